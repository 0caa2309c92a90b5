// SPDX-License-Identifier: Apache-2.0
#include "aureole/scene/edge/beam_width.h"

#include <cmath>

#include "aureole/core/error.h"
#include "aureole/core/units.h"

namespace aureole {

double BeamWidth::at(double wavelength_m) const {
  switch (unit) {
    case Unit::wavelengths:
      return value * wavelength_m;
    case Unit::length:
      return value;
    case Unit::fresnel:
      return std::sqrt(wavelength_m * value);
  }
  return 0;
}

BeamWidth BeamWidth::parse(const std::string& text) {
  const auto starts_with = [&](const char* word) { return text.rfind(word, 0) == 0; };
  BeamWidth width;
  if (starts_with("fresnel ")) {
    width = {Unit::fresnel, parse_length_m(text.substr(8))};
  } else if (const auto end = text.find(" wavelengths");
             end != std::string::npos && end + 12 == text.size()) {
    width = {Unit::wavelengths, parse_number(text.substr(0, end))};
  } else if (text.find_first_not_of("0123456789.+-eE") == std::string::npos) {
    width = {Unit::wavelengths, parse_number(text)};
  } else {
    width = {Unit::length, parse_length_m(text)};
  }
  if (!(width.value > 0) || !std::isfinite(width.value))
    throw Error("the width of a beam must be positive, got \"" + text + "\"");
  if (width.unit == Unit::wavelengths && width.value < 0.5)
    throw Error("a beam narrower than half a wavelength has no direction, got \"" + text + "\"");
  return width;
}

}  // namespace aureole

// SPDX-License-Identifier: Apache-2.0
#include "aureole/render/tone.h"

#include <algorithm>
#include <cmath>

#include "aureole/core/error.h"
#include "aureole/core/units.h"

namespace aureole {

Tone Tone::parse(const std::string& text) {
  Tone tone{0, 50};
  std::size_t at = text.find(':');
  bool good = text.substr(0, at) == "asinh";
  for (double* value : {&tone.compression, &tone.exposure}) {
    if (at == std::string::npos || !good) break;
    const std::size_t next = text.find(':', at + 1);
    try {
      *value = parse_number(text.substr(at + 1, next - at - 1));
    } catch (const Error&) {
      good = false;
    }
    at = next;
  }
  if (!good || at != std::string::npos || !(tone.compression >= 0 && tone.compression <= 1e9) ||
      !(std::abs(tone.exposure) <= 100))
    throw Error("\"" + text +
                "\": expected asinh, asinh:COMPRESSION or asinh:COMPRESSION:EXPOSURE, such as asinh:100:-2");
  return tone;
}

Image toned(const Image& picture, const Tone& tone) {
  int channel[3] = {picture.channel("R"), picture.channel("G"), picture.channel("B")};
  if (channel[0] < 0 || channel[1] < 0 || channel[2] < 0)
    channel[0] = channel[1] = channel[2] = std::max(0, picture.channel("Y"));
  Image out{picture.width, picture.height, {"R", "G", "B"}, {}, true};
  out.pixels.resize(std::size_t(picture.width) * picture.height * 3);
  const double gain = std::exp2(tone.exposure), b = tone.compression;
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      double c[3];
      for (int k = 0; k < 3; ++k) {
        c[k] = gain * picture.at(x, y, std::size_t(channel[k]));
        if (!std::isfinite(c[k])) c[k] = 0;
      }
      const double luminance = 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2];
      if (!(luminance > 0)) {
        for (int k = 0; k < 3; ++k) out.at(x, y, std::size_t(k)) = 0;
        continue;
      }
      const double target = std::min(1.0, b > 0 ? std::asinh(b * luminance) / std::asinh(b) : luminance);
      // Fraction of the saturation that is kept: colours outside the display's gamut are desaturated at
      // constant hue and brightness.
      double keep = 1;
      for (double& v : c) {
        v *= target / luminance;
        if (v < 0) keep = std::min(keep, target / (target - v));
        if (v > 1) keep = std::min(keep, (1 - target) / (v - target));
      }
      for (int k = 0; k < 3; ++k)
        out.at(x, y, std::size_t(k)) =
            srgb_encode(float(std::clamp(target + keep * (c[k] - target), 0.0, 1.0)));
    }
  return out;
}

}  // namespace aureole

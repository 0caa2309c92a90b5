// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/paint/aperture_loss.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "aureole/core/error.h"
#include "aureole/core/units.h"
#include "aureole/pigment/edge_loss.h"
#include "aureole/pigment/prediction.h"

namespace aureole {

std::optional<double> aperture_diameter_m(const std::string& text) {
  double metres = 0;
  try {
    metres = 1e-3 * parse_number(text);
  } catch (const Error&) {
    try {
      metres = parse_length_m(text);
    } catch (const Error&) {
      return {};
    }
  }
  constexpr double kSmallest = 1e-5, kLargest = 1;
  if (!(metres >= kSmallest && metres <= kLargest)) return {};
  return metres;
}

std::optional<ApertureLoss> aperture_loss(const pigment::SampleTable& table, const pigment::Palette& palette,
                                          const pigment::Observation& lamp) {
  const auto diameter = aperture_diameter_m(table.instrument.aperture);
  if (!diameter || palette.relative) return {};
  ApertureLoss loss{*diameter, 0, {}};
  pigment::Palette usable = palette;
  pigment::clamp_negative(usable);
  for (const pigment::Sample& s : table.samples) {
    const bool is_opaque = s.backing == "opaque";
    if (s.paints.empty() || s.backing == "none" || (!is_opaque && !(s.thickness > 0))) continue;
    std::vector<double> fractions(usable.pigments.size()), wide, seen;
    for (const pigment::Component& c : s.paints)
      if (const auto p = usable.find(c.name)) fractions[*p] += c.fraction;
    const pigment::Paint paint = pigment::mix(usable, fractions);
    const double thickness = is_opaque ? std::numeric_limits<double>::infinity() : s.thickness;
    try {
      for (std::size_t i = 0; i < paint.size(); ++i) {
        const double below =
            is_opaque ? 0 : std::clamp(pigment::substrate_at(table, usable.surface, s, i), 0.0, 1.0);
        const auto disc = [&](double radius) {
          return pigment::disc_reflectance(paint[i], thickness, below, usable.surface, radius);
        };
        constexpr double kWide = 1e4;  // times the aperture
        wide.push_back(disc(kWide * *diameter)), seen.push_back(disc(*diameter / 2));
      }
    } catch (const std::domain_error&) {
      continue;  // a card that was not measured
    }
    const double difference = pigment::ciede2000(lamp.lab(wide), lamp.lab(seen));
    if (loss.sample.empty() || difference > loss.difference)
      loss.difference = difference, loss.sample = s.name;
  }
  return loss;
}

std::string aperture_text(const pigment::SampleTable& table, const pigment::Palette& palette,
                          const pigment::Observation& lamp) {
  const std::string& stated = table.instrument.aperture;
  if (stated.empty()) return {};
  if (!aperture_diameter_m(stated))
    return "the aperture \"" + stated +
           "\" has no known size (expected a diameter, such as 4 mm): light lost at its edge is not estimated";
  const auto loss = aperture_loss(table, palette, lamp);
  if (!loss)
    return "aperture " + stated +
           ": K and S have no unit of length, so that light lost at its edge is not estimated";
  if (loss->sample.empty()) return "aperture " + stated + ": no layer has a known thickness";
  return fmt::format(
      "aperture {:.3g} mm: if the instrument lights no more than this, light lost at its edge makes a Delta E of {:.2f} at most "
      "(\"{}\")",
      1e3 * loss->diameter_m, loss->difference, loss->sample);
}

}  // namespace aureole

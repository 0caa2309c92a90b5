// SPDX-License-Identifier: Apache-2.0
#include "aureole/pigment/prediction.h"

#include <charconv>
#include <limits>

#include "aureole/pigment/domain.h"

namespace aureole::pigment {

std::optional<double> backing_reflectance(const Sample& sample) {
  const std::string& text = sample.backing;
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return {};
  return value;
}

double substrate_at(const SampleTable& table, const Surface& surface, const Sample& sample, std::size_t i) {
  if (const auto number = backing_reflectance(sample)) return *number;
  double sum = 0;
  int count = 0;
  for (const Sample& other : table.samples)
    if (other.paints.empty() && other.name == sample.backing) sum += other.values[i], ++count;
  if (count == 0) throw std::domain_error("there is no bare substrate \"" + sample.backing + "\"");
  return inner_reflectance(surface, sum / count);
}

std::vector<double> predict(const Palette& palette, const SampleTable& table, const Sample& sample) {
  std::vector<double> fractions(palette.pigments.size());
  for (const Component& c : sample.paints) {
    const auto p = palette.find(c.name);
    if (!p) throw std::domain_error("the palette has no paint \"" + c.name + "\"");
    fractions[*p] = c.fraction;
  }
  Palette possible = palette;
  clamp_negative(possible);
  const Paint paint = mix(possible, fractions);
  if (sample.backing == "opaque")
    return paint_reflectance(paint, std::numeric_limits<double>::infinity(), {}, palette.surface);
  if (palette.relative)
    throw std::domain_error("sample \"" + sample.name + "\" has a thickness, but K and S are relative");
  if (sample.backing != "none") {
    std::vector<double> substrate;
    for (std::size_t i = 0; i < paint.size(); ++i)
      substrate.push_back(substrate_at(table, palette.surface, sample, i));
    return paint_reflectance(paint, sample.thickness, substrate, palette.surface);
  }
  std::vector<double> result;
  for (const Coefficients& c : paint) {
    const LayerTransfer outer = outer_transfer(palette.surface, layer(c, sample.thickness));
    result.push_back(sample.quantity == Sample::Quantity::reflectance ? outer.reflectance
                                                                      : outer.transmittance);
  }
  return result;
}

}  // namespace aureole::pigment

// SPDX-License-Identifier: Apache-2.0
#include "aureole/parameter/palette_file.h"

#include <algorithm>
#include <cmath>

#include "aureole/core/error.h"
#include "aureole/core/input_file.h"
#include "aureole/parameter/data_range.h"
#include "aureole/pigment/measured_paints.h"
#include "aureole/pigment/palette_text.h"
#include "aureole/pigment/recipe.h"

namespace aureole {

pigment::Palette read_palette_file(const std::string& file) {
  if (file == kMeasuredPaints) return pigment::kimera_fit().palette;
  std::istringstream stream = read_table_file(file);
  try {
    return pigment::read_palette(stream);
  } catch (const pigment::TextError& e) {
    throw Error({file, e.line(), e.column()}, e.what());
  }
}

std::vector<double> recipe_fractions(const pigment::Palette& palette, const std::string& recipe,
                                     bool by_volume, const std::string& option) {
  try {
    std::vector<double> parts(palette.pigments.size());
    // The name of a paint may look like a recipe.
    const bool is_name = palette.find(recipe).has_value();
    for (const pigment::Component& c :
         is_name ? std::vector<pigment::Component>{{recipe, 1}} : pigment::parse_recipe(recipe)) {
      const auto at = palette.find(c.name);
      if (!at) {
        std::string all;
        for (const std::string& name : palette.names()) all += (all.empty() ? "" : ", ") + name;
        throw Error(option + ": unknown paint \"" + c.name + "\"" + did_you_mean(c.name, palette.names()) +
                    "; there are " + all);
      }
      parts[*at] = c.fraction;
    }
    return by_volume ? pigment::fractions_of_volumes(palette, parts) : pigment::fractions_of_parts(parts);
  } catch (const std::domain_error& e) {
    throw Error(option + ": " + e.what());
  }
}

void note_palette_range(const Properties& properties, std::string_view name,
                        const pigment::Palette& palette) {
  if (!palette.nm.empty())
    note_data_range(properties, name, "K and S of the palette", {palette.nm.front(), palette.nm.back()});
}

SampledSpectrum sampled_values(const SpectralGrid& grid, const std::vector<double>& nm,
                               const std::function<double(std::size_t)>& value) {
  return SampledSpectrum::from_function(grid, [&](double wavelength) {
    const auto above = std::upper_bound(nm.begin(), nm.end(), wavelength) - nm.begin();
    const std::size_t j = std::min(std::size_t(above), nm.size() - 1),
                      i = above == 0 ? 0 : std::size_t(above) - 1;
    const double t = j > i ? (wavelength - nm[i]) / (nm[j] - nm[i]) : 0;
    return std::lerp(value(i), value(j), t);
  });
}

SampledPaint sampled_paint(const SpectralGrid& grid, const pigment::Palette& palette,
                           const std::vector<double>& fractions, double factor) {
  const pigment::Paint paint = pigment::mix(palette, fractions);
  const auto table = [&](double pigment::Coefficients::*of) {
    return sampled_values(grid, palette.nm, [&, of](std::size_t i) { return factor * (paint[i].*of); });
  };
  return {table(&pigment::Coefficients::k), table(&pigment::Coefficients::s)};
}

}  // namespace aureole

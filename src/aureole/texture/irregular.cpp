// SPDX-License-Identifier: Apache-2.0
// A spectrum given at wavelengths of any spacing.
#include "aureole/plugin/registry.h"
#include "aureole/texture/constant_texture.h"

namespace aureole {
namespace {

SampledSpectrum tabulate(const Properties& properties) {
  const std::vector<double> nm = get_numbers(properties, "wavelengths");
  const std::vector<double> values = get_numbers(properties, "values");
  if (nm.size() != values.size())
    throw properties.error("values", "there are " + std::to_string(nm.size()) + " wavelengths but " +
                                         std::to_string(values.size()) + " values");
  for (std::size_t i = 1; i < nm.size(); ++i)
    if (!(nm[i] > nm[i - 1])) throw properties.error("wavelengths", "must increase");
  return SampledSpectrum::from_points(properties.context().grid, nm, values);
}

class Irregular final : public ConstantTexture {
public:
  explicit Irregular(const Properties& properties) : ConstantTexture(properties, tabulate(properties)) {}
  static std::optional<WavelengthRange> wavelength_range(const Properties& p) {
    WavelengthRange range;
    for (const double nm : get_numbers(p, "wavelengths")) range.extend(nm);
    return range;
  }
};

AUREOLE_PLUGIN(
    Irregular, "texture", "irregular",
    PluginDoc{
        "A spectrum given by wavelengths and values, linear between them and zero outside. Its integral is "
        "kept even where it has lines narrower than the renderer's wavelength grid.",
        "",
        {{"wavelengths", "string", "nm", "required", "two or more increasing wavelengths"},
         {"values", "string", "", "required", "as many numbers"}},
        {R"(<spectrum type="irregular">
    <string name="wavelengths" value="400, 520, 700"/>
    <string name="values" value="0.1, 0.3, 0.2"/>
</spectrum>)"}});

}  // namespace
}  // namespace aureole

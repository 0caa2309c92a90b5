// SPDX-License-Identifier: Apache-2.0
// A spectrum given at equidistant wavelengths.
#include "aureole/plugin/number_list.h"
#include "aureole/plugin/registry.h"
#include "aureole/texture/constant_texture.h"

namespace aureole {
namespace {

SampledSpectrum tabulate_regular(const Properties& properties) {
  const std::vector<double> values = get_numbers(properties, "values");
  const double min = get_wavelength(properties, "wavelength_min");
  const double max = get_wavelength(properties, "wavelength_max");
  if (!(max > min)) throw properties.error("wavelength_max", "must be greater than wavelength_min");
  std::vector<double> nm(values.size());
  for (std::size_t i = 0; i < nm.size(); ++i) nm[i] = min + (max - min) * double(i) / double(nm.size() - 1);
  return SampledSpectrum::from_points(properties.context().grid, nm, values);
}

class Regular final : public ConstantTexture {
public:
  explicit Regular(const Properties& properties)
      : ConstantTexture(properties, tabulate_regular(properties)) {}
  static std::optional<WavelengthRange> wavelength_range(const Properties& p) {
    return WavelengthRange{get_wavelength(p, "wavelength_min"), get_wavelength(p, "wavelength_max")};
  }
};

AUREOLE_PLUGIN(
    Regular, "texture", "regular",
    PluginDoc{"A spectrum given by values at equidistant wavelengths, linear between them and zero outside.",
              "",
              {{"values", "string", "", "required", "two or more numbers, separated by commas or spaces"},
               {"wavelength_min", "wavelength", "nm", "required",
                "wavelength of the first value; a number in nm or \"1cm\", \"29GHz\""},
               {"wavelength_max", "wavelength", "nm", "required", "wavelength of the last value"}},
              {R"(<spectrum type="regular">
    <float name="wavelength_min" value="400"/>
    <float name="wavelength_max" value="700"/>
    <string name="values" value="0.1, 0.3, 0.2"/>
</spectrum>)"}});

}  // namespace
}  // namespace aureole

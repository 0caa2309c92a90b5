// SPDX-License-Identifier: Apache-2.0
// A spectrum given at equidistant wavelengths.
#include "aureole/plugin/number_list.h"
#include "aureole/plugin/registry.h"
#include "aureole/texture/constant_texture.h"

namespace aureole {
namespace {

SpectrumPoints read_regular(const Properties& properties) {
  std::vector<double> values = get_numbers(properties, "values");
  const double min = get_wavelength(properties, "wavelength_min");
  const double max = get_wavelength(properties, "wavelength_max");
  if (!(max > min)) throw properties.error("wavelength_max", "must be greater than wavelength_min");
  // the numbers have no unit
  if (!std::holds_alternative<std::string>(properties.find("wavelength_min")->value))
    check_unit(properties, "wavelength_min", min, max);
  std::vector<double> nm(values.size());
  for (std::size_t i = 0; i < nm.size(); ++i) nm[i] = min + (max - min) * double(i) / double(nm.size() - 1);
  return {std::move(nm), std::move(values)};
}

class Regular final : public PointSpectrum {
public:
  explicit Regular(const Properties& properties) : PointSpectrum(properties, read_regular(properties)) {}
  static std::optional<WavelengthRange> wavelength_range(const Properties& p) {
    return WavelengthRange{get_wavelength(p, "wavelength_min"), get_wavelength(p, "wavelength_max")};
  }
};

AUREOLE_PLUGIN(
    Regular, "texture", "regular",
    PluginDoc{"A spectrum given by values at equidistant wavelengths, linear between them. Outside them a "
              "property of matter keeps the value at the end, and a note says so; light, a sensor's response "
              "and a filter are zero.",
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

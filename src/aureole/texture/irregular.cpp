// SPDX-License-Identifier: Apache-2.0
// A spectrum given by values at arbitrary wavelengths.
#include <algorithm>

#include "aureole/plugin/number_list.h"
#include "aureole/plugin/registry.h"
#include "aureole/texture/constant_texture.h"

namespace aureole {
namespace {

SpectrumPoints read_irregular(const Properties& properties) {
  std::vector<double> nm = get_wavelength_list(properties, "wavelengths");
  std::vector<double> values = get_numbers(properties, "values");
  if (nm.size() != values.size())
    throw properties.error("values", "there are " + std::to_string(nm.size()) + " wavelengths but " +
                                         std::to_string(values.size()) + " values");
  if (nm.front() > nm.back()) {  // wavelengths decrease, for example where frequencies increase
    std::reverse(nm.begin(), nm.end());
    std::reverse(values.begin(), values.end());
  }
  for (std::size_t i = 1; i < nm.size(); ++i)
    if (!(nm[i] > nm[i - 1])) throw properties.error("wavelengths", "must increase or decrease");
  const auto* text = std::get_if<std::string>(&properties.find("wavelengths")->value);
  if (!text || text->find_first_of("mHo") == text->npos)  // the numbers have no unit
    check_unit(properties, "wavelengths", nm.front(), nm.back());
  return {std::move(nm), std::move(values)};
}

class Irregular final : public PointSpectrum {
public:
  explicit Irregular(const Properties& properties) : PointSpectrum(properties, read_irregular(properties)) {}
  static std::optional<WavelengthRange> wavelength_range(const Properties& p) {
    WavelengthRange range;
    for (const double nm : get_wavelength_list(p, "wavelengths")) range.extend(nm);
    return range;
  }
};

AUREOLE_PLUGIN(
    Irregular, "texture", "irregular",
    PluginDoc{
        "A spectrum given by wavelengths and values, linear between them. Outside them a property of matter "
        "keeps the value at the end, and a note says so; light, a sensor's response and a filter are zero. "
        "Its integral is preserved, even for lines narrower than the renderer's wavelength grid.",
        "",
        {{"wavelengths", "string", "nm", "required",
          "two or more wavelengths in increasing or decreasing order; with units \"26GHz, 29GHz\""},
         {"values", "string", "", "required", "the value at each wavelength"}},
        {R"(<spectrum type="irregular">
    <string name="wavelengths" value="400, 520, 700"/>
    <string name="values" value="0.1, 0.3, 0.2"/>
</spectrum>)"}});

}  // namespace
}  // namespace aureole

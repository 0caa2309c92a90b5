// SPDX-License-Identifier: Apache-2.0
// The CIE's illuminants and representative light sources, by name.
#include "aureole/plugin/registry.h"
#include "aureole/spectrum/tables.h"
#include "aureole/texture/constant_texture.h"

namespace aureole {
namespace {

SampledSpectrum tabulate_illuminant(const Properties& properties) {
  const std::string name = properties.get_string("name");
  const double scale = properties.get_float("scale", 1, Range::non_negative());
  const auto table = find_illuminant(name);
  if (!table)
    throw properties.error("name",
                           "unknown illuminant \"" + name + "\"" + did_you_mean(name, illuminant_names()));
  SampledSpectrum s =
      SampledSpectrum::from_points(properties.context().grid, table->wavelengths_nm, table->values);
  s.scale(float(scale * cie_y_integral() / cie_tristimulus(*table)[1]));
  return s;
}

class Illuminant final : public ConstantTexture {
public:
  explicit Illuminant(const Properties& properties)
      : ConstantTexture(properties, tabulate_illuminant(properties)) {}
};

AUREOLE_PLUGIN(
    Illuminant, "texture", "illuminant",
    PluginDoc{
        "The relative spectrum of a CIE illuminant, scaled to the luminance of a flat spectrum of value one "
        "(integral of S y-bar = integral of y-bar over the CIE 1931 observer). So changing the illuminant "
        "changes colours and not the exposure. Names: A, B, C, D50 ... D75, E, the fluorescent lamps FL1 "
        "... and the other light sources of the CIE's tables.",
        "CIE 15:2004 and CIE 015:2018, Colorimetry",
        {{"name", "string", "", "required", "name of the illuminant; case is ignored"},
         {"scale", "float", "", "1", "factor"}},
        {R"(<spectrum type="illuminant">
    <string name="name" value="FL11"/>
    <float name="scale" value="10"/>
</spectrum>)"}});

}  // namespace
}  // namespace aureole

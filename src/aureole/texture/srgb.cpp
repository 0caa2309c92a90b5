// SPDX-License-Identifier: Apache-2.0
// The smooth reflectance spectrum of a colour.
#include "aureole/plugin/registry.h"
#include "aureole/texture/constant_texture.h"

namespace aureole {
namespace {

SampledSpectrum tabulate_srgb(const Properties& properties) {
  const SpectrumLiteral color = get_rgb(properties, "color", properties.get_bool("unbounded", false));
  return spectrum_of_rgb(properties.context().grid, color.rgb, false);
}

class Srgb final : public ConstantTexture {
public:
  explicit Srgb(const Properties& properties) : ConstantTexture(properties, tabulate_srgb(properties)) {}
};

AUREOLE_PLUGIN(
    Srgb, "texture", "srgb",
    PluginDoc{
        "A smooth reflectance spectrum that has a given colour under D65.",
        "W. Jakob, J. Hanika, A low-dimensional function space for efficient spectral upsampling, "
        "Computer Graphics Forum 38(2), 2019",
        {{"color", "rgb", "", "required", "linear sRGB components in [0, 1]"},
         {"unbounded", "boolean", "", "false",
          "accept components above one: the colour is scaled down and its spectrum is scaled back (Mitsuba "
          "clamps the colour instead)"}},
        {R"(<spectrum type="srgb">
    <rgb name="color" value="0.8, 0.3, 0.1"/>
</spectrum>)",
         R"(<spectrum type="srgb">
    <rgb name="color" value="4, 1.5, 0.5"/>
    <boolean name="unbounded" value="true"/>
</spectrum>)"}});

}  // namespace
}  // namespace aureole

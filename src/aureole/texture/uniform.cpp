// SPDX-License-Identifier: Apache-2.0
// A flat spectrum.
#include "aureole/plugin/registry.h"
#include "aureole/texture/constant_texture.h"

namespace aureole {
namespace {

class Uniform final : public ConstantTexture {
public:
  explicit Uniform(const Properties& properties)
      : ConstantTexture(properties, SampledSpectrum::constant(
                                        properties.context().grid,
                                        float(properties.get_float("value", Range::non_negative())))) {
    for (const char* bound : {"wavelength_min", "wavelength_max"}) {
      properties.get_float(bound, 0, Range::positive());
      if (properties.has(bound))
        properties.note(bound, "has no effect: the spectrum is flat at all wavelengths");
    }
  }
};

AUREOLE_PLUGIN(
    Uniform, "texture", "uniform",
    PluginDoc{
        "One value at all wavelengths. For an emitter this is an equal-energy spectrum, whereas a plain "
        "number multiplies D65.",
        "",
        {{"value", "float", "", "required", "the value"},
         {"wavelength_min", "float", "nm", "none", "accepted for compatibility with Mitsuba, no effect"},
         {"wavelength_max", "float", "nm", "none", "accepted for compatibility with Mitsuba, no effect"}},
        {R"(<spectrum type="uniform">
    <float name="value" value="0.1"/>
    <float name="wavelength_min" value="400"/>
    <float name="wavelength_max" value="700"/>
</spectrum>)"}});

}  // namespace
}  // namespace aureole

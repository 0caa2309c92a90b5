// SPDX-License-Identifier: Apache-2.0
// The radiance of a black body by Planck's law.
#include "aureole/plugin/registry.h"
#include "aureole/spectrum/planck.h"
#include "aureole/texture/constant_texture.h"

namespace aureole {
namespace {

SampledSpectrum tabulate_blackbody(const Properties& properties) {
  const double temperature = properties.get_float("temperature", Range::positive());
  const double min = properties.get_float("wavelength_min", 0, Range::non_negative());
  const double max =
      properties.get_float("wavelength_max", std::numeric_limits<double>::infinity(), Range::positive());
  if (!(max > min)) throw properties.error("wavelength_max", "must be greater than wavelength_min");
  return SampledSpectrum::from_function(properties.context().grid, [&](double nm) {
    return nm < min || nm > max ? 0.0 : black_body_radiance(nm, temperature);
  });
}

class Blackbody final : public ConstantTexture {
public:
  explicit Blackbody(const Properties& properties)
      : ConstantTexture(properties, tabulate_blackbody(properties)) {}
};

AUREOLE_PLUGIN(
    Blackbody, "texture", "blackbody",
    PluginDoc{"The radiance of a black body in W/(m^2 sr nm). It is an absolute quantity, of the order of "
              "10^4 for an incandescent lamp, so that other emitters of the scene must use the same units.",
              "M. Planck, Annalen der Physik 309, 1901",
              {{"temperature", "float", "K", "required", "temperature of the black body"},
               {"wavelength_min", "float", "nm", "0", "the spectrum is zero below this wavelength"},
               {"wavelength_max", "float", "nm", "infinity", "the spectrum is zero above this wavelength"}},
              {R"(<spectrum type="blackbody">
    <float name="temperature" value="2856"/>
    <float name="wavelength_min" value="360"/>
    <float name="wavelength_max" value="830"/>
</spectrum>)"}});

}  // namespace
}  // namespace aureole

// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/layer/coherent_layer.h"

#include <stdexcept>
#include <string>

#include "aureole/optics/arrangement/structure_factor.h"

namespace aureole::optics {

CoherentLayer coherent_layer(double cos_i, double area_fraction, const LayerSpheres& spheres,
                             const MieAmplitudes& specular) {
  CoherentLayer layer;
  if (area_fraction == 0) return layer.transmission = {1, 1}, layer;
  if (cos_i == 0) return layer.reflection = {-1, -1}, layer;
  const double clear = spheres.size_squared * cos_i;
  for (int j = 0; j < 2; ++j) {
    const std::complex<double> s = j == 0 ? specular.s1 : specular.s2;
    const std::complex<double> even = area_fraction * (spheres.forward + s),
                               odd = area_fraction * (spheres.forward - s);
    const std::complex<double> sum = (clear - even) / (clear + even),
                               difference = (clear - odd) / (clear + odd);
    layer.transmission[j] = 0.5 * (sum + difference);
    layer.reflection[j] = 0.5 * (sum - difference);
  }
  return layer;
}

CoherentLayer coherent_layer(double cos_i, double area_fraction, const Mie& sphere) {
  if (!(cos_i >= 0 && cos_i <= 1))
    throw std::domain_error("cosine of incidence must be in [0, 1], got " + std::to_string(cos_i));
  if (!(area_fraction >= 0 && area_fraction <= kMaxAreaFraction))
    throw std::domain_error("area fraction of spheres must be in [0, 0.7], got " +
                            std::to_string(area_fraction));
  return coherent_layer(cos_i, area_fraction, {sphere.size() * sphere.size(), sphere.forward()},
                        sphere.amplitudes(1 - 2 * cos_i * cos_i));
}

}  // namespace aureole::optics

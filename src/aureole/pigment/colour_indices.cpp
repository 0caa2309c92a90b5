// SPDX-License-Identifier: Apache-2.0
#include "aureole/pigment/colour_indices.h"

namespace aureole::pigment {

Chromaticity chromaticity(const Xyz& xyz) {
  const double sum = xyz[0] + xyz[1] + xyz[2];
  return sum > 0 ? Chromaticity{xyz[0] / sum, xyz[1] / sum} : Chromaticity{};
}

Whiteness cie_whiteness(const Xyz& xyz, const Xyz& white, Field field) {
  const Chromaticity c = chromaticity(xyz), n = chromaticity(white);
  const double y = 100 * xyz[1] / white[1];
  const double w = y + 800 * (n.x - c.x) + 1700 * (n.y - c.y);
  const double t = (field == Field::ten ? 900 : 1000) * (n.x - c.x) - 650 * (n.y - c.y);
  return {w, t, w > 40 && w < 5 * y - 280 && t > -4 && t < 2};
}

std::optional<double> yellowness(const Xyz& xyz, std::string_view illuminant, Field field) {
  if (!(xyz[1] > 0)) return {};
  const bool ten = field == Field::ten;
  if (illuminant == "C")
    return 100 * ((ten ? 1.2871 : 1.2769) * xyz[0] - (ten ? 1.0781 : 1.0592) * xyz[2]) / xyz[1];
  if (illuminant == "D65")
    return 100 * ((ten ? 1.3013 : 1.2985) * xyz[0] - (ten ? 1.1498 : 1.1335) * xyz[2]) / xyz[1];
  return {};
}

double metamerism_index(const Observation& reference, const Observation& test,
                        std::span<const double> standard, std::span<const double> sample,
                        const DifferenceFormula& formula) {
  const Xyz wanted = reference.xyz(standard), seen = reference.xyz(sample);
  Xyz corrected = test.xyz(sample);
  for (std::size_t i = 0; i < 3; ++i)
    if (seen[i] > 0) corrected[i] *= wanted[i] / seen[i];
  return formula(test.lab(standard), lab_of_xyz(corrected, test.white()));
}

}  // namespace aureole::pigment

// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/arrangement/equilibrium_structure_factor.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <stdexcept>
#include <string>

namespace aureole::optics {
namespace {

constexpr int kCorrectionNodes = 321;  // nodes of the table in u
constexpr double kCorrectionStep = 0.125, kCorrectionEnd = (kCorrectionNodes - 1) * kCorrectionStep;

struct CorrectionRow {
  double area_fraction;
  float correction[kCorrectionNodes];
};
constexpr CorrectionRow kCorrections[] = {
    {0, {}},
#include "aureole/optics/arrangement/data/hard_disc_corrections.inc"
};
constexpr int kCorrectionRows = int(std::size(kCorrections));

}  // namespace

double equilibrium_correction(double u, double area_fraction) {
  if (!(area_fraction >= 0 && area_fraction <= kMaxEquilibriumFraction + kFractionTolerance))
    throw std::domain_error("area fraction of hard discs in equilibrium must be in [0, 0.68], got " +
                            std::to_string(area_fraction));
  u = std::abs(u);
  if (!(u < kCorrectionEnd)) return 0;
  // Cubic interpolation in u, and in the area fraction through the four nearest rows.
  const double place = u / kCorrectionStep;
  const int node = std::clamp(int(place) - 1, 0, kCorrectionNodes - 4);
  const double t = place - node;
  const double along[4] = {-(t - 1) * (t - 2) * (t - 3) / 6, t * (t - 2) * (t - 3) / 2,
                           -t * (t - 1) * (t - 3) / 2, t * (t - 1) * (t - 2) / 6};
  int first = 0;
  while (first + 4 < kCorrectionRows && kCorrections[first + 2].area_fraction < area_fraction) ++first;
  double sum = 0;
  for (int i = first; i < first + 4; ++i) {
    double weight = 1;
    for (int k = first; k < first + 4; ++k)
      if (k != i)
        weight *= (area_fraction - kCorrections[k].area_fraction) /
                  (kCorrections[i].area_fraction - kCorrections[k].area_fraction);
    const float* row = &kCorrections[i].correction[node];
    for (int k = 0; k < 4; ++k) sum += weight * along[k] * double(row[k]);
  }
  return sum;
}

}  // namespace aureole::optics

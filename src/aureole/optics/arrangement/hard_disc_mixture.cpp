// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/arrangement/hard_disc_mixture.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "aureole/optics/aperture/aperture_transform.h"
#include "aureole/optics/arrangement/structure_factor.h"
#include "aureole/optics/bessel.h"
#include "aureole/optics/constants.h"

namespace aureole::optics {
HardDiscMixture::HardDiscMixture(std::vector<double> radii, std::vector<double> fractions,
                                 double area_fraction)
    : radii_(std::move(radii)), fractions_(std::move(fractions)), area_fraction_(area_fraction) {
  if (radii_.empty() || radii_.size() != fractions_.size())
    throw std::domain_error("a mixture of discs needs as many radii as number fractions");
  if (!(area_fraction >= 0 && area_fraction <= kMaxAreaFraction))
    throw std::domain_error("area fraction of hard discs must be in [0, 0.7], got " +
                            std::to_string(area_fraction));
  double sum = 0, area = 0, perimeter = 0;
  for (size_t m = 0; m < radii_.size(); ++m) {
    if (!(radii_[m] > 0 && std::isfinite(radii_[m])))
      throw std::domain_error("radii of hard discs must be positive, got " + std::to_string(radii_[m]));
    if (!(fractions_[m] > 0 && std::isfinite(fractions_[m])))
      throw std::domain_error("number fractions must be positive, got " + std::to_string(fractions_[m]));
    sum += fractions_[m];
  }
  for (size_t m = 0; m < radii_.size(); ++m) {
    fractions_[m] /= sum;
    area += fractions_[m] * kPi * radii_[m] * radii_[m];
    perimeter += fractions_[m] * 2 * kPi * radii_[m];
  }
  density_ = area_fraction / area;
  // Second derivatives of -n0 ln(1 - n2) + n1^2/(4 pi (1 - n2)), where n0, n1 and n2 are the number,
  // perimeter and area of discs per unit area.
  const double clear = 1 - area_fraction, n1 = density_ * perimeter;
  chi_[0] = 1 / clear;
  chi_[1] = n1 / (2 * kPi * clear * clear);
  chi_[2] = density_ / (clear * clear) + n1 * n1 / (2 * kPi * clear * clear * clear);
}

double HardDiscMixture::largest_radius() const { return *std::max_element(radii_.begin(), radii_.end()); }

double HardDiscMixture::mean_radius() const {
  double mean = 0;
  for (size_t m = 0; m < radii_.size(); ++m) mean += fractions_[m] * radii_[m];
  return mean;
}

double HardDiscMixture::direct(int m, int l, double q) const {
  const double a = radii_[m], b = radii_[l], contact = a + b;
  const double area_a = kPi * a * a * circle_transform(q * a), edge_a = 2 * kPi * a * bessel_j0(q * a);
  const double area_b = m == l ? area_a : kPi * b * b * circle_transform(q * b);
  const double edge_b = m == l ? edge_a : 2 * kPi * b * bessel_j0(q * b);
  const double c = chi_[0] * kPi * contact * contact * circle_transform(q * contact) +
                   chi_[1] * (edge_a * area_b + edge_b * area_a) + chi_[2] * area_a * area_b;
  return -density_ * std::sqrt(fractions_[m] * fractions_[l]) * c;
}

}  // namespace aureole::optics

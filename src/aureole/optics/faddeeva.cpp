// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/faddeeva.h"

#include <cerf.h>

#include <cmath>
#include <numbers>

#include "aureole/optics/constants.h"

namespace aureole::optics {
namespace {

using std::numbers::pi;

/// Returns the integral of exp(-t^2 + 2 i beta t) from a >= 0 to infinity: sqrt(pi)/2 exp(-beta^2) erfc(a - i
/// beta).
Complex upper_tail(double a, double beta) {
  return 0.5 * std::sqrt(pi) * std::polar(std::exp(-a * a), 2 * a * beta) * faddeeva({beta, a});
}

}  // namespace

std::complex<double> faddeeva(std::complex<double> z) {
  return {re_w_of_z(z.real(), z.imag()), im_w_of_z(z.real(), z.imag())};
}

std::complex<double> gaussian_wave_integral(double a, double b, double beta) {
  if (a > b) return -gaussian_wave_integral(b, a, beta);
  if (a >= 0) return upper_tail(a, beta) - upper_tail(b, beta);
  if (b <= 0) return std::conj(upper_tail(-b, beta) - upper_tail(-a, beta));
  // The integral over the whole line minus the integrals over both tails.
  return std::sqrt(pi) * std::exp(-beta * beta) - upper_tail(b, beta) - std::conj(upper_tail(-a, beta));
}

std::complex<double> fresnel_integral(double v) {
  const double size = std::abs(v), scale = 0.5 * std::sqrt(pi) * size;
  const Complex half(0.5, 0.5);
  const Complex value = half * (1.0 - std::polar(1.0, 0.5 * pi * v * v) * faddeeva({scale, scale}));
  return v < 0 ? -value : value;
}

std::complex<double> knife_edge_field(double v) {
  const double scale = 0.5 * std::sqrt(pi) * std::abs(v);
  const Complex edge = 0.5 * std::polar(1.0, 0.5 * pi * v * v) * faddeeva({scale, scale});
  return v < 0 ? edge : 1.0 - edge;
}

double knife_edge_intensity(double v) { return std::norm(knife_edge_field(v)); }

}  // namespace aureole::optics

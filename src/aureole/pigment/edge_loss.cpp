// SPDX-License-Identifier: Apache-2.0
#include "aureole/pigment/edge_loss.h"

#include <array>
#include <cmath>

#include "aureole/pigment/domain.h"

namespace aureole::pigment {
namespace {

/// The spectrum of a disc in steps of ln x, x = q radius: the power within each step. Beyond the last one nearly none is left.
struct DiscSpectrum {
  static constexpr double kFirst = 1e-4, kLast = 1e5;
  static constexpr std::size_t kSteps = 1200;
  std::array<double, kSteps + 1> x{}, power{};

  DiscSpectrum() {
    const auto below = [](double at) {
      const double j0 = std::cyl_bessel_j(0, at), j1 = std::cyl_bessel_j(1, at);
      return 1 - j0 * j0 - j1 * j1;
    };
    const double step = std::log(kLast / kFirst) / double(kSteps);
    double before = 0;
    for (std::size_t i = 0; i <= kSteps; ++i) {
      x[i] = kFirst * std::exp(step * double(i));
      const double now = i < kSteps ? below(x[i] * std::exp(0.5 * step)) : 1;
      power[i] = now - before, before = now;
    }
  }
};

}  // namespace

double disc_reflectance(const Coefficients& c, double thickness, double substrate, const Surface& surface,
                        double radius) {
  require(radius > 0 && std::isfinite(radius), radius, "radius of the aperture",
          "must be positive and finite");
  const double rate = c.k / 2 + c.s / 0.75, diffusion = rate > 0 ? 1 / (3 * rate) : 0;
  const auto reflectance = [&](double q) {
    const LayerTransfer of = layer({c.k + 2 * diffusion * q * q, c.s}, thickness);
    return outer_reflectance(surface,
                             std::isinf(thickness) ? of.reflectance : reflectance_over(of, substrate));
  };
  if (!(rate > 0)) return reflectance(0);
  static const DiscSpectrum disc;
  double sum = 0;
  for (std::size_t i = 0; i < disc.x.size(); ++i) sum += disc.power[i] * reflectance(disc.x[i] / radius);
  return sum;
}

}  // namespace aureole::pigment

// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/stack/stack_single_scattering.h"

#include <cmath>
#include <utility>

namespace aureole::optics {
namespace {

/// Returns (exp(-a t) - exp(-b t))/(b - a), continued to t exp(-a t) at a = b.
double two_ways(double a, double b, double t) {
  if (b < a) std::swap(a, b);
  const double d = (b - a) * t;
  return t * std::exp(-a * t) * (std::abs(d) < 1e-12 ? 1 : -std::expm1(-d) / d);
}

}  // namespace

bool SingleScattering::corrects() const {
  for (const StackSolver::Element& e : solver_.elements())
    if (e.kind == StackSolver::Element::Kind::layer && solver_.scaled(e.layer).share < 1 - 1e-12) return true;
  return false;
}

SingleScattering::Beam SingleScattering::light(int channel, bool from_below) const {
  return {channel, solver_.unscattered(channel, true).col(from_below ? 2 * solver_.last_level() + 1 : 0)};
}

std::vector<double> SingleScattering::correction(const Beam& beam, int channel, int level, bool goes_up,
                                                 std::span<const double> azimuths) const {
  std::vector<double> result(azimuths.size(), 0);
  const int levels = solver_.last_level() + 1;
  const auto escape = solver_.unscattered(channel, true).row(goes_up ? levels + level : level).eval();
  const double n_view = solver_.index(level);
  for (int k = 0; k + 1 < levels; ++k) {
    const StackSolver::Element& e = solver_.elements()[k];
    if (e.kind != StackSolver::Element::Kind::layer) continue;
    const double n = e.index_above;
    const StackLayer& layer = description_.layers[e.layer];
    const StackSolver::Scaled& scaled = solver_.scaled(e.layer);
    if (!(scaled.albedo > 0) || beam.channel >= solver_.channels().count(n) ||
        channel >= solver_.channels().count(n))
      continue;
    const double mu_in = solver_.channels().mu(beam.channel, n), mu_out = solver_.channels().mu(channel, n);
    // Unscattered light incident on the layer from above and from below.
    const double down = beam.paths[k], up = beam.paths[levels + k + 1];
    const double leaves_up = escape[levels + k], leaves_down = escape[k + 1];
    const double through = two_ways(1 / mu_in, 1 / mu_out, e.scaled), sum = 1 / mu_in + 1 / mu_out,
                 back = -std::expm1(-sum * e.scaled) / sum;
    const double scale = n_view * n_view / (n * n * mu_in * mu_out);
    const double forward = scale * through * (down * leaves_down + up * leaves_up),
                 backward = scale * back * (down * leaves_up + up * leaves_down);

    // Factor albedo/(1 - albedo f) of the whole phase function, compared with the scaled albedo of the
    // series.
    const double whole = layer.scattering / (layer.extinction() * scaled.share);
    const auto difference = [&](double cosine) {
      return whole * layer.phase.eval(cosine) - scaled.albedo * legendre_series(scaled.moments, cosine);
    };
    const double sines = std::sqrt((1 - mu_in * mu_in) * (1 - mu_out * mu_out));
    for (std::size_t a = 0; a < azimuths.size(); ++a) {
      const double across = sines * std::cos(azimuths[a]);
      result[a] += forward * difference(std::min(1.0, mu_in * mu_out + across)) +
                   backward * difference(std::max(-1.0, across - mu_in * mu_out));
    }
  }
  return result;
}

}  // namespace aureole::optics

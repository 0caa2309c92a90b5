// SPDX-License-Identifier: Apache-2.0
#include "aureole/phase/mie_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>
#include <utility>

namespace aureole {

namespace {

/// Returns the size parameter 2 pi n r/lambda of the effective radius.
double size_parameter(const optics::RadiusDistribution& radii, double host_index, double nm) {
  return 2 * M_PI * host_index * radii.effective_radius() * 1e9 / nm;
}

/// Returns the number of steps of the first set of wavelengths, which must resolve oscillations, so that the
/// agreement in the middle of a step is not accidental. Features move in proportion to the size parameter x.
/// Resonances of spheres of one size repeat over about one unit of x; a spread of sizes blurs them. Rainbows
/// are not blurred: dispersion turns the rainbow of water by some 3 degrees per unit of ln(lambda). It is 120
/// degrees x^(-2/3) wide (Airy), and nodes must be a fourth of that apart.
double first_steps(const SpectralGrid& grid, const optics::RadiusDistribution& radii, double host_index) {
  constexpr double kLeastPerLog = 8, kSizeStep = 0.25, kRainbow = 4 * 3 / 120.0;
  const double width = std::log(grid.max_nm / grid.min_nm);
  const double x = size_parameter(radii, host_index, grid.min_nm);
  double steps = (x - size_parameter(radii, host_index, grid.max_nm)) / kSizeStep;
  if (const double variance = radii.effective_variance(); variance > 0)
    steps = std::min(steps, 3 * width / std::sqrt(variance));
  return std::max({steps, kRainbow * std::cbrt(x * x) * width, kLeastPerLog * width});
}

using Coefficients = optics::EnsembleCoefficients;

// The following functions return errors of interpolation between `a` and `b` at `c`, relative to their
// tolerances. The errors of the averages over radii are added to the tolerances, since finer steps would
// resolve noise.

/// Returns the error of the phase function and the asymmetry, which are linear, at the fraction t of the step.
double phase_error(const Coefficients& a, const Coefficients& b, const Coefficients& c, double t) {
  constexpr double kAsymmetry = 2e-3, kPhase = 1.5e-2, kFloor = 1e-3 / (4 * M_PI);
  double worst = std::abs(std::lerp(a.asymmetry, b.asymmetry, t) - c.asymmetry) / kAsymmetry;
  if (a.phase.size() != c.phase.size() || b.phase.size() != c.phase.size()) return worst;
  for (std::size_t i = 0; i < c.phase.size(); ++i) {
    const double tolerance = kPhase * std::max(c.phase[i], kFloor) +
                             3 * std::max({a.phase_error[i], b.phase_error[i], c.phase_error[i]});
    worst = std::max(worst, std::abs(std::lerp(a.phase[i], b.phase[i], t) - c.phase[i]) / tolerance);
  }
  return worst;
}

/// Interpolates as a power of the wavelength, as scattering by both small and large particles is one; linearly
/// where a value is 0. `t` is the fraction of the step in ln(wavelength).
double power_law(double a, double b, double t) {
  return a > 0 && b > 0 ? a * std::pow(b / a, t) : std::lerp(a, b, t);
}

double fraction_of_log(const Coefficients& a, const Coefficients& b, double nm) {
  return std::clamp(std::log(nm / a.lambda_nm) / std::log(b.lambda_nm / a.lambda_nm), 0.0, 1.0);
}

double interpolated_scattering(const Coefficients& a, const Coefficients& b, double nm) {
  return power_law(a.scattering, b.scattering, fraction_of_log(a, b, nm));
}

/// The ratio of the absorption to its estimate is interpolated; where neither end absorbs, the ratio is taken as 1.
double interpolated_absorption(const Coefficients& a, const Coefficients& b, double nm,
                               const optics::SpectralFunction& estimate) {
  constexpr double kRounding = 1e-10;  // smallest absorption that counts, relative to the extinction
  const auto ratio = [&](const Coefficients& c) {
    const double estimated = estimate(c.lambda_nm);
    return estimated > 0 && c.absorption > kRounding * c.extinction() ? c.absorption / estimated : 0;
  };
  const double p = ratio(a), q = ratio(b);
  return estimate(nm) * (p > 0 && q > 0   ? power_law(p, q, fraction_of_log(a, b, nm))
                         : p > 0 || q > 0 ? std::max(p, q)
                                          : 1);
}

/// Returns the error of scattering and absorption.
double coefficient_error(const Coefficients& a, const Coefficients& b, const Coefficients& c,
                         const optics::SpectralFunction& estimate) {
  constexpr double kTolerance = 1e-3, kLeastAbsorption = 1e-4;
  const double scattering = std::abs(interpolated_scattering(a, b, c.lambda_nm) - c.scattering);
  const double absorption = std::abs(interpolated_absorption(a, b, c.lambda_nm, estimate) - c.absorption);
  const double tolerance = kTolerance * std::max(c.absorption, kLeastAbsorption * c.extinction()) +
                           2 * std::max({a.absorption_error, b.absorption_error, c.absorption_error});
  const double scattering_tolerance =
      kTolerance * c.scattering + 2 * std::max({a.scattering_error, b.scattering_error, c.scattering_error});
  return std::max(scattering_tolerance > 0 ? scattering / scattering_tolerance : 0,
                  tolerance > 0 ? absorption / tolerance : 0);
}

double fraction_of(const Coefficients& a, const Coefficients& b, const Coefficients& c) {
  return (c.lambda_nm - a.lambda_nm) / (b.lambda_nm - a.lambda_nm);
}

/// Returns the number of phase functions that may be tabulated. Their time is proportional to their number,
/// the number of radii, the size parameter and the number of angles.
std::size_t most_phases(const std::vector<Coefficients>& all, double size) {
  std::size_t radii = 1;
  for (const Coefficients& c : all) radii = std::max(radii, c.radii);
  return std::size_t(std::clamp(1e5 / (size * double(radii)), 65.0, 512.0));
}

/// Chooses wavelengths until linear interpolation of the phase function is accurate at all others, where its
/// error is largest first, or until there are `most`.
std::vector<double> choose_phases(const std::vector<Coefficients>& all, std::size_t most) {
  struct Step {
    std::size_t low, high, worst = 0;
    double error = 0;
  };
  const auto measured = [&](std::size_t low, std::size_t high) {
    Step s{low, high};
    for (std::size_t i = low + 1; i < high; ++i)
      if (const double e = phase_error(all[low], all[high], all[i], fraction_of(all[low], all[high], all[i]));
          e > s.error)
        s.error = e, s.worst = i;
    return s;
  };
  std::vector<Step> steps{measured(0, all.size() - 1)};
  const auto smaller = [](const Step& a, const Step& b) { return a.error < b.error; };
  while (steps.size() + 1 < most && steps.front().error > 1) {
    const Step s = steps.front();
    std::pop_heap(steps.begin(), steps.end(), smaller), steps.pop_back();
    for (const Step& half : {measured(s.low, s.worst), measured(s.worst, s.high)})
      steps.push_back(half), std::push_heap(steps.begin(), steps.end(), smaller);
  }
  std::vector<double> nm{all.back().lambda_nm};
  for (const Step& s : steps) nm.push_back(all[s.low].lambda_nm);
  std::sort(nm.begin(), nm.end());
  return nm;
}

}  // namespace

void require_sizes_for_tables(const SpectralGrid& grid, std::span<const optics::RadiusDistribution> radii,
                              double host_index) {
  constexpr double kMaxSize = 5000;
  for (const optics::RadiusDistribution& r : radii)
    if (const double x = size_parameter(r, host_index, grid.min_nm); x > kMaxSize)
      throw std::domain_error(fmt::format(
          "2 pi n radius/lambda is {:.0f} at the sensor's shortest wavelength, {:.6g} nm; up to {:.0f} is tabulated in a "
          "bearable time",
          x, grid.min_nm, kMaxSize));
}

std::pair<const Coefficients&, const Coefficients&> MieSpectrum::step_at(double nm) const {
  const auto above =
      std::upper_bound(coefficients.begin() + 1, coefficients.end() - 1, nm,
                       [](double l, const optics::EnsembleCoefficients& c) { return l < c.lambda_nm; });
  return {above[-1], above[0]};
}

double MieSpectrum::scattering(double nm) const {
  const auto [a, b] = step_at(nm);
  return interpolated_scattering(a, b, nm);
}

double MieSpectrum::absorption(double nm) const {
  const auto [a, b] = step_at(nm);
  return interpolated_absorption(a, b, nm, estimated_absorption);
}

MieSpectrum mie_spectrum(const SpectralGrid& grid, std::span<const optics::RadiusDistribution> radii,
                         double host_index, const MieEvaluator& evaluate,
                         optics::SpectralFunction estimated_absorption) {
  require_sizes_for_tables(grid, radii, host_index);
  double count = 2, size = 1;
  for (const optics::RadiusDistribution& r : radii)
    count = std::max(count, first_steps(grid, r, host_index)),
    size = std::max(size, size_parameter(r, host_index, grid.min_nm));
  const int steps = int(std::min(std::ceil(count), double(grid.cells)));
  const bool is_single = std::all_of(radii.begin(), radii.end(), [](const auto& r) { return r.is_single(); });
  std::map<int, Coefficients> found;  // coefficients by the index of the grid's node
  const auto find = [&](const std::vector<int>& nodes) {
    std::vector<double> nm;
    for (const int i : nodes) nm.push_back(grid.node(i));
    std::vector<Coefficients> values = evaluate(nm);
    for (std::size_t i = 0; i < nodes.size(); ++i) found.emplace(nodes[i], std::move(values[i]));
  };
  std::vector<int> nodes;
  for (int i = 0; i <= steps; ++i) {
    // Steps are uniform in 1/lambda, as size parameters are.
    const double nm = 1 / std::lerp(1 / grid.min_nm, 1 / grid.max_nm, double(i) / steps);
    const int node = std::clamp(int(std::lround((nm - grid.min_nm) / grid.step())), 0, grid.cells);
    if (nodes.empty() || node > nodes.back()) nodes.push_back(node);
  }
  find(nodes);
  struct Step {
    int low, high, halvings = 0;
    int middle() const { return (low + high) / 2; }
  };
  std::vector<Step> open;
  for (std::size_t i = 0; i + 1 < nodes.size(); ++i) open.push_back({nodes[i], nodes[i + 1]});
  while (!open.empty()) {
    std::erase_if(open, [](const Step& s) { return s.high - s.low < 2; });
    std::vector<int> middles;
    for (const Step& s : open) middles.push_back(s.middle());
    if (!middles.empty()) find(middles);
    const bool more_phases = found.size() < most_phases({found.at(0)}, size);
    std::vector<Step> next;
    for (const Step& s : open) {
      const Coefficients &a = found.at(s.low), &b = found.at(s.high), &c = found.at(s.middle());
      // Averages over radii are smooth functions of the wavelength with some noise, which finer steps would
      // resolve. Phase functions are the noisiest, in the glory; the absorption is noisy until it converges.
      const bool again = is_single || s.halvings < 1;
      const bool for_coefficients = estimated_absorption &&
                                    coefficient_error(a, b, c, estimated_absorption) > 1 &&
                                    (again || (a.converged && b.converged && c.converged));
      const bool for_phases = again && more_phases && phase_error(a, b, c, fraction_of(a, b, c)) > 1;
      if (for_coefficients || for_phases)
        for (const auto& [low, high] : {std::pair{s.low, s.middle()}, {s.middle(), s.high}})
          next.push_back({low, high, s.halvings + 1});
    }
    open = std::move(next);
  }
  MieSpectrum result;
  for (auto& [node, c] : found) result.coefficients.push_back(std::move(c));
  result.phase_nm = choose_phases(result.coefficients, most_phases(result.coefficients, size));
  result.estimated_absorption = std::move(estimated_absorption);
  return result;
}

optics::EnsembleAccuracy mie_accuracy(std::span<const optics::RadiusDistribution> radii, double host_index,
                                      double nm) {
  double x = 1;
  for (const optics::RadiusDistribution& r : radii) x = std::max(x, size_parameter(r, host_index, nm));
  optics::EnsembleAccuracy a;
  a.averaging = 1.5e-3, a.least_absorption = 1e-4, a.phase_averaging = 7e-3;
  // Bound of the number of radii: the cost grows as the square of the size, times the number of radii.
  a.most_radii = std::size_t(std::clamp(1e6 / x, 128.0, 4096.0));
  a.most_coefficient_radii = std::size_t(std::clamp(1e6 / x, 1024.0, 8192.0));
  a.phase.relative = 1e-2, a.phase.floor = 1e-3;
  a.phase.most_nodes = 12000;
  return a;
}

}  // namespace aureole

// SPDX-License-Identifier: Apache-2.0
#include "aureole/pigment/match_mixer.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace aureole::pigment {
namespace {

constexpr double kKept = 1e-4;  ///< a fraction above this is reduced step by step only
/// A contrast ratio that is 0.01 too low counts as a colour difference of 10.
constexpr double kContrastWeight = 1000;
/// Recipes aim at slightly more contrast than is asked for, since the penalty is met only nearly.
constexpr double kContrastMargin = 5e-4;

double squared(const std::vector<double>& v) {
  double sum = 0;
  for (const double x : v) sum += x * x;
  return sum;
}

/// Solves the n x n system a x = b by elimination; it is symmetric, and positive definite by its damping.
void solve(std::array<Shares, kMaxPaints>& a, Shares& b, std::size_t n) {
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i + 1; j < n; ++j) {
      const double f = a[j][i] / a[i][i];
      for (std::size_t l = i; l < n; ++l) a[j][l] -= f * a[i][l];
      b[j] -= f * b[i];
    }
  for (std::size_t i = n; i-- > 0;) {
    for (std::size_t l = i + 1; l < n; ++l) b[i] -= a[i][l] * b[l];
    b[i] /= a[i][i];
  }
}

/// `outer_reflectance` of `reflectance_over`, with one division and without checks: innermost loops call it.
double seen_over(const Surface& surface, const LayerTransfer& layer, double below) {
  const double open = 1 - layer.reflectance * below,
               inner = layer.reflectance * open + layer.transmittance * layer.transmittance * below;
  return surface.seen + surface.through * inner / (open - surface.k2 * inner);
}

/// Means over groups of neighbours.
std::vector<double> means(const std::vector<double>& values, std::size_t group) {
  std::vector<double> result;
  for (std::size_t i = 0; i < values.size(); i += group) {
    const std::size_t end = std::min(i + group, values.size());
    result.push_back(
        std::accumulate(values.begin() + std::ptrdiff_t(i), values.begin() + std::ptrdiff_t(end), 0.0) /
        double(end - i));
  }
  return result;
}

}  // namespace

MatchProblem grouped(const MatchProblem& problem, std::size_t group) {
  MatchProblem coarse = problem;
  coarse.palette.nm = means(problem.palette.nm, group);
  for (Pigment& p : coarse.palette.pigments) p.k = means(p.k, group), p.s = means(p.s, group);
  coarse.target.reflectance = means(problem.target.reflectance, group);
  for (Observation& lamp : coarse.lamps) lamp = lamp.grouped(group);
  if (coarse.settings.substrate.size() > 1)
    coarse.settings.substrate = means(problem.settings.substrate, group);
  return coarse;
}

Mixer::Mixer(const MatchProblem& problem)
    : problem_(problem),
      k_(problem.palette.nm.size()),
      s_(problem.palette.nm.size()),
      reflectance_(problem.palette.nm.size()) {}

void Mixer::mix(const Shares& shares) {
  std::fill(k_.begin(), k_.end(), 0.0);
  std::fill(s_.begin(), s_.end(), 0.0);
  const Palette& palette = problem_.palette;
  const std::size_t n = k_.size();
  double volume = 0;
  if (palette.by_volume)
    for (std::size_t p = 0; p < paints_.size(); ++p)
      volume += shares[p] / palette.pigments[paints_[p]].density;
  for (std::size_t p = 0; p < paints_.size(); ++p) {
    const Pigment& pigment = palette.pigments[paints_[p]];
    const double share = volume > 0 ? shares[p] / (pigment.density * volume) : shares[p];
    const double *k = pigment.k.data(), *s = pigment.s.data();
    for (std::size_t i = 0; i < n; ++i) k_[i] += share * k[i], s_[i] += share * s[i];
  }
}

const std::vector<double>& Mixer::reflectance(const Shares& shares) {
  mix(shares);
  const std::size_t n = k_.size();
  const Surface& surface = problem_.palette.surface;
  if (!std::isinf(problem_.settings.thickness)) {
    find_layers();
    const std::vector<double>& below = problem_.settings.substrate;
    for (std::size_t i = 0; i < n; ++i)
      reflectance_[i] = seen_over(surface, layers_[i], below.size() == 1 ? below[0] : below[i]);
    return reflectance_;
  }
  // R_inf = S/(K + S + gamma) under the interface, with one root and one division: this loop takes nearly
  // all of the time.
  constexpr double kTiny = 1e-300;  // avoids 0/0 for a paint with K = S = 0
  for (std::size_t i = 0; i < n; ++i) {
    const double k = k_[i], s = s_[i];
    reflectance_[i] =
        surface.seen + surface.through * s / (k + std::sqrt(k * (k + 2 * s)) + (1 - surface.k2) * s + kTiny);
  }
  return reflectance_;
}

void Mixer::find_layers() {
  layers_.resize(k_.size());
  for (std::size_t i = 0; i < k_.size(); ++i) layers_[i] = layer({k_[i], s_[i]}, problem_.settings.thickness);
}

double Mixer::contrast(const Shares& shares) {
  if (std::isinf(problem_.settings.thickness)) return 1;
  mix(shares), find_layers();
  return contrast_of_layers();
}

double Mixer::contrast_of_layers() {
  const Surface& surface = problem_.palette.surface;
  double over_black = 0, over_white = 0;
  for (std::size_t i = 0; i < layers_.size(); ++i) {
    const double weight = problem_.lamps.front().weights()[i][1];
    over_black += weight * seen_over(surface, layers_[i], 0);
    over_white += weight * seen_over(surface, layers_[i], problem_.settings.white_below);
  }
  return over_white > 0 ? over_black / over_white : 1;
}

const std::vector<double>& Mixer::residual(const Shares& shares) {
  const MatchSettings& settings = problem_.settings;
  const MatchTarget& target = problem_.target;
  residual_.clear();
  const std::vector<double>& r = reflectance(shares);
  if (settings.least_contrast > 0)
    residual_.push_back(kContrastWeight *
                        std::max(settings.least_contrast + kContrastMargin - contrast_of_layers(), 0.0));
  if (settings.by == MatchBy::spectrum) {
    const double scale = 100 / std::sqrt(double(r.size()));
    for (std::size_t i = 0; i < r.size(); ++i) residual_.push_back(scale * (r[i] - target.reflectance[i]));
    return residual_;
  }
  const std::size_t lamps = settings.by == MatchBy::lamps ? problem_.lamps.size() : 1;
  for (std::size_t l = 0; l < lamps; ++l) {
    const Observation& lamp = problem_.lamps[l];
    for (const double v :
         ciede2000_components(l == 0 ? target.lab : lamp.lab(target.reflectance), lamp.lab(r)))
      residual_.push_back(v);
  }
  return residual_;
}

double Mixer::value(const Shares& shares) { return squared(residual(shares)); }

Shares Mixer::projected(const Shares& shares) const {
  const std::size_t n = size();
  const auto moved = [&](double by) {
    Shares result{};
    for (std::size_t i = 0; i < n; ++i) result[i] = std::clamp(shares[i] + by, least(i), most(i));
    return result;
  };
  double sum = 0;
  bool inside = true;
  for (std::size_t i = 0; i < n; ++i)
    sum += shares[i], inside = inside && shares[i] >= least(i) && shares[i] <= most(i);
  if (inside && std::abs(sum - 1) < 1e-13) return shares;
  double low = -2, high = 2;
  for (int step = 0; step < 60; ++step) {
    const double middle = 0.5 * (low + high);
    const Shares s = moved(middle);
    (std::accumulate(s.begin(), s.begin() + std::ptrdiff_t(n), 0.0) < 1 ? low : high) = middle;
  }
  return moved(high);
}

/// The largest fraction is the remainder of the others. A fraction at its bound that would cross it is fixed.
double Mixer::descend(Shares& shares) {
  const std::size_t n = size();
  here_ = residual(shares);
  double value = squared(here_), damping = 1e-3;
  const std::size_t m = here_.size();
  for (int step = 0; step < 60 && value > 1e-18; ++step) {
    const std::size_t rest =
        std::size_t(std::max_element(shares.begin(), shares.begin() + std::ptrdiff_t(n)) - shares.begin());
    slopes_.assign(m * n, 0);
    std::array<std::size_t, kMaxPaints> free{};
    std::size_t count = 0;
    for (std::size_t i = 0; i < n; ++i) {
      if (i == rest) continue;
      const double h = 1e-7 + 1e-5 * shares[i];
      Shares there = shares;
      there[i] += h, there[rest] -= h;
      const std::vector<double>& other = residual(there);
      double gradient = 0;
      for (std::size_t c = 0; c < m; ++c) {
        slopes_[i * m + c] = (other[c] - here_[c]) / h;
        gradient += slopes_[i * m + c] * here_[c];
      }
      if ((gradient > 0 && shares[i] <= least(i)) || (gradient < 0 && shares[i] >= most(i))) continue;
      free[count++] = i;
    }
    if (count == 0) break;
    bool better = false;
    for (int attempt = 0; attempt < 12 && !better; ++attempt) {
      std::array<Shares, kMaxPaints> normal{};
      Shares move{};
      for (std::size_t i = 0; i < count; ++i) {
        const double* of_i = slopes_.data() + free[i] * m;
        for (std::size_t c = 0; c < m; ++c) move[i] -= of_i[c] * here_[c];
        for (std::size_t j = 0; j < count; ++j) {
          const double* of_j = slopes_.data() + free[j] * m;
          for (std::size_t c = 0; c < m; ++c) normal[i][j] += of_i[c] * of_j[c];
        }
        normal[i][i] = normal[i][i] * (1 + damping) + 1e-30;
      }
      solve(normal, move, count);
      Shares next = shares;
      for (std::size_t i = 0; i < count; ++i) {
        // A step may reduce a fraction by at most nine tenths, because colour depends on fractions of strong
        // paints logarithmically.
        const double share = shares[free[i]], to = std::max(share + move[i], share > kKept ? 0.1 * share : 0);
        next[free[i]] = to;
        next[rest] -= to - share;
      }
      next = projected(next);
      const std::vector<double>& there = residual(next);
      const double reached = squared(there);
      if (reached < value) {
        better = value - reached > 1e-10 * value;
        shares = next, here_ = there, value = reached, damping = std::max(0.2 * damping, 1e-9);
        if (!better) return value;
      } else {
        damping *= 6;
      }
    }
    if (!better) break;
  }
  return value;
}

/// A coarse grid of ratios, and descents from its three best points.
Shares Mixer::best() {
  const std::size_t n = size();
  constexpr double kRatios[] = {0.02, 0.15, 1};
  std::vector<std::pair<double, Shares>> starts;
  const int grid = int(std::lround(std::pow(3, n)));
  for (int code = 0; code < grid; ++code) {
    Shares shares{};
    double largest = 0, sum = 0;
    for (std::size_t i = 0, rest = std::size_t(code); i < n; ++i, rest /= 3)
      shares[i] = kRatios[rest % 3], largest = std::max(largest, shares[i]), sum += shares[i];
    if (largest < 1) continue;  // these ratios occur again with larger values
    for (std::size_t i = 0; i < n; ++i) shares[i] /= sum;
    shares = projected(shares);
    starts.emplace_back(value(shares), shares);
  }
  const std::size_t kept = std::min<std::size_t>(3, starts.size());
  std::partial_sort(starts.begin(), starts.begin() + std::ptrdiff_t(kept), starts.end(),
                    [](const auto& a, const auto& b) { return a.first < b.first; });
  if (n == 1) return starts[0].second;
  for (std::size_t i = 0; i < kept; ++i) starts[i].first = descend(starts[i].second);
  return std::min_element(starts.begin(), starts.begin() + std::ptrdiff_t(kept),
                          [](const auto& a, const auto& b) { return a.first < b.first; })
      ->second;
}

}  // namespace aureole::pigment

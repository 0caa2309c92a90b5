// SPDX-License-Identifier: Apache-2.0
#include "aureole/pigment/match.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <tuple>

#include "aureole/pigment/domain.h"

namespace aureole::pigment {
namespace {

constexpr double kNegligible = 1e-4;  ///< fraction below which a paint is dropped from a recipe
constexpr int kMaxPaints = 6;
using Triple = std::array<double, 3>;
using Shares = std::array<double, kMaxPaints>;

double squared(const Triple& v) { return v[0] * v[0] + v[1] * v[1] + v[2] * v[2]; }

/// The bounds of a problem, one entry per pigment.
struct Bounds {
  std::vector<double> least, most;
};

/// Mixtures of some paints of a palette, used by one thread.
class Mixer {
public:
  Mixer(const Palette& palette, const MatchSettings& settings, const Observation& lamp, const Lab& target)
      : palette_(palette),
        settings_(settings),
        lamp_(lamp),
        target_(target),
        k_(palette.nm.size()),
        s_(palette.nm.size()),
        reflectance_(palette.nm.size()) {}

  void choose(std::vector<std::size_t> paints) { paints_ = std::move(paints); }
  std::size_t size() const { return paints_.size(); }
  std::size_t paint(std::size_t i) const { return paints_[i]; }

  const std::vector<double>& reflectance(const Shares& shares) {
    std::fill(k_.begin(), k_.end(), 0.0);
    std::fill(s_.begin(), s_.end(), 0.0);
    const std::size_t n = k_.size();
    double volume = 0;
    if (palette_.by_volume)
      for (std::size_t p = 0; p < paints_.size(); ++p)
        volume += shares[p] / palette_.pigments[paints_[p]].density;
    for (std::size_t p = 0; p < paints_.size(); ++p) {
      const double share =
          volume > 0 ? shares[p] / (palette_.pigments[paints_[p]].density * volume) : shares[p];
      const double *k = palette_.pigments[paints_[p]].k.data(), *s = palette_.pigments[paints_[p]].s.data();
      for (std::size_t i = 0; i < n; ++i) k_[i] += share * k[i], s_[i] += share * s[i];
    }
    if (!std::isinf(settings_.thickness)) {
      Paint paint(n);
      for (std::size_t i = 0; i < n; ++i) paint[i] = {k_[i], s_[i]};
      reflectance_ = paint_reflectance(paint, settings_.thickness, settings_.substrate, palette_.surface);
      return reflectance_;
    }
    // R_inf = S/(K + S + gamma) under the interface, with one root and one division: this loop takes nearly
    // all of the time.
    const Surface& surface = palette_.surface;
    constexpr double kTiny = 1e-300;  // avoids 0/0 for a paint with K = S = 0
    for (std::size_t i = 0; i < n; ++i) {
      const double k = k_[i], s = s_[i];
      reflectance_[i] = surface.seen +
                        surface.through * s / (k + std::sqrt(k * (k + 2 * s)) + (1 - surface.k2) * s + kTiny);
    }
    return reflectance_;
  }
  Lab lab(const Shares& shares) { return lamp_.lab(reflectance(shares)); }
  Triple residual(const Shares& shares) { return ciede2000_components(target_, lab(shares)); }

private:
  const Palette& palette_;
  const MatchSettings& settings_;
  const Observation& lamp_;
  const Lab& target_;
  std::vector<std::size_t> paints_;
  std::vector<double> k_, s_, reflectance_;
};

/// Projects fractions onto the bounds and the sum of one: all are shifted by an equal amount and clamped.
Shares projected(const Shares& shares, const Mixer& mixer, const Bounds& bounds) {
  const std::size_t n = mixer.size();
  const auto moved = [&](double by) {
    Shares result{};
    for (std::size_t i = 0; i < n; ++i)
      result[i] = std::clamp(shares[i] + by, bounds.least[mixer.paint(i)], bounds.most[mixer.paint(i)]);
    return result;
  };
  double low = -2, high = 2;
  for (int step = 0; step < 60; ++step) {
    const double middle = 0.5 * (low + high);
    const Shares s = moved(middle);
    (std::accumulate(s.begin(), s.begin() + std::ptrdiff_t(n), 0.0) < 1 ? low : high) = middle;
  }
  return moved(high);
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

/// Levenberg-Marquardt method on the simplex: the largest fraction is the remainder of the others. A fraction
/// at its bound that would cross it is fixed.
double descend(Mixer& mixer, const Bounds& bounds, Shares& shares) {
  const std::size_t n = mixer.size();
  Triple r = mixer.residual(shares);
  double value = squared(r), damping = 1e-3;
  for (int step = 0; step < 60 && value > 1e-18; ++step) {
    const std::size_t rest =
        std::size_t(std::max_element(shares.begin(), shares.begin() + std::ptrdiff_t(n)) - shares.begin());
    std::array<Triple, kMaxPaints> slope{};
    std::array<std::size_t, kMaxPaints> free{};
    std::size_t count = 0;
    for (std::size_t i = 0; i < n; ++i) {
      if (i == rest) continue;
      const double h = 1e-7 + 1e-5 * shares[i];
      Shares there = shares;
      there[i] += h, there[rest] -= h;
      const Triple other = mixer.residual(there);
      double gradient = 0;
      for (std::size_t c = 0; c < 3; ++c) slope[i][c] = (other[c] - r[c]) / h, gradient += slope[i][c] * r[c];
      const double least = bounds.least[mixer.paint(i)], most = bounds.most[mixer.paint(i)];
      if ((gradient > 0 && shares[i] <= least) || (gradient < 0 && shares[i] >= most)) continue;
      free[count++] = i;
    }
    if (count == 0) break;
    bool better = false;
    for (int attempt = 0; attempt < 12 && !better; ++attempt) {
      std::array<Shares, kMaxPaints> normal{};
      Shares move{};
      for (std::size_t i = 0; i < count; ++i) {
        for (std::size_t c = 0; c < 3; ++c) move[i] -= slope[free[i]][c] * r[c];
        for (std::size_t j = 0; j < count; ++j)
          for (std::size_t c = 0; c < 3; ++c) normal[i][j] += slope[free[i]][c] * slope[free[j]][c];
        normal[i][i] = normal[i][i] * (1 + damping) + 1e-30;
      }
      solve(normal, move, count);
      Shares next = shares;
      for (std::size_t i = 0; i < count; ++i) {
        // A step may reduce a fraction by at most nine tenths, because colour depends on fractions of strong
        // paints logarithmically.
        const double share = shares[free[i]],
                     to = std::max(share + move[i], share > kNegligible ? 0.1 * share : 0);
        next[free[i]] = to;
        next[rest] -= to - share;
      }
      next = projected(next, mixer, bounds);
      const Triple there = mixer.residual(next);
      if (squared(there) < value) {
        better = value - squared(there) > 1e-10 * value;
        shares = next, r = there, value = squared(there), damping = std::max(0.2 * damping, 1e-9);
        if (!better) return value;
      } else {
        damping *= 6;
      }
    }
    if (!better) break;
  }
  return value;
}

/// The best fractions of the chosen paints: a coarse grid of ratios, and descents from its three best points.
Shares best_shares(Mixer& mixer, const Bounds& bounds) {
  const std::size_t n = mixer.size();
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
    shares = projected(shares, mixer, bounds);
    starts.emplace_back(squared(mixer.residual(shares)), shares);
  }
  const std::size_t kept = std::min<std::size_t>(3, starts.size());
  std::partial_sort(starts.begin(), starts.begin() + std::ptrdiff_t(kept), starts.end(),
                    [](const auto& a, const auto& b) { return a.first < b.first; });
  if (n == 1) return starts[0].second;
  for (std::size_t i = 0; i < kept; ++i) starts[i].first = descend(mixer, bounds, starts[i].second);
  return std::min_element(starts.begin(), starts.begin() + std::ptrdiff_t(kept),
                          [](const auto& a, const auto& b) { return a.first < b.first; })
      ->second;
}

Bounds checked_bounds(const Palette& palette, const MatchSettings& settings) {
  const std::size_t n = palette.pigments.size();
  Bounds b{settings.least, settings.most};
  if (b.least.empty()) b.least.assign(n, 0);
  if (b.most.empty()) b.most.assign(n, 1);
  if (b.least.size() != n || b.most.size() != n)
    throw std::domain_error("bounds need a number for each pigment");
  double sum = 0;
  int needed = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const std::string& name = palette.pigments[i].name;
    require_fraction(b.least[i], ("least share of \"" + name + "\"").c_str());
    require_fraction(b.most[i], ("largest share of \"" + name + "\"").c_str());
    require(b.least[i] <= b.most[i], b.least[i], "least share of \"" + name + "\"",
            "must not exceed the largest");
    sum += b.least[i], needed += b.least[i] > 0;
  }
  require(sum <= 1, sum, "sum of the least shares", "must not exceed 1");
  require(needed <= settings.max_paints, needed, "number of paints with a least share",
          "must not exceed the number of paints");
  return b;
}

/// All sets of 1 to `most` paints that the bounds allow.
std::vector<std::vector<std::size_t>> paint_sets(const Bounds& bounds, int most) {
  const std::size_t n = bounds.least.size();
  if (n > 24)
    throw std::domain_error("a palette to match with has at most 24 paints, got " + std::to_string(n));
  std::vector<std::vector<std::size_t>> sets;
  for (std::uint32_t mask = 1; mask < (1u << n); ++mask) {
    if (std::popcount(mask) > most) continue;
    std::vector<std::size_t> set;
    double least = 0, largest = 0;
    bool complete = true;
    for (std::size_t i = 0; i < n; ++i) {
      if (mask >> i & 1)
        set.push_back(i), least += bounds.least[i], largest += bounds.most[i];
      else
        complete = complete && bounds.least[i] == 0;
    }
    if (complete && least <= 1 && largest >= 1) sets.push_back(std::move(set));
  }
  if (sets.empty())
    throw std::domain_error("no recipe keeps the bounds: the largest shares of the paints do not sum to 1");
  return sets;
}

}  // namespace

std::vector<Match> match(const Palette& original, const MatchTarget& target, const Observation& lamp,
                         std::span<const Observation> others, const MatchSettings& settings,
                         const ParallelFor& parallel_for) {
  Palette palette = original;
  check(palette);
  clamp_negative(palette);
  require(settings.max_paints >= 1 && settings.max_paints <= kMaxPaints, settings.max_paints,
          "number of paints", "must be from 1 to 6");
  require(settings.solutions >= 1, settings.solutions, "number of solutions", "must be positive");
  const bool spectral = !target.reflectance.empty();
  if (spectral && target.reflectance.size() != palette.nm.size())
    throw std::domain_error("the target needs a reflectance for each wavelength of the palette");
  const Bounds bounds = checked_bounds(palette, settings);
  const auto sets = paint_sets(bounds, settings.max_paints);

  std::vector<Shares> found(sets.size());
  std::vector<double> differences(sets.size());
  parallel_for(
      sets.size(),
      [&](std::size_t begin, std::size_t end) {
        Mixer mixer(palette, settings, lamp, target.lab);
        for (std::size_t i = begin; i < end; ++i) {
          mixer.choose(sets[i]);
          found[i] = best_shares(mixer, bounds);
          differences[i] = std::sqrt(squared(mixer.residual(found[i])));
        }
      },
      8);

  std::vector<Match> matches;
  Mixer mixer(palette, settings, lamp, target.lab);
  for (std::size_t i = 0; i < sets.size(); ++i) {
    // Skips a set with a paint that is not needed: a smaller set has this recipe.
    bool minimal = true;
    for (std::size_t p = 0; p < sets[i].size(); ++p)
      minimal = minimal && (found[i][p] >= kNegligible || bounds.least[sets[i][p]] > 0);
    if (!minimal) continue;
    mixer.choose(sets[i]);
    Match& m = matches.emplace_back();
    m.fractions.resize(palette.pigments.size());
    for (std::size_t p = 0; p < sets[i].size(); ++p) m.fractions[sets[i][p]] = found[i][p];
    m.reflectance = mixer.reflectance(found[i]);
    m.lab = lamp.lab(m.reflectance);
    m.difference = differences[i];
    if (!spectral) continue;
    for (const Observation& other : others)
      m.differences.push_back(ciede2000(other.lab(target.reflectance), other.lab(m.reflectance)));
    double squares = 0;
    for (std::size_t l = 0; l < palette.nm.size(); ++l)
      squares += std::pow(m.reflectance[l] - target.reflectance[l], 2);
    m.rms = std::sqrt(squares / double(palette.nm.size()));
  }
  const auto order = [](const Match& m) {
    const double worst =
        m.differences.empty() ? 0 : *std::max_element(m.differences.begin(), m.differences.end());
    return std::tuple(std::floor(m.difference / 0.005), worst,
                      std::count_if(m.fractions.begin(), m.fractions.end(), [](double f) { return f > 0; }),
                      m.difference);
  };
  std::sort(matches.begin(), matches.end(),
            [&](const Match& a, const Match& b) { return order(a) < order(b); });
  if (matches.size() > std::size_t(settings.solutions)) matches.resize(std::size_t(settings.solutions));
  return matches;
}

}  // namespace aureole::pigment

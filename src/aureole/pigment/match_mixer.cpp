// SPDX-License-Identifier: Apache-2.0
#include "aureole/pigment/match_mixer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "aureole/pigment/streams_mixture.h"

namespace aureole::pigment {
namespace {

constexpr double kKept = 1e-4;  ///< fractions below this may be reduced to zero by one step
/// First weight of a lack of contrast: 0.01 too little counts as a colour difference of 10.
constexpr double kContrastWeight = 1000;
/// Tolerance of the least contrast ratio.
constexpr double kContrastError = 1e-8;

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

/// Light of a layer of two fluxes under an interface (`FilmLight`), without checks: innermost loops call it.
FilmLight two_flux_light(const Surface& surface, const LayerTransfer& layer) {
  const double open = 1 / (1 - surface.k2 * layer.reflectance),
               pass = layer.transmittance * layer.transmittance * open;
  return {surface.seen + surface.through * layer.reflectance * open, surface.through * pass * open,
          layer.reflectance + surface.k2 * pass};
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
      g_shift_(problem.palette.nm.size()),
      reflectance_(problem.palette.nm.size()) {
  for (const Pigment& p : problem.palette.pigments) has_g_ = has_g_ || (problem.theory && p.g);
}

void Mixer::choose(std::vector<std::size_t> paints) {
  paints_ = std::move(paints);
  for (std::size_t i = 0; i < size(); ++i)
    low_[i] = problem_.settings.least[paints_[i]], high_[i] = problem_.settings.most[paints_[i]];
  limit_ = problem_.settings.least_contrast, largest_contrast_ = 0, has_opaque_ = false;
}

bool Mixer::bound(std::size_t i, double least, double most) {
  low_[i] = least, high_[i] = most, has_opaque_ = false, largest_contrast_ = 0;
  double sum_low = 0, sum_high = 0;
  for (std::size_t p = 0; p < size(); ++p) sum_low += low_[p], sum_high += high_[p];
  return least <= most && sum_low <= 1 && sum_high >= 1;
}

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
  if (!has_g_) return;
  // As `g_shifts`: sigma_s, proportional to S/(1 - g), add up like S.
  std::fill(g_shift_.begin(), g_shift_.end(), 0.0);
  for (std::size_t p = 0; p < paints_.size(); ++p) {
    const Pigment& pigment = palette.pigments[paints_[p]];
    const double share = (volume > 0 ? shares[p] / (pigment.density * volume) : shares[p]) *
                         (pigment.g ? (1 - palette.streams->g) / (1 - *pigment.g) : 1);
    for (std::size_t i = 0; i < n; ++i) g_shift_[i] += share * pigment.s[i];
  }
  for (std::size_t i = 0; i < n; ++i)
    g_shift_[i] = g_shift_[i] > 0 && s_[i] > 0 ? std::log(s_[i] / g_shift_[i]) : 0;
}

const std::vector<double>& Mixer::reflectance(const Shares& shares) {
  mix(shares);
  const std::size_t n = k_.size();
  const Surface& surface = problem_.palette.surface;
  if (!std::isinf(problem_.settings.thickness)) {
    find_layers();
    const std::vector<double>& below = problem_.settings.substrate;
    for (std::size_t i = 0; i < n; ++i)
      reflectance_[i] = layers_[i].over(below.size() == 1 ? below[0] : below[i]);
    return reflectance_;
  }
  if (problem_.opaque) {
    const OpaqueReflectance& opaque = *problem_.opaque;
    for (std::size_t i = 0; i < n; ++i) reflectance_[i] = opaque(k_[i], s_[i]);
    return reflectance_;
  }
  if (problem_.theory) {
    constexpr double kLeast = 1e-12;  // as `light_of`
    for (std::size_t i = 0; i < n; ++i)
      reflectance_[i] = problem_.theory->opaque_value(
          {std::log(std::max(k_[i], kLeast) / std::max(s_[i], kLeast)), 0, g_shift_[i]});
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
  const double thickness = problem_.settings.thickness;
  for (std::size_t i = 0; i < k_.size(); ++i)
    layers_[i] = problem_.theory ? light_of(*problem_.theory, {k_[i], s_[i]}, g_shift_[i], thickness)
                                 : two_flux_light(problem_.palette.surface, layer({k_[i], s_[i]}, thickness));
}

double Mixer::contrast(const Shares& shares) {
  if (std::isinf(problem_.settings.thickness)) return 1;
  mix(shares), find_layers();
  return contrast_of_layers();
}

double Mixer::contrast_of_layers() {
  double over_black = 0, over_white = 0;
  for (std::size_t i = 0; i < layers_.size(); ++i) {
    const double weight = problem_.lamps.front().weights()[i][1];
    over_black += weight * layers_[i].over(0);
    over_white += weight * layers_[i].over(problem_.settings.white_below);
  }
  return over_white > 0 ? over_black / over_white : 1;
}

const std::vector<double>& Mixer::residual(const Shares& shares) {
  const MatchSettings& settings = problem_.settings;
  const MatchTarget& target = problem_.target;
  residual_.clear();
  if (aim_ == Aim::contrast) {
    residual_.push_back(1 - contrast(shares));
    return residual_;
  }
  const std::vector<double>& r = reflectance(shares);
  if (aim_ == Aim::hiding_colour)
    residual_.push_back(weight_ * std::max(limit_ + shift_ - contrast_of_layers(), 0.0));
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
  Shares part{}, result{};
  for (std::size_t i = 0; i < n; ++i) part[i] = std::max(shares[i] - low_[i], 1e-15);
  std::array<bool, kMaxPaints> full{};
  for (std::size_t round = 0; round <= n; ++round) {
    double left = 1, parts = 0;
    for (std::size_t i = 0; i < n; ++i) left -= full[i] ? high_[i] : low_[i], parts += full[i] ? 0 : part[i];
    bool again = false;
    for (std::size_t i = 0; i < n; ++i) {
      if (full[i]) continue;
      result[i] = low_[i] + std::max(left, 0.0) * part[i] / parts;
      if (result[i] >= high_[i]) result[i] = high_[i], full[i] = again = true;
    }
    if (!again) break;
  }
  return result;
}

/// Fractions that would cross their bounds are set to these, and the equations are solved again for the other ones.
Shares Mixer::stepped(const Shares& shares, const Shares& slope, const std::array<Shares, kMaxPaints>& normal,
                      std::array<bool, kMaxPaints> free, std::size_t rest, double damping) const {
  const std::size_t n = size();
  Shares moves{};
  for (std::size_t round = 0; round < n; ++round) {
    std::array<std::size_t, kMaxPaints> of{};
    std::array<Shares, kMaxPaints> a{};
    Shares b{};
    std::size_t count = 0;
    for (std::size_t i = 0; i < n; ++i)
      if (free[i]) of[count++] = i;
    if (count == 0) break;
    for (std::size_t i = 0; i < count; ++i) {
      b[i] = -slope[of[i]];
      for (std::size_t j = 0; j < n; ++j)
        if (!free[j]) b[i] -= normal[of[i]][j] * moves[j];
      for (std::size_t j = 0; j < count; ++j) a[i][j] = normal[of[i]][of[j]];
      a[i][i] = a[i][i] * (1 + damping) + 1e-30;
    }
    solve(a, b, count);
    bool again = false;
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t p = of[i];
      // A step may reduce a fraction by at most nine tenths, because colour depends on fractions of strong paints
      // logarithmically.
      const double share = shares[p], floor = std::max(low_[p], share > kKept ? 0.1 * share : 0);
      moves[p] = b[i];
      if (share + b[i] < floor)
        moves[p] = floor - share, again = true, free[p] = false;
      else if (share + b[i] > high_[p])
        moves[p] = high_[p] - share, again = true, free[p] = false;
    }
    if (!again) break;
  }
  double sum = 0;
  for (std::size_t i = 0; i < n; ++i)
    if (i != rest) sum += moves[i];
  // The whole step is shortened if the remainder would cross its bound.
  double scale = 1;
  const double floor = std::max(low_[rest], shares[rest] > kKept ? 0.1 * shares[rest] : 0);
  if (shares[rest] - sum < floor)
    scale = (shares[rest] - floor) / sum;
  else if (shares[rest] - sum > high_[rest])
    scale = (shares[rest] - high_[rest]) / sum;
  Shares next = shares;
  double others = 0;
  for (std::size_t i = 0; i < n; ++i)
    if (i != rest) {
      next[i] = std::clamp(shares[i] + scale * moves[i], low_[i], high_[i]);
      others += next[i];
    }
  next[rest] = std::clamp(1 - others, low_[rest], high_[rest]);
  return next;
}

/// The largest fraction between its bounds is the remainder of the others. A fraction at its bound that would cross it
/// is fixed. If all are at bounds, the remainder is the fraction that gains most by leaving its bound.
double Mixer::descend(Shares& shares, int most_steps) {
  const std::size_t n = size();
  here_ = residual(shares);
  double value = squared(here_), damping = 1e-3;
  const std::size_t m = here_.size();
  for (int step = 0; step < most_steps && value > 1e-18; ++step) {
    std::size_t rest = n, largest = 0;
    for (std::size_t i = 0; i < n; ++i) {
      if (shares[i] > shares[largest]) largest = i;
      if (shares[i] > low_[i] && shares[i] < high_[i] && (rest == n || shares[i] > shares[rest])) rest = i;
    }
    const bool at_corner = rest == n;
    if (at_corner) rest = largest;
    slopes_.assign(m * n, 0);
    Shares slope{};
    for (std::size_t i = 0; i < n; ++i) {
      if (i == rest) continue;
      double h = 1e-7 + 1e-5 * shares[i];
      if (shares[rest] < h) h = shares[i] > h ? -h : shares[rest];
      if (h == 0) continue;
      Shares there = shares;
      there[i] += h, there[rest] -= h;
      const std::vector<double>& other = residual(there);
      for (std::size_t c = 0; c < m; ++c) {
        slopes_[i * m + c] = (other[c] - here_[c]) / h;
        slope[i] += slopes_[i * m + c] * here_[c];
      }
    }
    if (at_corner) {
      std::size_t up = n, down = n;
      for (std::size_t i = 0; i < n; ++i) {
        if (shares[i] < high_[i] && (up == n || slope[i] < slope[up])) up = i;
        if (shares[i] > low_[i] && (down == n || slope[i] > slope[down])) down = i;
      }
      if (up == n || down == n || !(slope[up] < slope[down])) break;
      if (down != rest) {
        for (std::size_t i = 0; i < n; ++i) {
          if (i == down) continue;
          slope[i] -= slope[down];
          for (std::size_t c = 0; c < m; ++c) slopes_[i * m + c] -= slopes_[down * m + c];
        }
        slope[down] = 0;
        std::fill_n(slopes_.begin() + std::ptrdiff_t(down * m), m, 0.0);
        rest = down;
      }
    }
    std::array<bool, kMaxPaints> free{};
    bool any = false;
    for (std::size_t i = 0; i < n; ++i) {
      if (i == rest || (slope[i] >= 0 && shares[i] <= low_[i]) || (slope[i] <= 0 && shares[i] >= high_[i]))
        continue;
      free[i] = any = true;
    }
    if (!any) break;
    std::array<Shares, kMaxPaints> normal{};
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j)
        for (std::size_t c = 0; c < m; ++c) normal[i][j] += slopes_[i * m + c] * slopes_[j * m + c];
    bool better = false;
    for (int attempt = 0; attempt < 12 && !better; ++attempt) {
      const Shares next = stepped(shares, slope, normal, free, rest, damping);
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

Shares Mixer::hiding(const Shares& shares, double error) {
  if (hides(shares) || !find_opaque()) return shares;
  const auto between = [&](double t) {
    Shares s{};
    for (std::size_t i = 0; i < size(); ++i)
      s[i] = std::clamp(shares[i] + t * (opaque_[i] - shares[i]), low_[i], high_[i]);
    return s;
  };
  // Tries shares near the given ones first, which are often almost a match.
  double low = 0, high = 1;
  for (double t = 1e-6; t < 1 && error < 1e-3; t *= 30)
    if (hides(between(t))) {
      high = t;
      break;
    } else {
      low = t;
    }
  for (int step = 0; step < 40 && high - low > error * high; ++step) {
    const double middle = 0.5 * (low + high);
    (hides(between(middle)) ? high : low) = middle;
  }
  return high < 1 ? between(high) : opaque_;
}

double Mixer::descend_hiding(Shares& shares) {
  aim_ = Aim::hiding_colour, weight_ = kContrastWeight, shift_ = 0;
  double last = kNoRecipe;
  for (int round = 0; round < 15; ++round) {
    descend(shares, 15);
    const double lack = limit_ - contrast(shares);
    if (lack < kContrastError && (shift_ == 0 || lack > -10 * kContrastError)) break;
    shift_ = std::max(0.0, shift_ + lack);
    if (std::abs(lack) > 0.25 * last) weight_ *= 2, shift_ *= 0.25;
    last = std::abs(lack);
  }
  aim_ = Aim::colour;
  shares = hiding(shares);
  return value(shares);
}

std::vector<Shares> Mixer::grid() const {
  const std::size_t n = size();
  constexpr double kRatios[] = {0.02, 0.15, 1};
  std::vector<Shares> points;
  const int codes = int(std::lround(std::pow(3, n)));
  for (int code = 0; code < codes; ++code) {
    Shares shares{};
    double largest = 0, sum = 0;
    for (std::size_t i = 0, rest = std::size_t(code); i < n; ++i, rest /= 3)
      shares[i] = kRatios[rest % 3], largest = std::max(largest, shares[i]), sum += shares[i];
    if (largest < 1) continue;  // larger values with these ratios follow later in the grid
    for (std::size_t i = 0; i < n; ++i) shares[i] = low_[i] + shares[i] / sum;
    points.push_back(projected(shares));
  }
  return points;
}

/// The point of the grid and of the corners with the largest contrast ratio, and a descent from the two best if that
/// one is below the limit.
bool Mixer::find_opaque() {
  if (has_opaque_) return largest_contrast_ >= limit_;
  std::vector<std::pair<double, Shares>> points;
  for (const Shares& s : grid()) points.emplace_back(-contrast(s), s);
  for (std::size_t i = 0; i < size(); ++i) {
    Shares s = low_;
    s[i] += 1;
    s = projected(s);
    points.emplace_back(-contrast(s), s);
  }
  const auto less = [](const auto& a, const auto& b) { return a.first < b.first; };
  const std::size_t kept = std::min<std::size_t>(2, points.size());
  std::partial_sort(points.begin(), points.begin() + std::ptrdiff_t(kept), points.end(), less);
  if (-points[0].first < limit_) {
    aim_ = Aim::contrast;
    for (std::size_t i = 0; i < kept; ++i)
      descend(points[i].second), points[i].first = -contrast(points[i].second);
    aim_ = Aim::colour;
    if (points[kept - 1].first < points[0].first) std::swap(points[0], points[kept - 1]);
  }
  opaque_ = points[0].second, largest_contrast_ = -points[0].first, has_opaque_ = true;
  if (largest_contrast_ < limit_ && largest_contrast_ > limit_ - problem_.contrast_slack)
    limit_ = largest_contrast_ - 1e-6;
  return largest_contrast_ >= limit_;
}

/// Descents from the three best points of a coarse grid. If the best recipe hides too little, further descents at the
/// least contrast ratio begin from the recipe that hides best, and where the lines to it from the best recipe and from
/// the points of the grid reach the least contrast ratio.
double Mixer::best_of_grid(Shares& shares) {
  const std::size_t n = size();
  std::vector<std::pair<double, Shares>> starts;
  const std::vector<Shares> points = grid();
  const auto less = [](const auto& a, const auto& b) { return a.first < b.first; };
  const auto keep = [&](std::size_t count) {
    const std::size_t kept = std::min(count, starts.size());
    std::partial_sort(starts.begin(), starts.begin() + std::ptrdiff_t(kept), starts.end(), less);
    starts.resize(kept);
  };
  for (const Shares& s : points) starts.emplace_back(value(s), s);
  keep(3);
  if (n > 1)
    for (auto& [reached, s] : starts) reached = descend(s);
  const auto best = std::min_element(starts.begin(), starts.end(), less);
  shares = best->second;
  if (hides(shares)) return best->first;
  if (!find_opaque()) return kNoRecipe;
  if (hides(shares)) return best->first;
  starts.clear();
  for (const Shares& s : points) {
    const Shares there = hiding(s, 0.1);
    starts.emplace_back(value(there), there);
  }
  keep(2);
  const Shares nearest = hiding(shares);
  starts.emplace_back(0, nearest), starts.emplace_back(0, opaque_);
  double reached = kNoRecipe;
  for (auto& [_, s] : starts)
    if (const double there = n > 1 ? descend_hiding(s) : value(s); there < reached)
      reached = there, shares = s;
  return reached;
}

double Mixer::best(Shares& shares) {
  double reached = best_of_grid(shares);
  if (size() == 1 || reached == kNoRecipe) return reached;
  const Shares low = low_, high = high_, found = shares;
  const double largest = largest_contrast_;
  for (std::size_t i = 0; i < size(); ++i) {
    const bool at_low = low[i] > 0 && found[i] <= low[i] + 1e-9,
               at_high = high[i] < 1 && found[i] >= high[i] - 1e-9;
    if (low[i] == high[i] || (!at_low && !at_high)) continue;
    low_ = low, high_ = high;
    const double fixed = at_low ? low[i] : high[i];
    if (!bound(i, fixed, fixed)) continue;
    Shares there{};
    if (const double value = best_of_grid(there); value < reached) reached = value, shares = there;
  }
  low_ = low, high_ = high, largest_contrast_ = largest, has_opaque_ = false;
  return reached;
}

double Mixer::refine(Shares& shares) {
  Shares there = shares;
  const double reached = descend(there);
  if (hides(there)) {
    shares = there;
    return reached;
  }
  if (!find_opaque()) return kNoRecipe;
  there = hiding(there), shares = hiding(shares);
  const double one = descend_hiding(shares), other = descend_hiding(there);
  if (other < one) shares = there;
  return std::min(one, other);
}

}  // namespace aureole::pigment

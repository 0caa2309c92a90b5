// SPDX-License-Identifier: Apache-2.0
#include "aureole/pigment/match.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <tuple>
#include <unordered_map>

#include "aureole/pigment/domain.h"
#include "aureole/pigment/match_mixer.h"
#include "aureole/pigment/streams_mixture.h"

namespace aureole::pigment {
namespace {

/// Up to this number of sets every set is tried from all starting points.
constexpr std::size_t kExhaustive = 1200;
/// More sets are first tried at groups of wavelengths for layers with a thickness, which take ten times as long.
constexpr std::size_t kExhaustiveFilms = 120;
constexpr std::size_t kMostSets = 2'000'000;
/// A first search takes at least this number of groups of wavelengths.
constexpr std::size_t kCoarse = 24;
/// Largest number of recipes of the first search that are found again at all wavelengths.
constexpr std::size_t kRefined = 20'000;
/// A recipe whose squared difference is smaller cannot be improved by another paint.
constexpr double kMatched = 1e-8;
/// Sets whose contrast ratio at groups of wavelengths is too small by less than this are tried at all wavelengths.
constexpr double kContrastSlack = 0.01;

using Set = std::vector<std::size_t>;

/// The settings with bounds for each pigment; throws std::domain_error for wrong ones.
MatchSettings checked(const Palette& palette, const MatchTarget& target, const MatchSettings& settings) {
  const std::size_t n = palette.pigments.size();
  MatchSettings b = settings;
  require(settings.max_paints >= 1 && settings.max_paints <= kMaxPaints, settings.max_paints,
          "number of paints", "must be from 1 to 6");
  require(settings.solutions >= 1, settings.solutions, "number of solutions", "must be positive");
  require(settings.smallest >= 0 && settings.smallest < 0.5, settings.smallest, "smallest amount",
          "must be in [0, 0.5)");
  require(settings.within > 0, settings.within, "largest difference of trade-offs", "must be positive");
  require(settings.least_contrast >= 0 && settings.least_contrast < 1, settings.least_contrast,
          "least contrast ratio", "must be in [0, 1)");
  if (settings.least_contrast > 0 && std::isinf(settings.thickness))
    throw std::domain_error("a contrast ratio needs a layer with a thickness");
  if (!std::isinf(settings.thickness) && settings.substrate.size() != 1 &&
      settings.substrate.size() != palette.nm.size())
    throw std::domain_error("a substrate needs one reflectance, or one for each wavelength");
  if (!settings.price.empty() && settings.price.size() != n)
    throw std::domain_error("prices need a number for each pigment");
  for (const double price : settings.price) require(price >= 0, price, "price", "must not be negative");
  for (const auto& [one, other] : settings.forbidden)
    if (one >= n || other >= n || one == other) throw std::domain_error("a forbidden pair is two pigments");
  if (settings.by != MatchBy::colour && target.reflectance.empty())
    throw std::domain_error("matching by lamps or by the spectrum needs the target's reflectance");
  if (!target.reflectance.empty() && target.reflectance.size() != palette.nm.size())
    throw std::domain_error("the target needs a reflectance for each wavelength of the palette");
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

/// A set of paints as a key: six numbers of ten bits.
std::uint64_t key_of(const Set& set) {
  std::uint64_t key = 0;
  for (const std::size_t p : set) key = key << 10 | (p + 1);
  return key;
}

bool is_allowed(const Set& set, const MatchSettings& settings) {
  double least = 0, most = 0;
  for (const std::size_t p : set) least += settings.least[p], most += settings.most[p];
  if (least > 1 || most < 1) return false;
  for (std::size_t p = 0; p < settings.least.size(); ++p)
    if (settings.least[p] > 0 && std::find(set.begin(), set.end(), p) == set.end()) return false;
  return true;
}

/// All sets of 1 to `max_paints` paints that satisfy the bounds and contain no forbidden pair, grouped by
/// their number of paints.
std::vector<std::vector<Set>> paint_sets(const MatchSettings& settings) {
  const std::size_t n = settings.least.size();
  std::vector<std::vector<bool>> apart(n, std::vector<bool>(n));
  for (const auto& [one, other] : settings.forbidden) apart[one][other] = apart[other][one] = true;
  std::vector<std::size_t> usable;
  for (std::size_t p = 0; p < n; ++p)
    if (settings.most[p] > 0) usable.push_back(p);
  if (usable.size() > 1000) throw std::domain_error("a palette to match with has at most 1000 paints");
  std::vector<std::vector<Set>> levels;
  std::vector<Set> last{{}};
  std::size_t count = 0;
  for (int size = 1; size <= settings.max_paints; ++size) {
    std::vector<Set> next;
    for (const Set& set : last)
      for (const std::size_t p : usable) {
        if (!set.empty() && p <= set.back()) continue;
        if (std::any_of(set.begin(), set.end(), [&](std::size_t q) { return apart[p][q]; })) continue;
        Set& one = next.emplace_back(set);
        one.push_back(p);
        if (next.size() + count > kMostSets)
          throw std::domain_error("there are more than two million sets of at most " +
                                  std::to_string(settings.max_paints) + " of " +
                                  std::to_string(usable.size()) +
                                  " paints; choose fewer paints of a recipe, or fewer to choose from");
      }
    std::vector<Set>& allowed = levels.emplace_back();
    for (const Set& set : next)
      if (is_allowed(set, settings)) allowed.push_back(set);
    count += allowed.size();
    last = std::move(next);
  }
  if (count == 0)
    throw std::domain_error(
        settings.forbidden.empty()
            ? "no recipe keeps the bounds: the largest shares of the paints do not sum to 1"
            : "no recipe keeps the bounds and the forbidden pairs");
  return levels;
}

/// A set of paints and its best fractions.
struct Solved {
  Set set;
  Shares shares{};
  double value = 0;
  bool is_needed = true;  ///< whether each paint is needed, by the first search
  double contrast = 0;    ///< the largest contrast ratio, if no recipe of the set reaches the required one
};

/// Repeats the search for the best recipe of the mixer's set where a paint has less than can be dosed, with
/// at least that amount. The value is `kNoRecipe` if there is none. The paint is not needed if a recipe
/// without it is as good.
void make_dosable(const MatchProblem& problem, Mixer& mixer, Solved& one) {
  const double smallest = problem.settings.smallest;
  const auto solve = [&] {
    one.shares = mixer.projected(one.shares);
    one.value = one.set.size() <= 3 ? mixer.best(one.shares) : mixer.refine(one.shares);
  };
  for (std::size_t round = 0; round < one.set.size() && one.value < kNoRecipe; ++round) {
    // paints with less than can be dosed, with their upper bounds
    std::vector<std::pair<std::size_t, double>> small;
    for (std::size_t p = 0; p < one.set.size(); ++p)
      if (one.shares[p] > 0 && one.shares[p] < smallest && problem.settings.least[one.set[p]] == 0)
        small.emplace_back(p, mixer.most(p));
    if (small.empty()) break;
    const Solved before = one;
    double without = kNoRecipe;
    bool is_whole = true;
    for (const auto& [p, most] : small) is_whole = mixer.bound(p, 0, 0);
    if (is_whole) solve(), without = one.value, one = before;
    for (const auto& [p, most] : small) is_whole = mixer.bound(p, smallest, most);
    if (is_whole)
      solve();
    else
      one.value = kNoRecipe;
    if (without < kNoRecipe && without <= one.value * (1 + 1e-9)) {
      one = before, one.is_needed = false;
      return;
    }
  }
  if (!(one.value < kNoRecipe)) one.contrast = mixer.largest_contrast();
}

/// The best recipe of each set, of all sizes.
class Search {
public:
  Search(const MatchProblem& problem, bool is_exhaustive, const ParallelFor& parallel_for)
      : problem_(problem), is_exhaustive_(is_exhaustive), parallel_for_(parallel_for) {}

  std::vector<Solved> run(const std::vector<std::vector<Set>>& levels) {
    std::vector<Solved> all;
    std::size_t before = 0;
    for (std::size_t size = 1; size <= levels.size(); ++size) {
      const std::size_t begin = all.size();
      for (const Set& set : levels[size - 1]) all.push_back({set});
      subsets_.clear();
      if (!is_exhaustive_ && size > 3)
        for (std::size_t i = before; i < begin; ++i) subsets_.emplace(key_of(all[i].set), i);
      parallel_for_(
          all.size() - begin,
          [&](std::size_t first, std::size_t last) {
            Mixer mixer(problem_);
            for (std::size_t i = begin + first; i < begin + last; ++i) {
              solve(all, i, mixer);
              make_dosable(problem_, mixer, all[i]);
            }
          },
          8);
      before = begin;
    }
    return all;
  }

private:
  /// The recipe of a subset with a little of the paint that it lacks.
  struct Start {
    double value = 0;
    Shares shares{};
    std::size_t added = 0;
  };

  void solve(std::vector<Solved>& all, std::size_t i, Mixer& mixer) const {
    Solved& one = all[i];
    mixer.choose(one.set);
    std::vector<Start> starts;
    if (!subsets_.empty()) {
      for (std::size_t left_out = 0; left_out < one.set.size(); ++left_out) {
        Set subset = one.set;
        subset.erase(subset.begin() + std::ptrdiff_t(left_out));
        const auto found = subsets_.find(key_of(subset));
        if (found == subsets_.end() || !(all[found->second].value < kNoRecipe)) continue;
        Start& start = starts.emplace_back();
        start.value = all[found->second].value, start.added = left_out;
        for (std::size_t p = 0, of = 0; p < one.set.size(); ++p)
          start.shares[p] = p == left_out ? 0 : all[found->second].shares[of++];
      }
    }
    if (starts.empty()) {
      one.value = mixer.best(one.shares);
      return;
    }
    std::sort(starts.begin(), starts.end(), [](const Start& a, const Start& b) { return a.value < b.value; });
    one.shares = starts[0].shares, one.value = starts[0].value, one.is_needed = false;
    if (one.value < kMatched) return;
    for (std::size_t s = 0; s < std::min<std::size_t>(2, starts.size()); ++s) {
      // Strong paints act at one part in a thousand, weak ones from several per cent on.
      Shares best{};
      double reached = starts[s].value;
      for (const double amount : {0.001, 0.03}) {
        Shares there = starts[s].shares;
        for (double& share : there) share *= 1 - amount;
        there[starts[s].added] += amount;
        there = mixer.hiding(mixer.projected(there));
        const double value = mixer.value(there);
        if (value < reached) best = there, reached = value;
      }
      if (!(reached < starts[s].value)) {
        if (s == 0) return;
        continue;
      }
      const double value = mixer.refine(best);
      if (value < one.value) one.shares = best, one.value = value, one.is_needed = true;
    }
  }

  const MatchProblem& problem_;
  bool is_exhaustive_;
  const ParallelFor& parallel_for_;
  std::unordered_map<std::uint64_t, std::size_t> subsets_;
};

/// Sets the CIEDE2000 that results from 1 % too much of each paint.
void add_dosing_errors(const MatchProblem& problem, const Solved& solved, Mixer& mixer, Match& m) {
  m.dosing.assign(problem.palette.pigments.size(), 0);
  double squares = 0;
  for (std::size_t p = 0; p < solved.set.size(); ++p) {
    Shares other = solved.shares;
    const double more = 0.01 * other[p];
    other[p] += more;
    for (double& share : other) share /= 1 + more;
    const double d = ciede2000(m.lab, problem.lamps.front().lab(mixer.reflectance(other)));
    m.dosing[solved.set[p]] = d, squares += d * d;
  }
  m.dosing_error = std::sqrt(squares);
}

/// Returns the recipe with its figures.
Match match_of(const MatchProblem& problem, const Solved& solved, Mixer& mixer) {
  Match m;
  mixer.choose(solved.set);
  m.fractions.resize(problem.palette.pigments.size());
  for (std::size_t p = 0; p < solved.set.size(); ++p) m.fractions[solved.set[p]] = solved.shares[p];
  m.contrast = mixer.contrast(solved.shares);
  m.reflectance = mixer.reflectance(solved.shares);
  m.lab = problem.lamps.front().lab(m.reflectance);
  m.difference = ciede2000(problem.target.lab, m.lab);
  if (!problem.settings.price.empty())
    m.cost = std::inner_product(m.fractions.begin(), m.fractions.end(), problem.settings.price.begin(), 0.0);
  const std::vector<double>& wanted = problem.target.reflectance;
  if (wanted.empty()) return m;
  for (std::size_t l = 1; l < problem.lamps.size(); ++l)
    m.differences.push_back(ciede2000(problem.lamps[l].lab(wanted), problem.lamps[l].lab(m.reflectance)));
  double squares = 0;
  for (std::size_t l = 0; l < wanted.size(); ++l) squares += std::pow(m.reflectance[l] - wanted[l], 2);
  m.rms = std::sqrt(squares / double(wanted.size()));
  return m;
}

/// A recipe and the quantities by which it is sorted.
struct Candidate {
  Match match;
  const Solved* solved;

  int count() const {
    return int(std::count_if(match.fractions.begin(), match.fractions.end(), [](double f) { return f > 0; }));
  }
};

/// Colour difference, cost and metamerism, each rounded to steps below which a difference is negligible.
std::array<double, 3> objectives(const Match& m) {
  return {std::floor(m.difference / 0.02), std::floor(m.cost / 1e-6), std::floor(m.metamerism() / 0.02)};
}

/// Keeps the candidates that no other candidate equals or surpasses in all objectives (the Pareto front),
/// sorted by colour difference.
void keep_trade_offs(std::vector<Candidate>& all, const MatchSettings& settings) {
  std::erase_if(all, [&](const Candidate& c) { return c.match.difference > settings.within; });
  std::sort(all.begin(), all.end(), [](const Candidate& a, const Candidate& b) {
    return std::tuple(objectives(a.match), a.count(), a.match.difference) <
           std::tuple(objectives(b.match), b.count(), b.match.difference);
  });
  std::vector<Candidate> front;
  for (Candidate& c : all) {
    const auto of = objectives(c.match);
    const bool is_dominated = std::any_of(front.begin(), front.end(), [&](const Candidate& other) {
      const auto than = objectives(other.match);
      return than[0] <= of[0] && than[1] <= of[1] && than[2] <= of[2];
    });
    if (!is_dominated) front.push_back(std::move(c));
  }
  // Of many candidates, those far from each other are kept, beginning with the best in each objective.
  const std::size_t wanted = std::size_t(settings.solutions);
  if (front.size() > wanted) {
    std::array<double, 3> low{}, high{};
    const auto raw = [](const Candidate& c) {
      return std::array{c.match.difference, c.match.cost, c.match.metamerism()};
    };
    std::vector<std::size_t> kept;
    for (std::size_t o = 0; o < 3; ++o) {
      const auto by = [&](const Candidate& a, const Candidate& b) { return raw(a)[o] < raw(b)[o]; };
      const auto [least, most] = std::minmax_element(front.begin(), front.end(), by);
      low[o] = raw(*least)[o], high[o] = raw(*most)[o];
      const auto at = std::size_t(least - front.begin());
      if (kept.size() < wanted && std::find(kept.begin(), kept.end(), at) == kept.end()) kept.push_back(at);
    }
    const auto distance = [&](std::size_t a, std::size_t b) {
      double sum = 0;
      for (std::size_t o = 0; o < 3; ++o)
        if (high[o] > low[o]) sum += std::pow((raw(front[a])[o] - raw(front[b])[o]) / (high[o] - low[o]), 2);
      return sum;
    };
    while (kept.size() < wanted) {
      std::size_t farthest = 0;
      double most = -1;
      for (std::size_t i = 0; i < front.size(); ++i) {
        double nearest = std::numeric_limits<double>::infinity();
        for (const std::size_t k : kept) nearest = std::min(nearest, distance(i, k));
        if (nearest > most) most = nearest, farthest = i;
      }
      kept.push_back(farthest);
    }
    std::sort(kept.begin(), kept.end());
    std::vector<Candidate> some;
    for (const std::size_t k : kept) some.push_back(std::move(front[k]));
    front = std::move(some);
  }
  all = std::move(front);
}

void sort_by_merit(std::vector<Candidate>& all, const MatchSettings& settings) {
  const auto order = [&](const Candidate& c) {
    const double merit = settings.by == MatchBy::colour ? c.match.difference : std::sqrt(c.solved->value);
    return std::tuple(std::floor(merit / 0.005), c.match.metamerism(), c.count(), merit);
  };
  std::sort(all.begin(), all.end(),
            [&](const Candidate& a, const Candidate& b) { return order(a) < order(b); });
}

}  // namespace

double Match::metamerism() const {
  return differences.empty() ? 0 : *std::max_element(differences.begin(), differences.end());
}

std::vector<Match> match(const Palette& original, const MatchTarget& target, const Observation& lamp,
                         std::span<const Observation> others, const MatchSettings& settings,
                         const ParallelFor& parallel_for, std::shared_ptr<const FilmTheory> theory) {
  MatchProblem problem{original, target, {lamp}, settings};
  problem.lamps.insert(problem.lamps.end(), others.begin(), others.end());
  check(problem.palette);
  for (const Observation& one : problem.lamps)
    if (one.weights().size() != problem.palette.nm.size())
      throw std::domain_error("the observation " + one.name() + " needs the wavelengths of the palette");
  clamp_negative(problem.palette);
  problem.settings = checked(problem.palette, target, settings);
  const auto levels = paint_sets(problem.settings);
  if (problem.palette.streams)
    problem.theory = theory ? std::move(theory) : theory_of(problem.palette, parallel_for);
  if (problem.theory && !problem.theory->mean_cosine())
    problem.opaque = std::make_shared<const OpaqueReflectance>(*problem.theory);
  std::size_t count = 0;
  for (const auto& level : levels) count += level.size();
  const bool is_exhaustive = count <= kExhaustive;
  const bool is_slow = count > (std::isinf(settings.thickness) ? kExhaustive : kExhaustiveFilms);
  const std::size_t group = is_slow ? std::max<std::size_t>(1, problem.palette.nm.size() / kCoarse) : 1;

  std::vector<Solved> solved;
  {
    MatchProblem coarse = group == 1 ? problem : grouped(problem, group);
    if (group > 1) coarse.contrast_slack = kContrastSlack;
    solved = Search(coarse, is_exhaustive, parallel_for).run(levels);
  }
  double largest_contrast = 0;
  const auto leave_out = [&] {
    for (const Solved& s : solved)
      if (!(s.value < kNoRecipe)) largest_contrast = std::max(largest_contrast, s.contrast);
    std::erase_if(solved, [&](const Solved& s) {
      if (!s.is_needed || !(s.value < kNoRecipe)) return true;
      // Where a paint is not needed, the set's recipe is found as a recipe of the smaller set.
      for (std::size_t p = 0; p < s.set.size(); ++p)
        if (s.shares[p] < settings.smallest && problem.settings.least[s.set[p]] == 0) return true;
      return false;
    });
  };
  leave_out();
  if (group > 1) {
    const std::size_t kept = std::min(kRefined, solved.size());
    std::partial_sort(solved.begin(), solved.begin() + std::ptrdiff_t(kept), solved.end(),
                      [](const Solved& a, const Solved& b) { return a.value < b.value; });
    solved.resize(kept);
    parallel_for(
        kept,
        [&](std::size_t first, std::size_t last) {
          Mixer mixer(problem);
          for (std::size_t i = first; i < last; ++i) {
            mixer.choose(solved[i].set);
            solved[i].value = mixer.refine(solved[i].shares);
            make_dosable(problem, mixer, solved[i]);
          }
        },
        8);
    leave_out();
  }

  if (solved.empty() && settings.least_contrast > 0)
    require(false, largest_contrast, "the contrast ratio of every recipe at this thickness",
            "is below the least one");

  std::vector<Candidate> candidates(solved.size());
  parallel_for(
      solved.size(),
      [&](std::size_t first, std::size_t last) {
        Mixer mixer(problem);
        for (std::size_t i = first; i < last; ++i)
          candidates[i] = {match_of(problem, solved[i], mixer), &solved[i]};
      },
      64);
  if (settings.trade_offs) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const Candidate& c : candidates) nearest = std::min(nearest, c.match.difference);
    require(nearest <= settings.within, nearest, "the colour difference of the nearest recipe",
            "is larger than that of the trade-offs");
    keep_trade_offs(candidates, problem.settings);
  } else {
    sort_by_merit(candidates, problem.settings);
  }
  if (candidates.size() > std::size_t(settings.solutions)) candidates.resize(std::size_t(settings.solutions));

  std::vector<Match> matches;
  Mixer mixer(problem);
  for (Candidate& c : candidates) {
    mixer.choose(c.solved->set);
    add_dosing_errors(problem, *c.solved, mixer, c.match);
    matches.push_back(std::move(c.match));
  }
  return matches;
}

}  // namespace aureole::pigment

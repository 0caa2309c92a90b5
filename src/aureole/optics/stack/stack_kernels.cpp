// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/stack/stack_kernels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <set>

#include "aureole/optics/stack/stack_single_scattering.h"
#include "aureole/optics/stack/stack_solver.h"

namespace aureole::optics {
namespace {

constexpr double kGrazing = 1e-4;  // cosine of the nearly grazing direction

std::set<double> indices_of(const StackDescription& stack) {
  std::set<double> indices{stack.index_above};
  for (const StackLayer& layer : stack.layers) indices.insert(layer.index);
  if (!stack.substrate) indices.insert(stack.index_below);
  return indices;
}

/// Returns the limiting directions of each side, each twice: an extra channel's scattering into itself cannot
/// be separated from its unscattered light, but scattering into its twin can.
std::vector<IndexedCosine> end_directions(const StackDescription& d) {
  std::vector<IndexedCosine> ends{{d.index_above, 1}, {d.index_above, kGrazing}};
  if (!d.substrate && d.index_below != d.index_above) ends.push_back({d.index_below, kGrazing});
  const std::vector<IndexedCosine> once = ends;
  ends.insert(ends.end(), once.begin(), once.end());
  return ends;
}

/// The channels of a side from grazing to normal directions: `in` for incident light, `out` for outgoing
/// light.
struct SideChannels {
  std::vector<int> in, out;
  std::vector<double> cosines;

  SideChannels(const Channels& channels, double index) {
    const std::vector<int>& extra = channels.extra();
    const std::size_t ends = extra.size() / 2;
    std::vector<std::array<int, 2>> all;
    for (int i = 0; i < channels.count(index); ++i) {
      if (!channels.is_extra(i)) {
        all.push_back({i, i});
      } else if (const auto at =
                     std::find(extra.begin(), extra.begin() + std::ptrdiff_t(ends), i) - extra.begin();
                 std::size_t(at) < ends) {
        all.push_back({i, extra[std::size_t(at) + ends]});
      }
    }
    std::sort(all.begin(), all.end(), [&](const auto& a, const auto& b) {
      return channels.mu(a[0], index) < channels.mu(b[0], index);
    });
    for (const auto& [i, o] : all)
      in.push_back(i), out.push_back(o), cosines.push_back(channels.mu(i, index));
  }
  std::size_t size() const { return in.size(); }
};

class KernelMaker {
public:
  KernelMaker(const StackSolver& solver, const StackDescription& d, const DiscreteOrdinates& method,
              std::span<const double> azimuths)
      : solver_(solver), d_(d), azimuths_(azimuths), above_(solver.channels(), d.index_above) {
    if (!d.substrate) below_.emplace(solver.channels(), d.index_below);
    result_.azimuths = int(azimuths.size());
    const std::size_t a = above_.size(), b = below_ ? below_->size() : 0, turns = azimuths.size();
    result_.reflected_above.assign(a * a * turns, 0);
    result_.transmitted.assign(a * b * turns, 0);
    result_.reflected_below.assign(b * b * turns, 0);
    add_modes();
    if (method.delta_m) add_single_scattering();
    for (auto* all : {&result_.reflected_above, &result_.transmitted, &result_.reflected_below})
      for (double& k : *all) k = std::max(k, 0.0);
  }
  StackKernels take() { return std::move(result_); }

private:
  double root(int channel) const { return std::sqrt(solver_.channels().etendue(channel)); }

  void add_modes() {
    const Operators unscattered = solver_.whole(StackSolver::kUnscattered);
    double largest = 0;
    int small = 0;
    for (int m = 0; m < solver_.modes() && small < 2; ++m) {
      const Operators whole = solver_.whole(m);
      if (m == 0) add_fluxes(whole);
      double most = 0;
      const auto add = [&](std::vector<double>& sums, const Matrix& x, const Matrix& kept,
                           const SideChannels& from, const SideChannels& to) {
        std::size_t at = 0;
        for (const int i : from.in)
          for (const int o : to.out) {
            const double k = (m == 0 ? 1 : 2) * (x(o, i) - kept(o, i)) / (root(i) * root(o));
            most = std::max(most, std::abs(k));
            for (const double phi : azimuths_) sums[at++] += k * std::cos(m * phi);
          }
      };
      add(result_.reflected_above, whole.r_above, unscattered.r_above, above_, above_);
      if (below_) {
        add(result_.transmitted, whole.t_down, unscattered.t_down, above_, *below_);
        add(result_.reflected_below, whole.r_below, unscattered.r_below, *below_, *below_);
      }
      largest = std::max(largest, most);
      small = most < kNegligible * largest ? small + 1 : 0;
    }
  }

  void add_fluxes(const Operators& whole) {
    const auto add = [&](StackKernels::Side& side, const SideChannels& from, const Matrix& r, const Matrix& t,
                         bool is_below) {
      side.cosines = from.cosines;
      const int levels = solver_.last_level() + 1;
      for (const int i : from.in) {
        double flux = 0;
        for (int o = 0; o < r.rows(); ++o) flux += root(o) * r(o, i) / root(i);
        for (int o = 0; o < t.rows(); ++o) flux += root(o) * t(o, i) / root(i);
        const Vector paths = solver_.unscattered(i, false).col(is_below ? 2 * levels - 1 : 0);
        // Fractions of unscattered light that leave upward (`mirrored`) and downward (`passed`).
        double mirrored = paths[levels], passed = below_ ? paths[levels - 1] : 0;
        if (is_below) std::swap(mirrored, passed);
        side.mirrored.push_back(mirrored), side.passed.push_back(passed);
        side.scattered.push_back(std::max(0.0, flux - mirrored - passed));
      }
    };
    add(result_.above, above_, whole.r_above, whole.t_down, false);
    if (d_.substrate) add_reach();
    if (below_) add(result_.below, *below_, whole.r_below, Matrix(whole.t_down.transpose()), true);
  }

  /// Adds the downward irradiance on the substrate, and the fractions for diffuse upward light from it.
  void add_reach() {
    const std::optional<Operators> layers = solver_.above_substrate(0);
    const int inside = solver_.channels().count(d_.layers.back().index);
    if (!layers) {
      result_.above.reached.assign(above_.size(), 1);
      result_.left = 1;
      return;
    }
    double all = 0;
    for (int i = 0; i < inside; ++i) all += solver_.channels().etendue(i);
    const auto sum_over = [&](const auto& flux, int i) {
      double sum = 0;
      for (int o = 0; o < flux.rows(); ++o) sum += root(o) * flux(o, i);
      return sum;
    };
    for (const int i : above_.in) result_.above.reached.push_back(sum_over(layers->t_down, i) / root(i));
    for (int i = 0; i < inside; ++i) {
      result_.returned += root(i) * sum_over(layers->r_below, i) / all;
      double up = 0;
      for (int o = 0; o < layers->t_down.cols(); ++o) up += root(o) * layers->t_down(i, o);
      result_.left += root(i) * up / all;
    }
  }

  void add_single_scattering() {
    const SingleScattering single(solver_, d_);
    if (!single.corrects()) return;
    const auto add = [&](std::vector<double>& sums, const SideChannels& from, bool from_below,
                         const SideChannels& to, bool goes_up) {
      auto at = sums.begin();
      const int level = goes_up ? 0 : solver_.last_level();
      const double n = solver_.index(level);
      for (const int i : from.in) {
        const auto beam = single.light(i, from_below);
        for (const int o : to.in)
          for (const double change : single.correction(beam, o, level, goes_up, azimuths_))
            *at++ += change / (n * n);
      }
    };
    add(result_.reflected_above, above_, false, above_, true);
    if (!below_) return;
    add(result_.transmitted, above_, false, *below_, false);
    add(result_.reflected_below, *below_, true, *below_, false);
  }

  static constexpr double kNegligible = 1e-5;

  const StackSolver& solver_;
  const StackDescription& d_;
  std::span<const double> azimuths_;
  SideChannels above_;
  std::optional<SideChannels> below_;
  StackKernels result_;
};

}  // namespace

std::vector<StackKernels> stack_kernels(std::span<const StackDescription> stacks,
                                        const DiscreteOrdinates& method, std::span<const double> azimuths,
                                        const ParallelFor& parallel) {
  std::vector<StackKernels> result(stacks.size());
  if (stacks.empty()) return result;
  // The constructor validates the description.
  for (const StackDescription& d : stacks) (void)PlaneStack(d, method);
  const std::vector<IndexedCosine> ends = end_directions(stacks.front());
  const StackSolver first(stacks.front(), method, true, ends);
  parallel(
      stacks.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          const bool like_first = indices_of(stacks[i]) == indices_of(stacks.front());
          const StackSolver solver(stacks[i], method, true, ends, {}, {}, like_first ? &first : nullptr);
          result[i] = KernelMaker(solver, stacks[i], method, azimuths).take();
        }
      },
      1);
  return result;
}

bool have_same_directions(const StackDescription& a, const StackDescription& b) {
  const auto sides = [](const StackDescription& d) {
    return d.substrate ? std::array{d.index_above, d.index_above} : std::array{d.index_above, d.index_below};
  };
  if (sides(a) != sides(b) || a.layers.size() != b.layers.size()) return false;
  const std::set<double> all_a = indices_of(a), all_b = indices_of(b);
  if (all_a == all_b) return true;
  // The range of directions is divided at each index. Divisions below the larger outer index must be equal,
  // and there must be equally many above, since the streams are distributed over all pieces.
  const double outside = std::max(sides(a)[0], sides(a)[1]);
  const auto below = [&](const std::set<double>& all) {
    return std::set<double>(all.begin(), all.upper_bound(outside));
  };
  return all_a.size() == all_b.size() && below(all_a) == below(all_b);
}

int streams_for_directions(const StackDescription& stack, int directions) {
  return 2 * directions * int(indices_of(stack).size());
}

std::size_t kernel_pairs(const StackDescription& stack, int streams) {
  const std::set<double> indices = indices_of(stack);
  const Channels channels({indices.begin(), indices.end()}, streams / 2, end_directions(stack));
  const std::size_t above = SideChannels(channels, stack.index_above).size(),
                    below = stack.substrate ? 0 : SideChannels(channels, stack.index_below).size();
  return above * above + above * below + below * below;
}

}  // namespace aureole::optics

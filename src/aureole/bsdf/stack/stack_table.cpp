// SPDX-License-Identifier: Apache-2.0
#include "aureole/bsdf/stack/stack_table.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "aureole/spectrum/neighbours.h"

namespace aureole {
namespace {

constexpr int kPhiCells = 256, kCosineCells = 256;

/// Returns acos to 1e-6, for both signs, in a third of the time of std::acos (Abramowitz & Stegun 1964,
/// 4.4.46).
float fast_acos(float x) {
  const float a = std::abs(x);
  float p = -0.0012624911f;
  for (const float c : {0.0066700901f, -0.0170881256f, 0.0308918810f, -0.0501743046f, 0.0889789874f,
                        -0.2145988016f, 1.5707963050f})
    p = p * a + c;
  const float angle = std::sqrt(std::max(0.f, 1 - a)) * p;
  return x < 0 ? kPi - angle : angle;
}

/// Returns the position in [0, 1] at which the cumulative distribution of a density linear from a to b is u.
float sample_linear(float a, float b, float u) {
  const float root = std::sqrt(std::max(0.f, std::lerp(a * a, b * b, u)));
  return a + root > 0 ? std::min(u * (a + b) / (a + root), 1.f) : u;
}

/// Returns the flux between cosines x0 and x1, 2 x dx, weighted by the hat functions of the first and of the
/// second node. Their sum is x1^2 - x0^2.
template <typename T>
std::array<T, 2> hat_fluxes(T x0, T x1) {
  const T d = (x1 - x0) / 3;
  return {d * (2 * x0 + x1), d * (x0 + 2 * x1)};
}

/// Returns the position in [0, 1] between cosines x0 and x1 at which the fraction of the flux is u, for a
/// radiance linear from a to b. The density is a quadratic; its three terms in Bernstein form are sampled in
/// closed form, each with a range of u.
float sample_flux(float x0, float x1, float a, float b, float u) {
  const float first = 2 * a * x0, middle = a * x1 + b * x0, last = 2 * b * x1, sum = first + middle + last;
  if (!(sum > 0)) return u;
  float v = u * sum;
  if (v < first) return 1 - std::cbrt(1 - v / first);
  v -= first;
  // Solution of 3 t^2 - 2 t^3 = v by the cosine of a third of an angle.
  if (v < middle) return 0.5f - std::sin(std::asin(1 - 2 * v / middle) * (1.f / 3));
  return last > 0 ? std::min(std::cbrt((v - middle) / last), 1.f) : 1;
}

using Side = optics::StackKernels::Side;

/// A node of the table, interpolated from the solver's nodes near it. K is the mean of two of them; fractions
/// of light are smooth functions of the cosine, interpolated by a cubic through four.
struct TableNode {
  /// indices of two nodes of the solver; equal where the table's node is one of them
  std::size_t first, second;
  std::array<std::size_t, 4> near;
  std::array<double, 4> weight;

  double share(const std::vector<double>& of) const {
    double sum = 0;
    for (std::size_t j = 0; j < 4; ++j) sum += weight[j] * of[near[j]];
    return std::max(sum, 0.0);
  }
};

TableNode node_between(const std::vector<double>& cosines, std::size_t i) {
  TableNode n{i, i + 1, {}, {}};
  const std::size_t begin = std::min(i > 0 ? i - 1 : 0, cosines.size() - 4);
  const double x = 0.5 * (cosines[i] + cosines[i + 1]);
  for (std::size_t j = 0; j < 4; ++j) {
    n.near[j] = begin + j, n.weight[j] = 1;
    for (std::size_t l = 0; l < 4; ++l)
      if (l != j) n.weight[j] *= (x - cosines[begin + l]) / (cosines[begin + j] - cosines[begin + l]);
  }
  return n;
}

/// Returns the solver's nodes, and one more between two where the energy is not linear, which occurs near the
/// horizon.
std::vector<TableNode> table_nodes(std::span<const optics::StackKernels> kernels,
                                   Side optics::StackKernels::*which) {
  constexpr double kLinear = 2e-4;
  const std::vector<double>& cosines = (kernels.front().*which).cosines;
  std::vector<TableNode> nodes;
  for (std::size_t i = 0; i < cosines.size(); ++i) {
    nodes.push_back({i, i, {i, i, i, i}, {1, 0, 0, 0}});
    if (i + 1 == cosines.size() || cosines.size() < 4) continue;
    const TableNode n = node_between(cosines, i);
    const auto is_bent = [&](const optics::StackKernels& k) {
      const Side& side = k.*which;
      const auto bend = [&](const std::vector<double>& of) {
        return of.empty() ? 0 : n.share(of) - 0.5 * (of[i] + of[i + 1]);
      };
      return std::abs(bend(side.scattered) + bend(side.mirrored) + bend(side.passed)) > kLinear ||
             std::abs(bend(side.reached)) > kLinear;
    };
    if (std::any_of(kernels.begin(), kernels.end(), is_bent)) nodes.push_back(n);
  }
  return nodes;
}

struct TableNodes {
  std::vector<TableNode> above, below;
  explicit TableNodes(std::span<const optics::StackKernels> kernels)
      : above(table_nodes(kernels, &optics::StackKernels::above)),
        below(table_nodes(kernels, &optics::StackKernels::below)) {
    const double pairs = double(above.size()) * double(above.size() + below.size()) +
                         double(below.size()) * double(below.size());
    if (StackTable::megabytes(pairs * kernels.front().azimuths, kernels.size()) <=
        StackTable::kLargestMegabytes)
      return;
    const auto is_added = [](const TableNode& n) { return n.first != n.second; };
    std::erase_if(above, is_added), std::erase_if(below, is_added);
  }
};

optics::StackKernels at_nodes(const TableNodes& nodes, const optics::StackKernels& k) {
  optics::StackKernels r;
  r.azimuths = k.azimuths, r.returned = k.returned, r.left = k.left;
  const auto turns = std::size_t(k.azimuths);
  const auto side = [](const Side& from, Side& to, const std::vector<TableNode>& all) {
    for (const TableNode& n : all) {
      to.cosines.push_back(0.5 * (from.cosines[n.first] + from.cosines[n.second]));
      to.scattered.push_back(n.share(from.scattered));
      to.mirrored.push_back(n.share(from.mirrored)), to.passed.push_back(n.share(from.passed));
      if (!from.reached.empty()) to.reached.push_back(n.share(from.reached));
    }
  };
  side(k.above, r.above, nodes.above), side(k.below, r.below, nodes.below);
  const auto kernel = [&](const std::vector<double>& from, std::vector<double>& to,
                          const std::vector<TableNode>& in, const std::vector<TableNode>& out,
                          std::size_t width) {
    to.reserve(in.size() * out.size() * turns);
    for (const TableNode& i : in)
      for (const TableNode& o : out)
        for (std::size_t a = 0; a < turns; ++a) {
          const auto at = [&](std::size_t p, std::size_t q) { return from[(p * width + q) * turns + a]; };
          to.push_back(0.25 * (at(i.first, o.first) + at(i.first, o.second) + at(i.second, o.first) +
                               at(i.second, o.second)));
        }
  };
  const std::size_t above = k.above.cosines.size(), below = k.below.cosines.size();
  kernel(k.reflected_above, r.reflected_above, nodes.above, nodes.above, above);
  kernel(k.transmitted, r.transmitted, nodes.above, nodes.below, below);
  kernel(k.reflected_below, r.reflected_below, nodes.below, nodes.below, below);
  return r;
}

}  // namespace

StackTable::StackTable(std::vector<optics::StackKernels> kernels, std::span<const double> azimuths,
                       const SpectralGrid& grid, float index_above, float index_below,
                       std::span<const double> inner_indices)
    : index_{index_above, index_below},
      wavelengths_(std::max(2, int(kernels.size()))),
      azimuths_(int(azimuths.size())),
      first_nm_(float(grid.min_nm)),
      per_nm_(float((wavelengths_ - 1) / (grid.max_nm - grid.min_nm))) {
  phi_.assign(azimuths.begin(), azimuths.end());
  for (int i = 0, cell = 0; i < kPhiCells; ++i) {
    const float t = float(i) / kPhiCells;
    while (cell + 2 < azimuths_ && phi_[std::size_t(cell) + 1] <= kPi * t * t) ++cell;
    phi_cells_.push_back(cell);
  }
  const TableNodes nodes(kernels);
  for (optics::StackKernels& k : kernels) k = at_nodes(nodes, k);
  const optics::StackKernels& one = kernels.front();
  for (const int s : {0, 1}) {
    const optics::StackKernels::Side& from = s ? one.below : one.above;
    sides_[s].cosines.assign(from.cosines.begin(), from.cosines.end());
    if (!from.cosines.empty()) sides_[s].cosines.front() = 0, sides_[s].cosines.back() = 1;
    for (int i = 0, cell = 0; !from.cosines.empty() && i <= kCosineCells; ++i) {
      const float c = float(i) / kCosineCells;
      while (cell + 2 < int(from.cosines.size()) && sides_[s].cosines[std::size_t(cell) + 1] <= c) ++cell;
      sides_[s].cells.push_back(cell);
    }
    for (auto* table : {&sides_[s].scattered, &sides_[s].mirrored, &sides_[s].passed, &sides_[s].total})
      table->resize(from.cosines.size() * std::size_t(wavelengths_));
  }
  const auto w = std::size_t(wavelengths_);
  reflected_[0].resize(one.reflected_above.size() * w), reflected_[1].resize(one.reflected_below.size() * w);
  transmitted_.resize(one.transmitted.size() * w);
  balance(kernels);
  prepare_samples();
  if (!inner_indices.empty()) prepare_substrate(kernels, inner_indices);
}

void StackTable::balance(std::span<const optics::StackKernels> kernels) {
  const std::size_t above = sides_[0].cosines.size(), below = sides_[1].cosines.size(), all = above + below,
                    turns = std::size_t(azimuths_);
  // Integrals of the hat functions: over azimuth (both halves of the circle), and over flux.
  std::vector<double> turn(turns, 0), flux(all, 0);
  for (std::size_t k = 0; k + 1 < turns; ++k) {
    const double d = double(phi_[k + 1]) - double(phi_[k]);
    turn[k] += d, turn[k + 1] += d;
  }
  for (const int s : {0, 1}) {
    const std::vector<float>& cosines = sides_[s].cosines;
    const double half_n2 = 0.5 * double(index_[s]) * double(index_[s]);
    for (std::size_t i = 0; i + 1 < cosines.size(); ++i) {
      const auto [first, second] = hat_fluxes(double(cosines[i]), double(cosines[i + 1]));
      flux[s * above + i] += half_n2 * first, flux[s * above + i + 1] += half_n2 * second;
    }
  }
  for (int w = 0; w < wavelengths_; ++w) {
    const optics::StackKernels& k = kernels[std::min(std::size_t(w), kernels.size() - 1)];
    const auto kernel = [&](std::size_t i, std::size_t o) {
      if (i < above)
        return o < above ? &k.reflected_above[(i * above + o) * turns]
                         : &k.transmitted[(i * below + o - above) * turns];
      return o < above ? &k.transmitted[(o * below + i - above) * turns]
                       : &k.reflected_below[((i - above) * below + o - above) * turns];
    };
    // Sums over azimuth of K and of its square, for each pair of nodes.
    std::vector<double> sums(all * all), squares(all * all), target(all), largest(all, 0), peak(all, 0);
    for (std::size_t i = 0; i < all; ++i) {
      target[i] = i < above ? k.above.scattered[i] : k.below.scattered[i - above];
      for (std::size_t o = 0; o < all; ++o)
        for (std::size_t a = 0; a < turns; ++a) {
          const double value = kernel(i, o)[a];
          sums[i * all + o] += turn[a] * value, squares[i * all + o] += turn[a] * value * value;
          largest[i] = std::max(largest[i], value);
        }
    }
    // K becomes K (1 + K (p_i + p_o)): the error of sums over nodes is corrected mainly at peaks, where K is
    // largest, while their tails keep their values. Each iteration halves the error of each direction. p is
    // bounded, so that no value changes by more than half of itself.
    for (int iteration = 0; iteration < 500; ++iteration) {
      double worst = 0;
      std::vector<double> next(all);
      for (std::size_t i = 0; i < all; ++i) {
        double sum = 0, weight = 0;
        for (std::size_t o = 0; o < all; ++o) {
          sum += flux[o] * (sums[i * all + o] + squares[i * all + o] * (peak[i] + peak[o]));
          weight += flux[o] * squares[i * all + o];
        }
        const double missing = target[i] - sum;
        if (iteration == 0 && target[i] > 1e-6 &&
            (i < above ? sides_[0].cosines[i] : sides_[1].cosines[i - above]) > 0.173f)
          correction_ = std::max(correction_, std::abs(missing) / target[i]);
        const double bound = largest[i] > 0 ? 0.25 / largest[i] : 0;
        next[i] = weight > 0 ? std::clamp(peak[i] + missing / (2 * weight), -bound, bound) : 0;
        worst = std::max(worst, std::abs(next[i] - peak[i]) * weight);
      }
      peak.swap(next);
      if (worst < 1e-9) break;
    }
    for (std::size_t i = 0; i < all; ++i)
      for (std::size_t o = 0; o < all; ++o) sums[i * all + o] += squares[i * all + o] * (peak[i] + peak[o]);
    std::vector<double> factor(all, 1.0);
    const auto got = [&](std::size_t i) {
      double sum = 0;
      for (std::size_t o = 0; o < all; ++o) sum += flux[o] * sums[i * all + o] * factor[o];
      return factor[i] * sum;
    };
    for (int iteration = 0; iteration < 2000; ++iteration) {
      double worst = 0;
      std::vector<double> next(all);
      for (std::size_t i = 0; i < all; ++i) {
        const double g = got(i);
        next[i] = g > 1e-12 ? factor[i] * std::sqrt(target[i] / g) : factor[i];
        worst = std::max(worst, std::abs(g - target[i]));
      }
      factor.swap(next);
      if (worst < 1e-8) break;
    }
    for (std::size_t i = 0; i < all; ++i) {
      const bool s = i >= above;
      const optics::StackKernels::Side& from = s ? k.below : k.above;
      const std::size_t at = s ? i - above : i, to = at * std::size_t(wavelengths_) + std::size_t(w);
      // The sum over the table, which equals the target unless nothing is scattered at all.
      sides_[s].scattered[to] = float(got(i));
      sides_[s].mirrored[to] = float(from.mirrored[at]), sides_[s].passed[to] = float(from.passed[at]);
      sides_[s].total[to] = sides_[s].scattered[to] + sides_[s].mirrored[to] + sides_[s].passed[to];
    }
    const auto store = [&](const std::vector<double>& from, std::vector<float>& to, std::size_t in,
                           std::size_t out, std::size_t in_count, std::size_t out_count) {
      std::size_t at = 0;
      for (std::size_t i = 0; i < in_count; ++i)
        for (std::size_t o = 0; o < out_count; ++o)
          for (std::size_t a = 0; a < turns; ++a, ++at)
            to[at * std::size_t(wavelengths_) + std::size_t(w)] =
                float(from[at] * (1 + from[at] * (peak[in + i] + peak[out + o])) * factor[in + i] *
                      factor[out + o]);
    };
    store(k.reflected_above, reflected_[0], 0, 0, above, above);
    store(k.transmitted, transmitted_, 0, above, above, below);
    store(k.reflected_below, reflected_[1], above, above, below, below);
  }
}

void StackTable::prepare_samples() {
  const std::size_t above = sides_[0].cosines.size(), below = sides_[1].cosines.size(), all = above + below;
  for (const bool in : {false, true}) {
    Side& side = sides_[in];
    const std::size_t count = side.cosines.size();
    side.ring.resize(std::size_t(wavelengths_) * count * all), side.cdf.resize(side.ring.size());
    for (int w = 0; w < wavelengths_; ++w)
      for (std::size_t i = 0; i < count; ++i) {
        const std::size_t first = (std::size_t(w) * count + i) * all;
        double sum = 0;
        std::vector<double> up_to(all);
        for (std::size_t j = 0; j < all; ++j) {
          const bool out = j >= above;
          const std::size_t o = out ? j - above : j;
          const float* k = row(in, out, int(i), int(o)) + w;
          double ring = 0;
          for (int a = 0; a + 1 < azimuths_; ++a)
            ring += 0.5 * (double(phi_[a + 1]) - double(phi_[a])) *
                    (double(k[a * wavelengths_]) + double(k[(a + 1) * wavelengths_]));
          ring *= double(index_[out]) * double(index_[out]);
          if (o > 0) {
            const std::vector<float>& cosines = sides_[out].cosines;
            const auto [before, here] = hat_fluxes(double(cosines[o - 1]), double(cosines[o]));
            sum += here * ring + before * double(side.ring[first + j - 1]);
          }
          side.ring[first + j] = float(ring);
          up_to[j] = sum;
        }
        for (std::size_t j = 0; j < all; ++j) side.cdf[first + j] = sum > 0 ? float(up_to[j] / sum) : 0;
      }
  }
}

void StackTable::prepare_substrate(std::span<const optics::StackKernels> kernels,
                                   std::span<const double> inner_indices) {
  Side& side = sides_[0];
  const auto count = std::size_t(wavelengths_);
  side.reached.resize(side.cosines.size() * count);
  for (std::size_t w = 0; w < count; ++w) {
    const std::size_t of = std::min(w, kernels.size() - 1);
    const optics::StackKernels& k = kernels[of];
    double sum = 0;
    for (std::size_t i = 0; i < side.cosines.size(); ++i) {
      const double t = k.above.reached[i];
      side.reached[i * count + w] = float(t);
      if (i > 0) {
        const auto [before, here] = hat_fluxes(double(side.cosines[i - 1]), double(side.cosines[i]));
        sum += here * t + before * double(side.reached[(i - 1) * count + w]);
      }
    }
    const double inner = inner_indices[of], per_inner = 1 / (double(kPi) * inner * inner);
    reached_sum_.push_back(float(sum)), per_inner_.push_back(float(per_inner));
    // Exiting light that the sum over nodes misses returns to the substrate, so that none is lost.
    const double leaves = double(kPi) * double(index_[0]) * double(index_[0]) * per_inner * sum;
    lost_.push_back(float(std::max(1 - k.returned - k.left + leaves, 0.0)));
  }
}

Spectrum StackTable::at(const std::vector<float>& table, const Place& place, const Nodes& n) const {
  Neighbours p(&table[std::size_t(place.cell) * std::size_t(wavelengths_)], n.at);
  p.mix(Neighbours(&table[std::size_t(place.cell + 1) * std::size_t(wavelengths_)], n.at), place.fraction);
  return p.first + (p.second - p.first) * n.fraction;
}

StackTable::Upward StackTable::upward(const Nodes& n, const Spectrum& below) const {
  const auto mean = [&](const std::vector<float>& table) {
    const Neighbours p(table.data(), n.at);
    return p.first + (p.second - p.first) * n.fraction;
  };
  // A white substrate under a semi-infinite lossless coat would divide by 0; no light reaches it.
  const Spectrum taken = (Spectrum(1.f) - below) + mean(lost_) * below;
  const Spectrum scale = mean(per_inner_) * below / max(taken, 1e-9f);
  return {scale, scale * mean(reached_sum_) * (kPi * index_[0] * index_[0])};
}

StackTable::Nodes StackTable::nodes(const Wavelengths& w) const {
  Nodes n;
  const Spectrum position = min(max((w.nm - first_nm_) * per_nm_, 0.f), float(wavelengths_ - 1));
  for (int j = 0; j < kWavelengths; ++j) n.at[j] = std::min(int(position[j]), wavelengths_ - 2);
  n.fraction = make_spectrum([&](int j) { return position[j] - float(n.at[j]); });
  return n;
}

StackTable::Place StackTable::find(const Side& side, float cosine) {
  const float x = std::min(cosine, 1.f);
  const float* first = side.cosines.data();
  int low = side.cells[std::size_t(x * kCosineCells)];
  const int last = int(side.cosines.size()) - 2;
  while (low < last && x >= first[low + 1]) ++low;
  return {low, (x - first[low]) / (first[low + 1] - first[low])};
}

StackTable::Place StackTable::find_azimuth(const Vec3& wi, const Vec3& wo) const {
  const float across2 = (wi.x * wi.x + wi.y * wi.y) * (wo.x * wo.x + wo.y * wo.y);
  const float cosine = across2 > 0 ? -(wi.x * wo.x + wi.y * wo.y) / std::sqrt(across2) : 0;
  const float phi = fast_acos(std::clamp(cosine, -1.f, 1.f));
  int cell =
      phi_cells_[std::min(std::size_t(std::sqrt(phi * kInvPi) * kPhiCells), std::size_t(kPhiCells - 1))];
  while (cell + 2 < azimuths_ && phi >= phi_[cell + 1]) ++cell;
  return {cell, std::clamp((phi - phi_[cell]) / (phi_[cell + 1] - phi_[cell]), 0.f, 1.f)};
}

StackTable::Shares StackTable::shares(const Vec3& wi, const Wavelengths& w, const Spectrum* below) const {
  const Side& side = sides_[wi.z < 0];
  if (side.cosines.empty()) return {0.f, 0.f, 0.f};
  const Place place = find(side, std::abs(wi.z));
  const Nodes n = nodes(w);
  Shares all{at(side.scattered, place, n), at(side.mirrored, place, n), at(side.passed, place, n)};
  if (below) all.scattered += at(side.reached, place, n) * upward(n, *below).all;
  return all;
}

template <bool kWithTotal>
StackTable::Value StackTable::eval(const Vec3& wi, const Vec3& wo, const Wavelengths& w,
                                   const Spectrum* below) const {
  const bool in = wi.z < 0, out = wo.z < 0;
  if ((in || out) && !is_open()) return {0.f};
  const Place i = find(sides_[in], std::abs(wi.z)), o = find(sides_[out], std::abs(wo.z)),
              a = find_azimuth(wi, wo);
  const Nodes n = nodes(w);
  const auto across = [&](int di, int d_o) {
    const float* k = row(in, out, i.cell + di, o.cell + d_o) + a.cell * wavelengths_;
    Neighbours p(k, n.at);
    p.mix(Neighbours(k + wavelengths_, n.at), a.fraction);
    return p;
  };
  Neighbours p = across(0, 0), q = across(1, 0);
  p.mix(across(0, 1), o.fraction), q.mix(across(1, 1), o.fraction);
  p.mix(q, i.fraction);
  Value value{p.first + (p.second - p.first) * n.fraction};
  if constexpr (kWithTotal) {
    const float* total = &sides_[in].total[std::size_t(i.cell) * std::size_t(wavelengths_)];
    Neighbours t(total, n.at);
    t.mix(Neighbours(total + wavelengths_, n.at), i.fraction);
    value.total = t.first + (t.second - t.first) * n.fraction;
  }
  if (below) {
    const Upward up = upward(n, *below);
    const Spectrum from = at(sides_[0].reached, i, n);
    value.k += from * at(sides_[0].reached, o, n) * up.scale;
    if constexpr (kWithTotal) value.total += from * up.all;
  }
  return value;
}
template StackTable::Value StackTable::eval<true>(const Vec3&, const Vec3&, const Wavelengths&,
                                                  const Spectrum*) const;
template StackTable::Value StackTable::eval<false>(const Vec3&, const Vec3&, const Wavelengths&,
                                                   const Spectrum*) const;

Vec3 StackTable::sample_upward(Vec2 u, const Nodes& n) const {
  const Side& side = sides_[0];
  const auto node = [&](std::size_t i) {
    const float* t = &side.reached[i * std::size_t(wavelengths_) + std::size_t(n.at[0])];
    return std::lerp(t[0], t[1], n.fraction[0]);
  };
  const auto sum =
      std::lerp(reached_sum_[std::size_t(n.at[0])], reached_sum_[std::size_t(n.at[0]) + 1], n.fraction[0]);
  float wanted = u.x * sum, a = node(0), cosine = 1;
  for (std::size_t i = 0; i + 1 < side.cosines.size(); ++i) {
    const float b = node(i + 1), x0 = side.cosines[i], x1 = side.cosines[i + 1];
    const auto [before, here] = hat_fluxes(x0, x1);
    const float mass = before * a + here * b;
    if (wanted < mass || i + 2 == side.cosines.size()) {
      cosine =
          std::lerp(x0, x1, sample_flux(x0, x1, a, b, mass > 0 ? std::clamp(wanted / mass, 0.f, 1.f) : 0.5f));
      break;
    }
    wanted -= mass, a = b;
  }
  const float sine = std::sqrt(std::max(0.f, 1 - cosine * cosine)), phi = 2 * kPi * u.y;
  return {sine * std::cos(phi), sine * std::sin(phi), cosine};
}

Vec3 StackTable::sample(const Vec3& wi, float choice, Vec2 u, const Wavelengths& w,
                        const Spectrum* below) const {
  const bool in = wi.z < 0;
  const Side& side = sides_[in];
  const Place at = find(side, std::abs(wi.z));
  const Nodes n = nodes(w);
  if (below) {
    const float scattered = this->at(side.scattered, at, n)[0],
                upward_share = (this->at(side.reached, at, n) * upward(n, *below).all)[0];
    const float all = scattered + upward_share;
    if (choice * all >= scattered) return sample_upward(u, n);
    choice = std::min(choice * all / scattered, 0x1.fffffep-1f);
  }
  // The interpolated value is a mean of four nodes, one of which is chosen by the light that it scatters.
  float weight[4], sum = 0;
  for (int k = 0; k < 4; ++k) {
    const int i = at.cell + k / 2, l = n.at[0] + k % 2;
    weight[k] = side.scattered[std::size_t(i) * std::size_t(wavelengths_) + std::size_t(l)] *
                (k / 2 ? at.fraction : 1 - at.fraction) * (k % 2 ? n.fraction[0] : 1 - n.fraction[0]);
    sum += weight[k];
  }
  int k = 0;
  for (choice *= sum; k < 3 && choice >= weight[k]; ++k) choice -= weight[k];
  while (k > 0 && !(weight[k] > 0)) --k;  // skips nodes of weight zero, which rounding may have chosen
  const int i = at.cell + k / 2, l = n.at[0] + k % 2;

  const std::size_t above = sides_[0].cosines.size(), all = above + sides_[1].cosines.size(),
                    first = (std::size_t(l) * side.cosines.size() + std::size_t(i)) * all;
  const float *cdf = &side.cdf[first], *ring = &side.ring[first];
  auto j = std::size_t(std::upper_bound(cdf, cdf + all, u.x) - cdf);
  j = std::clamp<std::size_t>(j, 1, all - 1);
  if (j == above) ++j;  // the step from the upper to the lower hemisphere is not a cell
  const bool out = j > above;
  const int o = int(out ? j - above : j) - 1;
  const float width = cdf[j] - cdf[j - 1];
  const float x0 = sides_[out].cosines[std::size_t(o)], x1 = sides_[out].cosines[std::size_t(o) + 1];
  const float t = sample_flux(x0, x1, ring[j - 1], ring[j],
                              width > 0 ? std::clamp((u.x - cdf[j - 1]) / width, 0.f, 1.f) : 0.5f);
  const float cosine = std::lerp(x0, x1, t);

  // The azimuth, from the row at t between two nodes. The two halves of the circle are equal.
  const bool mirrored = u.y < 0.5f;
  const float v = mirrored ? 2 * u.y : 2 * u.y - 1;
  const float *p = row(in, out, i, o) + l, *q = row(in, out, i, o + 1) + l;
  const auto value = [&](int a) { return std::lerp(p[a * wavelengths_], q[a * wavelengths_], t); };
  float wanted = v * std::lerp(ring[j - 1], ring[j], t) / (index_[out] * index_[out]), phi = phi_.back();
  float a0 = value(0);
  for (int a = 0; a + 1 < azimuths_; ++a) {
    const float a1 = value(a + 1), step = phi_[a + 1] - phi_[a], mass = 0.5f * step * (a0 + a1);
    if (wanted < mass || a + 2 == azimuths_) {
      phi = phi_[a] + step * sample_linear(a0, a1, mass > 0 ? std::clamp(wanted / mass, 0.f, 1.f) : 0.5f);
      break;
    }
    wanted -= mass, a0 = a1;
  }
  if (mirrored) phi = -phi;
  // Azimuth 0 continues in the half-plane opposite to wi.
  const float across = std::sqrt(wi.x * wi.x + wi.y * wi.y);
  const float x = across > 0 ? -wi.x / across : 1, y = across > 0 ? -wi.y / across : 0;
  const float sine = std::sqrt(std::max(0.f, 1 - cosine * cosine)), c = std::cos(phi), s = std::sin(phi);
  return {sine * (x * c - y * s), sine * (y * c + x * s), out ? -cosine : cosine};
}

std::size_t StackTable::bytes() const {
  std::size_t floats = reflected_[0].size() + reflected_[1].size() + transmitted_.size();
  for (const Side& s : sides_)
    floats += s.cosines.size() + 4 * s.scattered.size() + s.ring.size() + s.cdf.size() + s.reached.size();
  return floats * sizeof(float);
}

}  // namespace aureole

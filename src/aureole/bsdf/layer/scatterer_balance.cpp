// SPDX-License-Identifier: Apache-2.0
#include "aureole/bsdf/layer/scatterer_balance.h"

#include <algorithm>
#include <cmath>

#include "aureole/core/parallel.h"
#include "aureole/optics/interface/fresnel_equations.h"

namespace aureole {
namespace {

/// Bound of k a below which scatterers count as small: they diffract few rings.
constexpr double kSmall = 10;

/// Returns the position, in nodes, of a direction of transverse index p = n sin(theta) in the table of h. h
/// varies on the scale 1/(k a) near the p beyond which waves are evanescent or totally reflected. With d the
/// distance from that p times k a, nodes are uniform in sqrt(d)/(1 + sqrt(d)): uniform in the cosine near
/// that limit, and in h - 1 ~ 1/d far from it. The rarer medium has one segment; the denser one has three: up
/// to the critical angle, and two beyond it.
template <class Real>
Real table_position(Real phase, Real here, Real beyond, Real p, int nodes) {
  const auto along = [&](Real distance, Real whole) {
    const Real s = std::sqrt(std::max(distance, Real(0)) * phase), m = std::sqrt(whole * phase);
    return std::min(s * (1 + m) / ((1 + s) * m), Real(1)) * Real(nodes);
  };
  if (!(here > beyond)) return along(here - p, here);
  if (p <= beyond) return Real(nodes + 1) + along(beyond - p, beyond);
  const Real half = (here - beyond) / 2;
  if (p <= beyond + half) return Real(2 * (nodes + 1)) + along(p - beyond, half);
  return Real(3 * (nodes + 1)) + along(here - p, half);
}

/// Returns the transverse index of a node: the inverse of `table_position`.
double node_transverse_index(double phase, double here, double beyond, int node, int nodes) {
  const int piece = node / (nodes + 1);
  const auto distance = [&](double whole) {
    const double m = std::sqrt(whole * phase), t = double(node % (nodes + 1)) / nodes * m / (1 + m);
    const double s = t / (1 - t);
    return std::min(s * s / phase, whole);
  };
  if (piece == 0) return here - distance(here);
  if (piece == 1) return beyond - distance(beyond);
  const double half = (here - beyond) / 2;
  return piece == 2 ? beyond + distance(half) : here - distance(half);
}

}  // namespace

ScattererBalance::ScattererBalance(const optics::RadialDistribution& table, double phase_nm,
                                   const SpectralGrid& grid,
                                   const std::function<std::pair<double, double>(double)>& indices,
                                   LayerSubstrate::Kind substrate)
    : substrate_(substrate), phase_nm_(phase_nm), first_(1 / grid.max_nm) {
  // For small k a, h oscillates: one ring per pi of k a passes the limit of evanescent waves.
  constexpr double kMinNodes = 8, kMaxNodes = 64;
  const double kStep = phase_nm / grid.max_nm < kSmall ? 0.04 : 0.4;
  const double range = 1 / grid.min_nm - 1 / grid.max_nm;
  wavelength_nodes_ = int(std::clamp(std::ceil(phase_nm * range / kStep) + 1, kMinNodes, kMaxNodes));
  scale_ = (wavelength_nodes_ - 1) / range;
  h_.assign(size_t(wavelength_nodes_) * kStride, 1.f);
  for_ranges(
      size_t(wavelength_nodes_),
      [&](size_t begin, size_t end) {
        for (size_t l = begin; l < end; ++l) {
          const double nm = std::clamp(1 / (first_ + double(l) / scale_), grid.min_nm, grid.max_nm);
          const auto [n_ext, n_int] = indices(nm);
          solve(&h_[l * kStride], table, phase_nm / nm, n_ext, n_int);
        }
      },
      1);
}

void ScattererBalance::solve(float* h_out, const optics::RadialDistribution& table, double phase,
                             double n_ext, double n_int) {
  const bool two_media = substrate_ == LayerSubstrate::Kind::interface && n_ext != n_int;
  const double rare = two_media ? std::min(n_ext, n_int) : n_ext,
               dense = two_media ? std::max(n_ext, n_int) : n_ext;
  const int used = two_media ? kStride : kNodes + 1;
  // At equal transverse index both sides have equal reflectance (Fresnel), 1 if either side has no direction.
  const auto reflectance = [&](double p) {
    if (substrate_ == LayerSubstrate::Kind::none) return 0.0;
    if (p >= rare) return 1.0;
    const double cosine = std::sqrt(1 - p * p / (rare * rare));
    return substrate_ == LayerSubstrate::Kind::pane ? optics::thin_slab_reflectance(cosine, n_ext, n_int)
                                                    : optics::fresnel_reflectance(cosine, rare, dense);
  };
  constexpr int kReflectanceCells = 4096;
  // Square roots of the reflectance, at equal steps of the cosine.
  std::vector<double> reflectances(kReflectanceCells + 1);
  for (int i = 0; i <= kReflectanceCells; ++i) {
    const double cosine = double(i) / kReflectanceCells;
    reflectances[i] = std::sqrt(reflectance(rare * std::sqrt(1 - cosine * cosine)));
  }
  const auto root_reflectance = [&](double p) {
    if (p >= rare) return substrate_ == LayerSubstrate::Kind::none ? 0.0 : 1.0;
    const double x = std::sqrt(1 - p * p / (rare * rare)) * kReflectanceCells;
    const int i = std::min(int(x), kReflectanceCells - 1);
    return reflectances[i] + (x - i) * (reflectances[i + 1] - reflectances[i]);
  };

  // Rows: power scattered from a direction to the nodes of h, by a rank-1 lattice in (cumulative power,
  // azimuth).
  // Small scatterers send light to all angles, and their h oscillates with the angle. An interface has four times
  // as many nodes.
  const int points = phase < kSmall ? (two_media ? 16384 : 32768) : 8192;
  constexpr double kGolden = 0.6180339887498949;
  std::vector<double> matrix(size_t(used) * used, 0.0), cosines(size_t(points), 0.0),
      distances(size_t(points), 0.0);
  const double u_max = 2 * phase * dense, power = table.cdf(u_max) / points;
  for (int k = 0; k < points; ++k) {
    distances[k] = table.sample((k + 0.5) / points, u_max) / phase;
    cosines[k] = std::cos(M_PI * std::fmod((k + 0.5) * kGolden, 1.0));
  }
  for (int i = 0; i < used; ++i) {
    const bool in_dense = i > kNodes;
    const double here = in_dense ? dense : rare, beyond = in_dense ? rare : dense;
    const double p = node_transverse_index(phase, here, beyond, i, kNodes), root = root_reflectance(p);
    double* row = &matrix[size_t(i) * used];
    const auto add = [&](double p_o, double n, double other, double share) {
      if (!(p_o < n) || !(share > 0)) return;
      const double x = table_position(phase, n, other, p_o, kNodes);
      const int j = std::min(int(x), used - 2);
      row[j] += power * share * (1 - (x - j));
      row[j + 1] += power * share * (x - j);
    };
    for (int k = 0; k < points; ++k) {
      const double v = distances[k];
      const double p_o = std::sqrt(std::max(p * p + v * v - 2 * p * v * cosines[k], 0.0));
      const double reflected = root * root_reflectance(p_o);
      add(p_o, here, beyond, reflected);
      add(p_o, beyond, here, 1 - reflected);
    }
  }

  std::vector<double> h(used, 1.0), next(used);
  for (int iteration = 0; iteration < 500; ++iteration) {
    double change = 0;
    for (int i = 0; i < used; ++i) {
      double sum = 0;
      for (int j = 0; j < used; ++j) sum += matrix[size_t(i) * used + j] * h[j];
      next[i] = sum > 1e-6 ? std::sqrt(h[i] / sum) : 1;  // no power leaves this direction
      change = std::max(change, std::abs(next[i] / h[i] - 1));
    }
    h.swap(next);
    if (change < 1e-7) break;
  }
  std::copy(h.begin(), h.end(), h_out);
}

Spectrum ScattererBalance::factor(const Spectrum& nm, const Spectrum& here, const Spectrum& beyond,
                                  float sine) const {
  return make_spectrum([&](int j) {
    const float y =
        std::clamp(float((1 / double(nm[j]) - first_) * scale_), 0.f, float(wavelength_nodes_ - 1));
    const int l = std::min(int(y), wavelength_nodes_ - 2);
    const float x =
        table_position(float(phase_nm_) / nm[j], here[j], beyond[j], std::min(sine, 1.f) * here[j], kNodes);
    const int i = std::min(int(x), kStride - 2);
    const float* a = &h_[size_t(l) * kStride + i];
    const float* b = a + kStride;
    const float t = x - float(i), s = y - float(l);
    return (a[0] + t * (a[1] - a[0])) * (1 - s) + (b[0] + t * (b[1] - b[0])) * s;
  });
}

}  // namespace aureole

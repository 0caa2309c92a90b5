// SPDX-License-Identifier: Apache-2.0
// `RingAzimuths`: the distribution over the azimuth, in each ring of radius |u|, of an intensity I(u) with
// I(-u) = I(u). For importance sampling: `density` is exactly the density of `sample`.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "aureole/core/parallel_for.h"

namespace aureole::optics {

/// Rings of some widths up to u = 16, up to 64 and up to 256, the last one for all beyond; in each, bins over
/// the half plane that are equal in the pseudo-angle p = (1 - x/(|x| + |y|))/2, which needs no transcendental
/// function.
class RingAzimuths {
public:
  /// Rings per unit of u in the three parts, and bins per unit of u along the half ring.
  struct Layout {
    float rings[3];
    double bins[3];
  };
  static constexpr Layout kShapes{{4, 2, 1}, {4.5, 4.5, 4.5}};  ///< features some 2 wide
  static constexpr Layout kSpots{{16, 4, 1}, {48, 12, 4.5}};    ///< spots of lattices, a tenth wide or so

  /// `extent`: rings up to there are tabulated; the last of them is used beyond. `f` is called from the
  /// threads of `parallel_for`.
  RingAzimuths(const std::function<double(double, double)>& f, double extent, const Layout& layout,
               const ParallelFor& parallel_for = serial_for);
  /// Writes several intensities at the places (x[i], y[i]), the k-th of them to values[k x.size() + i].
  using Intensities =
      std::function<void(std::span<const double> x, std::span<const double> y, std::span<double> values)>;
  /// The distributions of `count` intensities.
  static std::vector<RingAzimuths> of(int count, const Intensities& f, double extent, const Layout& layout,
                                      const ParallelFor& parallel_for = serial_for);

  /// The bins of N points u = (ux, uy) of length `u` > 0; tables of one layout and extent have the same bins.
  template <int N>
  struct Bins {
    std::int32_t index[N];
    float scale[N];  ///< density of a bin over its mass
  };
  template <int N>
  Bins<N> bins(const float* ux, const float* uy, const float* u) const {
    Bins<N> found;
    const int last = int(rings_.size()) - 1;
    for (int j = 0; j < N; ++j) {
      const int index = ring_index(u[j]);
      const Ring& r = rings_[std::size_t(index < last ? index : last)];
      found.index[j] = r.first, found.scale[j] = r.bins;
    }
    for (int j = 0; j < N; ++j) {
      const float x = uy[j] < 0 ? -ux[j] : ux[j];
      const float sum = (ux[j] < 0 ? -ux[j] : ux[j]) + (uy[j] < 0 ? -uy[j] : uy[j]);
      const float inverse = 1 / (sum > 1e-30f ? sum : 1e-30f), count = found.scale[j];
      const float place = (1 - x * inverse) * 0.5f * count, most = count - 1;
      found.index[j] += std::int32_t(place < most ? place : most);
      // Over p: mass times bins; dp/d azimuth = u^2/(2 sum^2); half a ring is pi.
      found.scale[j] = count * 1.57079633f * (u[j] * inverse) * (u[j] * inverse);
    }
    return found;
  }
  /// The density over the azimuth times 2 pi (1 for an isotropic intensity) is this times the bin's scale.
  float mass(std::int32_t index) const { return cdf_[std::size_t(index) + 1] - cdf_[std::size_t(index)]; }
  float density(float ux, float uy, float u) const {
    const Bins<1> b = bins<1>(&ux, &uy, &u);
    return mass(b.index[0]) * b.scale[0];
  }
  /// A unit vector, for xi in [0, 1).
  void sample(float u, float xi, float& cosine, float& sine) const;
  std::size_t bytes() const { return cdf_.size() * sizeof(float) + rings_.size() * sizeof(Ring); }

private:
  RingAzimuths(double extent, const Layout& layout);  // without a distribution
  struct Ring {
    std::int32_t first;  ///< in cdf_
    float bins;          ///< a whole number
  };
  int ring_index(float u) const {
    u = u < 1e6f ? u : 1e6f;
    const float a = layout_.rings[0] * u, b = layout_.rings[1] * u + starts_[1],
                c = layout_.rings[2] * u + starts_[2];
    return int(a < b ? a : b < c ? b : c);
  }
  double ring_start(int index) const;

  const Ring& ring(float u) const {
    const int i = ring_index(u);
    return rings_[std::size_t(i) < rings_.size() ? std::size_t(i) : rings_.size() - 1];
  }

  Layout layout_;
  float starts_[3];  ///< offsets of the lines (number of the ring over u) of the three parts, which cross
                     ///< where the width changes
  std::vector<Ring> rings_;
  std::vector<float> cdf_;  ///< bins + 1 per ring, from 0 to 1
};

}  // namespace aureole::optics

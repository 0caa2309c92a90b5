// SPDX-License-Identifier: Apache-2.0
// `RingAzimuths`: the azimuthal distribution, in each ring of radius |u|, of an intensity with I(-u) = I(u).
// It is for importance sampling: `density` is exactly the density of `sample`.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "aureole/core/parallel_for.h"

namespace aureole::optics {

/// Rings have one width up to u = 16, one up to 64 and one up to 256; the last ring serves all larger u. Each
/// is divided into bins over the half plane that are equal in the pseudo-angle p = (1 - x/(|x| + |y|))/2,
/// which needs no transcendental function.
class RingAzimuths {
public:
  /// Rings per unit of u in the three ranges, and bins per unit of u along the half ring.
  struct Layout {
    float rings[3];
    double bins[3];
    template <class Self, class Fields>
    static void fields(Self& self, Fields& all) {
      all(self.rings, self.bins);
    }
  };
  /// layout for shapes, whose features have a width of some 2
  static constexpr Layout kShapes{{4, 2, 1}, {4.5, 4.5, 4.5}};
  /// layout for lattices, whose spots have a width of about 0.1
  static constexpr Layout kSpots{{16, 4, 1}, {48, 12, 4.5}};

  /// An object without rings, to be read.
  RingAzimuths() = default;
  /// Tabulates rings up to `extent`; the last of them is used beyond. `f` is called from the threads of
  /// `parallel_for`.
  RingAzimuths(const std::function<double(double, double)>& f, double extent, const Layout& layout,
               const ParallelFor& parallel_for = serial_for);
  /// Computes several intensities at the points (x[i], y[i]) and writes the k-th of them to values[k x.size()
  /// + i].
  using Intensities =
      std::function<void(std::span<const double> x, std::span<const double> y, std::span<double> values)>;
  /// Returns the distributions of `count` intensities.
  static std::vector<RingAzimuths> of(int count, const Intensities& f, double extent, const Layout& layout,
                                      const ParallelFor& parallel_for = serial_for);

  /// Finds the bins of N points u = (ux, uy) of length `u` > 0; tables with equal layout and extent have
  /// equal bins.
  template <int N>
  struct Bins {
    std::int32_t index[N];
    float scale[N];  ///< density of a bin over its probability mass
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
      // The density over p is mass times bins; dp/d azimuth = u^2/(2 sum^2); half a ring is pi.
      found.scale[j] = count * 1.57079633f * (u[j] * inverse) * (u[j] * inverse);
    }
    return found;
  }
  /// Returns the probability mass of a bin. Times the bin's scale, it is the density over the azimuth times 2
  /// pi (1 for an isotropic intensity).
  float mass(std::int32_t index) const { return cdf_[std::size_t(index) + 1] - cdf_[std::size_t(index)]; }
  float density(float ux, float uy, float u) const {
    const Bins<1> b = bins<1>(&ux, &uy, &u);
    return mass(b.index[0]) * b.scale[0];
  }
  /// Samples a unit vector (cosine, sine) for xi in [0, 1).
  void sample(float u, float xi, float& cosine, float& sine) const;
  std::size_t bytes() const { return cdf_.size() * sizeof(float) + rings_.size() * sizeof(Ring); }
  /// Calls `all` with the members, for tables that are kept; `self` is constant or not.
  template <class Self, class Fields>
  static void fields(Self& self, Fields& all) {
    all(self.layout_, self.starts_, self.rings_, self.cdf_);
  }

private:
  RingAzimuths(double extent, const Layout& layout);  // makes an object without distributions
  struct Ring {
    std::int32_t first;  ///< index of the ring's first value in cdf_
    float bins;          ///< number of bins, a whole number
    template <class Self, class Fields>
    static void fields(Self& self, Fields& all) {
      all(self.first, self.bins);
    }
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

  Layout layout_{};
  /// Offsets of the linear functions (ring index over u) of the three ranges, which cross where the width
  /// changes
  float starts_[3] = {};
  std::vector<Ring> rings_;
  std::vector<float> cdf_;  ///< cumulative distribution: bins + 1 values per ring, from 0 to 1
};

}  // namespace aureole::optics

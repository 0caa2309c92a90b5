// SPDX-License-Identifier: Apache-2.0
// Functions of the scattering angle over one hemisphere, one per wavelength, on shared nodes. They are
// tabulated over x = 1 - cos(angle from the pole), in [0, 1], and linear in x between nodes. The pole is the
// forward direction for one hemisphere and the backward direction for the other, so that both keep full
// precision. Equal steps of x are equal solid angles. The cumulative distribution is a sum of trapezoids,
// whose inverse needs one square root.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "aureole/spectrum/neighbours.h"
#include "aureole/spectrum/spectrum.h"

namespace aureole {

class HemisphereTable {
public:
  HemisphereTable() = default;
  /// `x` increases from 0 to 1; `values` has one row per x, of `columns` values >= 0.
  HemisphereTable(std::span<const double> x, std::span<const double> values, std::size_t columns);

  /// A position between two nodes.
  struct Place {
    int cell = 0;
    float fraction = 0;  ///< position within the interval, in [0, 1]
  };
  /// Returns the position of x, which may exceed its range by rounding.
  Place find(float x) const;

  /// Values at a position: of one column, and interpolated between neighbouring columns per wavelength.
  float eval(const Place& p, int column) const {
    const float* row = row_of(p);
    return row[column] + p.fraction * (row[stride_ + std::size_t(column)] - row[column]);
  }
  Spectrum eval(const Place& p, const int (&columns)[kWavelengths], const Spectrum& fractions) const {
    const float* row = row_of(p);
    Neighbours n(row, columns);
    n.mix(Neighbours(row + stride_, columns), p.fraction);
    return n.first + (n.second - n.first) * fractions;
  }

  /// Returns the integral of a column over the hemisphere, with the solid angle 2 pi dx.
  double integral(int column) const { return integrals_[std::size_t(column)]; }
  /// Returns the integral of the column times x = 1 - cos.
  double first_moment(int column) const;
  void scale(int column, double factor);
  /// Prepares `sample`; it must be called once the values are final.
  void prepare_samples();

  /// Samples a position with the density of a column. `share` in [0, integral] is the cumulative integral
  /// from the pole.
  Place sample(int column, float share) const;
  float x(const Place& p) const { return cells_[p.cell].begin + p.fraction * width(p.cell); }

  std::size_t bytes() const;

  template <class Self, class Fields>
  static void fields(Self& self, Fields& all) {
    all(self.stride_, self.nodes_, self.cells_, self.values_, self.integrals_, self.guide_, self.guide_base_,
        self.guide_shift_, self.shares_, self.share_guide_);
  }

private:
  struct Cell {
    float begin, rate;  ///< x at the start of a cell, and 1/width of the cell

    template <class Self, class Fields>
    static void fields(Self& self, Fields& all) {
      all(self.begin, self.rate);
    }
  };
  const float* row_of(const Place& p) const { return &values_[std::size_t(p.cell) * stride_]; }
  float width(int cell) const { return 1 / cells_[cell].rate; }
  void make_guide();

  std::size_t stride_ = 1;
  std::vector<double> nodes_;  // x
  std::vector<Cell> cells_;
  std::vector<float> values_;  // values by [node][column]
  std::vector<double> integrals_;
  // First cell for the leading bits of x as a floating-point number. These buckets are uniform in each
  // octave, since peaks at the pole need finer buckets.
  std::vector<std::uint16_t> guide_;
  int guide_base_ = 0, guide_shift_ = 23;
  // For each column, the cumulative integral at all nodes, and the first cell for equal steps of the
  // integral.
  std::vector<float> shares_;
  std::vector<std::uint16_t> share_guide_;
};

}  // namespace aureole

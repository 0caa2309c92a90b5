// SPDX-License-Identifier: Apache-2.0
// Functions of the scattering angle over half of the sphere, one per wavelength, on shared nodes: tabulated
// over x = 1 - cos(angle from the pole), in [0, 1], and linear in x between nodes. The pole is the direction
// straight on for one half and straight back for the other, so that either has its full precision. Equal
// steps of x are equal solid angles, for which the shares of light are sums of trapezoids, whose inverse is a
// square root.
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

  /// A place between two rows.
  struct Place {
    int cell = 0;
    float fraction = 0;  ///< in [0, 1]
  };
  /// x may exceed its range by rounding.
  Place find(float x) const;

  /// Values at a place: of one column, and between each two neighbours of eight columns.
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

  /// The integral of a column over the half, with solid angle 2 pi dx.
  double integral(int column) const { return integrals_[std::size_t(column)]; }
  /// That of column times x: the integral of 1 - cos.
  double first_moment(int column) const;
  void scale(int column, double factor);
  /// To be called when values do not change any more.
  void prepare_samples();

  /// A place with the density of a column; `share` in [0, its integral] is the light nearer to the pole.
  Place sample(int column, float share) const;
  float x(const Place& p) const { return cells_[p.cell].begin + p.fraction * width(p.cell); }

  std::size_t bytes() const;

private:
  struct Cell {
    float begin, rate;  ///< x at the begin, 1/width
  };
  const float* row_of(const Place& p) const { return &values_[std::size_t(p.cell) * stride_]; }
  float width(int cell) const { return 1 / cells_[cell].rate; }
  void make_guide();

  std::size_t stride_ = 1;
  std::vector<double> nodes_;  // x
  std::vector<Cell> cells_;
  std::vector<float> values_;  // [node][column]
  std::vector<double> integrals_;
  // The first cell for the leading bits of x as a floating-point number: buckets that are uniform in each
  // octave, as fine near the pole as peaks are narrow there.
  std::vector<std::uint16_t> guide_;
  int guide_base_ = 0, guide_shift_ = 23;
  // Per column: the shares at all nodes, and the first cell for equal parts of the integral.
  std::vector<float> shares_;
  std::vector<std::uint16_t> share_guide_;
};

}  // namespace aureole

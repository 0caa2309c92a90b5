// SPDX-License-Identifier: Apache-2.0
// Bins of directions adapted to a pdf: a quadtree on each face of a cube, refined where the pdf has mass or
// structure. The mass of each bin is computed by Gauss-Legendre quadrature. For pdfs with discontinuities,
// for which quadrature converges slowly, see direction_grid.h.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "aureole/math/vec.h"
#include "aureole/spectrum/spectrum.h"

namespace aureole {

class DirectionBins {
public:
  /// A pdf and a second function that is integrated together with it.
  struct Value {
    double density = 0;
    Spectrum other;
  };
  using Function = std::function<Value(const Vec3&)>;
  /// A function evaluated for many directions at once.
  using ArrayFunction = std::function<void(std::span<const Vec3>, std::span<Value>)>;

  struct Options {
    double largest_mass = 1.0 / 256;  ///< bins with more mass are divided
    double tolerance = 1e-6;          ///< absolute tolerance of a bin's integrals
    int least_depth = 3, greatest_depth = 15;
    std::vector<Vec3> focus;    ///< bins near these directions are divided down to `focus_angle`
    double focus_angle = 0.02;  ///< size of bins near the directions of `focus` [rad]
    std::vector<Vec3> pilot;    ///< samples that locate narrow lobes; different from the tested samples
    /// upper bound of the number of bins, as a function without any smoothness would be divided without end
    std::size_t most_bins = 4000000;
  };

  struct Bin {
    Vec3 center;
    double mass = 0;
    std::array<double, kWavelengths> other{};
    double size = 0;  ///< edge on the cube's face, approximately in radians
  };

  DirectionBins(const ArrayFunction& f, const Options& options);
  DirectionBins(const Function& f, const Options& options);

  /// Bins in the order of the tree, so that neighbouring bins are close together.
  const std::vector<Bin>& bins() const { return bins_; }
  std::vector<double> masses() const;
  std::size_t find(const Vec3& direction) const;
  double mass() const;
  std::array<double, kWavelengths> other() const;

private:
  struct Node {
    int first_child = -1;
    int bin = -1;
  };
  struct Cell {
    int face;
    double a, b, size;  ///< lower corner and edge, in [-1, 1]^2
  };
  struct Integral {
    double mass = 0;
    std::array<double, kWavelengths> other{};
  };
  /// A node that may still be divided, with the samples in it.
  struct Pending {
    int node;
    Cell cell;
    Integral integral;
    std::vector<Vec3> pilot;
  };
  static Vec3 direction(int face, double a, double b);
  static int locate(const Vec3& d, double& a, double& b);
  static std::vector<Integral> integrate(const ArrayFunction& f, std::span<const Cell> cells);
  void number_bins(int node, const std::vector<Bin>& found);

  std::vector<Node> nodes_;
  std::vector<Bin> bins_;
};

}  // namespace aureole

// SPDX-License-Identifier: Apache-2.0
// The region of the plane covered by a field of view, as estimators need it. Lengths are in pixels; pixel (i,
// j) covers [i, i + 1] x [j, j + 1].
#pragma once

#include <cstdint>
#include <vector>

namespace aureole {

class ObservationWindow {
public:
  /// Window of a field. `seen` is 1 for usable pixels, or empty if all are usable.
  ObservationWindow(int width, int height, const std::vector<std::uint8_t>& seen);

  int width() const { return width_; }
  int height() const { return height_; }

  /// Half the side of the largest square centred at (x, y) that fits into the window; 0 outside.
  double free(double x, double y) const;
  /// Area of the window eroded by a square of half side `reach`. Divided by the window's area, it is the
  /// probability that a shape in such a square is uncut: the Miles-Lantuejoul correction (Lantuejoul,
  /// "Computation of the histograms of the number of edges and neighbours of cells in a tessellation", 1978;
  /// Serra, Image Analysis and Mathematical Morphology, 1982, chapter VIII).
  double area(double reach = 0) const;
  double largest_reach() const { return most_; }

  /// The window eroded by `reach` as a raster of free distances, row by row, with at most `side` cells along
  /// its longer side. 0 outside.
  struct Raster {
    int width, height;
    double cell_x, cell_y;      ///< sides of a cell [pixels]
    std::vector<float> free;    ///< mean over the cell of the free distance beyond `reach`
    std::vector<float> inside;  ///< fraction of the cell that is inside
  };
  Raster raster(double reach, int side) const;

private:
  int width_, height_;
  double most_;
  std::vector<float> free_;        ///< free distances at pixel centres; empty without a mask
  std::vector<double> area_from_;  ///< number of pixels whose free distance is at least i/2
};

/// Area of the intersection of the window eroded by `reach` and itself shifted by (dx, dy): its set
/// covariance, the weight of translation edge correction (Ohser & Stoyan, 1981; Illian et al., Statistical
/// Analysis and Modelling of Spatial Point Patterns, 2008, section 4.2).
class SetCovariance {
public:
  SetCovariance(const ObservationWindow& window, double reach, bool masked);
  double operator()(double dx, double dy) const;

private:
  double width_, height_;  ///< sides of a rectangular window, which has no mask
  int columns_ = 0, rows_ = 0;
  double cell_x_ = 1, cell_y_ = 1;
  std::vector<float> table_;  ///< set covariance as a periodic table of twice the window's size
};

}  // namespace aureole

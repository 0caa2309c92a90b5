// SPDX-License-Identifier: Apache-2.0
// Scattering angles theta in the tables of `correlated_spheres`. v = |w_i + w_o| = 2 sin(theta/2) is zero in
// the forward direction, w = |w_i - w_o| = 2 cos(theta/2) in the backward direction.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "aureole/math/vec.h"

namespace aureole {

/// A scattered direction about the forward direction: w_o + w_i has the component `along` w_i, and `in` and
/// `out` perpendicular to it, in and out of the plane of incidence.
struct Scattered {
  float along, in, out;

  Scattered(double v, double w, double phi)
      : along(float(0.5 * v * v)),
        in(float(0.5 * v * w * std::cos(phi))),
        out(float(0.5 * v * w * std::sin(phi))) {}
  /// Returns |(w_i + w_o)_xy|, the transverse component of the change of direction.
  float transverse(float cos_i, float sin_i) const {
    const float x = along * sin_i + in * cos_i;
    return std::sqrt(x * x + out * out);
  }
  /// Returns |cos theta_o|, the cosine of the scattered direction with the normal.
  float cosine(float cos_i, float sin_i) const {
    return std::min(std::abs((along - 1) * cos_i - in * sin_i), 1.f);
  }
};

/// Cells between nodes that are uniform in w (backward hemisphere, which comes first: cumulative sums keep
/// small terms accurate at their start) or in v (forward). Cells are finer at the centre of each hemisphere.
/// v dv dphi = w dw dphi is the solid angle.
class SphereAngles {
public:
  /// The step between nodes in rad, times the number of terms of Mie's series. The intensity has phases of up
  /// to twice that number times the angle; linear interpolation over this step preserves them to 1 %.
  static constexpr double kStep = 0.125;

  SphereAngles() = default;
  /// Makes cells for Mie series of up to `largest` terms.
  explicit SphereAngles(double largest) {
    constexpr double kFineEnd = 50, kRootTwo = std::numbers::sqrt2;
    constexpr int kMinCells = 64, kFineCells = int(kFineEnd / kStep), kCoarseCells = 384;
    const double fine = std::max(largest / kStep, kMinCells / kRootTwo);
    if (fine * kRootTwo < kFineCells + kCoarseCells) {
      half_ = int(std::ceil(fine * kRootTwo));
      fine_ = coarse_ = float(half_ / kRootTwo);
      split_ = float(kRootTwo);
    } else {
      half_ = kFineCells + kCoarseCells;
      split_ = float(kFineEnd / largest);
      fine_ = float(kFineCells) / split_;
      coarse_ = float(kCoarseCells / (kRootTwo - double(split_)));
      offset_ = float(half_ - kRootTwo * double(coarse_));
    }
  }

  int half() const { return half_; }  ///< number of cells in each hemisphere
  int cells() const { return 2 * half_; }
  bool is_forward(int cell) const { return cell >= half_; }
  /// Returns the cell's index in its hemisphere, from the centre.
  int ring(int cell) const { return is_forward(cell) ? cells() - 1 - cell : cell; }
  /// Returns v or w at a position in its hemisphere.
  double radius(double place) const {
    return place < double(fine_) * double(split_) ? place / double(fine_)
                                                  : (place - double(offset_)) / double(coarse_);
  }
  double area(int cell) const {
    const double a = radius(ring(cell)), b = radius(ring(cell) + 1);
    return std::numbers::pi * (b - a) * (b + a);
  }
  /// Returns the cell of a pair of directions plus the position in it, at most `cells()`.
  float position(const Vec3& wi, const Vec3& wo) const {
    const float v2 = length_squared(wi + wo), w2 = length_squared(wi - wo), r = std::sqrt(std::min(v2, w2));
    const float place = std::min(std::min(fine_ * r, coarse_ * r + offset_), float(half_));
    return v2 <= w2 ? float(cells()) - place : place;
  }

  template <class Self, class Fields>
  static void fields(Self& self, Fields& all) {
    all(self.fine_, self.coarse_, self.offset_, self.split_, self.half_);
  }

private:
  float fine_ = 1, coarse_ = 1, offset_ = 0, split_ = 1;
  int half_ = 1;
};

}  // namespace aureole

// SPDX-License-Identifier: Apache-2.0
// Diffuse interreflection in an empty box: exchange areas of rectangles in closed form, and the radiosity equations.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace aureole::optics {

struct Interval {
  double low = 0, high = 0;
};

/// The exchange area A_1 F_12 = A_2 F_21 [m^2] of two rectangles in parallel planes at a distance [m]; their sides run along x
/// and y (J. R. Ehlert and T. F. Smith, "View factors for perpendicular and parallel rectangular plates", 1993).
double parallel_exchange(Interval x1, Interval y1, Interval x2, Interval y2, double distance);

/// The exchange area [m^2] of the rectangle (x, y1) in the plane z = 0 and the rectangle (z, y2) in the plane x = 0, for x and
/// z that are not negative (ibid.).
double perpendicular_exchange(Interval x, Interval y1, Interval z, Interval y2);

enum class BoxSurface { floor, ceiling, wall };

/// A part of a box's inner surface: a rectangle across the axis `normal` (0, 1, 2 for x, y, z) at the end `side` of it (0 or
/// 1). `first` and `second` are its intervals along the other two axes in their order [m].
struct BoxPatch {
  BoxSurface surface = BoxSurface::floor;
  int normal = 2, side = 0;
  Interval first, second;
  double area() const { return (first.high - first.low) * (second.high - second.low); }
};

/// The box [0, x] x [0, y] x [0, height], divided into zones of even exitance.
class BoxRadiosity {
public:
  /// Three zones, floor, ceiling and all walls together, as the utilisation factors of CIE 52-1982 and CIE 190:2010 have them.
  static BoxRadiosity of_surfaces(double x, double y, double height);
  /// Rectangular patches with sides up to `largest_side` [m].
  static BoxRadiosity of_patches(double x, double y, double height, double largest_side);

  /// The patches of the zones, in their order; empty for the three zones of `of_surfaces`.
  const std::vector<BoxPatch>& patches() const { return patches_; }
  /// Numbers of patches along x, y and the height; 0 for `of_surfaces`.
  const std::array<std::size_t, 3>& parts() const { return parts_; }
  std::size_t size() const { return areas_.size(); }
  BoxSurface surface(std::size_t zone) const { return surfaces_[zone]; }
  double area(std::size_t zone) const { return areas_[zone]; }
  double exchange(std::size_t i, std::size_t j) const { return exchange_[i * size() + j]; }

  /// The incident flux of each zone, direct and reflected, by its direct flux and the reflectances of floor, ceiling and walls
  /// (below 1). Throws std::domain_error for other reflectances and another number of fluxes.
  std::vector<double> incident(const std::vector<double>& direct,
                               const std::array<double, 3>& reflectances) const;

private:
  std::vector<BoxPatch> patches_;
  std::array<std::size_t, 3> parts_{};
  std::vector<BoxSurface> surfaces_;
  std::vector<double> areas_, exchange_;
};

}  // namespace aureole::optics

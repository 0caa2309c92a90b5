// SPDX-License-Identifier: Apache-2.0
// `SplatField`: Gaussian splats as a field of extinction, with the cells of a grid that list the splats in them.
#pragma once

#include <optional>
#include <vector>

#include "aureole/medium/classified/transfer_function.h"
#include "aureole/medium/majorant_grid.h"
#include "aureole/medium/splats/splat_cells.h"
#include "aureole/parameter/splat/splat_cloud.h"

namespace aureole {

class SplatField {
public:
  /// The direction through the centre of a splat along which its thickness gives the stated opacity.
  enum class OpacityAlong { shortest, mean };
  struct Options {
    OpacityAlong along = OpacityAlong::shortest;
    float cutoff = 3;  ///< Mahalanobis distance at which a splat ends
    float extinction_scale = 1;
  };

  /// A Gaussian in world space: its extinction at p is peak exp(-|whiten (p - center)|^2 / 2) [1/length].
  struct Splat {
    Vec3 center;
    Vec3 whiten[3];  ///< rows of the matrix that turns the ellipsoid into the unit sphere
    float peak;
    std::uint32_t index;  ///< in the cloud
    ColorWeights color;   ///< without a direction

    Vec3 whitened(const Vec3& v) const { return {dot(whiten[0], v), dot(whiten[1], v), dot(whiten[2], v)}; }
  };

  /// Keeps a reference to the cloud.
  SplatField(const SplatCloud& cloud, const Transform& to_world, const Options& options);

  /// Extinction at a point, and the sum of the splats' colours weighted by their extinctions.
  struct Sample {
    float extinction = 0;
    ColorWeights color;
  };
  Sample at(const Vec3& p) const;
  /// With the colours that a viewer sees who looks along d.
  Sample seen_along(const Vec3& p, const Vec3& d) const;
  /// The optical thickness along a ray of unit direction up to the distance t_max, in closed form: splats that overlap
  /// add, whatever their order.
  double optical_thickness(const Ray& ray, float t_max) const;
  /// The distance along such a ray at which its thickness is `wanted`; infinity where it is not up to t_max.
  float distance_of_thickness(const Ray& ray, float t_max, double wanted) const;

  /// Upper bounds of the extinction.
  const MajorantGrid& grid() const { return *grid_; }
  const std::vector<Splat>& splats() const { return splats_; }
  /// Number of splats whose shortest scale was raised to 1/100 of the longest, and number of splats without
  /// any extent.
  std::size_t thickened() const { return thickened_; }
  std::size_t without_extent() const { return without_extent_; }

private:
  void make_cells();
  /// A splat along a piece of a ray: the thickness up to the distance t is scale (erf(root (t - middle)) - low), with t held
  /// between `from` and `to`.
  struct SplatOnRay {
    double scale, root, middle, from, to, low;

    double up_to(double t) const;
  };
  /// Calls visit(splat) for the splats on a piece of a ray that lies in one cell.
  template <class Visit>
  void for_splats(const Ray& ray, const MajorantGrid::Piece& piece, const Visit& visit) const;
  template <class ColorOf>
  Sample sum_at(const Vec3& p, const ColorOf& color_of) const;

  const SplatCloud& cloud_;
  Transform turn_;  ///< the rotation of the world to the axes of the cloud

  Options options_;
  std::vector<Splat> splats_;
  std::vector<Bounds3> boxes_;  ///< bounding boxes of the splats; empty once the cells are made
  std::vector<float> longest_;  ///< longest semi-axis of each splat [length]; empty once the cells are made
  std::size_t thickened_ = 0, without_extent_ = 0;
  SplatCells cells_;
  std::optional<MajorantGrid> grid_;
};

}  // namespace aureole

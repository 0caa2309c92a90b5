// SPDX-License-Identifier: Apache-2.0
// `RaySplats`: the Gaussian splats of a scene along rays, for sensors without a single centre of projection.
#pragma once

#include <span>
#include <vector>

#include "aureole/integrator/splat/splat_blend.h"
#include "aureole/medium/majorant_grid.h"
#include "aureole/medium/splats/splat_cells.h"

namespace aureole {

/// A splat is seen by a ray with the largest value of its Gaussian along it, and in the order of the places where that is
/// (Moenne-Loccoz and others 2024, "3D Gaussian ray tracing: fast tracing of particle scenes"). Where splats are small in the
/// picture this is the tangential projection without dilation.
class RaySplats {
public:
  RaySplats(std::span<const SplatMedium* const> media, const SplatSettings& settings);

  /// Blends the splats along a ray of unit direction up to its t_max. Sets colour, transmittance and distance.
  void blend(const SplatSettings& settings, const Ray& ray, SplatSample& sample) const;
  std::size_t size() const { return splats_.size(); }

private:
  struct RaySplat {
    Vec3 center;
    Vec3 whiten[3];  ///< rows of the matrix that turns the ellipsoid into the unit sphere
    float opacity;
    float limit;  ///< square of the Mahalanobis distance at which the splat ends
    std::uint32_t medium, index;

    Vec3 whitened(const Vec3& v) const { return {dot(whiten[0], v), dot(whiten[1], v), dot(whiten[2], v)}; }
  };
  struct Source {
    const SplatCloud* cloud;
    Transform turn;  ///< the rotation of the world to the axes of the cloud
  };
  std::vector<Source> sources_;
  std::vector<RaySplat> splats_;
  SplatCells cells_;
  std::optional<MajorantGrid> grid_;  ///< 1 in cells with splats
};

}  // namespace aureole

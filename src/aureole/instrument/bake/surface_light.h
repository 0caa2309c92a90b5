// SPDX-License-Identifier: Apache-2.0
// `SurfaceLight`: the radiance that leaves points of a scene's surfaces, followed by its integrator, for baking.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "aureole/integrator/aov_channels.h"
#include "aureole/loading/load.h"
#include "aureole/math/piecewise.h"
#include "aureole/transport/path.h"

namespace aureole {

class SurfaceLight {
public:
  /// How many points there are per area: equally many everywhere, or in inverse proportion to the square of the distance from
  /// the scene's sensor, so that distances of neighbours look equal from there.
  enum class Density { area, camera };

  /// Throws Error if there is no surface to bake, or where the integrator follows no light from a place.
  SurfaceLight(const LoadedScene& loaded, float exposure, std::uint64_t seed,
               Density density = Density::area);

  /// Area of all surfaces [length^2].
  double area() const { return area_; }
  /// Notes on surfaces and media that are left out.
  const std::vector<std::string>& notes() const { return notes_; }

  struct Point {
    Vec3 p, n;
    float spacing;  ///< mean distance of neighbours there [length]
  };
  /// Returns point i of `count` points; nothing where a surface has none there.
  std::optional<Point> point(std::size_t i, std::size_t count) const;

  /// Light in directions of the hemispheres above points: the direction in which a camera looks, and the radiance in linear
  /// sRGB in units of D65, times the exposure.
  struct Samples {
    std::vector<Vec3> looks, colors;
    std::size_t lost = 0;  ///< paths without finite light

    void clear() { looks.clear(), colors.clear(), lost = 0; }
  };
  /// Adds `count` paths from a point, in directions that are even in solid angle. `key` and `first` choose their random
  /// numbers; rays begin at the distance `start` above the surface.
  void add_samples(const Point& point, std::uint64_t key, int first, int count, float start,
                   Samples& samples) const;

private:
  struct Patch {
    const AreaSampler* sampler;
    std::size_t patch;
    float area;
    Piecewise2D within;  ///< of its unit square, by density; empty: uniform
    bool varies = false;
  };
  /// Weights of the cells of a patch, by the distance from `eye`. Returns their integral over the area.
  static double weigh_by_distance(Patch& patch, const Vec3& eye);

  const LoadedScene& loaded_;
  const float exposure_;
  const std::uint64_t seed_;
  const ColourMeter meter_;
  std::vector<std::shared_ptr<const AreaSampler>> samplers_;
  std::vector<Patch> patches_;
  Piecewise1D choice_;
  double area_ = 0;
  std::vector<std::string> notes_;
};

/// Writes the (degree + 1)^2 coefficients of a colour by direction, encoded as sRGB: the mean for degree 0, else the fit by
/// least squares of the light and then of its encoded values. Without samples the colour is black.
void fit_encoded_harmonics(int degree, const SurfaceLight::Samples& samples, float* out);

}  // namespace aureole

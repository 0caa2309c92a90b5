// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/bake/splat_bake.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "aureole/core/parallel.h"
#include "aureole/instrument/bake/surface_light.h"

namespace aureole {

SplatBake bake_splats(const LoadedScene& loaded, const SplatBakeOptions& options) {
  const SurfaceLight light(loaded, options.exposure, options.seed, options.density);
  SplatBake bake;
  bake.area = light.area(), bake.notes = light.notes();
  const int degree = options.as_points ? 0 : options.degree;
  SplatCloud& cloud = bake.cloud;
  cloud.kind = options.as_points ? SplatCloud::Kind::points : SplatCloud::Kind::gaussians;
  cloud.format = "baked", cloud.axes = "RUB", cloud.has_normals = options.as_points;
  cloud.resize(options.count, degree);
  const std::size_t terms = cloud.coefficients();
  std::vector<std::uint32_t> lost(options.count, 0);
  for_ranges(
      options.count,
      [&](std::size_t begin, std::size_t end) {
        SurfaceLight::Samples samples;
        for (std::size_t i = begin; i < end; ++i) {
          const auto point = light.point(i, options.count);
          samples.clear();
          if (point) {
            // Rays begin above the surface, but not so far that another one lies between often.
            constexpr float kStart = 0.1f;
            light.add_samples(*point, i, 0, options.paths, kStart * point->spacing, samples);
          }
          const float spacing = point ? point->spacing : 0;
          lost[i] = std::uint32_t(samples.lost) + (point ? 0 : 1);
          fit_encoded_harmonics(degree, samples, &cloud.harmonics[3 * terms * i]);
          const Vec3 n = point ? point->n : Vec3{0, 0, 1};
          cloud.positions[i] = point ? point->p : Vec3{};
          const float z = std::max(-0.999999f, n.z), w = std::sqrt(0.5f * (1 + z));
          cloud.rotations[i] = {w, -n.y / (2 * w), n.x / (2 * w), 0};
          const float norm = std::sqrt(w * w + (n.x * n.x + n.y * n.y) / (4 * w * w));
          for (float& q : cloud.rotations[i]) q /= norm;
          cloud.opacities[i] = options.as_points ? 1.f : options.opacity;
          const float radius = spacing * (options.as_points ? 0.8f : options.coverage);
          cloud.scales[i] = {radius, radius, options.as_points ? 0.f : 0.1f * radius};
        }
      },
      64);
  std::size_t all_lost = 0;
  for (const std::uint32_t n : lost) all_lost += n;
  if (all_lost > 0)
    bake.notes.push_back(fmt::format("{} paths had no finite light and are left out", all_lost));
  return bake;
}

}  // namespace aureole

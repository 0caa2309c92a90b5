// SPDX-License-Identifier: Apache-2.0
// The light of a radiance grid along one ray: the discrete sum of NeRF, or the integral that it approximates.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "aureole/medium/radiance/radiance_medium.h"
#include "aureole/plugin/registry.h"

namespace aureole {

struct RadianceSettings {
  enum class Method { nerf, exact };
  /// The place of a step at which density and colour are taken.
  enum class Samples { start, middle, jittered };

  Method method;
  Samples samples;
  bool last_is_opaque;  ///< the last step is infinitely long
  bool blends_linear;   ///< encoded colours are decoded before they are blended
  float step;           ///< [voxels]
  float density_limit;  ///< samples of less density are left out [1/length of the grid]
  float termination;    ///< transmittance at which a ray ends; 0: never
  std::optional<Vec3> background;

  /// Throws located Errors.
  static RadianceSettings read(const Properties& properties);
  static std::vector<ParameterDoc> rows();
};

struct RadianceResult {
  float color[3] = {0, 0, 0};  ///< sum of the colours by their opacities, in the colours that are blended
  float transmittance = 1;     ///< of the light from behind
  float depth = 0;             ///< distance at which half of that light is lost [length]; 0: less is lost
};

/// Composites the grid of `medium` along a ray of unit direction up to its t_max. `key` chooses the random numbers of jittered
/// samples.
RadianceResult march_radiance(const RadianceMedium& medium, const RadianceSettings& settings, const Ray& ray,
                              std::uint64_t key);

}  // namespace aureole

// SPDX-License-Identifier: Apache-2.0
// Light that arrives at points of a volume along one ray of `dvr`, and how gradient shading and scattering show it.
#pragma once

#include <optional>

#include "aureole/core/keyed_random.h"
#include "aureole/integrator/dvr/settings.h"
#include "aureole/medium/classified/classified_medium.h"
#include "aureole/scene/scene.h"
#include "aureole/transport/path.h"
#include "aureole/transport/ray_state.h"

namespace aureole {

class VolumeLighting {
public:
  VolumeLighting(const Scene& scene, const DvrSettings& settings, const Path& path, const Spectrum& d65,
                 KeyedRandom& random)
      : scene_(scene), settings_(settings), path_(path), d65_(d65), random_(random) {}

  /// Radiance towards the sensor of a point with the given colour and gradient, per part of its opacity: Levoy's shading.
  /// Without a gradient the ambient part is left.
  Spectrum shaded(const ClassifiedMedium& medium, const Vec3& p, const Spectrum& color, const Vec3& gradient);
  /// Radiance towards the sensor that the medium scatters once, per part of its extinction, with this albedo.
  Spectrum scattered(const ClassifiedMedium& medium, const Vec3& p, const Spectrum& albedo);

private:
  /// Calls visit(direction, irradiance of a plane towards it) for light samples at p.
  template <class Visit>
  void visit_lights(const ClassifiedMedium& medium, const Vec3& p, bool shadows, const Visit& visit);
  /// Mean transmittance of rays around `n`, distributed by their cosine.
  float ambient(const ClassifiedMedium& medium, const Vec3& p, const Vec3& n);

  const Scene& scene_;
  const DvrSettings& settings_;
  const Path& path_;
  const Spectrum& d65_;
  KeyedRandom& random_;
  std::optional<RayState> start_;  ///< where shadow rays of `start_medium_` begin
  const ClassifiedMedium* start_medium_ = nullptr;
};

/// Optical thickness of a medium along a ray of unit direction up to a distance, by steps of the given length.
float optical_thickness(const ClassifiedMedium& medium, const Ray& ray, float length, float step);

}  // namespace aureole

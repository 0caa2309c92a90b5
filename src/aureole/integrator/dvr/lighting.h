// SPDX-License-Identifier: Apache-2.0
// Light that arrives at points of a volume along one ray of `dvr`, and the radiance of gradient shading and
// of scattering there.
#pragma once

#include <span>

#include "aureole/core/keyed_random.h"
#include "aureole/integrator/dvr/settings.h"
#include "aureole/medium/classified/classified_medium.h"
#include "aureole/scene/scene.h"
#include "aureole/transport/path.h"

namespace aureole {

class VolumeLighting {
public:
  VolumeLighting(const Scene& scene, std::span<const ClassifiedMedium* const> media,
                 const DvrSettings& settings, const Path& path, const Spectrum& d65, KeyedRandom& random)
      : scene_(scene), media_(media), settings_(settings), path_(path), d65_(d65), random_(random) {}

  /// Whether each point is shaded by all lights, without random numbers: few lights, at points or infinitely far away.
  static bool samples_all_lights(const Scene& scene);

  /// Radiance towards the sensor of a point with the given colour and gradient, per unit of its opacity, by
  /// Levoy's shading. Without a gradient only the ambient term remains.
  Spectrum shaded(const ClassifiedMedium& medium, const Vec3& p, const Spectrum& color, const Vec3& gradient);
  /// Single-scattered radiance towards the sensor, per unit of extinction, for this albedo.
  Spectrum scattered(const ClassifiedMedium& medium, const Vec3& p, const Spectrum& albedo);

private:
  /// Calls visit(direction, irradiance of a plane towards it) for light samples at p.
  template <class Visit>
  void visit_lights(const Vec3& p, bool shadows, const Visit& visit);
  /// Transmittance of all classified media along a ray of unit direction up to a distance.
  float transmittance(const Ray& ray, float length, float step) const;
  /// Mean transmittance of rays around `n`, distributed by their cosine.
  float ambient(const Vec3& p, const Vec3& n);

  const Scene& scene_;
  const std::span<const ClassifiedMedium* const> media_;
  const DvrSettings& settings_;
  const Path& path_;
  const Spectrum& d65_;
  KeyedRandom& random_;
};

}  // namespace aureole

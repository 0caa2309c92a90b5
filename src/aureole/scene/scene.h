// SPDX-License-Identifier: Apache-2.0
// `Scene`: everything a job renders, ready for rays.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "aureole/scene/build.h"
#include "aureole/scene/light_sampler.h"
#include "aureole/scene/ray_tracer.h"
#include "aureole/sensor/sensor.h"

namespace aureole {

class Scene {
public:
  /// Attaches emitters to their shapes, builds the ray tracer, the light tree and the density of wavelengths.
  /// The ray tracer of `previous` is kept where both have the same shapes.
  explicit Scene(LoadedScene loaded, const Scene* previous = nullptr);

  /// The nearest surface point along a ray.
  std::optional<SurfacePoint> intersect(const Ray& ray) const {
    const RayTracer::Hit hit = tracer_->intersect(ray);
    if (!hit) return {};
    return surface_point(hit, ray);
  }
  /// The point that the ray tracer met.
  SurfacePoint surface_point(const RayTracer::Hit& hit, const Ray& ray) const {
    return shapes_[hit.shape]->surface_point(hit, ray);
  }
  const RayTracer& tracer() const { return *tracer_; }
  /// The fraction of light that passes, per wavelength, from a surface point to the other end of a
  /// connection: the only visibility call. Emitters' surfaces may be left out (`hide_emitters`).
  Spectrum connect(const SurfacePoint& from, const DirectSample& to, const Wavelengths& w,
                   bool through_emitters = false) const;
  /// The segment that `connect` tests.
  static Ray connection_ray(const SurfacePoint& from, const DirectSample& to) {
    const Vec3 o = offset_origin(from, to.wo);
    if (to.infinite) return {o, to.wo, kInfinity};
    return {o, connection_target(o, to) - o, 1};
  }
  /// False where a ray can meet no emitter: one that needs no tracing if nothing else counts.
  bool may_meet_emitter(const Ray& ray) const;
  /// Every connection is open or blocked: whether its ray meets anything says all.
  bool has_binary_visibility() const { return !any_passable_; }

  const Sensor& sensor() const { return *sensor_; }
  const Film& film() const { return sensor_->film(); }
  const std::vector<ShapePtr>& shapes() const { return shapes_; }
  const std::vector<const Emitter*>& emitters() const { return emitters_; }
  /// Those that rays which leave the scene may see.
  const std::vector<const Emitter*>& infinite_emitters() const { return infinite_; }
  const LightSampler& lights() const { return lights_; }
  const WavelengthDistribution& wavelengths() const { return *wavelengths_; }
  const ObjectPtr& integrator_object() const { return loaded_.integrator; }
  const LoadedScene& loaded() const { return loaded_; }
  /// What passes straight through the surface for light along `d` (either way).
  static Spectrum null_transmittance(const SurfacePoint& point, const Vec3& d, const Wavelengths& w);
  Bounds3 bounds() const { return tracer_->bounds(); }
  std::uint64_t hash() const { return loaded_.hash; }

private:
  /// The far end of a connection from `o`, off its surface, so that the segment needs no shortening by a
  /// constant. The rounding of the ray's own arithmetic counts too: direction, distance and differences of
  /// the length of the segment, gamma(10) of each.
  static Vec3 connection_target(const Vec3& o, const DirectSample& to) {
    const Vec3 p_error = to.p_error + (abs(o) + abs(to.p) + abs(to.p - o)) * gamma_bound(10);
    return offset_origin(to.p, p_error, to.ng, -to.wo);
  }

  LoadedScene loaded_;
  std::vector<ShapePtr> shapes_;
  std::vector<const Emitter*> emitters_, infinite_;
  std::shared_ptr<Sensor> sensor_;
  std::shared_ptr<const RayTracer> tracer_;
  LightSampler lights_;
  std::unique_ptr<WavelengthDistribution> wavelengths_;
  std::vector<Bounds3> emitter_bounds_;  ///< of shapes that shine, where they are few
  bool any_passable_ = false;            ///< connections may have to pass surfaces
};

}  // namespace aureole

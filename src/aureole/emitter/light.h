// SPDX-License-Identifier: Apache-2.0
// `Light`: an emitter together with its position in the scene.
#pragma once

#include <cstdint>

#include "aureole/emitter/emitter.h"
#include "aureole/emitter/light_motion.h"

namespace aureole {

class AreaSampler;
class Shape;

/// An emitter with the scene data that its methods need: shape, area sampler, bounds. The member functions
/// pass these data to the emitter, and multiply its light by its modulation over time. The scene owns everything pointed to.
struct Light {
  const Emitter* emitter = nullptr;
  // Shape and area of an emitter on a shape; otherwise null and zero.
  const Shape* shape = nullptr;
  const AreaSampler* area = nullptr;
  double surface_area = 0;
  /// The scene's bounding sphere.
  Vec3 scene_center;
  float scene_radius = 1;
  std::uint32_t index = 0;  ///< index among the scene's lights
  /// How the light moves; null: it stays where its emitter and its shape are written. The methods below take and give points
  /// of the scene.
  const LightMotion* motion = nullptr;
  float first_time = 0, last_time = 0;  ///< [s] between which it moves during the exposure

  float sampling_weight() const { return emitter->sampling_weight(); }
  bool is_infinite() const { return emitter->is_infinite(); }
  bool is_delta() const { return emitter->is_delta(); }
  const Properties& properties() const { return emitter->properties(); }

  std::size_t part_count() const { return emitter->part_count(*this); }
  std::size_t part_of(const SurfacePoint& point) const { return emitter->part_of(*this, point); }
  Spectrum eval(const SurfacePoint& point, const Vec3& w, const Wavelengths& wavelengths) const {
    return modulated(motion ? eval_moved(point, w, wavelengths) : emitter->eval(point, w, wavelengths),
                     wavelengths);
  }
  Spectrum eval_escaped(const Vec3& d, const Wavelengths& wavelengths) const {
    return modulated(emitter->eval_escaped(d, wavelengths), wavelengths);
  }
  std::optional<DirectSample> sample_direct(const Vec3& reference, std::size_t part, Vec2 u,
                                            const Wavelengths& wavelengths) const {
    auto s = motion ? sample_direct_moved(reference, {}, part, u, wavelengths)
                    : emitter->sample_direct(*this, reference, part, u, wavelengths);
    if (emitter->modulation() && s) s->radiance = modulated(s->radiance, wavelengths);
    return s;
  }
  std::optional<DirectSample> sample_direct_facing(const Vec3& reference, const Vec3& facing,
                                                   std::size_t part, Vec2 u,
                                                   const Wavelengths& wavelengths) const {
    auto s = motion ? sample_direct_moved(reference, facing, part, u, wavelengths)
                    : emitter->sample_direct_facing(*this, reference, facing, part, u, wavelengths);
    if (emitter->modulation() && s) s->radiance = modulated(s->radiance, wavelengths);
    return s;
  }
  float pdf_direct(const Vec3& reference, std::size_t part, const SurfacePoint& point) const {
    return motion ? pdf_direct_moved(reference, part, point)
                  : emitter->pdf_direct(*this, reference, part, point);
  }
  float pdf_direct(const Vec3& reference, const SurfacePoint& point) const {
    return pdf_direct(reference, part_of(point), point);
  }
  float pdf_direct_escaped(const Vec3& reference, const Vec3& facing, const Vec3& d) const {
    return emitter->pdf_direct_escaped(reference, facing, d);
  }
  std::optional<EmittedRay> sample_ray(std::size_t part, Vec2 position, Vec2 direction,
                                       const Wavelengths& wavelengths) const {
    auto s = motion ? sample_ray_moved(part, position, direction, wavelengths)
                    : emitter->sample_ray(*this, part, position, direction, wavelengths);
    if (motion && s) s->time = wavelengths.time;
    if (emitter->modulation() && s) s->value = modulated(s->value, wavelengths);
    return s;
  }
  /// `time` [s] matters for lights that move.
  RayDensity pdf_ray(std::size_t part, const SurfacePoint* point, const Vec3& d, float time = 0) const {
    return motion ? pdf_ray_moved(part, point, d, time) : emitter->pdf_ray(*this, part, point, d);
  }
  RayDensity pdf_ray(const SurfacePoint* point, const Vec3& d) const {
    return pdf_ray(point ? part_of(*point) : 0, point, d, point ? point->time : 0);
  }
  /// Emission of an emitter at the time of the path.
  Spectrum modulated(const Spectrum& emission, const Wavelengths& wavelengths) const {
    const Modulation* modulation = emitter->modulation();
    return modulation ? emission * modulation->at(double(wavelengths.time)) : emission;
  }
  SampledSpectrum power_spectrum() const { return emitter->power_spectrum(*this); }
  EmissionBounds emission_bounds(std::size_t part) const {
    return motion ? emission_bounds_moved(part) : emitter->emission_bounds(*this, part);
  }
  /// Whether its light or its place depends on the time.
  bool changes() const { return emitter->changes() || (motion && motion->is_moving()); }

private:
  Spectrum eval_moved(const SurfacePoint& point, const Vec3& w, const Wavelengths& wavelengths) const;
  std::optional<DirectSample> sample_direct_moved(const Vec3& reference, const Vec3& facing, std::size_t part,
                                                  Vec2 u, const Wavelengths& wavelengths) const;
  std::optional<EmittedRay> sample_ray_moved(std::size_t part, Vec2 position, Vec2 direction,
                                             const Wavelengths& wavelengths) const;
  float pdf_direct_moved(const Vec3& reference, std::size_t part, const SurfacePoint& point) const;
  RayDensity pdf_ray_moved(std::size_t part, const SurfacePoint* point, const Vec3& d, float time) const;
  EmissionBounds emission_bounds_moved(std::size_t part) const;
};

}  // namespace aureole

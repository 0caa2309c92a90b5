// SPDX-License-Identifier: Apache-2.0
// `Light`: an emitter together with its position in the scene.
#pragma once

#include <cstdint>

#include "aureole/emitter/emitter.h"

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

  float sampling_weight() const { return emitter->sampling_weight(); }
  bool is_infinite() const { return emitter->is_infinite(); }
  bool is_delta() const { return emitter->is_delta(); }
  const Properties& properties() const { return emitter->properties(); }

  std::size_t part_count() const { return emitter->part_count(*this); }
  std::size_t part_of(const SurfacePoint& point) const { return emitter->part_of(*this, point); }
  Spectrum eval(const SurfacePoint& point, const Vec3& w, const Wavelengths& wavelengths) const {
    return modulated(emitter->eval(point, w, wavelengths), wavelengths);
  }
  Spectrum eval_escaped(const Vec3& d, const Wavelengths& wavelengths) const {
    return modulated(emitter->eval_escaped(d, wavelengths), wavelengths);
  }
  std::optional<DirectSample> sample_direct(const Vec3& reference, std::size_t part, Vec2 u,
                                            const Wavelengths& wavelengths) const {
    auto s = emitter->sample_direct(*this, reference, part, u, wavelengths);
    if (emitter->modulation() && s) s->radiance = modulated(s->radiance, wavelengths);
    return s;
  }
  std::optional<DirectSample> sample_direct_facing(const Vec3& reference, const Vec3& facing,
                                                   std::size_t part, Vec2 u,
                                                   const Wavelengths& wavelengths) const {
    auto s = emitter->sample_direct_facing(*this, reference, facing, part, u, wavelengths);
    if (emitter->modulation() && s) s->radiance = modulated(s->radiance, wavelengths);
    return s;
  }
  float pdf_direct(const Vec3& reference, std::size_t part, const SurfacePoint& point) const {
    return emitter->pdf_direct(*this, reference, part, point);
  }
  float pdf_direct(const Vec3& reference, const SurfacePoint& point) const {
    return pdf_direct(reference, part_of(point), point);
  }
  float pdf_direct_escaped(const Vec3& reference, const Vec3& facing, const Vec3& d) const {
    return emitter->pdf_direct_escaped(reference, facing, d);
  }
  std::optional<EmittedRay> sample_ray(std::size_t part, Vec2 position, Vec2 direction,
                                       const Wavelengths& wavelengths) const {
    auto s = emitter->sample_ray(*this, part, position, direction, wavelengths);
    if (emitter->modulation() && s) s->value = modulated(s->value, wavelengths);
    return s;
  }
  RayDensity pdf_ray(std::size_t part, const SurfacePoint* point, const Vec3& d) const {
    return emitter->pdf_ray(*this, part, point, d);
  }
  RayDensity pdf_ray(const SurfacePoint* point, const Vec3& d) const {
    return pdf_ray(point ? part_of(*point) : 0, point, d);
  }
  /// Emission of an emitter at the time of the path.
  Spectrum modulated(const Spectrum& emission, const Wavelengths& wavelengths) const {
    const Modulation* modulation = emitter->modulation();
    return modulation ? emission * modulation->at(double(wavelengths.time)) : emission;
  }
  SampledSpectrum power_spectrum() const { return emitter->power_spectrum(*this); }
  EmissionBounds emission_bounds(std::size_t part) const { return emitter->emission_bounds(*this, part); }
};

}  // namespace aureole

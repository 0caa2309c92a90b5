// SPDX-License-Identifier: Apache-2.0
// The emitter family. An emitter is a model of emission; its position in the scene is stored in a `Light`
// (light.h), which is passed to its methods. A light has one or several parts (patches of a shape); light
// selection chooses a part.
#pragma once

#include <memory>
#include <optional>

#include "aureole/math/motion.h"
#include "aureole/medium/medium.h"
#include "aureole/modulation/modulation.h"
#include "aureole/plugin/object.h"
#include "aureole/shape/surface_point.h"
#include "aureole/spectrum/wavelengths.h"

namespace aureole {

struct Light;

/// A direction towards an emitter, sampled by `Emitter::sample_direct`.
struct DirectSample {
  Vec3 wo;       ///< unit direction from the reference point towards the emitter
  Vec3 p;        ///< the other endpoint of the segment; for an emitter at infinity a point beyond the
                 ///< scene
  Vec3 p_error;  ///< rounding error bound of p; zero for points that lie on no surface
  Vec3 ng;       ///< geometric normal; zero for points that lie on no surface
  /// radiance arriving along -wo; for a delta emitter the factor of the delta function (irradiance)
  Spectrum radiance;
  float pdf = 0;  ///< pdf [1/sr], or 1 (a probability mass) if `delta`
  bool delta = false;
  bool infinite = false;
};

/// A ray of light that leaves an emitter, sampled by `Emitter::sample_ray`.
struct EmittedRay {
  Vec3 p;        ///< origin of the ray; for an emitter at infinity a point outside the scene
  Vec3 p_error;  ///< rounding error bound of p; zero for points that lie on no surface
  Vec3 ng;       ///< geometric normal; zero for points that lie on no surface
  Vec3 d;        ///< unit direction of travel
  /// Emission along the ray. From a surface: radiance times |cos|, or the exitance if the direction is a
  /// delta. From a point: the intensity. From infinity: the radiance, or, if the direction is a delta, the
  /// irradiance on a plane perpendicular to it.
  Spectrum value;
  float pdf_position = 0;   ///< pdf [1/m^2], or a probability mass if `delta_position`
  float pdf_direction = 0;  ///< pdf [1/sr], or a probability mass if `delta_direction`
  bool delta_position = false, delta_direction = false;
  float time = 0;  ///< [s], of a light that moves
};

/// The pdfs of `Emitter::sample_ray`, or probability masses for delta positions and directions.
struct RayDensity {
  float position = 0, direction = 0;
};

/// Bounds of the emission of a part, for light selection (Conty Estevez & Kulla 2018, "Importance sampling of
/// many lights with adaptive tree splitting").
struct EmissionBounds {
  Bounds3 box;
  Vec3 axis{0, 0, 1};
  float cos_normals = -1;  ///< cosine of the half-angle of the cone of normals around `axis`
  float cos_emission = 0;  ///< cosine of the largest angle between a normal and an emitted direction (0 for a
                           ///< surface)
  float power = 1;         ///< fraction of the emitter's power that this part emits
  /// pi times the largest intensity over the power: 1 for a Lambertian surface, 1/4 for a point, 0 for
  /// emission that `sample_direct` never finds.
  float focus = 1;
};

class Emitter : public Object {
public:
  static constexpr const char* kFamily = "an emitter";
  /// Reads the parameters of every emitter: sampling_weight, medium and modulation.
  explicit Emitter(const Properties& properties);

  /// Factor of the probability that light sampling chooses this emitter.
  float sampling_weight() const { return sampling_weight_; }
  /// The medium around the emitter, if the scene states one; null: it follows from the surfaces around it.
  const Medium* medium() const { return medium_.get(); }

  /// How its light changes over time; null: it does not. `Light` multiplies the emission by it.
  const Modulation* modulation() const { return modulation_.get(); }
  /// Key frames of an emitter that is not on a shape and is written for the first of them; null: `Light` does not move it.
  virtual const Motion* motion() const { return nullptr; }
  /// Whether its light depends on the time, other than by `motion`.
  virtual bool changes() const { return modulation_ != nullptr; }

  /// Whether it emits from the surface of its parent shape. Other emitters cannot be children of shapes.
  bool sits_on_shape() const;
  /// For an emitter on a shape whose emission depends on the shape, such as one of a given flux: returns a
  /// copy for that shape, whose data are in `light`. Null: the emitter itself holds for every shape. Throws
  /// Error.
  virtual std::shared_ptr<const Emitter> fitted_to(const Light& /*light*/) const { return nullptr; }
  virtual bool is_infinite() const { return false; }
  /// Whether the emitter emits from a single point or into a single direction, so that no ray can hit it by
  /// chance.
  virtual bool is_delta() const { return false; }
  virtual std::size_t part_count(const Light&) const { return 1; }
  virtual std::size_t part_of(const Light&, const SurfacePoint&) const { return 0; }

  /// Emitted radiance at the surface `point` in the unit direction `w`.
  virtual Spectrum eval(const SurfacePoint& point, const Vec3& w, const Wavelengths& wavelengths) const;
  /// Radiance from infinity along a ray of direction `d` that left the scene, that is, arriving along -d.
  virtual Spectrum eval_escaped(const Vec3& d, const Wavelengths& wavelengths) const;

  virtual std::optional<DirectSample> sample_direct(const Light& light, const Vec3& reference,
                                                    std::size_t part, Vec2 u,
                                                    const Wavelengths& wavelengths) const = 0;
  /// Samples a direction for a receiver that scatters only light from the side of its unit normal `facing`
  /// (zero: from all sides). It may return nothing if wo is on the other side; an emitter at infinity may
  /// sample the cosine too.
  virtual std::optional<DirectSample> sample_direct_facing(const Light& light, const Vec3& reference,
                                                           const Vec3& /*facing*/, std::size_t part, Vec2 u,
                                                           const Wavelengths& wavelengths) const {
    return sample_direct(light, reference, part, u, wavelengths);
  }
  /// Solid-angle pdf [1/sr] with which sample_direct, for the part that contains `point`, samples it from
  /// `reference`; 0 for delta emitters. Only `p` and `ng` of the point are needed.
  virtual float pdf_direct(const Light& light, const Vec3& reference, std::size_t part,
                           const SurfacePoint& point) const;
  /// Solid-angle pdf [1/sr] with which sample_direct_facing with this `facing` (zero: sample_direct) samples
  /// the direction `d` of a ray that left the scene.
  virtual float pdf_direct_escaped(const Vec3& reference, const Vec3& facing, const Vec3& d) const;

  /// Samples a ray of light that leaves the part, for light tracing. `position` and `direction` are two
  /// points of [0, 1)^2.
  virtual std::optional<EmittedRay> sample_ray(const Light& light, std::size_t part, Vec2 position,
                                               Vec2 direction, const Wavelengths& wavelengths) const = 0;

  /// The pdfs with which sample_ray of a part samples a ray of direction `d` from `point` of that part, of
  /// which only `p` and `ng` are needed. `point` is null for an emitter that is not on a shape. If the
  /// direction is a delta, d is assumed to be that direction and the result is its mass.
  virtual RayDensity pdf_ray(const Light& light, std::size_t part, const SurfacePoint* point,
                             const Vec3& d) const = 0;

  /// Power spectrum of the light on the scene's grid, in W/nm or another scale common to all emitters.
  virtual SampledSpectrum power_spectrum(const Light& light) const = 0;
  virtual EmissionBounds emission_bounds(const Light& light, std::size_t part) const = 0;

protected:
  /// Copies an emitter, for `fitted_to`.
  Emitter(const Emitter& other)
      : Object(other.properties()),
        sampling_weight_(other.sampling_weight_),
        medium_(other.medium_),
        modulation_(other.modulation_) {}

private:
  float sampling_weight_;
  MediumPtr medium_;
  ModulationPtr modulation_;
};

/// The ray of light from infinity along `d`. It starts on a disc perpendicular to it, outside the scene's
/// bounding sphere. `position` chooses the point of the disc.
EmittedRay ray_from_infinity(const Light& light, const Vec3& d, Vec2 position);
/// The pdfs of `ray_from_infinity`; `direction` is the pdf of `d`.
RayDensity density_from_infinity(const Light& light, float direction);

using EmitterPtr = std::shared_ptr<const Emitter>;

}  // namespace aureole

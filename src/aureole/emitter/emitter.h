// SPDX-License-Identifier: Apache-2.0
// The emitter family. An emitter holds the emission model; its position in the scene is in a `Light`
// (light.h), which is passed to its methods. A light is divided into parts (patches of a shape, or one)
// between which the light selection chooses.
#pragma once

#include <optional>

#include "aureole/medium/medium.h"
#include "aureole/plugin/object.h"
#include "aureole/shape/surface_point.h"
#include "aureole/spectrum/wavelengths.h"

namespace aureole {

struct Light;

/// A direction towards an emitter, from `Emitter::sample_direct`.
struct DirectSample {
  Vec3 wo;            ///< unit direction from the reference point towards the emitter
  Vec3 p;             ///< where the connection ends; for an emitter at infinity a point beyond the scene
  Vec3 p_error;       ///< zero for points that lie on no surface
  Vec3 ng;            ///< zero for points that lie on no surface
  Spectrum radiance;  ///< arriving along -wo; of a delta emitter the factor of the delta (irradiance)
  float pdf = 0;      ///< density [1/sr], or 1 (a mass) where `delta`
  bool delta = false;
  bool infinite = false;
};

/// A ray of light that leaves an emitter, from `Emitter::sample_ray`.
struct EmittedRay {
  Vec3 p;        ///< where it starts; for an emitter at infinity a point outside the scene
  Vec3 p_error;  ///< zero for points that lie on no surface
  Vec3 ng;       ///< zero for points that lie on no surface
  Vec3 d;        ///< unit direction of travel
  /// Radiance times |cos| at a surface, or, where the direction is a delta, its exitance; of a point the
  /// intensity; of a beam from infinity the radiance, or, where the direction is a delta, the irradiance on a
  /// plane across it.
  Spectrum value;
  float pdf_position = 0;   ///< density [1/m^2], or a mass where `delta_position`
  float pdf_direction = 0;  ///< density [1/sr], or a mass where `delta_direction`
  bool delta_position = false, delta_direction = false;
};

/// The densities of `sample_ray`, or masses where the ray has those.
struct RayDensity {
  float position = 0, direction = 0;
};

/// How much light a part may send somewhere, for light selection (Conty Estevez & Kulla 2018, "Importance
/// sampling of many lights with adaptive tree splitting").
struct EmissionBounds {
  Bounds3 box;
  Vec3 axis{0, 0, 1};
  float cos_normals = -1;  ///< cosine of the half-angle of the cone of normals around axis
  float cos_emission = 0;  ///< cosine of the further angle into which it shines (0 for a surface)
  float power = 1;         ///< fraction of the emitter's power that this part sends
  /// pi times the largest intensity over the power: 1 of a Lambertian surface, 1/4 of a point, 0 for emission
  /// that `sample_direct` never finds.
  float focus = 1;
};

class Emitter : public Object {
public:
  static constexpr const char* kFamily = "an emitter";
  /// Reads what every emitter has: sampling_weight and medium.
  explicit Emitter(const Properties& properties);

  /// Factor of the probability with which light sampling chooses this emitter.
  float sampling_weight() const { return sampling_weight_; }
  /// The medium that it is in, where the scene states one; null: the surfaces around it tell.
  const Medium* medium() const { return medium_.get(); }

  /// Whether it emits from the surface of its parent shape; other emitters cannot be children of shapes.
  bool sits_on_shape() const;
  virtual bool is_infinite() const { return false; }
  /// Shines from one point or into one direction, so that no ray meets it by chance.
  virtual bool is_delta() const { return false; }
  virtual std::size_t part_count(const Light&) const { return 1; }
  virtual std::size_t part_of(const Light&, const SurfacePoint&) const { return 0; }

  /// Radiance that leaves the surface `point` along the unit direction `w`.
  virtual Spectrum eval(const SurfacePoint& point, const Vec3& w, const Wavelengths& wavelengths) const;
  /// Radiance arriving from infinity against the direction `d` of a ray that left the scene.
  virtual Spectrum eval_escaped(const Vec3& d, const Wavelengths& wavelengths) const;

  virtual std::optional<DirectSample> sample_direct(const Light& light, const Vec3& reference,
                                                    std::size_t part, Vec2 u,
                                                    const Wavelengths& wavelengths) const = 0;
  /// The same for a surface that scatters only light from the side of its unit normal `facing` (zero: from
  /// all): may return nothing where wo is on the other side, and an emitter at infinity may follow the
  /// cosine.
  virtual std::optional<DirectSample> sample_direct_facing(const Light& light, const Vec3& reference,
                                                           const Vec3& /*facing*/, std::size_t part, Vec2 u,
                                                           const Wavelengths& wavelengths) const {
    return sample_direct(light, reference, part, u, wavelengths);
  }
  /// Solid-angle density with which sample_direct of the part that `point` lies on chooses it from `reference`; 0
  /// for delta emitters. Of the point `p` and `ng` are needed only.
  virtual float pdf_direct(const Light& light, const Vec3& reference, std::size_t part,
                           const SurfacePoint& point) const;
  /// Density with which sample_direct_facing with the same `facing` (zero: sample_direct) chooses a direction
  /// that left the scene.
  virtual float pdf_direct_escaped(const Vec3& reference, const Vec3& facing, const Vec3& d) const;

  /// A ray of light that leaves the part, for light tracing; `position` and `direction` are two points of [0,
  /// 1)^2.
  virtual std::optional<EmittedRay> sample_ray(const Light& light, std::size_t part, Vec2 position,
                                               Vec2 direction, const Wavelengths& wavelengths) const = 0;

  /// The densities with which sample_ray of a part chooses a ray of light of direction `d`: from `point` of
  /// that part, of which `p` and `ng` are needed only, or, that being null, of an emitter that sits on no shape.
  /// Of a delta direction it is the mass of its own direction.
  virtual RayDensity pdf_ray(const Light& light, std::size_t part, const SurfacePoint* point,
                             const Vec3& d) const = 0;

  /// Power of a part per wavelength on the scene's grid (arbitrary but common scale for all emitters: W/nm).
  virtual SampledSpectrum power_spectrum(const Light& light) const = 0;
  virtual EmissionBounds emission_bounds(const Light& light, std::size_t part) const = 0;

private:
  float sampling_weight_;
  MediumPtr medium_;
};

/// The beam that enters a scene from infinity along `d`: starts on a disc across it, before the scene's
/// bounding sphere. `position` chooses the point of the disc.
EmittedRay ray_from_infinity(const Light& light, const Vec3& d, Vec2 position);
/// Its density, `direction` being that of d.
RayDensity density_from_infinity(const Light& light, float direction);

using EmitterPtr = std::shared_ptr<const Emitter>;

}  // namespace aureole

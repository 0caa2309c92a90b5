// SPDX-License-Identifier: Apache-2.0
// The BSDF family. Conventions (docs/conventions.md): local frame, z = shading normal; `wi` is the given
// direction (towards the previous vertex), `wo` the sampled one, both outward. Values include |cos theta_o|.
// In Radiance mode light travels wo -> wi, in Importance mode wi -> wo. Values and densities are per
// wavelength.
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>

#include "aureole/parameter/ior.h"
#include "aureole/plugin/object.h"
#include "aureole/plugin/properties.h"
#include "aureole/shape/surface_point.h"
#include "aureole/spectrum/wavelengths.h"

namespace aureole {

enum class TransportMode { radiance, importance };

/// Kind and side of a lobe; a BSDF's `lobes()` is the union over its lobes.
enum class Lobe : unsigned {
  none = 0,
  diffuse = 1,
  glossy = 2,
  delta = 4,
  reflect = 8,
  transmit = 16,
  through = 32,  ///< leaves the direction unchanged
  null = 64,     ///< as if nothing were there: connections pass, and it is no vertex of a path
  enter = 128,   ///< into a body of which only the surface is followed (bssrdf/bssrdf.h)
};
constexpr Lobe operator|(Lobe a, Lobe b) { return Lobe(unsigned(a) | unsigned(b)); }
constexpr Lobe operator&(Lobe a, Lobe b) { return Lobe(unsigned(a) & unsigned(b)); }
constexpr bool has(Lobe set, Lobe flag) { return unsigned(set & flag) != 0; }
/// Of light that passes as if nothing were there.
inline constexpr Lobe kNullLobe = Lobe::delta | Lobe::null;

struct BsdfContext {
  const Wavelengths& wavelengths;  ///< index 0 is the hero
  const SurfacePoint& point;
  TransportMode mode = TransportMode::radiance;
  std::uint32_t key = 0;  ///< random key for stochastic (layered) BSDFs
  /// Refractive index of the medium outside, per wavelength, if the interface lies inside a further medium;
  /// null if it is the exterior index of the scene file. Interfaces between media follow it, coatings of
  /// opaque bodies do not.
  const Spectrum* exterior_index = nullptr;

  /// The index outside an interface: `exterior_index` if there is one, else `stated`.
  Spectrum eval_exterior(const Ior& stated) const {
    return exterior_index ? *exterior_index : stated.eval(wavelengths);
  }
};

struct BsdfSample {
  Vec3 wo;
  /// f |cos theta_o|; for a delta lobe the factor of the delta (its mass-weighted reflectance).
  Spectrum value;
  Spectrum pdf;  ///< per wavelength: a density [1/sr], or where `lobe` is delta a probability (mass)
  Lobe lobe = Lobe::none;
  float eta = 1;  ///< index of the medium that wo leads into over that of wi's; for roulette

  bool is_delta() const { return has(lobe, Lobe::delta); }
};

struct BsdfEval {
  Spectrum value{0.f};  ///< f |cos theta_o|, delta lobes left out
  Spectrum pdf{0.f};    ///< density of `sample` for wo [1/sr] per wavelength, delta lobes left out
};

class Bsdf : public Object {
public:
  static constexpr const char* kFamily = "a BSDF";
  using Object::Object;

  /// Value and density of the non-delta lobes.
  virtual BsdfEval eval_pdf(const Vec3& wi, const Vec3& wo, const BsdfContext& ctx) const = 0;
  /// The value alone, for BSDFs that save something by it.
  virtual Spectrum eval(const Vec3& wi, const Vec3& wo, const BsdfContext& ctx) const {
    return eval_pdf(wi, wo, ctx).value;
  }
  /// The reverse density is this with swapped arguments.
  Spectrum pdf(const Vec3& wi, const Vec3& wo, const BsdfContext& ctx) const {
    return eval_pdf(wi, wo, ctx).pdf;
  }

  /// A direction drawn for the hero wavelength; nothing where no direction exists. `pdf[0]` > 0. The value
  /// and the density are those of all non-delta lobes at wo where a non-delta lobe was drawn (as `eval_pdf`),
  /// and of the one delta direction otherwise. Where a delta direction depends on the wavelength, wavelengths
  /// that go elsewhere have value 0 and mass 0. Several delta lobes in one direction, as a blend of mirrors
  /// has them, are drawn and reported each alone.
  virtual std::optional<BsdfSample> sample(const Vec3& wi, float u1, Vec2 u2,
                                           const BsdfContext& ctx) const = 0;

  /// The fraction of the light from wi that passes straight through as if nothing were there: the value of
  /// the `null` lobe. `sample` draws that lobe (wo = -wi) with a mass that is the same for all wavelengths.
  virtual Spectrum null_transmittance(const Vec3& /*wi*/, const BsdfContext& /*ctx*/) const { return 0.f; }

  /// The diffuse reflectance, roughly, as denoisers want it beside a picture: pi f along the normal on the
  /// side of wi, at most 1. Without delta lobes; glossy ones count as far as they reflect there.
  virtual Spectrum diffuse_reflectance(const Vec3& wi, const BsdfContext& ctx) const {
    return min(eval(wi, {0, 0, std::copysign(1.f, wi.z)}, ctx) * kPi, 1.f);
  }

  /// The shading normal in local coordinates, where the BSDF turns it.
  virtual Vec3 shading_normal(const SurfacePoint& /*point*/) const { return {0, 0, 1}; }

  /// The refractive index on the side that the normal points away from; false where the BSDF has none.
  virtual bool interior_index(const Wavelengths& /*w*/, Spectrum& /*n*/) const { return false; }

  virtual Lobe lobes() const = 0;
  /// `sample` looks at u1, or something at the context's key.
  virtual bool needs_choice() const { return true; }
  /// Known to have the same values at all points, so that tables may hold them.
  virtual bool is_constant() const { return false; }
  /// Values change when the frame turns about the normal: x must lie along dp/du. False saves the tangent.
  virtual bool needs_tangent() const { return true; }
  /// There are diffuse or glossy lobes, which next-event estimation can connect to a light.
  bool is_smooth() const { return has(lobes(), Lobe::diffuse | Lobe::glossy); }
  bool is_passable() const { return has(lobes(), Lobe::null); }
};
using BsdfPtr = std::shared_ptr<const Bsdf>;

inline float cos_theta(const Vec3& w) { return w.z; }
inline float abs_cos_theta(const Vec3& w) { return std::abs(w.z); }
inline Vec3 reflect(const Vec3& w) { return {-w.x, -w.y, w.z}; }  ///< about the local normal

}  // namespace aureole

// SPDX-License-Identifier: Apache-2.0
// The BSDF family. Conventions (docs/conventions.md): local frame, z = shading normal; `wi` is the given
// direction (towards the previous vertex), `wo` the sampled one, both outward. Values include |cos theta_o|.
// In radiance mode light travels wo -> wi, in importance mode wi -> wo. Values and pdfs are per wavelength.
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
enum class Lobe : std::uint16_t {
  none = 0,
  diffuse = 1,
  glossy = 2,
  delta = 4,
  reflect = 8,
  transmit = 16,
  through = 32,  ///< transmission that leaves the direction unchanged
  null = 64,     ///< null interaction: light passes unchanged, and it is not a path vertex
  enter = 128,   ///< entry into a body with a BSSRDF (bssrdf/bssrdf.h)
};
constexpr Lobe operator|(Lobe a, Lobe b) { return Lobe(unsigned(a) | unsigned(b)); }
constexpr Lobe operator&(Lobe a, Lobe b) { return Lobe(unsigned(a) & unsigned(b)); }
constexpr bool has(Lobe set, Lobe flag) { return unsigned(set & flag) != 0; }
/// The lobe of a null interaction: light passes unchanged.
inline constexpr Lobe kNullLobe = Lobe::delta | Lobe::null;

struct BsdfContext {
  const Wavelengths& wavelengths;  ///< wavelengths of the path; index 0 is the hero
  const SurfacePoint& point;
  TransportMode mode = TransportMode::radiance;
  std::uint32_t key = 0;  ///< random key for stochastic (layered) BSDFs
  /// Index of refraction of the medium outside, per wavelength, if the interface lies inside another medium;
  /// null if it is the exterior index of the scene file. Interfaces between media use it, coatings of opaque
  /// bodies do not.
  const Spectrum* exterior_index = nullptr;

  /// The index outside an interface: `exterior_index` if there is one, else `stated`.
  Spectrum eval_exterior(const Ior& stated) const {
    return exterior_index ? *exterior_index : stated.eval(wavelengths);
  }
};

struct BsdfSample {
  Vec3 wo;
  /// f |cos theta_o|; for a delta lobe the factor of the delta function (its mass-weighted reflectance).
  Spectrum value;
  Spectrum pdf;  ///< per wavelength: a density [1/sr], or a probability (mass) if `lobe` is delta
  Lobe lobe = Lobe::none;
  float eta = 1;  ///< index of the medium on the side of wo over the index on the side of wi; for Russian
                  ///< roulette

  bool is_delta() const { return has(lobe, Lobe::delta); }
};

struct BsdfEval {
  Spectrum value{0.f};  ///< f |cos theta_o| without delta lobes
  Spectrum pdf{0.f};    ///< pdf of sampling wo with `sample` [1/sr], per wavelength, without delta lobes
};

class Bsdf : public Object {
public:
  static constexpr const char* kFamily = "a BSDF";
  using Object::Object;

  /// Returns value and pdf of the non-delta lobes.
  virtual BsdfEval eval_pdf(const Vec3& wi, const Vec3& wo, const BsdfContext& ctx) const = 0;
  /// Returns the value alone, for BSDFs where that costs less than value and pdf.
  virtual Spectrum eval(const Vec3& wi, const Vec3& wo, const BsdfContext& ctx) const {
    return eval_pdf(wi, wo, ctx).value;
  }
  /// Returns the pdf; the reverse pdf has wi and wo swapped.
  Spectrum pdf(const Vec3& wi, const Vec3& wo, const BsdfContext& ctx) const {
    return eval_pdf(wi, wo, ctx).pdf;
  }

  /// Samples a direction for the hero wavelength; empty if there is none. `pdf[0]` > 0. For a non-delta lobe,
  /// value and pdf are the sums over all non-delta lobes at wo (as `eval_pdf` returns); otherwise those of
  /// the one delta direction. If a delta direction depends on the wavelength, wavelengths with other
  /// directions have value 0 and mass 0. Several delta lobes in one direction, as in a blend of mirrors, are
  /// sampled and reported separately.
  virtual std::optional<BsdfSample> sample(const Vec3& wi, float u1, Vec2 u2,
                                           const BsdfContext& ctx) const = 0;

  /// Returns the transmittance of the `null` lobe: the fraction of the light from wi that passes unchanged.
  /// `sample` chooses that lobe (wo = -wi) with a mass that does not depend on the wavelength.
  virtual Spectrum null_transmittance(const Vec3& /*wi*/, const BsdfContext& /*ctx*/) const { return 0.f; }

  /// Returns the approximate diffuse reflectance, an auxiliary feature for denoisers: pi f along the normal
  /// on the side of wi, at most 1. Delta lobes are excluded; glossy lobes contribute their value in that
  /// direction.
  virtual Spectrum diffuse_reflectance(const Vec3& wi, const BsdfContext& ctx) const {
    return min(eval(wi, {0, 0, std::copysign(1.f, wi.z)}, ctx) * kPi, 1.f);
  }

  /// Returns the shading normal in local coordinates, if the BSDF changes it.
  virtual Vec3 shading_normal(const SurfacePoint& /*point*/) const { return {0, 0, 1}; }

  /// Sets the index of refraction on the side opposite to the normal; returns false if the BSDF has none.
  virtual bool interior_index(const Wavelengths& /*w*/, Spectrum& /*n*/) const { return false; }
  /// Sets the index of refraction on the side of the normal that the BSDF states; returns false if it has none.
  virtual bool exterior_index(const Wavelengths& /*w*/, Spectrum& /*n*/) const { return false; }

  /// Returns the largest fraction, over the surface, of diffuse light from one side that is lost because the
  /// microfacets scatter it once: of light from within (opposite to the normal) or from outside. 0 for a
  /// model that keeps all light, or if the scene file asks for the loss.
  virtual double single_scattering_loss(bool /*from_within*/) const { return 0; }

  virtual Lobe lobes() const = 0;
  /// Whether `sample` uses u1, or `eval_pdf` or `sample` uses the context's key.
  virtual bool needs_choice() const { return true; }
  /// Whether values are known to be equal at all points, so that they can be tabulated.
  virtual bool is_constant() const { return false; }
  /// Whether values change when the frame rotates about the normal: x must lie along dp/du then. False saves
  /// the computation of the tangent.
  virtual bool needs_tangent() const { return true; }
  /// Whether there are diffuse or glossy lobes, which next-event estimation can connect to a light.
  bool is_smooth() const { return has(lobes(), Lobe::diffuse | Lobe::glossy); }
  bool is_passable() const { return has(lobes(), Lobe::null); }
};
using BsdfPtr = std::shared_ptr<const Bsdf>;

inline float cos_theta(const Vec3& w) { return w.z; }
inline float abs_cos_theta(const Vec3& w) { return std::abs(w.z); }
/// mirror direction of w about the local normal
inline Vec3 reflect(const Vec3& w) { return {-w.x, -w.y, w.z}; }

}  // namespace aureole

// SPDX-License-Identifier: Apache-2.0
// Microfacet surfaces: distributions of normals, Smith masking, sampling of visible normals, and the
// parameters that the rough BSDFs share. Walter, Marschner, Li & Torrance 2007, "Microfacet models for
// refraction through rough surfaces"; Heitz 2014, "Understanding the masking-shadowing function in
// microfacet-based BRDFs".
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <vector>

#include "aureole/bsdf/bsdf.h"
#include "aureole/texture/texture.h"

namespace aureole {

enum class NormalDistribution { beckmann, ggx };

/// Returns exp(x) for x <= 0, relative error below 3e-7; 0 below -87 (the polynomial of S. Moshier's Cephes
/// library).
inline Spectrum exp_of_negative(const Spectrum& x) {
  const SpectrumVector clamped = max(x, -87.f).v;
  const SpectrumMask n = __builtin_convertvector(clamped * 1.44269504f - 0.5f, SpectrumMask);
  const SpectrumVector whole = __builtin_convertvector(n, SpectrumVector);
  const SpectrumVector f = clamped - whole * 0.693359375f + whole * 2.12194440e-4f;
  // The polynomial is evaluated in pairs (Estrin's scheme): a chain of half as many dependent operations.
  const SpectrumVector f2 = f * f, high = f * 1.9875691500e-4f + 1.3981999507e-3f,
                       middle = f * 8.3334519073e-3f + 4.1665795894e-2f,
                       low = f * 1.6666665459e-1f + 5.0000001201e-1f;
  const SpectrumVector p = ((high * f2 + middle) * f2 + low) * f2 + (f + 1);
  const SpectrumMask power = (n + 127) << 23;
  return select(x.v > Spectrum(-87.f).v, p * std::bit_cast<SpectrumVector>(power), 0.f);
}

/// Returns (1 - erf(x)) exp(x^2) for x >= 0; times exp(-x^2) the error is below 1.5e-7 (Abramowitz & Stegun
/// 1964, 7.1.26).
inline float erfc_over_exp(float x) {
  const float t = 1 / (1 + 0.3275911f * x);
  return t *
         (0.254829592f + t * (-0.284496736f + t * (1.421413741f + t * (-1.453152027f + t * 1.061405429f))));
}

/// The microfacets at a point. Directions and normals are local; normals have z > 0. Roughnesses lie in
/// [kMinAlpha, kMaxAlpha]; alpha_u is along local x.
class Microfacets {
public:
  /// lower bound of the roughness: smoother surfaces exceed single precision
  static constexpr float kMinAlpha = 1e-4f;
  static constexpr float kMaxAlpha = 100.f;

  Microfacets(NormalDistribution type, float alpha_u, float alpha_v)
      : type_(type),
        alpha_u_(alpha_u),
        alpha_v_(alpha_v),
        inverse_u_(1 / alpha_u),
        inverse_v_(1 / alpha_v),
        scale_(kInvPi * inverse_u_ * inverse_v_) {}

  NormalDistribution type() const { return type_; }
  float alpha_u() const { return alpha_u_; }
  float alpha_v() const { return alpha_v_; }
  Microfacets scaled(float factor) const { return {type_, alpha_u_ * factor, alpha_v_ * factor}; }

  /// Returns D(m) [1/sr]: the integral of D cos is one. Zero for m.z <= 0.
  float density(const Vec3& m) const {
    const float x = m.x * inverse_u_, y = m.y * inverse_v_, s = x * x + y * y, c2 = m.z * m.z;
    if (!(m.z > 0)) return 0;
    if (type_ == NormalDistribution::ggx) return scale_ / ((s + c2) * (s + c2));
    if (!(s < 80 * c2)) return 0;
    const float sec2 = 1 / c2;
    return scale_ * sec2 * sec2 * std::exp(-s * sec2);
  }
  /// Returns D for one normal per wavelength.
  Spectrum density(const Spectrum& mx, const Spectrum& my, const Spectrum& mz) const {
    const Spectrum x = mx * inverse_u_, y = my * inverse_v_, s = x * x + y * y, c2 = mz * mz;
    const SpectrumMask up = mz.v > Spectrum(0.f).v;
    if (type_ == NormalDistribution::ggx)
      return select(up, Spectrum(scale_) / select(up, (s + c2) * (s + c2), 1.f), 0.f);
    const SpectrumMask seen = up & (s.v < (c2 * 80.f).v);
    const Spectrum sec2 = Spectrum(1.f) / select(seen, c2, 1.f);
    return select(seen, sec2 * sec2 * scale_ * exp_of_negative(select(seen, s * sec2, 0.f) * -1.f), 0.f);
  }

  /// Returns Smith's masking G1(v) over v.z, for v.z >= 0; finite at grazing angles. It is exact for both
  /// distributions: the integral of D(m) G1(v) max(v.m, 0) over m is v.z (Heitz 2014, equation 17).
  float masking_over_cos(const Vec3& v) const {
    const float x = alpha_u_ * v.x, y = alpha_v_ * v.y, r2 = x * x + y * y;
    if (type_ == NormalDistribution::ggx) return 2 / (v.z + std::sqrt(v.z * v.z + r2));
    const float r = std::sqrt(r2);
    if (v.z > 3.5f * r) return 1 / v.z;  // masking is below 2e-8 here
    const float a = v.z / r, e = std::exp(-a * a);
    constexpr float kRootPi = 1.77245385f;
    return 2 * kRootPi / (kRootPi * v.z * (2 - erfc_over_exp(a) * e) + r * e);
  }
  float masking(const Vec3& v) const { return std::min(v.z * masking_over_cos(v), 1.f); }

  /// Samples a normal visible from `wi` (wi.z > 0): density D(m) G1(wi) (wi.m) / wi.z.
  Vec3 sample_visible(const Vec3& wi, Vec2 u) const;
  /// Samples a normal of density D(m) m.z.
  Vec3 sample_all(Vec2 u) const;

private:
  Vec3 normal_of_slopes(float x, float y) const { return normalize({-alpha_u_ * x, -alpha_v_ * y, 1}); }

  NormalDistribution type_;
  float alpha_u_, alpha_v_, inverse_u_, inverse_v_, scale_;
};

/// The parameters `distribution`, `alpha`, `alpha_u`, `alpha_v` and `sample_visible`.
class Roughness {
public:
  /// With `variable`, roughness may be textured and differ along u and v; else it is one number, `alpha`.
  Roughness(const Properties& properties, bool variable);

  Microfacets at(const BsdfContext& ctx) const {
    if (!textured_) return constant_;
    const float u = value(texture_u_, constant_.alpha_u(), ctx);
    return {type_, u, isotropic_ ? u : value(texture_v_, constant_.alpha_v(), ctx)};
  }
  /// Returns the microfacets if no roughness is textured.
  const Microfacets& constant() const { return constant_; }
  NormalDistribution type() const { return type_; }
  bool visible() const { return visible_; }  ///< whether normals are sampled by `sample_visible`
  bool is_isotropic() const { return isotropic_; }
  /// Smallest and largest alpha_u and alpha_v over the surface.
  Vec2 range_u() const { return range_u_; }
  Vec2 range_v() const { return range_v_; }
  /// Returns the numbers on which tables over all roughnesses of the surface depend.
  std::vector<double> table_key() const {
    return {double(type_),      double(isotropic_), double(range_u_.x),
            double(range_u_.y), double(range_v_.x), double(range_v_.y)};
  }

private:
  static float value(const TexturePtr& texture, float constant, const BsdfContext& ctx) {
    return texture ? clamped(texture->eval(ctx.point, ctx.wavelengths)[0]) : constant;
  }
  static float clamped(float alpha) {
    return alpha > Microfacets::kMinAlpha ? std::min(alpha, Microfacets::kMaxAlpha) : Microfacets::kMinAlpha;
  }
  static Vec2 read(const Properties& properties, const char* name, TexturePtr& texture);

  NormalDistribution type_ = NormalDistribution::beckmann;
  bool visible_ = true, isotropic_ = true, textured_ = false;
  Microfacets constant_{NormalDistribution::beckmann, 0.1f, 0.1f};
  TexturePtr texture_u_, texture_v_;
  Vec2 range_u_, range_v_;
};

}  // namespace aureole

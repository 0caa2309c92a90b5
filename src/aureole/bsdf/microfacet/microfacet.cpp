// SPDX-License-Identifier: Apache-2.0
#include "aureole/bsdf/microfacet/microfacet.h"

#include "aureole/core/letter_case.h"
#include "aureole/math/warp.h"

namespace aureole {

namespace {

constexpr float kInvRootPi = 0.564189584f;

/// Returns the inverse of erf, relative error below 3e-7 for |x| < 1 (M. Giles 2010, "Approximating the
/// erfinv function").
float inverse_erf(float x) {
  float w = -std::log((1 - x) * (1 + x)), p;
  if (w < 5) {
    w -= 2.5f;
    p = 2.81022636e-08f;
    p = 3.43273939e-07f + p * w;
    p = -3.5233877e-06f + p * w;
    p = -4.39150654e-06f + p * w;
    p = 0.00021858087f + p * w;
    p = -0.00125372503f + p * w;
    p = -0.00417768164f + p * w;
    p = 0.246640727f + p * w;
    p = 1.50140941f + p * w;
  } else {
    w = std::sqrt(w) - 3;
    p = -0.000200214257f;
    p = 0.000100950558f + p * w;
    p = 0.00134934322f + p * w;
    p = -0.00367342844f + p * w;
    p = 0.00573950773f + p * w;
    p = -0.0076224613f + p * w;
    p = 0.00943887047f + p * w;
    p = 1.00167406f + p * w;
    p = 2.83297682f + p * w;
  }
  return p * x;
}

/// Samples a slope visible from a direction of angle theta, along its azimuth, on a Beckmann surface of alpha
/// = 1. The density is proportional to (1 - x tan theta) exp(-x^2) below cot theta. Up to a factor its
/// cumulative distribution in b = erf(x) is 1 + b + tan theta exp(-x^2)/sqrt(pi) (Heitz & d'Eon 2014,
/// "Importance sampling microfacet-based BSDFs using the distribution of visible normals"). It is inverted in
/// b (Jakob 2014, "An improved visible normal sampling routine for the Beckmann distribution") by Halley's
/// method, starting between the solutions at normal and at grazing incidence. A bracket ensures convergence.
float sample_visible_beckmann_slope(float cos_theta, float sin_theta, float u) {
  constexpr float kEnd = 1 - 1e-7f;
  u = std::clamp(u, 1e-7f, kEnd);
  if (!(sin_theta > 1e-5f * cos_theta)) return inverse_erf(2 * u - 1);
  const float cot = cos_theta / sin_theta, tangent = sin_theta / std::max(cos_theta, 1e-9f);
  const float weight = kInvRootPi * tangent, end_exp = std::exp(-cot * cot);
  const float end = std::min(1 - erfc_over_exp(cot) * end_exp, kEnd);
  const float total = 1 + end + weight * end_exp, target = u * total;
  float low = -1, high = end;
  // The identity erf(sqrt(-log u)) needs no exponential, which would be u.
  const float normal = -1 + (1 + end) * u;
  const float grazing = end - (1 + end) * (1 - erfc_over_exp(std::sqrt(-std::log(u))) * u);
  float b = normal + (grazing - normal) * tangent / (tangent + 0.3f);
  float x = inverse_erf(std::clamp(b, -kEnd, kEnd));
  for (int i = 0; i < 12; ++i) {
    const float e = std::exp(-x * x);
    b = std::copysign(1 - erfc_over_exp(std::abs(x)) * e, x);
    const float error = 1 + b + weight * e - target;
    (error > 0 ? high : low) = b;
    const float slope = 1 - x * tangent, dx_db = 0.5f / (kInvRootPi * e);
    float next = b - error * slope / (slope * slope + 0.5f * error * tangent * dx_db);
    if (!(next >= low && next <= high)) next = 0.5f * (low + high);
    // For short steps the inverse of erf is computed by its series about x.
    const float step = (next - b) * dx_db;
    x = std::abs(step) < 0.1f ? x + step * (1 + x * step) : inverse_erf(std::clamp(next, -kEnd, kEnd));
    // The remaining error is of third order.
    if (std::abs(error) < 1e-3f * total) break;
  }
  return x;
}

}  // namespace

Vec3 Microfacets::sample_visible(const Vec3& wi, Vec2 u) const {
  const Vec3 stretched = normalize({alpha_u_ * wi.x, alpha_v_ * wi.y, wi.z});
  if (type_ == NormalDistribution::ggx) {
    // Directions reflected by a stretched surface, a hemisphere, are uniform over the cap z > -wi.z (Dupuy &
    // Benyoub 2023, "Sampling visible GGX normals with spherical caps").
    const float z = 1 - u.y * (1 + stretched.z);
    const float r = std::sqrt(std::max((1 - z) * (1 + z), 0.f));
    const Vec2 a = cos_sin_2pi(u.x);
    const Vec3 m{alpha_u_ * (r * a.x + stretched.x), alpha_v_ * (r * a.y + stretched.y),
                 std::max(z + stretched.z, 1e-15f)};
    return normalize(m);
  }
  const float sin_theta = std::sqrt(stretched.x * stretched.x + stretched.y * stretched.y);
  const float c = sin_theta > 0 ? stretched.x / sin_theta : 1,
              s = sin_theta > 0 ? stretched.y / sin_theta : 0;
  const float along = sample_visible_beckmann_slope(stretched.z, sin_theta, u.x);
  const float across = inverse_erf(std::clamp(2 * u.y - 1, -1 + 1e-7f, 1 - 1e-7f));
  return normal_of_slopes(c * along - s * across, s * along + c * across);
}

Vec3 Microfacets::sample_all(Vec2 u) const {
  // Slopes divided by alpha have one density for all alphas: that of D cos.
  const float rest = 1 - std::min(u.x, kOneMinusEpsilon);
  const float r = std::sqrt(type_ == NormalDistribution::ggx ? (1 - rest) / rest : -std::log(rest));
  const Vec2 a = cos_sin_2pi(u.y);
  return normal_of_slopes(r * a.x, r * a.y);
}

Roughness::Roughness(const Properties& p, bool variable) {
  const auto distribution = [&] {
    const std::string name = lower_case(p.get_string("distribution", "beckmann"));
    if (name != "beckmann" && name != "ggx")
      throw p.error("distribution", "\"" + name + "\" is not one of beckmann, ggx" +
                                        did_you_mean(name, std::vector<std::string>{"beckmann", "ggx"}));
    return name;
  };
  const std::string name = p.tolerate(std::string("beckmann"), distribution);
  type_ = name == "ggx" ? NormalDistribution::ggx : NormalDistribution::beckmann;
  visible_ = p.get_bool("sample_visible", true);
  if (variable && (p.has("alpha_u") || p.has("alpha_v"))) {
    if (p.has("alpha")) throw p.error("alpha", "give either alpha or alpha_u and alpha_v, not both");
    for (const char* needed : {"alpha_u", "alpha_v"})
      if (!p.has(needed))
        throw p.error(needed, "alpha_u and alpha_v go together: " + std::string(needed) + " is missing");
    isotropic_ = false;
    range_u_ = read(p, "alpha_u", texture_u_);
    range_v_ = read(p, "alpha_v", texture_v_);
    if (!texture_u_ && !texture_v_ && range_u_.x == range_v_.x) isotropic_ = true;
  } else {
    if (variable)  // assigning them also marks the ranges as known
      for (const char* absent : {"alpha_u", "alpha_v"}) p.find(absent);
    range_u_ = range_v_ = read(p, "alpha", texture_u_);
    if (texture_u_ && !variable) throw p.error("alpha", "expected a number: the roughness cannot vary here");
  }
  textured_ = texture_u_ || texture_v_;
  constant_ = Microfacets(type_, range_u_.x, range_v_.x);
}

Vec2 Roughness::read(const Properties& p, const char* name, TexturePtr& texture) {
  const Properties::Entry* e = p.find(name);
  float alpha = 0.1f;
  if (e && (std::holds_alternative<double>(e->value) || std::holds_alternative<std::int64_t>(e->value))) {
    alpha = float(p.get_float(name, Range{0, Microfacets::kMaxAlpha, true}));
  } else if (e) {
    texture = get_texture(p, name, 0.1, SpectrumRole::unbounded);
    if (texture->maximum() > Microfacets::kMaxAlpha)
      throw p.error(name, "a roughness above 100 has no meaning");
    const SampledSpectrum mean = texture->average();
    if (mean.maximum() - mean.minimum() > 1e-4f * mean.maximum())
      throw p.error(name,
                    "a roughness does not depend on the wavelength: use a grey texture, or \"raw\" true");
    if (!texture->is_constant()) return {clamped(texture->minimum()), clamped(texture->maximum())};
    texture = nullptr;
    alpha = mean.maximum();
    if (!(alpha > 0)) throw p.error(name, "must be > 0");
  }
  if (alpha < Microfacets::kMinAlpha) {
    p.note(name, "is taken as 1e-4; for a smooth surface use the BSDF without \"rough\"");
    alpha = Microfacets::kMinAlpha;
  }
  return {alpha, alpha};
}

}  // namespace aureole

// SPDX-License-Identifier: Apache-2.0
#include "aureole/bsdf/nested/perturbed_frame.h"

#include "aureole/bsdf/nested/nested_bsdfs.h"
#include "aureole/math/warp.h"
#include "aureole/plugin/registry.h"

namespace aureole {

namespace {

Vec3 mirrored(const Vec3& n) { return {-n.x, -n.y, n.z}; }

/// Whether the direction is on the same side of the horizons of both frames, given in local and in perturbed
/// coordinates.
bool same_side(const Vec3& local, const Vec3& turned) { return local.z * turned.z > 0; }

float tan2_theta(const Vec3& w) { return (w.x * w.x + w.y * w.y) / (w.z * w.z); }

}  // namespace

/// The surface point with the frame around the perturbed normal `n`.
class PerturbedFrame::Turned {
public:
  Turned(const Vec3& n, const BsdfContext& ctx)
      : frame_(Frame::from_normal_tangent(n, {1, 0, 0})),
        point_(ctx.point),
        context_{ctx.wavelengths, point_, ctx.mode, ctx.key} {
    const Frame& shading = ctx.point.shading;
    point_.shading = {shading.to_world(frame_.s), shading.to_world(frame_.t), shading.to_world(frame_.n)};
  }
  Turned(const Turned&) = delete;
  Turned& operator=(const Turned&) = delete;

  const BsdfContext& context() const { return context_; }
  const Vec3& normal() const { return frame_.n; }
  Vec3 to_turned(const Vec3& local) const { return frame_.to_local(local); }
  Vec3 to_local(const Vec3& turned) const { return frame_.to_world(turned); }

private:
  Frame frame_;
  SurfacePoint point_;
  BsdfContext context_;
};

PerturbedFrame::PerturbedFrame(const Properties& properties)
    : Bsdf(properties),
      nested_(nested_bsdfs(properties, 1).front()),
      flip_invalid_normals_(properties.get_bool("flip_invalid_normals", true)),
      use_shadowing_function_(properties.get_bool("use_shadowing_function", true)) {}

Vec3 PerturbedFrame::unit_normal(const SurfacePoint& point) const {
  const Vec3 n = perturbed_normal(point);
  const float l2 = length_squared(n);
  return l2 > 0 && std::isfinite(l2) ? n * (1 / std::sqrt(l2)) : Vec3{0, 0, 1};
}

bool PerturbedFrame::is_flipped(const Vec3& n, const Vec3& viewer) const {
  return flip_invalid_normals_ && viewer.z * dot(viewer, n) <= 0;
}

/// Returns the probability that `sample` uses the mirrored frame. In importance mode the viewer's direction,
/// on which the choice depends, is not yet known.
float PerturbedFrame::probability_of_flipped(const Vec3& n, const Vec3& wi, TransportMode mode) const {
  if (mode == TransportMode::radiance) return is_flipped(n, wi) ? 1 : 0;
  if (!flip_invalid_normals_) return 0;
  if (!(wi.z * dot(wi, n) > 0)) return 1;
  if (!(wi.z * dot(wi, mirrored(n)) > 0)) return 0;
  // The fraction of a cosine-weighted hemisphere that lies below the perturbed horizon, (1 - cos) / 2.
  return (n.x * n.x + n.y * n.y) / (2 * (1 + std::abs(n.z)));
}

/// Returns the factor of the nested BSDF's values; directions in local and perturbed (t) coordinates.
float PerturbedFrame::weight(const Vec3& n, const Vec3& wi, const Vec3& wi_t, const Vec3& wo,
                             const Vec3& wo_t, TransportMode mode) const {
  const bool radiance = mode == TransportMode::radiance;
  float w = 1;
  if (use_shadowing_function_) {
    const float alpha2 = std::min(0.125f * tan2_theta(n), 1.f);
    if (alpha2 > 0) w = 2 / (1 + std::sqrt(1 + alpha2 * tan2_theta(radiance ? wo : wi)));
  }
  if (radiance) return w;
  w *= float((double(wi_t.z) * wo.z) / (double(wo_t.z) * wi.z));
  return std::isfinite(w) ? w : 0;
}

BsdfEval PerturbedFrame::eval_pdf(const Vec3& wi, const Vec3& wo, const BsdfContext& ctx) const {
  const Vec3 n = unit_normal(ctx.point);
  const float flipped = probability_of_flipped(n, wi, ctx.mode);
  const bool seen_flipped = is_flipped(n, ctx.mode == TransportMode::radiance ? wi : wo);
  BsdfEval result;
  for (const bool flip : {false, true}) {
    const float probability = flip ? flipped : 1 - flipped;
    if (!(probability > 0) && flip != seen_flipped) continue;
    const Turned turned(flip ? mirrored(n) : n, ctx);
    const Vec3 wi_t = turned.to_turned(wi), wo_t = turned.to_turned(wo);
    if (!same_side(wi, wi_t) || !same_side(wo, wo_t)) continue;
    const BsdfEval e = nested_->eval_pdf(wi_t, wo_t, turned.context());
    result.pdf += e.pdf * probability;
    if (flip == seen_flipped) result.value = e.value * weight(n, wi, wi_t, wo, wo_t, ctx.mode);
  }
  return result;
}

std::optional<BsdfSample> PerturbedFrame::sample(const Vec3& wi, float u1, Vec2 u2,
                                                 const BsdfContext& ctx) const {
  const Vec3 n = unit_normal(ctx.point);
  const float flipped = probability_of_flipped(n, wi, ctx.mode);
  const bool flip = u1 < flipped;
  const float probability = flip ? flipped : 1 - flipped;
  if (probability < 1) u1 = flip ? remap_below(u1, flipped) : remap_above(u1, flipped);

  const Turned turned(flip ? mirrored(n) : n, ctx);
  const Vec3 wi_t = turned.to_turned(wi);
  auto s = nested_->sample(wi_t, u1, u2, turned.context());
  if (!s) return s;
  if (has(s->lobe, Lobe::null)) {
    // A null interaction does not depend on the frame and has equal probability in both.
    s->wo = -wi;
    return s;
  }
  const Vec3 wo_t = s->wo;
  s->wo = turned.to_local(wo_t);
  if (!same_side(wi, wi_t) || !same_side(s->wo, wo_t)) return {};
  if (ctx.mode == TransportMode::importance) {
    if (!s->is_delta()) {
      const BsdfEval e = eval_pdf(wi, s->wo, ctx);
      s->value = e.value, s->pdf = e.pdf;
      return s;
    }
    if (is_flipped(n, s->wo) != flip) return {};  // at wo the perturbed normal is mirrored differently
    s->pdf *= probability;
  }
  s->value *= weight(n, wi, wi_t, s->wo, wo_t, ctx.mode);
  return s;
}

Spectrum PerturbedFrame::null_transmittance(const Vec3& wi, const BsdfContext& ctx) const {
  if (!nested_->is_passable()) return 0.f;
  const Vec3 n = unit_normal(ctx.point);
  const Turned turned(is_flipped(n, wi) ? mirrored(n) : n, ctx);
  return nested_->null_transmittance(turned.to_turned(wi), turned.context());
}

std::vector<ParameterDoc> perturbed_frame_parameters(std::vector<ParameterDoc> own) {
  own.push_back({"bsdf", "bsdf", "", "required", "one nested BSDF"});
  own.push_back({"flip_invalid_normals", "boolean", "", "true",
                 "mirror a perturbed normal that faces away from the viewer at the surface normal; "
                 "otherwise such points are black"});
  own.push_back({"use_shadowing_function", "boolean", "", "true",
                 "attenuate light at grazing directions, to avoid the hard edge at the shading terminator"});
  return own;
}

}  // namespace aureole

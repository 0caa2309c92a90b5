// SPDX-License-Identifier: Apache-2.0
// `Vertex`: a point where a path is scattered, on a surface or in a medium, in world space. No integrator
// names a concrete plug-in: they use these functions.
#pragma once

#include "aureole/bsdf/bsdf.h"
#include "aureole/scene/surface.h"
#include "aureole/spectrum/path_density.h"
#include "aureole/transport/connection.h"
#include "aureole/transport/ray_origin.h"

namespace aureole {

/// The scenes that code is compiled for: `empty` has no media, no bodies with a rank, no surfaces that touch bodies and no edges that
/// diffract light, so that paths among its surfaces need not test for them at every step.
enum class Space { empty, any };
inline Space space_of(const Scene& scene) {
  return scene.has_media() || scene.diffraction() || scene.outline_edges() ? Space::any : Space::empty;
}

/// Value and pdf of scattering at a vertex for one given direction.
template <class L>
struct BasicResponse {
  typename L::Weight value;
  Spectrum pdf;  ///< pdf with which `scatter` would sample the direction [1/sr], per wavelength
};
using Response = BasicResponse<Unpolarised>;

/// A direction sampled at a vertex.
template <class L>
struct BasicScatter {
  Vec3 d;  ///< unit direction in world space
  typename L::Weight value;
  /// used instead of `value` where the path crosses the surface: transmittance over the probability of
  /// crossing
  Spectrum transmittance;
  Spectrum pdf;  ///< per wavelength: a density [1/sr], or where `delta` a probability (mass)
  bool delta;
  float eta;  ///< index of refraction of the medium that d leads into over that of where the path comes from
};
using Scatter = BasicScatter<Unpolarised>;

/// A point of a surface on a path that arrives from the direction `to_previous`, with the checks that keep
/// light from leaking through the wrong side of a shading normal. Made in place, since the context of its
/// BSDF refers to its point.
template <class L>
class SurfaceVertex {
public:
  SurfaceVertex(const Scene& scene, const RayTracer::Hit& hit, const Ray& ray, const Wavelengths& w,
                TransportMode mode)
      : point_(scene.surface_point(hit, ray)), context_{w, point_, mode}, to_previous_(-ray.d) {}
  SurfaceVertex(const SurfacePoint& point, const Vec3& to_previous, const Wavelengths& w, TransportMode mode)
      : point_(point), context_{w, point_, mode}, to_previous_(to_previous) {}
  SurfaceVertex(const SurfaceVertex&) = delete;
  SurfaceVertex& operator=(const SurfaceVertex&) = delete;

  const SurfacePoint& point() const { return point_; }
  const Surface& surface() const { return *point_.surface; }
  /// Sets the index of refraction outside of the surface from the bodies around it.
  void set_exterior(const InteriorList& inside) {
    const Surface* other = inside.filling({&surface(), point_.instance}).surface;
    if (other && other->bsdf->interior_index(context_.wavelengths, exterior_))
      context_.exterior_index = &exterior_;
  }
  const Light* light() const { return point_.surface->light; }
  RayOrigin origin() const { return RayOrigin::of(point_); }

  /// Must be called before the functions below. `key` is for stochastic BSDFs.
  void prepare(std::uint32_t key) {
    context_.key = key;
    wi_ = point_.shading.to_local(to_previous_);
    wi_side_ = dot(point_.ng, to_previous_);
  }

  /// The shading normal on the side from which the BSDF scatters light; zero where it scatters from both.
  /// Light sampling and its pdfs depend on it.
  Vec3 facing() const {
    return has(surface().lobes, Lobe::transmit) ? Vec3{} : wi_.z < 0 ? -point_.shading.n : point_.shading.n;
  }
  /// Whether connections can contribute at this vertex.
  bool is_smooth() const { return has(surface().lobes, Lobe::diffuse | Lobe::glossy); }

  /// Sets the value and the pdf of scattering into `d`; false where the value is zero.
  bool respond(const Vec3& d, BasicResponse<L>& out) const {
    const Vec3 wo = point_.shading.to_local(d);
    if (!is_consistent(wo, d)) return false;
    const BsdfEval e = surface().bsdf->eval_pdf(wi_, wo, context_);
    if (is_black(e.value)) return false;
    out.value = lift(e.value, d);
    out.pdf = e.pdf;
    return true;
  }

  /// Pdf of the reversed event in the other mode of transport: a path arrives along -d and is
  /// scattered towards the previous vertex. For a direction that `respond` accepts.
  Spectrum reverse_pdf(const Vec3& d) const {
    BsdfContext reverse = context_;
    reverse.mode =
        context_.mode == TransportMode::radiance ? TransportMode::importance : TransportMode::radiance;
    return surface().bsdf->pdf(point_.shading.to_local(d), wi_, reverse);
  }
  /// Pdf of the reversed event for a direction that `scatter` has sampled. For a delta lobe it is the mass of
  /// `scatter` times the ratio of solid angles d(d) / d(to_previous). Then both directions of sampling have a
  /// pdf of one measure: their masses have the same spectral shape, and the scale cancels.
  Spectrum reverse_pdf(const BasicScatter<L>& s) const {
    if (!s.delta) return reverse_pdf(s.d);
    if (s.eta == 1) return s.pdf;
    return s.pdf * std::abs(wi_.z / (s.eta * s.eta * dot(point_.shading.n, s.d)));
  }

  /// Samples a direction. Returns `surface` where the path is scattered, `crossed` where it crosses a null
  /// component, `entered` where it is refracted into a surface with a BSSRDF, `blocked` where it ends.
  Event scatter(float u1, Vec2 u2, BasicScatter<L>& out) const {
    const std::optional<BsdfSample> s = surface().bsdf->sample(wi_, u1, u2, context_);
    if (!s || !(s->pdf[0] > 0)) return Event::blocked;
    const Vec3 d = point_.shading.to_world(s->wo);
    if (!is_consistent(s->wo, d) || is_black(s->value)) return Event::blocked;
    if (has(s->lobe, Lobe::null | Lobe::enter)) {
      if (has(s->lobe, Lobe::enter)) {
        enter(*s, out);
        return Event::entered;
      }
      out.d = -to_previous_;
      out.transmittance = s->value * (1 / s->pdf[0]);
      return Event::crossed;
    }
    out.d = normalize(d);
    out.value = lift(s->value, out.d);
    out.pdf = s->pdf;
    out.delta = s->is_delta();
    out.eta = s->eta;
    return Event::surface;
  }

private:
  [[gnu::noinline]] void enter(const BsdfSample& s, BasicScatter<L>& out) const {
    out.value = typename L::Weight(s.value);
    // In importance mode the irradiance refers to the geometric surface, while the BSDF's cosine refers to
    // the shading normal.
    if (context_.mode == TransportMode::importance)
      out.value = out.value.scaled(wi_side_ != 0 ? std::abs(wi_.z / wi_side_) : 0.f);
    out.pdf = s.pdf;
    out.delta = s.is_delta();
    out.eta = 1;
  }

  /// Lifts the BSDF's scalar value for the direction `d` to a map of light.
  typename L::Weight lift(const Spectrum& value, const Vec3& d) const {
    if (context_.mode == TransportMode::radiance) return L::lift(value, point_.p, -d, to_previous_);
    return L::lift(value * correction(d), point_.p, -to_previous_, d);
  }

  /// Whether both normals agree: reflection (in the shading frame) must stay on the geometric side that light
  /// came from, transmission must change it.
  bool is_consistent(const Vec3& wo, const Vec3& d) const {
    return (wi_.z * wo.z > 0) == (wi_side_ * dot(point_.ng, d) > 0);
  }

  /// Factor for values in importance mode that makes the BSDF the adjoint of that in radiance mode when
  /// shading and geometric normals differ: |wi.ns| |wo.ng| / (|wi.ng| |wo.ns|) (Veach 1997, section 5.3.2).
  float correction(const Vec3& d) const {
    const float below = std::abs(wi_side_ * dot(point_.shading.n, d));
    return below > 0 ? std::abs(wi_.z * dot(point_.ng, d)) / below : 0.f;
  }

  const SurfacePoint point_;
  BsdfContext context_;
  Vec3 to_previous_;
  Vec3 wi_;  ///< to_previous_ in the shading frame
  /// index of refraction outside of the surface, stored here since the context refers to it
  Spectrum exterior_;
  float wi_side_ = 0;  ///< cosine of the direction to the previous vertex with the geometric normal
};

/// A point of a medium on a path that arrives from the direction `to_previous`.
template <class L>
class MediumVertex {
public:
  MediumVertex(const MediumPoint& point, const Vec3& to_previous, const Wavelengths& w, TransportMode mode)
      : point_(point), w_(w), to_previous_(to_previous), mode_(mode) {}

  const MediumPoint& point() const { return point_; }

  bool respond(const Vec3& d, BasicResponse<L>& out) const {
    const PhaseEval e = phase().eval_pdf(to_previous_, d, {w_, point_.p});
    if (is_black(e.value)) return false;
    out.value = lift(e.value, d);
    out.pdf = e.pdf;
    return true;
  }
  Spectrum reverse_pdf(const Vec3& d) const { return phase().eval_pdf(d, to_previous_, {w_, point_.p}).pdf; }
  /// The extinction coefficient for light along d.
  Spectrum extinction(const Vec3& d) const {
    MediumCoefficients at;
    point_.medium->eval(point_.p, d, w_, at);
    return at.sigma_t;
  }
  Event scatter(float u1, Vec2 u2, BasicScatter<L>& out) const {
    const std::optional<PhaseSample> s = phase().sample(to_previous_, u1, u2, {w_, point_.p});
    if (!s || !(s->pdf[0] > 0)) return Event::blocked;
    out.d = s->wo;
    out.value = lift(s->value, s->wo);
    out.pdf = s->pdf;
    out.delta = false;
    out.eta = 1;
    return Event::medium;
  }

private:
  const PhaseFunction& phase() const { return point_.medium->phase(); }
  typename L::Weight lift(const Spectrum& value, const Vec3& d) const {
    return mode_ == TransportMode::radiance ? L::lift(value, point_.p, -d, to_previous_)
                                            : L::lift(value, point_.p, -to_previous_, d);
  }

  MediumPoint point_;
  const Wavelengths& w_;
  Vec3 to_previous_;
  TransportMode mode_;
};

/// A vertex on a surface or in a medium, made in place. In `Space::empty` all vertices are on surfaces, and
/// none has a rank.
template <Space kSpace, class L = Unpolarised>
class BasicVertex {
public:
  static constexpr bool kMayBeInMedium = kSpace == Space::any;

  BasicVertex(const Scene& scene, const RayTracer::Hit& hit, const Ray& ray, const Wavelengths& w,
              TransportMode mode)
      : surface_(scene, hit, ray, w, mode) {}
  BasicVertex(const SurfacePoint& point, const Vec3& to_previous, const Wavelengths& w, TransportMode mode)
      : surface_(point, to_previous, w, mode) {}
  BasicVertex(const MediumPoint& point, const Vec3& to_previous, const Wavelengths& w,
              TransportMode mode) requires(kMayBeInMedium)
      : medium_(point, to_previous, w, mode), in_medium_(true) {}

  bool is_surface() const { return !in_medium(); }
  /// The vertex as a surface vertex; only for vertices on surfaces, as the two functions below.
  const SurfaceVertex<L>& on_surface() const { return surface_; }
  const SurfacePoint& point() const { return surface_.point(); }
  const Surface& surface() const { return surface_.surface(); }

  Vec3 p() const { return in_medium() ? medium_.point().p : surface_.point().p; }
  RayOrigin origin() const {
    return in_medium() ? RayOrigin::in_space(medium_.point().p) : RayOrigin::of(surface_.point());
  }
  /// The light that the surface emits, or null.
  const Light* light() const { return in_medium() ? nullptr : surface().light; }
  /// Whether connections can contribute at this vertex.
  bool is_smooth() const { return in_medium() || surface_.is_smooth(); }
  /// Whether the surface has a null component, which the path may cross.
  bool is_passable() const { return !in_medium() && surface().passable; }
  /// Whether the surface has a BSSRDF.
  bool has_exit() const { return !in_medium() && surface().has_exit(); }
  /// Whether `scatter` uses `u1`, or the BSDF uses the key.
  bool needs_choice() const {
    return in_medium() ? medium_.point().medium->phase().needs_choice() : surface().needs_choice;
  }
  /// Turns the ray that has ended here into one that leaves along `d`. `has_media`: the medium and the
  /// interior list are updated as well (`Scene::has_media`).
  void leave(const Vec3& d, bool has_media, RayState& state) const {
    if (has_media && !in_medium()) state.pass(surface_.point(), state.ray.d, d);
    const RayOrigin from = origin();
    const float time = state.ray.time;
    state.ray = from.spawn(d);
    state.ray.time = time;
    if (has_media) state.offset = from.offset(state.ray);
  }
  /// The state of a ray that leaves along `d`, except for the ray itself. `state` belongs to the ray that led
  /// to the vertex.
  RayState leaving(const Vec3& d, const RayState& state) const {
    RayState leaving = state;
    if (!in_medium()) leaving.pass(surface_.point(), state.ray.d, d);
    return leaving;
  }

  /// Must be called before the functions below for a vertex on a surface. `key` is for stochastic BSDFs.
  /// `state` belongs to the ray that led to the vertex.
  void prepare(std::uint32_t key, const RayState& state) {
    surface_.prepare(key);
    if (kSpace == Space::any && surface().rank != 0)
      surface_.set_exterior(state.around(point(), state.ray.d));
  }
  /// The normal on the side from which light is scattered; zero in a medium and where a BSDF scatters from
  /// both sides. Light sampling and its pdfs depend on it.
  Vec3 facing() const { return in_medium() ? Vec3{} : surface_.facing(); }
  /// Sets the value and the pdf of scattering into `d`; false where the value is zero.
  bool respond(const Vec3& d, BasicResponse<L>& out) const {
    return in_medium() ? medium_.respond(d, out) : surface_.respond(d, out);
  }
  // For bidirectional methods, which need the pdfs of other techniques:
  /// Pdf of the reversed event: a path that arrives along -d, in the other mode of transport, is scattered
  /// towards the previous vertex.
  Spectrum reverse_pdf(const Vec3& d) const {
    return in_medium() ? medium_.reverse_pdf(d) : surface_.reverse_pdf(d);
  }
  /// Pdf of the reversed event for a direction that `scatter` has sampled.
  Spectrum reverse_pdf(const BasicScatter<L>& s) const {
    return in_medium() ? medium_.reverse_pdf(s.d) : surface_.reverse_pdf(s);
  }
  /// Factor from area perpendicular to `d` to the measure of the vertex: the cosine on a surface (area), the
  /// extinction coefficient in a medium (volume).
  Spectrum density_across(const Vec3& d) const {
    return in_medium() ? medium_.extinction(d) : Spectrum(std::abs(dot(surface_.point().ng, d)));
  }

  /// Samples a direction; returns what `SurfaceVertex::scatter` does, or `medium` where a phase function
  /// scatters the path.
  Event scatter(float u1, Vec2 u2, BasicScatter<L>& out) const {
    return in_medium() ? medium_.scatter(u1, u2, out) : surface_.scatter(u1, u2, out);
  }

private:
  bool in_medium() const { return kMayBeInMedium && in_medium_; }

  union {
    SurfaceVertex<L> surface_;
    MediumVertex<L> medium_;
  };
  bool in_medium_ = false;
};

using Vertex = BasicVertex<Space::any>;

}  // namespace aureole

// SPDX-License-Identifier: Apache-2.0
#include "aureole/transport/emerge.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "aureole/core/random.h"
#include "aureole/math/warp.h"

namespace aureole {

namespace {

/// The probe rays of one entry.
class Probes {
public:
  Probes(const SurfacePoint& entry, const Wavelengths& w)
      : entry_(entry), ctx_{w, entry}, bssrdf_(*entry.surface->exit->bssrdf), reach_(bssrdf_.reach(ctx_)) {
    const Frame frame = Frame::from_normal(entry.ng);
    axes_ = {frame.n, frame.s, frame.t};
    // On a curved surface, rays along the tangents hit parts that rays along the normal only graze.
    probabilities_ = {0.5f, 0.25f, 0.25f};
    // Rays cannot resolve exits that are nearer to the entry than the rounding error of positions.
    least_ = 16 * length(entry.p_error);
  }

  /// Samples the distance from the entry.
  float draw_distance(const EmergenceRandom& random) const {
    return bssrdf_.sample_distance(random.place.x, ctx_);
  }
  /// Whether light leaves where it has entered: the distance is too short for rays.
  bool is_here(float distance) const { return distance < least_; }
  BssrdfEval here(float distance) const { return bssrdf_.eval_pdf(distance, ctx_); }

  /// The probe ray of unit direction at the distance `r` from the entry. It ends where exits are no longer
  /// sampled.
  Ray ray(float r, const EmergenceRandom& random) const {
    const std::size_t k = random.axis < 0.5f ? 0 : random.axis < 0.75f ? 1 : 2;
    const Vec2 turn = cos_sin_2pi(random.place.y);
    const float depth = half_length(r);
    const Vec3 foot = entry_.p + (axes_[(k + 1) % 3] * turn.x + axes_[(k + 2) % 3] * turn.y) * r;
    return {foot + axes_[k] * depth, -axes_[k], 2 * depth};
  }

  /// Value P of the BSSRDF at an exit, and the pdf per area of the surface with which that exit is sampled.
  BssrdfEval at(const SurfacePoint& exit) const {
    const Vec3 offset = exit.p - entry_.p;
    BssrdfEval e;
    e.value = bssrdf_.eval_pdf(length(offset), ctx_).value;
    for (std::size_t k = 0; k < 3; ++k) {
      const float height = dot(offset, axes_[k]);
      const float r = length(offset - axes_[k] * height);
      if (is_here(r) || !(std::abs(height) <= half_length(r))) continue;
      e.pdf += bssrdf_.eval_pdf(r, ctx_).pdf * (probabilities_[k] * std::abs(dot(exit.ng, axes_[k])));
    }
    return e;
  }

private:
  /// Half the length of the probe ray at the distance r in its plane, for all wavelengths. The ray ends at
  /// the sphere that contains nearly all light, and beyond a flat surface.
  float half_length(float r) const {
    const float left = reach_ * reach_ - r * r;
    return std::max(left > 0 ? std::sqrt(left) : 0.f, r);
  }

  const SurfacePoint& entry_;
  BssrdfContext ctx_;
  const Bssrdf& bssrdf_;
  float reach_, least_;
  std::array<Vec3, 3> axes_;
  std::array<float, 3> probabilities_;
};

}  // namespace

bool emerge(const Scene& scene, const SurfacePoint& entry, const Wavelengths& w,
            const EmergenceRandom& random, const Spectrum& throughput, const Spectrum& ratio,
            Emergence& out) {
  const Probes probes(entry, w);
  const float distance = probes.draw_distance(random);
  if (probes.is_here(distance)) {
    const BssrdfEval e = probes.here(distance);
    out.point = entry, out.value = e.value, out.pdf = e.pdf, out.chosen = 1;
    out.point.surface = entry.surface->exit;
    return e.pdf[0] > 0;
  }
  const Ray whole = probes.ray(distance, random);
  const Vec3 end = whole.o + whole.d * whole.t_max;
  // Upper bound of the number of hits: a ray within the plane of a surface would hit it without end.
  constexpr int kMaxPoints = 1000;
  float total = 0, kept = 0;
  std::uint64_t state = random.key;
  Ray ray = whole;
  for (int i = 0; i < kMaxPoints; ++i) {
    const RayTracer::Hit hit = scene.tracer().intersect(ray);
    if (!hit) break;
    const SurfacePoint point = scene.surface_point(hit, ray);
    ray.o = offset_origin(point, ray.d);
    ray.t_max = dot(end - ray.o, ray.d);
    if (point.surface == entry.surface && point.instance == entry.instance) {
      const BssrdfEval e = probes.at(point);
      // Contribution of this exit to the path, which does not depend on which wavelength is the hero.
      const float density = mean(ratio * e.pdf),
                  share = density > 0 ? mean(throughput * e.value) / density : 0;
      if (share > 0 && share < kInfinity) {
        total += share;
        state = mix_bits(state + 0x9e3779b97f4a7c15u);
        if (unit_float(std::uint32_t(state >> 32)) * total < share) {
          kept = share;
          out.point = point, out.value = e.value, out.pdf = e.pdf;
        }
      }
    }
    if (!(ray.t_max > 0)) break;
  }
  if (!(kept > 0) || !(out.pdf[0] > 0)) return false;
  out.point.surface = entry.surface->exit;
  out.chosen = kept / total;
  return true;
}

}  // namespace aureole

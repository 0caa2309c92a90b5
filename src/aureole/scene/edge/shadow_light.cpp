// SPDX-License-Identifier: Apache-2.0
#include "aureole/scene/edge/shadow_light.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <unordered_map>
#include <vector>

#include "aureole/core/keyed_random.h"

namespace aureole {
namespace {

constexpr int kPlacesAlong = 8;  ///< points on the film, along each axis
constexpr int kLampRays = 16384;
/// Largest number of points that are kept on one surface, and largest number of surfaces, those that most
/// rays hit. The limit for each surface lets the few points behind a small hole count as well.
constexpr std::size_t kMostBounces = 32, kMostSurfaces = 16;
/// Fewest points in shadow for a result.
constexpr std::size_t kFewestPlaces = 8;

Vec2 next2(KeyedRandom& random) {
  const float x = random.next();
  return {x, random.next()};
}

bool is_matt_or_glossy(const SurfacePoint& point) {
  return has(point.surface->lobes, Lobe::diffuse | Lobe::glossy);
}

bool is_open(const DiffractionInput& scene, const SurfacePoint& from, const Vec3& d, const Vec3* to) {
  Ray ray{offset_origin(from, d), d, kInfinity};
  if (to) ray.d = *to - ray.o, ray.t_max = 1 - 1e-4f;
  return !scene.surfaces.tracer->occluded(ray);
}

/// The first hit of light of a lamp on a surface.
struct Bounce {
  SurfacePoint point;
  Vec3 to_lamp;
  Spectrum power;  ///< power of the ray [W]
};

std::vector<Bounce> bounces(const DiffractionInput& scene, const Wavelengths& w, KeyedRandom& random) {
  std::vector<std::vector<Bounce>> found;
  std::unordered_map<const Surface*, std::size_t> number;
  for (int i = 0; i < kLampRays; ++i) {
    const auto lamp = scene.lights.choose_by_power(next2(random));
    if (!lamp || !(lamp->probability > 0)) continue;
    // Directions are stratified (Roberts' sequence), since few of the rays pass small holes.
    const auto spread = [&](double step) { return float(std::fmod((i + 0.5) * step, 1.0)); };
    const Vec2 position = next2(random), direction{spread(0.7548776662466927), spread(0.5698402909980532)};
    const auto s = lamp->light->sample_ray(lamp->part, position, direction, w);
    if (!s || !(s->pdf_position > 0) || !(s->pdf_direction > 0)) continue;
    const auto point =
        scene.surfaces.intersect({offset_origin(s->p, s->p_error, s->ng, s->d), s->d, kInfinity});
    if (!point || !is_matt_or_glossy(*point)) continue;
    const auto [at, is_new] = number.try_emplace(point->surface, found.size());
    if (is_new) found.emplace_back();
    const float density = s->pdf_position * s->pdf_direction * lamp->probability * kLampRays;
    found[at->second].push_back({*point, -s->d, s->value * (1 / density)});
  }
  std::ranges::stable_sort(found, std::ranges::greater{},
                           [](const auto& of_surface) { return of_surface.size(); });
  found.resize(std::min(found.size(), kMostSurfaces));
  std::vector<Bounce> result;
  for (const std::vector<Bounce>& all : found) {
    const std::size_t kept = std::min(all.size(), kMostBounces);
    for (std::size_t i = 0; i < kept; ++i) {
      result.push_back(all[i]);
      result.back().power *= float(all.size()) / float(kept);
    }
  }
  return result;
}

/// Returns the irradiance of a point by light that the bounces reflect to it.
double irradiance_from(const DiffractionInput& scene, std::span<const Bounce> bounces, const SurfacePoint& x,
                       const Vec3& n, const Wavelengths& w) {
  double sum = 0;
  for (const Bounce& b : bounces) {
    const Vec3 to = x.p - b.point.p;
    const float d2 = length_squared(to);
    if (!(d2 > 0)) continue;
    const Vec3 d = to * (1 / std::sqrt(d2));
    const float cosine = -dot(n, d);
    if (!(cosine > 0)) continue;
    const BsdfContext context{w, b.point};
    const Frame& frame = b.point.shading;
    const double sent = double(
        mean(b.power * b.point.surface->bsdf->eval(frame.to_local(b.to_lamp), frame.to_local(d), context)));
    if (sent > 0 && is_open(scene, x, -d, &b.point.p)) sum += sent * double(cosine / d2);
  }
  return sum;
}

/// Returns an estimate of the unobstructed irradiance, of a matt point with the normal n, by a lamp as it
/// irradiates a sampled edge, from the direction of that edge, over the lamp's probability.
double unobstructed(const SceneEdges& edges, const LitEdges& lit_edges, const Vec3& p, const Vec3& n,
                    const LightChoice& lamp, const Wavelengths& w, KeyedRandom& random) {
  const Vec2 u = next2(random);
  const auto end = lamp_end(*lamp.light, lamp.part, u, p, w);
  if (!end) return 0;
  const LitEdges::Lamp* known = lit_edges.from(*lamp.light, lamp.part);
  const float at[3] = {random.next(), random.next(), random.next()};
  const auto place = edges.choose_from(*end, at, nullptr, known ? known->lit.data() : nullptr);
  if (!place) return 0;
  const Vec3 y = place->on_edge();
  const auto s = lamp.light->sample_direct(y, lamp.part, u, w);
  if (!s || !(s->pdf > 0)) return 0;
  const float nearer =
      s->infinite ? 1 : length_squared(s->p - y) / std::max(length_squared(s->p - p), 1e-30f);
  return double(mean(s->radiance)) * nearer * std::max(0.f, dot(n, normalize(y - p))) /
         (s->pdf * lamp.probability);
}

bool is_lit(const DiffractionInput& scene, const SurfacePoint& point, const LightChoice& lamp,
            const Wavelengths& w, KeyedRandom& random) {
  const auto s = lamp.light->sample_direct(point.p, lamp.part, next2(random), w);
  return s && s->pdf > 0 && is_open(scene, point, s->wo, s->infinite ? nullptr : &s->p);
}

}  // namespace

float light_in_shadows(const DiffractionInput& scene, const SceneEdges& edges, const LitEdges& lit_edges,
                       const Wavelengths& w) {
  if (scene.lights.empty() || !scene.has_binary_visibility) return 0;
  KeyedRandom random(0x5851f42du);
  const std::vector<Bounce> lit = bounces(scene, w, random);
  if (lit.empty()) return 0;
  std::vector<double> ratios;
  const FilmPart& part = scene.sensor.part;
  const Vec2 size = part.upper - part.lower;
  for (int i = 0; i < kPlacesAlong * kPlacesAlong; ++i) {
    const Vec2 film{part.lower.x + size.x * (float(i % kPlacesAlong) + 0.5f) / kPlacesAlong,
                    part.lower.y + size.y * (float(i / kPlacesAlong) + 0.5f) / kPlacesAlong};
    const Ray ray = scene.sensor.sample_ray(film, next2(random)).ray;
    const auto point = scene.surfaces.intersect(ray);
    const auto lamp = scene.lights.choose_by_power(next2(random));
    if (!point || !is_matt_or_glossy(*point) || !lamp || !(lamp->probability > 0)) continue;
    const Vec3 n = dot(point->shading.n, ray.d) < 0 ? point->shading.n : -point->shading.n;
    if (is_lit(scene, *point, *lamp, w, random)) continue;
    if (const double direct = unobstructed(edges, lit_edges, point->p, n, *lamp, w, random); direct > 0)
      ratios.push_back(irradiance_from(scene, lit, *point, n, w) / direct);
  }
  if (ratios.size() < kFewestPlaces) return 0;
  const auto quartile = ratios.begin() + std::ptrdiff_t(ratios.size() / 4);
  std::ranges::nth_element(ratios, quartile);
  return float(*quartile);
}

}  // namespace aureole

// SPDX-License-Identifier: Apache-2.0
#include "aureole/transport/flight.h"

#include <algorithm>
#include <cmath>

#include "aureole/core/keyed_random.h"

namespace aureole {

namespace {

/// The distance to the next event of a Poisson process of density 1.
float free_path(float u) { return -std::log1p(-u); }

/// exp(-sigma t); where sigma is 0, 1 at any distance.
Spectrum passing(const Spectrum& sigma, float t) {
  return make_spectrum([&](int i) { return sigma[i] > 0 ? std::exp(-sigma[i] * t) : 1.f; });
}

/// The integral of exp(-sigma s) over s from 0 to t.
float attenuated_length(float sigma, float t) {
  const float depth = sigma * t;
  return depth > 1e-3f ? -std::expm1(-depth) / sigma : t * (1 - 0.5f * depth);
}

/// The density per length and solid angle with which connections would have found emission at p.
float connection_density(const Glow& glow, const Medium& medium, const Vec3& p) {
  return glow.media->pdf(medium, glow.from.p, glow.from.facing, p) * length_squared(p - glow.from.p);
}

/// Adds emission at a tentative collision, of which the part `passed` arrives, over the density of finding it there,
/// `flight` for each density of the path before, and `connection` for each of a connection.
void add_collision(const Medium& medium, const Vec3& p, const MediumCoefficients& at, const Spectrum& passed,
                   const Spectrum& flight, float connection, Glow& glow) {
  if (is_black(at.emission)) return;
  Spectrum found = glow.ratio * flight;
  if (glow.media) found += glow.light_ratio * (connection * connection_density(glow, medium, p));
  glow.seen += passed * at.emission * (1 / sum(found));
}

/// The light that a medium of the extinction `sigma` emits along the ray.
void add_glow(const Medium& medium, const Ray& ray, float t_max, const Spectrum& sigma,
              const Spectrum& emission, const Wavelengths& w, float u, Glow& glow) {
  // A medium without end that does not absorb would shine without bound.
  const float end = std::min(t_max, kFarthest);
  const float inverse_size = glow.media ? glow.media->inverse_size(medium) : 0.f;
  if (medium.has_uniform_emission() && !(inverse_size > 0)) {
    glow.seen += emission * make_spectrum([&](int i) { return attenuated_length(sigma[i], end); }) *
                 (1 / sum(glow.ratio));
    return;
  }
  // One place, drawn as a mean wavelength would be absorbed: the same for each hero.
  const float middle = mean(sigma), length = attenuated_length(middle, end);
  const float t = middle * end > 1e-3f ? -std::log1p(-u * middle * length) / middle : u * end;
  const Vec3 p = ray.o + ray.d * t;
  MediumCoefficients at;
  medium.eval(p, ray.d, w, at);
  const Spectrum light = at.emission * passing(sigma, t) * (length * std::exp(middle * t));
  const float found = inverse_size > 0 ? connection_density(glow, medium, p) : 0.f;
  if (!(found > 0)) {
    glow.seen += light * (1 / sum(glow.ratio));
    return;
  }
  const float rate = emission_rate(medium, p, ray.d, sigma, inverse_size, w);
  glow.seen += light * (rate / sum(glow.ratio * rate + glow.light_ratio * found));
}

/// The extinction is the same everywhere: the distance is drawn in closed form for the hero.
bool fly_uniformly(const Medium& medium, const Ray& ray, float t_max, const Wavelengths& w,
                   FlightRandom random, Passage& passage, Glow* glow, float& t) {
  MediumCoefficients at;
  medium.eval(ray.o, ray.d, w, at);
  const Spectrum sigma = at.sigma_t;
  const float hero = sigma[0];
  if (glow) add_glow(medium, ray, t_max, sigma, at.emission, w, KeyedRandom(random.key).next(), *glow);
  t = hero > 0 ? free_path(random.first) / hero : kInfinity;
  if (!(t < t_max)) {
    const float inverse = hero > 0 ? std::exp(hero * t_max) : 1.f;
    passage.flight = passing(sigma, t_max) * inverse;
    passage.connection = inverse;
    passage.value = Weight(passage.flight);
    return false;
  }
  if (!medium.is_uniform()) medium.eval(ray.o + ray.d * t, ray.d, w, at);
  const float inverse = std::exp(hero * t) / hero;
  const Spectrum relative = passing(sigma, t) * inverse;
  passage.flight = relative * sigma;
  passage.connection = inverse;
  passage.value = Weight(relative * at.sigma_s);
  return true;
}

/// Calls `visit(t, bound)` for the places of a Poisson process along the ray whose density is that of a grid's
/// bounds times `scale`, in order, until it returns true. `first` decides where the first is.
template <class Visit>
bool visit_events(const MajorantGrid& grid, const Ray& ray, float t_max, float scale, float first,
                  KeyedRandom& random, Visit&& visit) {
  MajorantGrid::Walk walk(grid, ray, t_max);
  MajorantGrid::Piece piece;
  float depth = free_path(first);
  while (walk.next(piece)) {
    const float bound = piece.bound * scale;
    for (float t = piece.begin;;) {
      const float left = (piece.end - t) * bound;
      if (!(depth < left)) {
        depth -= left;
        break;
      }
      t += depth / bound;
      depth = free_path(random.next());
      if (visit(t, bound)) return true;
    }
  }
  return false;
}

/// Events under the bounds of a grid.
bool fly_by_null_collisions(const Medium& medium, const MajorantGrid& grid, const Ray& ray, float t_max,
                            const Wavelengths& w, FlightRandom random, Passage& passage, Glow* glow,
                            float& t) {
  KeyedRandom further(random.key);
  MediumCoefficients at;
  // The value of the null collisions so far is their density on a walk, too.
  Spectrum passed = 1.f;
  float connection = 1;
  const float scale = max_component(medium.majorant(ray.d, w));
  if (visit_events(grid, ray, t_max, scale, random.first, further, [&](float place, float bound) {
        medium.eval(ray.o + ray.d * place, ray.d, w, at);
        if (glow) add_collision(medium, ray.o + ray.d * place, at, passed, passed * bound, connection, *glow);
        const float hero = at.sigma_t[0];
        if (further.next() * bound < hero) {
          passage.value = Weight(passed * at.sigma_s * (1 / hero));
          passage.flight = passed * at.sigma_t * (1 / hero);
          passage.connection = connection / hero;
          t = place;
          return true;
        }
        // By rounding an extinction may exceed the bound.
        passed *= max(Spectrum(bound) - at.sigma_t, 0.f) * (1 / (bound - hero));
        connection *= bound / (bound - hero);
        return false;
      }))
    return true;
  passage.value = Weight(passed);
  passage.flight = passed;
  passage.connection = connection;
  return false;
}

}  // namespace

void find_surroundings(const Scene& scene, const Light* light, Flight& flight) {
  if (!scene.has_media()) return;
  const Medium* stated = light ? light->emitter->medium() : scene.sensor().sensor->medium();
  if (!stated) return find_surroundings(scene, flight);
  scene.shapes_around(flight.ray, flight.inside);
  flight.medium = stated;
}

void find_surroundings(const Scene& scene, Flight& flight) {
  scene.shapes_around(flight.ray, flight.inside);
  const Surface* filling = flight.inside.filling();
  flight.medium = filling ? filling->inside : scene.medium_at(flight.ray);
}

bool fly(const Medium& medium, const Ray& ray, float t_max, const Wavelengths& w, FlightRandom random,
         Passage& passage, Glow* glow, float& t) {
  if (const MajorantGrid* grid = medium.majorants())
    return fly_by_null_collisions(medium, *grid, ray, t_max, w, random, passage, glow, t);
  return fly_uniformly(medium, ray, t_max, w, random, passage, glow, t);
}

void end_at_event(Flight& flight, const Wavelengths& w, float first) {
  const Medium& medium = *flight.medium;
  if (medium.majorants() || medium.emits()) return;
  MediumCoefficients at;
  medium.eval(flight.ray.o, flight.ray.d, w, at);
  const float hero = at.sigma_t[0];
  // Room for rounding: which of two is nearer, the event or a surface, is decided by `fly`.
  if (hero > 0) flight.ray.t_max = free_path(first) / hero * 1.00001f;
}

float emission_rate(const Medium& medium, const Vec3& p, const Vec3& d, const Spectrum& sigma_t,
                    float inverse_size, const Wavelengths& w) {
  if (const MajorantGrid* grid = medium.majorants())
    return grid->at(p) * max_component(medium.majorant(d, w));
  return std::max(mean(sigma_t), inverse_size);
}

namespace {

/// Ratio tracking (Novak, Selle & Jarosz 2014, "Residual ratio tracking for estimating attenuation in
/// participating media"); `meet(p, at, bound, passed)` is called at each event, of which the part `passed` arrives,
/// and `go_on(passed, random)` is asked after it.
template <class Meet, class GoOn>
Spectrum track_ratio(const Medium& medium, const MajorantGrid& grid, const Ray& ray, float t_max,
                     const Wavelengths& w, std::uint32_t key, Meet&& meet, GoOn&& go_on) {
  KeyedRandom random(key);
  MediumCoefficients at;
  Spectrum passed = 1.f;
  const float first = random.next(), scale = max_component(medium.majorant(ray.d, w));
  visit_events(grid, ray, t_max, scale, first, random, [&](float t, float bound) {
    const Vec3 p = ray.o + ray.d * t;
    medium.eval(p, ray.d, w, at);
    meet(p, at, bound, passed);
    passed *= max(Spectrum(1.f) - at.sigma_t * (1 / bound), 0.f);
    return !go_on(passed, random);
  });
  return passed;
}

Spectrum passed_uniformly(const Medium& medium, const Ray& ray, float t_max, const Wavelengths& w) {
  MediumCoefficients at;
  medium.eval(ray.o, ray.d, w, at);
  return passing(at.sigma_t, t_max);
}

}  // namespace

Straight transmittance(const Medium& medium, const Ray& ray, float t_max, const Wavelengths& w,
                       std::uint32_t key, Glow* glow) {
  const MajorantGrid* grid = medium.majorants();
  if (!grid) {
    MediumCoefficients at;
    medium.eval(ray.o, ray.d, w, at);
    if (glow) add_glow(medium, ray, t_max, at.sigma_t, at.emission, w, KeyedRandom(key).next(), *glow);
    return {passing(at.sigma_t, t_max)};
  }
  Straight result;
  result.passed = track_ratio(
      medium, *grid, ray, t_max, w, key,
      [&](const Vec3& p, const MediumCoefficients& c, float bound, const Spectrum& passed) {
        if (glow) add_collision(medium, p, c, passed * result.roulette, Spectrum(bound), 1, *glow);
      },
      [&](const Spectrum& passed, KeyedRandom& random) {
        // Roulette, the same for each hero.
        constexpr float kLittle = 0.1f, kSurvival = 0.5f;
        if (!(max_component(passed) * result.roulette < kLittle)) return true;
        result.roulette = random.next() < kSurvival ? result.roulette / kSurvival : 0.f;
        return result.roulette > 0;
      });
  return result;
}

Spectrum passed_to(const Medium& medium, const Ray& ray, float t, const Wavelengths& w, std::uint32_t key) {
  const MajorantGrid* grid = medium.majorants();
  if (!grid) return passed_uniformly(medium, ray, t, w);
  return track_ratio(
      medium, *grid, ray, t, w, key, [](const Vec3&, const MediumCoefficients&, float, const Spectrum&) {},
      [](const Spectrum& passed, KeyedRandom&) { return !is_black(passed); });
}

}  // namespace aureole

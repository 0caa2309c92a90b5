// SPDX-License-Identifier: Apache-2.0
#include "aureole/transport/flight.h"

#include <algorithm>
#include <cmath>

#include "aureole/core/random.h"

namespace aureole {

namespace {

/// Numbers in [0, 1) from a key.
class KeyedRandom {
public:
  explicit KeyedRandom(std::uint32_t key) : state_(mix_bits(key + 0x9e3779b97f4a7c15u)) {}
  float next() { return unit_float(std::uint32_t(mix_bits(state_ += 0x9e3779b97f4a7c15u) >> 32)); }

private:
  std::uint64_t state_;
};

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

/// The light that a medium of the extinction `sigma` emits along the ray.
Spectrum emitted_along(const Medium& medium, const Ray& ray, float t_max, const Spectrum& sigma,
                       const Spectrum& emission, const Wavelengths& w, float u) {
  // A medium without end that does not absorb would shine without bound.
  const float end = std::min(t_max, kFarthest);
  if (medium.has_uniform_emission())
    return emission * make_spectrum([&](int i) { return attenuated_length(sigma[i], end); });
  // One place, drawn as a mean wavelength would be absorbed: the same for each hero.
  const float middle = mean(sigma), length = attenuated_length(middle, end);
  const float t = middle * end > 1e-3f ? -std::log1p(-u * middle * length) / middle : u * end;
  MediumCoefficients at;
  medium.eval(ray.o + ray.d * t, ray.d, w, at);
  return at.emission * passing(sigma, t) * (length * std::exp(middle * t));
}

/// The extinction is the same everywhere: the distance is drawn in closed form for the hero.
bool fly_uniformly(const Medium& medium, const Ray& ray, float t_max, const Wavelengths& w,
                   FlightRandom random, Passage& passage, Spectrum* emitted, float& t) {
  MediumCoefficients at;
  medium.eval(ray.o, ray.d, w, at);
  const Spectrum sigma = at.sigma_t;
  const float hero = sigma[0];
  if (emitted && medium.emits())
    *emitted = emitted_along(medium, ray, t_max, sigma, at.emission, w, KeyedRandom(random.key).next());
  t = hero > 0 ? free_path(random.first) / hero : kInfinity;
  if (!(t < t_max)) {
    const float inverse = hero > 0 ? std::exp(hero * t_max) : 1.f;
    passage.flight = passing(sigma, t_max) * inverse;
    passage.connection = inverse;
    passage.value = Weight(passage.flight);
    return false;
  }
  if (!medium.is_uniform()) medium.eval(ray.o + ray.d * t, ray.d, w, at);
  passage.connection = std::exp(hero * t) / hero;
  const Spectrum relative = passing(sigma, t) * passage.connection;
  passage.flight = relative * sigma;
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
                            const Wavelengths& w, FlightRandom random, const Spectrum& ratio,
                            Passage& passage, Spectrum* emitted, float& t) {
  const bool emits = emitted && medium.emits();
  KeyedRandom further(random.key);
  MediumCoefficients at;
  // The value of the null collisions so far is their density on a walk, too.
  Spectrum passed = 1.f;
  float connection = 1;
  const float scale = max_component(medium.majorant(ray.d, w));
  if (visit_events(grid, ray, t_max, scale, random.first, further, [&](float place, float bound) {
        medium.eval(ray.o + ray.d * place, ray.d, w, at);
        if (emits) *emitted += passed * at.emission * (sum(ratio) / (bound * sum(ratio * passed)));
        const float hero = at.sigma_t[0];
        if (further.next() * bound < hero) {
          passage.value = Weight(passed * at.sigma_s * (1 / hero));
          passage.flight = passed * at.sigma_t * (1 / hero);
          passage.connection = connection * (1 / hero);
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
  scene.shapes_around(flight.ray, flight.inside);
  const Medium* stated = light ? light->emitter->medium() : scene.sensor().sensor->medium();
  const Surface* filling = flight.inside.filling();
  flight.medium = stated ? stated : filling ? filling->inside : scene.medium_at(flight.ray);
}

bool fly(const Medium& medium, const Ray& ray, float t_max, const Wavelengths& w, FlightRandom random,
         const Spectrum& ratio, Passage& passage, Spectrum* emitted, float& t) {
  if (const MajorantGrid* grid = medium.majorants())
    return fly_by_null_collisions(medium, *grid, ray, t_max, w, random, ratio, passage, emitted, t);
  return fly_uniformly(medium, ray, t_max, w, random, passage, emitted, t);
}

Spectrum transmittance(const Medium& medium, const Ray& ray, float t_max, const Wavelengths& w,
                       std::uint32_t key) {
  MediumCoefficients at;
  const MajorantGrid* grid = medium.majorants();
  if (!grid) {
    medium.eval(ray.o, ray.d, w, at);
    return passing(at.sigma_t, t_max);
  }
  // Ratio tracking (Novak, Selle & Jarosz 2014, "Residual ratio tracking for estimating attenuation in
  // participating media").
  KeyedRandom random(key);
  Spectrum passed = 1.f;
  const float first = random.next(), scale = max_component(medium.majorant(ray.d, w));
  const bool lost = visit_events(*grid, ray, t_max, scale, first, random, [&](float t, float bound) {
    medium.eval(ray.o + ray.d * t, ray.d, w, at);
    passed *= max(Spectrum(1.f) - at.sigma_t * (1 / bound), 0.f);
    // Roulette, the same for each hero.
    constexpr float kLittle = 0.1f, kSurvival = 0.5f;
    if (!(max_component(passed) < kLittle)) return false;
    passed *= 1 / kSurvival;
    return !(random.next() < kSurvival);
  });
  return lost ? Spectrum(0.f) : passed;
}

}  // namespace aureole

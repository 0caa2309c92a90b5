// SPDX-License-Identifier: Apache-2.0
#include "aureole/transport/medium_segment.h"

#include <algorithm>
#include <cmath>

#include "aureole/core/keyed_random.h"

namespace aureole {

namespace {

/// The distance to the next event of a Poisson process of density 1.
float free_path(float u) { return -std::log1p(-u); }

/// exp(-sigma t); 1 at any distance where sigma is 0.
Spectrum passing(const Spectrum& sigma, float t) {
  return make_spectrum([&](int i) { return sigma[i] > 0 ? std::exp(-sigma[i] * t) : 1.f; });
}

/// The integral of exp(-sigma s) over s from 0 to t.
float attenuated_length(float sigma, float t) {
  const float depth = sigma * t;
  return depth > 1e-3f ? -std::expm1(-depth) / sigma : t * (1 - 0.5f * depth);
}

/// The density per length and solid angle with which connections would have found the emission at p.
float connection_density(const SegmentEmission& emission_sum, const Medium& medium, const Vec3& p) {
  return emission_sum.media->pdf(medium, emission_sum.from.p, emission_sum.from.facing, p) *
         length_squared(p - emission_sum.from.p);
}

/// Adds the emission at a tentative collision. `passed` is the transmittance to the collision, over the pdf
/// of finding it there. `flight` and `connection` are the pdfs of a collision there relative to the path so
/// far, of the walk and of connections.
void add_collision(const Medium& medium, const Vec3& p, const MediumCoefficients& at, const Spectrum& passed,
                   const Spectrum& flight, float connection, SegmentEmission& emission_sum) {
  if (is_black(at.emission)) return;
  Spectrum found = emission_sum.r_u * flight;
  if (emission_sum.media)
    found += emission_sum.r_l * (connection * connection_density(emission_sum, medium, p));
  emission_sum.radiance += passed * at.emission * (1 / sum(found));
}

/// The light that a medium of the extinction `sigma` emits along the ray.
void add_emission(const Medium& medium, const Ray& ray, float t_max, const Spectrum& sigma,
                  const Spectrum& emission, const Wavelengths& w, float u, SegmentEmission& emission_sum) {
  // The radiance of an infinite medium that emits and does not absorb has no upper bound.
  const float end = std::min(t_max, kFarthest);
  const float inverse_size = emission_sum.media ? emission_sum.media->inverse_size(medium) : 0.f;
  if (medium.has_uniform_emission() && !(inverse_size > 0)) {
    emission_sum.radiance += emission *
                             make_spectrum([&](int i) { return attenuated_length(sigma[i], end); }) *
                             (1 / sum(emission_sum.r_u));
    return;
  }
  // One position, sampled by the absorption at a mean wavelength, so that it does not depend on the hero.
  const float middle = mean(sigma), length = attenuated_length(middle, end);
  const float t = middle * end > 1e-3f ? -std::log1p(-u * middle * length) / middle : u * end;
  const Vec3 p = ray.o + ray.d * t;
  MediumCoefficients at;
  medium.eval(p, ray.d, w, at);
  const Spectrum light = at.emission * passing(sigma, t) * (length * std::exp(middle * t));
  const float found = inverse_size > 0 ? connection_density(emission_sum, medium, p) : 0.f;
  if (!(found > 0)) {
    emission_sum.radiance += light * (1 / sum(emission_sum.r_u));
    return;
  }
  const float rate = emission_rate(medium, p, ray.d, sigma, inverse_size, w);
  emission_sum.radiance += light * (rate / sum(emission_sum.r_u * rate + emission_sum.r_l * found));
}

/// Distance sampling in closed form for the hero, in a medium whose extinction is the same everywhere.
bool sample_uniform(const Medium& medium, const Ray& ray, float t_max, const Wavelengths& w,
                    DistanceRandom random, Passage& passage, SegmentEmission* emission_sum, float& t) {
  MediumCoefficients at;
  medium.eval(ray.o, ray.d, w, at);
  const Spectrum sigma = at.sigma_t;
  const float hero = sigma[0];
  if (emission_sum)
    add_emission(medium, ray, t_max, sigma, at.emission, w, KeyedRandom(random.key).next(), *emission_sum);
  t = hero > 0 ? free_path(random.first) / hero : kInfinity;
  if (!(t < t_max)) {
    const float inverse = hero > 0 ? std::exp(hero * t_max) : 1.f;
    passage.flight = passing(sigma, t_max) * inverse;
    passage.connection = inverse;
    passage.value = passage.flight;
    return false;
  }
  if (!medium.is_uniform()) medium.eval(ray.o + ray.d * t, ray.d, w, at);
  const float inverse = std::exp(hero * t) / hero;
  const Spectrum relative = passing(sigma, t) * inverse;
  passage.flight = relative * sigma;
  passage.connection = inverse;
  passage.value = relative * at.sigma_s;
  return true;
}

/// Calls `visit(t, bound)` for the positions of a Poisson process along the ray whose density is that of the
/// majorants times `scale`, in order, until `visit` returns true. The random number `first` decides the first
/// position.
template <class Visit>
bool visit_collisions(const Majorants& majorants, const Ray& ray, float t_max, float scale, float first,
                      KeyedRandom& random, Visit&& visit) {
  float depth = free_path(first);
  return majorants.visit_segments(ray, t_max, [&](const MajorantSegment& segment) {
    const float bound = segment.bound * scale;
    for (float t = segment.begin;;) {
      const float left = (segment.end - t) * bound;
      if (!(depth < left)) {
        depth -= left;
        return false;
      }
      t += depth / bound;
      depth = free_path(random.next());
      if (visit(t, bound)) return true;
    }
  });
}

/// Distance sampling by null collisions under majorants that vary.
bool sample_null_collisions(const Medium& medium, const Majorants& majorants, const Ray& ray, float t_max,
                            const Wavelengths& w, DistanceRandom random, Passage& passage,
                            SegmentEmission* emission_sum, float& t) {
  KeyedRandom further(random.key);
  MediumCoefficients at;
  // Product of the null-collision coefficients so far, which is also the pdf of a walk that passes them.
  Spectrum passed = 1.f;
  float connection = 1;
  const float scale = max_component(medium.majorant(ray.d, w));
  if (visit_collisions(majorants, ray, t_max, scale, random.first, further, [&](float place, float bound) {
        medium.eval(ray.o + ray.d * place, ray.d, w, at);
        if (emission_sum)
          add_collision(medium, ray.o + ray.d * place, at, passed, passed * bound, connection, *emission_sum);
        const float hero = at.sigma_t[0];
        if (further.next() * bound < hero) {
          passage.value = passed * at.sigma_s * (1 / hero);
          passage.flight = passed * at.sigma_t * (1 / hero);
          passage.connection = connection / hero;
          t = place;
          return true;
        }
        // By rounding, an extinction coefficient may exceed its majorant.
        passed *= max(Spectrum(bound) - at.sigma_t, 0.f) * (1 / (bound - hero));
        connection *= bound / (bound - hero);
        return false;
      }))
    return true;
  passage.value = passed;
  passage.flight = passed;
  passage.connection = connection;
  return false;
}

/// The extinction is that of all wavelengths and its integral is known: the distance has the density sigma T, and no
/// collision is null.
bool sample_closed_form(const Medium& medium, const Ray& ray, float t_max, const Wavelengths& w,
                        DistanceRandom random, Passage& passage, float& t) {
  const double wanted = double(free_path(random.first));
  t = medium.distance_of_thickness(ray, t_max, wanted);
  MediumCoefficients at;
  if (t < t_max) medium.eval(ray.o + ray.d * t, ray.d, w, at);
  if (!(t < t_max) || !(at.sigma_t[0] > 0)) {
    // By rounding, the end of a splat may be hit just outside of it.
    passage.value = passage.flight = 1.f;
    passage.connection = float(std::exp(t < t_max ? wanted : medium.optical_thickness(ray, t_max)));
    t = kInfinity;
    return false;
  }
  passage.value = at.sigma_s * (1 / at.sigma_t[0]);
  passage.flight = 1.f;
  passage.connection = float(std::exp(wanted)) / at.sigma_t[0];
  return true;
}

}  // namespace

bool sample_distance(const Medium& medium, const Ray& ray, float t_max, const Wavelengths& w,
                     DistanceRandom random, Passage& passage, SegmentEmission* emission_sum, float& t) {
  if (medium.has_closed_form()) return sample_closed_form(medium, ray, t_max, w, random, passage, t);
  if (const Majorants majorants = medium.majorants())
    return sample_null_collisions(medium, majorants, ray, t_max, w, random, passage, emission_sum, t);
  return sample_uniform(medium, ray, t_max, w, random, passage, emission_sum, t);
}

void cut_at_collision(RayState& state, const Wavelengths& w, float first) {
  const Medium& medium = *state.medium;
  if (medium.majorants() || medium.emits()) return;
  MediumCoefficients at;
  medium.eval(state.ray.o, state.ray.d, w, at);
  const float hero = at.sigma_t[0];
  // Margin for rounding: `fly` decides whether the event or a surface is nearer.
  if (hero > 0) state.ray.t_max = std::max(free_path(first) / hero * 1.00001f - state.offset, 0.f);
}

float emission_rate(const Medium& medium, const Vec3& p, const Vec3& d, const Spectrum& sigma_t,
                    float inverse_size, const Wavelengths& w) {
  if (const Majorants majorants = medium.majorants())
    return majorants.bound_at(p) * max_component(medium.majorant(d, w));
  return std::max(mean(sigma_t), inverse_size);
}

namespace {

/// Ratio tracking (Novak, Selle & Jarosz 2014, "Residual ratio tracking for estimating attenuation in
/// participating media"); `meet(p, at, bound, passed)` is called at each event, of which the part `passed`
/// arrives, and `go_on(passed, random)` is asked after it.
template <class Meet, class GoOn>
Spectrum track_ratio(const Medium& medium, const Majorants& majorants, const Ray& ray, float t_max,
                     const Wavelengths& w, std::uint32_t key, Meet&& meet, GoOn&& go_on) {
  KeyedRandom random(key);
  MediumCoefficients at;
  Spectrum passed = 1.f;
  const float first = random.next(), scale = max_component(medium.majorant(ray.d, w));
  visit_collisions(majorants, ray, t_max, scale, first, random, [&](float t, float bound) {
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

Transmittance transmittance(const Medium& medium, const Ray& ray, float t_max, const Wavelengths& w,
                            std::uint32_t key, SegmentEmission* emission_sum) {
  if (medium.has_closed_form()) return {Spectrum(float(std::exp(-medium.optical_thickness(ray, t_max))))};
  const Majorants majorants = medium.majorants();
  if (!majorants) {
    MediumCoefficients at;
    medium.eval(ray.o, ray.d, w, at);
    if (emission_sum)
      add_emission(medium, ray, t_max, at.sigma_t, at.emission, w, KeyedRandom(key).next(), *emission_sum);
    return {passing(at.sigma_t, t_max)};
  }
  Transmittance result;
  result.value = track_ratio(
      medium, majorants, ray, t_max, w, key,
      [&](const Vec3& p, const MediumCoefficients& c, float bound, const Spectrum& passed) {
        if (emission_sum)
          add_collision(medium, p, c, passed * result.roulette, Spectrum(bound), 1, *emission_sum);
      },
      [&](const Spectrum& passed, KeyedRandom& random) {
        // Russian roulette decides by a mean over wavelengths, so that it does not depend on the hero.
        constexpr float kRouletteThreshold = 0.1f, kSurvival = 0.5f;
        if (!(max_component(passed) * result.roulette < kRouletteThreshold)) return true;
        result.roulette = random.next() < kSurvival ? result.roulette / kSurvival : 0.f;
        return result.roulette > 0;
      });
  return result;
}

Spectrum transmittance_to(const Medium& medium, const Ray& ray, float t, const Wavelengths& w,
                          std::uint32_t key) {
  if (medium.has_closed_form()) return float(std::exp(-medium.optical_thickness(ray, t)));
  const Majorants majorants = medium.majorants();
  if (!majorants) return passed_uniformly(medium, ray, t, w);
  return track_ratio(
      medium, majorants, ray, t, w, key,
      [](const Vec3&, const MediumCoefficients&, float, const Spectrum&) {},
      [](const Spectrum& passed, KeyedRandom&) { return !is_black(passed); });
}

}  // namespace aureole

// SPDX-License-Identifier: Apache-2.0
// Spectral MIS, in one place: how the contributions of N wavelengths that were all carried by directions
// sampled from the hero are combined (Wilkie, Nawaz, Droske, Weidlich & Hanika 2014, "Hero wavelength
// spectral sampling", Eq. 8, with the balance heuristic over wavelengths and techniques).
//
// A path X sampled from wavelength index 0 contributes, for each wavelength i,
//     f_i(X) / ( N p_lambda(lambda_i)  mean_j sum_t p_t(X | lambda_j) )
// With beta_i = f_i / p(X | lambda_0) and the ratios p_t(X | lambda_j) / p(X | lambda_0) this is beta_i /
// (p_lambda,i sum_j sum_t ratio_t,j), so that a path needs to keep beta and the ratios only.
#pragma once

#include <type_traits>

#include "aureole/spectrum/wavelengths.h"
#include "aureole/spectrum/weight.h"

namespace aureole {

/// Returns the estimate, per wavelength, of light along a ray of the sensor that only one technique finds, as
/// Film::measure takes it.
inline Spectrum single_estimate(const Spectrum& light, const Wavelengths& w) {
  return light / (w.pdf * float(kWavelengths));
}

/// The effect of a null interface or a medium between two vertices: the transmittance and, at a vertex in a
/// medium, the scattering coefficient; and the pdfs with which a walk and a connection pass it, divided by
/// the hero's pdf of the walk.
struct Passage {
  Spectrum value;
  Spectrum flight{1.f}, connection{1.f};
};

/// The endpoint at which a path begins, which decides the order in which its weights are multiplied.
enum class PathStart { sensor, emitter };

/// Throughput of a path and the ratios of its pdfs per wavelength to the hero's own (`r_u` and `r_l` of
/// Miller, Georgiev & Jarosz 2019, "A null-scattering path integral formulation of light transport"). A ratio
/// that became zero stays zero.
template <class L, PathStart kStart>
struct BasicPathDensity {
  static constexpr PathStart kBegin = kStart;
  using Light = typename L::Light;
  using Weight = typename L::Weight;

  /// Throughput f / p_hero: the map of light that arrives at the last vertex; for a light path the light
  /// itself.
  std::conditional_t<kStart == PathStart::sensor, Weight, Light> beta{};
  Spectrum r_u{1.f};  ///< ratio for unidirectional sampling; r_u[0] is always 1
  /// Ratio as if light sampling had found the last vertex, without the pdf of choosing the light; 0 where
  /// light sampling cannot find it.
  Spectrum r_l{0.f};

  /// Extends the path by a sampled event of value `f` (cosine included) and pdf per wavelength, or mass of a
  /// `delta` lobe. Requires pdf[0] > 0.
  void extend(const Weight& f, const Spectrum& pdf, bool delta) {
    const float inverse = 1.f / pdf[0];
    compose(f.scaled(inverse));
    r_l = delta ? Spectrum(0.f) : r_u * inverse;
    r_u *= pdf * inverse;
  }
  /// Continues the path through a medium or a null interface.
  void pass(const Passage& p) {
    beta = L::scaled(beta, p.value);
    r_u *= p.flight;
    r_l *= p.connection;
  }
  /// Continues behind a null surface, which connections cross with the same probability: it cancels in the
  /// MIS weights.
  void attenuate(const Spectrum& transmittance) { beta = L::scaled(beta, transmittance); }
  /// Multiplies by an event whose probability is the same for all wavelengths (Russian roulette, choices of
  /// lights).
  void survive(float probability) { beta = L::scaled(beta, 1.f / probability); }

  bool has_light() const { return !L::is_black(beta); }
  /// Whether light sampling could have found the last vertex.
  bool has_light_ratio() const { return r_l[0] > 0; }

  /// Returns the estimate, per wavelength, of a path from the sensor that hits a light of that radiance and
  /// is found by no other technique.
  Spectrum contribution(const Spectrum& radiance, const Wavelengths& w) const {
    return seen(radiance) / (w.pdf * sum(r_u));
  }
  /// Returns the estimate of a path that hits a light, where light sampling would have found that light with
  /// the pdf `light_pdf`.
  Spectrum met(const Spectrum& radiance, float light_pdf, const Wavelengths& w) const {
    return seen(radiance) / (w.pdf * sum(r_u + r_l * light_pdf));
  }
  /// Returns the measured light, over the hero's pdf alone, of a light that emits that radiance towards the
  /// last vertex.
  Spectrum seen(const Spectrum& radiance) const { return L::measured(beta.of(L::emitted(radiance))); }

  /// Returns the estimate of a light path that is scattered with value `f` at its last vertex and connected
  /// to the sensor with `importance`.
  Spectrum reached(const Weight& f, float importance, const Wavelengths& w) const {
    return L::measured(f.of(beta)) * importance / (w.pdf * sum(r_u));
  }

  /// Returns a measure of the path's importance that does not depend on which wavelength is the hero.
  float hero_symmetric_throughput() const { return max_component(L::magnitude(beta)) / mean(r_u); }

private:
  void compose(const Weight& f) {
    if constexpr (kStart == PathStart::sensor)
      beta = beta.after(f);
    else
      beta = f.of(beta);
  }
};

using PathDensity = BasicPathDensity<Unpolarised, PathStart::sensor>;
using LightPathDensity = BasicPathDensity<Unpolarised, PathStart::emitter>;

}  // namespace aureole

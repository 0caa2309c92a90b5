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

#include "aureole/spectrum/wavelengths.h"
#include "aureole/spectrum/weight.h"

namespace aureole {

/// The estimate, per wavelength, of light that a ray of the sensor sees, as Film::measure takes it.
inline Spectrum single_estimate(const Spectrum& light, const Wavelengths& w) {
  return light / (w.pdf * float(kWavelengths));
}

/// The effect of passing a null surface or a medium: the transmitted fraction, and the probability densities,
/// divided by the hero's own, of passing it on a walk and on a connection.
template <class W>
struct BasicPassage {
  W value;
  Spectrum flight{1.f}, connection{1.f};
};

/// The end at which a path begins, which decides the order in which its weights are multiplied.
enum class PathStart { sensor, emitter };

/// Throughput of a path and the ratios of its densities per wavelength to the hero's own. A ratio that became
/// zero stays zero.
template <class W, PathStart kStart>
struct BasicPathDensity {
  static constexpr PathStart kBegin = kStart;

  W beta{};             ///< f / p_hero
  Spectrum ratio{1.f};  ///< of walking here; ratio[0] is always 1
  /// The ratio as if the last vertex had been found by light sampling, without the density of that choice; 0
  /// where light sampling cannot find it.
  Spectrum light_ratio{0.f};

  /// Extends the path by a sampled event of value `f` (cosine included) and density per wavelength, or mass
  /// of a `delta` lobe. Requires pdf[0] > 0.
  void extend(const W& f, const Spectrum& pdf, bool delta) {
    const float inverse = 1.f / pdf[0];
    compose(f.scaled(inverse));
    light_ratio = delta ? Spectrum(0.f) : ratio * inverse;
    ratio *= pdf * inverse;
  }
  /// Continues behind a null surface or through a medium.
  void pass(const BasicPassage<W>& p) {
    compose(p.value);
    ratio *= p.flight;
    light_ratio *= p.connection;
  }
  /// The same if only the value changes: connections pass the surface with the same probability, which
  /// therefore cancels in the MIS weights.
  void attenuate(const W& value) { compose(value); }
  /// Multiplies by an event whose probability is the same for all wavelengths (roulette, choices of lights).
  void survive(float probability) { beta = beta.scaled(1.f / probability); }

  /// Whether light sampling could have found the last vertex.
  bool has_light_ratio() const { return light_ratio[0] > 0; }

  /// The estimate, per wavelength, of a path found by one technique only: by walking to where it met `light`.
  Spectrum contribution(const Spectrum& light, const Wavelengths& w) const {
    return beta.of(light) / (w.pdf * sum(ratio));
  }
  /// The same of light that light sampling would have found with the density `light_density`.
  Spectrum met(const Spectrum& light, float light_density, const Wavelengths& w) const {
    return beta.of(light) / (w.pdf * sum(ratio + light_ratio * light_density));
  }
  /// The estimate of a connection: of `light` that is scattered with value `f` at the end of the path, where
  /// `own` and `other` are the densities (relative to the same measure) of this event given the path so far,
  /// by the technique used and by others. beta does not contain the event yet.
  Spectrum connected(const W& f, const Spectrum& light, const Spectrum& own, const Spectrum& other,
                     const Wavelengths& w) const {
    return beta.of(f.of(light)) / (w.pdf * sum(ratio * (own + other)));
  }

  /// The estimate of a path of light that is scattered with value `f` at its end and counts with
  /// `importance`.
  Spectrum reached(const W& f, float importance, const Wavelengths& w) const {
    return f.after(beta).of(Spectrum(importance)) / (w.pdf * sum(ratio));
  }

  /// A measure of the path's importance that does not depend on which of the wavelengths is the hero.
  float hero_symmetric_throughput() const { return beta.largest() / mean(ratio); }

private:
  void compose(const W& f) { beta = kStart == PathStart::sensor ? beta.after(f) : f.after(beta); }
};

using Passage = BasicPassage<Weight>;
using PathDensity = BasicPathDensity<Weight, PathStart::sensor>;
using LightPathDensity = BasicPathDensity<Weight, PathStart::emitter>;

}  // namespace aureole

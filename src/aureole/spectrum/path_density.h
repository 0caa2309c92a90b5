// SPDX-License-Identifier: Apache-2.0
// Spectral MIS, in one place: how the contributions of N wavelengths that were all carried by directions
// sampled from the hero are combined (Wilkie, Nawaz, Droske, Weidlich & Hanika 2014, "Hero wavelength
// spectral sampling", Eq. 8, with the balance heuristic over wavelengths and techniques).
//
// A path X sampled from wavelength index 0 contributes, for each wavelength i,
//     f_i(X) / ( N p_lambda(lambda_i)  mean_j sum_t p_t(X | lambda_j) )
// With beta_i = f_i / p(X | lambda_0) and r_j = p(X | lambda_j) / p(X | lambda_0) this is beta_i /
// (p_lambda,i sum_j r_j), so that a path needs to keep beta and r only.
#pragma once

#include "aureole/spectrum/wavelengths.h"

namespace aureole {

/// Throughput of a path and the ratios of its densities per wavelength to the hero's. A ratio that became
/// zero stays zero.
struct PathDensity {
  Weight beta{1.f};     ///< f / p_hero
  Spectrum ratio{1.f};  ///< p_j / p_hero; ratio[0] is always 1

  /// Extends the path by a sampled event of value `f` (cosine included) and density or mass `pdf` per
  /// wavelength. Requires pdf[0] > 0.
  void extend(const Spectrum& f, const Spectrum& pdf) {
    const float inverse = 1.f / pdf[0];
    beta *= f * inverse;
    ratio *= pdf * inverse;
  }
  /// Multiplies by an event whose probability is the same for all wavelengths (roulette, choices of lights).
  void survive(float probability) { beta *= 1.f / probability; }

  /// The estimate, per wavelength, of a path found by one technique only, times the integrand's last factor
  /// `f`.
  Spectrum contribution(const Spectrum& f, const Wavelengths& w) const {
    return beta * f / (w.pdf * sum(ratio));
  }
  /// The same where the last vertex could also have been found with the densities `other` (relative to the
  /// *same* measure): `own` and `other` are densities per wavelength of this last event given the path so
  /// far. beta does not contain the event yet.
  Spectrum contribution(const Spectrum& f, const Spectrum& own, const Spectrum& other,
                        const Wavelengths& w) const {
    return beta * f / (w.pdf * sum(ratio * (own + other)));
  }

  /// A measure of the path's importance that does not depend on which of the wavelengths is the hero.
  float hero_symmetric_throughput() const { return max_component(beta) / mean(ratio); }
};

}  // namespace aureole

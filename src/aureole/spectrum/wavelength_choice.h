// SPDX-License-Identifier: Apache-2.0
// The choice of p_lambda, the density of the wavelengths of paths, for a scene. May change: the candidates
// and the spectra they are judged by; every choice is unbiased.
#pragma once

#include <span>

#include "aureole/spectrum/wavelengths.h"

namespace aureole {

/// The density under which the channels of a picture differ least from one set of N wavelengths to the next.
/// The wavelengths of a set are equidistant in the CDF, so that a set integrates a spectrum the better, the
/// smoother its quotient by the density is: the product of response and light, the best density for single
/// wavelengths, is sharper than is good for N, unless the light consists of lines. So candidates between the
/// two are tried on the lights themselves and on their reflections from coloured surfaces.
///
/// `response`: magnitude of the film's response; `channels`: the (signed) responses of the picture's
/// channels; `lights`: spectra of the emitters' powers, in common units. All on one grid.
WavelengthDistribution choose_wavelengths(const SampledSpectrum& response,
                                          std::span<const SampledSpectrum> channels,
                                          std::span<const SampledSpectrum> lights);

/// Variance of the channels between the sets of N wavelengths for this light, over their squared means (both
/// summed over the channels).
double variance_between_sets(const WavelengthDistribution& distribution,
                             std::span<const SampledSpectrum> channels, const SampledSpectrum& light);

}  // namespace aureole

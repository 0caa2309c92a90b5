// SPDX-License-Identifier: Apache-2.0
// The choice of p_lambda, the pdf from which the wavelengths of paths are drawn, for a scene. The candidate
// densities and the spectra that judge them may change; every choice is unbiased.
#pragma once

#include <span>

#include "aureole/spectrum/wavelengths.h"

namespace aureole {

/// Returns the density for which the channels of a picture vary least from one set of N wavelengths to the
/// next. The wavelengths of a set are equidistant in the CDF. A set therefore integrates a spectrum more
/// accurately if the quotient of the spectrum by the density is smoother. The product of response and light,
/// which is the best density for single wavelengths, is too sharp for N > 1, unless the light consists of
/// lines. So mixtures of this product and smoother densities are tried on the lights themselves and on their
/// reflections from coloured surfaces.
///
/// `response`: magnitude of the film's response; `channels`: the (signed) responses of the picture's
/// channels; `lights`: power spectra of the emitters, in common units. All are on one grid.
WavelengthDistribution choose_wavelengths(const SampledSpectrum& response,
                                          std::span<const SampledSpectrum> channels,
                                          std::span<const SampledSpectrum> lights);

/// Returns the variance of the channels between the sets of N wavelengths for this light, divided by their
/// squared means (both summed over the channels).
double variance_between_sets(const WavelengthDistribution& distribution,
                             std::span<const SampledSpectrum> channels, const SampledSpectrum& light);

}  // namespace aureole

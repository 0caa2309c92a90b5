// SPDX-License-Identifier: Apache-2.0
// Photometry: light weighted by the sensitivity of the eye (CIE 018:2019, "The basis of physical photometry").
#pragma once

#include "aureole/spectrum/wavelengths.h"

namespace aureole {

/// Maximum luminous efficacies [lm/W] of photopic vision, V(lambda), and of scotopic vision, V'(lambda).
inline constexpr double kPhotopicEfficacy = 683.002, kScotopicEfficacy = 1700;

/// Photon energy times wavelength, h c [J m], and Avogadro's number [1/mol], exact in the SI.
inline constexpr double kPlanckTimesLight = 6.62607015e-34 * 299792458, kAvogadro = 6.02214076e23;

/// Returns the functions K(lambda) [lm/W] on a grid, whose product with a spectrum in W/nm has an integral in
/// lm: 683.002 V (CIE 1924, the y-bar of the CIE 1931 observer), and 1700 V' (CIE 1951).
SampledSpectrum photopic_efficacy(const SpectralGrid& grid);
SampledSpectrum scotopic_efficacy(const SpectralGrid& grid);
/// As `photopic_efficacy`, with V_M of Judd and Vos (CIE 86-1990), which corrects V at short wavelengths.
SampledSpectrum modified_photopic_efficacy(const SpectralGrid& grid);
/// The efficacy of mesopic vision whose adaptation has the coefficient m of CIE 191:2010, m = 1 photopic and m = 0 scotopic:
/// (m K + (1 - m) V'(555 nm) K')/(m + (1 - m) V'(555 nm)) by the efficacies K and K' of both, V'(555 nm) = 683/1699.
SampledSpectrum mesopic_efficacy(const SpectralGrid& grid, double m);

/// Returns the micromoles of photons for each joule, lambda / (h c N_A) [umol/J], on a grid.
SampledSpectrum photons_per_joule(const SpectralGrid& grid);

/// Whether a grid holds at least 99.9 % of the integral of V, so that photometric quantities are complete.
bool covers_photopic_vision(const SpectralGrid& grid);

}  // namespace aureole

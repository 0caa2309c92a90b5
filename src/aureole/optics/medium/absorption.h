// SPDX-License-Identifier: Apache-2.0
// Absorption in the terms of the IUPAC Compendium of Chemical Terminology: one law, T = exp(-sigma_a s)
// (Bouguer, Lambert, Beer), and the quantities by which several sciences state it. The "absorption
// coefficient" sigma_a is always Napierian and per metre here. "Absorbance" is Napierian, A = -ln T, or
// decadic, -lg T, the optical density.
#pragma once

#include <span>

namespace aureole::optics {

inline constexpr double kAvogadro = 6.02214076e23;  ///< Avogadro's constant [1/mol]

/// Returns the transmitted fraction over a `distance` (m), given sigma_a (1/m).
double transmittance(double absorption, double distance);
/// Returns the absorbed fraction 1 - T, without cancellation if it is small.
double absorptance(double absorption, double distance);

/// Returns -ln T. Throws std::domain_error for a transmittance outside (0, 1], as does `decadic_absorbance`.
double napierian_absorbance(double transmittance);
/// Returns -lg T, also called optical density.
double decadic_absorbance(double transmittance);
double transmittance_of_napierian(double absorbance);
double transmittance_of_decadic(double absorbance);

/// Returns sigma_a from a Napierian absorbance over a path of `distance` m; 1 m converts an absorbance per
/// length.
double absorption_of_napierian(double absorbance, double distance);
double absorption_of_decadic(double absorbance, double distance);

/// Returns sigma_a = 4 pi k/lambda from k of the index n + i k; lambda is in vacuum.
double absorption_of_index(double k, double lambda_nm);
/// Returns k from sigma_a.
double index_of_absorption(double absorption, double lambda_nm);

/// Returns sigma_a = ln 10 x 100 epsilon c from the molar (decadic) absorption coefficient epsilon in L/(mol
/// cm), as chemists tabulate it, and a concentration c in mol/L.
double absorption_of_molar(double molar, double concentration);
/// Returns the absorption cross section of a molecule, m^2, from the molar coefficient in L/(mol cm).
double cross_section_of_molar(double molar);
/// Returns sigma_a from a mass-specific coefficient (Napierian, m^2/kg) and a concentration in kg/m^3.
double absorption_of_mass(double specific, double concentration);
/// Returns sigma_a of particles from their number per m^3 and cross section in m^2.
double absorption_of_number(double cross_section, double number_density);

/// One substance of a mixture: a concentration, and the absorption coefficient per unit of it.
struct AbsorbingShare {
  double concentration, coefficient;
};
/// Returns sigma_a of a mixture: absorption coefficients add.
double mixture_absorption(std::span<const AbsorbingShare> shares);

}  // namespace aureole::optics

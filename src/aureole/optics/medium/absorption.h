// SPDX-License-Identifier: Apache-2.0
// Absorption by its names (IUPAC Compendium of Chemical Terminology): one law, T = exp(-sigma_a s) (Bouguer,
// Lambert, Beer), and what several sciences call its parts. "Absorption coefficient", sigma_a, is always
// Napierian and per metre here; "absorbance" is Napierian, A = -ln T, or decadic, -lg T, the optical density.
#pragma once

#include <span>

namespace aureole::optics {

inline constexpr double kAvogadro = 6.02214076e23;  ///< per mol

/// Fraction of light that passes `distance` (m), given sigma_a (1/m).
double transmittance(double absorption, double distance);
/// Fraction that is absorbed, 1 - T, without cancellation where it is small.
double absorptance(double absorption, double distance);

/// -ln T. Throws std::domain_error for a transmittance outside of (0, 1], like the next.
double napierian_absorbance(double transmittance);
/// -lg T, also called optical density.
double decadic_absorbance(double transmittance);
double transmittance_of_napierian(double absorbance);
double transmittance_of_decadic(double absorbance);

/// sigma_a from an absorbance over a path of `distance` m: also the specific (per length) Napierian
/// absorbance.
double absorption_of_napierian(double absorbance, double distance);
double absorption_of_decadic(double absorbance, double distance);

/// sigma_a from k of the index n + i k, 4 pi k/lambda; lambda in vacuum.
double absorption_of_index(double k, double lambda_nm);
/// k from sigma_a.
double index_of_absorption(double absorption, double lambda_nm);

/// sigma_a from the molar (decadic) absorption coefficient in L/(mol cm), as chemists tabulate it, and a
/// concentration in mol/L: ln 10 x 100 epsilon c.
double absorption_of_molar(double molar, double concentration);
/// Absorption cross section of a molecule, m^2, from the molar coefficient in L/(mol cm).
double cross_section_of_molar(double molar);
/// sigma_a from a mass-specific coefficient (Napierian, m^2/kg) and a concentration in kg/m^3.
double absorption_of_mass(double specific, double concentration);
/// sigma_a of particles by number per m^3 and cross section in m^2.
double absorption_of_number(double cross_section, double number_density);

/// One substance of a mixture: a concentration, and the absorption coefficient per unit of it.
struct AbsorbingShare {
  double concentration, coefficient;
};
/// sigma_a of a mixture: absorption coefficients add.
double mixture_absorption(std::span<const AbsorbingShare> shares);

}  // namespace aureole::optics

// SPDX-License-Identifier: Apache-2.0
// Clear media: pure liquids and gases, and dyes dissolved in them.
#pragma once

#include <string>
#include <vector>

#include "aureole/optics/medium/spectral_table.h"
#include "aureole/optics/particle/particle.h"

namespace aureole::optics {

/// A medium without particles: a liquid or gas that refracts, absorbs and, by its molecules, scatters. It can
/// host particles.
struct ClearMedium {
  SpectralFunction index;                 ///< real part of the index of refraction
  SpectralFunction absorption = nullptr;  ///< absorption coefficient sigma_a, 1/m; null: lossless
  SpectralFunction scattering = nullptr;  ///< scattering coefficient sigma_s by molecules, 1/m; null: 0
  /// Depolarisation factor of that scattering (`rayleigh_phase`); null: 0.
  SpectralFunction depolarization = nullptr;
  double density = 0;   ///< density [kg/m^3]; 0: unknown
  DataRange data = {};  ///< wavelengths over which the absorption was measured
};

/// Returns pure water at 20 C: index by Daimon & Masumura 2007, absorption by Pope & Fry 1997 and Smith &
/// Baker 1981 (380 to 800 nm, constant beyond), scattering by Morel 1974.
ClearMedium water();
/// Returns dry air at 15 C and 1013.25 hPa: Peck & Reeder 1972, Bodhaine et al. 1999; no absorption.
ClearMedium air();
/// Returns a vacuum, n = 1.
ClearMedium vacuum();

/// Returns the complex index of water, for droplets.
IndexFunction water_index();
/// Returns the range of the measured absorption of water.
DataRange water_range();

/// A dissolved substance that absorbs and does not scatter.
struct Dye {
  std::string name;
  SpectralFunction molar_absorptivity;  ///< decadic molar absorptivity, L/(mol cm)
  double concentration = 0;             ///< concentration [mol/L]
};

/// Dyes in a solvent: absorption coefficients add (Beer); the solvent's index, scattering and density are
/// unchanged. It is a `ClearMedium` with names of its dyes and can be the host of a `Suspension`.
class Solution {
public:
  /// Adds dyes to a solvent. Throws std::domain_error, with the name of the dye, for a negative concentration
  /// or a dye without a spectrum.
  Solution(ClearMedium solvent, std::vector<Dye> dyes);

  const ClearMedium& medium() const { return medium_; }
  const std::vector<Dye>& dyes() const { return dyes_; }
  /// Returns the absorption coefficient sigma_a, 1/m.
  double absorption(double lambda_nm) const { return medium_.absorption(lambda_nm); }
  double index(double lambda_nm) const { return medium_.index(lambda_nm); }

private:
  ClearMedium medium_;
  std::vector<Dye> dyes_;
};

/// Returns the molar absorptivity of riboflavin (vitamin B2) in water: PhotochemCAD's spectrum (Du et al.
/// 1998), 375 to 775 nm, scaled to 33000 L/(mol cm) at 266.5 nm (Koziol 1966) as by Frisvad, Christensen &
/// Jensen 2007. Its background, the mean above 540 nm, where riboflavin does not absorb, is subtracted.
SpectralFunction riboflavin_absorptivity();
inline constexpr double kRiboflavinMolarMass = 376.36;  ///< molar mass [g/mol]

}  // namespace aureole::optics

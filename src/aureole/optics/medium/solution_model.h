// SPDX-License-Identifier: Apache-2.0
// Clear media: pure liquids and gases, and dyes dissolved in them.
#pragma once

#include <string>
#include <vector>

#include "aureole/optics/particle/particle.h"

namespace aureole::optics {

/// The host medium of particles: a liquid or gas that refracts, absorbs and, by its molecules, scatters.
struct ClearMedium {
  SpectralFunction index;                 ///< real part
  SpectralFunction absorption = nullptr;  ///< sigma_a, 1/m; none: lossless
  SpectralFunction scattering = nullptr;  ///< sigma_s by molecules, 1/m; none: none
  SpectralFunction depolarization =
      nullptr;         ///< depolarisation factor of `rayleigh_phase` for that scattering; null: 0
  double density = 0;  ///< kg/m^3; 0: not known
};

/// Pure water at 20 C: Daimon & Masumura 2007 (index), Pope & Fry 1997 and Smith & Baker 1981 (absorption,
/// 380 to 800 nm, constant beyond), Morel 1974 (scattering).
ClearMedium water();
/// Dry air at 15 C and 1013.25 hPa: Peck & Reeder 1972, Bodhaine et al. 1999; no absorption.
ClearMedium air();
/// Nothing, n = 1.
ClearMedium vacuum();

/// The complex index of water, for droplets of it.
IndexFunction water_index();

/// A dissolved substance that absorbs and is too small to scatter.
struct Dye {
  std::string name;
  SpectralFunction molar_absorptivity;  ///< decadic, L/(mol cm)
  double concentration = 0;             ///< mol/L
};

/// Dyes in a solvent: absorption coefficients add (Beer), the solvent's index, scattering and density stay.
/// It is a `ClearMedium` with names, and what `Suspension` takes for a host.
class Solution {
public:
  /// Throws std::domain_error, with the name of the dye, for negative concentrations and dyes without a
  /// spectrum.
  Solution(ClearMedium solvent, std::vector<Dye> dyes);

  const ClearMedium& medium() const { return medium_; }
  const std::vector<Dye>& dyes() const { return dyes_; }
  /// sigma_a, 1/m.
  double absorption(double lambda_nm) const { return medium_.absorption(lambda_nm); }
  double index(double lambda_nm) const { return medium_.index(lambda_nm); }

private:
  ClearMedium medium_;
  std::vector<Dye> dyes_;
};

/// Riboflavin (vitamin B2) in water: PhotochemCAD's spectrum (Du et al. 1998), 375 to 775 nm, scaled to 33000
/// L/(mol cm) at 266.5 nm (Koziol 1966) as Frisvad, Christensen & Jensen 2007 do. Its background, the mean
/// above 540 nm, where riboflavin does not absorb, is subtracted.
SpectralFunction riboflavin_absorptivity();
inline constexpr double kRiboflavinMolarMass = 376.36;  ///< g/mol

}  // namespace aureole::optics

// SPDX-License-Identifier: Apache-2.0
// Media by name, each with its source.
#pragma once

#include <span>
#include <string_view>

#include "aureole/optics/medium/suspension_model.h"

namespace aureole::optics {

/// Milk by its contents of fat and protein in per cent of the mass (Frisvad, Christensen & Jensen, "Computing the
/// scattering properties of participating media using Lorenz-Mie theory", ACM Trans. Graph. 26 (2007) 60): fat
/// globules, log-normal by volume with a coefficient of variation of 0.6 and a mean radius that follows from the
/// fat content and the pressure of homogenisation; micelles of casein, 76 % of the protein, log-normal by volume in
/// r/(150 nm - r); riboflavin in the water between.
struct MilkRecipe {
  double fat = 3.0, protein = 3.4;  ///< % of the mass; skimmed 0.1, low-fat 1.5, whole 3.0 of fat
  double pressure = 0;              ///< of homogenisation, MPa; 0: not homogenised
  /// Micelles keep their distance: the scattering of casein falls by 12 % (the paper has none of it).
  bool hard_spheres = false;
};
/// Throws std::domain_error for contents that are negative or above 40 % (fat) and 20 % (protein), and pressures
/// outside of [0, 200] MPa.
Suspension milk(const MilkRecipe& recipe = {});
/// Mean radius (by volume) of the fat globules, m.
double milk_fat_radius(double fat, double pressure);

/// Water droplets of a cloud or a fog in air.
struct DropletRecipe {
  std::string_view name;
  double mode_radius;            ///< m
  double alpha, gamma;           ///< of `RadiusDistribution::modified_gamma`
  double number_density;         ///< per m^3
  std::string_view description;  ///< with its source
};
/// "c1", "c2", "c3" (clouds of Deirmendjian 1969), "heavy_advection_fog", "moderate_advection_fog",
/// "heavy_radiation_fog", "moderate_radiation_fog" (Shettle & Fenn 1979, AFGL-TR-79-0214).
std::span<const DropletRecipe> droplet_recipes();
/// Throws std::domain_error, with all names, for an unknown one, and for a density that is not positive.
/// `number_density` replaces that of the recipe.
Suspension droplets(std::string_view name, std::optional<double> number_density = std::nullopt);

/// Soot in air: log-normal, median radius 11.8 nm, geometric standard deviation 2.0, density 1000 kg/m^3, index
/// 1.75 + 0.44 i at 550 nm (Hess, Koepke & Schult, "Optical properties of aerosols and clouds: the software package
/// OPAC", Bull. Am. Meteorol. Soc. 79 (1998) 831; index of d'Almeida, Koepke & Shettle 1991). `mass` in kg/m^3.
Suspension smoke(double mass);

}  // namespace aureole::optics

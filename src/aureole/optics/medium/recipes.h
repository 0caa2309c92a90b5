// SPDX-License-Identifier: Apache-2.0
// Media by name, each with its source.
#pragma once

#include <span>
#include <string_view>

#include "aureole/optics/medium/suspension_model.h"

namespace aureole::optics {

/// Milk from its contents of fat and protein in per cent by mass (Frisvad, Christensen & Jensen, "Computing
/// the scattering properties of participating media using Lorenz-Mie theory", ACM Trans. Graph. 26 (2007)
/// 60). Fat globules are log-normal by volume with a coefficient of variation of 0.6; their mean radius
/// follows from the fat content and the homogenisation pressure. Casein micelles, 76 % of the protein, are
/// log-normal by volume in r/(150 nm - r). The water between contains riboflavin, and in proportion to the
/// protein an absorber that the paper lacks; without it skim milk would be whiter than whole milk. Its
/// spectrum is the absorption of measured milk beyond the known components (Jensen, Marschner, Levoy &
/// Hanrahan, "A practical model for subsurface light transport", SIGGRAPH 2001, figure 5). The extinction
/// coefficient of fat has no background.
struct MilkRecipe {
  double fat = 3.0,
         protein = 3.4;  ///< contents in per cent by mass; fat: skimmed 0.1, low-fat 1.5, whole 3.0
  double pressure = 0;   ///< homogenisation pressure [MPa]; 0: not homogenised
  /// Whether micelles are correlated as hard spheres, which reduces the scattering of casein by 12 %; the
  /// paper neglects it.
  bool hard_spheres = false;
};
/// Returns the suspension. Throws std::domain_error for contents that are negative or above 40 % (fat) or 20
/// % (protein), and for pressures outside [0, 200] MPa.
Suspension milk(const MilkRecipe& recipe = {});
/// Returns the mean radius (by volume) of the fat globules, m.
double milk_fat_radius(double fat, double pressure);

/// Water droplets of a cloud or a fog in air.
struct DropletRecipe {
  std::string_view name;
  double mode_radius;            ///< m
  double alpha, gamma;           ///< parameters of `RadiusDistribution::modified_gamma`
  double number_density;         ///< number of droplets per m^3
  std::string_view description;  ///< description, including the source
};
/// Returns the recipes "c1", "c2", "c3" (clouds of Deirmendjian 1969), "heavy_advection_fog",
/// "moderate_advection_fog", "heavy_radiation_fog", "moderate_radiation_fog" (Shettle & Fenn 1979,
/// AFGL-TR-79-0214).
std::span<const DropletRecipe> droplet_recipes();
/// Returns the suspension of a recipe; `number_density` replaces the recipe's value. Throws std::domain_error
/// for a density that is not positive and, with all names, for an unknown name.
Suspension droplets(std::string_view name, std::optional<double> number_density = std::nullopt);

/// Returns soot in air, `mass` in kg/m^3: log-normal, median radius 11.8 nm, geometric standard deviation
/// 2.0, density 1000 kg/m^3, index 1.75 + 0.44 i at 550 nm (Hess, Koepke & Schult, "Optical properties of
/// aerosols and clouds: the software package OPAC", Bull. Am. Meteorol. Soc. 79 (1998) 831; index of
/// d'Almeida, Koepke & Shettle 1991).
Suspension smoke(double mass);

}  // namespace aureole::optics

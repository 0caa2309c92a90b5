// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/medium/recipes.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <stdexcept>
#include <string>

#include "aureole/optics/medium/milk_components.h"
#include "aureole/optics/medium/spectral_table.h"

namespace aureole::optics {
namespace {

const MilkComponents kMilk[] = {
#include "aureole/optics/medium/data/milk.inc"
};

SpectralFunction milk_column(double MilkComponents::*column) {
  std::vector<SpectralPoint> points;
  for (const MilkComponents& row : kMilk) points.push_back({row.lambda_nm, row.*column});
  return spectral_table(points);
}

/// Returns the extinction coefficient of milk fat without its background. The measured curve has a peak by
/// carotenoids near 450 nm and 5e-6 at all wavelengths above 540 nm. That part would give whole milk 4 /m in red
/// light, where 1.1 /m (Jensen et al. 2001) and 1.5 /m (Narasimhan et al. 2006) were measured, no more than in
/// skim milk: it is not absorption by fat. As with riboflavin, the mean above 540 nm is subtracted.
SpectralFunction milk_fat_absorption_index() {
  double background = 0, count = 0;
  for (const MilkComponents& row : kMilk)
    if (row.lambda_nm > 540) background += row.fat_absorption_index, ++count;
  background /= count;
  std::vector<SpectralPoint> points;
  for (const MilkComponents& row : kMilk)
    points.push_back({row.lambda_nm,
                      row.lambda_nm > 540 ? 0 : 1e-6 * std::max(0.0, row.fat_absorption_index - background)});
  return spectral_table(points);
}

/// Returns the absorption coefficient in 1/m of the other solids of milk, at 3.4 % protein: what the milk of
/// Jensen, Marschner, Levoy & Hanrahan 2001 absorbs beyond water, riboflavin and fat. They measured 1.4, 2.5
/// and 14.2 /m in the red, green and blue channel of a camera for skim milk, and 1.1, 2.4 and 14 /m for whole
/// milk. The rest, 1.0, 2.3 and some 5 /m, falls exponentially with the wavelength. Milk of Narasimhan et al.
/// 2006 absorbs up to twice as much in green light, which shows how much milks and measurements differ.
double milk_solids_absorption(double lambda_nm) {
  // coefficient at 540 nm [1/m], that wavelength [nm], and the decay length [nm]
  constexpr double kAtGreen = 2.3, kGreen = 540, kDecay = 94;
  return kAtGreen * std::exp((kGreen - lambda_nm) / kDecay);
}

void require_range(double value, double low, double high, const char* name, const char* unit) {
  if (value >= low && value <= high) return;
  throw std::domain_error(std::string(name) + " must be in [" + std::to_string(low) + ", " +
                          std::to_string(high) + "] " + unit + ", got " + std::to_string(value));
}

/// Returns the radii of casein micelles as a density over r: the volume is log-normal in t = r/(150 nm - r),
/// with mean 43/(150 - 43) and standard deviation 0.23.
RadiusDistribution casein_radii() {
  constexpr double kLargest = 150e-9, kMean = 43e-9, kDeviation = 0.23;
  const double mean = kMean / (kLargest - kMean);
  const double s2 = std::log1p(kDeviation * kDeviation / (mean * mean)), mu = std::log(mean) - s2 / 2;
  const auto density = [=](double r) {
    const double t = r / (kLargest - r), z = std::log(t) - mu;
    return std::exp(-0.5 * z * z / s2) / t;
  };
  return RadiusDistribution::of_density(density, 1e-9, 0.999 * kLargest, SizeWeighting::volume);
}

constexpr DropletRecipe kDroplets[] = {
    {"c1", 4e-6, 6, 1, 100e6, "cumulus cloud C1: Deirmendjian 1969"},
    {"c2", 4e-6, 8, 3, 100e6, "cloud C2, which shows a corona: Deirmendjian 1969"},
    {"c3", 2e-6, 8, 3, 100e6, "mother-of-pearl cloud C3: Deirmendjian 1969"},
    {"heavy_advection_fog", 10e-6, 3, 1, 20e6, "heavy advection fog: Shettle & Fenn 1979"},
    {"moderate_advection_fog", 8e-6, 3, 1, 20e6, "moderate advection fog: Shettle & Fenn 1979"},
    {"heavy_radiation_fog", 4e-6, 6, 1, 100e6, "heavy radiation fog: Shettle & Fenn 1979"},
    {"moderate_radiation_fog", 2e-6, 6, 1, 200e6, "moderate radiation fog: Shettle & Fenn 1979"},
};

}  // namespace

std::span<const MilkComponents> milk_components() { return kMilk; }

double milk_fat_radius(double fat, double pressure) {
  // Fits of Frisvad, Christensen & Jensen 2007 to measured means, in um, at 0 and 50 MPa. Between them the
  // mean is a power of the pressure, and equals the mean of raw milk up to 1 MPa.
  const double raw =
      fat < 2 ? -0.2528033794 * fat * fat + 1.418606759 * fat : 1.456189142 * std::pow(fat, 0.36);
  if (!(pressure > 1)) return raw * 1e-6;
  const double fine = 7.481403922e-4 * fat * fat + 3.203991829e-2 * fat + 0.1162155667;
  return raw * std::pow(pressure, -std::log10(raw / fine) / std::log10(50.0)) * 1e-6;
}

Suspension milk(const MilkRecipe& recipe) {
  require_range(recipe.fat, 0, 40, "fat content of milk", "% of the mass");
  require_range(recipe.protein, 0, 20, "protein content of milk", "% of the mass");
  require_range(recipe.pressure, 0, 200, "pressure of homogenisation", "MPa");
  constexpr double kFatDensity = 915, kCaseinDensity = 1110, kMilkDensity = 1030;  // densities [kg/m^3]
  constexpr double kVariation = 0.6, kCaseinInProtein = 0.76;
  // Concentration of riboflavin: 0.17 mg in 100 g (Fox & McSweeney 1998), converted to mol/L.
  const double riboflavin = 0.17e-3 / kRiboflavinMolarMass / 0.1 * kMilkDensity * 1e-3;
  const ClearMedium pure = water();
  ClearMedium solvent = pure;
  const DataRange range{std::begin(kMilk)->lambda_nm, std::rbegin(kMilk)->lambda_nm};
  solvent.data = range;
  solvent.absorption = [range, water = pure.absorption, part = recipe.protein / 3.4](double lambda_nm) {
    const double nm = std::clamp(lambda_nm, range.min_nm, range.max_nm);
    return water(lambda_nm) + part * milk_solids_absorption(nm);
  };
  solvent.index = milk_column(&MilkComponents::water_index);
  const Solution host(solvent, {{"riboflavin", riboflavin_absorptivity(), riboflavin}});

  std::vector<Ingredient> ingredients;
  if (recipe.fat > 0) {
    const auto n = milk_column(&MilkComponents::fat_index);
    const auto k = milk_fat_absorption_index();
    // The mean is interpreted as the volume-to-surface mean, as in the authors' program.
    const double mean = milk_fat_radius(recipe.fat, recipe.pressure) / (1 + kVariation * kVariation);
    ingredients.push_back(
        {.name = "milk fat",
         .particles =
             sphere_kind([=](double lambda_nm) { return std::complex<double>(n(lambda_nm), k(lambda_nm)); }),
         .radii = RadiusDistribution::log_normal_of_mean(mean, kVariation, SizeWeighting::volume),
         .amount = {Amount::Kind::volume, recipe.fat / 100 * kMilkDensity / kFatDensity},
         .density = kFatDensity,
         .data = range});
  }
  if (recipe.protein > 0)
    ingredients.push_back({.name = "casein",
                           .particles = sphere_kind([](double) { return std::complex<double>(1.503); }),
                           .radii = casein_radii(),
                           .amount = {Amount::Kind::volume, kCaseinInProtein * recipe.protein / 100 *
                                                                kMilkDensity / kCaseinDensity},
                           .density = kCaseinDensity,
                           .hard_spheres = recipe.hard_spheres});
  return Suspension(host.medium(), std::move(ingredients));
}

std::span<const DropletRecipe> droplet_recipes() { return kDroplets; }

Suspension droplets(std::string_view name, std::optional<double> number_density) {
  const auto recipe =
      std::find_if(std::begin(kDroplets), std::end(kDroplets), [&](auto& r) { return r.name == name; });
  if (recipe == std::end(kDroplets)) {
    std::string known;
    for (const DropletRecipe& r : kDroplets) known += (known.empty() ? "" : ", ") + std::string(r.name);
    throw std::domain_error("no droplets are named \"" + std::string(name) + "\"; known are " + known);
  }
  const double number = number_density.value_or(recipe->number_density);
  if (!(number > 0 && std::isfinite(number)))
    throw std::domain_error("number density of droplets must be positive, got " + std::to_string(number) +
                            " per m^3");
  return Suspension(
      air(), {{.name = "water droplets",
               .particles = sphere_kind(water_index()),
               .radii = RadiusDistribution::modified_gamma(recipe->mode_radius, recipe->alpha, recipe->gamma),
               .amount = {Amount::Kind::number, number},
               .density = 998.2,
               .data = water_range()}});
}

Suspension smoke(double mass) {
  if (!(mass > 0 && std::isfinite(mass)))
    throw std::domain_error("mass of soot must be positive, got " + std::to_string(mass) + " kg/m^3");
  constexpr double kDensity = 1000;
  constexpr SpectralPoint kAbsorption[] = {{400, 0.46}, {488, 0.45}, {515, 0.45},
                                           {550, 0.44}, {633, 0.43}, {860, 0.43}};
  const auto k = spectral_table(kAbsorption);
  return Suspension(
      air(),
      {{.name = "soot",
        .particles = sphere_kind([=](double lambda_nm) { return std::complex<double>(1.75, k(lambda_nm)); }),
        .radii = RadiusDistribution::log_normal(11.8e-9, std::log(2.0)),
        .amount = {Amount::Kind::volume, mass / kDensity},
        .density = kDensity,
        .data = {std::begin(kAbsorption)->lambda_nm, std::rbegin(kAbsorption)->lambda_nm}}});
}

}  // namespace aureole::optics

// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/medium/solution_model.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <stdexcept>

#include "aureole/optics/medium/absorption.h"
#include "aureole/optics/medium/milk_components.h"
#include "aureole/optics/medium/spectral_table.h"
#include "aureole/optics/particle/rayleigh_scattering.h"

namespace aureole::optics {
namespace {

const SpectralPoint kWaterAbsorption[] = {
#include "aureole/optics/medium/data/water_absorption.inc"
};

/// Returns the real index of water at 20 C, 182 to 1129 nm (M. Daimon and A. Masumura, Appl. Opt. 46 (2007)
/// 3811, table 3).
double water_real_index(double lambda_nm) {
  constexpr double kTerms[4][2] = {{5.684027565e-1, 5.101829712e-3},
                                   {1.726177391e-1, 1.821153936e-2},
                                   {2.086189578e-2, 2.620722293e-2},
                                   {1.130748688e-1, 1.069792721e1}};
  const double l = std::clamp(lambda_nm, 182.0, 1129.0) * 1e-3, l2 = l * l;
  double n2 = 1;
  for (const auto& t : kTerms) n2 += t[0] * l2 / (l2 - t[1]);
  return std::sqrt(n2);
}

}  // namespace

ClearMedium water() {
  return {.index = water_real_index,
          .absorption = spectral_table(kWaterAbsorption),
          .scattering = water_scattering,
          .depolarization = spectral_constant(kWaterDepolarization),
          .density = 998.2,
          .data = water_range()};
}

ClearMedium air() {
  return {.index = [](double lambda_nm) { return 1 + air_refractivity(lambda_nm); },
          .absorption = nullptr,
          .scattering = [](double lambda_nm) { return kAirMolecules * air_cross_section(lambda_nm); },
          .depolarization = air_depolarization,
          .density = 1.225};
}

ClearMedium vacuum() { return {.index = spectral_constant(1)}; }

DataRange water_range() {
  return {std::begin(kWaterAbsorption)->lambda_nm, std::rbegin(kWaterAbsorption)->lambda_nm};
}

IndexFunction water_index() {
  return [absorption = spectral_table(kWaterAbsorption)](double lambda_nm) {
    return std::complex<double>(water_real_index(lambda_nm),
                                index_of_absorption(absorption(lambda_nm), lambda_nm));
  };
}

Solution::Solution(ClearMedium solvent, std::vector<Dye> dyes)
    : medium_(std::move(solvent)), dyes_(std::move(dyes)) {
  if (!medium_.index) throw std::domain_error("a solvent needs a refractive index");
  for (const Dye& dye : dyes_) {
    if (!(dye.concentration >= 0 && std::isfinite(dye.concentration)))
      throw std::domain_error("concentration of " + dye.name + " must not be negative, got " +
                              std::to_string(dye.concentration) + " mol/L");
    if (!dye.molar_absorptivity) throw std::domain_error("the dye " + dye.name + " has no absorptivity");
  }
  medium_.absorption = [solvent = medium_.absorption, dyes = dyes_](double lambda_nm) {
    double sum = solvent ? solvent(lambda_nm) : 0;
    for (const Dye& dye : dyes)
      sum += absorption_of_molar(dye.molar_absorptivity(lambda_nm), dye.concentration);
    return sum;
  };
}

SpectralFunction riboflavin_absorptivity() {
  double background = 0, count = 0;
  for (const MilkComponents& row : milk_components())
    if (row.lambda_nm > 540) background += row.riboflavin_absorbance, ++count;
  background /= count;
  constexpr double kAt266 = 0.25654;  // absorbance of the same solution at 266.5 nm
  const double scale = 33000 / (kAt266 - background);
  std::vector<SpectralPoint> points;
  for (const MilkComponents& row : milk_components())
    points.push_back({row.lambda_nm, row.lambda_nm > 540
                                         ? 0
                                         : scale * std::max(0.0, row.riboflavin_absorbance - background)});
  return spectral_table(points);
}

}  // namespace aureole::optics

// SPDX-License-Identifier: Apache-2.0
// Paints and their mixtures over wavelengths.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "aureole/pigment/kubelka_munk_layer.h"
#include "aureole/pigment/saunderson.h"

namespace aureole::pigment {

/// One paint (a pigment in its binder, as it comes out of the tube) of a palette: K and S where it is the
/// whole of a layer, at the palette's wavelengths.
struct Pigment {
  std::string name;
  std::vector<double> k, s;
  std::vector<double> k_error = {}, s_error = {};  ///< standard errors; empty: not known
  double density = 0;  ///< mass per volume in any one unit; 0: not known. Recipes by volume need it.
};

/// Paints that can be mixed with one another: same wavelengths, same unit, same binder.
struct Palette {
  std::vector<double> nm;  ///< increasing
  std::vector<Pigment> pigments;
  bool relative = true;  ///< K and S are relative to S of the white; else per metre
  Surface surface = {};  ///< between the binder and air, as seen by the instrument that measured

  std::optional<std::size_t> find(std::string_view name) const;
  std::vector<std::string> names() const;
};

/// Throws std::domain_error, with the name of the pigment and the wavelength, where the palette has no
/// wavelengths or no pigments, the former do not increase, a number is missing or not finite, or a name
/// twice.
void check(const Palette& palette);

/// Sets negative K and S to zero, which no layer has but fits of noisy or inconsistent measurements can.
/// Returns how many there were.
int clamp_negative(Palette& palette);

/// Parts, one for each pigment of a palette, divided by their sum. Throws std::domain_error where one is
/// negative or not finite, or all are zero.
std::vector<double> fractions_of_parts(std::span<const double> parts);

/// Mass fractions from parts by volume, by the densities of the pigments. Throws std::domain_error that names
/// a pigment which is used and has no density.
std::vector<double> fractions_of_volumes(const Palette& palette, std::span<const double> volumes);

/// K and S of a layer at the wavelengths of a palette.
using Paint = std::vector<Coefficients>;

/// Two-constant mixture by mass fractions that sum to one: K = sum c_i K_i, S = sum c_i S_i (D. R. Duncan,
/// Proc. Phys. Soc. 52, 1940).
Paint mix(const Palette& palette, std::span<const double> fractions);

/// Single-constant theory, for little colorant in much white or in a textile whose scattering does not
/// change: K/S = (K/S)_base + sum c_i (K/S)_i. This is the colorant's K/S per share from one tint.
double unit_k_over_s(double tint_k_over_s, double base_k_over_s, double share);
/// One colorant's share and its unit K/S.
struct Colorant {
  double share = 0, unit_k_over_s = 0;
};
double single_constant_k_over_s(double base_k_over_s, std::span<const Colorant> colorants);

/// The substrate below a layer: its inner reflectance at each wavelength, or one for all.
using Substrate = std::span<const double>;

/// Outer reflectance of a layer of paint. `thickness` is in the inverse unit of K and S and may be infinite:
/// then the substrate does not matter and may be empty.
std::vector<double> paint_reflectance(const Paint& paint, double thickness, Substrate substrate,
                                      const Surface& surface);

}  // namespace aureole::pigment

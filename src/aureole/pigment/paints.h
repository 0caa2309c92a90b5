// SPDX-License-Identifier: Apache-2.0
// Paints and their mixtures as functions of the wavelength.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "aureole/pigment/kubelka_munk_layer.h"
#include "aureole/pigment/saunderson.h"

namespace aureole::pigment {

/// One paint (a pigment in its binder, as sold) of a palette: K and S of the unmixed paint, at the palette's
/// wavelengths.
struct Pigment {
  std::string name;
  std::vector<double> k, s;
  std::vector<double> k_error = {}, s_error = {};  ///< standard errors of K and S; empty: unknown
  double density = 0;  ///< mass per volume, in one unit for all paints; 0: unknown. Recipes by volume need
                       ///< it, and mixtures in a palette that mixes by volume.
  /// mean cosine of scattering of this paint, where streams were fitted with one for each
  std::optional<double> g = {};
};

/// The theory by streams (film_theory.h) that K = 2 sigma_a and S = 3/4 sigma_s (1 - g) of a palette belong to.
struct PaletteStreams {
  double index = 1.5;  ///< index of refraction of the binder, relative to air
  double g = 0.8;      ///< mean cosine of scattering in paints that have none of their own
  Geometry geometry = Geometry::diffuse_8;
  Specular specular = Specular::excluded;
  bool operator==(const PaletteStreams&) const = default;
};

/// Paints that can be mixed with each other: common wavelengths, unit and binder.
struct Palette {
  std::vector<double> nm;  ///< wavelengths [nm], increasing
  std::vector<Pigment> pigments;
  bool relative = true;  ///< K and S have no unit of length: they are relative to the white's S, or per film.
                         ///< Otherwise they are per metre.
  bool per_film = false;  ///< with `relative`: K and S are per thickness of the films that were measured, and
                          ///< thickness counts in films
  bool by_volume = false;  ///< K and S add up by volume rather than by mass; all pigments have a density
  Surface surface = {};    ///< interface between the binder and air, for the instrument of the measurements
  /// settings if K and S were fitted by streams; otherwise they were fitted by two fluxes
  std::optional<PaletteStreams> streams = {};

  std::optional<std::size_t> find(std::string_view name) const;
  std::vector<std::string> names() const;
};

/// Returns the unit of K and S as files name it: "1/m", "relative" or "film".
std::string_view unit_name(const Palette& palette);

/// A note for predictions by two fluxes from K and S that were fitted by streams; empty for other palettes.
std::string theory_note(const Palette& palette);

/// Throws std::domain_error, with the name of the pigment and the wavelength, if the palette has no
/// wavelengths or no pigments, if wavelengths do not increase, if a number is missing or not finite, if a name
/// occurs twice, or if a density is missing in a palette that mixes by volume.
void check(const Palette& palette);

/// Sets negative K and S to zero and returns their number. They are unphysical but occur in fits of noisy or
/// inconsistent measurements.
int clamp_negative(Palette& palette);

/// Divides parts, one per pigment of a palette, by their sum. Throws std::domain_error if one is negative or
/// not finite, or if all are zero.
std::vector<double> fractions_of_parts(std::span<const double> parts);

/// Converts parts by volume to mass fractions with the densities of the pigments. Throws std::domain_error
/// that names a used pigment without density.
std::vector<double> fractions_of_volumes(const Palette& palette, std::span<const double> volumes);

/// The weights by which K and S of a palette add up, for mass fractions that sum to one: the mass fractions,
/// or volume fractions if the palette mixes by volume.
std::vector<double> mixing_fractions(const Palette& palette, std::span<const double> fractions);

/// K and S of a paint at the wavelengths of a palette.
using Paint = std::vector<Coefficients>;

/// Two-constant mixture by mass fractions that sum to one: K = sum c_i K_i, S = sum c_i S_i (D. R. Duncan,
/// Proc. Phys. Soc. 52, 1940), where c_i are `mixing_fractions`.
Paint mix(const Palette& palette, std::span<const double> fractions);

/// Single-constant theory, for little colorant in much white or in a textile whose scattering is constant:
/// K/S = (K/S)_base + sum c_i (K/S)_i. Returns the colorant's K/S per unit of `share`, from one tint.
double unit_k_over_s(double tint_k_over_s, double base_k_over_s, double share);
/// A colorant's fraction and its unit K/S.
struct Colorant {
  double share = 0, unit_k_over_s = 0;
};
double single_constant_k_over_s(double base_k_over_s, std::span<const Colorant> colorants);

/// The substrate below a layer: its inner reflectance at each wavelength, or one value for all.
using Substrate = std::span<const double>;

/// Outer reflectance of a layer of paint. `thickness` is in the inverse unit of K and S. It may be infinite;
/// the substrate is then ignored and may be empty.
std::vector<double> paint_reflectance(const Paint& paint, double thickness, Substrate substrate,
                                      const Surface& surface);

}  // namespace aureole::pigment

// SPDX-License-Identifier: Apache-2.0
// Complex refractive indices of named materials: dispersion formulas, constants and tables from the
// literature.
#pragma once

#include <complex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace aureole {

namespace detail {
struct DispersionFormula;
struct MetalRecord;
}  // namespace detail

/// A complex refractive index n + i k, with k >= 0 for absorption, as a function of the vacuum wavelength.
/// (Most dielectric measurements are relative to air and use the wavelength in air. The difference, 3e-4, is
/// too small to see in a picture.)
class RefractiveIndex {
public:
  /// Makes an index that does not depend on the wavelength.
  explicit RefractiveIndex(std::complex<double> constant) : constant_(constant) {}
  explicit RefractiveIndex(const detail::DispersionFormula& formula) : formula_(&formula) {}
  explicit RefractiveIndex(const detail::MetalRecord& table) : table_(&table) {}

  /// Returns n + i k at a vacuum wavelength in nm. The wavelength is first clamped to [min_nm(), max_nm()],
  /// because a dispersion formula is wrong, and can be singular, outside its range. Tables are interpolated
  /// linearly in n and in k. Never throws.
  std::complex<double> at(double lambda_nm) const;

  /// Whether the index depends on the wavelength; a constant index refracts all wavelengths into one
  /// direction.
  bool is_dispersive() const { return formula_ != nullptr || table_ != nullptr; }

  /// The range in nm over which the data are valid; [0, infinity] for a constant.
  double min_nm() const;
  double max_nm() const;

  /// Returns the publication or data set of the numbers.
  std::string_view source() const;

private:
  std::complex<double> constant_{1.0, 0.0};
  const detail::DispersionFormula* formula_ = nullptr;
  const detail::MetalRecord* table_ = nullptr;
};

/// Returns the index of the material `name`, ignoring case, or nothing if it is unknown. Names: Mitsuba 3's
/// scalar indices ("bk7", "water", "fused quartz", ...), further dielectrics with dispersion ("sapphire",
/// "polystyrene", "sf11", ...) and Mitsuba 3's conductors ("Au", "Cu_palik", ...; its "none", a perfect
/// mirror, is not an index). With `dispersion`, a dispersion formula is used where there is one. Without it,
/// a dielectric has a constant index: Mitsuba's value for Mitsuba's names, else the formula at 589.3 nm
/// (sodium D). Metals are always tables. Mitsuba's "bk7" is 1.5046, while the actual glass has 1.5167.
std::optional<RefractiveIndex> find_refractive_index(std::string_view name, bool dispersion = true);

/// All names including aliases, each once, in a fixed order: constants, dispersion formulas, metals.
std::vector<std::string> refractive_index_names();

}  // namespace aureole

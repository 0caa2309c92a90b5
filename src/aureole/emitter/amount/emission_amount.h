// SPDX-License-Identifier: Apache-2.0
// The strength of an emitter, stated with a unit: "800 lm", "60 W", "1200 cd", "500 lx", "3000 cd/m^2".
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "aureole/plugin/properties.h"
#include "aureole/plugin/registry.h"
#include "aureole/texture/texture.h"

namespace aureole {

/// An amount in SI units.
struct EmissionAmount {
  enum class Quantity {
    flux,        ///< in lm or W
    intensity,   ///< in cd or W/sr
    irradiance,  ///< in lx or W/m^2
    radiance     ///< in cd/m^2 or W/(m^2 sr)
  } quantity = Quantity::flux;
  bool is_photometric = false;
  double value = 0;
};

/// Parses a number with a unit: W, mW, kW, lm, klm; W/sr, cd, kcd; W/m^2, lx, klx, fc; W/(m^2 sr), cd/m^2, nit, kcd/m^2.
/// Throws Error that lists them. The number must be positive and finite.
EmissionAmount parse_emission_amount(std::string_view text);

/// For each quantity, the value of an emitter's own spectral parameter (a radiance, an intensity, ...) that
/// corresponds to one unit of the amount, with lengths in metres; 0: the emitter has no such quantity.
struct AmountFactors {
  double flux = 0, intensity = 0, irradiance = 0, radiance = 0;
};

/// Factor (1 m / scene unit)^2 of intensities: they are divided by squares of distances in scene units, so
/// that the factor makes irradiances per m^2.
double per_square_unit(const Properties& properties);

/// The rows of the parameters `amount`, `efficacy` and `color_temperature` of an emitter; `units` lists the
/// units that it accepts, and `meaning` names the quantity.
std::vector<ParameterDoc> with_amount_parameters(std::vector<ParameterDoc> rows, const std::string& units,
                                                 const std::string& meaning);

/// The emission of an emitter: the spectrum or texture `name`, or a black body by `color_temperature`, scaled to
/// `amount` where that is given. Emission without an amount keeps its values.
class Emission {
public:
  Emission(const Properties& properties, std::string_view name);

  const TexturePtr& texture() const { return texture_; }
  const std::optional<EmissionAmount>& amount() const { return amount_; }

  /// The factor by which the texture is multiplied so that the amount holds; 1 without an amount. `average` is the mean
  /// spectrum to which `factors` refer. Throws Error for an amount of a quantity that the emitter does not have.
  double scale(const AmountFactors& factors, const SampledSpectrum& average) const;
  /// Returns the texture multiplied by `scale`.
  TexturePtr scaled(const AmountFactors& factors) const;

private:
  const Properties& properties_;
  std::string name_;
  TexturePtr texture_;
  std::optional<EmissionAmount> amount_;
};

}  // namespace aureole

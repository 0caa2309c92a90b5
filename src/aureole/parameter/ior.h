// SPDX-License-Identifier: Apache-2.0
// Indices of refraction (IOR) as parameters: a number or the name of a material.
#pragma once

#include <string>
#include <string_view>

#include "aureole/plugin/properties.h"
#include "aureole/spectrum/wavelengths.h"

namespace aureole {

class RefractiveIndex;

/// Checks that the index of `material` is tabulated at all wavelengths of the sensor. Outside the table the
/// index is constant: a note says so, or an error located at `name` if the sensor covers more than the
/// visible range.
void check_index_range(const Properties& properties, std::string_view name, const std::string& material,
                       const RefractiveIndex& index);

/// A refractive index given as a number or a material's name, per wavelength of the path.
class Ior {
public:
  /// Reads `name` ("bk7", 1.5, ...); a name with dispersion data disperses. Errors are located and suggest
  /// names.
  static Ior from(const Properties& properties, std::string_view name, const std::string& fallback);
  Spectrum eval(const Wavelengths& w) const { return dispersive_ ? table_.eval(w) : Spectrum(constant_); }
  bool is_dispersive() const { return dispersive_; }
  /// Returns the index at the sodium D line (589.3 nm), or the constant.
  float at_sodium_d() const { return constant_; }

private:
  bool dispersive_ = false;
  float constant_ = 1;
  SampledSpectrum table_;
};

}  // namespace aureole

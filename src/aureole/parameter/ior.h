// SPDX-License-Identifier: Apache-2.0
// Indices of refraction as parameters give them: a number or the name of a material.
#pragma once

#include <string>
#include <string_view>

#include "aureole/plugin/properties.h"
#include "aureole/spectrum/wavelengths.h"

namespace aureole {

class RefractiveIndex;

/// Checks that the index of `material` is known at all wavelengths that the sensor sees. Where it is not: an
/// error, located at `name`, if the sensor sees more than the visible range, else a note; the index continues
/// with its value at the end.
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
  /// The index at the sodium D line (589.3 nm) or the constant.
  float at_sodium_d() const { return constant_; }

private:
  bool dispersive_ = false;
  float constant_ = 1;
  SampledSpectrum table_;
};

}  // namespace aureole

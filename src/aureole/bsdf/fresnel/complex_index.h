// SPDX-License-Identifier: Apache-2.0
// Reads the complex index of refraction of a particle from parameters.
#pragma once

#include <complex>
#include <functional>
#include <string>
#include <string_view>

#include "aureole/plugin/properties.h"

namespace aureole {

/// Returns n + i k as a function of the wavelength in nm, read from `name`: a number, the name of a
/// dielectric, or the name of a metal. Dielectrics take k from the spectrum `k_name`, which a plug-in
/// documents besides; metals have their own. Errors are located and suggest names.
std::function<std::complex<double>(double)> read_complex_index(const Properties& properties,
                                                               std::string_view name,
                                                               const std::string& fallback,
                                                               std::string_view k_name = "k");

}  // namespace aureole

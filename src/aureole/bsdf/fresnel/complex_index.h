// SPDX-License-Identifier: Apache-2.0
// The complex refractive index of a small body, as parameters give it.
#pragma once

#include <complex>
#include <functional>
#include <string>
#include <string_view>

#include "aureole/plugin/properties.h"

namespace aureole {

/// n + i k as a function of the wavelength in nm, from `name`: a number, the name of a dielectric, or that of
/// a metal. Dielectrics take their absorption from the parameter `k_name`, a spectrum, which a plug-in documents
/// beside it; metals have their own. Errors are located and suggest names.
std::function<std::complex<double>(double)> read_complex_index(const Properties& properties,
                                                               std::string_view name,
                                                               const std::string& fallback,
                                                               std::string_view k_name = "k");

}  // namespace aureole

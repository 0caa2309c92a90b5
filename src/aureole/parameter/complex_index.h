// SPDX-License-Identifier: Apache-2.0
// Reads the complex index of refraction of a particle from parameters.
#pragma once

#include <complex>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "aureole/plugin/properties.h"
#include "aureole/spectrum/wavelengths.h"

namespace aureole {

/// n + i k as a function of the wavelength in nm, from `name`: a number, the name of a dielectric, or that of
/// a metal. Dielectrics take their absorption from `k`, which the caller has read from the parameter `k_name`
/// (`get_optional_spectrum`), 0 where there is none; metals have their own. Errors are located and suggest names.
std::function<std::complex<double>(double)> read_complex_index(const Properties& properties,
                                                               std::string_view name,
                                                               const std::string& fallback,
                                                               const std::optional<SampledSpectrum>& k,
                                                               std::string_view k_name = "k");

}  // namespace aureole

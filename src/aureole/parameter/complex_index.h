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

/// Returns n + i k as a function of the wavelength in nm. `name` is a number, a dielectric or a metal. Metals
/// have their own absorption; otherwise it is `k`, which the caller has read from the parameter `k_name`
/// (`get_optional_spectrum`), or 0. Errors are located and suggest names.
std::function<std::complex<double>(double)> read_complex_index(const Properties& properties,
                                                               std::string_view name,
                                                               const std::string& fallback,
                                                               const std::optional<SampledSpectrum>& k,
                                                               std::string_view k_name = "k");

}  // namespace aureole

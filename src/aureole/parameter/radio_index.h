// SPDX-License-Identifier: Apache-2.0
// Building materials at radio frequencies, by names such as "itu_concrete".
#pragma once

#include <complex>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "aureole/plugin/properties.h"

namespace aureole {

/// Returns n + i k as a function of the wavelength in nm: the root of the permittivity of Recommendation
/// ITU-R P.2040-3 (optics/interface/radio_material.h); empty if `material` does not begin with "itu_". Throws
/// an error located at the parameter `name` for an unknown material, and if the sensor includes frequencies
/// outside the material's range.
std::optional<std::function<std::complex<double>(double)>> radio_index(const Properties& properties,
                                                                       std::string_view name,
                                                                       const std::string& material);

/// Returns the names of the building materials, with the prefix "itu_".
std::vector<std::string> radio_material_names();

}  // namespace aureole

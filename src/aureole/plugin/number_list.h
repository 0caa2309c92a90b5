// SPDX-License-Identifier: Apache-2.0
// Lists of numbers, written in a scene file as one string.
#pragma once

#include <string_view>
#include <vector>

namespace aureole {

class Properties;

/// Returns the numbers in a string such as "0.1, -0.2 0.3", the parameter `name`. A word that is not a finite
/// number is an Error located at the parameter.
std::vector<double> get_number_list(const Properties& properties, std::string_view name);

/// Returns at least two vacuum wavelengths [nm] of a string such as "400, 450nm 0.5um" or "29GHz, 28GHz".
/// Numbers without a unit are in nm. Errors are located at the parameter.
std::vector<double> get_wavelength_list(const Properties& properties, std::string_view name);

/// Returns one positive vacuum wavelength [nm], given as a number or as a string.
double get_wavelength(const Properties& properties, std::string_view name);

}  // namespace aureole

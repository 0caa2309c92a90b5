// SPDX-License-Identifier: Apache-2.0
// Lists of numbers as scene files have them in one string.
#pragma once

#include <string_view>
#include <vector>

namespace aureole {

class Properties;

/// The numbers in a string such as "0.1, -0.2 0.3" under `name`. What is no finite number is an error located
/// there.
std::vector<double> get_number_list(const Properties& properties, std::string_view name);

/// The vacuum wavelengths [nm] in a string such as "400, 450nm 0.5um" or "29GHz, 28GHz", at least two; numbers
/// without a unit are in nm. Errors are located there.
std::vector<double> get_wavelength_list(const Properties& properties, std::string_view name);

/// One of them [nm], positive, given as a number or as a string.
double get_wavelength(const Properties& properties, std::string_view name);

}  // namespace aureole

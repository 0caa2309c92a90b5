// SPDX-License-Identifier: Apache-2.0
// Numbers with units in text: "5um", "0.3 mm", "589nm", "10GHz".
#pragma once

#include <string_view>

namespace aureole {

/// A number without a unit, the whole of `text`; throws Error. Accepts what strtod accepts in the C locale,
/// except hex and "inf"/"nan".
double parse_number(std::string_view text);

/// A length in metres from a number with one of the units nm, um (or µm), mm, cm, m, km. Throws Error where
/// the unit is missing or unknown, naming the valid ones.
double parse_length_m(std::string_view text);

/// A vacuum wavelength in nm from a length, or from a frequency in Hz, kHz, MHz, GHz, THz; a plain number is
/// in nm.
double parse_wavelength_nm(std::string_view text);

}  // namespace aureole

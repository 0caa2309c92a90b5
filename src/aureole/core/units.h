// SPDX-License-Identifier: Apache-2.0
// Parses numbers with units: "5um", "0.3 mm", "589nm", "10GHz".
#pragma once

#include <string>
#include <string_view>

namespace aureole {

/// Returns a number for a message, with enough digits that 1.0000001 differs from 1.
std::string shown_number(double value);
std::string shown_number(float value);

/// Parses the whole of `text` as a number without a unit; throws Error. Accepts the input of strtod in the C
/// locale except hex and "inf"/"nan".
double parse_number(std::string_view text);

/// Parses a length with one of the units nm, um (or µm), mm, cm, m, km, and returns metres. If the unit is
/// missing or unknown, throws an Error that lists the valid ones.
double parse_length_m(std::string_view text);

/// Parses a vacuum wavelength, given as a length or as a frequency in Hz, kHz, MHz, GHz, THz, and returns nm.
/// A plain number is in nm.
double parse_wavelength_nm(std::string_view text);

}  // namespace aureole

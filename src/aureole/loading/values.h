// SPDX-License-Identifier: Apache-2.0
// Converts the text of property elements to typed values.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "aureole/loading/node.h"
#include "aureole/math/motion.h"
#include "aureole/plugin/properties.h"

namespace aureole {

/// Returns the value of a <float>, <rgb>, <transform> ... element, or nothing if it has problems, which are
/// reported.
std::optional<Properties::Value> property_value(const Node& node, Diagnostics& diagnostics);

/// Returns the product of the steps of a <transform>; later steps apply after earlier ones. Throws Error at
/// the faulty step.
Transform parse_transform(const Node& node, Diagnostics& diagnostics);
/// Returns the key frames of an <animation>: its children <transform time="...">. Throws Error at the faulty one.
Motion parse_animation(const Node& node, Diagnostics& diagnostics);

/// Parses numbers separated by commas or spaces; throws Error.
std::vector<double> parse_numbers(std::string_view text);
/// Splits a list at commas or spaces.
std::vector<std::string_view> split_list(std::string_view text);

/// Parses one or three linear numbers, or "#rrggbb", which is sRGB-encoded and gets decoded; throws Error.
SpectrumLiteral parse_rgb(std::string_view text);
/// Parses one number, or "wavelength:value" pairs in order of wavelength; throws Error. `unit` applies to
/// wavelengths without a unit; empty: nm.
SpectrumLiteral parse_spectrum(std::string_view text, const std::string& unit = "");
/// Reads a text file with two columns, wavelength and value, and # comments; throws Error located in that
/// file. Lines before the first number are a header, which may name the unit.
SpectrumLiteral read_spectrum_file(const std::filesystem::path& file, const std::string& unit = "");

/// Decodes one sRGB component (IEC 61966-2-1).
double srgb_to_linear(double encoded);
/// Returns the shortest text that reads back as `value`.
std::string number_text(double value);

}  // namespace aureole

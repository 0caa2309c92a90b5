// SPDX-License-Identifier: Apache-2.0
// From the text of property elements to typed values.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "aureole/loading/node.h"
#include "aureole/math/transform.h"
#include "aureole/plugin/properties.h"

namespace aureole {

/// The value of a <float>, <rgb>, <transform> ... element, or nothing where it has problems, which are
/// reported.
std::optional<Properties::Value> property_value(const Node& node, Diagnostics& diagnostics);

/// The product of the steps of a <transform>; later steps apply after earlier ones. Throws Error at the
/// faulty step.
Transform parse_transform(const Node& node, Diagnostics& diagnostics);

/// Numbers separated by commas or spaces; throws Error.
std::vector<double> parse_numbers(std::string_view text);
/// The words of a list separated by commas or spaces.
std::vector<std::string_view> split_list(std::string_view text);

/// One or three linear numbers, or "#rrggbb", which is sRGB-encoded and gets decoded; throws Error.
SpectrumLiteral parse_rgb(std::string_view text);
/// One number, or "wavelength:value" pairs in order of wavelength (nm, or with a unit); throws Error.
SpectrumLiteral parse_spectrum(std::string_view text);
/// A text file of two columns, nm and value, with # comments; throws Error located in that file.
SpectrumLiteral read_spectrum_file(const std::filesystem::path& file);

/// IEC 61966-2-1 decoding of one component.
double srgb_to_linear(double encoded);
/// Shortest text that reads back as `value`.
std::string number_text(double value);

}  // namespace aureole

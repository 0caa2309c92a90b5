// SPDX-License-Identifier: Apache-2.0
// Reads measured tables as text, with two numbers per line.
#pragma once

#include <iosfwd>
#include <utility>
#include <vector>

namespace aureole::optics {

/// Reads pairs of numbers, one per line, separated by blanks or commas. '#' starts a comment. Further
/// columns, and lines of words before the first pair, are skipped. Throws std::domain_error that names an
/// invalid line, and for more than 100,000 lines.
std::vector<std::pair<double, double>> read_two_columns(std::istream& text);

}  // namespace aureole::optics

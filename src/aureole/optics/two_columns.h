// SPDX-License-Identifier: Apache-2.0
// Measured tables as text: two numbers per line.
#pragma once

#include <iosfwd>
#include <utility>
#include <vector>

namespace aureole::optics {

/// Pairs of numbers, one per line, separated by blanks or commas. '#' starts a comment; further columns, and
/// lines of words before the first pair, are skipped. Throws std::domain_error that names the line, and where
/// there are more than 100,000 lines.
std::vector<std::pair<double, double>> read_two_columns(std::istream& text);

}  // namespace aureole::optics

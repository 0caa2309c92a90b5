// SPDX-License-Identifier: Apache-2.0
// Indices for one colour or a pair of colours: whiteness, yellowness, metamerism.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string_view>

#include "aureole/pigment/observation.h"

namespace aureole::pigment {

/// x = X/(X + Y + Z) and y; 0 for black.
struct Chromaticity {
  double x = 0, y = 0;
};
Chromaticity chromaticity(const Xyz& xyz);

/// The field of the observer in degrees: 2 (CIE 1931) or 10 (CIE 1964).
enum class Field { two, ten };

/// CIE whiteness W = Y + 800 (x_n - x) + 1700 (y_n - y), and tint T = k (x_n - x) - 650 (y_n - y) with k = 1000 for 2
/// degrees and 900 for 10 (CIE 15:2004, 9.1; ISO 11475). Positive tints are greenish. The formulas are for D65.
struct Whiteness {
  double whiteness = 0, tint = 0;
  /// Whether the sample is a white for which the formulas hold: 40 < W < 5 Y - 280 and -4 < T < 2.
  bool is_valid = false;
};
/// Whiteness of a sample. `xyz` is relative to `white`; `Observation` has both.
Whiteness cie_whiteness(const Xyz& xyz, const Xyz& white, Field field);

/// Yellowness index YI = 100 (C_x X - C_z Z)/Y of ASTM E313-20, section 6. Nothing for illuminants other than C and
/// D65, for which it is not defined.
std::optional<double> yellowness(const Xyz& xyz, std::string_view illuminant, Field field);

/// A colour difference of a sample from a standard, in this order.
using DifferenceFormula = std::function<double(const Lab&, const Lab&)>;

/// Special metamerism index, change of illuminant or observer (CIE 15:2018, 9.2.2; DIN 6172): the difference of two
/// reflectances under `test`. Their difference under `reference` is removed first: the sample's X, Y, Z under
/// `test` are multiplied by the ratios of the standard's to the sample's under `reference` (multiplicative
/// correction of Brockes). A pair that matches under `reference` is not changed.
double metamerism_index(const Observation& reference, const Observation& test,
                        std::span<const double> standard, std::span<const double> sample,
                        const DifferenceFormula& formula = cie1976);

}  // namespace aureole::pigment

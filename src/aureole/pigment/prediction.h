// SPDX-License-Identifier: Apache-2.0
// Predictions of a palette for a measured sample.
#pragma once

#include <optional>
#include <vector>

#include "aureole/pigment/paints.h"
#include "aureole/pigment/samples.h"

namespace aureole::pigment {

/// The reflectance that a sample's backing states as a number, if it is one.
std::optional<double> backing_reflectance(const Sample& sample);

/// Inner reflectance of what lies behind a sample, at wavelength i of the table: the number that it states, or
/// the mean of the bare substrates of that name in the table, without the interface.
double substrate_at(const SampleTable& table, const Surface& surface, const Sample& sample, std::size_t i);

/// A palette's prediction of one sample, as it would be measured. Throws std::domain_error where the sample
/// has a thickness and the palette's coefficients are relative, or a paint is not in the palette.
std::vector<double> predict(const Palette& palette, const SampleTable& table, const Sample& sample);

}  // namespace aureole::pigment

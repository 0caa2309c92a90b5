// SPDX-License-Identifier: Apache-2.0
// Predicts measured samples from a palette.
#pragma once

#include <optional>
#include <vector>

#include "aureole/pigment/paints.h"
#include "aureole/pigment/samples.h"

namespace aureole::pigment {

/// The reflectance that a sample's backing states as a number, or nothing.
std::optional<double> backing_reflectance(const Sample& sample);

/// Inner reflectance of the backing of a sample, at wavelength i of the table: the stated number, or the mean
/// of the bare substrates of that name in the table, without the interface.
double substrate_at(const SampleTable& table, const Surface& surface, const Sample& sample, std::size_t i);

/// A palette's prediction of one sample, as it would be measured. Throws std::domain_error if the sample has
/// a thickness and the palette's coefficients are relative, or if a paint is not in the palette.
std::vector<double> predict(const Palette& palette, const SampleTable& table, const Sample& sample);

}  // namespace aureole::pigment

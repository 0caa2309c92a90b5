// SPDX-License-Identifier: Apache-2.0
// Measured samples in the text format ANSI CGATS.17 (ISO 28178): header lines with keywords, a list of
// fields, and rows of data. Spectrophotometers and profiling programs write it.
#pragma once

#include <iosfwd>

#include "aureole/pigment/samples.h"

namespace aureole::pigment {

/// Reads the first table with spectra. Its fields are wavelengths (SPECTRAL_NM400, SPECTRAL_400, SPEC_400,
/// NM400, NM_400, R_400 or 400; or pairs of fields SPECTRAL_NM and SPECTRAL_DEC or SPECTRAL_PCT) and the columns of `read_samples`, in any case: PAINTS, which names the paint
/// or the recipe (else SAMPLE_NAME, else SAMPLE_ID), SAMPLE_NAME or SAMPLE_ID, QUANTITY, BACKING,
/// THICKNESS_UM, SERIES, SPECIMEN. Other fields are ignored. Values are fractions, or per cent if SPECTRAL_NORM is 100, if a
/// field is named SPECTRAL_PCT400, or if UNIT is "percent". The keyword
/// MEASUREMENT_GEOMETRY ("45/0", "d/8 SCI") becomes the table's instrument. Throws TextError.
SampleTable read_cgats(std::istream& text);

}  // namespace aureole::pigment

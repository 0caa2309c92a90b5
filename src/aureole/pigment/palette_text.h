// SPDX-License-Identifier: Apache-2.0
// Palettes as comma-separated values, for spreadsheets and for other programs.
#pragma once

#include <iosfwd>
#include <string>

#include "aureole/pigment/paints.h"

namespace aureole::pigment {

/// One row for each wavelength; columns "nm" and, of each paint, "NAME K", "NAME S" and, if known, "NAME K
/// error", "NAME S error". Lines before it, each a key and a value: "unit" ("relative" or "1/m"), "surface
/// seen", "surface through", "surface k2" (saunderson.h), "density NAME". Numbers have as many digits as it
/// takes to read them back unchanged.
std::string palette_text(const Palette& palette);

/// Reads that, and checks it. Throws TextError.
Palette read_palette(std::istream& text);

}  // namespace aureole::pigment

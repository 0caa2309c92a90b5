// SPDX-License-Identifier: Apache-2.0
// Palettes as comma-separated values, for spreadsheets and other programs.
#pragma once

#include <iosfwd>
#include <string>

#include "aureole/pigment/paints.h"

namespace aureole::pigment {

/// Writes one row per wavelength, with columns "nm" and, for each paint, "NAME K", "NAME S" and, if known,
/// "NAME K error", "NAME S error". Lines before the table contain a key and a value: "unit" ("relative",
/// "film" or "1/m"), "surface seen", "surface through", "surface k2" (saunderson.h), "theory" ("streams", or "two fluxes", which holds without this line), "streams index",
/// "streams g", "streams geometry", "streams specular" (PaletteStreams), "g NAME", "mixing" ("volume", or "mass",
/// which holds without this line), "density NAME". Numbers have
/// enough digits to be read back unchanged.
std::string palette_text(const Palette& palette);

/// Reads the format of `palette_text` and checks the palette. Throws TextError.
Palette read_palette(std::istream& text);

}  // namespace aureole::pigment

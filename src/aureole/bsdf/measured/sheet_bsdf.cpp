// SPDX-License-Identifier: Apache-2.0
#include "aureole/bsdf/measured/sheet_bsdf.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace aureole {

void note_window_file(const Properties& properties, const WindowFile& file, const WindowNotes& notes,
                      bool is_coloured) {
  const auto note = [&](const std::string& text) {
    properties.note("filename", "parameter \"filename\": " + text);
  };
  note(is_coloured ? "the file has colours (CIE XYZ), not spectra; they become smooth spectra"
                   : "the file has one number for the visible range; it is used at all wavelengths");
  if (!file.skipped.empty()) note(fmt::format("not used: {}", fmt::join(file.skipped, ", ")));
  if (notes.negative > 0) note(fmt::format("{} values are negative and count as 0", notes.negative));
  if (notes.reversed_front || notes.reversed_back)
    note(fmt::format(
        "there is no transmission from the {}; the other direction is taken, as in air both are alike",
        notes.reversed_front ? "front" : "back"));
  const auto has = [&](bool transmission, bool front, int channel = 1) {
    for (const WindowBlock& b : file.blocks)
      if (b.channel == channel && b.is_transmission == transmission && b.is_front == front) return true;
    return false;
  };
  const bool some_unused = std::any_of(file.blocks.begin(), file.blocks.end(), [&](const WindowBlock& b) {
    if (b.channel == 1) return false;
    return file.is_tree() || !has(b.is_transmission, b.is_front) ||
           !has(b.is_transmission, b.is_front, 2 - b.channel);
  });
  if (some_unused)
    note(file.is_tree()
             ? "CIE X and Z of tensor trees are not used"
             : "CIE X and Z are used where a direction has X, Y (Visible) and Z; some have not all of them");
  for (const bool front : {true, false})
    if (!has(false, front))
      note(fmt::format("there is no reflection on the {}; it is black", front ? "front" : "back"));
  if (!has(true, true) && !has(true, false)) note("there is no transmission; the surface is opaque");
}

}  // namespace aureole

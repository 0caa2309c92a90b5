// SPDX-License-Identifier: Apache-2.0
// Notes about measured data that end within the wavelengths of the film.
#pragma once

#include <string>
#include <string_view>

#include "aureole/plugin/properties.h"
#include "aureole/spectrum/wavelengths.h"

namespace aureole {

/// Returns a range in nm for messages, as in "400 to 700 nm".
std::string range_text(double min_nm, double max_nm);

/// Notes, located at the parameter `name`, that a property of matter is known over `data` alone, if the film's
/// range exceeds it: at the wavelengths outside, which the note lists, the value at the nearer end is used.
/// `subject` begins the note, as in "the spectrum" or "\"rutile\"".
void note_data_range(const Properties& properties, std::string_view name, const std::string& subject,
                     const WavelengthRange& data);

}  // namespace aureole

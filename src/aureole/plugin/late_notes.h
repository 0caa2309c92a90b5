// SPDX-License-Identifier: Apache-2.0
// Notes to the user that are found once a file is loaded.
#pragma once

#include <string>
#include <string_view>

#include "aureole/plugin/properties.h"

namespace aureole {

/// Returns a note with the place of a parameter, or of the object if the parameter is absent, for `Integrator::scene_notes`.
std::string note_text(const Properties& properties, std::string_view name, const std::string& message);

/// Diagnostics of contexts whose file is loaded. The notes of its objects have been shown, so that later ones would be lost:
/// `Properties::note` throws std::logic_error where a context has these.
Diagnostics* closed_diagnostics();

}  // namespace aureole

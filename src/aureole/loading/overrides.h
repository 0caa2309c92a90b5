// SPDX-License-Identifier: Apache-2.0
// Third stage of loading: overrides of the command line, and the default integrator.
#pragma once

#include "aureole/loading/load.h"
#include "aureole/loading/references.h"

namespace aureole {

/// Names of the channels that scenes for denoising get, as the parameter "aovs" of the integrator "aov" states them.
inline constexpr const char* kDenoisingFeatures = "albedo:albedo, normal:sh_normal";

/// Applies `options` to the first sensor's sampler and film, and to the integrator.
void apply_overrides(Node& root, const LoadOptions& options, Diagnostics& diagnostics);

/// Returns the first child of `parent` that belongs to a family, following references, or null.
Node* child_of_family(const Ids& ids, Node& parent, std::string_view family);

/// Returns the first sensor in the file, possibly on a shape, following references, or null.
Node* first_sensor(const Ids& ids);

}  // namespace aureole

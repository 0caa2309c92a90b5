// SPDX-License-Identifier: Apache-2.0
// Third stage of loading: overrides of the command line, and the default integrator.
#pragma once

#include "aureole/loading/load.h"
#include "aureole/loading/references.h"

namespace aureole {

/// Applies `options` to the first sensor's sampler and to the integrator.
void apply_overrides(Node& root, const LoadOptions& options, Diagnostics& diagnostics);

/// Returns the first child of `parent` that belongs to a family, following references, or null.
Node* child_of_family(const Ids& ids, Node& parent, std::string_view family);

/// Returns the first sensor in the file, possibly on a shape, following references, or null.
Node* first_sensor(const Ids& ids);

}  // namespace aureole

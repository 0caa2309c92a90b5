// SPDX-License-Identifier: Apache-2.0
// Third stage of loading: changes by the command line, and the default integrator.
#pragma once

#include "aureole/loading/load.h"
#include "aureole/loading/references.h"

namespace aureole {

/// Applies `options` to the first sensor's sampler and to the integrator.
void apply_overrides(Node& root, const LoadOptions& options, Diagnostics& diagnostics);

/// The first child of `parent` that belongs to a family, references followed, or null.
Node* child_of_family(const Ids& ids, Node& parent, std::string_view family);

/// The first sensor in the file, which may sit on a shape, references followed, or null.
Node* first_sensor(const Ids& ids);

}  // namespace aureole

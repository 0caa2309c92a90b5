// SPDX-License-Identifier: Apache-2.0
// Third stage of loading: what the command line changes, and the integrator that a scene without one gets.
#pragma once

#include "aureole/scene/build.h"
#include "aureole/scene/node.h"

namespace aureole {

/// Applies `options` to the first sensor's sampler and to the integrator.
void apply_overrides(Node& root, const LoadOptions& options, Diagnostics& diagnostics);

/// The node itself, or what a <ref> refers to, or null.
Node* target_of(Node& root, Node& node);

/// The first top-level element of a family, following references, or null.
Node* first_of_family(Node& root, std::string_view family);

/// The first child of `parent` that belongs to a family, following references into the scene, or null.
Node* child_of_family(Node& root, Node& parent, std::string_view family);

}  // namespace aureole

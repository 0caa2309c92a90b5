// SPDX-License-Identifier: Apache-2.0
// The rows of the parameter table that every shape shares.
#pragma once

#include <vector>

#include "aureole/plugin/registry.h"

namespace aureole {

/// `own` followed by the rows common to all shapes: bsdf, emitter, sensor, to_world, flip_normals.
std::vector<ParameterDoc> shape_parameters(std::vector<ParameterDoc> own);

/// The same for meshes: face_normals before them.
std::vector<ParameterDoc> mesh_parameters(std::vector<ParameterDoc> own);

}  // namespace aureole

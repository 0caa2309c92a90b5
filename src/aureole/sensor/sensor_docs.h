// SPDX-License-Identifier: Apache-2.0
// The rows of the parameter table that sensors share.
#pragma once

#include <vector>

#include "aureole/plugin/registry.h"

namespace aureole {

/// `own` followed by the rows common to all sensors: film, sampler, srf, shutter_open, shutter_close.
std::vector<ParameterDoc> sensor_parameters(std::vector<ParameterDoc> own);

/// The same for cameras: near_clip and far_clip before them.
std::vector<ParameterDoc> camera_parameters(std::vector<ParameterDoc> own);

/// The same for cameras with a lens or a pinhole: the field of view and the centre of projection before them.
std::vector<ParameterDoc> lens_camera_parameters(std::vector<ParameterDoc> own);

}  // namespace aureole

// SPDX-License-Identifier: Apache-2.0
// The parameters `fov`, `fov_axis` and `focal_length` of cameras and projectors.
#pragma once

namespace aureole {

class Properties;

/// tan(half the horizontal field of view) of a picture whose width is `aspect` times its height: from `fov`
/// about `fov_axis`, or from `focal_length` (50mm where neither is given) by the diagonal of 35 mm film.
double tangent_of_half_width(const Properties& properties, double aspect);

}  // namespace aureole

// SPDX-License-Identifier: Apache-2.0
// Measured paints that come with the library.
#pragma once

#include "aureole/pigment/fit.h"

namespace aureole::pigment {

/// Reflectance of 13 acrylic paints of single pigments ("Kimera") and of a weighed tint of each of 12 with
/// white, opaque layers, three measurements each, 381 to 720 nm; noisy below 400 nm, where the instrument had
/// little light. By miciwan, https://github.com/miciwan/PaintMixing, CC BY 4.0: name the author where you use
/// them.
const SampleTable& kimera_samples();

/// The interface that `kimera_fit` assumes: the measurements do not state their geometry, but dark paints
/// reflect less (2.2 %) than an acrylic surface does by itself, so that specular light was not counted. 45:0
/// and an index of 1.5.
Surface kimera_surface();

/// K and S of those paints, relative to the white's S, by `kimera_surface`.
const Fit& kimera_fit();

}  // namespace aureole::pigment

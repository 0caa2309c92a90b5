// SPDX-License-Identifier: Apache-2.0
// Measured paints included in the library.
#pragma once

#include "aureole/pigment/fit.h"

namespace aureole::pigment {

/// Reflectance of 13 acrylic paints with single pigments ("Kimera"), and of a weighed tint with white of each
/// of the other 12. Opaque layers, three measurements each, 381 to 720 nm; noisy below 400 nm, where the
/// instrument had little light. By miciwan, https://github.com/miciwan/PaintMixing, CC BY 4.0: the author
/// must be credited.
const SampleTable& kimera_samples();

/// The interface that `kimera_fit` assumes: geometry 45:0 and an index of 1.5. The measurements do not state
/// their geometry. But dark paints reflect less (2.2 %) than an acrylic surface alone, so that specular light
/// was excluded.
Surface kimera_surface();

/// K and S of these paints, relative to the white's S, with the interface `kimera_surface`.
const Fit& kimera_fit();

}  // namespace aureole::pigment

// SPDX-License-Identifier: Apache-2.0
// The boundary of a translucent body: the BSDF of its surface where light enters, and the BSDF where it
// exits.
#pragma once

#include "aureole/bsdf/bsdf.h"

namespace aureole {

struct Boundary {
  /// index of refraction inside over outside, at the nodes of the scene's grid
  SampledSpectrum relative_index;
  /// Reflects as the boundary does, and transmits with the lobe `enter`. The transmitted value lacks the
  /// factor n^2 by which refraction changes radiance, since the light returns to the outside.
  BsdfPtr entry;
  BsdfPtr exit;  ///< the factor T(w_o)/(c pi) cos theta_o, with T and c as in bssrdf.h
};

/// Reads "bsdf", or "int_ior" and "ext_ior". Throws located Errors.
Boundary make_boundary(const Properties& properties);

}  // namespace aureole

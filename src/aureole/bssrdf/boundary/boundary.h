// SPDX-License-Identifier: Apache-2.0
// The boundary of a translucent body: the BSDF of a BSSRDF's surface where light enters, and that where it
// leaves.
#pragma once

#include "aureole/bsdf/bsdf.h"

namespace aureole {

struct Boundary {
  SampledSpectrum relative_index;  ///< inside over outside, at the nodes of the scene's grid
  /// Reflects as the boundary does. Light that is transmitted has the lobe `enter`: a value without the factor
  /// of the squared index by which radiance changes, since it returns to where it came from.
  BsdfPtr entry;
  BsdfPtr exit;  ///< T(w_o)/(c pi) cos theta_o, T and c as in bssrdf.h
};

/// Reads "bsdf", or "int_ior" and "ext_ior". Throws located errors.
Boundary make_boundary(const Properties& properties);

}  // namespace aureole

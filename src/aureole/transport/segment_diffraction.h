// SPDX-License-Identifier: Apache-2.0
// The diffraction factor |u/u0|^2 of segments in scenes with the diffraction model "segments"
// (docs/diffraction.md): it may be nonzero where the segment is occluded, and above 1 where it is unoccluded.
#pragma once

#include "aureole/scene/scene.h"
#include "aureole/transport/connection.h"

namespace aureole {

/// Returns |u/u0|^2 per wavelength of the segment from `origin` along the unit direction `d`; `length` may be
/// infinite. `is_open`: whether the segment is unoccluded. An edge counts if light reaches it from both ends
/// of the segment, straight or by way of one parallel edge on each side.
Spectrum segment_diffraction(const Scene& scene, const Vec3& origin, const Vec3& d, float length,
                             bool is_open, const Wavelengths& w);

/// Returns the probability with which a ray continues behind an obstacle that it has hit, into the shadow. It
/// falls with Fresnel's parameter of the nearest edge that light along the ray reaches, and is 0 if there is
/// none near. It is equal for all obstacles along a ray. `from_infinity`: the ray is light of an emitter at
/// infinity.
float probability_behind(const Scene& scene, const Vec3& origin, const Vec3& d, bool from_infinity,
                         const Wavelengths& w);

/// Multiplies the passage of a connection by its diffraction factor and returns whether light arrives.
/// `is_open` is the result of the connection's visibility test. Surfaces that transmit less than a hundredth
/// of the light block a connection; the light that they transmit is added. If rays of other techniques
/// continue behind obstacles (`TestSegment::others_go_behind`), these find the light of a blocked connection
/// as well; otherwise its MIS weight becomes that of the connection alone.
bool diffract_connection(const Scene& scene, TestSegment& connection, bool is_open, const Wavelengths& w);

}  // namespace aureole

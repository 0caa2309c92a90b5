// SPDX-License-Identifier: Apache-2.0
// The diffraction factor |u/u0|^2 of segments in scenes with the diffraction model "segments"
// (docs/diffraction.md): it may be nonzero where the segment is occluded, and above 1 where it is unoccluded.
#pragma once

#include "aureole/scene/scene.h"
#include "aureole/transport/connection.h"

namespace aureole {

/// Returns |u/u0|^2 per wavelength of the segment from `origin` along the unit direction `d`; `length` may be infinite.
/// `is_open`: whether the segment is unoccluded. An edge counts if light reaches it from both ends of the
/// segment, straight or by way of one parallel edge on each side.
Spectrum segment_diffraction(const Scene& scene, const Vec3& origin, const Vec3& d, float length,
                             bool is_open, const Wavelengths& w);

/// The probability with which a ray goes on behind an obstacle that it has hit, into the shadow; 0 where no edge is near that
/// light along the ray reaches. It falls with Fresnel's parameter of the nearest edge. `from_infinity`: the ray is light of an emitter at infinity. The
/// same for all obstacles along a ray.
float probability_behind(const Scene& scene, const Vec3& origin, const Vec3& d, bool from_infinity,
                         const Wavelengths& w);

/// Multiplies the passage of a connection by its diffraction factor, `is_open` being the result of its visibility test,
/// and returns whether light arrives. Surfaces that transmit less than a hundredth of the light block a
/// connection; the light that they transmit is added. Light that arrives on a blocked connection is found by other
/// techniques as well if their rays go on behind obstacles (`TestSegment::others_go_behind`); else the MIS weight
/// becomes that of the connection alone.
bool diffract_connection(const Scene& scene, TestSegment& connection, bool is_open, const Wavelengths& w);

}  // namespace aureole

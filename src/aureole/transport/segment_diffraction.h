// SPDX-License-Identifier: Apache-2.0
// The diffraction factor |u/u0|^2 of segments in scenes with the diffraction model "segments"
// (docs/diffraction.md): it may be nonzero where the segment is occluded, and above 1 where it is unoccluded.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>

#include "aureole/scene/scene.h"
#include "aureole/transport/connection.h"
#include "aureole/transport/segment_chain.h"

namespace aureole {

/// Returns |u/u0|^2 per wavelength of the segment from `origin` along the unit direction `d`; `length` may be
/// infinite. `is_open`: whether the segment is unoccluded. An edge counts if light reaches it from both ends
/// of the segment, straight or by way of one parallel edge on each side.
Spectrum segment_diffraction(const Scene& scene, const Vec3& origin, const Vec3& d, float length,
                             bool is_open, const Wavelengths& w);

/// Returns |u/u0|^2 per wavelength of the legs of a path between planar mirrors, as one straight segment in the space
/// in which the mirrors are unfolded. Edges beside all legs act together. `begins_at_infinity`: light comes from
/// infinity along the first leg.
Spectrum chain_diffraction(const Scene& scene, std::span<const PathLeg> legs, bool begins_at_infinity,
                           const Wavelengths& w);

/// Segments of a path whose diffraction factors its throughput does not contain yet. They are computed when the
/// path is known to carry light: most paths in shadows never do.
class PendingSegments {
public:
  bool is_empty() const { return count_ == 0; }
  /// Adds the legs of a chain, or a segment by itself. Returns false if there is no room for them.
  bool add(std::span<const PathLeg> legs) {
    if (legs.size() > kMaxSegments - count_) return false;
    std::copy(legs.begin(), legs.end(), segments_.begin() + std::ptrdiff_t(count_));
    count_ += legs.size();
    return true;
  }
  /// Returns the product of their factors, and removes them.
  Spectrum take_factors(const Scene& scene, const Wavelengths& w) {
    Spectrum product = 1.f;
    for (std::size_t begin = 0, end; begin < count_; begin = end) {
      for (end = begin + 1; end < count_ && segments_[end].continues();) ++end;
      product *= chain_diffraction(scene, std::span(segments_).subspan(begin, end - begin), false, w);
    }
    count_ = 0;
    return product;
  }

private:
  static constexpr std::size_t kMaxSegments = 6;
  std::array<PathLeg, kMaxSegments> segments_;
  std::size_t count_ = 0;
};

/// Whether edges may lie so near to a ray that it has a diffraction factor other than 1 up to any unoccluded point.
bool has_edges_near(const Scene& scene, const Vec3& origin, const Vec3& d, const Wavelengths& w);

/// Returns the probability with which a ray continues behind an obstacle that it has hit, into the shadow. It
/// falls with Fresnel's parameter of the nearest edge that light along the ray reaches, and is 0 if there is
/// none near. It is equal for all obstacles along a ray. `from_infinity`: the ray is light of an emitter at
/// infinity. `before`: the chain that the ray continues, from whose begin detours count; or null.
float probability_behind(const Scene& scene, const Vec3& origin, const Vec3& d, bool from_infinity,
                         const Wavelengths& w, const SegmentChain* before = nullptr);

/// Multiplies the passage of a connection by its diffraction factor and returns whether light arrives.
/// `is_open` is the result of the connection's visibility test. Surfaces that transmit less than a hundredth
/// of the light block a connection; the light that they transmit is added. If rays of other techniques
/// continue behind obstacles (`TestSegment::others_go_behind`), these find the light of a blocked connection
/// as well; otherwise its MIS weight becomes that of the connection alone. `before`: the chain that the connection
/// continues, whose factor is included; or null.
bool diffract_connection(const Scene& scene, TestSegment& connection, bool is_open, const Wavelengths& w,
                         const SegmentChain* before = nullptr);

}  // namespace aureole

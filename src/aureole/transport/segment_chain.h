// SPDX-License-Identifier: Apache-2.0
// `SegmentChain`: the successive segments of a path between planar mirrors and through panes. They are one straight
// segment in the space in which the mirrors are unfolded, and have one diffraction factor (docs/diffraction.md).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "aureole/math/vec.h"
#include "aureole/shape/surface_point.h"
#include "aureole/spectrum/wavelengths.h"

namespace aureole {

class Scene;

/// A segment of a path: one of several between planar mirrors, or one by itself.
struct PathLeg {
  Vec3 origin, d;  ///< `d` has unit length
  float length;    ///< may be infinite
  bool is_open;    ///< whether the segment is unoccluded
  /// Unit normal of the planar mirror that reflects the leg before into this one, and the point of reflection; zero
  /// for the first leg.
  Vec3 mirror_normal{}, mirror_p{};

  bool continues() const { return length_squared(mirror_normal) > 0; }
};

/// Whether the surface around a point lies in a plane, on which the shading normal is the normal of the plane.
bool is_flat(const SurfacePoint& point);

/// The legs of a path since its last vertex that is neither a planar mirror nor a pane. The throughput of the path
/// does not contain their diffraction factor.
class SegmentChain {
public:
  /// Largest number of legs. A path between more mirrors has a diffraction factor for each group of so many legs.
  static constexpr std::size_t kMaxLegs = 6;

  bool is_empty() const { return count_ == 0; }
  /// Whether the present ray of the path continues the chain.
  bool is_linked() const { return link_ != Link::none; }
  bool begins_at_infinity() const { return begins_at_infinity_; }
  std::span<const PathLeg> legs() const { return {legs_.data(), count_}; }

  /// Continues the chain along the present ray behind a pane.
  void link_straight() { link_ = Link::straight; }
  /// Continues the chain along the present ray, which a planar mirror reflects at `p`. Returns false if there is no
  /// room for a leg.
  bool link_by_mirror(const Vec3& p, const Vec3& normal) {
    if (count_ == kMaxLegs) return false;
    link_ = Link::mirror, mirror_p_ = p, mirror_normal_ = normal;
    return true;
  }
  /// Adds the present segment, which ends at a vertex: it continues the chain if that is linked, or begins a new one.
  void arrive(const PathLeg& segment, bool begins_at_infinity) {
    factor_.reset();
    switch (link_) {
      case Link::none:
        count_ = 1, begins_at_infinity_ = begins_at_infinity;
        legs_[0] = segment;
        break;
      case Link::straight: {
        PathLeg& last = legs_[count_ - 1];
        last.length = dot(segment.origin - last.origin, last.d) + segment.length;
        last.is_open &= segment.is_open;
        break;
      }
      case Link::mirror:
        legs_[count_] = segment;
        legs_[count_].mirror_normal = mirror_normal_;
        legs_[count_++].mirror_p = mirror_p_;
        break;
    }
    link_ = Link::none;
  }
  void clear() { count_ = 0, link_ = Link::none, factor_.reset(); }

  /// Whether `factor` has been computed.
  bool has_factor() const { return factor_.has_value(); }
  /// Returns the diffraction factor of the chain, which ends at a vertex.
  const Spectrum& factor(const Scene& scene, const Wavelengths& w);

private:
  enum class Link : std::uint8_t { none, straight, mirror };
  std::array<PathLeg, kMaxLegs> legs_;
  std::size_t count_ = 0;
  Link link_ = Link::none;  ///< how the present ray continues the chain
  bool begins_at_infinity_ = false;
  Vec3 mirror_p_, mirror_normal_;  ///< of the mirror that has reflected the present ray
  std::optional<Spectrum> factor_;
};

}  // namespace aureole

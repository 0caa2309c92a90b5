// SPDX-License-Identifier: Apache-2.0
// `Surface`: the data of a surface that a hit needs. One array holds a record for each shape, and for each
// shape of an instanced group; each record fills one cache line.
#pragma once

#include <cstdint>

#include "aureole/asset/primitive.h"
#include "aureole/bsdf/bsdf.h"
#include "aureole/bssrdf/bssrdf.h"
#include "aureole/emitter/light.h"
#include "aureole/shape/instance.h"
#include "aureole/shape/shape.h"

namespace aureole {

struct alignas(64) Surface {
  const Shape* shape = nullptr;  ///< shape of the surface; null for an instance
  const Bsdf* bsdf = nullptr;
  const Light* light = nullptr;  ///< the emitter on this surface, or null
  /// Media on the side of the normal (`outside`) and on the other side (`inside`); null is vacuum.
  const Medium *outside = nullptr, *inside = nullptr;

  /// An instance, which is not a surface itself, has its transform here; null for surfaces.
  const Instance* instance = nullptr;
  union {
    const Surface* members = nullptr;  ///< for an instance, the surfaces of its group
    /// For a surface with a BSSRDF: the surface record for light that leaves, after it entered at another
    /// point.
    const Surface* exit;
    const Bssrdf* bssrdf;  ///< for the exit of a surface with a BSSRDF, that BSSRDF
  };

  // Copies of BSDF properties that every vertex needs.
  Lobe lobes = Lobe::none;
  bool passable : 1 = false;  ///< whether it transmits some light without deflection
  /// whether `outside` and `inside` are set; else the surrounding medium is on both sides
  bool bounds_media : 1 = false;
  bool needs_choice : 1 = true, needs_tangent : 1 = true;
  /// Whether other surfaces lie so close to a part of this one that the offset of a ray's origin would skip
  /// them (scene/contact_search.h).
  bool touches : 1 = false;
  /// Where bodies overlap, the one of the highest rank fills the space: a stated priority (above 0), or below
  /// 0 the rank of a body without one that touches or cuts another (scene/contact_search.h). 0: the surface
  /// belongs to no such body.
  std::int8_t rank = 0;
  std::uint32_t body = 0;  ///< number of the closed body with a rank that the surface belongs to

  /// Whether light passes as if the surface were not there.
  bool is_null() const { return lobes == kNullLobe; }
  /// Whether the surface transmits no light.
  bool is_opaque() const { return !has(lobes, Lobe::transmit | Lobe::null | Lobe::enter); }
  /// Whether refracted light that enters this surface leaves it at another point (BSSRDF).
  bool has_exit() const { return has(lobes, Lobe::enter); }

  /// Returns the medium into which the direction `d` points; `around` is the medium on the other side.
  const Medium* medium_along(const Vec3& d, const Vec3& ng, const Medium* around) const {
    return bounds_media ? (dot(d, ng) > 0 ? outside : inside) : around;
  }

  Surface() = default;
  Surface(const Shape& s, const Bsdf& b, const SurfaceMedia& media)
      : shape(&s),
        bsdf(&b),
        outside(media.outside.get()),
        inside(media.inside.get()),
        lobes(b.lobes()),
        passable(b.is_passable()),
        bounds_media(media.given()),
        needs_choice(b.needs_choice()),
        needs_tangent(b.needs_tangent()),
        rank(std::int8_t(media.priority)) {}
  /// Makes the exit of a surface with a BSSRDF.
  Surface(const Surface& entry, const Bssrdf& b) : Surface(entry) {
    bsdf = &b.exit(), light = nullptr, bssrdf = &b;
    lobes = bsdf->lobes(), needs_choice = bsdf->needs_choice(), needs_tangent = bsdf->needs_tangent();
  }
};
static_assert(sizeof(Surface) == 64);

}  // namespace aureole

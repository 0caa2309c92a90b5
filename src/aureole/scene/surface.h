// SPDX-License-Identifier: Apache-2.0
// `Surface`: the data that a hit looks up. One record for each shape, and for each shape of an instanced
// group, in one array: a hit reads one cache line.
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
  const Shape* shape = nullptr;  ///< null: an instance
  const Bsdf* bsdf = nullptr;
  const Light* light = nullptr;  ///< that it emits, or null
  /// Media on the side of the normal and on the other; null is vacuum.
  const Medium *outside = nullptr, *inside = nullptr;

  /// For an instance, which is not a surface itself: its transform; else null.
  const Instance* instance = nullptr;
  union {
    const Surface* members = nullptr;  ///< of an instance: its group's surfaces
    /// For a surface with a BSSRDF: the surface at which light leaves that has entered elsewhere.
    const Surface* exit;
    const Bssrdf* bssrdf;  ///< of such an exit
  };

  // Copies of BSDF properties that every vertex needs.
  Lobe lobes = Lobe::none;
  bool passable : 1 = false;      ///< some light may pass straight through it
  bool bounds_media : 1 = false;  ///< `outside` and `inside` lie at it; else the same medium is on both sides
  bool needs_choice : 1 = true, needs_tangent : 1 = true;
  std::int8_t priority = 0;  ///< of overlapping dielectrics the highest counts

  /// Light that is refracted into it leaves elsewhere.
  bool has_exit() const { return has(lobes, Lobe::enter); }

  /// The medium on the side that the direction `d` leads to, where `around` is that of the other.
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
        priority(std::int8_t(media.priority)) {}
  /// The exit of a surface with a BSSRDF.
  Surface(const Surface& entry, const Bssrdf& b) : Surface(entry) {
    bsdf = &b.exit(), light = nullptr, bssrdf = &b;
    lobes = bsdf->lobes(), needs_choice = bsdf->needs_choice(), needs_tangent = bsdf->needs_tangent();
  }
};
static_assert(sizeof(Surface) == 64);

}  // namespace aureole

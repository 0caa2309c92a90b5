// SPDX-License-Identifier: Apache-2.0
// `Surface`: the data that a hit looks up. One record for each shape, and for each shape of an instanced
// group, in one array: a hit reads one cache line.
#pragma once

#include <cstdint>

#include "aureole/bsdf/bsdf.h"
#include "aureole/emitter/light.h"
#include "aureole/shape/instance.h"
#include "aureole/shape/shape.h"

namespace aureole {

class Medium;

struct alignas(64) Surface {
  const Shape* shape = nullptr;  ///< null: an instance
  const Bsdf* bsdf = nullptr;
  const Light* light = nullptr;  ///< that shines from it, or null
  /// On the side of the normal and on the other; null is vacuum.
  const Medium *outside = nullptr, *inside = nullptr;

  // For an instance, which is not a surface itself: its transform and its group's surfaces; else null.
  const Instance* instance = nullptr;
  const Surface* members = nullptr;

  // Copies of BSDF properties that every vertex needs.
  Lobe lobes = Lobe::none;
  bool passable = false;  ///< some light may pass straight through it
  bool needs_choice = true, needs_tangent = true;
  std::int8_t priority = 0;  ///< of overlapping dielectrics the highest counts

  Surface() = default;
  Surface(const Shape& s, const Bsdf& b)
      : shape(&s),
        bsdf(&b),
        lobes(b.lobes()),
        passable(b.is_passable()),
        needs_choice(b.needs_choice()),
        needs_tangent(b.needs_tangent()) {}
};
static_assert(sizeof(Surface) == 64);

}  // namespace aureole

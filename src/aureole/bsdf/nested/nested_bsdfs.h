// SPDX-License-Identifier: Apache-2.0
// Helpers of BSDFs that contain others.
#pragma once

#include <string>
#include <vector>

#include "aureole/bsdf/bsdf.h"
#include "aureole/math/warp.h"

namespace aureole {

/// Returns a sample of the null lobe; `mass` is both its probability and the transmitted fraction.
inline BsdfSample null_sample(const Vec3& wi, float mass) { return {-wi, mass, mass, kNullLobe}; }

/// Returns the nested BSDFs in their order; an error unless there are `count` of them.
inline std::vector<BsdfPtr> nested_bsdfs(const Properties& properties, std::size_t count) {
  const auto found = properties.get_children<Bsdf>("bsdf");
  if (found.size() != count)
    throw Error(properties.where(), "\"" + properties.type() + "\" needs " +
                                        (count == 1 ? "one nested BSDF" : "two nested BSDFs") + ", got " +
                                        std::to_string(found.size()));
  return {found.begin(), found.end()};
}

}  // namespace aureole

// SPDX-License-Identifier: Apache-2.0
#include "aureole/emitter/directions/emitter_placement.h"

#include <algorithm>
#include <cmath>

#include "aureole/plugin/properties.h"

namespace aureole {

Placement get_placement(const Properties& properties) {
  return get_placement(properties, properties.get_transform("to_world"));
}

Placement get_placement(const Properties& properties, const Transform& t) {
  const auto& m = t.matrix();
  double length[3];
  for (int c = 0; c < 3; ++c) length[c] = std::hypot(m[0][c], m[1][c], m[2][c]);
  constexpr double kTolerance = 1e-3;
  for (int c = 0; c < 3; ++c) {
    const int d = (c + 1) % 3;
    const double cosine =
        (m[0][c] * m[0][d] + m[1][c] * m[1][d] + m[2][c] * m[2][d]) / (length[c] * length[d]);
    if (std::abs(cosine) > kTolerance || std::abs(length[c] / length[d] - 1) > kTolerance)
      throw properties.error("to_world", "\"" + properties.type() +
                                             "\" may be moved, turned, mirrored and scaled as a whole, but "
                                             "not sheared or stretched");
  }
  Vec3 axis[3];
  for (int c = 0; c < 3; ++c)
    axis[c] = {float(m[0][c] / length[c]), float(m[1][c] / length[c]), float(m[2][c] / length[c])};
  return {t.point({0, 0, 0}), {axis[0], axis[1], axis[2]}, length[0]};
}

Motion get_placement_motion(const Properties& properties) {
  Motion motion = properties.get_motion("to_world");
  if (!motion.is_rigid())
    throw properties.error("to_world", "an emitter must not be scaled or sheared while it moves");
  return motion;
}

}  // namespace aureole

// SPDX-License-Identifier: Apache-2.0
// Shared by the two walks of `bdpt`: which techniques count, and how a connection is weighted against the
// others.
//
// Edges that diffract light are vertices that one of the two ends finds, which the path itself decides: an
// edge is sampled from the vertex before it, as seen from the sensor, unless that is a mirror or smooth
// glass, which nothing can be connected with. That edge, and all edges nearer to the light, are found from
// the light. So of the techniques for a path with edges those are left that connect it between the last edge
// which the light path finds and the first one which the sensor's path finds. An edge
// that the sensor has found is connected with the vertices of light paths, and the one next to a light is
// sampled for both of its neighbours, as in `path`.
#pragma once

#include "aureole/transport/two_way.h"
#include "aureole/transport/walk.h"

namespace aureole::bdpt {

/// Which techniques count, by their numbers of vertices from the light and from the sensor; -1: any.
struct Techniques {
  int s, t;

  /// Whether all techniques count, with MIS weights. A single chosen technique counts without a weight.
  bool are_weighted() const { return s < 0 && t < 0; }
  bool have(int from_light, int from_sensor) const {
    return (s < 0 || s == from_light) && (t < 0 || t == from_sensor);
  }
  /// Whether light paths with a second vertex count.
  bool need_light() const { return s != 0 && s != 1; }
  /// The pdfs of other techniques, or 0 where a single technique was chosen.
  Spectrum others(const Spectrum& pdfs) const { return are_weighted() ? pdfs : Spectrum(0.f); }
};

struct Settings {
  PathLimits limits;
  Techniques techniques;
};

}  // namespace aureole::bdpt

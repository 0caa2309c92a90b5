// SPDX-License-Identifier: Apache-2.0
// The first surface that ends a ray of `dvr`: the ray crosses null surfaces, which bound media.
#pragma once

#include <span>

#include "aureole/transport/batch.h"

namespace aureole {

/// Sets the distance along each ray to just before the first surface that is not null and lies before its t_max; infinity
/// if there is none. `rays` are at most kBatch, of unit directions.
void find_first_surfaces(const Scene& scene, std::span<const Ray> rays, RayTracer::Rays kind,
                         float distances[]);

}  // namespace aureole

// SPDX-License-Identifier: Apache-2.0
#include "aureole/transport/segment_chain.h"

#include "aureole/shape/geometry/outline.h"
#include "aureole/shape/mesh/mesh.h"
#include "aureole/transport/segment_diffraction.h"

namespace aureole {

bool is_flat(const SurfacePoint& point) {
  // Shading normals that are interpolated between equal normals differ from the face's normal by rounding.
  constexpr float kRounding = 1e-5f;
  if (length_squared(point.shading.n - point.ng) > kRounding * kRounding) return false;
  if (dynamic_cast<const Mesh*>(point.shape)) return true;
  const auto* round = dynamic_cast<const RoundShape*>(point.shape);
  return round && !round->is_curved();
}

const Spectrum& SegmentChain::factor(const Scene& scene, const Wavelengths& w) {
  if (!factor_) factor_ = chain_diffraction(scene, legs(), begins_at_infinity_, w);
  return *factor_;
}

}  // namespace aureole

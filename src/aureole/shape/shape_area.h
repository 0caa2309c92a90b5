// SPDX-License-Identifier: Apache-2.0
// Samples points uniformly over the whole surface of a shape.
#pragma once

#include <algorithm>
#include <memory>
#include <vector>

#include "aureole/shape/area_sampler.h"

namespace aureole {

class ShapeArea {
public:
  explicit ShapeArea(std::shared_ptr<const AreaSampler> sampler) : sampler_(std::move(sampler)), below_{0} {
    for (std::size_t i = 0; i < sampler_->patch_count(); ++i)
      below_.push_back(below_.back() + double(sampler_->patch_area(i)));
  }

  double area() const { return below_.back(); }

  /// Chooses the patch by its area with u.x, which is then rescaled to sample the point. `pdf` is per area of
  /// the whole surface [1/m^2].
  std::optional<ShapeSample> sample(Vec2 u) const {
    const double target = double(u.x) * area();
    const auto above = std::upper_bound(below_.begin() + 1, below_.end() - 1, target);
    const double first = *(above - 1), rest = (target - first) / (*above - first);
    const auto patch = std::size_t(above - below_.begin() - 1);
    auto s = sampler_->sample_area(patch, {float(std::clamp(rest, 0.0, 0x1.fffffep-1)), u.y});
    if (s) s->pdf *= float((*above - first) / area());
    return s;
  }

  /// Returns the sampler's point with these texture coordinates.
  std::optional<ShapeSample> point_at_uv(Vec2 uv) const { return sampler_->point_at_uv(uv); }

private:
  std::shared_ptr<const AreaSampler> sampler_;
  std::vector<double> below_;  ///< area of all patches before each one; the last entry is the total
};

}  // namespace aureole

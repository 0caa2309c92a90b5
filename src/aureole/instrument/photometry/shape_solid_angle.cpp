// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/photometry/shape_solid_angle.h"

#include <algorithm>
#include <cmath>

#include "aureole/core/error.h"
#include "aureole/core/random.h"
#include "aureole/math/warp.h"

namespace aureole {

TracedSolidAngle traced_solid_angle(const Scene& scene, const Vec3& p, const Vec3& normal, int samples,
                                    const std::function<void()>& between) {
  const Bounds3 box = scene.bounds();
  if (box.empty()) throw Error("the scene has no shape of which a solid angle could be known");
  const bool has_normal = length_squared(normal) > 0;
  const Vec3 n = has_normal ? normalize(normal) : Vec3{};
  const Vec3 to = box.center() - p;
  const double distance = double(length(to)), radius = 0.5 * double(length(box.diagonal())) * (1 + 1e-5);
  const bool is_outside = distance > radius;
  const Frame frame = Frame::from_normal(is_outside ? to * float(1 / distance) : Vec3{0, 0, 1});
  const double sine2 = is_outside ? radius * radius / (distance * distance) : 0;
  const float reach = is_outside ? float(sine2 / (1 + std::sqrt(1 - sine2))) : 2.f;
  constexpr int kRotations = 16;
  const int count = std::max(1, samples / kRotations);
  double sums[2] = {}, squares[2] = {};
  for (int r = 0; r < kRotations; ++r) {
    const std::uint64_t bits = combine_bits(0x501dull, std::uint64_t(r));
    const double shift_x = double(bits >> 40) * 0x1p-24, shift_y = double(bits & 0xffffff) * 0x1p-24;
    double hit = 0, weighted = 0;
    for (int i = 0; i < count; ++i) {
      if (between && i % 4096 == 0) between();
      // The additive lattice of the plastic number (M. Roberts 2018).
      const double x = shift_x + 0.7548776662466927 * i, y = shift_y + 0.5698402909980532 * i;
      const Vec2 u{float(std::min(x - std::floor(x), 0x1.fffffep-1)),
                   float(std::min(y - std::floor(y), 0x1.fffffep-1))};
      const Vec3 d = normalize(frame.to_world(square_to_uniform_cone(u, reach)));
      if (!scene.tracer().occluded({p, d, kInfinity})) continue;
      hit += 1;
      if (has_normal) weighted += std::max(0.0, double(dot(d, n)));
    }
    const double solid = 2 * M_PI * double(reach) / count;
    for (int k = 0; k < 2; ++k) {
      const double value = (k == 0 ? hit : weighted) * solid;
      sums[k] += value / kRotations, squares[k] += value * value / kRotations;
    }
  }
  const auto error = [&](int k) {
    return std::sqrt(std::max(0.0, squares[k] - sums[k] * sums[k]) / (kRotations - 1));
  };
  return {sums[0], sums[1], error(0), error(1)};
}

}  // namespace aureole

// SPDX-License-Identifier: Apache-2.0
#include "aureole/integrator/splat/ray_splats.h"

#include <algorithm>
#include <cmath>

#include "aureole/parameter/splat/spherical_harmonics.h"

namespace aureole {

RaySplats::RaySplats(std::span<const SplatMedium* const> media, const SplatSettings& settings) {
  std::vector<Bounds3> boxes;
  for (const SplatMedium* medium : media) {
    const SplatCloud& cloud = medium->cloud();
    const auto m = medium->to_world().matrix();
    const auto source = std::uint32_t(sources_.size());
    sources_.push_back({&cloud, medium->to_world().orthogonal_part().inverse()});
    const double cutoff = double(settings.cutoff > 0      ? settings.cutoff
                                 : cloud.hints.cutoff > 0 ? cloud.hints.cutoff
                                                          : 10.f / 3);
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      RaySplat s;
      s.opacity = cloud.opacities[i];
      if (!(s.opacity > 0) || s.opacity < settings.opacity_limit) continue;
      double k = cutoff;
      if (settings.opacity_limit > 0)
        k = std::min(k, std::sqrt(2 * std::log(double(s.opacity) / double(settings.opacity_limit))));
      const double longest = double(max_component(cloud.scales[i]));
      if (!(longest > 0) || !(k > 0)) continue;
      // A flat splat is seen as if it were 1/1000 of its longest scale thick.
      constexpr double kThinnest = 1e-3;
      const auto& q = cloud.rotations[i];
      const double w = double(q[0]), x = double(q[1]), y = double(q[2]), z = double(q[3]);
      const double r[3][3] = {{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
                              {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
                              {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}};
      Transform::Matrix a{};
      for (std::size_t axis = 0; axis < 3; ++axis)
        for (std::size_t row = 0; row < 3; ++row)
          for (std::size_t j = 0; j < 3; ++j)
            a[row][axis] +=
                m[row][j] * r[j][axis] * std::max(double(cloud.scales[i][int(axis)]), kThinnest * longest);
      a[3][3] = 1;
      const auto inverse = Transform(a).inverse().matrix();
      s.center = medium->to_world().point(cloud.positions[i]);
      Vec3 half;
      for (std::size_t row = 0; row < 3; ++row) {
        s.whiten[row] = {float(inverse[row][0]), float(inverse[row][1]), float(inverse[row][2])};
        half[int(row)] =
            float(k * std::sqrt(a[row][0] * a[row][0] + a[row][1] * a[row][1] + a[row][2] * a[row][2]) *
                  (1 + 1e-5));
      }
      // Room for the rounding of places along a ray, so that the cell of a peak lists its splat.
      half += Vec3{1, 1, 1} * (2e-5f * max_component(abs(s.center)));
      Bounds3 box;
      box.extend(s.center - half), box.extend(s.center + half);
      if (!is_finite(box.diagonal()) || !is_finite(s.whiten[0] + s.whiten[1] + s.whiten[2])) continue;
      s.limit = float(k * k), s.medium = source, s.index = std::uint32_t(i);
      splats_.push_back(s), boxes.push_back(box);
    }
  }
  if (splats_.empty()) return;
  cells_ = SplatCells(boxes);
  std::vector<float> bounds(cells_.count());
  for (std::size_t cell = 0; cell < bounds.size(); ++cell)
    bounds[cell] = cells_.entries(cell).empty() ? 0.f : 1.f;
  grid_.emplace(cells_.to_box(), cells_.size(), std::move(bounds));
}

void RaySplats::blend(const SplatSettings& settings, const Ray& ray, SplatSample& sample) const {
  std::fill_n(sample.color, 3, 0.f);
  sample.transmittance = 1, sample.distance = kInfinity;
  if (!grid_) return;
  struct Seen {
    float t, alpha;
    std::uint32_t splat;
  };
  std::vector<Seen> seen;
  std::vector<std::array<float, 16>> functions(sources_.size());
  for (std::size_t k = 0; k < sources_.size(); ++k)
    eval_harmonics(sources_[k].cloud->degree, normalize(sources_[k].turn.vector(ray.d)), functions[k].data());
  MajorantGrid::Walk walk(*grid_, ray, std::min(ray.t_max, 1e18f));
  MajorantGrid::Piece piece;
  while (walk.next(piece)) {
    const std::size_t cell = cells_.cell_of(ray.o + ray.d * (0.5f * (piece.begin + piece.end)));
    if (cell >= cells_.count()) continue;
    seen.clear();
    for (const std::uint32_t index : cells_.entries(cell)) {
      const RaySplat& s = splats_[index];
      const Vec3 a = s.whitened(ray.o - s.center), b = s.whitened(ray.d);
      const float bb = dot(b, b), t = -dot(a, b) / bb;
      // The peak lies in one cell, so that a splat is seen once.
      if (!(t >= piece.begin && t < piece.end) || !(t > settings.near)) continue;
      const float d2 = length_squared(a + b * t);
      if (!(d2 <= s.limit)) continue;
      const float alpha = std::min(settings.opacity_cap, s.opacity * std::exp(-0.5f * d2));
      if (alpha >= settings.opacity_limit) seen.push_back({t, alpha, index});
    }
    std::sort(seen.begin(), seen.end(),
              [](const Seen& a, const Seen& b) { return a.t != b.t ? a.t < b.t : a.splat < b.splat; });
    for (const Seen& one : seen) {
      const float left = sample.transmittance * (1 - one.alpha);
      if (left < settings.termination) return;
      const RaySplat& s = splats_[one.splat];
      const SplatCloud& cloud = *sources_[s.medium].cloud;
      const Vec3 c =
          harmonic_color(cloud.harmonics_of(s.index), functions[s.medium].data(), cloud.coefficients());
      for (int k = 0; k < 3; ++k) sample.color[k] += one.alpha * sample.transmittance * std::max(0.f, c[k]);
      sample.transmittance = left;
      if (left <= 0.5f && !(sample.distance < kInfinity)) sample.distance = one.t;
    }
  }
}

}  // namespace aureole

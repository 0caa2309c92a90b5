// SPDX-License-Identifier: Apache-2.0
#include "aureole/medium/radiance/grid_radiance.h"

#include <algorithm>
#include <cmath>

#include "aureole/core/parallel.h"
#include "aureole/parameter/splat/spherical_harmonics.h"

namespace aureole {

RadianceField::RadianceField(std::shared_ptr<const RadianceVoxels> voxels, const Transform& to_world,
                             float scale)
    : voxels_(std::move(voxels)), to_file_(to_world.inverse()), scale_(scale) {
  const RadianceVoxels& v = *voxels_;
  turn_ = to_world.orthogonal_part().inverse();
  // A voxel's index i has its centre at center + radius (2 (i + 1/2) / size - 1).
  const auto to_index = [&](int axis) {
    return double(v.size[std::size_t(axis)]) / (2 * double(v.radius[axis]));
  };
  const auto shift = [&](int axis) {
    return 0.5 * double(v.size[std::size_t(axis)]) * (1 - double(v.center[axis]) / double(v.radius[axis])) -
           0.5;
  };
  to_index_ = Transform::translate(shift(0), shift(1), shift(2)) *
              Transform::scale(to_index(0), to_index(1), to_index(2)) * to_file_;
  voxel_edge_ = kInfinity;
  const Transform back = to_index_.inverse();
  for (int axis = 0; axis < 3; ++axis)
    voxel_edge_ =
        std::min(voxel_edge_, length(back.vector({float(axis == 0), float(axis == 1), float(axis == 2)})));

  std::array<int, 3> cells;
  for (std::size_t k = 0; k < 3; ++k) cells[k] = v.size[k] + 1;
  const std::size_t nx = std::size_t(cells[0]), ny = std::size_t(cells[1]), nz = std::size_t(cells[2]);
  std::vector<float> bounds(nx * ny * nz, 0.f);
  for_ranges(
      ny * nz,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t row = begin; row < end; ++row)
          for (int x = 0; x < cells[0]; ++x) {
            const int y = int(row % ny), z = int(row / ny);
            float most = 0;
            for (int corner = 0; corner < 8; ++corner) {
              const auto clamped = [&](int i, std::size_t axis) {
                return std::clamp(i - 1, 0, v.size[axis] - 1);
              };
              const std::int32_t link =
                  v.links[v.link_index(clamped(x + (corner & 1), 0), clamped(y + (corner >> 1 & 1), 1),
                                       clamped(z + (corner >> 2), 2))];
              if (link >= 0) most = std::max(most, v.densities[std::size_t(link)]);
            }
            bounds[row * nx + std::size_t(x)] = most * (1 + 1e-5f);
          }
      },
      64);
  grid_.emplace(Transform::scale(1 / double(nx), 1 / double(ny), 1 / double(nz)) *
                    Transform::translate(1, 1, 1) * to_index_,
                cells, std::move(bounds));
}

RadianceField::View RadianceField::view_along(const Vec3& d) const {
  View view;
  eval_harmonics(voxels_->degree, normalize(turn_.vector(d)), view.functions);
  return view;
}

bool RadianceField::find_cell(const Vec3& index, Cell& cell) const {
  const RadianceVoxels& v = *voxels_;
  std::size_t low[3], high[3];
  float part[3];
  for (int axis = 0; axis < 3; ++axis) {
    const int n = v.size[std::size_t(axis)];
    const float x = index[axis];
    if (!(x >= -0.5f && x <= float(n) - 0.5f)) return false;
    const float within = std::clamp(x, 0.f, float(n - 1));
    const int i = std::min(int(within), std::max(0, n - 2));
    low[axis] = std::size_t(i), high[axis] = std::size_t(std::min(i + 1, n - 1));
    part[axis] = within - float(i);
  }
  const std::size_t ny = std::size_t(v.size[1]), nz = std::size_t(v.size[2]);
  bool any = false;
  for (int k = 0; k < 8; ++k) {
    const std::size_t x = k & 1 ? high[0] : low[0], y = k & 2 ? high[1] : low[1],
                      z = k & 4 ? high[2] : low[2];
    cell.links[k] = v.links[(x * ny + y) * nz + z];
    cell.weights[k] =
        (k & 1 ? part[0] : 1 - part[0]) * (k & 2 ? part[1] : 1 - part[1]) * (k & 4 ? part[2] : 1 - part[2]);
    any |= cell.links[k] >= 0;
  }
  return any;
}

float RadianceField::raw_density(const Cell& cell) const {
  float sum = 0;
  for (int k = 0; k < 8; ++k)
    if (cell.links[k] >= 0) sum += cell.weights[k] * voxels_->densities[std::size_t(cell.links[k])];
  return sum;
}

Vec3 RadianceField::raw_color(const Cell& cell, const View& view) const {
  const std::size_t terms = voxels_->coefficients();
  Vec3 sum{0.5f, 0.5f, 0.5f};
  for (int k = 0; k < 8; ++k) {
    if (cell.links[k] < 0 || cell.weights[k] == 0) continue;
    const float* h = voxels_->harmonics_of(std::size_t(cell.links[k]));
    Vec3 at;
    for (std::size_t i = 0; i < terms; ++i)
      at += Vec3{h[3 * i], h[3 * i + 1], h[3 * i + 2]} * view.functions[i];
    sum += at * cell.weights[k];
  }
  return sum;
}

std::optional<std::array<float, 2>> RadianceField::cross_box(const Ray& ray) const {
  const Vec3 o = index_of(ray.o), d = index_vector(ray.d);
  float begin = 0, end = ray.t_max;
  for (int axis = 0; axis < 3; ++axis) {
    const float low = -0.5f - o[axis], high = float(voxels_->size[std::size_t(axis)]) - 0.5f - o[axis];
    if (d[axis] == 0) {
      if (low > 0 || high < 0) return {};
      continue;
    }
    const float a = low / d[axis], b = high / d[axis];
    begin = std::max(begin, std::min(a, b)), end = std::min(end, std::max(a, b));
  }
  if (!(end > begin)) return {};
  return std::array{begin, end};
}

}  // namespace aureole

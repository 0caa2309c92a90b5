// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/bake/radiance_bake.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "aureole/core/parallel.h"
#include "aureole/instrument/bake/surface_light.h"

namespace aureole {

RadianceBake bake_radiance_grid(const LoadedScene& loaded, const RadianceBakeOptions& options) {
  const SurfaceLight light(loaded, options.exposure, options.seed);
  RadianceBake bake;
  bake.area = light.area(), bake.notes = light.notes();
  RadianceVoxels& g = bake.voxels;
  g.degree = options.degree;

  // Points find the box of the surfaces; a margin of two voxels holds the neighbours of those at its border.
  Bounds3 box;
  constexpr std::size_t kFirstPoints = 1 << 16;
  for (std::size_t i = 0; i < kFirstPoints; ++i)
    if (const auto point = light.point(i, kFirstPoints)) box.extend(point->p);
  const Vec3 extent = box.diagonal();
  const float longest = max_component(extent);
  if (!(longest > 0) || !std::isfinite(longest)) throw Error("the surfaces to bake have no extent");
  constexpr int kMargin = 2;
  const float edge = longest / float(options.resolution);
  for (int axis = 0; axis < 3; ++axis) {
    // One voxel more than the extent has, so that walls at its ends pass through the middle of voxels.
    constexpr float kRounding = 1e-3f;
    const int n = std::max(0, int(std::ceil(extent[axis] / edge - kRounding))) + 1 + 2 * kMargin;
    g.size[std::size_t(axis)] = n;
    g.radius[axis] = 0.5f * float(n) * edge;
    g.center[axis] = 0.5f * (box.lower[axis] + box.upper[axis]);
  }
  const Vec3 lower = g.center - g.radius;
  const auto voxel_of = [&](const Vec3& p, int at[3]) {
    for (int axis = 0; axis < 3; ++axis)
      at[axis] = std::clamp(int((p[axis] - lower[axis]) / edge), 0, g.size[std::size_t(axis)] - 1);
  };

  // Some 24 points for each voxel that a surface can pass, numbered by the voxel that they lie in.
  constexpr double kPointsPerArea = 24, kMostPoints = 1e8;
  const double wanted = kPointsPerArea * light.area() / (double(edge) * double(edge));
  if (wanted > kMostPoints)
    throw Error(fmt::format(
        "needs {:.3g} points of the surfaces to find their voxels; {:g} are possible: bake with a "
        "lower resolution",
        wanted, kMostPoints));
  const std::size_t count = std::max(kFirstPoints, std::size_t(wanted));
  std::vector<std::uint64_t> voxel_of_point(count);
  std::vector<Vec3> place_of_point(count);  // in voxels from the corner of the box
  constexpr std::uint64_t kNone = ~std::uint64_t(0);
  for_ranges(count, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto point = light.point(i, count);
      int at[3];
      if (point) voxel_of(point->p, at), place_of_point[i] = (point->p - lower) * (1 / edge);
      voxel_of_point[i] = point ? g.link_index(at[0], at[1], at[2]) : kNone;
    }
  });
  // Points of each voxel, in the order of the points.
  std::vector<std::uint32_t> order(count);
  for (std::size_t i = 0; i < count; ++i) order[i] = std::uint32_t(i);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return voxel_of_point[a] != voxel_of_point[b] ? voxel_of_point[a] < voxel_of_point[b] : a < b;
  });
  g.links.assign(std::size_t(g.size[0]) * std::size_t(g.size[1]) * std::size_t(g.size[2]), -1);
  std::vector<std::size_t> first;  // of each occupied voxel's points in `order`
  for (std::size_t k = 0; k < count; ++k) {
    const std::uint64_t voxel = voxel_of_point[order[k]];
    if (voxel == kNone) break;
    if (k == 0 || voxel != voxel_of_point[order[k - 1]]) {
      g.links[voxel] = std::int32_t(first.size());
      first.push_back(k);
    }
  }
  bake.occupied = first.size();
  std::size_t points_end = count;
  while (points_end > 0 && voxel_of_point[order[points_end - 1]] == kNone) --points_end;
  first.push_back(points_end);

  // Voxels without a point in them: those around voxels with points, and then those around the former that get a density.
  struct Neighbour {
    std::size_t voxel;
    std::int32_t link;
  };
  std::vector<Neighbour> neighbours;
  const auto place_of = [&](std::size_t voxel, int at[3]) {
    const std::size_t ny = std::size_t(g.size[1]), nz = std::size_t(g.size[2]);
    at[0] = int(voxel / nz / ny), at[1] = int(voxel / nz % ny), at[2] = int(voxel % nz);
  };
  const auto for_neighbours = [&](std::size_t voxel, const auto& visit) {
    int at[3];
    place_of(voxel, at);
    for (int k = 0; k < 27; ++k) {
      const int i = at[0] + k % 3 - 1, j = at[1] + k / 3 % 3 - 1, l = at[2] + k / 9 - 1;
      if (i >= 0 && j >= 0 && l >= 0 && i < g.size[0] && j < g.size[1] && l < g.size[2])
        visit(g.link_index(i, j, l));
    }
  };
  const auto occupied = std::int32_t(bake.occupied);
  const auto store_neighbours = [&](std::size_t of) {
    for_neighbours(of, [&](std::size_t voxel) {
      if (g.links[voxel] >= 0) return;
      const auto link = occupied + std::int32_t(neighbours.size());
      g.links[voxel] = link;
      neighbours.push_back({voxel, link});
    });
  };
  for (std::size_t v = 0; v < bake.occupied; ++v) store_neighbours(voxel_of_point[order[first[v]]]);
  const std::size_t nearest = neighbours.size();

  // Densities: the area of each point is distributed over the eight voxels around it by the weights of trilinear interpolation,
  // so that the interpolated density follows the surface without steps, and its integral across a plane is the thickness,
  // however the plane is turned.
  const float per_point = options.thickness * float(light.area() / double(count)) / (edge * edge * edge),
              least = 0.01f * options.thickness / edge;
  g.densities.assign(bake.occupied + nearest, 0.f);
  for_ranges(g.densities.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      const std::size_t voxel =
          v < bake.occupied ? voxel_of_point[order[first[v]]] : neighbours[v - bake.occupied].voxel;
      int at[3];
      place_of(voxel, at);
      float sum = 0;
      for_neighbours(voxel, [&](std::size_t other) {
        const std::int32_t link = g.links[other];
        if (link < 0 || link >= occupied) return;
        for (std::size_t k = first[std::size_t(link)]; k < first[std::size_t(link) + 1]; ++k) {
          float weight = 1;
          for (int axis = 0; axis < 3; ++axis)
            weight *= std::max(0.f, 1 - std::abs(place_of_point[order[k]][axis] - 0.5f - float(at[axis])));
          sum += weight;
        }
      });
      const float density = per_point * sum;
      g.densities[v] = density > least ? density : 0.f;
    }
  });
  for (std::size_t v = 0; v < nearest; ++v)
    if (g.densities[bake.occupied + v] > 0) store_neighbours(neighbours[v].voxel);

  const std::size_t stored = bake.occupied + neighbours.size(), numbers = 3 * g.coefficients();
  g.densities.resize(stored);
  std::fill(g.densities.begin() + std::ptrdiff_t(bake.occupied + nearest), g.densities.end(), 0.f);
  g.harmonics.assign(stored * numbers, 0.f);
  std::vector<std::uint32_t> lost(bake.occupied, 0);
  for_ranges(
      bake.occupied,
      [&](std::size_t begin, std::size_t end) {
        SurfaceLight::Samples samples;
        for (std::size_t v = begin; v < end; ++v) {
          samples.clear();
          const std::size_t points = first[v + 1] - first[v];
          const std::uint64_t voxel = voxel_of_point[order[first[v]]];
          // Paths are shared among the points of the voxel, in blocks of a batch.
          const int paths = options.paths;
          const int at_once =
              std::max(1, paths / int(std::min<std::size_t>(points, std::size_t(std::max(1, paths / 4)))));
          std::size_t turn = 0;
          for (int done = 0; done < paths; done += at_once, ++turn) {
            const std::size_t k = first[v] + turn * points / std::size_t((paths + at_once - 1) / at_once);
            const auto point = light.point(order[k], count);
            if (!point) continue;
            constexpr float kStart = 0.05f;
            light.add_samples(*point, voxel, done, std::min(at_once, paths - done), kStart * edge, samples);
          }
          lost[v] = std::uint32_t(samples.lost);
          fit_encoded_harmonics(options.degree, samples, &g.harmonics[numbers * v]);
        }
      },
      16);
  // The colours of the others are the means of those beside them: of voxels with points, then of the nearest.
  for (std::size_t v = 0; v < neighbours.size(); ++v) {
    const Neighbour& n = neighbours[v];
    const std::int32_t before = v < nearest ? occupied : occupied + std::int32_t(nearest);
    float* out = &g.harmonics[numbers * std::size_t(n.link)];
    int found = 0;
    for_neighbours(n.voxel, [&](std::size_t voxel) {
      const std::int32_t link = g.links[voxel];
      if (link < 0 || link >= before) return;
      ++found;
      for (std::size_t k = 0; k < numbers; ++k) out[k] += g.harmonics[numbers * std::size_t(link) + k];
    });
    for (std::size_t k = 0; k < numbers; ++k) out[k] /= float(found);
  }
  std::size_t all_lost = 0;
  for (const std::uint32_t n : lost) all_lost += n;
  if (all_lost > 0)
    bake.notes.push_back(fmt::format("{} paths had no finite light and are left out", all_lost));
  return bake;
}

}  // namespace aureole

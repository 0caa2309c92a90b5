// SPDX-License-Identifier: Apache-2.0
// Edges and faces in beams of a city of blocks, 12 triangles each, every block turned by an angle of its own.
#include <benchmark/benchmark.h>

#include <cmath>
#include <random>

#include "aureole/scene/edge/edge_index.h"

namespace aureole {
namespace {

EdgeIndex city(int blocks) {
  std::vector<Vec3> positions;
  std::vector<TriangleIndices> triangles;
  std::mt19937 random(1);
  std::uniform_real_distribution<float> unit;
  const int side = int(std::ceil(std::sqrt(double(blocks))));
  for (int block = 0; block < blocks; ++block) {
    const float x = 40.f * float(block % side), y = 40.f * float(block / side),
                height = 5 + 60 * unit(random), turn = unit(random);
    const auto first = std::uint32_t(positions.size());
    for (int i = 0; i < 8; ++i) {
      const float angle = turn + kPi / 2 * float(i % 4);
      positions.push_back({x + 12 * std::cos(angle), y + 12 * std::sin(angle), i < 4 ? 0 : height});
    }
    const auto quad = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
      triangles.push_back({first + a, first + b, first + c});
      triangles.push_back({first + a, first + c, first + d});
    };
    quad(3, 2, 1, 0), quad(4, 5, 6, 7);
    for (std::uint32_t i = 0; i < 4; ++i) quad(i, (i + 1) % 4, (i + 1) % 4 + 4, i + 4);
  }
  const TriangleSet set{positions, triangles};
  return EdgeIndex(std::span(&set, 1));
}

/// Arguments: radius of the beam and half its depth, in cm; blocks.
void edges_in_beam(benchmark::State& state) {
  const EdgeIndex index = city(int(state.range(1)));
  std::mt19937 random(2);
  std::uniform_real_distribution<float> unit;
  const float radius = 0.01f * float(state.range(0));
  std::size_t edges = 0, faces = 0;
  for (auto _ : state) {
    // About a point on a wall.
    const EdgeIndex::Face& face = index.faces()[std::size_t(unit(random) * float(index.faces().size() - 1))];
    const float z = 2 * unit(random) - 1, phi = 2 * kPi * unit(random), r = std::sqrt(1 - z * z);
    const Beam beam{(face.p[0] + face.p[1] + face.p[2]) * (1.f / 3),
                    {r * std::cos(phi), r * std::sin(phi), z},
                    radius,
                    -radius,
                    radius};
    index.visit_edges(beam, [&](const MeshEdge& e) { benchmark::DoNotOptimize(&e), ++edges; });
    index.visit_faces(beam, [&](const EdgeIndex::Face& f) { benchmark::DoNotOptimize(&f), ++faces; });
  }
  state.counters["edges"] = benchmark::Counter(double(edges), benchmark::Counter::kAvgIterations);
  state.counters["faces"] = benchmark::Counter(double(faces), benchmark::Counter::kAvgIterations);
  state.counters["MB"] = double(index.memory_bytes()) * 1e-6;
}
BENCHMARK(edges_in_beam)->ArgsProduct({{1, 225, 3000}, {834, 83334}})->Unit(benchmark::kMicrosecond);

void build_index(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(city(int(state.range(0))).edges().size());
}
BENCHMARK(build_index)->Arg(83334)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace aureole

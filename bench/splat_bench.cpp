// SPDX-License-Identifier: Apache-2.0
// Frames of splats at 640 x 360 by all cores: projection, sorting and listing by tiles; blending of all pixels; both, a frame. And
// sorting alone. The splats cover a torus knot twice, as thin discs of equal area.
#include <benchmark/benchmark.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <random>

#include "aureole/core/parallel.h"
#include "aureole/integrator/splat/depth_sort.h"
#include "aureole/integrator/splat/splat_blend.h"
#include "tests/harness/properties_builder.h"
#include "tests/medium/splat_test_support.h"

namespace aureole {
namespace {

constexpr int kWidth = 640, kHeight = 360;

std::vector<test::PlainSplat> knot(int count) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> turn(0, 2 * M_PI);
  std::vector<test::PlainSplat> splats;
  const auto curve = [](double t) {
    return std::array{(std::sin(t) + 2 * std::sin(2 * t)) / 3, (std::cos(t) - 2 * std::cos(2 * t)) / 3,
                      -std::sin(3 * t) / 3};
  };
  const double radius = 0.22, scale = 0.55 * std::sqrt(2 * M_PI * radius * 12 / count);
  for (int i = 0; i < count; ++i) {
    const double t = turn(random), a = turn(random);
    const auto p = curve(t), q = curve(t + 1e-4);
    const Vec3 along = normalize({float(q[0] - p[0]), float(q[1] - p[1]), float(q[2] - p[2])});
    const Frame frame = Frame::from_normal_tangent(along, {0.3f, 0.2f, 1});
    const Vec3 n = frame.s * float(std::cos(a)) + frame.t * float(std::sin(a));
    test::PlainSplat s;
    for (int k = 0; k < 3; ++k) s.position[std::size_t(k)] = p[std::size_t(k)] + radius * double(n[k]);
    s.position[2] += 3.2;
    s.scale = {scale, scale, 0.1 * scale};
    const double w = std::sqrt(std::max(1e-6, 0.5 * (1 + double(n.z))));
    s.rotation = {w, -double(n.y) / (2 * w), double(n.x) / (2 * w), 0};
    s.opacity = 0.9;
    s.color = {0.5 + 0.4 * std::cos(t), 0.5 + 0.4 * std::cos(t - 2), 0.5 + 0.4 * std::cos(t + 2)};
    s.rest.assign(15, {0.05, -0.05, 0.02});
    splats.push_back(s);
  }
  return splats;
}

struct Stage {
  std::shared_ptr<const SplatMedium> medium;
  SplatSettings settings;
  SplatConventions conventions;
  PinholeView view;
  FilmPart part;

  explicit Stage(int count) {
    const test::SplatFolder folder;
    const auto file = folder.write("knot.ply", test::make_ply(knot(count)));
    medium = testing::build<SplatMedium>(
        R"(<medium type="splats"><string name="filename" value="knot.ply"/></medium>)",
        testing::make_context(), [&](const std::string&) { return file; });
    settings = SplatSettings::read(Properties("splat", "", {}, testing::make_context(),
                                              Registry::instance().find("integrator", "splat")));
    const SplatMedium* one = medium.get();
    conventions = SplatConventions::of({&one, 1}, settings, medium->properties());
    // The file's axes are turned by half a turn about x: so is the camera.
    view.to_camera = Transform::scale(1, -1, -1);
    view.center = {kWidth / 2, kHeight / 2}, view.focal = 400;
    part.width = kWidth, part.height = kHeight, part.upper = {kWidth, kHeight};
  }
  ProjectedSplats project() const {
    const SplatMedium* one = medium.get();
    return {{&one, 1}, settings, conventions, view, part, 0, 0};
  }
  float blend(const ProjectedSplats& splats) const {
    std::vector<float> rows(kHeight);
    for_ranges(
        kHeight,
        [&](std::size_t begin, std::size_t end) {
          for (std::size_t y = begin; y < end; ++y)
            for (int x = 0; x < kWidth; x += kSplatLanes) {
              SplatSample samples[kSplatLanes];
              for (int k = 0; k < kSplatLanes; ++k) samples[k].film = {float(x + k) + 0.5f, float(y) + 0.5f};
              blend_splats(splats, settings, samples);
              rows[y] += samples[0].color[0] + samples[7].transmittance;
            }
        },
        16);
    return rows[kHeight / 2];
  }
};

const Stage& stage(int count) {
  static std::map<int, std::unique_ptr<Stage>> stages;
  auto& s = stages[count];
  if (!s) s = std::make_unique<Stage>(count);
  return *s;
}

void splat_project(benchmark::State& state) {
  const Stage& s = stage(int(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(s.project().entry_count());
}
void splat_blend(benchmark::State& state) {
  const Stage& s = stage(int(state.range(0)));
  const ProjectedSplats splats = s.project();
  for (auto _ : state) benchmark::DoNotOptimize(s.blend(splats));
  state.counters["splats_per_tile"] = double(splats.entry_count()) / (kWidth / 16 * ((kHeight + 15) / 16));
}
void splat_frame(benchmark::State& state) {
  const Stage& s = stage(int(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(s.blend(s.project()));
}
void splat_sort(benchmark::State& state) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> depth(0.2f, 100);
  std::vector<float> depths(std::size_t(state.range(0)));
  for (float& d : depths) d = depth(random);
  for (auto _ : state) benchmark::DoNotOptimize(sort_by_depth(depths).data());
}

BENCHMARK(splat_project)->Arg(100000)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(splat_blend)->Arg(100000)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(splat_frame)->Arg(100000)->Arg(1000000)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(splat_sort)->Arg(1000000)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace aureole

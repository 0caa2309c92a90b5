// SPDX-License-Identifier: Apache-2.0
// Nanoseconds per look-up in grids of N^3 voxels, at points along rays: 16 points, two voxels apart, then another ray.
#include <benchmark/benchmark.h>

#include <cmath>
#include <memory>
#include <vector>

#include "aureole/core/random.h"
#include "aureole/plugin/array.h"
#include "aureole/plugin/registry.h"
#include "aureole/volume/volume.h"
#include "tests/harness/properties_builder.h"

namespace aureole {
namespace {

constexpr int kPoints = 1 << 16;

float number(std::uint64_t i) { return unit_float(std::uint32_t(mix_bits(i + 1))); }

/// In [0, 1]^3.
std::vector<Vec3> points_along_rays(int n) {
  std::vector<Vec3> points;
  for (std::uint64_t ray = 0; points.size() < kPoints; ++ray) {
    const Vec3 o{number(8 * ray), number(8 * ray + 1), number(8 * ray + 2)};
    const Vec3 d =
        normalize(Vec3{number(8 * ray + 3) - .5f, number(8 * ray + 4) - .5f, number(8 * ray + 5) - .5f});
    for (int i = 0; i < 16; ++i) {
      const Vec3 p = o + d * (2 * float(i) / float(n));
      points.push_back({std::min(std::max(p.x, 0.f), 1.f), std::min(std::max(p.y, 0.f), 1.f),
                        std::min(std::max(p.z, 0.f), 1.f)});
    }
  }
  return points;
}

std::shared_ptr<const Volume> make_grid(int n, int channels) {
  std::vector<double> values(std::size_t(n) * std::size_t(n) * std::size_t(n) * std::size_t(channels));
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = double(number(i));
  std::vector<std::size_t> shape(3, std::size_t(n));
  if (channels > 1) shape.push_back(std::size_t(channels));
  const PluginInfo* plugin = Registry::instance().find("volume", "gridvolume");
  Properties p("gridvolume", "", {}, testing::make_context(), plugin);
  p.add("data", ObjectPtr(std::make_shared<Array>(shape, std::move(values))), {});
  return std::dynamic_pointer_cast<const Volume>(plugin->create(p));
}

void grid(benchmark::State& state, int channels) {
  const int n = int(state.range(0));
  const auto volume = make_grid(n, channels);
  const std::vector<Vec3> points = points_along_rays(n);
  const Wavelengths w =
      Wavelengths::at(SpectralGrid::over(360, 830), make_spectrum([](int i) { return 380 + 50 * float(i); }));
  std::size_t i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(volume->eval(points[i], w));
    i = (i + 1) % kPoints;
  }
}
void grey_grid(benchmark::State& state) { grid(state, 1); }
void color_grid(benchmark::State& state) { grid(state, 3); }

/// Trilinear interpolation in an array with a border of one voxel, in the order of the axes.
void plain_array(benchmark::State& state) {
  const int n = int(state.range(0));
  const std::ptrdiff_t sy = n + 2, sz = sy * (n + 2);
  std::vector<float> values(std::size_t(sz * (n + 2)));
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = number(i);
  const std::vector<Vec3> points = points_along_rays(n);
  std::size_t i = 0;
  for (auto _ : state) {
    const Vec3 p = points[i] * float(n) + Vec3{.5f, .5f, .5f};
    const float x = std::floor(p.x), y = std::floor(p.y), z = std::floor(p.z);
    const float* v = values.data() + int(x) + int(y) * sy + int(z) * sz;
    const auto along_x = [&](const float* q) { return q[0] + (q[1] - q[0]) * (p.x - x); };
    const auto along_y = [&](const float* q) {
      const float a = along_x(q);
      return a + (along_x(q + sy) - a) * (p.y - y);
    };
    const float a = along_y(v);
    benchmark::DoNotOptimize(Spectrum(a + (along_y(v + sz) - a) * (p.z - z)));
    i = (i + 1) % kPoints;
  }
}

BENCHMARK(plain_array)->Arg(64)->Arg(128)->Arg(256);
BENCHMARK(grey_grid)->Arg(64)->Arg(128)->Arg(256);
BENCHMARK(color_grid)->Arg(64)->Arg(128);

}  // namespace
}  // namespace aureole

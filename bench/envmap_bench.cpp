// SPDX-License-Identifier: Apache-2.0
// Nanoseconds per look-up in an environment map of 1024 x 512 colours, in random directions, and per light sample.
#include <benchmark/benchmark.h>

#include <memory>
#include <vector>

#include "aureole/core/random.h"
#include "aureole/emitter/light.h"
#include "aureole/plugin/array.h"
#include "aureole/plugin/registry.h"
#include "tests/harness/properties_builder.h"

namespace aureole {
namespace {

constexpr int kWidth = 1024, kHeight = 512;
constexpr std::size_t kDirections = 1 << 14;

float number(std::uint64_t i) { return unit_float(std::uint32_t(mix_bits(i + 1))); }

/// A map of random colours, each in [0, 1].
std::shared_ptr<const Emitter> make_map() {
  std::vector<double> values(std::size_t(kWidth) * kHeight * 3);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = double(number(i));
  const PluginInfo* plugin = Registry::instance().find("emitter", "envmap");
  Properties p("envmap", "", {}, testing::make_context(), plugin);
  p.add("data",
        ObjectPtr(std::make_shared<Array>(std::vector<std::size_t>{kHeight, kWidth, 3}, std::move(values))),
        {});
  return std::dynamic_pointer_cast<const Emitter>(plugin->create(p));
}

Wavelengths wavelengths() {
  return Wavelengths::at(SpectralGrid::over(360, 830),
                         make_spectrum([](int i) { return 380 + 50 * float(i); }));
}

void envmap_eval(benchmark::State& state) {
  const auto map = make_map();
  std::vector<Vec3> directions;
  for (std::uint64_t i = 0; i < kDirections; ++i)
    directions.push_back(
        normalize(Vec3{number(3 * i) - .5f, number(3 * i + 1) - .5f, number(3 * i + 2) - .5f}));
  const Wavelengths w = wavelengths();
  std::size_t i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(map->eval_escaped(directions[i], w));
    i = (i + 1) % kDirections;
  }
}

void envmap_sample(benchmark::State& state) {
  const auto map = make_map();
  Light light;
  light.emitter = map.get();
  const Wavelengths w = wavelengths();
  std::uint64_t i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        light.sample_direct_facing({}, {0, 1, 0}, 0, {number(2 * i), number(2 * i + 1)}, w));
    ++i;
  }
}

BENCHMARK(envmap_eval);
BENCHMARK(envmap_sample);

}  // namespace
}  // namespace aureole

// SPDX-License-Identifier: Apache-2.0
// Nanoseconds per evaluation of `measured` with a file that exceeds the caches of a processor, beside those of
// `roughconductor`: an anisotropic material of 13 x 8 directions of incidence and 195 wavelengths, 85 MB. Its values are
// smooth functions; their time does not depend on them. `random`: each pair of directions is drawn anew. `picture`:
// directions of view follow the rows of a picture of a sphere, and half of the other ones are sampled from the BSDF.
#include <benchmark/benchmark.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "aureole/bsdf/bsdf.h"
#include "aureole/bsdf/measured/rgl_file.h"
#include "aureole/core/random.h"
#include "aureole/math/warp.h"
#include "aureole/spectrum/observer.h"
#include "aureole/spectrum/wavelength_choice.h"
#include "tests/harness/properties_builder.h"

namespace aureole {
namespace {

float uniform(std::uint64_t i) { return unit_float(std::uint32_t(mix_bits(i + 1))); }

RglFile::Table smooth_table(std::size_t slices, std::size_t size, float power) {
  RglFile::Table table{size, size, {}};
  for (std::size_t s = 0; s < slices; ++s)
    for (std::size_t y = 0; y < size; ++y)
      for (std::size_t x = 0; x < size; ++x) {
        const float u = float(x) / float(size - 1), v = float(y) / float(size - 1);
        table.values.push_back(std::pow(u, power) * std::exp(-16 * u * u * u * u) *
                                   (1.2f + std::sin(2 * kPi * v + float(s))) +
                               1e-3f);
      }
  return table;
}

/// Writes the file and removes it at the end of the program.
class LargeFile {
public:
  LargeFile() : path_(std::filesystem::temp_directory_path() / "aureole_measured_bench.bsdf") {
    RglFile file;
    constexpr std::size_t kAzimuths = 13, kAngles = 8, kChannels = 195, kSize = 32;
    constexpr std::size_t kSlices = kAzimuths * kAngles;
    for (std::size_t i = 0; i < kAzimuths; ++i)
      file.phi_i.push_back(kPi * (2 * float(i) / float(kAzimuths - 1) - 1));
    for (std::size_t i = 0; i < kAngles; ++i) file.theta_i.push_back(1.4f * float(i) / float(kAngles - 1));
    for (std::size_t i = 0; i < kChannels; ++i)
      file.nm.push_back(360 + 640 * float(i) / float(kChannels - 1));
    file.ndf = smooth_table(1, 64, 0), file.sigma = smooth_table(1, 64, 0);
    file.vndf = smooth_table(kSlices, 64, 3), file.luminance = smooth_table(kSlices, kSize, 0);
    file.spectra.reserve(kSlices * kChannels * kSize * kSize);
    for (std::size_t s = 0; s < kSlices; ++s)
      for (std::size_t c = 0; c < kChannels; ++c)
        for (std::size_t i = 0; i < kSize * kSize; ++i)
          file.spectra.push_back(0.3f + 0.1f * std::sin(0.05f * float(c) + 0.1f * float(s)) +
                                 1e-4f * float(i));
    std::ofstream(path_, std::ios::binary) << rgl_file_content(file);
  }
  ~LargeFile() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  LargeFile(const LargeFile&) = delete;
  LargeFile& operator=(const LargeFile&) = delete;
  const std::filesystem::path& path() const { return path_; }

private:
  std::filesystem::path path_;
};

std::shared_ptr<Bsdf> measured() {
  static const LargeFile file;
  static const std::shared_ptr<Bsdf> bsdf = testing::build<Bsdf>(
      R"(<bsdf type="measured"><string name="filename" value=")" + file.path().string() + R"("/></bsdf>)");
  return bsdf;
}

std::shared_ptr<Bsdf> roughconductor() {
  static const std::shared_ptr<Bsdf> bsdf =
      testing::build<Bsdf>(R"(<bsdf type="roughconductor"><string name="material" value="Al"/>
      <string name="distribution" value="ggx"/><float name="alpha" value="0.2"/></bsdf>)");
  return bsdf;
}

/// Wavelengths as a scene under daylight draws them for a colour film.
WavelengthDistribution film_wavelengths(const SpectralGrid& grid) {
  const std::array<SampledSpectrum, 3> xyz = observer_xyz(grid);
  std::vector<float> sum(xyz[0].nodes().size());
  for (const SampledSpectrum& channel : xyz)
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += channel.nodes()[i];
  const SampledSpectrum light = d65_spectrum(grid, 1);
  return choose_wavelengths({grid, sum}, xyz, {&light, 1});
}

constexpr std::uint64_t kSets = 256;  // sets of wavelengths, few enough to stay in the L2 cache

enum class Directions { random, picture };

struct Inputs {
  Inputs(const Bsdf& bsdf, Directions directions) {
    constexpr std::uint64_t kWidth = 128, kHeight = 8, kSamples = 16;  // pixels in rows, samples of each
    const auto context = testing::make_context();
    const WavelengthDistribution distribution = film_wavelengths(context->grid);
    const SurfacePoint point;
    for (std::uint64_t i = 0; i < kWidth * kHeight * kSamples; ++i) {
      const Vec2 u{uniform(4 * i), uniform(4 * i + 1)}, v{uniform(4 * i + 2), uniform(4 * i + 3)};
      if (i < kSets) wavelengths.push_back(distribution.sample(uniform(i + (1 << 20))));
      if (directions == Directions::random) {
        wi.push_back(square_to_cosine_hemisphere(u));
      } else {
        // The sphere's point behind the pixel; dp/du runs around the vertical axis.
        const std::uint64_t pixel = i / kSamples;
        const float x = 1.8f * (float(pixel % kWidth) + u.x) / float(kWidth) - 0.9f,
                    y = 0.1f * (float(pixel / kWidth) + u.y) / float(kHeight) + 0.2f;
        const Vec3 n = normalize(Vec3{x, y, std::sqrt(1 - x * x - y * y)});
        const Vec3 s = normalize(Vec3{n.z, 0, -n.x}), t = cross(n, s);
        wi.push_back({s.z, t.z, n.z});
      }
      wo.push_back(square_to_cosine_hemisphere(v));
      if (i % 2 == 0) continue;
      const BsdfContext ctx{wavelengths[i % kSets], point, TransportMode::radiance, std::uint32_t(i)};
      if (const auto sampled = bsdf.sample(wi.back(), 0.5f, v, ctx)) wo.back() = sampled->wo;
    }
  }
  std::vector<Vec3> wi, wo;
  std::vector<Wavelengths> wavelengths;
};

template <class Function>
void run(benchmark::State& state, const std::shared_ptr<Bsdf>& bsdf, Directions directions,
         const Function& function) {
  const Inputs in(*bsdf, directions);
  const SurfacePoint point;
  std::size_t i = 0;
  for (auto _ : state) {
    const BsdfContext ctx{in.wavelengths[i % kSets], point, TransportMode::radiance, std::uint32_t(i)};
    benchmark::DoNotOptimize(function(*bsdf, in.wi[i], in.wo[i], ctx));
    i = (i + 1) % in.wi.size();
  }
}

void eval(benchmark::State& state, const std::shared_ptr<Bsdf>& bsdf, Directions directions) {
  run(state, bsdf, directions, [](const Bsdf& b, const Vec3& wi, const Vec3& wo, const BsdfContext& ctx) {
    return b.eval(wi, wo, ctx);
  });
}

void eval_pdf(benchmark::State& state, const std::shared_ptr<Bsdf>& bsdf, Directions directions) {
  run(state, bsdf, directions, [](const Bsdf& b, const Vec3& wi, const Vec3& wo, const BsdfContext& ctx) {
    return b.eval_pdf(wi, wo, ctx);
  });
}

void sample(benchmark::State& state, const std::shared_ptr<Bsdf>& bsdf, Directions directions) {
  run(state, bsdf, directions, [](const Bsdf& b, const Vec3& wi, const Vec3& wo, const BsdfContext& ctx) {
    return b.sample(wi, 0.5f, {0.5f + 0.5f * wo.x, 0.5f + 0.5f * wo.y}, ctx);
  });
}

void rough_random_eval(benchmark::State& state) { eval(state, roughconductor(), Directions::random); }
void rough_random_eval_pdf(benchmark::State& state) { eval_pdf(state, roughconductor(), Directions::random); }
void rough_picture_eval(benchmark::State& state) { eval(state, roughconductor(), Directions::picture); }
void rough_picture_eval_pdf(benchmark::State& state) {
  eval_pdf(state, roughconductor(), Directions::picture);
}
void measured_random_eval(benchmark::State& state) { eval(state, measured(), Directions::random); }
void measured_random_eval_pdf(benchmark::State& state) { eval_pdf(state, measured(), Directions::random); }
void measured_picture_eval(benchmark::State& state) { eval(state, measured(), Directions::picture); }
void measured_picture_eval_pdf(benchmark::State& state) { eval_pdf(state, measured(), Directions::picture); }

void rough_random_sample(benchmark::State& state) { sample(state, roughconductor(), Directions::random); }
void rough_picture_sample(benchmark::State& state) { sample(state, roughconductor(), Directions::picture); }
void measured_random_sample(benchmark::State& state) { sample(state, measured(), Directions::random); }
void measured_picture_sample(benchmark::State& state) { sample(state, measured(), Directions::picture); }

BENCHMARK(rough_random_eval)->Name("roughconductor, random/eval");
BENCHMARK(rough_random_eval_pdf)->Name("roughconductor, random/eval_pdf");
BENCHMARK(rough_picture_eval)->Name("roughconductor, picture/eval");
BENCHMARK(rough_picture_eval_pdf)->Name("roughconductor, picture/eval_pdf");
BENCHMARK(measured_random_eval)->Name("measured, 85 MB, random/eval");
BENCHMARK(measured_random_eval_pdf)->Name("measured, 85 MB, random/eval_pdf");
BENCHMARK(measured_picture_eval)->Name("measured, 85 MB, picture/eval");
BENCHMARK(measured_picture_eval_pdf)->Name("measured, 85 MB, picture/eval_pdf");
BENCHMARK(rough_random_sample)->Name("roughconductor, random/sample");
BENCHMARK(rough_picture_sample)->Name("roughconductor, picture/sample");
BENCHMARK(measured_random_sample)->Name("measured, 85 MB, random/sample");
BENCHMARK(measured_picture_sample)->Name("measured, 85 MB, picture/sample");

}  // namespace
}  // namespace aureole

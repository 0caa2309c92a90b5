// SPDX-License-Identifier: Apache-2.0
// Light tracing and two-way paths find what the path tracer finds: estimators without a common line but for the models,
// compared per pixel by z-test on scenes that each show one mode (tests/render/scenes/ptracer-*.xml). And its
// splats make the same picture, bit for bit, for any number of threads, across interruptions, for parts
// merged.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <thread>

#include "aureole/render/job.h"
#include "aureole/render/output.h"
#include "aureole/render/statistics.h"
#include "harness/effort.h"
#include "harness/paths.h"
#include "loading/load_text.h"
#include "render/small_scene.h"

namespace aureole::test {
namespace {

const std::atomic<bool> kGo{false};

RenderState rendered(const LoadedScene& scene, const RenderOptions& options) {
  RenderJob job(scene, options);
  EXPECT_EQ(job.run(kGo), RenderJob::Outcome::finished);
  EXPECT_EQ(job.state().invalid_samples, 0u);
  return job.state();
}

class LightTracing : public ::testing::TestWithParam<const char*> {};

/// The picture's mean luminance and its standard error, from the replicates: pixels and channels of one are
/// correlated.
std::pair<double, double> mean_luminance(const RenderState& state) {
  double sum = 0, squares = 0;
  const auto total = [](const FilmBuffer& film) {
    double luminance = 0, measured[3], alpha;
    for (int y = 0; y < film.height(); ++y)
      for (int x = 0; x < film.width(); ++x) film.mean(x, y, measured, &alpha), luminance += measured[1];
    return luminance / (double(film.width()) * film.height());
  };
  for (std::size_t r = 0; r < state.films.size(); ++r) {
    double luminance = total(state.films[r]);
    if (!state.splats.empty()) luminance += total(state.splats[r]);
    sum += luminance, squares += luminance * luminance;
  }
  const double n = double(state.films.size()), mean = sum / n;
  return {mean, std::sqrt(std::max(0.0, squares / n - mean * mean) / (n - 1))};
}

TEST_P(LightTracing, AgreesWithPathTracing) {
  const auto file = source_dir() / "tests/render/scenes" / (std::string("ptracer-") + GetParam() + ".xml");
  RenderOptions options;
  options.replicates = kSanitized ? 2 : 32;
  const double more_noise = effort(2.0, 1.0);  // than with all samples
  // A sixteenth is as quiet in scenes without glass, gloss and lenses, an eighth in some more.
  const std::string name = GetParam();
  const bool is_quiet = name == "area" || name == "border" || name == "depth" || name == "constant" ||
                        name == "envmap" || name == "mask" || name == "beams";
  const int part = is_quiet ? 16 : name == "point" || name == "smooth" || name == "lenses" ? 8 : 4;
  const auto traced = [&](const char* integrator, std::uint64_t seed) {
    LoadOptions load;
    load.defines = {{"integrator", integrator}};
    options.seed = seed;
    const LoadedScene scene = load_scene(file, load);
    const std::int64_t samples = scene.scene->sensor().sampler().sample_count() / effort(part, 1);
    const bool two_way = integrator == std::string("bdpt");  // needs fewer samples
    options.end = kSanitized ? 16 : two_way ? std::min<std::int64_t>(samples, effort(16, 64)) : samples;
    return rendered(scene, options);
  };
  // Of different seeds: both find a background with the same samples.
  const RenderState reference = traced("path", 1);
  const auto [mean_b, error_b] = mean_luminance(reference);
  for (const char* integrator : {"ptracer", "bdpt"}) {
    if (!kSanitized && integrator == std::string("bdpt")) {
      // Glass seen in glass is found by rare events only, whose pixels are not normally distributed.
      if (name == "smooth" || name == "glass") continue;
    }
    const RenderState state = traced(integrator, 0);
    if (kSanitized) continue;
    const Image picture = state.picture();
    const Comparison c = compare_images(picture, reference.picture());
    ASSERT_TRUE(c.z);
    const auto [mean_a, error_a] = mean_luminance(state);
    const double error = std::hypot(error_a, error_b);
    std::printf("%-8s %-10s mean of z^2 %.3f, outside %.3f %%, mean %+.2f standard errors (%+.3f %%)\n",
                integrator, GetParam(), c.z->mean_square, 100 * c.z->outside, (mean_a - mean_b) / error,
                100 * (mean_a / mean_b - 1));
    EXPECT_GE(c.z->mean_square, kZMeanSquareMin) << integrator;
    EXPECT_LE(c.z->mean_square, kZMeanSquareMax) << integrator;
    EXPECT_LE(c.z->outside, kZOutsideMax) << integrator;
    EXPECT_NEAR(mean_a, mean_b, 4 * error) << integrator;
    // The noise must be small enough for the comparison to mean something.
    EXPECT_LT(error, more_noise * 0.003 * mean_b) << integrator;
    double noise = 0;
    for (const char* channel : {"variance.R", "variance.G", "variance.B"})
      for (int y = 0; y < picture.height; ++y)
        for (int x = 0; x < picture.width; ++x)
          noise += std::sqrt(picture.at(x, y, size_t(picture.channel(channel))));
    EXPECT_LT(noise / (3.0 * picture.width * picture.height), more_noise * 0.05 * c.mean_b) << integrator;
  }
}

INSTANTIATE_TEST_SUITE_P(All, LightTracing,
                         ::testing::Values("area", "border", "depth", "point", "constant", "envmap", "hide",
                                           "smooth", "glass", "inside", "rough", "mask", "lenses", "beams"),
                         [](const auto& info) { return std::string(info.param); });

// Sensors of one value, with the light that falls on a wall and the light that leaves the scene.
TEST(LightTracingMeters, AgreeWithPathTracing) {
  const std::string ball =
      R"(<shape type="sphere"><point name="center" x="0.3" y="0" z="0.8"/><float name="radius" value="0.5"/>
         <bsdf type="diffuse"><rgb name="reflectance" value="0.8, 0.5, 0.3"/></bsdf></shape>
         <emitter type="point"><point name="position" x="0.5" y="-0.5" z="2"/></emitter>
         <emitter type="constant"><rgb name="radiance" value="0.1, 0.2, 0.3"/></emitter>)";
  const std::string parts = R"(<sampler type="sobol"><integer name="sample_count" value="16384"/></sampler>)";
  const std::string scenes[] = {
      R"(<shape type="rectangle"><bsdf type="diffuse"/><sensor type="irradiancemeter">)" + parts +
          "</sensor></shape>" + ball,
      R"(<shape type="rectangle"><bsdf type="diffuse"/></shape>
         <sensor type="distant"><vector name="direction" x="0.2" y="0.3" z="-1"/>)" +
          parts + "</sensor>" + ball};
  for (const std::string& scene : scenes) {
    RenderOptions options;
    options.replicates = kSanitized ? 2 : 32;
    if (kSanitized) options.end = 16;
    const auto measured = [&](const char* integrator, std::uint64_t seed) {
      options.seed = seed;
      LoadOptions load;
      load.integrator = integrator;
      const Image image = rendered(load_scene_from_string(R"(<scene version="3.0.0">)" + scene + "</scene>",
                                                          "meter.xml", load),
                                   options)
                              .picture();
      return std::pair(double(image.at(0, 0, size_t(image.channel("G")))),
                       double(image.at(0, 0, size_t(image.channel("variance.G")))));
    };
    const auto [expected, variance] = measured("path", 1);
    for (const char* integrator : {"ptracer", "bdpt"}) {
      const auto [mean, own_variance] = measured(integrator, 0);
      if (kSanitized) continue;
      const double error = std::sqrt(own_variance + variance);
      EXPECT_NEAR(mean, expected, 4.5 * error) << integrator << scene;
      EXPECT_LT(error, 3e-3 * expected) << integrator << scene;
    }
  }
}

// Light that only paths from emitters find: a beam of irradiance 1 from a square straight down to the floor.
TEST(LightTracingBeam, OfADirectionalAreaHasItsIrradiance) {
  for (const char* integrator : {"ptracer", "bdpt"}) {
    LoadOptions load;
    load.integrator = integrator;
    const auto scene = load_scene_from_string(
        R"(<scene version="3.0.0">
         <sensor type="perspective"><float name="fov" value="20"/>
           <transform name="to_world"><lookat origin="0, 0, 4" target="0, 0, 0" up="0, 1, 0"/></transform>
           <sampler type="sobol"><integer name="sample_count" value="16384"/></sampler>
           <film type="hdrfilm"><integer name="width" value="6"/><integer name="height" value="4"/>
           <string name="pixel_format" value="luminance"/><rfilter type="box"/></film></sensor>
         <shape type="rectangle"><transform name="to_world"><scale value="3"/></transform>
           <bsdf type="diffuse"><spectrum name="reflectance" value="0.6"/></bsdf></shape>
         <shape type="rectangle"><transform name="to_world"><rotate x="1" angle="180"/><translate z="5"/></transform>
           <emitter type="directionalarea"><spectrum name="radiance" value="1"/></emitter></shape></scene>)",
        "beam.xml", load);
    const Image image = rendered(scene, {}).picture();
    double mean = 0;
    for (const float v : image.pixels) mean += v / double(image.pixels.size());
    EXPECT_NEAR(mean, 0.6 / 3.14159265, 0.01 * 0.6 / 3.14159265) << integrator;
  }
}

LoadedScene small_light_scene(const std::string& extra_film = "") {
  LoadOptions load;
  load.integrator = "ptracer";
  return load_scene_from_string(small_scene_text(40, 28, extra_film), "small.xml", load);
}

TEST(FilmBuffer, FixedPointIsExactAndTruncates) {
  const auto expect_same = [](float x) {
    EXPECT_TRUE(to_fixed(x) == Fixed(double(x) * 0x1p64)) << x;
    EXPECT_TRUE(to_fixed(-x) == Fixed(double(-x) * 0x1p64)) << -x;
  };
  for (const float x :
       {0.f, 1.f, 0x1p-64f, 0x1.8p-64f, 0x1.fffffep-65f, 0x1.8p-60f, 0x1p-126f, 1e-42f, 0x1.fffffep59f})
    expect_same(x);
  std::uint32_t bits = 12345;
  for (int i = 0; i < 100000; ++i) {
    bits = bits * 1664525u + 1013904223u;
    const float x = std::bit_cast<float>(bits & 0x7fffffffu);
    if (x < kFixedLimit) expect_same(x);
  }
}

TEST(LightTracingJob, ThreadsDoNotChangeABit) {
  for (const char* film :
       {"", R"(<boolean name="sample_border" value="true"/>)",
        R"(<integer name="crop_offset_x" value="5"/><integer name="crop_offset_y" value="3"/>
           <integer name="crop_width" value="21"/><integer name="crop_height" value="18"/>)"}) {
    RenderOptions options;
    options.threads = 1;
    const RenderState one = rendered(small_light_scene(film), options);
    for (int threads : {2, 8}) {
      options.threads = threads;
      EXPECT_TRUE(same_bits(one, rendered(small_light_scene(film), options))) << threads << " " << film;
    }
  }
}

TEST(LightTracingJob, PartsMergeToTheWhole) {
  const auto scene = small_light_scene();
  RenderOptions options;
  options.replicates = 2;
  const RenderState whole = rendered(scene, options);
  options.begin = 0, options.end = 16;
  RenderState sum = rendered(scene, options);
  options.begin = 16, options.end = 48;
  sum.merge(rendered(scene, options));
  EXPECT_TRUE(same_bits(whole, sum));
}

TEST(LightTracingJob, InterruptedAndResumed) {
  const TemporaryFolder folder;
  const auto scene = small_light_scene();
  RenderOptions options;
  const RenderState whole = rendered(scene, options);
  options.state_file = folder.path / "job.state";
  const int interruptions = render_interrupted(
      scene, options, [&](const RenderJob& job) { EXPECT_TRUE(same_bits(whole, job.state())); });
  EXPECT_GT(interruptions, 0);
}

// A picture of some units has the brightness of the whole, since weights count the paths there are.
TEST(LightTracingJob, PartOfAPictureIsNotDark) {
  const TemporaryFolder folder;
  const auto scene = small_light_scene();
  RenderOptions options;
  options.threads = 1;
  options.end = 4096;
  options.state_file = folder.path / "job.state";
  RenderJob job(scene, options);
  std::atomic<bool> stop{false};
  std::thread breaker([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(kSanitized ? 2000 : 300));
    stop = true;
  });
  const auto outcome = job.run(stop);
  breaker.join();
  ASSERT_EQ(outcome, RenderJob::Outcome::interrupted);
  const std::int64_t done = job.state().units_done();
  ASSERT_GT(done, 0);
  options.end = 64;
  options.state_file.clear();
  const auto mean = [](const Image& image) {
    double sum = 0;
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x) sum += image.at(x, y, size_t(image.channel("G")));
    return sum / (image.width * image.height);
  };
  const double whole = mean(rendered(scene, options).picture());
  EXPECT_NEAR(mean(job.state().picture()), whole, 0.15 * whole) << done << " units";
  for (const float a : {job.state().picture().at(3, 4, 3), job.state().picture().at(39, 27, 3)})
    EXPECT_EQ(a, 1.f) << "alpha";
}

TEST(LightTracingJob, ReplayShowsThePathOfASample) {
  const auto scene = small_light_scene();
  RenderOptions options;
  RenderJob job(scene, options);
  EXPECT_EQ(job.integrator().leaves(), Integrator::Leaves::film);
  int lines = 0;
  size_t numbers = 0;
  for (int x = 0; x < 40; ++x)
    numbers += job.replay(x, 14, 0, 0, [&](const PathEvent&) { ++lines; }).splatted.size();
  EXPECT_GT(lines, 40) << "at least the emission of each";
  EXPECT_GT(numbers, 0u);
  EXPECT_EQ(numbers % 3, 0u);
}

TEST(LightTracingJob, IsBlackWithoutLights) {
  const auto scene = load_scene_from_string(
      R"(<scene version="3.0.0"><integrator type="ptracer"/><sensor type="perspective"><film type="hdrfilm">
         <integer name="width" value="4"/><integer name="height" value="4"/></film></sensor>
         <shape type="sphere"/></scene>)",
      "dark.xml");
  for (const float v : rendered(scene, {}).picture().pixels) EXPECT_EQ(v, 0.f);
}

}  // namespace
}  // namespace aureole::test

// SPDX-License-Identifier: Apache-2.0
// Light tracing finds what the path tracer finds: two estimators without a common line but for the models,
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
#include "harness/paths.h"
#include "render/small_scene.h"
#include "scene/load_text.h"

namespace aureole::test {
namespace {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kSanitized = true;  // run, without statistics
#else
constexpr bool kSanitized = false;
#endif

const std::atomic<bool> kGo{false};

RenderState rendered(const std::shared_ptr<const Scene>& scene, const RenderOptions& options) {
  RenderJob job(scene, options);
  EXPECT_EQ(job.run(kGo), RenderJob::Outcome::finished);
  EXPECT_EQ(job.state().invalid_samples, 0u);
  return job.state();
}

class LightTracing : public ::testing::TestWithParam<const char*> {};

TEST_P(LightTracing, AgreesWithPathTracing) {
  const auto file = source_dir() / "tests/render/scenes" / (std::string("ptracer-") + GetParam() + ".xml");
  RenderOptions options;
  options.replicates = kSanitized ? 2 : 32;
  if (kSanitized) options.end = 16;
  Image pictures[2];  // of different seeds: both find a background with the same samples
  for (int i = 0; i < 2; ++i) {
    LoadOptions load;
    options.seed = std::uint64_t(i);
    load.defines = {{"integrator", i == 0 ? "ptracer" : "path"}};
    pictures[i] = rendered(std::make_shared<const Scene>(load_scene(file, load)), options).picture();
  }
  if (kSanitized) return;
  const Comparison c = compare_images(pictures[0], pictures[1]);
  ASSERT_TRUE(c.z);
  std::printf("%-10s mean of z^2 %.3f, outside %.3f %%, mean %+.2f standard errors (%+.3f %%)\n", GetParam(),
              c.z->mean_square, 100 * c.z->outside, c.z->mean_difference, 100 * c.z->mean_relative);
  EXPECT_TRUE(c.z->passes);
  // Noise below 5 % of the mean: a test that can see something.
  double noise = 0;
  for (const char* channel : {"variance.R", "variance.G", "variance.B"})
    for (int y = 0; y < pictures[0].height; ++y)
      for (int x = 0; x < pictures[0].width; ++x)
        noise += std::sqrt(pictures[0].at(x, y, size_t(pictures[0].channel(channel))));
  EXPECT_LT(noise / (3.0 * pictures[0].width * pictures[0].height), 0.05 * c.mean_b);
}

INSTANTIATE_TEST_SUITE_P(All, LightTracing,
                         ::testing::Values("area", "border", "depth", "point", "constant", "envmap", "hide",
                                           "smooth", "glass", "inside", "rough", "mask"),
                         [](const auto& info) { return std::string(info.param); });

std::shared_ptr<const Scene> small_light_scene(const std::string& extra_film = "") {
  LoadOptions load;
  load.integrator = "ptracer";
  return std::make_shared<const Scene>(
      load_scene_from_string(small_scene_text(40, 28, extra_film), "small.xml", load));
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
  int interruptions = 0;
  for (bool finished = false; !finished;) {
    RenderJob job(scene, options);
    if (std::filesystem::exists(options.state_file)) job.resume(RenderState::load(options.state_file));
    std::atomic<bool> stop{false};
    std::thread breaker([&] {
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
      stop = interruptions < 5;
    });
    finished = job.run(stop) == RenderJob::Outcome::finished;
    breaker.join();
    if (finished)
      EXPECT_TRUE(same_bits(whole, job.state()));
    else
      ++interruptions;
  }
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
  EXPECT_TRUE(job.traces_light());
  int lines = 0;
  size_t numbers = 0;
  for (int x = 0; x < 40; ++x)
    numbers += job.replay(x, 14, 0, 0, [&](const std::string&) { ++lines; })->size();
  EXPECT_GT(lines, 40) << "at least the emission of each";
  EXPECT_GT(numbers, 0u);
  EXPECT_EQ(numbers % 3, 0u);
}

TEST(LightTracingJob, IsBlackWithoutLights) {
  const auto scene = std::make_shared<const Scene>(load_scene_from_string(
      R"(<scene version="3.0.0"><integrator type="ptracer"/><sensor type="perspective"><film type="hdrfilm">
         <integer name="width" value="4"/><integer name="height" value="4"/></film></sensor>
         <shape type="sphere"/></scene>)",
      "dark.xml"));
  for (const float v : rendered(scene, {}).picture().pixels) EXPECT_EQ(v, 0.f);
}

}  // namespace
}  // namespace aureole::test

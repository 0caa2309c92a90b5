// SPDX-License-Identifier: Apache-2.0
// Pictures are equal bit for bit: for any number of threads, across interruptions, for parts merged.
#include <gtest/gtest.h>

#include "harness/paths.h"
#include "loading/load_text.h"
#include "render/small_scene.h"

namespace aureole::test {
namespace {

const std::atomic<bool> kGo{false};

RenderState rendered(const RenderOptions& options, const std::string& extra_film = "") {
  RenderJob job(small_scene(40, 28, extra_film), options);
  EXPECT_EQ(job.run(kGo), RenderJob::Outcome::finished);
  return job.state();
}

TEST(Determinism, ThreadsDoNotChangeABit) {
  for (
      const char* film :
      {"", R"(<boolean name="sample_border" value="true"/>)",
       R"(<integer name="crop_offset_x" value="5"/><integer name="crop_offset_y" value="3"/><integer name="crop_width" value="21"/><integer name="crop_height" value="18"/>)"}) {
    RenderOptions options;
    options.threads = 1;
    const RenderState one = rendered(options, film);
    for (int threads : {2, 8}) {
      options.threads = threads;
      EXPECT_TRUE(same_bits(one, rendered(options, film))) << threads << " threads " << film;
    }
    EXPECT_EQ(one.invalid_samples, 0u);
  }
}

TEST(Determinism, ThreadsDoNotChangeABitOfDiffractedLight) {
  for (const char* integrator : {"path", "ptracer", "bdpt"}) {
    const auto state = [&](int threads, const char* diffraction) {
      LoadOptions load;
      load.defines = {{"integrator", integrator}, {"diffraction", diffraction}};
      RenderOptions options;
      options.threads = threads, options.replicates = 2, options.end = 96;
      RenderJob job(load_scene(source_dir() / "tests/render/scenes/diffraction-block.xml", load), options);
      EXPECT_EQ(job.run(kGo), RenderJob::Outcome::finished);
      return job.state();
    };
    const RenderState one = state(1, "true");
    EXPECT_TRUE(same_bits(one, state(2, "true"))) << integrator;
    EXPECT_FALSE(same_bits(one, state(1, "false"))) << integrator << ": there is no diffracted light";
  }
}

TEST(Determinism, SeedsAndReplicatesDiffer) {
  RenderOptions options;
  const RenderState a = rendered(options);
  options.seed = 1;
  EXPECT_FALSE(same_bits(a, rendered(options)));
  options.seed.reset();
  options.replicates = 2;
  const RenderState two = rendered(options);
  EXPECT_EQ(two.films[0].data(), a.films[0].data()) << "replicate 0 is the plain picture";
  EXPECT_NE(two.films[1].data(), a.films[0].data());
}

TEST(Determinism, PartsMergeToTheWhole) {
  RenderOptions options;
  const RenderState whole = rendered(options);
  options.begin = 0, options.end = 16;
  RenderState sum = rendered(options);
  options.begin = 32, options.end = 48;
  sum.merge(rendered(options));
  EXPECT_LT(sum.units_done(), sum.units()) << "a gap is left";
  EXPECT_EQ(sum.samples_everywhere(), 32);
  options.begin = 16, options.end = 32;
  sum.merge(rendered(options));
  EXPECT_EQ(sum.samples_everywhere(), 48);
  EXPECT_TRUE(same_bits(whole, sum));
}

TEST(Determinism, MergeRefusesOverlapsAndStrangers) {
  RenderOptions options;
  options.end = 32;
  RenderState a = rendered(options);
  options.begin = 16, options.end = 48;
  EXPECT_THROW(a.merge(rendered(options)), Error);
  options.begin = 32;
  options.seed = 7;
  EXPECT_THROW(a.merge(rendered(options)), Error);
  options.seed.reset();
  RenderJob other(small_scene(41, 28), options);
  other.run(kGo);
  EXPECT_THROW(a.merge(other.state()), Error);
  options.begin = 8;
  EXPECT_THROW(RenderJob(small_scene(), options), Error) << "parts start at multiples of the block";
}

TEST(Determinism, InterruptedAndResumed) {
  const TemporaryFolder folder;
  RenderOptions options;
  const RenderState whole = rendered(options);
  options.state_file = folder.path / "job.state";
  const int interruptions = render_interrupted(small_scene(), options, [&](const RenderJob& job) {
    EXPECT_TRUE(same_bits(whole, job.state()));
    job.remove_state();
    EXPECT_FALSE(std::filesystem::exists(options.state_file)) << "a finished job leaves no state";
  });
  EXPECT_GT(interruptions, 0);
}

TEST(Determinism, TimeLimitEndsOnWholeBlocksAndResumes) {
  const TemporaryFolder folder;
  RenderOptions options;
  const RenderState whole = rendered(options);
  options.state_file = folder.path / "job.state";
  options.time_limit_s = 1e-6;
  RenderJob job(small_scene(), options);
  EXPECT_EQ(job.run(kGo), RenderJob::Outcome::time_limit);
  EXPECT_EQ(job.state().samples_everywhere(), 16);
  EXPECT_EQ(job.state().units_done(), job.state().units_per_block());
  options.time_limit_s = 0;
  RenderJob rest(small_scene(), options);
  rest.resume(RenderState::load(options.state_file));
  EXPECT_EQ(rest.run(kGo), RenderJob::Outcome::finished);
  EXPECT_TRUE(same_bits(whole, rest.state()));
}

TEST(Determinism, ResumeRefusesAnotherPicture) {
  RenderOptions options;
  const RenderState a = rendered(options);
  options.seed = 3;
  RenderJob job(small_scene(), options);
  EXPECT_THROW(job.resume(a), Error);
}

TEST(Determinism, ReplayShowsWhatTheJobSaw) {
  // One sample per pixel with a box filter: the replayed sample is the pixel.
  std::string text = small_scene_text();
  text.replace(text.find("<rfilter type=\"gaussian\"/>"), 26, "<rfilter type=\"box\"/>");
  const auto scene = load_scene_from_string(text, "small.xml");
  RenderOptions options;
  options.end = 1;
  RenderJob job(scene, options);
  job.run(kGo);
  for (int x : {3, 17, 30}) {
    int lines = 0;
    const auto measured = job.replay(x, 14, 0, 0, [&](const PathEvent&) { ++lines; });
    double expected[3], alpha;
    job.state().films[0].mean(x, 14, expected, &alpha);
    EXPECT_GT(lines, 0);
    ASSERT_TRUE(measured.valid);
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(measured.measured[size_t(c)], expected[c], 1e-6 * (1 + expected[c]));
  }
}

}  // namespace
}  // namespace aureole::test

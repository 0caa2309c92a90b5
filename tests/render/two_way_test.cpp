// SPDX-License-Identifier: Apache-2.0
// One job for paths that leave light on their own pixel and anywhere else: `bdpt` makes the same picture, bit for
// bit, however the work is divided, and each of its techniques finds what the others find.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "aureole/render/job.h"
#include "aureole/render/statistics.h"
#include "loading/load_text.h"
#include "render/small_scene.h"

namespace aureole::test {
namespace {

const std::atomic<bool> kGo{false};

LoadedScene load(const std::string& text, const char* integrator) {
  LoadOptions options;
  options.integrator = integrator;
  return load_scene_from_string(text, "two_way.xml", options);
}

LoadedScene two_way(const std::string& text) { return load(text, "bdpt"); }

RenderState rendered(const LoadedScene& scene, const RenderOptions& options) {
  RenderJob job(scene, options);
  EXPECT_EQ(job.run(kGo), RenderJob::Outcome::finished);
  EXPECT_EQ(job.state().invalid_samples, 0u);
  return job.state();
}

/// Without glass and point lights, which some techniques do not find.
const std::string kDiffuse = R"(<scene version="3.0.0">
<sensor type="perspective"><float name="fov" value="50"/>
  <transform name="to_world"><lookat origin="0, 1, 4" target="0, .5, 0" up="0, 1, 0"/></transform>
  <sampler type="independent"><integer name="sample_count" value="256"/></sampler>
  <film type="hdrfilm"><integer name="width" value="16"/><integer name="height" value="11"/>
    <string name="component_format" value="float32"/><rfilter type="gaussian"/></film></sensor>
<shape type="rectangle"><transform name="to_world"><scale value="3"/><rotate x="1" angle="-90"/></transform>
  <bsdf type="diffuse"><rgb name="reflectance" value=".7, .5, .3"/></bsdf></shape>
<shape type="sphere"><point name="center" x="0" y="0.5" z="0"/><float name="radius" value="0.5"/></shape>
<shape type="rectangle"><transform name="to_world"><rotate x="1" angle="90"/><translate y="2.5"/></transform>
  <emitter type="area"><rgb name="radiance" value="8, 7, 5"/></emitter></shape>
</scene>)";

TEST(TwoWayJob, AgreesWithThePathTracer) {
  RenderOptions options;
  options.replicates = 32;
  const RenderState both = rendered(two_way(kDiffuse), options);
  options.seed = 7;
  const RenderState reference = rendered(load(kDiffuse, "path"), options);
  const Comparison c = compare_images(both.picture(), reference.picture());
  ASSERT_TRUE(c.z);
  std::printf("mean of z^2 %.3f, outside %.3f %%, mean %+.2f standard errors (%+.3f %%)\n", c.z->mean_square,
              100 * c.z->outside, c.z->mean_difference, 100 * c.z->mean_relative);
  EXPECT_TRUE(c.z->passes);
  double splatted = 0, alpha;
  std::vector<double> measured(3);
  for (int x = 0; x < 16; ++x) {
    both.splats[0].mean(x, 8, measured.data(), &alpha);
    splatted += measured[1];
  }
  EXPECT_GT(splatted, 0) << "the floor";
}

// Light that is scattered twice before it reaches the sensor, by each of the four techniques that find it alone.
TEST(TwoWayTechniques, EachFindsWhatTheOthersFind) {
  const auto only = [](int s, int t) {
    std::string text = kDiffuse;
    // Off the floor: where they touch, connections of near points have an unbounded variance.
    const std::string touching = R"(y="0.5" z="0")";
    text.replace(text.find(touching), touching.size(), R"(y="1.2" z="0")");
    text.insert(text.find("<sensor"),
                fmt::format(R"(<integrator type="bdpt"><integer name="strategy_s" value="{}"/>
      <integer name="strategy_t" value="{}"/></integrator>)",
                            s, t));
    RenderOptions options;
    options.replicates = 32, options.end = 256, options.seed = std::uint64_t(s);
    return rendered(load_scene_from_string(text, "technique.xml"), options).picture();
  };
  const Image reference = only(1, 3);
  for (const int s : {0, 2, 3}) {
    const Comparison c = compare_images(only(s, 4 - s), reference);
    ASSERT_TRUE(c.z);
    std::printf("s = %d: mean of z^2 %.3f, outside %.3f %%, mean %+.2f standard errors (%+.3f %%)\n", s,
                c.z->mean_square, 100 * c.z->outside, c.z->mean_difference, 100 * c.z->mean_relative);
    // Paths that hit the lamp by chance are so rare that pixels are not normally distributed.
    if (s != 0) {
      EXPECT_TRUE(c.z->passes) << s;
    }
    EXPECT_LT(std::abs(c.z->mean_difference), 4) << s;
    EXPECT_LT(c.rmse, 0.2 * c.mean_b) << s;
  }
}

// Single techniques for an irradiance meter on the floor, whose point a connection samples on the surface.
TEST(TwoWayTechniques, EachFindsWhatAMeterMeasures) {
  const auto only = [](int s, int t) {
    const std::string text = fmt::format(
        R"(<scene version="3.0.0">
<integrator type="bdpt"><integer name="strategy_s" value="{}"/><integer name="strategy_t" value="{}"/></integrator>
<shape type="rectangle"><transform name="to_world"><rotate x="1" angle="-90"/></transform>
  <bsdf type="diffuse"/><sensor type="irradiancemeter"><sampler type="independent"/></sensor></shape>
<shape type="sphere"><point name="center" x="0.2" y="1.2" z="0"/><float name="radius" value="0.5"/></shape>
<shape type="rectangle"><transform name="to_world"><rotate x="1" angle="90"/><translate y="2.5"/></transform>
  <emitter type="area"/></shape></scene>)",
        s, t);
    RenderOptions options;
    options.replicates = 32, options.end = 8192, options.seed = std::uint64_t(s);
    const Image picture = rendered(load_scene_from_string(text, "meter.xml"), options).picture();
    return std::pair(double(picture.at(0, 0, size_t(picture.channel("G")))),
                     double(picture.at(0, 0, size_t(picture.channel("variance.G")))));
  };
  const auto [expected, variance] = only(1, 3);
  for (const int s : {0, 2, 3}) {
    const auto [mean, own_variance] = only(s, 4 - s);
    const double error = std::sqrt(own_variance + variance);
    std::printf("s = %d: %.5f of %.5f, %+.2f standard errors\n", s, mean, expected,
                (mean - expected) / error);
    EXPECT_NEAR(mean, expected, 4 * error) << s;
    EXPECT_LT(error, 0.05 * expected) << s;
  }
}

TEST(TwoWayTechniques, ThoseThatNothingFindsAreErrors) {
  for (const char* parameters :
       {R"(<integer name="strategy_t" value="0"/>)",
        R"(<integer name="strategy_t" value="1"/><integer name="strategy_s" value="1"/>)",
        R"(<integer name="strategy_s" value="-2"/>)"}) {
    std::string text = kDiffuse;
    // Off the floor: where they touch, connections of near points have an unbounded variance.
    const std::string touching = R"(y="0.5" z="0")";
    text.replace(text.find(touching), touching.size(), R"(y="1.2" z="0")");
    text.insert(text.find("<sensor"),
                std::string("<integrator type=\"bdpt\">") + parameters + "</integrator>");
    EXPECT_THROW(load_scene_from_string(text, "technique.xml"), Error) << parameters;
  }
}

TEST(TwoWayJob, ThreadsPartsAndFilesDoNotChangeABit) {
  const TemporaryFolder folder;
  const auto scene = two_way(small_scene_text());
  RenderOptions options;
  options.replicates = 2;
  options.threads = 1;
  const RenderState one = rendered(scene, options);
  EXPECT_GT(one.identity.splat_channels, 0);
  options.threads = 8;
  EXPECT_TRUE(same_bits(one, rendered(scene, options)));

  options.begin = 0, options.end = 16;
  RenderState sum = rendered(scene, options);
  sum.save(folder.path / "part.state");
  sum = RenderState::load(folder.path / "part.state");
  options.begin = 16, options.end = 48;
  sum.merge(rendered(scene, options));
  EXPECT_TRUE(same_bits(one, sum));
}

TEST(TwoWayJob, InterruptedAndResumed) {
  const TemporaryFolder folder;
  const auto scene = two_way(small_scene_text());
  RenderOptions options;
  const RenderState whole = rendered(scene, options);
  options.state_file = folder.path / "job.state";
  const int interruptions = render_interrupted(
      scene, options, [&](const RenderJob& job) { EXPECT_TRUE(same_bits(whole, job.state())); });
  EXPECT_GT(interruptions, 0);
}

TEST(TwoWayJob, ReplayShowsThePixelAndTheSplats) {
  const auto scene = two_way(small_scene_text());
  RenderJob job(scene, {});
  std::size_t splatted = 0, lines = 0;
  for (int x = 0; x < 40; ++x) {
    const ReplayedSample s = job.replay(x, 14, 5, 0, [&](const PathEvent&) { ++lines; });
    EXPECT_TRUE(s.valid);
    EXPECT_EQ(s.measured.size(), 3u);
    splatted += s.splatted.size();
  }
  EXPECT_GT(lines, 40u);
  EXPECT_GT(splatted, 0u);
}

}  // namespace
}  // namespace aureole::test

// SPDX-License-Identifier: Apache-2.0
// Adaptive sampling: where its samples go, that the picture's expectation does not change, and that its bits
// do not depend on threads, interruptions or parts.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numeric>
#include <thread>

#include "aureole/render/sample_density.h"
#include "aureole/render/statistics.h"
#include "harness/effort.h"
#include "loading/load_text.h"
#include "render/small_scene.h"

namespace aureole::test {
namespace {

const std::atomic<bool> kGo{false};
constexpr AdaptiveTarget kErrors[] = {AdaptiveTarget::absolute, AdaptiveTarget::display,
                                      AdaptiveTarget::relative};

LoadedScene changed_scene(const std::string& from, const std::string& to) {
  std::string text = small_scene_text();
  text.replace(text.find(from), from.size(), to);
  return load_scene_from_string(text, "small.xml");
}

RenderState rendered(const RenderOptions& options, LoadedScene scene = small_scene()) {
  RenderJob job(std::move(scene), options);
  EXPECT_EQ(job.run(kGo), RenderJob::Outcome::finished);
  return job.state();
}

TEST(SampleDensity, NoiseThatIsTheSameEverywhereChangesNothing) {
  for (const float variance : {0.f, 1e-20f, 1.f, 1e20f})
    for (const AdaptiveTarget error : kErrors) {
      const std::vector<PixelNoise> pixels(30 * 20, {2.f, variance});
      for (const std::int8_t e : sample_densities(30, 20, pixels, error)) EXPECT_EQ(e, 0);
    }
  EXPECT_EQ(mean_density({}), 1);
}

TEST(SampleDensity, HardlyMoreSamplesThanAskedForAndHardlyFewer) {
  // Noise over eight decades.
  std::vector<PixelNoise> pixels;
  for (int i = 0; i < 64 * 64; ++i) pixels.push_back({1, float(std::pow(10.0, 8.0 * i / (64 * 64) - 4))});
  const std::vector<std::int8_t> density = sample_densities(64, 64, pixels, AdaptiveTarget::absolute);
  EXPECT_LE(mean_density(density), 1);
  EXPECT_GT(mean_density(density), 0.9);
  EXPECT_EQ(density.front(), kMinDensityExponent);
  EXPECT_EQ(density.back(), kMaxDensityExponent);
  for (size_t i = 64; i < density.size(); ++i) EXPECT_GE(density[i], density[i - 64]) << i;
}

TEST(SampleDensity, UnitsOfTheError) {
  // The right half has 16 times the brightness. Noise that is the same in the unit of the error counts as the
  // same; else there are more samples where there is more.
  const auto ratio = [](float variance_left, float variance_right, AdaptiveTarget error) {
    std::vector<PixelNoise> pixels;
    for (int y = 0; y < 40; ++y)
      for (int x = 0; x < 40; ++x)
        pixels.push_back(x < 20 ? PixelNoise{1, variance_left} : PixelNoise{16, variance_right});
    const auto density = sample_densities(40, 40, pixels, error);
    return density[20 * 40 + 35] - density[20 * 40 + 5];
  };
  // Both levels with a tenth of the mean.
  const float levels = (16 + .85f) / (1 + .85f);
  EXPECT_EQ(ratio(1, 1, AdaptiveTarget::absolute), 0);
  EXPECT_EQ(ratio(1, levels, AdaptiveTarget::display), 0);
  EXPECT_EQ(ratio(1, levels * levels, AdaptiveTarget::relative), 0);
  EXPECT_GT(ratio(1, 8, AdaptiveTarget::absolute), 0);
  EXPECT_GT(ratio(1, 8 * levels, AdaptiveTarget::display), 0);
  EXPECT_LT(ratio(8, levels, AdaptiveTarget::display), 0);
  EXPECT_LT(ratio(8, levels * levels, AdaptiveTarget::relative), 0);
}

TEST(SampleDensity, APixelsOwnSamplesDoNotCount) {
  std::vector<PixelNoise> pixels;
  for (int i = 0; i < 40 * 40; ++i) pixels.push_back({1 + .01f * float(i % 7), 1 + float(i % 13)});
  for (const AdaptiveTarget error : kErrors) {
    const auto before = sample_densities(40, 40, pixels, error);
    for (const int at : {0, 39, 5 * 40 + 20, 39 * 40 + 39}) {
      auto changed = pixels;
      changed[size_t(at)].variance = 1e3f;
      const auto after = sample_densities(40, 40, changed, error);
      // The others share the remaining samples.
      EXPECT_LE(after[size_t(at)], before[size_t(at)]);
      EXPECT_NE(after, before) << "its neighbours have more";
    }
  }
  EXPECT_EQ(sample_densities(1, 1, std::vector<PixelNoise>{{1, 1}}, AdaptiveTarget::display),
            std::vector<std::int8_t>{0});
}

TEST(SampleDensity, EveryPixelHasSamplesAndWholeBlocksAreExact) {
  for (int e = kMinDensityExponent; e <= kMaxDensityExponent; ++e) {
    EXPECT_EQ(samples_up_to(0, e), 0);
    EXPECT_GE(samples_up_to(1, e), 1);
    for (std::int64_t n = 1; n < 100; ++n) EXPECT_GE(samples_up_to(n, e), samples_up_to(n - 1, e));
    for (std::int64_t n = 0; n < 1000; n += kSampleBlock)
      EXPECT_EQ(double(samples_up_to(n, e)), double(n) * std::exp2(e));
  }
}

TEST(Adaptive, ThePictureIsThatOfEqualSamples) {
  // A filter that mixes pixels of different density: they must weigh the same. 23 samples cut a block.
  const std::string border = R"(<boolean name="sample_border" value="true"/>)";
  std::map<std::int64_t, Image> equal_pictures;  // by the number of samples
  for (const AdaptiveTarget error : kErrors) {
    RenderOptions options;
    options.end = error == AdaptiveTarget::relative ? 23 : 32;
    options.replicates = test::effort(32, 64);
    options.adaptive = AdaptiveTarget::none;
    Image& equal = equal_pictures[*options.end];
    if (equal.pixels.empty()) equal = rendered(options, small_scene(40, 28, border)).picture();
    options.adaptive = error;
    options.seed = 1;
    const RenderState state = rendered(options, small_scene(40, 28, border));
    ASSERT_EQ(state.density.size(), size_t(44 * 32)) << "the border has densities, too";
    EXPECT_LT(*std::min_element(state.density.begin(), state.density.end()), 0);
    EXPECT_GT(*std::max_element(state.density.begin(), state.density.end()), 0);
    const Comparison c = compare_images(state.picture(), equal);
    ASSERT_TRUE(c.z.has_value());
    EXPECT_TRUE(c.z->passes) << name_of(error) << ": mean z^2 " << c.z->mean_square << ", outside "
                             << c.z->outside << ", mean " << c.z->mean_relative << ", "
                             << c.z->mean_difference << " standard errors";
  }
}

TEST(Adaptive, SquaredErrorsFall) {
  // A lamp's sharp edge and its bright surroundings hold the noise.
  const auto scene = load_scene_from_string(R"(<scene version="3.0.0">
<integrator type="path"><integer name="max_depth" value="3"/></integrator>
<sensor type="perspective"><float name="fov" value="45"/>
  <transform name="to_world"><lookat origin="0, 0, 4" target="0, 0, 0" up="0, 1, 0"/></transform>
  <sampler type="sobol"/>
  <film type="hdrfilm"><integer name="width" value="64"/><integer name="height" value="48"/>
    <string name="component_format" value="float32"/><rfilter type="box"/></film></sensor>
<shape type="rectangle"><transform name="to_world"><scale value="3"/></transform><bsdf type="diffuse"/></shape>
<shape type="rectangle"><transform name="to_world"><scale x=".3" y=".2"/><rotate z="1" angle="20"/>
  <translate z="0.5"/></transform><emitter type="area"><rgb name="radiance" value="20"/></emitter></shape>
<shape type="rectangle"><transform name="to_world"><scale value=".3"/><rotate x="1" angle="90"/>
  <translate y="2.5" z="1"/></transform><emitter type="area"><rgb name="radiance" value="20"/></emitter></shape>
</scene>)",
                                            "lamp.xml");
  RenderOptions options;
  options.end = 32;
  options.replicates = effort(12, 24);
  const auto picture = [&](AdaptiveTarget adaptive) {
    options.adaptive = adaptive;
    const RenderState state = rendered(options, scene);
    EXPECT_LE(mean_density(state.density), 1);
    return state.picture();
  };
  const auto error = [](const Image& image, int power) {
    double sum = 0, mean = 0;
    for (int c = 0; c < 3; ++c)
      for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x)
          mean += image.at(x, y, size_t(c)) / (3.0 * image.width * image.height);
    for (int c = 0; c < 3; ++c)
      for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x)
          sum += image.at(x, y, size_t(c + 3)) / std::pow(image.at(x, y, size_t(c)) + .1 * mean, power);
    return sum;
  };
  const struct {
    AdaptiveTarget error;
    int power;
    double at_most;
  } cases[] = {{AdaptiveTarget::absolute, 0, .25},
               {AdaptiveTarget::display, 1, .25},
               {AdaptiveTarget::relative, 2, .4}};
  const Image equal = picture(AdaptiveTarget::none);
  for (const auto& c : cases) {
    const double ratio = error(picture(c.error), c.power) / error(equal, c.power);
    std::printf("%s: squared error %.3f of that of equal samples\n", name_of(c.error).c_str(), ratio);
    EXPECT_LT(ratio, c.at_most) << name_of(c.error);
  }
}

TEST(Adaptive, ThreadsDoNotChangeABit) {
  RenderOptions options;
  options.adaptive = AdaptiveTarget::display;
  options.threads = 1;
  const RenderState one = rendered(options);
  for (int threads : {2, 8}) {
    options.threads = threads;
    const RenderState other = rendered(options);
    EXPECT_EQ(one.density, other.density);
    EXPECT_TRUE(same_bits(one, other)) << threads << " threads";
  }
  options.adaptive = AdaptiveTarget::none;
  EXPECT_FALSE(same_bits(one, rendered(options)));
}

TEST(Adaptive, PartsMergeToTheWhole) {
  RenderOptions options;
  options.adaptive = AdaptiveTarget::absolute;
  const RenderState whole = rendered(options);
  options.begin = 16, options.end = 48;
  RenderState sum = rendered(options);
  EXPECT_EQ(sum.density, whole.density);
  options.begin = 0, options.end = 16;
  sum.merge(rendered(options));
  EXPECT_TRUE(same_bits(whole, sum));
  options.begin = 48, options.end = 64;
  options.adaptive = AdaptiveTarget::none;
  EXPECT_THROW(sum.merge(rendered(options)), Error);
}

TEST(Adaptive, InterruptedAnywhereAndResumed) {
  const TemporaryFolder folder;
  RenderOptions options;
  options.adaptive = AdaptiveTarget::absolute;
  const RenderState whole = rendered(options);
  options.state_file = folder.path / "job.state";
  {
    // Before the pilot is done.
    RenderJob job(small_scene(), options);
    const std::atomic<bool> stop{true};
    EXPECT_EQ(job.run(stop), RenderJob::Outcome::interrupted);
    EXPECT_TRUE(job.state().density.empty());
    EXPECT_EQ(job.state().units_done(), 0);
  }
  options.time_limit_s = 1e-6;
  RenderJob part(small_scene(), options);
  part.resume(RenderState::load(options.state_file));
  EXPECT_EQ(part.run(kGo), RenderJob::Outcome::time_limit);
  const RenderState saved = RenderState::load(options.state_file);
  EXPECT_EQ(saved.density, whole.density) << "the file holds it: no second pilot";
  EXPECT_EQ(saved.samples_everywhere(), 16);
  options.time_limit_s = 0;
  RenderJob rest(small_scene(), options);
  rest.resume(saved);
  EXPECT_EQ(rest.run(kGo), RenderJob::Outcome::finished);
  EXPECT_TRUE(same_bits(whole, rest.state()));
  options.adaptive = AdaptiveTarget::relative;
  RenderJob other(small_scene(), options);
  EXPECT_THROW(other.resume(saved), Error);
}

TEST(Adaptive, ThePilotsSamplesAreTheFirst) {
  // Kept or, where a job has the densities alone, traced again.
  const std::string path = R"(<integrator type="path"><integer name="max_depth" value="7"/></integrator>)";
  const std::string gaussian = R"(<rfilter type="gaussian"/>)";
  const LoadedScene scenes[] = {
      small_scene(), changed_scene(gaussian, R"(<rfilter type="box"/>)"),
      changed_scene(gaussian, gaussian + R"(<integer name="crop_offset_x" value="5"/>)"),
      changed_scene(path, R"(<integrator type="aov"><string name="aovs" value="d:depth,n:sh_normal"/>)" +
                              path + "</integrator>"),
      changed_scene(path, R"(<integrator type="moment">)" + path + "</integrator>")};
  for (size_t i = 0; i < std::size(scenes); ++i) {
    RenderOptions options;
    options.adaptive = AdaptiveTarget::display;
    options.replicates = 2;
    const RenderState whole = rendered(options, scenes[i]);
    RenderJob again(scenes[i], options);
    RenderState state = again.state();
    state.density = whole.density;
    again.resume(state);
    EXPECT_EQ(again.run(kGo), RenderJob::Outcome::finished);
    EXPECT_TRUE(same_bits(whole, again.state())) << i;
    // More samples of a picture whose densities are fixed.
    options.end = 96;
    RenderJob more(scenes[i], options);
    more.resume(whole);
    EXPECT_EQ(more.run(kGo), RenderJob::Outcome::finished);
    EXPECT_TRUE(same_bits(rendered(options, scenes[i]), more.state())) << i;
  }
}

TEST(Adaptive, FewSamplesAreTheSameForAll) {
  for (const int spp : {1, 4, 15}) {
    RenderOptions options;
    options.end = spp;
    const RenderState equal = rendered(options);
    options.adaptive = AdaptiveTarget::display;
    const RenderState state = rendered(options);
    EXPECT_EQ(state.identity.adaptive, "none");
    EXPECT_TRUE(same_bits(equal, state));
  }
}

TEST(Adaptive, StatesThatContradictThemselvesAreRefused) {
  const TemporaryFolder folder;
  const auto loads = [&](const RenderState& state) {
    state.save(folder.path / "a.state");
    try {
      RenderState::load(folder.path / "a.state");
      return true;
    } catch (const Error&) {
      return false;
    }
  };
  RenderOptions options;
  options.adaptive = AdaptiveTarget::absolute;
  options.end = 16;
  const RenderState good = rendered(options);
  EXPECT_TRUE(loads(good));
  RenderState s = good;
  s.density[3] = kMaxDensityExponent + 1;
  EXPECT_FALSE(loads(s));
  s = good;
  s.density.pop_back();
  EXPECT_FALSE(loads(s));
  s = good;
  s.density.clear();
  EXPECT_FALSE(loads(s)) << "units are done, with what density?";
  s = good;
  s.identity.adaptive = "none";
  EXPECT_FALSE(loads(s));
  s.identity.adaptive = "some";
  EXPECT_FALSE(loads(s));
  s = good;
  s.identity.width = 1 << 20, s.identity.height = 1 << 20;
  EXPECT_FALSE(loads(s)) << "what is not in the file is not allocated";

  options.begin = 16, options.end = 32;
  RenderState other = rendered(options);
  std::swap(other.density.front(), *std::max_element(other.density.begin(), other.density.end()));
  s = good;
  if (other.density != good.density) {
    EXPECT_THROW(s.merge(other), Error);
  } else {
    ADD_FAILURE() << "the densities are the same";
  }
}

TEST(Adaptive, FromTheScene) {
  const std::string count = R"(<integer name="sample_count" value="48"/>)";
  const auto scene = changed_scene(count, count + R"(<string name="adaptive" value="relative"/>)");
  EXPECT_EQ(scene.hash, small_scene().hash) << "as the number of samples, it belongs to the render";
  EXPECT_EQ(RenderJob(scene, {}).state().identity.adaptive, "relative");
  RenderOptions options;
  options.adaptive = AdaptiveTarget::none;
  EXPECT_EQ(RenderJob(scene, options).state().identity.adaptive, "none");
  EXPECT_THROW(adaptive_target("Display"), Error);
}

TEST(Adaptive, RefusesPathsFromEmitters) {
  for (const char* integrator : {"ptracer", "bdpt"}) {
    LoadOptions load;
    load.integrator = integrator;
    const auto scene = load_scene_from_string(small_scene_text(), "small.xml", load);
    RenderOptions options;
    options.adaptive = AdaptiveTarget::display;
    EXPECT_THROW(RenderJob(scene, options), Error);
    options.adaptive.reset();
    EXPECT_NO_THROW(RenderJob(scene, options));
  }
}

}  // namespace
}  // namespace aureole::test

// SPDX-License-Identifier: Apache-2.0
// The errors that `dvr` prints of its approximations, against closed forms and an integration of the test's own.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <random>

#include "aureole/core/input_file.h"
#include "aureole/render/job.h"
#include "aureole/render/output.h"
#include "integrator/dvr_test_support.h"

namespace aureole::test {
namespace {

/// A scene that is seen along z, by parallel rays through the middle of the unit cube.
LoadedScene seen_along_z(const std::string& integrator, const std::string& content, int width = 64,
                         int height = 48) {
  return load_scene_from_string(
      R"(<scene version="3.0.0"><integrator type=")" + integrator + "</integrator>" + content +
          R"(<sensor type="orthographic"><transform name="to_world"><scale x="0.4" y="0.4"/>
      <translate x="0.5" y="0.5" z="-1"/></transform><sampler type="sobol"/><film type="hdrfilm"><integer name="width" value=")" +
          std::to_string(width) + R"("/><integer name="height" value=")" + std::to_string(height) +
          R"("/><rfilter type="box"/></film></sensor></scene>)",
      "dvr.xml");
}

std::vector<ApproximationError> errors_of(const LoadedScene& scene, double samples = 1e6) {
  return scene.integrator->approximation_errors(*scene.scene, samples, 2);
}

/// The entry whose text begins with a name.
ApproximationError named(const std::vector<ApproximationError>& errors, const std::string& name) {
  for (const ApproximationError& error : errors)
    if (error.text.starts_with(name)) return error;
  ADD_FAILURE() << "no error of " << name;
  return {};
}

TEST(DvrErrors, OfASlabAreTheTrueOnes) {
  const VolumeFolder folder;
  const std::string slab = volume_of(folder, "slab", {2, 2, 2}, kOnes, text("extinction", "0 2"));
  const double exact = 1 - std::exp(-2.0);
  const std::string quarter = number("step", 0.25) + number("termination", 0);
  const auto premultiplied = errors_of(seen_along_z(dvr(quarter + text("form", "premultiplied")), slab)),
             taylor = errors_of(seen_along_z(dvr(quarter + text("alpha", "taylor")), slab)),
             good = errors_of(seen_along_z(dvr(quarter), slab));
  // The sum of four steps of 0.5 each, and four opacities of 0.5.
  double sum = 0, passed = 1;
  for (int k = 0; k < 4; ++k) sum += 0.5 * std::exp(-0.5 * k), passed *= 0.5;
  const double too_bright = sum / exact - 1, too_opaque = (1 - passed) / exact - 1;
  for (const char* name : {"steps of", "form"}) {
    EXPECT_NEAR(named(premultiplied, name).mean, too_bright, 0.01 * too_bright) << name;
    EXPECT_NEAR(named(premultiplied, name).largest, too_bright, 0.01 * too_bright) << name;
  }
  for (const char* name : {"steps of", "alpha"})
    EXPECT_NEAR(named(taylor, name).mean, too_opaque, 0.01 * too_opaque) << name;
  EXPECT_LT(named(good, "steps of").largest, 1e-5);
  EXPECT_NE(named(good, "steps of").text.find("less than 0.001 %"), std::string::npos);
  EXPECT_NE(named(premultiplied, "steps of").text.find("27 % on average and 27 % at most"), std::string::npos)
      << named(premultiplied, "steps of").text;
}

/// Light and brightest light of parallel rays through a grid of noise, by sums in double precision.
class NoisyVolume {
public:
  static constexpr int kSize = 24;

  NoisyVolume() {
    std::mt19937 random(7);
    std::uniform_real_distribution<float> uniform(0, 1);
    for (int i = 0; i < kSize * kSize * kSize; ++i) values.push_back(uniform(random));
  }
  /// The light of a ray along z from `steps` equal steps: extinction 20 (s - 0.5) for s > 0.5, colour s.
  double light(double x, double y, int steps) const {
    double light = 0, passed = 1;
    for (int k = 0; k < steps; ++k) {
      const double s = value(x, y, (k + 0.5) / steps);
      const double opacity = 1 - std::exp(-std::max(0.0, 20 * (s - 0.5)) / steps);
      light += passed * opacity * s, passed *= 1 - opacity;
    }
    return light;
  }
  std::vector<float> values;

private:
  double value(double x, double y, double z) const {
    const double p[3] = {x * kSize - 0.5, y * kSize - 0.5, z * kSize - 0.5};
    double sum = 0;
    for (int corner = 0; corner < 8; ++corner) {
      double weight = 1;
      int at = 0;
      for (int k = 2; k >= 0; --k) {
        const double cell = std::floor(p[k]), t = p[k] - cell;
        const int upper = corner >> k & 1;
        weight *= upper ? t : 1 - t;
        at = at * kSize + std::clamp(int(cell) + upper, 0, kSize - 1);
      }
      sum += weight * double(values[std::size_t(at)]);
    }
    return sum;
  }
};

TEST(DvrErrors, OfNoiseAreTheTrueOnes) {
  const VolumeFolder folder;
  const NoisyVolume noise;
  const std::string content =
      volume_of(folder, "noise", {NoisyVolume::kSize, NoisyVolume::kSize, NoisyVolume::kSize}, noise.values,
                text("extinction", "0.5 0, 1 10") + text("colors", "0 0 0 0, 1 1 1 1"));
  for (const int steps : {24, 48, 96}) {
    double sum = 0, largest = 0, brightest = 0;
    constexpr int kRays = 40;
    for (int i = 0; i < kRays; ++i)
      for (int j = 0; j < kRays; ++j) {
        const double x = 0.1 + 0.8 * (i + 0.5) / kRays, y = 0.2 + 0.6 * (j + 0.5) / kRays;
        const double expected = noise.light(x, y, 64 * NoisyVolume::kSize);
        const double error = std::abs(noise.light(x, y, steps) - expected);
        sum += error, largest = std::max(largest, error), brightest = std::max(brightest, expected);
      }
    const double mean = sum / (kRays * kRays * brightest);
    const ApproximationError found = named(
        errors_of(seen_along_z(dvr(number("step", 1.0 / steps) + number("termination", 0)), content), 4e6),
        "steps of");
    EXPECT_GT(found.mean, 0.5 * mean) << steps;
    EXPECT_LT(found.mean, 2 * mean) << steps;
    EXPECT_GT(found.largest, 0.5 * largest / brightest) << steps;
    EXPECT_LT(found.largest, 2 * largest / brightest) << steps;
  }
}

TEST(DvrErrors, EarlyTerminationHasItsBound) {
  const VolumeFolder folder;
  const std::string slab = volume_of(folder, "slab", {2, 2, 2}, kOnes, text("extinction", "0 20"));
  const auto errors = errors_of(seen_along_z(dvr(number("termination", 0.05) + number("step", 0.01)), slab));
  const ApproximationError found = named(errors, "rays that end");
  // Each step passes exp(-0.2): the ray ends after the first power below 0.05, and the rest of the white light is missing.
  double passed = 1;
  while (!(passed < 0.05)) passed *= std::exp(-0.2);
  EXPECT_NEAR(found.mean, passed, 1e-4);
  EXPECT_LE(found.largest, 0.05);
  EXPECT_NE(found.text.find("at most 5 % of the light behind"), std::string::npos) << found.text;
  for (const ApproximationError& error : errors_of(seen_along_z(dvr(number("termination", 0)), slab)))
    EXPECT_FALSE(error.text.starts_with("rays that end")) << error.text;
}

TEST(DvrErrors, OfOtherMethods) {
  const VolumeFolder folder;
  const std::string content =
      ball(folder, text("extinction", "0 0, 0.5 0, 1 30") + text("colors", "0 1 1 1"), 16);
  const auto of = [&](const std::string& parameters) {
    return errors_of(seen_along_z(dvr(parameters), content), 1e5);
  };
  const ApproximationError thin = named(of(number("step", 0.3)), "classification \"post\" against");
  EXPECT_GT(thin.mean, 0.001);
  EXPECT_LT(
      named(of(text("method", "emission_absorption") + number("tolerance", 0.01)), "a tolerance of 0.01")
          .largest,
      0.01);
  EXPECT_LT(
      named(of(text("steps", "adaptive") + number("tolerance", 0.01)), "adaptive steps, tolerance").largest,
      0.02);
  EXPECT_GT(named(of(text("steps", "by_opacity") + number("step_opacity", 0.5)), "steps by_opacity 0.5").mean,
            0);
  EXPECT_NE(
      named(of(text("method", "mip") + number("step", 0.2)), "steps of").text.find("of the volume's range"),
      std::string::npos);
  const ApproximationError splats = named(of(text("method", "splatting")), "splatting against ray casting");
  EXPECT_GT(splats.mean, 1e-4);
  EXPECT_LT(splats.mean, 0.1);
  EXPECT_LT(splats.largest, 0.6);
  EXPECT_EQ(of(text("method", "isosurface") + text("isovalues", "0.6") + number("termination", 0)).size(),
            0u);
  // A ray of black light has an opacity alone; no ray hits a volume behind the sensor.
  const auto dark =
      errors_of(seen_along_z(dvr(number("step", 0.3)),
                             ball(folder, text("extinction", "0 0, 1 30") + text("colors", "0 0 0 0"), 16)));
  EXPECT_EQ(named(dark, "steps of").text.find("light"), std::string::npos);
  EXPECT_NE(named(dark, "steps of").text.find("opacity by"), std::string::npos);
  const auto nested =
      seen_along_z(R"(aov"><string name="aovs" value="dd:depth"/><integrator type="dvr"/>)", content);
  EXPECT_FALSE(errors_of(nested).empty());
  EXPECT_TRUE(errors_of(seen_along_z(R"(path">)", content)).empty());
}

// A slab of white dust, alone and before a wall: `path` has the light that single scattering leaves out.
TEST(DvrErrors, OfSingleScatteringAreThoseBesidePath) {
  const VolumeFolder folder;
  const std::string
      content = volume_of(folder, "slab", {2, 2, 2}, kOnes,
                          text("extinction", "0 0.5") + text("colors", "0 0.9 0.9 0.9") +
                              text("color_is", "albedo")) +
                R"(<emitter type="directional"><vector name="direction" x="0" y="0" z="1"/></emitter>)",
      wall =
          R"(<shape type="rectangle"><transform name="to_world"><scale value="9"/><rotate y="1" angle="180"/>
        <translate z="1.5"/></transform><bsdf type="diffuse"><spectrum name="reflectance" value="0.5"/></bsdf></shape>)";
  const std::string once = text("method", "single_scattering");
  for (const std::string& scene_text : {content, content + wall}) {
    const ApproximationError found = named(errors_of(seen_along_z(dvr(once), scene_text), 4e5),
                                           "light that the volume scatters more than once");
    // Rays of the test's own through the middle.
    const auto steps = seen_along_z(dvr(once), scene_text), paths = seen_along_z(R"(path">)", scene_text);
    const auto a = mean_radiance(steps, kAlongZ, 512), b = mean_radiance(paths, kAlongZ, 4096);
    const double expected = 1 - a.mean / b.mean;
    EXPECT_GT(expected, 0.02);
    EXPECT_GT(found.mean, 0.5 * expected) << found.text;
    EXPECT_LT(found.mean, 2 * expected) << found.text;
  }
}

TEST(DvrErrors, StandInThePicture) {
  const VolumeFolder folder;
  const std::string content = ball(folder, text("extinction", "0 0, 1 30"), 8);
  const auto scene = seen_along_z(dvr(""), content, 24, 16);
  RenderOptions options;
  options.end = 1;
  RenderJob job(scene, options);
  const std::atomic<bool> stop{false};
  ASSERT_EQ(job.run(stop), RenderJob::Outcome::finished);
  ASSERT_FALSE(job.state().approximations.empty());
  EXPECT_TRUE(job.state().approximations.front().starts_with("steps of 0.5 voxels against steps of"))
      << job.state().approximations.front();
  const auto file = folder.path() / "ball.exr";
  write_pictures(job.state(), file);
  const std::string bytes = read_text_file(file, 1 << 20);
  EXPECT_NE(bytes.find("aureole:approximations"), std::string::npos);
  EXPECT_NE(bytes.find(job.state().approximations.front()), std::string::npos);
  // They are part of a saved state.
  const auto saved = job.state().to_bytes();
  EXPECT_EQ(RenderState::from_bytes(saved, {"state", 0, 0}).approximations, job.state().approximations);
  // The number of threads does not change them.
  const auto one = scene.integrator->approximation_errors(*scene.scene, 384, 1),
             four = scene.integrator->approximation_errors(*scene.scene, 384, 4);
  ASSERT_EQ(one.size(), four.size());
  for (std::size_t i = 0; i < one.size(); ++i) EXPECT_EQ(one[i].text, four[i].text);
}

TEST(DvrScene, NotesApplyToIt) {
  const VolumeFolder folder;
  const auto notes = [](const std::string& integrator, const std::string& content) {
    std::string all;
    for (const std::string& note : scene_of(integrator, content).notes) all += note + "\n";
    return all;
  };
  const auto slab = [&](const std::string& name, const std::string& parameters) {
    return volume_of(folder, name, {2, 2, 2}, kOnes, parameters);
  };
  // Overlapping volumes add up in `dvr`, but one of them has to be chosen for paths.
  const std::string two = slab("a", text("extinction", "0 2")) + slab("b", text("extinction", "0 1"));
  EXPECT_EQ(notes(dvr(""), two), "");
  EXPECT_NE(notes(R"(path">)", two).find("fill the same space"), std::string::npos);
  EXPECT_NE(notes(R"(path">)", slab("a", text("extinction", "0 2") + text("color_is", "albedo") +
                                             number("emission_scale", 2)))
                .find("\"emission_scale\" has no effect: the colour is an albedo"),
            std::string::npos);
  const std::string layer = slab("a", text("extinction", "0 2") + number("opacity_unit_length", 2));
  EXPECT_NE(notes(dvr(""), layer).find("does not change \"extinction\""), std::string::npos);
  EXPECT_EQ(notes(dvr(""), slab("a", text("opacity", "0 0.2") + number("opacity_unit_length", 2))), "");
  const std::string cloud = slab("a", text("extinction", "0 2") + text("color_is", "albedo")) +
                            R"(<emitter type="directional"/>)",
                    wall =
                        R"(<shape type="rectangle"><transform name="to_world"><translate z="3"/></transform>
        <bsdf type="diffuse"/></shape>)";
  const std::string once = text("method", "single_scattering");
  EXPECT_EQ(notes(dvr(once), cloud), "");
  EXPECT_NE(notes(dvr(once), cloud + wall).find("send into the volume"), std::string::npos);
}

// Without surfaces and emitters there is nothing to trace: the picture is that of a scene with a surface beside the rays.
TEST(DvrScene, VolumesAlone) {
  const VolumeFolder folder;
  const std::string content =
                        ball(folder, text("extinction", "0 0, 1 8") + text("colors", "0 1 0.5 0.2"), 16),
                    aside =
                        R"(<shape type="rectangle"><transform name="to_world"><translate x="50"/></transform>
        <bsdf type="diffuse"/></shape>)",
                    behind = R"(<emitter type="constant"><spectrum name="radiance" value="2"/></emitter>)";
  for (const std::string nested : {"", R"(<integrator type="direct"/>)"}) {
    const Seen alone = look(scene_of(dvr(nested), content), kOblique),
               with = look(scene_of(dvr(nested), content + aside), kOblique);
    EXPECT_GT(alone.radiance, 0.1);
    EXPECT_EQ(alone.radiance, with.radiance);
    EXPECT_EQ(alone.alpha, with.alpha);
    EXPECT_GT(look(scene_of(dvr(nested), content + behind), kOblique).radiance, alone.radiance);
  }
  // `depth` shows no light.
  EXPECT_EQ(look(scene_of(dvr(R"(<integrator type="depth"/>)"), content), kOblique).radiance,
            look(scene_of(dvr(R"(<integrator type="depth"/>)"), content + aside), kOblique).radiance);
}

}  // namespace
}  // namespace aureole::test

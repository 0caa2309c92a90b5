// SPDX-License-Identifier: Apache-2.0
// Scenes that are loaded for denoising: a box filter and features beside the same picture, and nothing else changes.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>

#include "aureole/loading/document.h"
#include "aureole/render/job.h"
#include "aureole/render/part.h"
#include "loading/load_text.h"
#include "render/small_scene.h"

namespace aureole::test {
namespace {

std::string with_filter(const std::string& filter) {
  std::string text = small_scene_text(16, 12);
  const std::string before = R"(<rfilter type="gaussian"/>)";
  return text.replace(text.find(before), before.size(), filter);
}

LoadedScene loaded(const std::string& text, bool for_denoising) {
  LoadOptions options;
  options.for_denoising = for_denoising;
  return load_scene_from_string(text, "small.xml", options);
}

RenderState rendered(const LoadedScene& scene, std::int64_t samples = 16) {
  RenderOptions options;
  options.end = samples;
  options.threads = 1;
  RenderJob job(scene, options);
  const std::atomic<bool> stop{false};
  job.run(stop, {});
  return job.state();
}

std::size_t count_notes(const LoadedScene& scene, const std::string& part) {
  return std::size_t(std::count_if(scene.notes.begin(), scene.notes.end(),
                                   [&](const std::string& note) { return note.find(part) != note.npos; }));
}

TEST(ForDenoising, ThePictureIsThatOfABoxFilterAndFeaturesAreBesideIt) {
  const LoadedScene box = loaded(with_filter(R"(<rfilter type="box"/>)"), false);
  const Image expected = rendered(box).picture();
  for (const char* filter : {R"(<rfilter type="gaussian"/>)", R"(<rfilter type="box"/>)", ""}) {
    const LoadedScene scene = loaded(with_filter(filter), true);
    EXPECT_EQ(count_notes(scene, "the reconstruction filter is \"box\""),
              std::string(filter).find("box") == std::string::npos);
    const Image found = rendered(scene).picture();
    EXPECT_EQ(found.channels, (std::vector<std::string>{"R", "G", "B", "albedo.R", "albedo.G", "albedo.B",
                                                        "normal.X", "normal.Y", "normal.Z", "A"}));
    for (int y = 0; y < expected.height; ++y)
      for (int x = 0; x < expected.width; ++x)
        for (const char* name : {"R", "G", "B", "A"})
          EXPECT_EQ(found.at(x, y, std::size_t(found.channel(name))),
                    expected.at(x, y, std::size_t(expected.channel(name))))
              << filter << name << x << y;
    // The lowest row shows the checkerboard on the ground, of albedos 0.4 and 0.2 and with the normal y.
    const int y = expected.height - 1;
    for (int x = 0; x < expected.width; ++x) {
      const float albedo = found.at(x, y, std::size_t(found.channel("albedo.G")));
      EXPECT_GE(albedo, 0.19f);
      EXPECT_LE(albedo, 0.41f);
      EXPECT_NEAR(found.at(x, y, std::size_t(found.channel("normal.Y"))), 1, 1e-5);
    }
  }
}

TEST(ForDenoising, FeaturesLieBehindGlass) {
  // A pane of glass in front of a wall whose normal points to the camera.
  const std::string text = R"(<scene version="3.0.0"><integrator type="path"/>
<sensor type="perspective"><transform name="to_world"><lookat origin="0, 0, 4" target="0, 0, 0" up="0, 1, 0"/></transform>
<film type="hdrfilm"><integer name="width" value="8"/><integer name="height" value="8"/></film></sensor>
<shape type="rectangle"><transform name="to_world"><scale value="9"/><translate z="2"/></transform><bsdf type="thindielectric"/></shape>
<shape type="rectangle"><transform name="to_world"><scale value="9"/></transform>
<bsdf type="diffuse"><rgb name="reflectance" value="0.2, 0.5, 0.7"/></bsdf></shape><emitter type="constant"/></scene>)";
  const Image found = rendered(loaded(text, true), 256).picture();
  // Some 8 % of the rays are reflected by the pane and see the sky, which has no albedo.
  double albedo = 0, normal = 0;
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 8; ++x) {
      albedo += double(found.at(x, y, std::size_t(found.channel("albedo.G")))) / 64;
      normal += double(found.at(x, y, std::size_t(found.channel("normal.Z")))) / 64;
    }
  EXPECT_NEAR(albedo, 0.92 * 0.5, 0.02);
  EXPECT_NEAR(normal, 0.92, 0.03);
}

TEST(ForDenoising, ASceneWithoutFilmAndIntegratorHasTheDefaults) {
  const LoadedScene scene = loaded(
      R"(<scene version="3.0.0"><sensor type="perspective"/><emitter type="constant"/></scene>)", true);
  EXPECT_EQ(scene.integrator->properties().type(), "aov");
  EXPECT_EQ(count_notes(scene, "the reconstruction filter is \"box\""), 1u);
}

TEST(ForDenoising, AnOpenSceneDoesNotChange) {
  const std::string text = small_scene_text(16, 12);
  SceneDocument document(text, "small.xml");
  const std::string xml = document.xml();
  const std::uint64_t hash = document.loaded().hash;
  const RenderState before = rendered(document.loaded());
  const LoadedScene other = document.for_denoising();
  EXPECT_EQ(other.hash, loaded(text, true).hash);
  EXPECT_TRUE(same_samples(rendered(other), rendered(loaded(text, true))));
  EXPECT_EQ(document.xml(), xml);
  EXPECT_EQ(document.loaded().hash, hash);
  EXPECT_TRUE(same_samples(rendered(document.loaded()), before));
  // Edits go on, and the scene for denoising follows them.
  document.edit({{"sensor.fov", "<float value='30'/>"}});
  EXPECT_FALSE(same_samples(rendered(document.loaded()), before));
  EXPECT_NE(document.for_denoising().hash, other.hash);
  document.edit({{"sensor.fov", "<float value='45'/>"}});
  EXPECT_TRUE(same_samples(rendered(document.for_denoising()), rendered(other)));
}

TEST(ForDenoising, LightThatReachesAnyPixelHasNoFeatures) {
  std::string text = small_scene_text(16, 12);
  text.replace(text.find("type=\"path\""), 11, "type=\"ptracer\"");
  try {
    loaded(text, true);
    ADD_FAILURE() << "no error";
  } catch (const ErrorList& list) {
    ASSERT_FALSE(list.errors().empty());
    EXPECT_NE(list.errors().front().find("ptracer"), std::string::npos) << list.errors().front();
    EXPECT_NE(list.errors().front().find("then \"aureole denoise\" the picture"), std::string::npos)
        << list.errors().front();
    EXPECT_NE(list.errors().front().find("small.xml:2:"), std::string::npos) << list.errors().front();
  }
}

TEST(ForDenoising, SamplesAreDividedAmongReplicates) {
  const LoadedScene scene = loaded(small_scene_text(16, 12), true);  // 48 samples
  const auto divided = [&](std::optional<std::int64_t> samples, int replicates = 1) {
    RenderOptions options;
    options.end = samples, options.replicates = replicates;
    divide_for_denoising(scene, options);
    return std::pair(options.replicates, options.end);
  };
  using Found = std::pair<int, std::optional<std::int64_t>>;
  EXPECT_EQ(divided({}), (Found{3, 16}));
  EXPECT_EQ(divided(64), (Found{4, 16}));
  EXPECT_EQ(divided(1000), (Found{4, 250}));
  EXPECT_EQ(divided(16), (Found{2, 8}));
  EXPECT_EQ(divided(7), (Found{2, 4}));
  EXPECT_EQ(divided(1), (Found{1, 1}));
  EXPECT_EQ(divided(64, 8), (Found{8, 64})) << "replicates that are stated stay";
}

}  // namespace
}  // namespace aureole::test

// SPDX-License-Identifier: Apache-2.0
// A sphere that is the ground of a small scene: rays must not meet it where they leave it, and light sampling
// must agree with it near its surface.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "aureole/render/job.h"
#include "aureole/render/statistics.h"

namespace aureole::test {
namespace {

RenderState rendered(const std::string& text, int spp, int replicates, std::uint64_t seed = 0) {
  RenderOptions options;
  options.end = spp, options.replicates = replicates, options.seed = seed;
  RenderJob job(load_scene_from_string(text, "ball.xml"), options);
  const std::atomic<bool> go{false};
  job.run(go);
  return job.state();
}

const char* const kCamera = R"(<sensor type="perspective"><float name="fov" value="40"/>
  <transform name="to_world"><lookat origin="0, 1, -5" target="0, 0, 0" up="0, 1, 0"/></transform>
  <film type="hdrfilm"><integer name="width" value="16"/><integer name="height" value="16"/>
    <string name="component_format" value="float32"/><rfilter type="box"/></film></sensor>)";

TEST(LargeSphere, WhiteFurnace) {
  for (const double radius : {1.0, 1e3, 1e4, 1e5, 1e6, 1e7}) {
    const std::string text = fmt::format(
        R"(<scene version="3.0.0"><integrator type="path"/>{}<emitter type="constant"><spectrum name="radiance" value="1"/></emitter>
        <shape type="sphere"><point name="center" x="0" y="{}" z="0"/><float name="radius" value="{}"/>
        <bsdf type="diffuse"><spectrum name="reflectance" value="1"/></bsdf></shape></scene>)",
        kCamera, -radius, radius);
    const Image image = rendered(text, 64, 1).picture();
    const size_t g = size_t(image.channel("G"));
    double mean = 0;
    for (int y = 0; y < 16; ++y)
      for (int x = 0; x < 16; ++x) mean += image.at(x, y, g) / 256;
    // A flat spectrum of 1 has G = .9491 in linear sRGB.
    EXPECT_NEAR(mean / 0.9491, 1, 4e-3) << radius;
  }
}

TEST(LargeSphere, LightSamplingNearItsSurfaceAgreesWithBsdfSampling) {
  for (const double radius : {100.0, 1e6}) {
    const std::string rest = fmt::format(
        R"({}<shape type="sphere"><point name="center" x="0" y="{}" z="0"/><float name="radius" value="{}"/>
        <emitter type="area"><spectrum name="radiance" value="1"/></emitter></shape>
        <shape type="sphere"><point name="center" x="0" y="0.6" z="0"/><float name="radius" value="0.5"/></shape></scene>)",
        kCamera, -radius, radius);
    const std::string head = R"(<scene version="3.0.0">)";
    const auto both = rendered(
        head + R"(<integrator type="path"><integer name="max_depth" value="2"/></integrator>)" + rest, 64,
        16);
    const auto bsdf_only = rendered(
        head + R"(<integrator type="direct"><integer name="emitter_samples" value="0"/></integrator>)" + rest,
        64, 16, 1);
    const Comparison c = compare_images(both.picture(), bsdf_only.picture());
    ASSERT_TRUE(c.z);
    EXPECT_TRUE(c.z->passes) << radius << ": " << 100 * c.z->mean_relative << " %, z^2 " << c.z->mean_square;
  }
}

}  // namespace
}  // namespace aureole::test

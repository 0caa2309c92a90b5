// SPDX-License-Identifier: Apache-2.0
// A layer of clear spheres, a surface of its own, just above another surface: in light that is the same from
// all sides nothing shows, if the two surfaces exchange light without losing or making any.
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <string>

#include "aureole/render/job.h"

namespace aureole {
namespace {

double mean_radiance(const std::string& below, const std::string& offset) {
  const std::string scene = R"(<scene version="3.0.0">
  <integrator type="path"><integer name="max_depth" value="200"/><integer name="rr_depth" value="200"/></integrator>
  <sensor type="perspective"><float name="fov" value="40"/>
    <transform name="to_world"><lookat origin="1, 0, 2" target="0, 0, 0" up="0, 1, 0"/></transform>
    <sampler type="sobol"><integer name="sample_count" value="128"/></sampler>
    <film type="hdrfilm"><integer name="width" value="16"/><integer name="height" value="16"/>
      <float name="wavelength_min" value="500"/><float name="wavelength_max" value="600"/>
      <string name="response" value="uniform"/><string name="component_format" value="float32"/>
      <rfilter type="box"/></film></sensor>
  <shape type="rectangle"><transform name="to_world"><scale value="10"/></transform>)" +
                            below + R"(</shape>
  <shape type="rectangle"><transform name="to_world"><scale value="10"/><translate z=")" +
                            offset + R"("/></transform>
    <bsdf type="correlated_spheres"><string name="radius" value="2um"/><float name="area_fraction" value="0.4"/>
      <float name="int_ior" value="1.33"/><float name="ext_ior" value="1"/></bsdf></shape>
  <emitter type="constant"><spectrum name="radiance" value="1"/></emitter>
</scene>)";
  RenderOptions options;
  RenderJob job(load_scene_from_string(scene, "stacked.xml"), options);
  const std::atomic<bool> stop{false};
  EXPECT_EQ(job.run(stop), RenderJob::Outcome::finished);
  const Image image = job.state().picture();
  double sum = 0;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) sum += double(image.at(x, y, 0)) / (image.width * image.height);
  return sum;
}

TEST(StackedLayers, Furnace) {
  const std::string white =
      R"(<bsdf type="twosided"><bsdf type="diffuse"><float name="reflectance" value="1"/></bsdf></bsdf>)";
  const std::string glass =
      R"(<bsdf type="thindielectric"><float name="int_ior" value="1.5"/><float name="ext_ior" value="1"/></bsdf>)";
  for (const char* offset : {"1e-3", "1e-5"}) {
    const double on_white = mean_radiance(white, offset), on_glass = mean_radiance(glass, offset);
    std::printf("spheres %s above a white surface: %.5f, above a pane: %.5f\n", offset, on_white, on_glass);
    EXPECT_NEAR(on_white, 1, 4e-3) << offset;
    EXPECT_NEAR(on_glass, 1, 4e-3) << offset;
  }
}

}  // namespace
}  // namespace aureole

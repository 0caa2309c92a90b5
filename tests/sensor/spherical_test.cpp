// SPDX-License-Identifier: Apache-2.0
// The panorama: its rays, their inverse and density, and that it is the environment map that it sees.
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>

#include "aureole/core/image.h"
#include "aureole/integrator/integrator.h"
#include "aureole/math/significance.h"
#include "aureole/math/warp.h"
#include "aureole/render/job.h"
#include "aureole/sensor/placed_sensor.h"
#include "harness/properties_builder.h"
#include "loading/load_text.h"

namespace aureole {
namespace {

const std::string kFilm =
    R"(<film type="hdrfilm"><integer name="width" value="64"/><integer name="height" value="32"/>
  <string name="component_format" value="float32"/><rfilter type="box"/></film>)";
const std::string kLook =
    R"(<transform name="to_world"><lookat origin="1, -4, 2" target="0, 0, 0.3" up="0.1, 0, 1"/>
  </transform>)";

TEST(Spherical, RaysAndTheirInverse) {
  const auto object = testing::build_object("<sensor type='spherical'>" + kLook + kFilm + "</sensor>");
  const PlacedSensor sensor = PlacedSensor::of(dynamic_cast<const Sensor&>(*object), nullptr, {}, 1);
  // The middle looks at the target, the upper edge up, and the right half to the right.
  const Vec3 ahead = normalize(Vec3{-1, 4, -1.7f});
  EXPECT_LT(length(sensor.sample_ray({32, 16}, {}).ray.d - ahead), 1e-5f);
  EXPECT_GT(sensor.sample_ray({32, 0}, {}).ray.d.z, 0.9f);
  EXPECT_GT(dot(sensor.sample_ray({48, 16}, {}).ray.d, cross(ahead, {0, 0, 1})), 0.9f);
  SeededRandom random(3);
  double integral = 0;
  const int n = 20000;
  for (int i = 0; i < n; ++i) {
    const Vec2 film{64 * random.next(), 32 * (0.002f + 0.996f * random.next())};
    const SensorRay s = sensor.sample_ray(film, {});
    const auto found = sensor.eval(s.ray.o + s.ray.d * random.next(), s.ray.d);
    ASSERT_TRUE(found) << film.x << " " << film.y;
    EXPECT_LT(std::abs(std::remainder(found->film.x - film.x, 64)),
              2e-2 / std::sin(M_PI * double(film.y) / 32));
    EXPECT_NEAR(found->film.y, film.y, 2e-3);
    const Vec3 d = square_to_uniform_sphere(random.next2());
    const auto any = sensor.eval(Vec3{1, -4, 2} + d, d);
    ASSERT_TRUE(any);
    integral += 4 * M_PI * double(any->pdf_direction) / n;
  }
  EXPECT_NEAR(integral, 1, 0.02);
  EXPECT_FALSE(sensor.eval({0, 0, 0}, {0, 0, 1}));  // this ray does not come from the camera
}

TEST(Spherical, FilmsThatDoNotFit) {
  const auto with = [](const std::string& film) {
    return load_scene_from_string(test::kHead + "<sensor type='spherical'><film type='hdrfilm'>" + film +
                                      "</film></sensor><emitter type='constant'/></scene>",
                                  "test.xml");
  };
  EXPECT_THROW(with("<boolean name='sample_border' value='true'/>"), Error);
  const auto square = with("<integer name='width' value='8'/><integer name='height' value='8'/>").notes;
  ASSERT_EQ(square.size(), 1u);
  EXPECT_NE(square[0].find("not twice as wide as high"), std::string::npos) << square[0];
}

TEST(Spherical, NotesThatNothingIsBetweenItsClips) {
  const auto notes = [](const char* clip) {
    std::string all;
    for (const std::string& note :
         load_scene_from_string(
             test::kHead + "<sensor type='spherical'><float name='" + clip +
                 "'/></sensor><shape type='sphere'><point name='center' x='3' y='0' z='0'/></shape></scene>",
             "test.xml")
             .notes)
      all += note + "\n";
    return all;
  };
  EXPECT_EQ(notes("far_clip' value='2.1").find("the camera sees none"), std::string::npos);
  EXPECT_NE(notes("far_clip' value='1.9").find("the camera sees none: their distances are 2 to "),
            std::string::npos);
  EXPECT_NE(notes("near_clip' value='9").find("the camera sees none"), std::string::npos);
}

TEST(Spherical, SeesTheEnvironmentMapAsItIs) {
  const test::TemporaryFolder folder;
  Image map;
  map.width = 64, map.height = 32, map.channels = {"R", "G", "B"};
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 64; ++x) {
      const double phi = 2 * M_PI * (x + 0.5) / 64, theta = M_PI * y / 31.0;
      map.pixels.push_back(float(0.5 + 0.3 * std::sin(phi) * std::sin(theta)));
      map.pixels.push_back(float(0.5 + 0.3 * std::cos(phi) * std::sin(theta)));
      map.pixels.push_back(float(0.5 + 0.4 * std::cos(theta)));
    }
  write_exr(folder.path / "map.exr", map, ExrPixel::float32, {});
  const auto loaded = load_scene_from_string(
      test::kHead + "<integrator type='path'/><sensor type='spherical'>" + kLook + kFilm +
          "<sampler type='sobol'><integer name='sample_count' value='64'/></sampler></sensor>"
          "<emitter type='envmap'><string name='filename' value='map.exr'/>" +
          kLook + "</emitter></scene>",
      folder.path / "scene.xml");
  RenderOptions options;
  RenderJob job(loaded, options);
  const std::atomic<bool> stop{false};
  ASSERT_EQ(job.run(stop), RenderJob::Outcome::finished);
  const Image seen = job.state().picture();
  for (int y = 1; y < 31; y += 3)
    for (int x = 0; x < 64; ++x) {
      const double phi = 2 * M_PI * (x + 0.5) / 64, theta = M_PI * (y + 0.5) / 32;
      EXPECT_NEAR(seen.at(x, y, std::size_t(seen.channel("R"))), 0.5 + 0.3 * std::sin(phi) * std::sin(theta),
                  0.02);
      EXPECT_NEAR(seen.at(x, y, std::size_t(seen.channel("G"))), 0.5 + 0.3 * std::cos(phi) * std::sin(theta),
                  0.02);
      EXPECT_NEAR(seen.at(x, y, std::size_t(seen.channel("B"))), 0.5 + 0.4 * std::cos(theta), 0.02);
    }
}

}  // namespace
}  // namespace aureole

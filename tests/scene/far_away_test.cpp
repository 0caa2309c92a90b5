// SPDX-License-Identifier: Apache-2.0
// Coordinates near the end of the range of float: rays that cannot be followed, and objects that no ray
// reaches.
#include <gtest/gtest.h>

#include <limits>

#include "aureole/scene/scene.h"
#include "loading/load_text.h"

namespace aureole {
namespace {

std::shared_ptr<const Scene> scene_of(const std::string& objects) {
  return load_scene_from_string(test::kHead + "<sensor type=\"perspective\"/>\n" + objects + "</scene>",
                                "test.xml")
      .scene;
}
std::string error_of_scene(const std::string& objects) {
  try {
    scene_of(objects);
  } catch (const Error& e) {
    return e.what();
  }
  return "";
}

TEST(FarAway, RaysWithoutAPlaceMeetNothing) {
  const auto scene = scene_of("<shape type=\"sphere\"/>");
  const float nan = std::numeric_limits<float>::quiet_NaN(),
              infinity = std::numeric_limits<float>::infinity();
  ASSERT_TRUE(scene->intersect({{0, 0, -5}, {0, 0, 1}}));
  for (const float bad : {nan, infinity, -infinity, 3e38f, -1e19f})
    for (int i = 0; i < 3; ++i) {
      Ray from{{0, 0, -5}, {0, 0, 1}}, along = from;
      from.o[i] = bad, along.d[i] = bad;
      EXPECT_FALSE(scene->intersect(from)) << bad << i;
      EXPECT_FALSE(scene->intersect(along)) << bad << i;
    }
  EXPECT_FALSE(scene->intersect({{0, 0, -5}, {0, 0, 1}, nan}));
}

TEST(FarAway, ObjectsThatNoRayReachesAreErrors) {
  const std::string moved = "<transform name=\"to_world\"><translate x=\"3e38\"/></transform></shape>";
  EXPECT_EQ(error_of_scene("<shape type=\"rectangle\"><transform name=\"to_world\"><scale "
                           "value=\"1e30\"/></transform></shape>"),
            "test.xml:3:1: \"rectangle\" reaches beyond the coordinate 1.8e18, where rays end");
  EXPECT_EQ(error_of_scene("<shape type=\"sphere\">" + moved),
            "test.xml:3:1: \"sphere\" reaches beyond the coordinate 1.8e18, where rays end");
  EXPECT_EQ(error_of_scene("<shape type=\"sphere\"><float name=\"radius\" value=\"1e30\"/></shape>"),
            "test.xml:3:1: \"sphere\" reaches beyond the coordinate 1.8e18, where rays end");
  const std::string light =
      "<emitter type=\"point\"><point name=\"position\" x=\"3e38\" y=\"0\" z=\"0\"/></emitter>";
  EXPECT_EQ(error_of_scene(light + light),
            "test.xml:3:1: \"point\" reaches beyond the coordinate 1.8e18, where rays end");
}

TEST(FarAway, SensorsSeeNothing) {
  const auto scene =
      load_scene_from_string(test::kHead +
                                 "<sensor type=\"perspective\"><transform "
                                 "name=\"to_world\"><translate x=\"1e30\"/></transform></sensor>"
                                 "<shape type=\"sphere\"/><emitter type=\"constant\"/></scene>",
                             "test.xml")
          .scene;
  EXPECT_FALSE(scene->intersect(scene->sensor().sample_ray({1, 1}, {}).ray));
}

TEST(FarAway, ResponsesAndEmissionsThatOverflow) {
  const auto scene = [](const std::string& srf, const std::string& radiance) {
    return load_scene_from_string(
               test::kHead + "<sensor type=\"perspective\"><spectrum name=\"srf\" value=\"400:0, 650:" + srf +
                   "\"/></sensor>\n<emitter type=\"constant\">" +
                   "<spectrum name=\"radiance\" value=\"400:0, 650:" + radiance + "\"/></emitter></scene>",
               "test.xml")
        .scene;
  };
  EXPECT_THROW(scene("3e38", "1"), Error);
  const auto bright = scene("1e12", "1e30");
  for (const float u : {0.f, 0.3f, 0.9f}) {
    const Wavelengths w = bright->wavelengths().sample(u);
    for (int j = 0; j < kWavelengths; ++j) {
      EXPECT_TRUE(w.nm[j] >= 360 && w.nm[j] <= 830) << w.nm[j];
      EXPECT_TRUE(w.pdf[j] > 0 && std::isfinite(w.pdf[j])) << w.pdf[j];
    }
  }
}

}  // namespace
}  // namespace aureole

// SPDX-License-Identifier: Apache-2.0
// Coordinates near the end of the range of float: rays that cannot be followed, and objects that no ray
// reaches.
#include <gtest/gtest.h>

#include <atomic>
#include <limits>

#include "aureole/render/job.h"
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

TEST(FarAway, RoundedPositionsAreNoted) {
  const auto notes = [](double distance, const std::string& scale) {
    const std::string at = std::to_string(distance);
    std::string all;
    const auto scene = scene_of("<shape type=\"sphere\">\n<transform name=\"to_world\"><scale value=\"" +
                                scale + "\"/><translate x=\"" + at +
                                "\"/></transform></shape>\n<shape type=\"cube\"><transform name=\"to_world\">"
                                "<scale value=\"" +
                                scale + "\"/><translate y=\"" + at + "\"/></transform></shape>");
    for (const std::string& note : scene->notes()) all += note + "\n";
    return all;
  };
  EXPECT_EQ(notes(1e3, "0.5").find("rounded"), std::string::npos);
  EXPECT_EQ(notes(1e6, "500").find("rounded"), std::string::npos);
  for (const auto& [distance, scale] :
       {std::pair(1e6, "0.5"), std::pair(1e6, "20"), std::pair(1e3, "0.01")}) {
    const std::string text = notes(distance, scale);
    EXPECT_NE(text.find("test.xml:3:1: positions on this shape"), std::string::npos) << text;
    EXPECT_NE(text.find("(so for 2 shapes)"), std::string::npos) << text;
  }
}

TEST(FarAway, ErrorsStandWhereThePlaceIsStated) {
  const std::string reaches = "reaches beyond the coordinate 9e17, where rays end";
  for (const char* distance : {"1e18", "3e38", "1e300"}) {
    const std::string moved =
        "\n<transform name=\"to_world\"><translate x=\"" + std::string(distance) + "\"/></transform>";
    for (const char* object :
         {"shape type=\"sphere\"", "shape type=\"rectangle\"", "emitter type=\"spot\""}) {
      const std::string type = std::string(object).substr(std::string(object).find('"'));
      EXPECT_EQ(error_of_scene("<" + std::string(object) + ">" + moved + "</" +
                               std::string(object, std::string(object).find(' ')) + ">"),
                "test.xml:4:1: parameter \"to_world\" of " + type +
                    ": leads beyond the coordinate 9e17, where rays end");
    }
  }
  EXPECT_EQ(error_of_scene("<shape type=\"rectangle\">\n<transform name=\"to_world\"><scale value=\"1e30\"/>"
                           "</transform></shape>"),
            "test.xml:4:1: parameter \"to_world\" of \"rectangle\": " + reaches);
  EXPECT_EQ(error_of_scene("<shape type=\"sphere\">\n<float name=\"radius\" value=\"1e30\"/></shape>"),
            "test.xml:4:1: parameter \"radius\" of \"sphere\": " + reaches);
  EXPECT_EQ(error_of_scene("<emitter type=\"point\">\n<point name=\"position\" x=\"3e38\" y=\"0\" z=\"0\"/>"
                           "</emitter>"),
            "test.xml:4:1: parameter \"position\" of \"point\": " + reaches);
}

TEST(FarAway, SensorsWhoseRaysCannotBeTracedAreErrors) {
  const auto error = [](const std::string& sensor) {
    try {
      load_scene_from_string(test::kHead + sensor + "<shape type=\"sphere\"/></scene>", "test.xml");
    } catch (const Error& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_EQ(
      error("<sensor type=\"perspective\">\n<transform name=\"to_world\"><lookat origin=\"-1e30, -5, 2\" "
            "target=\"0, 0, 0\" up=\"0, 0, 1\"/></transform></sensor>"),
      "test.xml:3:1: parameter \"to_world\" of \"perspective\": leads beyond the coordinate 9e17, where rays end");
  EXPECT_EQ(
      error("<sensor type=\"orthographic\">\n<transform name=\"to_world\"><scale value=\"1e20\"/>"
            "</transform></sensor>"),
      "test.xml:3:1: parameter \"to_world\" of \"orthographic\": its rays begin beyond the coordinate 9e17, where "
      "rays end");
  EXPECT_EQ(
      error("<sensor type=\"perspective\"><transform name=\"to_world\"><translate x=\"8e17\"/></transform>"
            "</sensor>"),
      "");
}

TEST(FarAway, InstancesThatMagnifyRaysBeyondTheRangeAreErrors) {
  const auto instance = [](const std::string& member, const std::string& scale) {
    return error_of_scene("<shape type=\"instance\">\n<shape type=\"shapegroup\">\n" + member +
                          "</shape>\n<transform name=\"to_world\"><scale value=\"" + scale +
                          "\"/><translate x=\"8\"/></transform></shape>");
  };
  EXPECT_EQ(instance("<shape type=\"sphere\"/>", "1e-10"), "");
  EXPECT_EQ(
      instance("<shape type=\"sphere\"/>", "1e-17"),
      "test.xml:6:1: parameter \"to_world\" of \"instance\": makes its group so small that rays of this "
      "scene have coordinates beyond 1.8e18 in it");
  EXPECT_EQ(
      instance("<shape type=\"sphere\">\n<float name=\"radius\" value=\"1e20\"/></shape>", "1e-10"),
      "test.xml:6:1: parameter \"radius\" of \"sphere\": reaches beyond the coordinate 9e17, where rays end");
}

TEST(FarAway, LostRaysMakeSamplesInvalid) {
  // Light is scattered once in 1e19 units of length: most places are beyond the range.
  const auto lost = [](const std::string& integrator) {
    const LoadedScene loaded = load_scene_from_string(
        test::kHead + "<integrator type=\"" + integrator +
            "\"/><sensor type=\"perspective\"><medium type=\"homogeneous\" id=\"haze\"><float name=\"sigma_t\" "
            "value=\"1e-19\"/><float name=\"albedo\" value=\"1\"/></medium><film type=\"hdrfilm\">"
            "<integer name=\"width\" value=\"4\"/><integer name=\"height\" value=\"4\"/></film></sensor>"
            "<emitter type=\"point\"><rgb name=\"intensity\" value=\"1e30\"/><ref id=\"haze\"/></emitter></scene>",
        "test.xml");
    RenderOptions options;
    options.end = 16;
    RenderJob job(loaded, options);
    const std::atomic<bool> stop{false};
    job.run(stop);
    return double(job.state().invalid_samples) / (16 * 16);
  };
  // At most half of the paths end within the far clip plane or are absorbed by roulette.
  EXPECT_GT(lost("path"), 0.5);
  EXPECT_GT(lost("ptracer"), 0.5);
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

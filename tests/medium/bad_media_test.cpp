// SPDX-License-Identifier: Apache-2.0
// Media that cannot be rendered are located errors.
#include <gtest/gtest.h>

#include "aureole/loading/load.h"
#include "medium/scene_text.h"
#include "volume/volume_test_support.h"

namespace aureole::testing {
namespace {

std::string error_of(const std::string& content) {
  try {
    load_scene_from_string("<scene version=\"3.0.0\">\n" + content + "</scene>", "bad.xml");
  } catch (const Error& e) {
    return e.what();
  }
  return "";
}
std::string seen_from(const std::string& origin) {
  return camera("origin=\"" + origin + "\" target=\"0, 0, 0\" up=\"0, 0, 1\"", 30, 2, 4) + "\n";
}

TEST(BadMedia, ASensorInAMediumThatIsNotClosed) {
  const std::string below = "<shape type=\"rectangle\">" + kNull + medium(0.1, 1) + "</shape>";
  const std::string error = error_of(seen_from("0.1, 0.2, -2") + below);
  EXPECT_NE(error.find("bad.xml:2:1"), std::string::npos) << error;
  EXPECT_NE(error.find("not closed"), std::string::npos) << error;
  // Above it there is none, a ball is closed, walls without a medium of their own close it, too, and what the
  // sensor says is believed.
  EXPECT_EQ(error_of(seen_from("0.1, 0.2, 2") + below), "");
  EXPECT_EQ(error_of(seen_from("0.1, 0.2, 0.3") + ball(kNull, medium(0.1, 1))), "");
  EXPECT_EQ(error_of(seen_from("0.1, 0.2, -2") + below +
                     "<shape type=\"sphere\"><float name=\"radius\" value=\"5\"/></shape>"),
            "");
  std::string stated = seen_from("0.1, 0.2, -2");
  stated.insert(stated.find("</sensor>"), "<ref id=\"fog\"/>");
  EXPECT_EQ(error_of("<medium type=\"homogeneous\" id=\"fog\"/>" + stated + below), "");
}

TEST(BadMedia, CoefficientsThatNothingHas) {
  const auto expect = [](const std::string& type, const std::string& parameters, const std::string& text) {
    const std::string error =
        error_of(seen_from("0, -4, 0") +
                 ball(kNull, "<medium type=\"" + type + "\" name=\"interior\">" + parameters + "</medium>"));
    EXPECT_NE(error.find("bad.xml:3:"), std::string::npos) << parameters << ": " << error;
    EXPECT_NE(error.find(text), std::string::npos) << parameters << ": " << error;
  };
  const auto volume = [](const std::string& name, double value) {
    return "<volume type=\"constvolume\" name=\"" + name + "\">" + parameter("value", value) + "</volume>";
  };
  for (const char* name : {"sigma_t", "sigma_a", "sigma_s", "emission"}) {
    const std::string start = "<float name=\"" + std::string(name) + "\" value=\"";
    expect("homogeneous", start + "-1\"/>", "must not be negative");
    expect("homogeneous", start + "nan\"/>", "is not a number");
  }
  expect("homogeneous", "<spectrum name=\"sigma_s\" value=\"400:1, 600:-2\"/>", "must not be negative");
  expect("homogeneous", parameter("albedo", 1.5), "[0, 1]");
  expect("heterogeneous", volume("sigma_t", 1) + volume("albedo", 1.5), "[0, 1]");
  expect("heterogeneous", volume("sigma_t", -1), "must not be negative");
}

TEST(BadMedia, AMediumInABodyWithAGap) {
  const auto end = [](double z) {
    return "<shape type=\"disk\"><transform name=\"to_world\"><scale value=\"0.5\"/><translate z=\"" +
           number(z) + "\"/></transform></shape>\n";
  };
  const std::string pipe =
      "<shape type=\"cylinder\"><point name=\"p0\" x=\"0\" y=\"0\" z=\"-1\"/><point name=\"p1\" x=\"0\" y=\"0\" "
      "z=\"1\"/>" +
      parameter("radius", 0.5) + kNull + "\n" + medium(0.1, 1) + "</shape>\n";
  const std::string error = error_of(seen_from("0, -4, 0") + pipe + end(1));
  EXPECT_NE(error.find("bad.xml:4:1"), std::string::npos) << error;
  EXPECT_NE(error.find("has a gap"), std::string::npos) << error;
  // Other surfaces may close it: lids, walls around all. A surface with nothing below it is no body.
  EXPECT_EQ(error_of(seen_from("0, -4, 0") + pipe + end(1) + end(-1)), "");
  EXPECT_EQ(error_of(seen_from("0, -4, 0") + pipe +
                     "<shape type=\"sphere\"><float name=\"radius\" value=\"5\"/></shape>"),
            "");
  EXPECT_EQ(
      error_of(seen_from("0, 1, 4") + "<shape type=\"rectangle\">" + kNull + medium(0.1, 1) + "</shape>"),
      "");
}

TEST(BadMedia, AnExtinctionBeyondNumbers) {
  const std::string error =
      error_of(seen_from("0, -4, 0") +
               ball(kNull, "<medium type=\"homogeneous\" name=\"interior\">" + parameter("sigma_t", 1e15) +
                               parameter("scale", 1e15) + "</medium>"));
  EXPECT_NE(error.find("bad.xml:3:"), std::string::npos) << error;
  EXPECT_NE(error.find("parameter \"scale\""), std::string::npos) << error;
}

// Rays step along free paths of the largest extinction of a cell, also where the extinction is small.
TEST(BadMedia, AnExtinctionThatVariesByTooMuch) {
  const test::VolumeFolder folder;
  std::vector<float> values(64, 1.f);
  const auto error = [&](float densest) {
    values[21] = densest;
    const auto file =
        test::write_bytes(folder.path() / "t.vol", test::make_vol({4, 4, 4}, 1, values).bytes());
    return error_of(seen_from("0, -4, 0") +
                    ball(kNull,
                         "<medium type=\"heterogeneous\" name=\"interior\">"
                         "<volume type=\"gridvolume\" name=\"sigma_t\"><string name=\"filename\" value=\"" +
                             file.string() + "\"/></volume></medium>"));
  };
  EXPECT_EQ(error(1e4f), "");
  EXPECT_NE(error(1e16f).find("bad.xml:3:"), std::string::npos) << error(1e16f);
  EXPECT_NE(error(1e16f).find("free paths long"), std::string::npos) << error(1e16f);
  // Where it is as dense everywhere, light ends at once.
  values.assign(64, 1e8f);
  EXPECT_EQ(error(1.001e8f), "");
}

TEST(BadMedia, ATemperatureBeyondNumbers) {
  const auto error = [](double kelvin) {
    return error_of(seen_from("0, -4, 0") + ball(kNull, "<medium type=\"homogeneous\" name=\"interior\">" +
                                                            parameter("temperature", kelvin) + "</medium>"));
  };
  EXPECT_EQ(error(1e7), "");
  EXPECT_NE(error(1e30).find("bad.xml:3:"), std::string::npos) << error(1e30);
  EXPECT_NE(error(1e30).find("parameter \"temperature\""), std::string::npos) << error(1e30);
}

}  // namespace
}  // namespace aureole::testing

// SPDX-License-Identifier: Apache-2.0
// Media that cannot be rendered are located errors.
#include <gtest/gtest.h>

#include "aureole/loading/load.h"
#include "medium/scene_text.h"

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

TEST(BadMedia, AnExtinctionBeyondNumbers) {
  const std::string error =
      error_of(seen_from("0, -4, 0") +
               ball(kNull, "<medium type=\"homogeneous\" name=\"interior\">" + parameter("sigma_t", 1e15) +
                               parameter("scale", 1e15) + "</medium>"));
  EXPECT_NE(error.find("bad.xml:3:"), std::string::npos) << error;
  EXPECT_NE(error.find("parameter \"scale\""), std::string::npos) << error;
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

// SPDX-License-Identifier: Apache-2.0
// Surfaces that bound a medium and have a gap are noted.
#include <gtest/gtest.h>

#include "aureole/asset/asset.h"
#include "harness/paths.h"
#include "harness/properties_builder.h"

namespace aureole::test {
namespace {

std::string note_of(const std::string& type, const std::string& children,
                    const std::string& medium = R"(<medium name="interior" type="homogeneous"/>)") {
  Diagnostics diagnostics;
  const auto asset = testing::build<Asset>("<shape type=\"" + type + "\">" + children + medium + "</shape>",
                                           testing::make_context(360, 830, &diagnostics), example_file);
  EXPECT_FALSE(diagnostics.has_errors());
  return diagnostics.notes().empty() ? "" : diagnostics.notes().front();
}
std::string file(const std::string& name) { return "<string name=\"filename\" value=\"" + name + "\"/>"; }

TEST(OpenSurface, ClosedOnesAreNotNoted) {
  EXPECT_EQ(note_of("cube", ""), "");
  EXPECT_EQ(note_of("sphere", ""), "");
  EXPECT_EQ(note_of("rectangle", "", ""), "");
  EXPECT_EQ(note_of("obj", file("icosphere.obj")), "");
}

TEST(OpenSurface, OpenOnesAreNoted) {
  const std::string rectangle = note_of("rectangle", "");
  EXPECT_NE(rectangle.find("4 edges belong to one triangle alone"), std::string::npos) << rectangle;
  EXPECT_NE(rectangle.find("snippet:1"), std::string::npos) << rectangle;
  EXPECT_NE(note_of("disk", "").find("a disk has an edge"), std::string::npos);
  EXPECT_NE(note_of("cylinder", "", R"(<medium name="exterior" type="homogeneous"/>)").find("no caps"),
            std::string::npos);
  EXPECT_NE(note_of("ply", file("hill_little.ply")).find("24 edges"),
            std::string::npos);  // of 6 x 6 quadrangles
}

}  // namespace
}  // namespace aureole::test

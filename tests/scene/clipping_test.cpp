// SPDX-License-Identifier: Apache-2.0
// Cameras whose clip planes hide the whole scene say so.
#include <gtest/gtest.h>

#include "aureole/loading/load.h"

namespace aureole::test {
namespace {

/// The notes about clip planes of a scene of two spheres of radius 1 at z = 20 and 30.
std::vector<std::string> notes_about_clipping(const std::string& sensor, const std::string& more = "") {
  const LoadedScene scene = load_scene_from_string(R"(<scene version="3.0.0">
)" + sensor + R"(
<shape type="sphere"><point name="center" x="0" y="0" z="20"/></shape><shape type="sphere"><point name="center" x="0" y="0" z="30"/></shape>
<emitter type="constant"/>)" + more + "</scene>",
                                                   "clip.xml");
  std::vector<std::string> found;
  for (const std::string& note : scene.notes)
    if (note.find("every shape lies") != std::string::npos) found.push_back(note);
  return found;
}

std::string camera(const std::string& type, const std::string& planes) {
  return "<sensor type=\"" + type + "\">\n" + planes + "</sensor>";
}

std::string plane(const std::string& name, double distance) {
  return "<float name=\"" + name + "\" value=\"" + std::to_string(distance) + "\"/>\n";
}

TEST(Clipping, IsNotedWhereItHidesEveryShape) {
  for (const char* type : {"perspective", "orthographic"}) {
    EXPECT_TRUE(notes_about_clipping(camera(type, "")).empty());
    const auto far = notes_about_clipping(camera(type, plane("far_clip", 18.9)));
    ASSERT_EQ(far.size(), 1u);
    EXPECT_EQ(
        far[0],
        "clip.xml:3:1: every shape lies beyond far_clip, so that the camera sees none: along its axis they reach "
        "from 19 to 31, the near plane is at 0.01 and the far plane at 18.9");
    EXPECT_TRUE(notes_about_clipping(camera(type, plane("far_clip", 19.1))).empty());
    const auto near = notes_about_clipping(camera(type, plane("near_clip", 31.1)));
    ASSERT_EQ(near.size(), 1u);
    EXPECT_NE(near[0].find("clip.xml:3:1: every shape lies before near_clip"), std::string::npos) << near[0];
    EXPECT_TRUE(notes_about_clipping(camera(type, plane("near_clip", 30.9))).empty());
    // The gap between the spheres.
    const auto between = notes_about_clipping(camera(type, plane("near_clip", 22) + plane("far_clip", 28)));
    ASSERT_EQ(between.size(), 1u);
    EXPECT_NE(between[0].find("before near_clip or beyond far_clip"), std::string::npos) << between[0];
    const auto behind = notes_about_clipping(
        camera(type, "<transform name=\"to_world\"><rotate y=\"1\" angle=\"180\"/></transform>"));
    ASSERT_EQ(behind.size(), 1u);
    EXPECT_NE(behind[0].find("clip.xml:2:1: every shape lies behind the camera"), std::string::npos)
        << behind[0];
  }
}

TEST(Clipping, OfParallelProjectionIsMeasuredAsItsRaysAre) {
  // A scale of 2 along the axis: the near plane at 10 of the camera is 20 in the world, and rays are 15 - 10 long.
  const auto scaled = [](double far) {
    return camera("orthographic", "<transform name=\"to_world\"><scale z=\"2\"/></transform>" +
                                      plane("near_clip", 11) + plane("far_clip", far));
  };
  EXPECT_EQ(notes_about_clipping(scaled(17.9)).size(), 1u);  // 22 + 6.9 = 28.9: before the second sphere
  EXPECT_TRUE(notes_about_clipping(scaled(18.1)).empty());
}

TEST(Clipping, OfEachCameraOfABatch) {
  const std::string batch = "<sensor type=\"batch\">" + camera("perspective", plane("far_clip", 5)) +
                            camera("perspective", "") +
                            "<film type=\"hdrfilm\"><integer name=\"width\" value=\"64\"/></film></sensor>";
  EXPECT_EQ(notes_about_clipping(batch).size(), 1u);
}

}  // namespace
}  // namespace aureole::test

// SPDX-License-Identifier: Apache-2.0
// A lamp and a receiver change places and the power stays, around edges, too; and whatever lies behind a thick block is lit by edges only,
// the same from both ends.
#include <gtest/gtest.h>

#include <string>

#include "harness/effort.h"
#include "render/edge_scenes.h"

namespace aureole::test {
namespace {

using testing::Picture;

/// Black; only its edges diffract.
std::string block(double half_height) {
  return fmt::format(
      R"(<shape type="cube"><transform name="to_world"><scale x="0.3" y="0.3" z="{}"/></transform>
    <bsdf type="freespacediffraction"><float name="scale" value="1"/>{}</bsdf></shape>)",
      half_height, grey(0));
}

/// Returns what the receiver has without diffraction.
double expect_exchange(const std::string& scene, const char* a, const char* b, int samples) {
  const int n = effort(samples, 8 * samples);
  for (const char* integrator : kIntegrators)
    expect_equal(integrator, measured(scene + point(a), {integrator, n}, receiver(b), 1),
                 measured(scene + point(b), {integrator, n}, receiver(a), 2), 0.04);
  return measured(scene + point(a), {"path", n, 4, false}, receiver(b), 3).all;
}

std::string plate(const char* transform) {
  return rectangle(std::string(R"(<scale value="0.25"/>)") + transform, grey(0.7));
}

// There is a wall beside the lamp and one in the shadow.
TEST(EdgeExchange, OfLampAndReceiverAroundABlock) {
  const std::string scene = block(0.3) + plate(R"(<translate x="0.5" z="-0.7"/>)") +
                            plate(R"(<rotate y="1" angle="90"/><translate x="-1.5" z="0.9"/>)");
  EXPECT_EQ(expect_exchange(scene, "-0.8, -0.1, 0.7", "0.9, 0, -0.4", 4096), 0);
}
TEST(EdgeExchange, OfLampAndReceiverAroundAnEdge) {
  const std::string scene = only_edges() + plate(R"(<translate x="-0.4" z="-0.8"/>)") +
                            plate(R"(<rotate y="1" angle="90"/><translate x="-1" z="0.6"/>)");
  EXPECT_EQ(expect_exchange(scene, "-0.4, -0.2, 0.9", "-0.15, 0.1, -0.5", 2048), 0);
}
// The light that comes straight passes the edge within a beam.
TEST(EdgeExchange, OfLampAndReceiverBesideAnEdge) {
  EXPECT_GT(expect_exchange(only_edges(), "0.05, 0.02, 0.9", "0.03, 0, -0.5", 1024), 0.5);
}

void expect_edges_only(const std::string& scene, const std::string& sensor, int samples, int depth) {
  const int n = effort(samples, 8 * samples);
  Picture by_path;
  for (const char* integrator : kIntegrators) {
    const Picture p = measured(scene, {integrator, n, depth}, sensor, std::uint64_t(integrator[0]));
    if (!kSanitized) {
      EXPECT_GT(p.all, 0) << integrator;
    }
    EXPECT_EQ(measured(scene, {integrator, n, depth, false}, sensor, 1).all, 0) << integrator;
    if (integrator == kIntegrators[0]) {
      by_path = p;
    } else {
      expect_equal(integrator, by_path, p, 0.08);
    }
  }
}

// From a lamp far behind a block, light comes to its other side around two edges; to places at the side of the block, around one.
TEST(BehindABlock, IsLightOfEdgesOnly) {
  expect_edges_only(block(0.6) + point("0.02, 0.01, 2"), receiver("0, 0, -2"), 4096, 3);
  expect_edges_only(block(0.3) + point("-0.8, -0.1, 0.7"), receiver("0.9, 0, -0.4"), 2048, 3);
}
TEST(BehindABlock, ACameraSeesLightOfEdgesOnly) {
  const std::string camera = R"(<sensor type="perspective"><float name="fov" value="18"/>
    <transform name="to_world"><lookat origin="0.2, 0, -1.6" target="1.2, 0, -0.35" up="0, 0, 1"/></transform>)";
  expect_edges_only(block(0.3) + point("-0.8, -0.1, 0.7") +
                        plate(R"(<rotate y="1" angle="90"/><translate x="1.2" z="-0.35"/>)"),
                    camera, 8192, 3);
}

}  // namespace
}  // namespace aureole::test

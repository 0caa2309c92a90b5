// SPDX-License-Identifier: Apache-2.0
// Edges that places of a sensor are known to see (scene/edge/seen_edges.h): tables say what rays would, and change the noise of a power
// map only. The reference is a picture of a white screen, whose light comes by another choice of edges.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>

#include "aureole/loading/load.h"
#include "aureole/scene/edge/scene_diffraction.h"
#include "aureole/scene/scene.h"
#include "harness/effort.h"
#include "harness/rendered.h"

namespace aureole::testing {
namespace {

using test::kSanitized;

/// A black sheet whose border has `pieces` pieces, between a lamp and the points where it casts a shadow, parted by a wall across the
/// border. Two laths over the points occlude the part of the border at y = 40 to 50 mm from the points of the tables.
std::string sheet_in_pieces(int pieces) {
  const auto sheet = [](double x, double y, double z, double half_x, double half_y) {
    return fmt::format(
        "<shape type='rectangle'><transform name='to_world'><scale x='{}' y='{}'/><translate x='{}' "
        "y='{}' z='{}'/></transform><bsdf type='diffuse'><spectrum name='reflectance' "
        "value='0'/></bsdf></shape>",
        half_x, half_y, x, y, z);
  };
  std::string all = sheet(-0.1, 0.038, -0.9, 0.1, 0.001) + sheet(-0.1, 0.106, -0.9, 0.1, 0.001);
  const double half = 0.2 / pieces;
  for (int i = 0; i < pieces; ++i) all += sheet(-5, half * (2 * i + 1) - 0.2, 0, 5, half);
  return all + R"(
  <shape type="rectangle"><transform name="to_world"><scale x="0.2" y="0.47"/><rotate x="1" angle="90"/>
    <translate z="-0.49"/></transform><bsdf type="diffuse"><spectrum name="reflectance" value="0"/></bsdf></shape>
  <emitter type="point"><point name="position" x="0" y="0.001" z="1"/><spectrum name="intensity" value="1"/></emitter>)";
}
std::string integrator(const char* type, int depth) {
  return "<integrator type='" + std::string(type) + "'><integer name='max_depth' value='" +
         std::to_string(depth) +
         "'/><boolean name='diffraction' value='true'/><string name='diffraction_model' value='beams'/><string name='beam_width' value='25 wavelengths'/></integrator>";
}
std::string film(int samples) {
  return R"(<film type="specfilm"><integer name="width" value="8"/><integer name="height" value="8"/><rfilter type="box"/>
    <float name="wavelength_min" value="549"/><float name="wavelength_max" value="551"/>
    <integer name="bins" value="1"/><boolean name="preview" value="false"/></film>
    <sampler type="independent"><integer name="sample_count" value=")" +
         std::to_string(samples) + R"("/></sampler></sensor>)";
}
std::string power_map(const char* type, int pieces = 40) {
  return integrator(type, 2) + R"(<sensor type="powermap"><string name="measure" value="irradiance"/>
    <transform name="to_world"><scale x="0.02" y="0.15"/><translate x="-0.04" z="-1"/></transform>)" +
         film(32) + sheet_in_pieces(pieces);
}

TEST(SeenEdges, ChangeNoMeanOfAPowerMap) {
  const Picture screen = render(
      integrator("path", 3) + R"(
    <sensor type="orthographic"><transform name="to_world"><scale x="0.02" y="0.15"/>
      <lookat origin="-0.04, 0, -0.98" target="-0.04, 0, -1" up="0, 1, 0"/></transform>)" +
      film(kSanitized ? 4 : 64) +
      R"(<shape type="rectangle"><transform name="to_world"><scale value="9"/><translate z="-1"/></transform>
      <bsdf type="diffuse"><spectrum name="reflectance" value="1"/></bsdf></shape>)" +
      sheet_in_pieces(40));
  const double expected = std::numbers::pi * screen.all, expected_error = std::numbers::pi * screen.all_error;
  if (!kSanitized) {
    EXPECT_LT(expected_error, 0.04 * expected);
  }
  // With 200 pieces a place sees more than a table holds.
  for (const auto& [type, pieces] :
       {std::pair{"path", 40}, std::pair{"ptracer", 40}, std::pair{"ptracer", 200}}) {
    const Picture map = render(power_map(type, pieces));
    std::printf("%s: %.5g +- %.2g, screen %.5g +- %.2g\n", type, map.all, map.all_error, expected,
                expected_error);
    EXPECT_NEAR(map.all, expected, 4 * std::hypot(map.all_error, expected_error)) << type;
    EXPECT_LT(map.all_error, 0.02 * expected) << type;
  }
}

TEST(SeenEdges, TablesHoldThoseOnTheSensorsSideOfTheWall) {
  const auto scene =
      load_scene_from_string("<scene version='3.0.0'>" + power_map("path") + "</scene>", "pieces.xml").scene;
  const Light& lamp = scene->emitters().front();
  const std::vector<MeshEdge>& edges = scene->diffraction()->edges().index().edges();
  const SceneEdges::Beams beams =
      scene->diffraction()->edges().beams(Wavelengths::at(scene->parts().context->grid, Spectrum(550.f)));
  int same_side = 0, other_side = 0;
  for (const float x : {0.1f, 0.6f, 0.9f})
    for (const float y : {0.05f, 0.3f, 0.7f, 0.95f}) {
      const auto eye = scene->sensor().sample_direct(scene->bounds().center(), {x, y});
      ASSERT_TRUE(eye);
      const SeenEdges::Table* table = scene->diffraction()->seen_edges().from(lamp, 0, {x, y});
      ASSERT_NE(table, nullptr);
      ASSERT_FALSE(table->edges.empty());
      for (const std::uint32_t number : table->edges) {
        EXPECT_TRUE(table->has(number));
        const Vec3 middle = 0.5f * (edges[number].a + edges[number].b);
        // Beside the wall, which is .4 m wide and ends 2 cm below the sheet.
        if (std::abs(middle.x) < 0.01f && std::abs(middle.z) < 0.01f && std::abs(middle.y) > 0.02f)
          ++((middle.y > 0) == (eye->p.y > 0) ? same_side : other_side);
      }
      EXPECT_FALSE(table->has(std::uint32_t(edges.size())));
      std::map<std::uint32_t, int> chosen;
      std::map<std::uint32_t, float> probability;
      for (int i = 0; i < 10000; ++i) {
        const SeenEdges::Table::Choice choice = table->choose(
            scene->diffraction()->edges(), {eye->p}, {{0, 0.001f, 1}}, beams, (float(i) + 0.5f) / 10000);
        ++chosen[choice.edge], probability[choice.edge] = choice.probability;
      }
      // All are chosen, each as often as it says.
      EXPECT_EQ(chosen.size(), table->edges.size());
      for (const auto& [edge, times] : chosen) EXPECT_NEAR(float(times), 10000 * probability[edge], 1.1f);
    }
  const SeenEdges::Table* table = scene->diffraction()->seen_edges().from(lamp, 0, {0.5f, 0.3f});
  int hidden = 0;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const Vec3 middle = 0.5f * (edges[i].a + edges[i].b);
    if (std::abs(middle.x) > 0.01f || std::abs(std::abs(middle.y) - 0.045f) > 0.001f) continue;
    hidden += !table->has(std::uint32_t(i));
  }
  EXPECT_GE(hidden, 1);
  EXPECT_EQ(
      load_scene_from_string("<scene version='3.0.0'>" + power_map("path", 200) + "</scene>", "pieces.xml")
          .scene->diffraction()
          ->seen_edges()
          .from(lamp, 0, {0.5f, 0.3f}),
      nullptr);
  EXPECT_GT(same_side, 100);
  EXPECT_EQ(other_side, 0);
}

TEST(SeenEdges, FewEdgesHaveTables) {
  const auto scene =
      load_scene_from_string(
          "<scene version='3.0.0'>" + integrator("path", 3) +
              R"(<sensor type="powermap"><transform name="to_world"><translate z="-3"/></transform>)" +
              film(1) +
              R"(<shape type="cube"/><emitter type="point"><point name="position" x="9" y="0" z="0"/></emitter></scene>)",
          "cube.xml")
          .scene;
  const SeenEdges::Table* table =
      scene->diffraction()->seen_edges().from(scene->emitters().front(), 0, {0.5f, 0.5f});
  ASSERT_NE(table, nullptr);
  EXPECT_FALSE(table->edges.empty());
  EXPECT_LT(table->edges.size(), 12u) << "no place sees all edges of a cube that the lamp shines on";
}

}  // namespace
}  // namespace aureole::testing

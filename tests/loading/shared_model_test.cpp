// SPDX-License-Identifier: Apache-2.0
// Tables that equal objects share, and that nobody waits for where the scene has errors; all problems of one
// object at once.
#include <gtest/gtest.h>

#include "aureole/loading/document.h"
#include "loading/test_plugins.h"

namespace aureole {
namespace {

using test::errors_of;

/// A BSDF with tables.
struct Tabulated : Object {
  explicit Tabulated(const Properties& p) : Object(p) {
    radius = p.get_float("radius", 1, Range::positive());
    bins = int(p.get_int("bins", 8, {1, 1000}));
    table = p.shared_model<double>([&] {
      ++tables_made;
      return std::make_shared<const double>(p.get_float("height", 1) * radius);
    });
  }
  double radius;
  int bins;
  std::shared_ptr<const double> table;
  static inline int tables_made = 0;
};
const PluginRegistration kTabulated(test::test_plugin<Tabulated>("bsdf", "test_tabulated",
                                                                 {"radius", "bins", "height"}));

std::string layer(const std::string& id, const std::string& radius) {
  return "<bsdf type='test_tabulated' id='" + id + "'><float name='radius' value='" + radius +
         "'/><float name='height' value='3'/></bsdf>\n";
}

/// How many tables are made in a scene that holds these objects.
int tables_of(const std::string& objects) {
  Tabulated::tables_made = 0;
  errors_of(objects);
  return Tabulated::tables_made;
}

TEST(SharedModel, EqualObjectsShareTheirTables) {
  std::string many;
  for (int i = 0; i < 101; ++i) many += layer("l" + std::to_string(i), "1");
  EXPECT_EQ(errors_of(many), std::vector<std::string>{});
  EXPECT_EQ(tables_of(many), 1);
  EXPECT_EQ(tables_of(many + layer("other", "2")), 2);
}

TEST(SharedModel, ScenesWithErrorsGetNoTables) {
  EXPECT_EQ(tables_of(layer("a", "1") + layer("a", "2")), 0);  // the id is taken
  EXPECT_EQ(tables_of("<bsdf type='test_bsdf'><ref id='nothing'/></bsdf>" + layer("a", "1")), 0);
  // Problems are reported all the same, and no others follow from the missing tables.
  const auto errors = errors_of(layer("a", "1") + layer("a", "-2"));
  ASSERT_EQ(errors.size(), 2u) << ::testing::PrintToString(errors);
  EXPECT_NE(errors[0].find("the id \"a\" is taken"), std::string::npos) << errors[0];
  EXPECT_NE(errors[1].find("must be > 0, got -2"), std::string::npos) << errors[1];
}

TEST(SharedModel, OneModelAcrossEdits) {
  SceneDocument document(
      "<scene version='3.0.0'><sensor type='perspective'/>" + layer("a", "1") + layer("b", "1") + "</scene>",
      "test.xml");
  Tabulated::tables_made = 0;
  document.edit({{"a.radius", "<float value='2'/>"}});
  EXPECT_EQ(Tabulated::tables_made, 1);
  document.edit({{"b.radius", "<float value='2'/>"}});
  EXPECT_EQ(Tabulated::tables_made, 1);
}

TEST(Problems, AllOfOneObjectAtOnce) {
  const auto errors = errors_of(
      "<bsdf type='test_bsdf'>\n<float name='amount' value='2'/>\n<string name='flag' value='yes'/>\n"
      "<float name='thickness' value='2'/>\n<float name='amuont' value='2'/>\n</bsdf>");
  ASSERT_EQ(errors.size(), 4u) << ::testing::PrintToString(errors);
  EXPECT_TRUE(errors[0].starts_with("test.xml:4:")) << errors[0];
  EXPECT_NE(errors[0].find("must be in [0, 1], got 2"), std::string::npos) << errors[0];
  EXPECT_NE(errors[1].find("expected a boolean, got a string"), std::string::npos) << errors[1];
  EXPECT_NE(errors[2].find("a physical length needs a unit"), std::string::npos) << errors[2];
  EXPECT_NE(errors[3].find("unknown parameter \"amuont\""), std::string::npos) << errors[3];
}

TEST(Problems, OfRoughSurfaces) {
  const auto errors = errors_of(
      "<bsdf type='roughconductor'>\n<string name='distribution' value='bekmann'/>\n"
      "<float name='alpha' value='-3'/>\n</bsdf>");
  ASSERT_EQ(errors.size(), 2u) << ::testing::PrintToString(errors);
  EXPECT_NE(errors[0].find("did you mean \"beckmann\""), std::string::npos) << errors[0];
  EXPECT_NE(errors[1].find("must be in (0, 100], got -3"), std::string::npos) << errors[1];
}

TEST(Problems, OfShapesAndTheirGeometry) {
  const auto errors = errors_of(
      "<shape type='sphere'>\n<float name='radius' value='-1'/>\n<string name='center' value='x'/>\n"
      "<string name='priority' value='high'/>\n</shape>");
  ASSERT_EQ(errors.size(), 3u) << ::testing::PrintToString(errors);
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_TRUE(errors[i].starts_with("test.xml:" + std::to_string(4 + i) + ":")) << errors[i];
}

TEST(TextureRoles, ATextureInATextureMeansWhatTheOuterOneIsFor) {
  const auto checker = [](const std::string& name, const std::string& color) {
    return "<texture type='checkerboard' name='" + name + "'>\n<rgb name='color0' value='" + color +
           "'/><texture type='checkerboard' name='color1'><rgb name='color0' value='" + color +
           "'/></texture></texture>";
  };
  const auto lamp = [&](const std::string& color) {
    return "<shape type='rectangle'><emitter type='area'>" + checker("radiance", color) +
           "</emitter></shape>";
  };
  EXPECT_EQ(errors_of(lamp("30, 20, 10")), std::vector<std::string>{});
  EXPECT_EQ(errors_of("<shape type='rectangle'><bsdf type='principledthin'>" +
                      checker("diff_trans", "1.4, 1.4, 1.4") + "</bsdf></shape>"),
            std::vector<std::string>{});
  const auto errors = errors_of("<shape type='rectangle'><bsdf type='diffuse'>" +
                                checker("reflectance", "30, 20, 10") + "</bsdf></shape>");
  ASSERT_EQ(errors.size(), 1u) << ::testing::PrintToString(errors);
  EXPECT_TRUE(errors[0].starts_with("test.xml:4:1: parameter \"color0\" of \"checkerboard\"")) << errors[0];
}

TEST(TextureRoles, NumbersOfAnEmissionMultiplyD65) {
  // A checkerboard of equal numbers is the number.
  const auto power = [](const std::string& radiance) {
    const LoadedScene loaded = load_scene_from_string(
        "<scene version='3.0.0'><sensor type='perspective'/><shape type='rectangle'><emitter type='area'>" +
            radiance + "</emitter></shape></scene>",
        "test.xml");
    return loaded.scene->emitters().at(0).power_spectrum();
  };
  const SampledSpectrum number = power("<float name='radiance' value='3'/>"),
                        squares = power(
                            "<texture name='radiance' type='checkerboard'><float name='color0' value='3'/>"
                            "<float name='color1' value='3'/></texture>");
  for (std::size_t i = 0; i < number.nodes().size(); ++i)
    EXPECT_NEAR(squares.nodes()[i], number.nodes()[i], 1e-5f * number.nodes()[i]);
}

}  // namespace
}  // namespace aureole

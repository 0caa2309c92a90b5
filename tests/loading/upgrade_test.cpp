// SPDX-License-Identifier: Apache-2.0
#include "aureole/loading/upgrade.h"

#include <gtest/gtest.h>

#include "aureole/loading/parse.h"
#include "aureole/loading/values.h"

namespace aureole {
namespace {

/// The first child of an upgraded 0.6 scene.
struct Upgraded : Diagnostics {
  explicit Upgraded(const std::string& element, const std::string& version = "0.6.0")
      : scene(
            parse_scene("old.xml", "<scene version='" + version + "'>\n" + element + "</scene>", {}, *this)) {
    upgrade(scene.root, *this);
  }
  ParsedScene scene;
  Node& node() { return scene.root.children.at(0); }
  Node& child(std::size_t i) { return node().children.at(i); }
};

TEST(Upgrade, SnakeCase) {
  EXPECT_EQ(snake_case("toWorld"), "to_world");
  EXPECT_EQ(snake_case("intIOR"), "int_ior");
  EXPECT_EQ(snake_case("kNN"), "k_nn");
  EXPECT_EQ(snake_case("sampleCount"), "sample_count");
  EXPECT_EQ(snake_case("reflectance"), "reflectance");
}

TEST(Upgrade, OnlyOldFiles) {
  EXPECT_EQ(Upgraded("<shape type='a'><float name='maxDepth' value='1'/></shape>").child(0).get("name"),
            "max_depth");
  EXPECT_EQ(
      Upgraded("<shape type='a'><float name='maxDepth' value='1'/></shape>", "2.0.0").child(0).get("name"),
      "maxDepth");
}

// Mitsuba 0.6 gives a shape with a medium and without a BSDF none; later versions a diffuse one.
TEST(Upgrade, ShapesWithAMediumAndNoBsdfAreInterfaces) {
  const std::string medium = "<medium name='interior' type='homogeneous'/>";
  const auto bsdf = [](Upgraded& u) {
    for (const Node& child : u.node().children)
      if (child.tag == "bsdf") return child.get("type");
    return std::string();
  };
  Upgraded bare("<shape type='sphere'>" + medium + "</shape>");
  EXPECT_EQ(bsdf(bare), "null");
  ASSERT_EQ(bare.notes().size(), 1u);
  EXPECT_NE(bare.notes()[0].find("old.xml:2:22: the shape has a medium and no BSDF"), std::string::npos)
      << bare.notes()[0];
  Upgraded shared(
      "<shape type='sphere'><ref name='exterior' id='air'/></shape>"
      "<medium type='homogeneous' id='air'/>");
  EXPECT_EQ(bsdf(shared), "null");
  Upgraded with_bsdf("<shape type='sphere'>" + medium + "<bsdf type='dielectric'/></shape>");
  EXPECT_EQ(bsdf(with_bsdf), "dielectric");
  // A reference to a BSDF, which may be defined behind the shape, and a light make a surface.
  Upgraded referenced("<shape type='sphere'>" + medium +
                      "<ref id='skin'/></shape><bsdf type='diffuse' id='skin'/>");
  EXPECT_EQ(bsdf(referenced), "");
  Upgraded light("<shape type='sphere'>" + medium + "<emitter type='area'/></shape>");
  EXPECT_EQ(bsdf(light), "");
  Upgraded without("<shape type='sphere'/>");
  EXPECT_EQ(bsdf(without), "");
  Upgraded later("<shape type='sphere'>" + medium + "</shape>", "2.0.0");
  EXPECT_EQ(bsdf(later), "");
}

TEST(Upgrade, NamesWithCapitalsAreReadWithANote) {
  Upgraded u("<shape type='Rectangle'><bsdf type='RoughConductor'/><emitter type='Area'/></shape>", "3.0.0");
  EXPECT_EQ(u.node().get("type"), "rectangle");
  EXPECT_EQ(u.child(0).get("type"), "roughconductor");
  EXPECT_EQ(u.child(1).get("type"), "area");
  ASSERT_EQ(u.notes().size(), 3u);
  EXPECT_NE(u.notes()[2].find("shape \"Rectangle\" is read as \"rectangle\""), std::string::npos)
      << u.notes()[2];
  // A name that is unknown in small letters, too, stays as it is for the error about it.
  EXPECT_EQ(Upgraded("<shape type='Heightfield'/>", "3.0.0").node().get("type"), "Heightfield");
}

TEST(Upgrade, WallsOfSionnaBecomeSlabs) {
  Upgraded u(
      "<bsdf type='itu-radio-material' id='w'><string name='type' value='brick'/><float name='thickness' "
      "value='0.25'/><float name='scattering_coefficient' value='0.3'/><float name='xpd_coefficient' "
      "value='0.0'/></bsdf>",
      "2.1.0");
  EXPECT_EQ(u.node().get("type"), "slab");
  EXPECT_EQ(u.node().get("id"), "w");
  EXPECT_EQ(u.node().named_child("int_ior")->get("value"), "itu_brick");
  EXPECT_EQ(u.node().named_child("thickness")->get("value"), "0.25m");
  ASSERT_EQ(u.notes().size(), 2u);
  EXPECT_NE(u.notes()[0].find("\"scattering_coefficient\" is ignored"), std::string::npos) << u.notes()[0];
  EXPECT_NE(u.notes()[1].find("\"slab\" of itu_brick, 0.25m thick"), std::string::npos) << u.notes()[1];
  EXPECT_TRUE(Upgraded("<bsdf type='itu-radio-material'/>", "2.1.0").has_errors());
}

TEST(Upgrade, RenamesWhatTodaysPluginsCallOtherwise) {
  EXPECT_EQ(
      Upgraded("<bsdf type='diffuse'><rgb name='diffuseReflectance' value='1'/></bsdf>").child(0).get("name"),
      "reflectance");
  EXPECT_EQ(
      Upgraded("<bsdf type='plastic'><rgb name='diffuseReflectance' value='1'/></bsdf>").child(0).get("name"),
      "diffuse_reflectance");
  EXPECT_EQ(Upgraded("<bsdf type='conductor'><float name='extEta' value='1.3'/></bsdf>").child(0).get("name"),
            "ext_ior");
  EXPECT_EQ(Upgraded("<sensor type='a'><transform name='toWorld'><lookAt/></transform></sensor>")
                .child(0)
                .children[0]
                .tag,
            "lookat");
}

TEST(Upgrade, ConductorsInAirKeepNothing) {
  Upgraded u("<bsdf type='roughconductor'><string name='extEta' value='air'/></bsdf>");
  EXPECT_TRUE(u.node().children.empty());
  EXPECT_EQ(u.notes().size(), 1u);
}

TEST(Upgrade, SrgbBecomesLinear) {
  Upgraded hex("<bsdf type='diffuse'><srgb name='reflectance' value='#18455c'/></bsdf>");
  EXPECT_EQ(hex.child(0).tag, "rgb");
  const SpectrumLiteral a = parse_rgb(hex.child(0).get("value"));
  EXPECT_NEAR(a.rgb[0], .0091, 5e-5);
  EXPECT_NEAR(a.rgb[1], .0595, 5e-5);
  EXPECT_NEAR(a.rgb[2], .1070, 5e-5);
  Upgraded list("<bsdf type='diffuse'><srgb name='reflectance' value='0.5, 0 1'/></bsdf>");
  const SpectrumLiteral b = parse_rgb(list.child(0).get("value"));
  EXPECT_NEAR(b.rgb[0], 0.21404114, 1e-8);
  EXPECT_EQ(b.rgb[1], 0);
  EXPECT_EQ(b.rgb[2], 1);
}

TEST(Upgrade, BlackbodyBecomesASpectrumPlugin) {
  Upgraded u("<emitter type='area'><blackbody name='radiance' temperature='5000K' scale='2'/></emitter>");
  EXPECT_FALSE(u.has_errors());
  EXPECT_EQ(object_family(u.child(0)), "texture");
  EXPECT_EQ(u.child(0).get("type"), "blackbody");
  EXPECT_EQ(u.child(0).named_child("temperature")->get("value"), "5000");
  EXPECT_EQ(u.child(0).named_child("scale")->get("value"), "2");
  EXPECT_EQ(u.child(0).find("temperature"), nullptr);
}

TEST(Upgrade, UvScaleAndOffsetBecomeATransform) {
  Upgraded u(
      "<texture type='checkerboard'><float name='voffset' value='0.5'/><float name='uscale' "
      "value='4'/></texture>");
  ASSERT_EQ(u.node().children.size(), 1u);
  Diagnostics d;
  const Transform t = parse_transform(u.child(0), d);
  EXPECT_EQ(u.child(0).get("name"), "to_uv");
  EXPECT_EQ(t, Transform::scale(4, 1, 1) * Transform::translate(0, 0.5, 0));
}

TEST(Upgrade, LdrFilmBecomesHdrFilm) {
  Upgraded u(
      "<film type='ldrfilm'><boolean name='banner' value='false'/>\n<float name='gamma' value='2.2'/>"
      "<string name='fileFormat' value='png'/><integer name='width' value='5'/>"
      "<string name='label[10, 10]' value='hello'/></film>");
  EXPECT_EQ(u.node().get("type"), "hdrfilm");
  ASSERT_EQ(u.node().children.size(), 1u);
  EXPECT_EQ(u.child(0).get("name"), "width");
  ASSERT_EQ(u.notes().size(), 4u);  // all but the banner
  EXPECT_NE(u.notes()[0].find("old.xml:2:1: film \"ldrfilm\" is replaced by \"hdrfilm\""), std::string::npos);
  EXPECT_EQ(u.notes()[2], "old.xml:3:1: \"gamma\" has no effect and is ignored");
}

TEST(Upgrade, DropsParametersWithoutMeaning) {
  Upgraded u("<integrator type='path'><boolean name='strictNormals' value='true'/></integrator>");
  EXPECT_TRUE(u.node().children.empty());
  EXPECT_EQ(u.notes().size(), 1u);
}

TEST(Upgrade, Bitmaps) {
  Upgraded u(
      "<texture type='bitmap'><string name='filterType' value='trilinear'/><float name='gamma' "
      "value='1'/></texture>");
  EXPECT_EQ(u.child(0).get("value"), "bilinear");
  EXPECT_EQ(u.child(1).tag, "boolean");
  EXPECT_EQ(u.child(1).get("name"), "raw");
  EXPECT_EQ(u.notes().size(), 2u);
  Upgraded other("<texture type='bitmap'><float name='gamma' value='2.2'/></texture>");
  EXPECT_TRUE(other.node().children.empty());
}

std::string value_of(Upgraded& u, const char* name) {
  Node* child = u.node().named_child(name);
  return child ? child->get("value") : "none";
}

TEST(Upgrade, EmittersKeepTheirNamesInSnakeCase) {
  Upgraded u(
      "<emitter type='spot'><float name='cutoffAngle' value='30'/><float name='beamWidth' value='5'/>"
      "<float name='samplingWeight' value='2'/></emitter>");
  EXPECT_EQ(value_of(u, "cutoff_angle"), "30");
  EXPECT_EQ(value_of(u, "beam_width"), "5");
  EXPECT_EQ(value_of(u, "sampling_weight"), "2");
  EXPECT_TRUE(u.notes().empty());
}

TEST(Upgrade, CoatingsAreLayersOfTheSameOpticalThickness) {
  Upgraded u(
      "<bsdf type='coating'><float name='intIOR' value='1.7'/><float name='thickness' value='2'/><rgb "
      "name='sigmaA' value='0.1, 0.2, 0.3'/><bsdf type='diffuse'/></bsdf>");
  EXPECT_EQ(u.node().get("type"), "layered");
  EXPECT_EQ(value_of(u, "int_ior"), "1.7");
  EXPECT_EQ(value_of(u, "thickness"), "10um");
  EXPECT_EQ(value_of(u, "alpha"), "0");
  Node medium;
  for (const Node& child : u.node().children)
    if (child.tag == "medium") medium = child;
  ASSERT_TRUE(medium.named_child("sigma_t"));
  EXPECT_EQ(medium.named_child("sigma_t")->get("value"), "0.1, 0.2, 0.3");
  EXPECT_NEAR(std::stod(medium.named_child("scale")->get("value")) * 1e-5, 2, 1e-12);
  EXPECT_EQ(medium.named_child("albedo")->get("value"), "0");
  EXPECT_EQ(u.notes().size(), 1u);

  Upgraded rough("<bsdf type='roughcoating'><float name='alpha' value='0.2'/><bsdf type='diffuse'/></bsdf>");
  EXPECT_EQ(value_of(rough, "alpha"), "0.2");
  EXPECT_EQ(value_of(rough, "int_ior"), "bk7");
  Upgraded smooth(
      "<bsdf type='roughcoating'><float name='alpha' value='0.01'/><bsdf type='diffuse'/></bsdf>");
  EXPECT_EQ(value_of(smooth, "alpha"), "0");
  EXPECT_EQ(smooth.notes().size(), 2u);
}

TEST(Upgrade, SkyAndSun) {
  Upgraded sky(
      "<emitter type='sky'><float name='scale' value='3'/><integer name='resolution' "
      "value='512'/></emitter>");
  EXPECT_EQ(sky.node().get("type"), "sunsky");
  EXPECT_EQ(value_of(sky, "sky_scale"), "3");
  EXPECT_EQ(value_of(sky, "sun_scale"), "0");
  EXPECT_EQ(value_of(sky, "albedo"), "0.15");
  EXPECT_EQ(value_of(sky, "scale"), "none");
  EXPECT_EQ(value_of(sky, "resolution"), "none");
  EXPECT_EQ(sky.notes().size(), 2u);

  Upgraded sun(
      "<emitter type='sun'><float name='sunRadiusScale' value='10'/><vector name='sunDirection' x='1' y='2' "
      "z='3'/>"
      "<rgb name='albedo' value='0.4'/></emitter>");
  EXPECT_EQ(sun.node().get("type"), "sunsky");
  EXPECT_NEAR(std::stod(value_of(sun, "sun_aperture")), 5.358, 1e-12);
  EXPECT_EQ(value_of(sun, "sun_scale"), "1");
  EXPECT_EQ(value_of(sun, "sky_scale"), "0");
  EXPECT_EQ(value_of(sun, "albedo"), "0.4");
  EXPECT_TRUE(sun.node().named_child("sun_direction"));

  Upgraded both(
      "<emitter type='sunsky'><float name='scale' value='4'/><float name='sunScale' value='2'/>"
      "<transform name='toWorld'><rotate x='1' angle='90'/></transform></emitter>");
  EXPECT_EQ(value_of(both, "sun_scale"), "2");
  EXPECT_EQ(value_of(both, "sky_scale"), "4");
  EXPECT_TRUE(both.notes().empty());
  // Before the scene's own steps, y becomes up: the axes of the emitter here are south, west, up.
  const Node& to_world = *both.node().named_child("to_world");
  ASSERT_EQ(to_world.children.size(), 2u);
  EXPECT_EQ(to_world.children[0].tag, "matrix");
  EXPECT_EQ(to_world.children[1].tag, "rotate");

  Upgraded today("<emitter type='sunsky'/>", "3.0.0");
  EXPECT_TRUE(today.node().children.empty());
}

}  // namespace
}  // namespace aureole

// SPDX-License-Identifier: Apache-2.0
// Attributes of meshes: which a file has, their values, and the texture that shows them.
#include "aureole/shape/mesh/mesh_attribute.h"

#include "aureole/loading/load.h"
#include "aureole/shape/mesh/mesh.h"
#include "aureole/shape/mesh/ply_attributes.h"
#include "aureole/spectrum/upsampling.h"
#include "aureole/texture/texture.h"
#include "shape/shape_test_support.h"

namespace aureole {
namespace {

using test::ShapeBuilder;

ply::Element element(const std::vector<std::string>& names) {
  ply::Element e;
  for (const std::string& name : names)
    e.properties.push_back({name, ply::Type::float32, false, ply::Type::uint8});
  return e;
}

TEST(PlyAttributes, NamesAsMitsuba) {
  // Attributes that Mitsuba 3.9.1 finds, as name:number of components.
  const auto names = [](const std::vector<std::string>& properties) {
    std::string all;
    for (const auto& a : ply::find_attributes(element(properties), "vertex_"))
      all += (all.empty() ? "" : " ") + a.name + ":" + std::to_string(a.properties.size());
    return all;
  };
  EXPECT_EQ(names({"x", "y", "z", "red", "green", "blue"}), "vertex_color:3");
  EXPECT_EQ(names({"b", "g", "r"}), "vertex_color:3");
  EXPECT_EQ(names({"paint_r", "paint_g", "paint_b"}), "vertex_paint_color:3");
  EXPECT_EQ(names({"paint_r", "paint_g", "paint_b", "paint_a"}), "");
  EXPECT_EQ(names({"w_x"}), "vertex_w:1");
  EXPECT_EQ(names({"w_0"}), "vertex_w:1");
  EXPECT_EQ(names({"w_1"}), "vertex_w:1");
  EXPECT_EQ(names({"w_r"}), "vertex_w_color:1");
  EXPECT_EQ(names({"w", "w_2", "quality"}), "");
  EXPECT_EQ(names({"a_x", "a_y"}), "");
  EXPECT_EQ(names({"a_x", "a_y", "a_z", "b_1", "b_2", "b_3", "c_x"}), "vertex_a:3 vertex_b:3 vertex_c:1");
  EXPECT_EQ(names({"vertex_a_x", "x", "nx"}), "vertex_vertex_a:1");
  EXPECT_EQ(names({"a_x", "b_y"}), "vertex_a:1");
  ply::Element list = element({"r", "g", "b"});
  list.properties[1].is_list = true;
  EXPECT_TRUE(ply::find_attributes(list, "face_").empty());
}

TEST(PlyAttributes, IntegersAreEncoded) {
  EXPECT_EQ(ply::attribute_value(ply::Type::float32, 0.3), 0.3);
  EXPECT_EQ(ply::attribute_value(ply::Type::uint8, 255), 1);
  EXPECT_NEAR(ply::attribute_value(ply::Type::uint8, 128), 0.21586, 1e-5);
  EXPECT_NEAR(ply::attribute_value(ply::Type::uint16, 32768), 0.214048, 1e-5);  // Mitsuba 3.9.1
  EXPECT_EQ(ply::attribute_value(ply::Type::uint16, 0), 0);
}

/// Triangle (0, 0), (1, 0), (0, 1), with attributes.
const std::string kHead =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n";

class MeshAttributeTest : public test::FileTest {
protected:
  /// A scene of one mesh on which a diffuse BSDF shows the attribute.
  std::string scene(const std::string& name, const std::string& more = "", const std::string& shape = "ply",
                    const std::string& around = "") const {
    const std::string mesh =
        "<shape type=\"" + shape + "\">" +
        (shape == "ply" ? R"(<string name="filename" value="mesh.ply"/>)" : "") +
        R"(<bsdf type="twosided"><bsdf type="diffuse"><texture name="reflectance" type="mesh_attribute">
<string name="name" value=")" +
        name + "\"/>" + more + "</texture></bsdf></bsdf></shape>";
    return R"(<scene version="3.0.0"><integrator type="path"/><sensor type="perspective"><film type="hdrfilm"/></sensor>
<emitter type="constant"/>)" +
           (around.empty()
                ? mesh
                : around.substr(0, around.find('@')) + mesh + around.substr(around.find('@') + 1)) +
           "</scene>";
  }
  LoadedScene load(const std::string& text) const {
    return load_scene_from_string(text, folder_ / "test.xml");
  }
  std::string error(const std::string& text) const {
    try {
      load(text);
      return "";
    } catch (const Error& e) {
      return e.what();
    }
  }
  /// f of the BSDF there, times pi: the reflectance.
  static Spectrum reflectance(const LoadedScene& loaded, float x, float y, const Wavelengths& w) {
    const auto hit = loaded.scene->intersect({{x, y, 5}, {0, 0, -1}});
    EXPECT_TRUE(hit);
    if (!hit) return 0.f;
    return hit->surface->bsdf->eval({0, 0, 1}, {0, 0, 1}, BsdfContext{w, *hit}) * kPi;
  }
};

const Spectrum kNm = make_spectrum([](int i) { return 420.f + 300.f * float(i) / kWavelengths; });

TEST_F(MeshAttributeTest, VerticesAreInterpolated) {
  write("mesh.ply",
        kHead +
            "property float t_x\nproperty float r\nproperty float g\nproperty float b\nelement face 2\n"
            "property list uchar int vertex_indices\nend_header\n"
            "0 0 0 .1  .8 .1 .1\n1 0 0 .5  .1 .7 .2\n0 1 0 .9  .2 .2 .9\n9 9 9 0  0 0 0\n"
            "3 0 0 1\n3 0 1 2\n");  // the first face is degenerate, and dropped
  const LoadedScene numbers = load(scene("vertex_t"));
  const Wavelengths w = Wavelengths::at(numbers.scene->wavelengths().grid(), kNm);
  EXPECT_NEAR(reflectance(numbers, 0.2f, 0.3f, w)[0], 0.5f * 0.1f + 0.2f * 0.5f + 0.3f * 0.9f, 1e-5f);
  EXPECT_NEAR(reflectance(numbers, 0.2f, 0.3f, w)[3], 0.42f, 1e-5f);
  // Spectra are interpolated, not colours.
  const LoadedScene colors = load(scene("vertex_color", R"(<float name="scale" value="0.5"/>)"));
  const Spectrum found = reflectance(colors, 0.2f, 0.3f, w);
  for (int j = 0; j < kWavelengths; ++j) {
    const float nm = w.nm[j];
    const float expected = 0.5f * upsample_srgb(.8f, .1f, .1f).at(nm) +
                           0.2f * upsample_srgb(.1f, .7f, .2f).at(nm) +
                           0.3f * upsample_srgb(.2f, .2f, .9f).at(nm);
    EXPECT_NEAR(found[j], 0.5f * expected, 1e-5f);
  }
  // Attributes that no texture reads are not kept.
  EXPECT_EQ(
      numbers.scene->parts().surfaces[0].shape->memory_bytes() + 4 * (sizeof(UpsampledColor) - sizeof(float)),
      colors.scene->parts().surfaces[0].shape->memory_bytes());
}

TEST_F(MeshAttributeTest, FacesKeepTheirsThroughPolygonsAndDroppedTriangles) {
  write("mesh.ply", kHead +
                        "element face 3\nproperty float t_x\nproperty list uchar int vertex_indices\n"
                        "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n"
                        "0 0 0\n1 0 0\n1 1 0\n0 1 0\n"
                        ".9 3 0 0 1 255 0 0\n.25 4 0 1 2 3 0 0 255\n.7 3 0 1 1 0 255 0\n");
  const LoadedScene numbers = load(scene("face_t"));
  const Wavelengths w = Wavelengths::at(numbers.scene->wavelengths().grid(), kNm);
  EXPECT_NEAR(reflectance(numbers, 0.7f, 0.2f, w)[0], 0.25f, 1e-6f);
  EXPECT_NEAR(reflectance(numbers, 0.2f, 0.7f, w)[0], 0.25f, 1e-6f);
  const LoadedScene colors = load(scene("face_color"));
  EXPECT_NEAR(reflectance(colors, 0.2f, 0.7f, w)[1], upsample_srgb(0, 0, 1).at(w.nm[1]), 1e-5f);
}

TEST_F(MeshAttributeTest, ThroughInstances) {
  write("mesh.ply",
        kHead +
            "property float t_x\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
            "0 0 0 .1\n1 0 0 .5\n0 1 0 .9\n9 9 9 0\n3 0 1 2\n");
  const LoadedScene s =
      load(scene("vertex_t", "", "ply",
                 R"(<shape type="shapegroup" id="g">@</shape><shape type="instance"><ref id="g"/>
<transform name="to_world"><scale x="-2" y="3" z="1"/><translate x="7"/></transform></shape>)"));
  const Wavelengths w = Wavelengths::at(s.scene->wavelengths().grid(), kNm);
  EXPECT_NEAR(reflectance(s, 7 - 2 * 0.2f, 3 * 0.3f, w)[0], 0.42f, 1e-5f);
}

TEST_F(MeshAttributeTest, AsAnEmittersRadiance) {
  write("mesh.ply",
        kHead +
            "property float t_x\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
            "0 0 0 1\n1 0 0 5\n0 1 0 9\n9 9 9 0\n3 0 1 2\n");
  const LoadedScene s = load(
      R"(<scene version="3.0.0"><integrator type="path"/><sensor type="perspective"><film type="hdrfilm"/>
</sensor><shape type="ply"><string name="filename" value="mesh.ply"/><emitter type="area">
<texture name="radiance" type="mesh_attribute"><string name="name" value="vertex_t"/></texture></emitter></shape></scene>)");
  const Wavelengths w = Wavelengths::at(s.scene->wavelengths().grid(), kNm);
  const Light& lamp = s.scene->emitters().at(0);
  test::Random random(1);
  for (int i = 0; i < 100; ++i) {
    // A sample has its position in the triangle; a ray that hits it has the same attribute there.
    const auto sample = lamp.sample_direct({0.3f, 0.2f, 2}, 0, random.square(), w);
    ASSERT_TRUE(sample);
    EXPECT_NEAR(sample->radiance[0], 1 + 4 * sample->p.x + 8 * sample->p.y, 1e-4f);
    const auto hit = s.scene->intersect({{0.3f, 0.2f, 2}, sample->wo});
    if (hit) {
      EXPECT_NEAR(lamp.eval(*hit, -sample->wo, w)[0], sample->radiance[0], 1e-4f);
    }
    const auto ray = lamp.sample_ray(0, random.square(), random.square(), w);
    ASSERT_TRUE(ray);
    EXPECT_NEAR(ray->value[0] / std::abs(ray->d.z), 1 + 4 * ray->p.x + 8 * ray->p.y, 1e-3f);
  }
  // The mean over the vertices: (1 + 5 + 9 + 0) / 4.
  EXPECT_NEAR(lamp.power_spectrum().nodes()[10], kPi * 0.5f * 3.75f, 1e-3f);
}

TEST_F(MeshAttributeTest, WhatIsWrongIsSaid) {
  const auto with = [&](const std::string& values) {
    write("mesh.ply",
          kHead +
              "property float t_x\nproperty float r\nproperty float g\nproperty float b\nelement face 1\n"
              "property list uchar int vertex_indices\nend_header\n0 0 0 " +
              values + "\n1 0 0 .5 .1 .1 .1\n0 1 0 .9 .1 .1 .1\n9 9 9 0 0 0 0\n3 0 1 2\n");
  };
  const auto expect = [](const std::string& found, const std::string& part) {
    EXPECT_NE(found.find(part), std::string::npos) << found;
    EXPECT_NE(found.find("test.xml:"), std::string::npos) << found;
  };
  with(".5 .1 .1 .1");
  EXPECT_EQ(error(scene("vertex_t")), "");
  expect(error(scene("vertex_s")), "it has: vertex_color, vertex_t");
  expect(error(scene("face_color")), "no attribute \"face_color\"");
  expect(error(scene("color")), "starts with");
  expect(error(scene("vertex_t", "", "sphere")), "only meshes");
  expect(error(scene("vertex_t", "", "rectangle")), "nor any other");
  with("1.5 .1 .1 .1");
  expect(error(scene("vertex_t")), "goes up to 1.5");
  EXPECT_EQ(error(scene("vertex_t", R"(<float name="scale" value="0.6"/>)")), "");
  EXPECT_EQ(error(scene("vertex_color")), "");
  with("-.5 .1 .1 .1");
  expect(error(scene("vertex_t")), "negative");
  with(".5 1.2 .1 .1");
  expect(error(scene("vertex_color")), "goes up to");
  with(".5 -1 .1 .1");
  expect(error(scene("vertex_color")), "vertex 0");
  with("nan .1 .1 .1");
  expect(error(scene("vertex_t")), "not finite");
  EXPECT_EQ(error(scene("vertex_color")), "") << "nobody asks for the NaN";
}

}  // namespace
}  // namespace aureole

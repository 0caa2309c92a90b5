// SPDX-License-Identifier: Apache-2.0
// Materials of OBJ files: BSDFs of the scene by their ids, and those of .mtl files.
#include "aureole/asset/mtl.h"
#include "aureole/core/image.h"
#include "aureole/loading/load.h"
#include "aureole/shape/mesh/mesh.h"
#include "shape/shape_test_support.h"

namespace aureole {
namespace {

/// Two squares, [0, 1]^2 and [1, 2] x [0, 1], each of two triangles, smooth at their edge, and a third one of
/// no material before them.
const std::string kObj =
    "mtllib a.mtl\nv 0 0 0\nv 1 0 0.5\nv 2 0 0\nv 0 1 0\nv 1 1 0.5\nv 2 1 0\nv 5 0 0\nv 6 0 0\nv 5 1 0\n"
    "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 7/1 8/2 9/3\nusemtl red\nf 1/1 2/2 5/3 4/4\nusemtl blue\nf 2/1 3/2 "
    "6/3 5/4\n";

class ObjMaterials : public test::FileTest {
protected:
  LoadedScene load(const std::string& shape_children, const std::string& before = "",
                   const std::string& obj = kObj) const {
    write("mesh.obj", obj);
    return load_scene_from_string(
        R"(<scene version="3.0.0"><integrator type="path"/><sensor type="perspective"><film type="hdrfilm"/></sensor>
<emitter type="constant"/>)" +
            before + R"(
<shape type="obj"><string name="filename" value="mesh.obj"/>)" +
            shape_children + "</shape></scene>",
        folder_ / "test.xml");
  }
  /// Reflectance of the surface that a ray from above hits.
  static Spectrum seen(const LoadedScene& loaded, float x, float y) {
    const Scene& scene = *loaded.scene;
    const auto hit = scene.intersect({{x, y, 5}, {0, 0, -1}});
    if (!hit) return -1.f;
    const Wavelengths w = Wavelengths::at(scene.wavelengths().grid(), Spectrum(550.f));
    return hit->surface->bsdf->eval({0, 0, 1}, {0, 0, 1}, BsdfContext{w, *hit}) * kPi;
  }
  static std::string notes(const LoadedScene& s) {
    std::string all;
    for (const auto& n : s.notes) all += n + "\n";
    for (const Primitive& part : s.scene->parts().surfaces)
      for (const auto& r : part.remarks) all += r + "\n";
    return all;
  }
};

std::string diffuse(const std::string& id, const std::string& value) {
  return "<bsdf type=\"diffuse\" id=\"" + id + "\"><float name=\"reflectance\" value=\"" + value +
         "\"/></bsdf>";
}

TEST_F(ObjMaterials, AreTheBsdfsWithTheirNames) {
  const LoadedScene s = load("", diffuse("red", "0.1") + diffuse("blue", "0.2"));
  ASSERT_EQ(s.scene->parts().surfaces.size(), 3u);
  EXPECT_NEAR(seen(s, 0.4f, 0.5f)[0], 0.1f, 1e-6f);
  EXPECT_NEAR(seen(s, 1.4f, 0.5f)[0], 0.2f, 1e-6f);
  EXPECT_NEAR(seen(s, 5.2f, 0.3f)[0], 0.5f, 1e-6f);  // no material
  std::size_t triangles = 0;
  for (const Primitive& part : s.scene->parts().surfaces) {
    const ShapePtr& shape = part.shape;
    triangles += shape->primitive_count();
    EXPECT_EQ(shape->properties().type(), "obj");
    EXPECT_GT(shape->memory_bytes(), 0u);
  }
  EXPECT_EQ(triangles, 5u);
  // Normals were made for the whole mesh: they meet at the ridge.
  for (const float x : {0.9999f, 1.0001f}) {
    const auto hit = s.scene->intersect({{x, 0.5f, 5}, {0, 0, -1}});
    ASSERT_TRUE(hit);
    EXPECT_GT(hit->shading.n.z, 0.999f);
    EXPECT_LT(hit->ng.z, 0.95f);
  }
  // Texture coordinates stay with their corners (flipped, as always).
  const auto hit = s.scene->intersect({{1.25f, 0.5f, 5}, {0, 0, -1}});
  EXPECT_NEAR(hit->uv.x, 0.25f, 1e-5f);
  EXPECT_NEAR(hit->uv.y, 0.5f, 1e-5f);
  EXPECT_NEAR(s.scene->bounds().upper.x, 6, 1e-6f);
}

TEST_F(ObjMaterials, ABsdfOfTheShapeIsForAll) {
  const LoadedScene s =
      load(R"(<bsdf type="diffuse"><float name="reflectance" value="0.3"/></bsdf>)", diffuse("red", "0.1"));
  ASSERT_EQ(s.scene->parts().surfaces.size(), 1u);
  EXPECT_NEAR(seen(s, 0.4f, 0.5f)[0], 0.3f, 1e-6f);
  EXPECT_EQ(notes(s), "");
  // An emitter is for the whole file, too.
  const LoadedScene lamp = load(R"(<emitter type="area"/>)", diffuse("red", "0.1"));
  EXPECT_EQ(lamp.scene->parts().surfaces.size(), 1u);
  EXPECT_EQ(lamp.scene->emitters().size(), 2u);
}

TEST_F(ObjMaterials, WithoutAnyTheDefaultIsUsed) {
  const LoadedScene s = load("");
  ASSERT_EQ(s.scene->parts().surfaces.size(), 1u);
  EXPECT_NEAR(seen(s, 0.4f, 0.5f)[0], 0.5f, 1e-6f);
  EXPECT_NE(notes(s).find("\"red\", \"blue\""), std::string::npos) << notes(s);
  EXPECT_NE(notes(s).find("a.mtl"), std::string::npos) << notes(s);
  // Only one material has a BSDF in the scene; an id of another family does not count.
  const LoadedScene some = load("", diffuse("blue", "0.2") + R"(<texture type="checkerboard" id="red"/>)");
  EXPECT_NEAR(seen(some, 0.4f, 0.5f)[0], 0.5f, 1e-6f);
  EXPECT_NEAR(seen(some, 1.4f, 0.5f)[0], 0.2f, 1e-6f);
  EXPECT_EQ(some.scene->parts().surfaces.size(), 2u);
}

TEST_F(ObjMaterials, OneMaterialForAllMakesNoParts) {
  const std::string obj =
      kObj.substr(0, kObj.find("f 7/1")) + "usemtl red\nf 1 2 5 4\nusemtl blue\nusemtl red\nf 2 3 6 5\n";
  const LoadedScene s = load("", diffuse("red", "0.1"), obj);
  ASSERT_EQ(s.scene->parts().surfaces.size(), 1u);
  EXPECT_NEAR(seen(s, 0.4f, 0.5f)[0], 0.1f, 1e-6f);
  EXPECT_EQ(s.scene->parts().surfaces[0].triangle_count(), 4u);
}

TEST_F(ObjMaterials, PartsOfAGroupAreInstanced) {
  write("mesh.obj", kObj);
  const LoadedScene s = load_scene_from_string(
      R"(<scene version="3.0.0"><integrator type="path"/><sensor type="perspective"><film type="hdrfilm"/></sensor>
<emitter type="constant"/>)" +
          diffuse("red", "0.1") + diffuse("blue", "0.2") + R"(
<shape type="shapegroup" id="g"><shape type="obj"><string name="filename" value="mesh.obj"/></shape></shape>
<shape type="instance"><ref id="g"/><transform name="to_world"><translate y="3"/></transform></shape></scene>)",
      folder_ / "test.xml");
  EXPECT_EQ(s.scene->parts().surfaces.size(), 1u);
  EXPECT_NEAR(seen(s, 0.4f, 3.5f)[0], 0.1f, 1e-6f);
  EXPECT_NEAR(seen(s, 1.4f, 3.5f)[0], 0.2f, 1e-6f);
}

TEST_F(ObjMaterials, OfAnMtlFile) {
  Image picture;
  picture.width = picture.height = 2;
  picture.channels = {"R", "G", "B"};
  picture.pixels.assign(12, 0.7f);
  std::filesystem::create_directories(folder_ / "maps");
  write_exr(folder_ / "maps/a picture.exr", picture, ExrPixel::float32, {});
  write("a.mtl",
        "# comment\nnewmtl red\nKa 1 1 1\nKd 0.25 0.25 0.25\nillum 1\nKs 1 1 1\nNs 10\n"
        "newmtl blue\n  map_Kd -s 2 2 2 -o 0.5 -clamp on maps\\a picture.exr\r\nmap_Bump b.png\n");
  const LoadedScene s = load("");
  EXPECT_NEAR(seen(s, 0.4f, 0.5f)[0], 0.25f, 1e-6f);
  EXPECT_NEAR(seen(s, 1.4f, 0.5f)[0], 0.7f, 1e-5f);
  EXPECT_NE(notes(s).find("map_Bump ignored"), std::string::npos) << notes(s);
  EXPECT_NE(notes(s).find("test.xml:"), std::string::npos) << notes(s);
  // Both sides.
  const auto below = s.scene->intersect({{0.4f, 0.5f, -5}, {0, 0, 1}});
  const Wavelengths w = Wavelengths::at(s.scene->wavelengths().grid(), Spectrum(550.f));
  EXPECT_FALSE(is_black(below->surface->bsdf->eval({0, 0, -1}, {0, 0, -1}, BsdfContext{w, *below})));
  // A BSDF of the scene takes precedence over the .mtl file's.
  const LoadedScene both = load("", diffuse("red", "0.1"));
  EXPECT_NEAR(seen(both, 0.4f, 0.5f)[0], 0.1f, 1e-6f);
  EXPECT_NEAR(seen(both, 1.4f, 0.5f)[0], 0.7f, 1e-5f);
  // The content of the .mtl file is part of the scene's hash.
  write("a.mtl", "newmtl red\nKd 0.26 0.25 0.25\nnewmtl blue\nKd 1 0 0\n");
  EXPECT_NE(load("").hash, s.hash);
}

/// The types of an object and of the BSDFs below it.
std::string types(const Properties& p) {
  std::string all = p.type();
  for (const auto& e : p.entries())
    if (const auto* child = std::get_if<ObjectPtr>(&e.value))
      if (dynamic_cast<const Bsdf*>(child->get())) all += " " + types((*child)->properties());
  return all;
}

TEST_F(ObjMaterials, HighlightsAndOpacity) {
  const auto has = [](const char* name) { return Registry::instance().find("bsdf", name) != nullptr; };
  write("a.mtl", "newmtl red\nKd .2 .2 .2\nKs .3 .3 .3\nNs 40\nnewmtl blue\nd 0.5\n");
  const LoadedScene s = load("");
  const auto type = [&](float x) {
    return types(s.scene->intersect({{x, 0.5f, 5}, {0, 0, -1}})->surface->bsdf->properties());
  };
  const std::string glossy = has("phong") ? "phong" : has("roughplastic") ? "roughplastic" : "diffuse";
  EXPECT_EQ(type(0.4f), "twosided " + glossy);
  EXPECT_EQ(notes(s).find("highlights") == std::string::npos, glossy != "diffuse");
  EXPECT_EQ(type(1.4f), has("mask") ? "mask twosided diffuse" : "twosided diffuse");
  EXPECT_EQ(notes(s).find("opacity") == std::string::npos, has("mask"));
}

TEST_F(ObjMaterials, PhysicalStatementsAreAPrincipledBsdf) {
  Image grey{1, 1, {"Y"}, {0.25f}, false};
  write_exr(folder_ / "rough.exr", grey, ExrPixel::float32, {});
  write(
      "a.mtl",
      "newmtl red\nKd .8 .6 .4\nKs .5 .5 .5\nNs 250\nNi 1.45\nd 1\nillum 3\nPr .4\nPm .9\nPs .1\nPc .2\nPcr .1\n"
      "aniso .3\nanisor 0\nKe 0 0 0\nnewmtl blue\nKd .2 .2 .2\nPm 1.5\nmap_Pr rough.exr\nmap_Bump -bm 1 n.png\n");
  const LoadedScene s = load("");
  const auto bsdf = [&](float x) { return s.scene->intersect({{x, 0.5f, 5}, {0, 0, -1}})->surface->bsdf; };
  EXPECT_EQ(types(bsdf(0.4f)->properties()), "twosided principled");
  EXPECT_EQ(types(bsdf(1.4f)->properties()), "twosided principled");
  // A BSDF of the scene with these parameters has the same values.
  const LoadedScene own = load(
      "",
      R"(<bsdf type="twosided" id="red"><bsdf type="principled"><rgb name="base_color" value=".8, .6, .4"/>
    <float name="roughness" value=".4"/><float name="metallic" value=".9"/><float name="sheen" value=".1"/>
    <float name="clearcoat" value=".2"/><float name="clearcoat_gloss" value=".9"/><float name="anisotropic" value=".3"/>
    <float name="eta" value="1.45"/></bsdf></bsdf>
    <bsdf type="twosided" id="blue"><bsdf type="principled"><rgb name="base_color" value=".2"/>
    <float name="roughness" value=".25"/><float name="metallic" value="1"/></bsdf></bsdf>)");
  for (const float x : {0.4f, 1.4f}) EXPECT_NEAR(seen(s, x, 0.5f)[0], seen(own, x, 0.5f)[0], 1e-4) << x;
  EXPECT_NE(notes(s).find("map_Bump ignored"), std::string::npos) << notes(s);
  EXPECT_NE(notes(s).find("Pm is cut to [0, 1]"), std::string::npos) << notes(s);
  EXPECT_EQ(notes(s).find("\"red\""), std::string::npos) << notes(s);
}

TEST_F(ObjMaterials, MapsAreScaledAndMoved) {
  // Columns of 0.1, 0.2, 0.3, 0.4, in the row at the bottom ten times less.
  Image picture{4, 2, {"Y"}, {0.1f, 0.2f, 0.3f, 0.4f, 0.01f, 0.02f, 0.03f, 0.04f}, false};
  write_exr(folder_ / "p.exr", picture, ExrPixel::float32, {});
  const auto at = [&](const std::string& options, float x, float y) {
    write("a.mtl", "newmtl red\nmap_Kd " + options + " p.exr\nnewmtl blue\nKd 1 1 1\n");
    return seen(load(""), x, y)[0];
  };
  // Texel centres: u = 1/8 is the first column; v = 1/4 of the file the lower row.
  EXPECT_NEAR(at("", 0.125f, 0.25f), 0.01f, 1e-5);
  EXPECT_NEAR(at("", 0.125f, 0.75f), 0.1f, 1e-5);
  EXPECT_NEAR(at("-o 0.25 0 0", 0.125f, 0.25f), 0.02f, 1e-5);
  EXPECT_NEAR(at("-o 0.25 0.5 0", 0.125f, 0.25f), 0.2f, 1e-5);
  EXPECT_NEAR(at("-s 3 1 1", 0.125f, 0.25f), 0.02f, 1e-5);
  EXPECT_NEAR(at("-s 1 3 1", 0.125f, 0.25f), 0.1f, 1e-5);
  EXPECT_NEAR(at("-s 1 3 1 -o 0.5", 0.125f, 0.25f), 0.3f, 1e-5);
  EXPECT_NEAR(at("-clamp on -o 9 0", 0.125f, 0.25f), 0.04f, 1e-5);
}

TEST_F(ObjMaterials, NamesMayHaveBlanks) {
  write("my lib.mtl", "\xEF\xBB\xBFnewmtl wood dark\nKd .1 .1 .1\nnewmtl wood light\nKd .6 .6 .6\n");
  std::string obj = kObj;
  obj.replace(obj.find("a.mtl"), 5, "my lib.mtl");
  obj.replace(obj.find("usemtl red"), 10, "usemtl wood dark ");
  obj.replace(obj.find("usemtl blue"), 11, "usemtl wood light");
  for (const char* library : {"my lib.mtl", "none.mtl my\\ lib.mtl"}) {
    std::string text = obj;
    text.replace(text.find("my lib.mtl"), 10, library);
    const LoadedScene s = load("", "", text);
    EXPECT_NEAR(seen(s, 0.4f, 0.5f)[0], 0.1f, 1e-6f);
    EXPECT_NEAR(seen(s, 1.4f, 0.5f)[0], 0.6f, 1e-6f);
  }
}

TEST_F(ObjMaterials, NothingIsDroppedInSilence) {
  write(
      "a.mtl",
      "newmtl red\nKd 2 0 0\nillum 7\nmap_Ks a.png\nmap_Kd -mm 0 2 -imfchan r b.png\nfoo 1\nd -halo 1\nnewmtl blue\n"
      "Ka 1 1 1\nKe 3 0 0\n");
  const std::string all = notes(load(""));
  for (const char* part : {"Kd is cut", "glass of illum 7", "map_Ks", "map_Kd -mm", "map_Kd -imfchan", "foo",
                           "-halo of d", "Ke (give the shape an emitter)"})
    EXPECT_NE(all.find(part), std::string::npos) << part << "\n" << all;
}

TEST_F(ObjMaterials, BadMtlFilesAreNotes) {
  const auto with = [&](const std::string& text) {
    write("a.mtl", text);
    const LoadedScene s = load("");
    EXPECT_GE(seen(s, 0.4f, 0.5f)[0], 0);
    return notes(s);
  };
  EXPECT_NE(with("Kd 1 1 1\n").find("line 1: expected newmtl"), std::string::npos);
  EXPECT_NE(with("newmtl red\nKd x\n").find("line 2: the value of Kd"), std::string::npos);
  EXPECT_NE(with("newmtl red\nmap_Kd none.png\n").find("none.png"), std::string::npos);
  with("newmtl red\nKd 7 -1 nan\n");
  with("newmtl\nnewmtl red\nd 2\n");
  with(std::string("newmtl red\nKd \0 1", 17));
  const std::string text =
      "newmtl red\nKd .1 .2 .3\nmap_Kd -bm 1 x.png\nmap_d -o 1 y.png\nKs 1 1 1\nNs 5\nillum 2\nd .5\n";
  for (std::size_t n = 0; n < text.size(); ++n) with(text.substr(0, n));
}

TEST_F(ObjMaterials, WhatAnMtlFileSays) {
  write("a.mtl",
        "newmtl a\nd 0.25\nTr 0.25\nnewmtl b\nTr 0.25\nNs 12\nKs .5\nKe 0 0 0\nnewmtl c\nKe 1 0 0\nrefl x\n");
  const Properties p("obj", "", {}, nullptr);
  const auto all = read_mtl(MeshFile(p, folder_ / "a.mtl"));
  EXPECT_EQ(all.at("a").opacity, 0.25);
  EXPECT_EQ(all.at("b").opacity, 0.75);
  EXPECT_EQ(all.at("b").exponent, 12);
  EXPECT_EQ(all.at("b").specular[2], 0.5);
  EXPECT_EQ(all.at("b").ignored, "");
  EXPECT_EQ(all.at("c").ignored, "Ke (give the shape an emitter), refl");
}

}  // namespace
}  // namespace aureole

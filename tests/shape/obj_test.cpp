// SPDX-License-Identifier: Apache-2.0
#include "aureole/shape/mesh/mesh.h"
#include "shape/shape_test_support.h"

namespace aureole {
namespace {

using test::ShapeBuilder;

class ObjTest : public test::FileTest {
protected:
  ShapeBuilder builder(const std::string& text) const {
    return ShapeBuilder("obj").set("filename", write("mesh.obj", text));
  }
  /// The mesh in the file `text`; `shape_` keeps it.
  const Mesh& mesh(const std::string& text) {
    shape_ = builder(text).build();
    return dynamic_cast<const Mesh&>(*shape_);
  }
  std::string error(const std::string& text) const { return test::build_error(builder(text)); }
  ShapePtr shape_;
};

constexpr const char* kSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

TEST_F(ObjTest, TrianglesQuadsAndPolygonsAreFanned) {
  EXPECT_EQ(mesh(std::string(kSquare) + "f 1 2 3\n").primitive_count(), 1u);
  EXPECT_EQ(mesh(std::string(kSquare) + "f 1 2 3 4\n").primitive_count(), 2u);
  const Mesh& m = mesh("v 0 0 0\nv 1 0 0\nv 2 1 0\nv 1 2 0\nv 0 1 0\nf 1 2 3 4 5");  // no newline at the end
  EXPECT_EQ(m.data().triangles, (std::vector<TriangleIndices>{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}}));
}

TEST_F(ObjTest, SeamsOfTextureCoordinatesDoNotSplitPositions) {
  const Mesh& m =
      mesh(std::string(kSquare) + "vt 0 0\nvt 1 0\nvt 1 1\nvt .5 .5\nf 1/1 2/2 3/3\nf 1/4 3/3 4/1\n");
  EXPECT_EQ(m.data().positions.size(), 4u + 1);  // and one of padding
  EXPECT_EQ(m.data().uvs.size(), 4u);
  EXPECT_EQ(m.data().triangles[1], (TriangleIndices{0, 2, 3}));
  EXPECT_EQ(m.data().uv_triangles[1], (TriangleIndices{3, 2, 0}));
  EXPECT_EQ(m.data().uvs[2].y, 0);  // flipped unless asked otherwise
}

TEST_F(ObjTest, Options) {
  const std::string text = std::string(kSquare) + "vt 0 0.25\nvn 0 0 2\nf 1/1/1 2/1/1 3/1/1\n";
  const auto keep = builder(text).set("flip_tex_coords", false).build();
  EXPECT_EQ(dynamic_cast<const Mesh&>(*keep).data().uvs[0].y, 0.25f);
  EXPECT_EQ(dynamic_cast<const Mesh&>(*keep).data().normals[0].z, 1);
  const auto flat = builder(text).set("face_normals", true).build();
  EXPECT_TRUE(dynamic_cast<const Mesh&>(*flat).data().normals.empty());
  const auto flipped = builder(text).set("flip_normals", true).build();
  const auto hit = test::OneShapeScene(*flipped).intersect({{0.6f, 0.3f, 1}, {0, 0, -1}});
  ASSERT_TRUE(hit);
  EXPECT_EQ(hit->point.ng.z, -1);
  EXPECT_EQ(hit->point.shading.n.z, -1);
}

TEST_F(ObjTest, MirroringAndNormals) {
  const std::string text = std::string(kSquare) + "vn 0 0 1\nf 1//1 2//1 3//1\n";
  const auto mirrored = builder(text).to_world(Transform::scale(-1, 1, 1)).build();
  const auto hit = test::OneShapeScene(*mirrored).intersect({{-0.6f, 0.3f, 1}, {0, 0, -1}});
  ASSERT_TRUE(hit);
  EXPECT_EQ(hit->point.ng.z, 1);
  EXPECT_EQ(hit->point.shading.n.z, 1);
  EXPECT_TRUE(mirrored->remarks().empty());
}

TEST_F(ObjTest, NegativeIndicesCountBackwards) {
  const Mesh& m = mesh(std::string(kSquare) + "vt 0 0\nvt 1 1\nf -4/-1 -3/-2 -2/-1\nv 9 9 9\nf -1 1 2\n");
  EXPECT_EQ(m.data().triangles[0], (TriangleIndices{0, 1, 2}));
  EXPECT_EQ(m.data().uv_triangles[0], (TriangleIndices{1, 0, 1}));
  EXPECT_EQ(m.data().triangles[1], (TriangleIndices{4, 0, 1}));
}

TEST_F(ObjTest, WhatMayBeMissing) {
  // Normals on one face only: the other uses its own plane.
  const Mesh& m = mesh(std::string(kSquare) + "vn 0.6 0 0.8\nf 1//1 2//1 3//1\nf 1 3 4\n");
  const auto hit = test::OneShapeScene(m).intersect({{0.2f, 0.7f, 1}, {0, 0, -1}});
  ASSERT_TRUE(hit);
  EXPECT_EQ(hit->primitive, 1u);
  EXPECT_EQ(hit->point.shading.n.z, 1);
  const auto other = test::OneShapeScene(m).intersect({{0.7f, 0.2f, 1}, {0, 0, -1}});
  EXPECT_NEAR(other->point.shading.n.x, 0.6f, 1e-6f);
}

TEST_F(ObjTest, WhatIsRead) {
  const std::string text =
      "# comment\r\n\r\nmtllib a.mtl\r\no thing\r\ng part\r\ns off\r\nusemtl red\r\n  v\t0 0 0 1.0\r\nv +1 0 "
      "0\r\nv 1e0 1.0E+0 -0\r\n"
      "f 1 \\\r\n 2 3\r\nusemtl blue\r\nf 1 2\r\nl 1 2\r\n";
  const Mesh& m = mesh(text);
  EXPECT_EQ(m.primitive_count(), 1u);
  ASSERT_EQ(m.remarks().size(), 2u);
  EXPECT_NE(m.remarks()[0].find("fewer than three"), std::string::npos);
  EXPECT_NE(m.remarks()[1].find("\"l\""), std::string::npos);
  const auto asset = builder(text).build_asset();
  ASSERT_EQ(asset->primitives().size(), 1u);
  const auto& remarks = asset->primitives()[0].remarks;
  ASSERT_EQ(remarks.size(), 3u);
  EXPECT_NE(remarks[2].find("\"red\""), std::string::npos);  // and no face is blue
}

TEST_F(ObjTest, ErrorsNameTheParameterAndTheLine) {
  const auto expect = [&](const std::string& text, const std::string& part) {
    const std::string e = error(text);
    EXPECT_NE(e.find("scene.xml:8:5"), std::string::npos) << e;
    EXPECT_NE(e.find("mesh.obj"), std::string::npos) << e;
    EXPECT_NE(e.find(part), std::string::npos) << e;
  };
  expect("v 0 0 0\nv 1 x 0\n", "line 2");
  expect("v 0 0 0\nv 1 0 0\nf 1 2 3\n", "line 3: there is no vertex 3");
  expect(std::string(kSquare) + "f 1 2 0\n", "line 5: there is no vertex 0");
  expect(std::string(kSquare) + "f 1/1 2/1 3/1\n", "no texture coordinate 1");
  expect(std::string(kSquare) + "f 1//5 2//1 3//1\n", "no normal 5");
  expect(std::string(kSquare) + "f 1 -9 3\n", "no vertex -9");
  expect(std::string(kSquare) + "f 1 2 3x\n", "malformed");
  expect("v 0 0 0\n", "no faces");
  expect("", "no faces");
  expect(std::string("\x7f"
                     "ELF\0\1\2\3\nabc",
                     12),
         "not an OBJ");
  expect("f 1 2 99999999999999999999\n", "line 1");
}

TEST_F(ObjTest, TruncationNeverCrashes) {
  const std::string text = std::string(kSquare) +
                           "vt 0 0\nvn 0 0 1\nf 1/1/1 2/1/1 3/1/1 4/1/1\nf -1/-1/-1 -2/-1/-1 \\\n -3/-1/-1\n";
  for (std::size_t n = 0; n < text.size(); ++n) error(text.substr(0, n));
  std::mt19937 random(1);
  for (int i = 0; i < 5000; ++i) {
    std::string bad = text;
    for (int k = 0; k < 3; ++k) bad[random() % bad.size()] = char(random());
    error(bad);
  }
}

}  // namespace
}  // namespace aureole

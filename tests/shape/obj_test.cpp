// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

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

TEST_F(ObjTest, TrianglesQuadsAndConvexPolygonsAreFanned) {
  EXPECT_EQ(mesh(std::string(kSquare) + "f 1 2 3\n").primitive_count(), 1u);
  EXPECT_EQ(mesh(std::string(kSquare) + "f 1 2 3 4\n").primitive_count(), 2u);
  const Mesh& m = mesh("v 0 0 0\nv 1 0 0\nv 2 1 0\nv 1 2 0\nv 0 1 0\nf 1 2 3 4 5");  // no newline at the end
  EXPECT_EQ(m.data().triangles, (std::vector<TriangleIndices>{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}}));
}

/// The area of all triangles that face up, minus that of those that face down.
double area_up(const Mesh& m) {
  double sum = 0;
  for (const TriangleIndices& t : m.data().triangles) {
    const auto &p = m.data().positions[t[0]], &q = m.data().positions[t[1]], &r = m.data().positions[t[2]];
    sum += cross(q - p, r - p).z / 2;
  }
  return sum;
}
double area(const Mesh& m) {
  double sum = 0;
  for (const TriangleIndices& t : m.data().triangles) {
    const auto &p = m.data().positions[t[0]], &q = m.data().positions[t[1]], &r = m.data().positions[t[2]];
    sum += length(cross(q - p, r - p)) / 2;
  }
  return sum;
}

TEST_F(ObjTest, ConcavePolygonsCoverTheirArea) {
  const std::string arrow = "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv 0 -.5 0\nv -1 1 0\n";
  for (const char* face : {"1 2 3 4 5", "3 4 5 1 2", "5 1 2 3 4", "2 3 4 5 1", "4 5 1 2 3"}) {
    EXPECT_NEAR(area(mesh(arrow + "f " + face)), 2.5, 1e-6) << face;
    EXPECT_NEAR(area_up(mesh(arrow + "f " + face)), 2.5, 1e-6) << face;
  }
  EXPECT_NEAR(area_up(mesh(arrow + "f 5 4 3 2 1")), -2.5, 1e-6);
  // A quadrangle whose first diagonal lies outside, seen from all three axes, and one that is not plane.
  for (const char* v : {"v 0 0 5\nv 2 2 5\nv 0 1 5\nv -2 2 5\n", "v 5 0 0\nv 5 2 2\nv 5 0 1\nv 5 -2 2\n",
                        "v 0 5 0\nv 2 5 2\nv 0 5 1\nv -2 5 2\n"}) {
    EXPECT_NEAR(area(mesh(std::string(v) + "f 2 3 4 1")), 2, 1e-6) << v;
    EXPECT_TRUE(shape_->remarks().empty());
  }
  const Mesh& bent = mesh("v 0 0 0\nv 2 2 0.1\nv 0 1 0\nv -2 2 0.1\nf 2 3 4 1");
  EXPECT_NEAR(area_up(bent), 2, 1e-6);
}

TEST_F(ObjTest, PolygonsWithHolesCombsAndSpiralsAreTriangulated) {
  // A square with a square hole, joined along one edge that the polygon passes twice.
  EXPECT_NEAR(area(mesh("v 0 0 0\nv 3 0 0\nv 3 3 0\nv 0 3 0\nv 1 1 0\nv 1 2 0\nv 2 2 0\nv 2 1 0\n"
                        "f 1 2 3 4 1 5 6 7 8 5")),
              8, 1e-6);
  // Corners on an edge stay corners: no triangle is degenerate.
  const Mesh& m = mesh("v 0 0 0\nv 1 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nf 1 2 3 4 5");
  EXPECT_EQ(m.primitive_count(), 3u);
  EXPECT_NEAR(area_up(m), 4, 1e-6);
  // A comb of 400 teeth and a spiral, from every first corner.
  std::string comb, face;
  int n = 0;
  for (int i = 0; i < 400; ++i, n += 2) comb += fmt::format("v {} 0 0\nv {} 9 0\n", i, i + 0.5);
  comb += "v 400 0 0\nv 400 -1 0\nv 0 -1 0\n";
  for (int i = n + 3; i > 0; --i) face += fmt::format(" {}", i);
  EXPECT_NEAR(area_up(mesh(comb + "f" + face)), 400 + 400 * 4.5, 1e-2);
  std::string spiral;
  std::vector<Vec3> corners;
  for (const double r : {1.0, 0.6})
    for (int i = 0; i <= 100; ++i) {
      const double phi = 0.2 * (r == 1 ? i : 100 - i), radius = (r + 0.15 * phi);
      corners.push_back({float(radius * std::cos(phi)), float(radius * std::sin(phi)), 0});
    }
  double expected = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec3 &p = corners[i], &q = corners[(i + 1) % corners.size()];
    expected += (double(p.x) * q.y - double(p.y) * q.x) / 2;
    spiral += fmt::format("v {} {} 0\n", p.x, p.y);
  }
  for (int first = 0; first < int(corners.size()); first += 20) {
    std::string f = "f";
    for (int i = 0; i < int(corners.size()); ++i)
      f += fmt::format(" {}", 1 + (first + i) % int(corners.size()));
    EXPECT_NEAR(area(mesh(spiral + f)), std::abs(expected), 1e-4) << first;
    EXPECT_TRUE(shape_->remarks().empty());
  }
}

TEST_F(ObjTest, IndicesOfConcavePolygonsStayTogether) {
  const Mesh& m =
      mesh("v 0 0 0\nv 2 2 0\nv 0 1 0\nv -2 2 0\nvt 0 0\nvt 2 2\nvt 0 1\nvt -2 2\nf 2/2 3/3 4/4 1/1\n");
  for (std::size_t i = 0; i < m.data().triangles.size(); ++i)
    for (int k = 0; k < 3; ++k)
      EXPECT_EQ(m.data().triangles[i][k], m.data().uv_triangles[i][k]) << i << " " << k;
}

TEST_F(ObjTest, PolygonsThatIntersectThemselvesAreNoted) {
  mesh("v 0 0 0\nv 1 1 0\nv 1 0 0\nv 0 2 0\nf 1 2 3 4\n");
  ASSERT_EQ(shape_->remarks().size(), 1u);
  EXPECT_NE(shape_->remarks()[0].find("1 polygon intersects itself"), std::string::npos);
  mesh("v 0 0 0\nv 1 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3 4\n");
  EXPECT_EQ(shape_->primitive_count(), 0u);
}

TEST_F(ObjTest, CreasesAreSharp) {
  // A roof: two squares that meet at the y axis with normals 60 degrees apart.
  const std::string roof =
      "v 0 0 0\nv 0 1 0\nv 0.8660254 1 -0.5\nv 0.8660254 0 -0.5\nv -0.8660254 1 -0.5\n"
      "v -0.8660254 0 -0.5\nf 1 4 3 2\nf 1 2 5 6\n";
  for (const auto& [angle, z] : {std::pair{59.0, std::sqrt(0.75)}, {61.0, 1.0}}) {
    const auto shape = builder(roof).set("max_smooth_angle", angle).build();
    const auto hit = test::OneShapeScene(*shape).intersect({{1e-4f, 0.5f, 1}, {0, 0, -1}});
    ASSERT_TRUE(hit);
    EXPECT_NEAR(hit->point.shading.n.z, z, 1e-3) << angle;
  }
}

TEST_F(ObjTest, RecenteredFilesFillTheBoxFromMinusOneToOne) {
  const auto shape = builder("v 10 0 0\nv 14 0 0\nv 14 2 0\nf 1 2 3\n")
                         .set("recenter", true)
                         .to_world(Transform::translate(0, 0, 5))
                         .build();
  EXPECT_EQ(shape->bounds().lower, (Vec3{-1, -0.5f, 5}));
  EXPECT_EQ(shape->bounds().upper, (Vec3{1, 0.5f, 5}));
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

TEST_F(ObjTest, NormalsAndTextureCoordinatesMayFollowOrBeMissing) {
  const std::string first = std::string(kSquare) + "f 1/1/1 2/2/1 3/3/1\n";
  const Mesh& m = mesh(first + "vt 0 0\nvt 1 0\nvt 1 1\nvn 0 0 1\n");
  EXPECT_EQ(m.data().uvs.size(), 3u);
  EXPECT_EQ(m.data().uv_triangles[0], (TriangleIndices{0, 1, 2}));
  EXPECT_TRUE(shape_->remarks().empty());
  // A trailing slash, and files that name normals which they do not have.
  EXPECT_TRUE(mesh(std::string(kSquare) + "vt 0 0\nf 1/1/ 2/1/ 3/1/\n").remarks().empty());
  mesh(first + "vt 0 0\nvt 1 0\n");
  ASSERT_EQ(shape_->remarks().size(), 2u);
  EXPECT_NE(shape_->remarks()[0].find("1 corners of triangles refer to texture coordinates"),
            std::string::npos);
  EXPECT_NE(shape_->remarks()[1].find("3 corners of triangles refer to normals"), std::string::npos);
  mesh("v 0 0 0 1 0 0\nv 1 0 0 1 0 0\nv 0 1 0 1 0 0\nf 1 2 3\n");
  ASSERT_EQ(shape_->remarks().size(), 1u);
  EXPECT_NE(shape_->remarks()[0].find("3 colours of vertices"), std::string::npos);
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
  expect(std::string(kSquare) + "f 1/-1 2 3\n", "no texture coordinate -1");
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

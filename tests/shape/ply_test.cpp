// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstring>

#include "aureole/shape/mesh/mesh.h"
#include "shape/shape_test_support.h"

namespace aureole {
namespace {

using test::ShapeBuilder;

/// Bytes of numbers in either byte order.
class Binary {
public:
  explicit Binary(bool big) : big_(big) {}
  template <class T>
  Binary& add(T value) {
    char raw[sizeof(T)];
    std::memcpy(raw, &value, sizeof(T));
    if (big_) std::reverse(raw, raw + sizeof(T));
    bytes.append(raw, sizeof(T));
    return *this;
  }
  std::string bytes;

private:
  bool big_;
};

class PlyTest : public test::FileTest {
protected:
  ShapeBuilder builder(const std::string& bytes) const {
    return ShapeBuilder("ply").set("filename", write("mesh.ply", bytes));
  }
  const Mesh& mesh(const std::string& bytes) {
    shape_ = builder(bytes).build();
    return dynamic_cast<const Mesh&>(*shape_);
  }
  std::string error(const std::string& bytes) const { return test::build_error(builder(bytes)); }
  ShapePtr shape_;
};

std::string ascii_square() {
  return "ply\nformat ascii 1.0\ncomment made by hand\nelement vertex 4\nproperty float x\nproperty float "
         "y\nproperty float z\n"
         "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 "
         "0 1 2 3\n";
}

/// Vertices of mixed types with normals, texture coordinates and a colour; faces with an extra list; an
/// unknown element before both.
std::string binary_mesh(bool big, const char* u = "u", const char* v = "v") {
  std::string h =
      std::string("ply\nformat ") + (big ? "binary_big_endian" : "binary_little_endian") + " 1.0\n" +
      "element extra 2\nproperty short a\nproperty list uint8 float32 b\n" +
      "element vertex 3\nproperty double x\nproperty float y\nproperty float32 z\nproperty uchar red\n" +
      "property float nx\nproperty float ny\nproperty float nz\nproperty float " + u + "\nproperty float " +
      v + "\n" +
      "element face 2\nproperty list uchar float texcoord\nproperty list ushort uint "
      "vertex_index\nend_header\n";
  Binary b(big);
  b.add<std::int16_t>(1).add<std::uint8_t>(2).add(1.f).add(2.f).add<std::int16_t>(3).add<std::uint8_t>(0);
  const float p[3][2] = {{0, 0}, {1, 0}, {0, 1}};
  for (const auto& q : p)
    b.add(double(q[0]))
        .add(q[1])
        .add(0.5f)
        .add<std::uint8_t>(200)
        .add(0.f)
        .add(0.f)
        .add(2.f)
        .add(q[0])
        .add(q[1] * 0.25f);
  b.add<std::uint8_t>(1)
      .add(0.5f)
      .add<std::uint16_t>(3)
      .add<std::uint32_t>(0)
      .add<std::uint32_t>(1)
      .add<std::uint32_t>(2);
  b.add<std::uint8_t>(0).add<std::uint16_t>(2).add<std::uint32_t>(0).add<std::uint32_t>(1);
  return h + b.bytes;
}

TEST_F(PlyTest, LinesWithMoreNumbersThanPropertiesAreNoted) {
  std::string text = ascii_square();
  text.replace(text.find("4 0 1 2 3"), 9, "4 0 1 2 3 9 1 1 1");
  EXPECT_EQ(mesh(text).primitive_count(), 2u);
  ASSERT_EQ(shape_->remarks().size(), 1u);
  EXPECT_NE(shape_->remarks()[0].find("1 lines have more numbers"), std::string::npos);
}

TEST_F(PlyTest, ConcavePolygonsCoverTheirArea) {
  const std::string head = "ply\nformat ascii 1.0\n",
                    vertex = "element vertex 5\nproperty float x\nproperty float y\nproperty float z\n",
                    face = "element face 2\nproperty list uchar int vertex_indices\n",
                    vertices = "-1 -1 0\n1 -1 0\n1 1 0\n0 -.5 0\n-1 1 0\n", faces = "5 2 3 4 0 1\n3 0 1 3\n";
  // Faces may stand before vertices.
  for (const std::string& text : {head + vertex + face + "end_header\n" + vertices + faces,
                                  head + face + vertex + "end_header\n" + faces + vertices}) {
    const Mesh& m = mesh(text);
    double sum = 0;
    for (const TriangleIndices& t : m.data().triangles)
      sum += length(cross(m.data().positions[t[1]] - m.data().positions[t[0]],
                          m.data().positions[t[2]] - m.data().positions[t[0]])) /
             2;
    EXPECT_NEAR(sum, 2.5 + 0.5, 1e-6);
  }
}

TEST_F(PlyTest, Ascii) {
  const Mesh& m = mesh(ascii_square());
  EXPECT_EQ(m.primitive_count(), 2u);
  EXPECT_EQ(m.data().positions[2].y, 1);
  EXPECT_EQ(m.data().normals[0].z, 1);  // computed
  EXPECT_TRUE(m.remarks().empty());
}

TEST_F(PlyTest, BinaryOfBothOrders) {
  for (const bool big : {false, true})
    for (const auto& [u, v] : {std::pair{"u", "v"}, {"s", "t"}, {"texture_u", "texture_v"}}) {
      const Mesh& m = mesh(binary_mesh(big, u, v));
      ASSERT_EQ(m.primitive_count(), 1u);
      EXPECT_EQ(m.data().positions[1].x, 1);
      EXPECT_EQ(m.data().positions[1].z, 0.5f);
      EXPECT_EQ(m.data().normals[2].z, 1);
      EXPECT_EQ(m.data().uvs[2].y, 0.25f);
      ASSERT_EQ(m.remarks().size(), 2u);
      EXPECT_EQ(m.remarks()[0], "ignored in the file: extra, face.texcoord, vertex.red");
    }
  const auto flipped = builder(binary_mesh(false)).set("flip_tex_coords", true).build();
  EXPECT_EQ(dynamic_cast<const Mesh&>(*flipped).data().uvs[2].y, 0.75f);
}

TEST_F(PlyTest, ErrorsAreLocated) {
  const auto expect = [&](const std::string& bytes, const std::string& part) {
    const std::string e = error(bytes);
    EXPECT_NE(e.find("scene.xml:8:5"), std::string::npos) << e;
    EXPECT_NE(e.find(part), std::string::npos) << e;
  };
  const auto replaced = [](std::string s, const std::string& from, const std::string& to) {
    return s.replace(s.find(from), from.size(), to);
  };
  expect("plx\n", "not a PLY");
  expect(replaced(ascii_square(), "float z", "flat z"), "line 7: unknown type \"flat\"");
  expect(replaced(ascii_square(), "float z", "float w"), "x, y and z");
  expect(replaced(ascii_square(), "vertex_indices", "corners"), "vertex_indices");
  expect(replaced(ascii_square(), "4 0 1 2 3", "4 0 1 2 7"), "vertex 7 of 4");
  expect(replaced(ascii_square(), "4 0 1 2 3", "4 0 1 2 -1"), "refers to the vertex");
  expect(replaced(ascii_square(), "1 1 0", "1 one 0"), "line 13: expected a number");
  expect(replaced(ascii_square(), "element vertex 4", "element vertex 4000000000"), "cannot be in it");
  expect(replaced(ascii_square(), "element vertex 4", "element vertex 3"), "more in the file");
  expect(replaced(binary_mesh(false), "element vertex 3", "element vertex 3000000000"), "cannot be in it");
  expect(binary_mesh(false) + "x", "more in the file");
  expect(replaced(ascii_square(), "format ascii 1.0\n", ""), "no format");
  expect(replaced(ascii_square(), "element face", "element fact"), "no element \"face\"");
}

TEST_F(PlyTest, EveryTruncationIsAnError) {
  for (const std::string& whole : {ascii_square(), binary_mesh(false), binary_mesh(true)})
    for (std::size_t n = 0; n < whole.size(); ++n) {
      // The last newline, and the last digit, of a text can go unnoticed.
      if (whole == ascii_square() && n + 1 >= whole.size()) continue;
      EXPECT_FALSE(error(whole.substr(0, n)).empty()) << n << " of " << whole.size();
    }
}

TEST_F(PlyTest, DamageNeverCrashes) {
  std::mt19937 random(1);
  for (const std::string& whole : {ascii_square(), binary_mesh(false), binary_mesh(true)})
    for (int i = 0; i < 4000; ++i) {
      std::string bad = whole;
      for (int k = 0; k < 2; ++k) bad[random() % bad.size()] = char(random());
      error(bad);
    }
}

}  // namespace
}  // namespace aureole

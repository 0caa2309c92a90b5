// SPDX-License-Identifier: Apache-2.0
#include <zlib.h>

#include <cstring>

#include "aureole/shape/mesh/mesh.h"
#include "shape/shape_test_support.h"

namespace aureole {
namespace {

using test::ShapeBuilder;

template <class T>
void append(std::string& s, T value) {
  s.append(reinterpret_cast<const char*>(&value), sizeof(T));
}

std::string deflated(const std::string& bytes) {
  uLongf size = compressBound(uLong(bytes.size()));
  std::string out(size, 0);
  compress(reinterpret_cast<Bytef*>(out.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()),
           uLong(bytes.size()));
  return out.substr(0, size);
}

constexpr std::uint32_t kNormals = 1, kUvs = 2, kColors = 8, kSingle = 0x1000, kDouble = 0x2000;

/// The uncompressed contents of a mesh: a triangle at height z.
template <class Real>
std::string contents(int version, std::uint32_t flags, Real z) {
  std::string s;
  append(s, flags | (sizeof(Real) == 8 ? kDouble : kSingle));
  if (version == 4) s += std::string("name") + '\0';
  append(s, std::uint64_t(3)), append(s, std::uint64_t(1));
  for (const Real v : {Real(0), Real(0), z, Real(1), Real(0), z, Real(0), Real(1), z}) append(s, v);
  if (flags & kNormals)
    for (int i = 0; i < 3; ++i) append(s, Real(0)), append(s, Real(0)), append(s, Real(2));
  if (flags & kUvs)
    for (int i = 0; i < 3; ++i) append(s, Real(i)), append(s, Real(0.25));
  if (flags & kColors)
    for (int i = 0; i < 9; ++i) append(s, Real(0.5));
  for (const std::uint32_t i : {0u, 1u, 2u}) append(s, i);
  return s;
}

std::string file(int version, const std::vector<std::string>& meshes) {
  std::string s;
  std::vector<std::uint64_t> offsets;
  for (const std::string& m : meshes) {
    offsets.push_back(s.size());
    append(s, std::uint16_t(0x041c)), append(s, std::uint16_t(version));
    s += deflated(m);
  }
  for (const std::uint64_t o : offsets)
    if (version == 4)
      append(s, o);
    else
      append(s, std::uint32_t(o));
  append(s, std::uint32_t(meshes.size()));
  return s;
}

class SerializedTest : public test::FileTest {
protected:
  ShapeBuilder builder(const std::string& bytes, std::int64_t index = 0) const {
    return ShapeBuilder("serialized")
        .set("filename", write("mesh.serialized", bytes))
        .set("shape_index", index);
  }
  const Mesh& mesh(const std::string& bytes, std::int64_t index = 0) {
    shape_ = builder(bytes, index).build();
    return dynamic_cast<const Mesh&>(*shape_);
  }
  std::string error(const std::string& bytes, std::int64_t index = 0) const {
    return test::build_error(builder(bytes, index));
  }
  ShapePtr shape_;
};

TEST_F(SerializedTest, AllKinds) {
  for (const int version : {3, 4})
    for (const bool in_double : {false, true})
      for (const std::uint32_t flags : {0u, kNormals, kUvs, kNormals | kUvs | kColors}) {
        const std::string m =
            in_double ? contents<double>(version, flags, 3) : contents<float>(version, flags, 3);
        const Mesh& mesh_read = mesh(file(version, {m}));
        ASSERT_EQ(mesh_read.primitive_count(), 1u);
        EXPECT_EQ(mesh_read.data().positions[1].x, 1);
        EXPECT_EQ(mesh_read.data().positions[1].z, 3);
        EXPECT_EQ(mesh_read.data().normals[0].z, 1);
        EXPECT_EQ(mesh_read.data().uvs.empty(), !(flags & kUvs));
        if (flags & kUvs) {
          EXPECT_EQ(mesh_read.data().uvs[2].x, 2);
        }
        EXPECT_EQ(mesh_read.remarks().size(), flags & kColors ? 1u : 0u);
      }
}

TEST_F(SerializedTest, ShapeIndex) {
  for (const int version : {3, 4}) {
    const std::string f = file(version, {contents<float>(version, 0, 1), contents<float>(version, kUvs, 2),
                                         contents<float>(version, 0, 3)});
    for (int i = 0; i < 3; ++i) EXPECT_EQ(mesh(f, i).data().positions[0].z, float(i + 1));
    EXPECT_NE(error(f, 3).find("out of range"), std::string::npos);
    EXPECT_NE(error(f, -1), "");
  }
}

TEST_F(SerializedTest, WrongFiles) {
  const auto expect = [&](const std::string& bytes, const std::string& part) {
    const std::string e = error(bytes);
    EXPECT_NE(e.find("scene.xml:8:5"), std::string::npos) << e;
    EXPECT_NE(e.find(part), std::string::npos) << e;
  };
  std::string f = file(4, {contents<float>(4, 0, 1)});
  f[2] = 9;
  expect(f, "version 9");
  f[0] = 0;
  expect(f, "not a serialized mesh");
  std::string huge = contents<float>(4, 0, 1);
  const std::uint64_t count = 1000000000;
  std::memcpy(huge.data() + 4 + 5, &count, 8);
  expect(file(4, {huge}), "cannot be in it");
  std::string index = contents<float>(4, 0, 1);
  index[index.size() - 4] = 7;
  expect(file(4, {index}), "vertex 7 of 3");
  std::string short_data = contents<float>(4, 0, 1);
  short_data.resize(short_data.size() - 4);
  expect(file(4, {short_data}), "ends early");
}

TEST_F(SerializedTest, EveryTruncationIsAnErrorOrTheMesh) {
  const std::string f = file(4, {contents<float>(4, kNormals, 1), contents<float>(4, kUvs, 2)});
  for (std::size_t n = 0; n < f.size(); ++n) EXPECT_FALSE(error(f.substr(0, n), 1).empty()) << n;
  // The first mesh needs no table: it is complete where its stream is.
  const std::size_t stream = 4 + deflated(contents<float>(4, kNormals, 1)).size();
  for (std::size_t n = 0; n + 8 < stream; ++n) EXPECT_FALSE(error(f.substr(0, n), 0).empty()) << n;
  EXPECT_EQ(error(f.substr(0, stream)), "");
}

TEST_F(SerializedTest, DamageNeverCrashes) {
  const std::string f = file(4, {contents<float>(4, kNormals, 1), contents<float>(4, kUvs, 2)});
  std::mt19937 random(1);
  for (int i = 0; i < 6000; ++i) {
    std::string bad = f;
    bad[random() % bad.size()] = char(random());
    error(bad, i % 2);
  }
  // Damage before compression, which no checksum detects.
  for (int i = 0; i < 6000; ++i) {
    std::string m = contents<float>(4, kNormals, 1);
    m[random() % m.size()] = char(random());
    error(file(4, {m}));
  }
}

}  // namespace
}  // namespace aureole

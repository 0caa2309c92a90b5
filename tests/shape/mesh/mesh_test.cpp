// SPDX-License-Identifier: Apache-2.0
#include "aureole/shape/mesh/mesh.h"

#include "aureole/shape/geometry/double3.h"
#include "harness/properties_builder.h"
#include "shape/shape_test_support.h"

namespace aureole {
namespace {

using test::OneShapeScene;
using test::Random;
using test::ShapeBuilder;

/// A mesh straight from its data.
class TestMesh final : public Mesh {
public:
  TestMesh(const Properties& p, MeshData data) : Mesh(p) { build(std::move(data), "data"); }
};

Properties plain() { return Properties("mesh", "", {}, nullptr); }

double distance_to_plane(const SurfacePoint& s, const TriangleCorners& c) {
  const Double3 n = normalize(cross(Double3(c[1]) - Double3(c[0]), Double3(c[2]) - Double3(c[0])));
  return std::abs(dot(Double3(s.p) - Double3(c[0]), n));
}

/// How far p_error allows the point to be from the plane.
double allowed(const SurfacePoint& s, const TriangleCorners& c) {
  const Double3 n = normalize(cross(Double3(c[1]) - Double3(c[0]), Double3(c[2]) - Double3(c[0])));
  return std::abs(n.x) * s.p_error.x + std::abs(n.y) * s.p_error.y + std::abs(n.z) * s.p_error.z;
}

MeshData random_triangle(Random& random) {
  const float size = std::pow(10.f, random.uniform(-3, 3)), away = std::pow(10.f, random.uniform(-3, 5));
  const float slender = std::pow(10.f, random.uniform(-2, 0));
  const Vec3 center = random.direction() * std::min(away, size * 1e4f);
  const Frame f = Frame::from_normal(random.direction());
  const auto corner = [&](float x, float y) {
    return center + f.to_world({x * size, y * size * slender, 0});
  };
  MeshData d;
  d.positions = {corner(random.uniform(-1, 0), random.uniform(-1, 0)),
                 corner(random.uniform(0.2f, 1), random.uniform(-1, 0)),
                 corner(random.uniform(-0.5f, 0.5f), random.uniform(0.2f, 1))};
  d.triangles = {{0, 1, 2}};
  return d;
}

TEST(Mesh, HitsLieWithinTheErrorBoundAndLeaveWithoutMeetingThemselves) {
  Random random(1);
  int hits = 0, self = 0;
  double worst = 0;
  for (int n = 0; n < 500; ++n) {
    const TestMesh mesh(plain(), random_triangle(random));
    if (mesh.primitive_count() == 0) continue;
    const auto& p = mesh.data().positions;
    const TriangleIndices& t = mesh.data().triangles[0];
    const TriangleCorners c = {p[t[0]], p[t[1]], p[t[2]]};
    const float size = length(c[1] - c[0]);
    const OneShapeScene scene(mesh);
    for (int i = 0; i < 250; ++i) {
      const float b1 = random.uniform(), b2 = random.uniform(0, 1 - b1);
      const Vec3 target = c[0] * (1 - b1 - b2) + c[1] * b1 + c[2] * b2;
      const Vec3 o = target + random.direction() * (size * std::pow(10.f, random.uniform(-1, 2)));
      const auto hit = scene.intersect({o, normalize(target - o)});
      if (!hit) continue;
      ++hits;
      worst = std::max(worst, distance_to_plane(hit->point, c) / allowed(hit->point, c));
      // All directions, many of them grazing.
      Vec3 d = random.direction();
      if (i % 2)
        d = normalize(d -
                      hit->point.ng * (dot(d, hit->point.ng) * (1 - std::pow(10.f, random.uniform(-6, 0)))));
      const Ray leaving{offset_origin(hit->point, d), d};
      if (scene.intersect(leaving)) ++self;
      EXPECT_EQ(scene.occluded(leaving), scene.intersect(leaving).has_value());
    }
  }
  EXPECT_GT(hits, 100000);
  EXPECT_EQ(self, 0) << "of " << hits;
  EXPECT_LE(worst, 1);
  RecordProperty("worst_share_of_bound", std::to_string(worst));
}

TEST(Mesh, SampledPointsLieWithinTheErrorBound) {
  Random random(2);
  double worst = 0;
  for (int n = 0; n < 2000; ++n) {
    const TestMesh mesh(plain(), random_triangle(random));
    if (mesh.primitive_count() == 0) continue;
    const auto sampler = mesh.make_area_sampler(AreaUse::emitter);
    const auto& p = mesh.data().positions;
    const TriangleIndices& t = mesh.data().triangles[0];
    const TriangleCorners c = {p[t[0]], p[t[1]], p[t[2]]};
    const float size = length(c[1] - c[0]);
    for (int i = 0; i < 20; ++i) {
      const Vec3 o = c[0] + random.direction() * (size * std::pow(10.f, random.uniform(-2, 3)));
      const auto s = sampler->sample_direct(o, 0, random.square());
      if (!s) continue;
      SurfacePoint at;
      at.p = s->p, at.p_error = s->p_error;
      worst = std::max(worst, distance_to_plane(at, c) / allowed(at, c));
      EXPECT_TRUE(std::isfinite(s->pdf));
    }
  }
  EXPECT_LE(worst, 1);
}

TEST(Mesh, DegenerateTrianglesAreDropped) {
  MeshData d;
  d.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {2, 0, 0}, {NAN, 0, 0}};  // no triangle has the last one
  d.triangles = {{0, 1, 1}, {0, 1, 2}, {0, 1, 3}};
  const TestMesh mesh(plain(), d);
  EXPECT_EQ(mesh.primitive_count(), 1u);
  ASSERT_EQ(mesh.remarks().size(), 1u);
  EXPECT_EQ(mesh.remarks()[0], "2 degenerate triangles dropped");
  EXPECT_EQ(mesh.bounds().upper.x, 1);
  EXPECT_TRUE(OneShapeScene(mesh).intersect({{0.2f, 0.2f, 1}, {0, 0, -1}}));
}

TEST(Mesh, PositionsThatAreNotFiniteAreErrors) {
  for (const float bad : {NAN, INFINITY, -INFINITY}) {
    MeshData d;
    d.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, bad, 0}};
    d.triangles = {{0, 1, 2}, {0, 1, 3}};
    try {
      const TestMesh mesh(plain(), d);
      ADD_FAILURE() << bad;
    } catch (const Error& e) {
      EXPECT_NE(std::string(e.what()).find("vertex 4 of 4"), std::string::npos) << e.what();
    }
  }
}

TEST(Mesh, TinyTrianglesAreKept) {
  MeshData d;
  d.positions = {{0, 0, 0}, {1e-15f, 0, 0}, {0, 1e-15f, 0}};
  d.triangles = {{0, 1, 2}};
  EXPECT_EQ(TestMesh(plain(), d).primitive_count(), 1u);
}

TEST(Mesh, EmptyMeshIsARemarkAndAnErrorOnAnEmitter) {
  MeshData d;
  const TestMesh mesh(plain(), d);
  ASSERT_EQ(mesh.remarks().size(), 1u);
  EXPECT_TRUE(mesh.bounds().empty());
  EXPECT_FALSE(OneShapeScene(mesh).intersect({{0, 0, 1}, {0, 0, -1}}));
  EXPECT_THROW(mesh.make_area_sampler(AreaUse::emitter), Error);
}

TEST(Mesh, VertexNormalsDecideTheSide) {
  MeshData d;
  d.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  d.normals.assign(3, Vec3{0, 0, -1});
  d.triangles = {{0, 1, 2}};  // counter-clockwise seen from +z
  const TestMesh mesh(plain(), d);
  const auto hit = OneShapeScene(mesh).intersect({{0.2f, 0.3f, 1}, {0, 0, -1}});
  ASSERT_TRUE(hit);
  EXPECT_EQ(hit->point.ng.z, -1);
  EXPECT_EQ(hit->point.shading.n.z, -1);
  ASSERT_EQ(mesh.remarks().size(), 1u);
}

TEST(Mesh, ComputedNormalsAreWeightedByAngle) {
  // A cube corner at the origin, one of whose sides is two triangles: the normal must still be the diagonal.
  MeshData d;
  d.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 0}};
  d.triangles = {{0, 4, 1}, {0, 2, 4}, {0, 3, 2}, {0, 1, 3}};
  const TestMesh mesh(plain(), d);
  const Vec3 n = mesh.data().normals[0];
  EXPECT_NEAR(n.x, -1 / std::sqrt(3.f), 1e-5f);
  EXPECT_NEAR(n.y, n.x, 1e-5f);
  EXPECT_NEAR(n.z, n.x, 1e-5f);
}

TEST(Mesh, TangentFollowsTextureCoordinates) {
  // A BSDF that does not look at the tangent does without.
  const ObjectPtr rough = testing::build_object(R"(<bsdf type="roughconductor"/>)");
  const auto shape =
      ShapeBuilder("rectangle").set("", rough).to_world(Transform::rotate(0, 0, 1, 30)).build();
  const auto hit = OneShapeScene(*shape).intersect({{0.1f, 0.2f, 1}, {0, 0, -1}});
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->point.shading.s.x, std::cos(kPi / 6), 1e-6f);
  EXPECT_NEAR(hit->point.shading.s.y, std::sin(kPi / 6), 1e-6f);
  EXPECT_NEAR(hit->point.shading.n.z, 1, 1e-6f);
}

TEST(Rectangle, NormalAndTextureCoordinates) {
  const auto shape = ShapeBuilder("rectangle").build();
  const auto hit = OneShapeScene(*shape).intersect({{0.1f, 0.2f, 5}, {0, 0, -1}});
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->point.uv.x, 0.55f, 1e-6f);
  EXPECT_NEAR(hit->point.uv.y, 0.6f, 1e-6f);
  EXPECT_EQ(hit->point.ng.z, 1);
  const auto flipped = ShapeBuilder("rectangle").set("flip_normals", true).build();
  const auto back = OneShapeScene(*flipped).intersect({{0.1f, 0.2f, 5}, {0, 0, -1}});
  ASSERT_TRUE(back);
  EXPECT_NEAR(back->point.uv.x, 0.55f, 1e-6f);
  EXPECT_EQ(back->point.ng.z, -1);
  EXPECT_EQ(back->point.shading.n.z, -1);
}

TEST(Rectangle, MirroringKeepsTheNormal) {
  const auto shape = ShapeBuilder("rectangle").to_world(Transform::scale(-1, 1, 1)).build();
  const auto hit = OneShapeScene(*shape).intersect({{0.1f, 0.2f, 5}, {0, 0, -1}});
  ASSERT_TRUE(hit);
  EXPECT_EQ(hit->point.ng.z, 1);
  EXPECT_EQ(hit->point.shading.n.z, 1);
  EXPECT_NEAR(hit->point.uv.x, 0.45f, 1e-6f);
}

TEST(Cube, SidesNormalsAndTextureCoordinates) {
  for (const bool mirrored : {false, true})
    for (const bool flipped : {false, true}) {
      const auto shape = ShapeBuilder("cube")
                             .to_world(Transform::scale(mirrored ? -1 : 1, 1, 1))
                             .set("flip_normals", flipped)
                             .build();
      EXPECT_EQ(shape->primitive_count(), 12u);
      EXPECT_TRUE(shape->remarks().empty());
      const OneShapeScene scene(*shape);
      Random random(4);
      for (int i = 0; i < 500; ++i) {
        const Vec3 d = random.direction();
        const auto hit = scene.intersect({{0.1f, 0.1f, 0.1f}, d});
        ASSERT_TRUE(hit);
        EXPECT_EQ(dot(hit->point.ng, d) > 0, !flipped);
        EXPECT_GT(dot(hit->point.ng, hit->point.shading.n), 0.999f);
        EXPECT_GE(hit->point.uv.x, -1e-6f);
        EXPECT_LE(hit->point.uv.y, 1 + 1e-6f);
      }
    }
  // As Mitsuba 3.9: the top side met at (0.1, 0.2).
  const auto cube = ShapeBuilder("cube").build();
  const auto hit = OneShapeScene(*cube).intersect({{0.1f, 0.2f, 5}, {0, 0, -1}});
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->point.uv.x, 0.6f, 1e-6f);
  EXPECT_NEAR(hit->point.uv.y, 0.55f, 1e-6f);
}

TEST(Patches, RectanglesBecomeOne) {
  EXPECT_EQ(ShapeBuilder("rectangle").build_sampler()->patch_count(), 1u);
  const auto cube = ShapeBuilder("cube").to_world(Transform::rotate(1, 2, 3, 30)).build_sampler();
  EXPECT_EQ(cube->patch_count(), 6u);
  float area = 0;
  for (std::size_t i = 0; i < 6; ++i) area += cube->patch_area(i);
  EXPECT_NEAR(area, 24, 1e-4f);
  for (std::uint32_t i = 0; i < 12; ++i) EXPECT_LT(cube->patch_of_primitive(i), 6u);
  const auto [n, cosine] = cube->patch_normals(0);
  EXPECT_NEAR(length(n), 1, 1e-6f);
  EXPECT_EQ(cosine, 1);
}

TEST(Patches, VerticesSplitByAttributesStillPair) {
  MeshData d;
  d.positions = {{0, 0, 0}, {2, 0, 0}, {0, 1, 0}, {2, 0, 0}, {2, 1, 0}, {0, 1, 0}};
  d.triangles = {{0, 1, 2}, {3, 4, 5}};
  const TestMesh mesh(plain(), d);
  const auto sampler = mesh.make_area_sampler(AreaUse::emitter);
  EXPECT_EQ(sampler->patch_count(), 1u);
  EXPECT_NEAR(sampler->patch_area(0), 2, 1e-6f);
  // A sensor needs no patches, and no memory for them.
  const auto plain_sampler = mesh.make_area_sampler(AreaUse::sensor);
  EXPECT_EQ(plain_sampler->patch_count(), 2u);
  EXPECT_LT(plain_sampler->memory_bytes(), sampler->memory_bytes());
}

TEST(Patches, OthersStayTriangles) {
  MeshData d;
  d.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0.1f}};  // not in one plane
  d.triangles = {{0, 1, 2}, {1, 3, 2}};
  const auto patches = [&] {
    const TestMesh mesh(plain(), d);
    return mesh.make_area_sampler(AreaUse::emitter)->patch_count();
  };
  EXPECT_EQ(patches(), 2u);
  d.positions[3] = {2, 2, 0};  // a kite
  EXPECT_EQ(patches(), 2u);
  d.positions[3] = {1, 1, 0};
  d.triangles[1] = {1, 2, 3};  // the other side shines
  EXPECT_EQ(patches(), 2u);
}

TEST(Asset, Children) {
  const auto two = [] {
    ShapeBuilder("rectangle").emitting().set("other", test::make_dark_emitter()).build_asset();
  };
  EXPECT_THROW(two(), Error);
  const auto asset = ShapeBuilder("rectangle").build_asset();
  ASSERT_EQ(asset->primitives().size(), 1u);
  EXPECT_TRUE(asset->primitives()[0].bsdf);
  EXPECT_EQ(asset->primitives()[0].emitter, nullptr);
  EXPECT_EQ(asset->primitives()[0].area, nullptr);
  const auto lamp = ShapeBuilder("rectangle").emitting().build_asset();
  EXPECT_TRUE(lamp->primitives()[0].emitter);
  ASSERT_TRUE(lamp->primitives()[0].area);
  EXPECT_EQ(lamp->primitives()[0].area->patch_count(), 1u);
}

}  // namespace
}  // namespace aureole

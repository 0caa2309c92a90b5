// SPDX-License-Identifier: Apache-2.0
#include "aureole/shape/geometry/double3.h"
#include "shape/shape_test_support.h"

namespace aureole {
namespace {

using test::OneShapeScene;
using test::Random;
using test::ShapeBuilder;

TEST(Disk, NormalsAndTextureCoordinatesAsMitsuba) {
  // Reference values: Mitsuba 3.9.1.
  struct Expected {
    ShapeBuilder builder;
    float t;
    Vec3 n, s;
    float u, v;
  };
  const Vec3 radial{0.447214f, 0.894427f, 0};
  const Transform turned = Transform::rotate(1, 2, 3, 50) * Transform::scale(2, 0.5, 3);
  const std::vector<Expected> all = {
      {ShapeBuilder("disk"), 5, {0, 0, 1}, radial, 0.223607f, 0.176208f},
      {ShapeBuilder("disk").set("flip_normals", true), 5, {0, 0, -1}, radial, 0.223607f, 0.176208f},
      {ShapeBuilder("disk").to_world(Transform::scale(-1, 1, 1)), 5, {0, 0, 1}, radial, 0.223607f, 0.323792f},
      {ShapeBuilder("disk").to_world(Transform::scale(1, 1, -1)),
       5,
       {0, 0, -1},
       radial,
       0.223607f,
       0.176208f},
      {ShapeBuilder("disk").to_world(turned),
       5.043869f,
       {0.486014f, -0.0516429f, 0.872424f},
       {0.438848f, 0.877695f, -0.19252f},
       0.187587f,
       0.153145f}};
  for (const Expected& e : all) {
    const auto shape = e.builder.build();
    const auto hit = OneShapeScene(*shape).intersect({{0.1f, 0.2f, 5}, {0, 0, -1}});
    ASSERT_TRUE(hit);
    EXPECT_NEAR(hit->t, e.t, 1e-5f);
    EXPECT_LT(length(hit->point.ng - e.n), 1e-5f);
    EXPECT_LT(length(hit->point.shading.n - e.n), 1e-5f);
    EXPECT_GT(dot(hit->point.shading.s, e.s), 0.9999f);
    EXPECT_NEAR(hit->point.uv.x, e.u, 1e-5f);
    EXPECT_NEAR(hit->point.uv.y, e.v, 1e-5f);
  }
}

TEST(Disk, RimAndBounds) {
  const auto shape = ShapeBuilder("disk").to_world(Transform::rotate(0, 1, 0, 90)).build();
  const OneShapeScene scene(*shape);
  for (int i = 0; i < 100; ++i) {
    const float phi = 0.0628f * float(i), inside = 0.9999f, outside = 1.0001f;
    const auto at = [&](float r) { return Ray{{2, r * std::cos(phi), r * std::sin(phi)}, {-1, 0, 0}}; };
    EXPECT_TRUE(scene.intersect(at(inside)));
    EXPECT_FALSE(scene.intersect(at(outside)));
    EXPECT_TRUE(scene.occluded(at(inside)));
    EXPECT_FALSE(scene.occluded(at(outside)));
  }
  EXPECT_FALSE(scene.intersect({{0, 3, 0}, {0, -1, 0}})) << "in its plane";
  const Bounds3 b = shape->bounds();
  EXPECT_NEAR(b.lower.y, -1, 1e-6f);
  EXPECT_NEAR(b.upper.z, 1, 1e-6f);
  EXPECT_NEAR(b.upper.x, 0, 1e-6f);
}

TEST(Disk, HitsAreExactAndLeaveWithoutMeetingThemselves) {
  Random random(1);
  int hits = 0, self = 0, wrong = 0;
  for (int n = 0; n < 300; ++n) {
    const float size = std::pow(10.f, random.uniform(-3, 3));
    const Vec3 c = random.direction() * (size * std::pow(10.f, random.uniform(-2, 3)));
    const Vec3 axis = random.direction();
    const Transform t = Transform::translate(c.x, c.y, c.z) *
                        Transform::rotate(axis.x, axis.y, axis.z, random.uniform(0, 360)) *
                        Transform::scale(size, size * random.uniform(0.1f, 1), 1);
    const auto shape = ShapeBuilder("disk").to_world(t).build();
    const OneShapeScene scene(*shape);
    const Vec3 center = t.point({0, 0, 0});
    const Double3 exact(t.matrix()[0][3], t.matrix()[1][3], t.matrix()[2][3]);
    const auto& m = t.matrix();
    const Double3 x(m[0][0], m[1][0], m[2][0]), y(m[0][1], m[1][1], m[2][1]);
    const Double3 normal = normalize(cross(x, y));
    for (int i = 0; i < 400; ++i) {
      const Vec3 o = center + random.direction() * (size * random.uniform(0.1f, 100));
      const Vec3 target = t.point({random.uniform(-0.7f, 0.7f), random.uniform(-0.7f, 0.7f), 0});
      const auto hit = scene.intersect({o, normalize(target - o)});
      if (!hit) continue;
      ++hits;
      const double gap = std::abs(dot(Double3(hit->point.p) - exact, normal));
      wrong += gap > double(dot(abs(hit->point.ng), hit->point.p_error));
      Vec3 d = random.direction();
      if (i % 2)
        d = normalize(d -
                      hit->point.ng * (dot(d, hit->point.ng) * (1 - std::pow(10.f, random.uniform(-6, 0)))));
      const Ray leaving{offset_origin(hit->point, d), d};
      self += scene.intersect(leaving).has_value();
      EXPECT_EQ(scene.occluded(leaving), scene.intersect(leaving).has_value());
    }
  }
  EXPECT_GT(hits, 80000);
  EXPECT_EQ(self, 0) << "of " << hits;
  EXPECT_EQ(wrong, 0) << "of " << hits;
}

TEST(Disk, AreaUnderAnyTransform) {
  EXPECT_NEAR(ShapeBuilder("disk").build_sampler()->patch_area(0), kPi, 1e-6f);
  EXPECT_NEAR(ShapeBuilder("disk").to_world(Transform::scale(2, 3, 7)).build_sampler()->patch_area(0),
              6 * kPi, 1e-5f);
  Transform::Matrix m = Transform().matrix();
  m[0][1] = 0.8;  // a shear in the plane keeps the area
  EXPECT_NEAR(ShapeBuilder("disk").to_world(Transform(m)).build_sampler()->patch_area(0), kPi, 1e-6f);
}

}  // namespace
}  // namespace aureole

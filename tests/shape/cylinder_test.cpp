// SPDX-License-Identifier: Apache-2.0
#include "aureole/shape/geometry/double3.h"
#include "shape/shape_test_support.h"

namespace aureole {
namespace {

using test::OneShapeScene;
using test::Random;
using test::ShapeBuilder;

ShapeBuilder upright() {
  return ShapeBuilder("cylinder").set("p0", Vec3{0, 0, -1}).set("p1", Vec3{0, 0, 1}).set("radius", 0.5);
}

TEST(Cylinder, NormalsAndTextureCoordinatesAsMitsuba) {
  // Reference values: Mitsuba 3.9.1.
  struct Expected {
    ShapeBuilder builder;
    float t;
    Vec3 n, s;
    float u, v;
  };
  const Vec3 n{0.2f, 0.979796f, 0}, s{-0.979796f, 0.2f, 0};
  const std::vector<Expected> all = {
      {upright(), 4.510102f, n, s, 0.217953f, 0.6f},
      {upright().set("flip_normals", true), 4.510102f, -n, s, 0.217953f, 0.6f},
      {upright().to_world(Transform::scale(-1, 1, 1)), 4.510102f, n, -s, 0.282047f, 0.6f},
      {upright().to_world(Transform::scale(1, 1, -1)), 4.510102f, n, s, 0.217953f, 0.4f},
      {upright().to_world(Transform::scale(-2, -2, 1)),
       4.005013f,
       {0.1f, 0.994987f, 0},
       {-0.994987f, 0.1f, 0},
       0.734058f,
       0.6f},
      {upright().to_world(Transform::scale(2, 1, 1)),
       4.502506f,
       {0.0501886f, 0.99874f, 0},
       {-0.99874f, 0.0501886f, 0},
       0.234058f,
       0.6f},
      {ShapeBuilder("cylinder").set("p0", Vec3{0, 0, -1}).set("p1", Vec3{0.5f, 0.3f, 1}).set("radius", 0.5),
       4.361387f,
       {-0.40866f, 0.912029f, -0.0346395f},
       {-0.880564f, -0.384012f, 0.277743f},
       0.316263f,
       0.60866f}};
  for (const Expected& e : all) {
    const auto shape = e.builder.build();
    const auto hit = OneShapeScene(*shape).intersect({{0.1f, 5, 0.2f}, {0, -1, 0}});
    ASSERT_TRUE(hit);
    EXPECT_NEAR(hit->t, e.t, 1e-5f);
    EXPECT_LT(length(hit->point.ng - e.n), 2e-5f);
    EXPECT_LT(length(hit->point.shading.n - e.n), 2e-5f);
    EXPECT_LT(length(hit->point.shading.s - e.s), 2e-5f);
    EXPECT_NEAR(hit->point.uv.x, e.u, 1e-5f);
    EXPECT_NEAR(hit->point.uv.y, e.v, 1e-5f);
  }
}

TEST(Cylinder, IsOpen) {
  const auto shape = upright().build();
  const OneShapeScene scene(*shape);
  EXPECT_FALSE(scene.intersect({{0.1f, 0.2f, 5}, {0, 0, -1}}));
  EXPECT_FALSE(scene.intersect({{0, 5, 1.001f}, {0, -1, 0}}));
  EXPECT_FALSE(scene.occluded({{0, 5, -1.001f}, {0, -1, 0}}));
  // Through the open end onto the inside, whose normal points away.
  const auto inside = scene.intersect({{0, 0.4f, 3}, normalize(Vec3{0, -0.3f, -1})});
  ASSERT_TRUE(inside);
  EXPECT_GT(dot(inside->point.ng, normalize(Vec3{0, -0.3f, -1})), 0);
  EXPECT_NEAR(test::sampler_of(shape)->patch_area(0), 2 * kPi, 1e-5f);
  EXPECT_NEAR(shape->bounds().upper.z, 1, 1e-5f);
  EXPECT_NEAR(shape->bounds().lower.x, -0.5f, 1e-5f);
}

TEST(Cylinder, AreaOfAnEllipticOne) {
  // Perimeter of an ellipse of half-axes 3 and 1 (Ramanujan's second series to all its digits): 13.364893...
  const auto shape = ShapeBuilder("cylinder").to_world(Transform::scale(3, 1, 2)).build_sampler();
  EXPECT_NEAR(shape->patch_area(0), 2 * 13.3648932205, 1e-4);
}

TEST(Cylinder, WrongParametersAreLocatedErrors) {
  const std::string flat =
      test::build_error(ShapeBuilder("cylinder").set("p0", Vec3{1, 2, 3}).set("p1", Vec3{1, 2, 3}));
  EXPECT_NE(flat.find("scene.xml:8:5"), std::string::npos) << flat;
  EXPECT_NE(flat.find("no length"), std::string::npos) << flat;
  EXPECT_NE(test::build_error(ShapeBuilder("cylinder").set("radius", -1.0)), "");
}

TEST(Cylinder, HitsAreExactAndLeaveWithoutMeetingThemselves) {
  Random random(1);
  int hits = 0, self = 0, wrong = 0;
  for (int n = 0; n < 300; ++n) {
    const float radius = std::pow(10.f, random.uniform(-3, 2)),
                l = radius * std::pow(10.f, random.uniform(-1, 2));
    const Vec3 p0 = random.direction() * (radius * std::pow(10.f, random.uniform(-1, 3)));
    const Vec3 axis = random.direction(), p1 = p0 + axis * l;
    const auto shape =
        ShapeBuilder("cylinder").set("p0", p0).set("p1", p1).set("radius", double(radius)).build();
    const OneShapeScene scene(*shape);
    const Double3 along = normalize(Double3(p1) - Double3(p0));
    for (int i = 0; i < 400; ++i) {
      const Vec3 target =
          p0 + axis * (l * random.uniform(0.05f, 0.95f)) + random.direction() * (radius * 0.7f);
      const Vec3 o = target + random.direction() * (radius * std::pow(10.f, random.uniform(-0.5, 2)));
      const auto hit = scene.intersect({o, normalize(target - o)});
      if (!hit) continue;
      ++hits;
      const Double3 w = Double3(hit->point.p) - Double3(p0);
      const double gap = std::abs(length(w - along * dot(w, along)) - double(radius));
      wrong += gap > 1.01 * length(Double3(hit->point.p_error));
      // Away from the tangent plane, outside: nothing more. Inside: the chord, unless it ends outside.
      Vec3 out = random.direction();
      if (dot(out, hit->point.ng) < 0) out = -out;
      if (i % 2)
        out = normalize(out - hit->point.ng *
                                  (dot(out, hit->point.ng) * (1 - std::pow(10.f, random.uniform(-5, 0)))));
      if (!(dot(out, hit->point.ng) > 1e-6f)) continue;
      self += scene.intersect({offset_origin(hit->point, out), out}).has_value();
      const Vec3 in = -out;
      const auto chord = scene.intersect({offset_origin(hit->point, in), in});
      const double across = 1 - std::pow(dot(Double3(in), along), 2);
      const double expected = 2 * radius * std::abs(dot(in, hit->point.ng)) / across;
      // The rounding of the cosine counts where it is small.
      const double cosine = std::abs(dot(in, hit->point.ng));
      const double slack = 20 * length(hit->point.p_error) / cosine + (1e-4 + 5e-7 / cosine) * expected;
      if (chord && expected > 20 * slack) wrong += std::abs(chord->t - expected) > slack;
    }
  }
  EXPECT_GT(hits, 70000);
  EXPECT_EQ(self, 0) << "of " << hits;
  EXPECT_EQ(wrong, 0) << "of " << hits;
}

}  // namespace
}  // namespace aureole

// SPDX-License-Identifier: Apache-2.0
#include "aureole/shape/geometry/double3.h"
#include "shape/shape_test_support.h"

namespace aureole {
namespace {

using test::OneShapeScene;
using test::Random;
using test::ShapeBuilder;

TEST(Sphere, NormalsAndTextureCoordinatesAsMitsuba) {
  // Reference values: Mitsuba 3.9.
  struct Expected {
    ShapeBuilder builder;
    float side, s_x, u, v;
  };
  const float a = 0.894427f;
  std::vector<Expected> all = {
      {ShapeBuilder("sphere"), 1, -a, 0.176208f, 0.0717831f},
      {ShapeBuilder("sphere").to_world(Transform::scale(-1, 1, 1)), -1, a, 0.323792f, 0.0717831f},
      {ShapeBuilder("sphere").set("flip_normals", true), -1, -a, 0.176208f, 0.0717831f}};
  for (const auto& e : all) {
    const auto shape = e.builder.build();
    const auto hit = OneShapeScene(*shape).intersect({{0.1f, 0.2f, 5}, {0, 0, -1}});
    ASSERT_TRUE(hit);
    EXPECT_NEAR(hit->t, 4.025320529937744f, 1e-6f);
    EXPECT_NEAR(hit->point.ng.z, e.side * 0.974679f, 1e-6f);
    EXPECT_NEAR(hit->point.shading.n.z, e.side * 0.974679f, 1e-6f);
    EXPECT_NEAR(hit->point.shading.s.x, e.s_x, 1e-5f);
    EXPECT_NEAR(hit->point.uv.x, e.u, 1e-6f);
    EXPECT_NEAR(hit->point.uv.y, e.v, 1e-6f);
  }
}

TEST(Sphere, Placement) {
  const auto shape = ShapeBuilder("sphere")
                         .set("center", Vec3{1, 2, 3})
                         .set("radius", 0.5)
                         .to_world(Transform::translate(10, 0, 0) * Transform::scale(2, 2, 2))
                         .build();
  EXPECT_NEAR(shape->bounds().lower.x, 11, 1e-5f);
  EXPECT_NEAR(shape->bounds().upper.z, 7, 1e-5f);
  EXPECT_NEAR(test::sampler_of(shape)->patch_area(0), 4 * kPi, 1e-5f);
}

TEST(Sphere, WrongParametersAreLocatedErrors) {
  const std::string skewed = test::build_error(ShapeBuilder("sphere").to_world(Transform::scale(1, 2, 1)));
  EXPECT_NE(skewed.find("scene.xml:8:5"), std::string::npos) << skewed;
  EXPECT_NE(skewed.find("uniform"), std::string::npos) << skewed;
  EXPECT_NE(test::build_error(ShapeBuilder("sphere").set("radius", 0.0)), "");
}

TEST(Sphere, HitsAreExactAndLeaveWithoutMeetingThemselves) {
  Random random(1);
  int self = 0, hits = 0, wrong = 0;
  for (int n = 0; n < 200; ++n) {
    const float radius = std::pow(10.f, random.uniform(-3, 3));
    const Vec3 center = random.direction() * (radius * std::pow(10.f, random.uniform(-2, 3)));
    const auto shape = ShapeBuilder("sphere").set("center", center).set("radius", double(radius)).build();
    const OneShapeScene scene(*shape);
    for (int i = 0; i < 600; ++i) {
      const bool inside = i % 3 == 0;
      const Vec3 o = center + random.direction() *
                                  (radius * (inside ? random.uniform(0, 0.9f) : random.uniform(1.1f, 100.f)));
      const Vec3 d = normalize(center + random.direction() * (radius * random.uniform(0, 1)) - o);
      const auto hit = scene.intersect({o, d});
      if (!hit) continue;
      ++hits;
      // On the sphere, to within the bound.
      const double gap = length(Double3(hit->point.p) - Double3(center)) - double(radius);
      if (std::abs(gap) > length(Double3(hit->point.p_error))) ++wrong;
      // The ray leaves away from the tangent plane: any hit is a chord through the ball, so none from
      // outside...
      Vec3 out = random.direction();
      if (dot(out, hit->point.ng) < 0) out = -out;
      if (scene.intersect({offset_origin(hit->point, out), out})) ++self;
      // ...and from inside always one, at the length of the chord.
      const Vec3 in = -out;
      const auto chord = scene.intersect({offset_origin(hit->point, in), in});
      const float expected = 2 * radius * std::abs(dot(in, hit->point.ng));
      const float slack =
          10 * length(hit->point.p_error) / std::abs(dot(in, hit->point.ng)) + 1e-5f * expected;
      if (expected > 20 * slack && (!chord || std::abs(chord->t - expected) > slack)) ++wrong;
    }
  }
  EXPECT_GT(hits, 100000);
  EXPECT_EQ(self, 0) << "of " << hits;
  EXPECT_EQ(wrong, 0) << "of " << hits;
}

TEST(Sphere, FarAwayAndThin) {
  // Seen from 10^5 radii: the float discriminant has no correct digit.
  const auto shape = ShapeBuilder("sphere").build();
  const OneShapeScene scene(*shape);
  for (const float x : {0.f, 0.5f, 0.9f, 0.999f}) {
    const auto hit = scene.intersect({{x, 0, 1e5f}, {0, 0, -1}});
    ASSERT_TRUE(hit) << x;
    // The point comes from the float distance: its error across the ray is none, along the ray it is
    // reprojected.
    EXPECT_NEAR(hit->point.p.x, x, 0.02f);
    EXPECT_NEAR(length(hit->point.p), 1, 1e-6f);
  }
  EXPECT_FALSE(scene.intersect({{1.0001f, 0, 1e5f}, {0, 0, -1}}));
}

TEST(Sphere, PacketsAgreeWithSingleRays) {
  const auto shape = ShapeBuilder("sphere").set("center", Vec3{0.3f, 0, 0}).build();
  const OneShapeScene scene(*shape);
  Random random(3);
  for (int round = 0; round < 200; ++round) {
    alignas(64) int valid[8];
    alignas(64) RTCRayHit8 packet{};
    alignas(64) RTCRay8 shadow{};
    Ray rays[8];
    for (int i = 0; i < 8; ++i) {
      rays[i] = {random.direction() * random.uniform(0, 4), random.direction(), random.uniform(0.5f, 10)};
      valid[i] = random.uniform() < 0.8f ? -1 : 0;
      const Ray& r = rays[i];
      packet.ray.org_x[i] = r.o.x, packet.ray.org_y[i] = r.o.y, packet.ray.org_z[i] = r.o.z;
      packet.ray.dir_x[i] = r.d.x, packet.ray.dir_y[i] = r.d.y, packet.ray.dir_z[i] = r.d.z;
      packet.ray.tfar[i] = r.t_max, packet.ray.mask[i] = ~0u;
      packet.hit.geomID[i] = packet.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
    }
    shadow = packet.ray;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect8(valid, scene.scene(), &context, &packet);
    rtcInitIntersectContext(&context);
    rtcOccluded8(valid, scene.scene(), &context, &shadow);
    for (int i = 0; i < 8; ++i) {
      if (!valid[i]) continue;
      const auto hit = scene.intersect(rays[i]);
      ASSERT_EQ(hit.has_value(), packet.hit.geomID[i] != RTC_INVALID_GEOMETRY_ID);
      ASSERT_EQ(hit.has_value(), shadow.tfar[i] < 0);
      if (hit) {
        EXPECT_EQ(hit->t, packet.ray.tfar[i]);
      }
    }
  }
}

TEST(Sphere, PointsOnTheSurfaceSeeTheFarSide) {
  // Reference points on a shining sphere itself: the density is that of all directions and samples are
  // visible from inside.
  const auto shape = ShapeBuilder("sphere").set("flip_normals", true).build_sampler();
  Random random(7);
  double mean = 0;
  constexpr int kSamples = 20000;
  for (int i = 0; i < kSamples; ++i) {
    const Vec3 reference = random.direction();
    const auto s = shape->sample_direct(reference, 0, random.square());
    if (!s) continue;
    EXPECT_EQ(s->pdf, shape->pdf_direct(reference, 0, SurfacePoint{}));
    mean += 1 / s->pdf / kSamples;
  }
  EXPECT_NEAR(mean, 2 * kPi, 0.15f);  // half of all directions hit the sphere
}

}  // namespace
}  // namespace aureole

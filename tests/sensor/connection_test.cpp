// SPDX-License-Identifier: Apache-2.0
// Connections of light paths to sensors: what sample_ray sees, sample_direct finds at the same place on the
// film, and its importance is the area that an area of the scene covers there.
#include <gtest/gtest.h>

#include <cmath>

#include "aureole/sensor/sensor.h"
#include "harness/properties_builder.h"
#include "harness/statistics.h"

namespace aureole::testing {
namespace {

const char* const kCamera = R"(<sensor type="perspective">
  <transform name="to_world"><lookat origin="1, 2, 3" target="-2, 1, 0" up="0, 1, 0.2"/></transform>
  <float name="fov" value="70"/> <float name="near_clip" value="0.5"/> <float name="far_clip" value="50"/>
  <float name="principal_point_offset_x" value="0.1"/> <float name="principal_point_offset_y" value="-0.2"/>
  <film type="hdrfilm"><integer name="width" value="300"/><integer name="height" value="200"/></film>
</sensor>)";

TEST(PerspectiveConnection, IsTheInverseOfItsRays) {
  const auto sensor = std::dynamic_pointer_cast<Sensor>(build_object(kCamera, make_context(360, 830)));
  ASSERT_TRUE(sensor);
  TestRandom random(1);
  for (int i = 0; i < 1000; ++i) {
    const Vec2 film{random.next() * 300, random.next() * 200};
    const Ray ray = sensor->sample_ray(film, {}).ray;
    const Vec3 p = ray.o + ray.d * (0.1f + 10 * random.next());
    const auto c = sensor->sample_direct(p, {});
    ASSERT_TRUE(c);
    EXPECT_NEAR(c->film.x, film.x, 2e-3);
    EXPECT_NEAR(c->film.y, film.y, 2e-3);
    EXPECT_NEAR(dot(c->wo, ray.d), -1, 1e-5);
    EXPECT_NEAR(length(c->p - ray.o), 0, 1e-5) << "the connection ends where the ray begins";

    // A small square across the direction covers a parallelogram of the film.
    const Frame frame = Frame::from_normal(ray.d);
    const float step = 1e-2f * length(p - ray.o);
    const auto at = [&](float s, float t) {
      return sensor->sample_direct(p + frame.s * s + frame.t * t, {})->film;
    };
    const Vec2 a = at(step, 0) - at(-step, 0), b = at(0, step) - at(0, -step);
    const float area = std::abs(a.x * b.y - a.y * b.x) / (4 * step * step);
    EXPECT_NEAR(c->importance, area, 2e-3 * area);
  }
}

TEST(PerspectiveConnection, SeesBetweenItsClippingPlanesOnly) {
  const auto sensor = std::dynamic_pointer_cast<Sensor>(build_object(kCamera, make_context(360, 830)));
  const Ray ray = sensor->sample_ray({150, 100}, {}).ray;
  EXPECT_FALSE(sensor->sample_direct(ray.o - ray.d * 0.01f, {})) << "nearer than the near plane";
  EXPECT_FALSE(sensor->sample_direct(ray.o - ray.d * 5.f, {})) << "behind";
  EXPECT_TRUE(sensor->sample_direct(ray.o + ray.d * (0.999f * ray.t_max), {}));
  EXPECT_FALSE(sensor->sample_direct(ray.o + ray.d * (1.001f * ray.t_max), {}));
}

}  // namespace
}  // namespace aureole::testing

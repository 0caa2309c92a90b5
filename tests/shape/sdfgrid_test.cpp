// SPDX-License-Identifier: Apache-2.0
// Signed distances on grids: against a search along rays and closed forms, leaving rays, instances, files.
#include <limits>

#include "aureole/plugin/array.h"
#include "aureole/scene/ray_tracer.h"
#include "aureole/shape/geometry/double3.h"
#include "shape/shape_test_support.h"

namespace aureole {
namespace {

using test::OneShapeScene;
using test::Random;
using test::ShapeBuilder;

/// Nodes of a grid over [0, 1]^3 and the function that they stand for, by the definition of trilinear interpolation.
struct Grid {
  std::array<int, 3> n;
  std::vector<double> values;

  template <class F>
  Grid(std::array<int, 3> size, F&& f) : n(size) {
    for (int z = 0; z < n[2]; ++z)
      for (int y = 0; y < n[1]; ++y)
        for (int x = 0; x < n[0]; ++x)
          values.push_back(double(float(f(x / (n[0] - 1.0), y / (n[1] - 1.0), z / (n[2] - 1.0)))));
  }
  double at(double x, double y, double z) const {
    const double p[3] = {x * (n[0] - 1), y * (n[1] - 1), z * (n[2] - 1)};
    double sum = 0;
    int cell[3];
    for (int k = 0; k < 3; ++k) cell[k] = std::clamp(int(std::floor(p[k])), 0, n[std::size_t(k)] - 2);
    for (int i = 0; i < 8; ++i) {
      double w = 1;
      int node[3];
      for (int k = 0; k < 3; ++k) {
        const int up = i >> k & 1;
        node[k] = cell[k] + up;
        w *= up ? p[k] - cell[k] : 1 - (p[k] - cell[k]);
      }
      sum += w * values[std::size_t((node[2] * n[1] + node[1]) * n[0] + node[0])];
    }
    return sum;
  }
  Double3 gradient(const Double3& p) const {
    const double h = 1e-6;
    return {(at(p.x + h, p.y, p.z) - at(p.x - h, p.y, p.z)) / (2 * h),
            (at(p.x, p.y + h, p.z) - at(p.x, p.y - h, p.z)) / (2 * h),
            (at(p.x, p.y, p.z + h) - at(p.x, p.y, p.z - h)) / (2 * h)};
  }
  ShapeBuilder builder() const {
    const std::vector<std::size_t> shape = {std::size_t(n[2]), std::size_t(n[1]), std::size_t(n[0])};
    return ShapeBuilder("sdfgrid").set("grid", ObjectPtr(std::make_shared<Array>(shape, values)));
  }
};

/// Many sheets and bridges: numbers without order.
Grid tangle() {
  Random random(5);
  return Grid({5, 7, 6}, [&](double, double, double) { return random.uniform(-1, 1); });
}
Grid ball(int n) {
  return Grid({n, n, n}, [](double x, double y, double z) {
    return std::sqrt((x - 0.5) * (x - 0.5) + (y - 0.5) * (y - 0.5) + (z - 0.5) * (z - 0.5)) - 0.35;
  });
}

TEST(SdfGrid, MeetsTheFirstZeroOfTheInterpolation) {
  const Grid grid = tangle();
  const auto shape = grid.builder().build();
  const OneShapeScene scene(*shape);
  Random random(1);
  int hits = 0, misses = 0, wrong = 0;
  for (int i = 0; i < 3000; ++i) {
    const Vec3 target{random.uniform(), random.uniform(), random.uniform()};
    const Vec3 o = i % 4 ? Vec3{0.5f, 0.5f, 0.5f} + random.direction() * 1.5f
                         : Vec3{random.uniform(), random.uniform(), random.uniform()};
    const Vec3 d = normalize(target - o);
    // Small steps along the ray inside the box, and bisection where the sign changes.
    const auto f = [&](double t) { return grid.at(o.x + d.x * t, o.y + d.y * t, o.z + d.z * t); };
    double t0 = 0, t1 = 10;
    for (int k = 0; k < 3; ++k) {
      const double a = (0.0 - o[k]) / double(d[k]), b = (1.0 - o[k]) / double(d[k]);
      t0 = std::max(t0, std::min(a, b)), t1 = std::min(t1, std::max(a, b));
    }
    double expected = -1;
    if (t0 < t1) {
      const int steps = 4000;
      for (int j = 0; j < steps && expected < 0; ++j) {
        double a = t0 + (t1 - t0) * j / steps, b = t0 + (t1 - t0) * (j + 1) / steps;
        if ((f(a) < 0) == (f(b) < 0)) continue;
        for (int k = 0; k < 50; ++k) {
          const double m = 0.5 * (a + b);
          ((f(m) < 0) == (f(a) < 0) ? a : b) = m;
        }
        expected = a;
      }
    }
    const auto hit = scene.intersect({o, d});
    EXPECT_EQ(scene.occluded({o, d}), hit.has_value());
    (hit ? hits : misses)++;
    // Two crossings within one step escape the search.
    if (hit.has_value() != (expected >= 0) || (hit && std::abs(hit->t - expected) > 1e-5)) {
      if (!(hit && (expected < 0 || hit->t < expected) && std::abs(f(double(hit->t))) < 1e-5)) ++wrong;
      continue;
    }
    if (!hit) continue;
    const SurfacePoint& p = hit->point;
    EXPECT_LT(std::abs(grid.at(p.p.x, p.p.y, p.p.z)), 5e-6);
    const Double3 g = grid.gradient(Double3(p.p));
    const double nearest_face = [&] {
      double least = 1;
      for (int k = 0; k < 3; ++k) {
        const double x = double(p.p[k]) * (grid.n[std::size_t(k)] - 1);
        least = std::min(least, std::abs(x - std::round(x)));
      }
      return least;
    }();
    if (nearest_face > 1e-4 && length(g) > 0.05) {
      EXPECT_GT(dot(normalize(g), Double3(p.ng)), 0.9999);
    }
    EXPECT_GT(dot(p.shading.n, p.ng), 0);
  }
  EXPECT_GT(hits, 1000);
  EXPECT_GT(misses, 20);
  EXPECT_EQ(wrong, 0);
}

TEST(SdfGrid, RaysLeaveWithoutMeetingThemselvesAndNoneSlipsThrough) {
  // Through a closed surface every ray from the middle gets out only by meeting it, however it is placed.
  const Transform placed = Transform::translate(30, -200, 7) * Transform::rotate(1, 2, 3, 50) *
                           Transform::scale(1, 0.6, -1.3) * Transform::translate(-0.5, -0.5, -0.5);
  const auto shape = ball(12).builder().to_world(placed).build();
  const OneShapeScene scene(*shape);
  Random random(2);
  const Vec3 middle{30, -200, 7};
  int missed = 0, self = 0, second = 0;
  for (int i = 0; i < 40000; ++i) {
    const Vec3 d = random.direction();
    const auto hit = scene.intersect({middle, d});
    if (!hit) {
      ++missed;
      continue;
    }
    EXPECT_GT(dot(hit->point.ng, d), 0);  // distances grow outwards, also mirrored
    Vec3 out = random.direction();
    if (dot(out, hit->point.ng) < 0) out = -out;
    // The interpolation of a ball bulges: near the horizon a ray may meet it again, but never at once.
    if (const auto again = scene.intersect({offset_origin(hit->point, out), out})) {
      self += again->t < 1e-4f;
      second += dot(out, hit->point.ng) > 0.3f;
    }
  }
  EXPECT_EQ(missed, 0);
  EXPECT_EQ(self, 0);
  EXPECT_EQ(second, 0);
}

TEST(SdfGrid, SmoothNormalsApproachThoseOfTheBall) {
  const auto smooth = ball(24).builder().build();
  const auto analytic = ball(24).builder().set("normals", std::string("analytic")).build();
  const OneShapeScene scene(*smooth), creased(*analytic);
  Random random(3);
  double error_smooth = 0, error_analytic = 0;
  for (int i = 0; i < 2000; ++i) {
    const Ray ray{{0.5f, 0.5f, 0.5f}, random.direction()};
    const auto a = scene.intersect(ray), b = creased.intersect(ray);
    ASSERT_TRUE(a && b);
    EXPECT_EQ(a->t, b->t);
    EXPECT_EQ(b->point.shading.n.x, b->point.ng.x);
    error_smooth += length(a->point.shading.n - ray.d), error_analytic += length(b->point.shading.n - ray.d);
    EXPECT_LT(length(a->point.shading.n - ray.d), 0.02f);
    EXPECT_NEAR(length(a->point.p - ray.o), 0.35f, 2e-3f);
    // Continuous: a point very near has nearly the same.
    const auto near = scene.intersect({ray.o, normalize(ray.d + random.direction() * 1e-5f)});
    ASSERT_TRUE(near);
    EXPECT_LT(length(near->point.shading.n - a->point.shading.n), 2e-4f);
  }
  EXPECT_LT(error_smooth, 0.5 * error_analytic);
}

TEST(SdfGrid, PlaneAtTheBorderAndBounds) {
  // z = .25 of unequal sizes along the axes, up to the faces of the grid.
  const Grid grid({3, 5, 4}, [](double, double, double z) { return z - 0.25; });
  const auto shape = grid.builder().to_world(Transform::scale(2, 3, 4)).build();
  EXPECT_EQ(shape->opening(), "the surface ends at the faces of its grid");
  EXPECT_EQ(ball(8).builder().build()->opening(), "");
  EXPECT_EQ(shape->primitive_count(), 8u);
  EXPECT_NEAR(shape->bounds().upper.x, 2, 1e-6f);
  EXPECT_NEAR(shape->bounds().upper.z, 4 / 3.f, 1e-6f);
  const OneShapeScene scene(*shape);
  for (const Vec2 at : {Vec2{1e-4f, 1e-4f}, Vec2{1, 1.5f}, Vec2{1.9999f, 2.9999f}, Vec2{1, 0.75f}}) {
    const auto hit = scene.intersect({{at.x, at.y, 9}, {0, 0, -1}});
    ASSERT_TRUE(hit) << at.x << " " << at.y;
    EXPECT_NEAR(hit->t, 8, 1e-6f);
    EXPECT_EQ(hit->point.ng.z, 1);
    EXPECT_NEAR(hit->point.shading.n.z, 1, 1e-6f);
  }
  EXPECT_FALSE(scene.intersect({{2.001f, 1, 9}, {0, 0, -1}}));
  EXPECT_EQ(OneShapeScene(*grid.builder().set("flip_normals", true).build())
                .intersect({{0.5f, 0.5f, 9}, {0, 0, -1}})
                ->point.ng.z,
            -1);
}

TEST(SdfGrid, Instances) {
  const ObjectPtr group =
      ShapeBuilder("shapegroup").set("", ObjectPtr(ball(10).builder().build_asset())).build_asset();
  const auto one = ball(10).builder().to_world(Transform::translate(2, 0, 0)).build_asset();
  const auto other =
      ShapeBuilder("instance").set("", group).to_world(Transform::translate(2, 0, 0)).build_asset();
  const RayTracer a(one->primitives()), b(other->primitives());
  Random random(4);
  for (int i = 0; i < 500; ++i) {
    const Ray ray{Vec3{2.5f, 0.5f, 0.5f} + random.direction() * 2, random.direction()};
    const auto x = a.intersect(ray), y = b.intersect(ray);
    ASSERT_EQ(bool(x), bool(y));
    if (x) {
      EXPECT_NEAR(x.t, y.t, 1e-5f);
    }
  }
}

TEST(SdfGrid, WrongInputIsALocatedError) {
  const auto error = [](std::array<int, 3> n, double offset, double slope) {
    return test::build_error(Grid(n, [&](double x, double, double) { return offset + slope * x; }).builder());
  };
  EXPECT_NE(error({3, 3, 3}, 1, 1).find("has no surface: no sign changes"), std::string::npos)
      << error({3, 3, 3}, 1, 1);
  EXPECT_NE(error({3, 3, 3}, 1, 1).find("from 1 to 2"), std::string::npos);
  EXPECT_NE(error({3, 1, 3}, -0.5, 1).find("two along each axis"), std::string::npos);
  EXPECT_NE(error({3, 3, 3}, -0.5, std::numeric_limits<double>::infinity()).find("scene.xml:8:5"),
            std::string::npos);
  EXPECT_NE(test::build_error(ball(4).builder().set("normals", std::string("smoth"))).find("smooth"),
            std::string::npos);
  EXPECT_NE(test::build_error(ball(4).builder().emitting()).find("cannot be an emitter"), std::string::npos);
  EXPECT_NE(test::build_error(ShapeBuilder("sdfgrid")), "");
  const std::vector<std::size_t> colours = {2, 2, 2, 3};
  EXPECT_NE(test::build_error(ShapeBuilder("sdfgrid").set("grid", ObjectPtr(std::make_shared<Array>(
                                                                      colours, std::vector<double>(24)))))
                .find("a distance is one number"),
            std::string::npos);
}

}  // namespace
}  // namespace aureole

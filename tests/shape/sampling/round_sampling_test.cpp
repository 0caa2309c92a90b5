// SPDX-License-Identifier: Apache-2.0
// Sampling of discs and cylinders from a point, against quadrature over their surface.
#include <array>
#include <functional>

#include "aureole/shape/geometry/double3.h"
#include "shape/shape_test_support.h"

namespace aureole {
namespace {

using test::Random;
using test::ShapeBuilder;

constexpr double kPiD = 3.14159265358979323846;

/// A surface p(a, b) over [0, 1]^2 with its normal times the area element.
struct Parametric {
  std::function<Double3(double, double)> point, area;
};

struct Case {
  const char* name;
  ShapePtr shape;
  Parametric surface;
  std::vector<Vec3> references;
  std::shared_ptr<const AreaSampler> area = test::sampler_of(shape);
};

Double3 apply(const Transform& t, double x, double y, double z) {
  const auto& m = t.matrix();
  return {m[0][0] * x + m[0][1] * y + m[0][2] * z + m[0][3],
          m[1][0] * x + m[1][1] * y + m[1][2] * z + m[1][3],
          m[2][0] * x + m[2][1] * y + m[2][2] * z + m[2][3]};
}

/// r^2 and azimuth of the unit disc.
Parametric disc(const Transform& t, double side) {
  const Double3 o = apply(t, 0, 0, 0);
  const Double3 n = cross(apply(t, 1, 0, 0) - o, apply(t, 0, 1, 0) - o) * (kPiD * side);
  return {[t](double a, double b) {
            const double r = std::sqrt(a), phi = 2 * kPiD * b;
            return apply(t, r * std::cos(phi), r * std::sin(phi), 0);
          },
          [n](double, double) { return n; }};
}
/// Azimuth and z of the unit cylinder.
Parametric tube(const Transform& t, double side) {
  const auto point = [t](double a, double b) {
    return apply(t, std::cos(2 * kPiD * a), std::sin(2 * kPiD * a), b);
  };
  return {point, [t, side](double a, double) {
            const Double3 o = apply(t, 0, 0, 0);
            const Double3 around = apply(t, -std::sin(2 * kPiD * a), std::cos(2 * kPiD * a), 0) - o;
            return cross(around, apply(t, 0, 0, 1) - o) * (2 * kPiD * side);
          }};
}

std::vector<Case> cases() {
  const std::vector<Vec3> above = {{0, 0, 5},       {0.3f, 0.2f, 1},    {0.1f, -0.2f, 0.05f}, {4, 0, 0.1f},
                                   {1.5f, 1.5f, 2}, {0.99f, 0, 0.003f}, {1.01f, 0, 0.003f},   {100, 40, 60},
                                   {0, 0, 0.001f},  {1.2f, -0.4f, 0.2f}};
  const Transform turned =
      Transform::translate(1, 2, 3) * Transform::rotate(1, 1, 0, 70) * Transform::scale(2, 2, 1);
  const Transform ellipse = Transform::rotate(1, 0, 0, 20) * Transform::scale(2, 0.5, 1);
  const auto shape = [](const char* type, const Transform& t) { return ShapeBuilder(type).to_world(t); };
  std::vector<Vec3> from_turned;
  for (const Vec3& p : above) from_turned.push_back(turned.point(p));
  const std::vector<Vec3> around = {{3, 0, 0.5f},        {1.01f, 0, 0.5f},   {0, -2, 4},   {40, 20, -7},
                                    {-1.5f, 0.2f, 0.1f}, {0.9f, 0.9f, 0.7f}, {0, 1.2f, -3}};
  const std::vector<Vec3> inside = {{0, 0, 0.5f}, {0.9f, 0, 0.2f}, {0.3f, -0.4f, 3}, {0.2f, 0.1f, -0.01f}};
  const Transform oblique = Transform::rotate(1, 2, 3, 25) * Transform::scale(1, 0.6, 3);
  std::vector<Vec3> from_oblique;
  for (const Vec3& p : around) from_oblique.push_back(oblique.point(p));
  return {{"disk", shape("disk", {}).build(), disc({}, 1), above},
          {"disk turned", shape("disk", turned).build(), disc(turned, 1), from_turned},
          {"ellipse",
           shape("disk", ellipse).build(),
           disc(ellipse, 1),
           {{0, 0, 5}, {0.3f, 0.2f, 1}, {3, 0, 0.1f}, {40, 20, 60}}},
          {"cylinder", shape("cylinder", {}).build(), tube({}, 1), around},
          {"long cylinder",
           shape("cylinder", Transform::scale(1, 1, 30)).build(),
           tube(Transform::scale(1, 1, 30), 1),
           {{3, 0, 0.5f}, {1.05f, 0, 20}, {0, -2, 45}, {0, 50, 15}}},
          {"inside", shape("cylinder", {}).set("flip_normals", true).build(), tube({}, -1), inside},
          {"inside, seen from outside",
           shape("cylinder", {}).set("flip_normals", true).build(),
           tube({}, -1),
           {{3, 0, 0.5f}, {2, 1, 4}}},
          {"elliptic cylinder", shape("cylinder", oblique).build(), tube(oblique, 1), from_oblique}};
}

using Moments = std::array<double, 5>;
Moments moments(const Double3& p, const Bounds3& box) {
  const Double3 q = (p - Double3(box.center())) * (1 / double(length(box.diagonal())));
  return {1, 1 + q.x, 1 + q.y, 1 + q.z * q.x, 1 + q.x * q.y};
}

/// Adds the integral of the moments over the solid angle of the front in a cell, halved until it looks small.
void add_cell(const Parametric& s, const Double3& o, const Bounds3& box, double a, double b, double da,
              double db, Moments& sum, int depth = 0) {
  const Double3 middle = s.point(a + da / 2, b + db / 2);
  const double along_a = length(s.point(a + da, b + db / 2) - s.point(a, b + db / 2));
  const double along_b = length(s.point(a + da / 2, b + db) - s.point(a + da / 2, b));
  // A ring's two ends are one point: cells start small in both directions.
  const double size = std::max(along_a, along_b);
  if (depth < 16 || (depth < 60 && size > 0.04 * length(middle - o))) {
    const bool halve_a = depth < 16 ? depth % 2 == 0 : along_a > along_b;
    const double x = halve_a ? da / 2 : da, y = halve_a ? db : db / 2;
    add_cell(s, o, box, a, b, x, y, sum, depth + 1);
    add_cell(s, o, box, a + (da - x), b + (db - y), x, y, sum, depth + 1);
    return;
  }
  const Double3 w = o - middle;
  const double facing = dot(s.area(a + da / 2, b + db / 2), w);
  if (!(facing > 0)) return;
  const Moments m = moments(middle, box);
  for (std::size_t k = 0; k < m.size(); ++k) sum[k] += m[k] * facing * da * db / std::pow(dot(w, w), 1.5);
}

TEST(RoundSampling, MomentsAgreeWithQuadrature) {
  for (const Case& c : cases()) {
    const Bounds3 box = c.area->patch_bounds(0);
    for (const Vec3& reference : c.references) {
      SCOPED_TRACE(std::string(c.name) + " from " + std::to_string(reference.x) + " " +
                   std::to_string(reference.y) + " " + std::to_string(reference.z));
      Random random(3);
      constexpr int kSamples = 100000;
      Moments sum{}, sum2{}, expected{};
      for (int i = 0; i < kSamples; ++i) {
        const auto s = c.area->sample_direct(reference, 0, random.square());
        if (!s || !(dot(s->ng, reference - s->p) > 0)) continue;
        const Moments m = moments(Double3(s->p), box);
        for (std::size_t k = 0; k < m.size(); ++k)
          sum[k] += m[k] / s->pdf, sum2[k] += m[k] * m[k] / s->pdf / s->pdf;
      }
      add_cell(c.surface, Double3(reference), box, 0, 0, 1, 1, expected);
      for (std::size_t k = 0; k < expected.size(); ++k) {
        const double mean = sum[k] / kSamples;
        const double error = std::sqrt(std::max(0.0, sum2[k] / kSamples - mean * mean) / kSamples);
        EXPECT_NEAR(mean, expected[k], 5 * error + 4e-3 * expected[0]) << "moment " << k;
      }
    }
  }
}

TEST(RoundSampling, DensityAgreesWithSample) {
  for (const Case& c : cases()) {
    const test::OneShapeScene scene(*c.shape);
    int met = 0;
    for (const Vec3& reference : c.references) {
      Random random(5);
      for (int i = 0; i < 2000; ++i) {
        const Vec2 u = i == 0 ? Vec2{0, 0} : i == 1 ? Vec2{0x1.fffffep-1f, 0x1.fffffep-1f} : random.square();
        const auto s = c.area->sample_direct(reference, 0, u);
        if (!s) continue;
        ASSERT_TRUE(std::isfinite(s->pdf) && s->pdf > 0);
        ASSERT_TRUE(s->uv.x >= 0 && s->uv.x <= 1 && s->uv.y >= 0 && s->uv.y <= 1);
        SurfacePoint p;
        p.p = s->p, p.ng = s->ng, p.uv = s->uv, p.shape = c.shape.get();
        // Edge-on the cosine of the two may be rounded differently.
        EXPECT_NEAR(c.area->pdf_direct(reference, 0, p), s->pdf, 1e-3f * s->pdf) << c.name;
        // A ray towards the sample meets it, or another part before it.
        const Vec3 d = normalize(s->p - reference);
        const auto hit = scene.intersect({reference, d});
        if (!hit || std::abs(dot(d, s->ng)) < 0.05f || hit->t < 0.999f * length(s->p - reference)) continue;
        ++met;
        EXPECT_LT(length(hit->point.p - s->p), 3e-5f * (1 + length(s->p - reference))) << c.name;
        EXPECT_NEAR(c.area->pdf_direct(reference, 0, hit->point), s->pdf, 2e-3f * s->pdf) << c.name;
      }
    }
    EXPECT_GT(met, 1000) << c.name;
  }
}

TEST(RoundSampling, DiscsAreSampledNearlyUniformlyInSolidAngle) {
  // Wherever the point is, the largest density is not far from the smallest; from afar, where the area is
  // sampled, by the distances of the two ends.
  const auto shape = ShapeBuilder("disk").build_sampler();
  Random random(7);
  float near = 1, far = 1;
  for (int n = 0; n < 4000; ++n) {
    const Vec3 reference{random.uniform(0, 8), 0, std::pow(10.f, random.uniform(-3, 1))};
    float least = kInfinity, most = 0;
    for (int i = 0; i < 64; ++i)
      if (const auto s = shape->sample_direct(reference, 0, random.square()))
        least = std::min(least, s->pdf), most = std::max(most, s->pdf);
    if (!(most > 0) || 1 / most < 1e-5f) continue;
    float& worst = length(reference) < 6.3f ? near : far;
    worst = std::max(worst, most / least);
  }
  EXPECT_LT(near, 1.3);
  EXPECT_LT(far, 2.7);
}

TEST(RoundSampling, AreaSamplesAreUniform) {
  for (const Case& c : cases()) {
    // The integral of one over the area, and of a moment.
    Random random(9);
    const Bounds3 box = c.area->patch_bounds(0);
    double area = 0, moment = 0, square = 0, expected = 0, expected_area = 0;
    constexpr int kSamples = 20000, kCells = 200;
    for (int i = 0; i < kSamples; ++i) {
      const auto s = c.area->sample_area(0, random.square());
      ASSERT_TRUE(s);
      const double m = moments(Double3(s->p), box)[3] / s->pdf;
      area += 1 / s->pdf, moment += m, square += m * m;
    }
    for (int i = 0; i < kCells; ++i)
      for (int j = 0; j < kCells; ++j) {
        const double a = (i + 0.5) / kCells, b = (j + 0.5) / kCells, da = length(c.surface.area(a, b));
        expected_area += da / (kCells * kCells);
        expected += moments(c.surface.point(a, b), box)[3] * da / (kCells * kCells);
      }
    EXPECT_NEAR(c.area->patch_area(0), expected_area, 1e-3 * expected_area) << c.name;
    EXPECT_NEAR(area / kSamples, expected_area, 0.02 * expected_area) << c.name;
    const double mean = moment / kSamples, sigma = std::sqrt((square / kSamples - mean * mean) / kSamples);
    EXPECT_NEAR(mean, expected, 5 * sigma + 1e-3 * expected) << c.name;
  }
}

TEST(RoundSampling, NothingFromBehind) {
  const auto disk = ShapeBuilder("disk").build_sampler();
  EXPECT_FALSE(disk->sample_direct({0, 0, -1}, 0, {0.5f, 0.5f}));
  EXPECT_FALSE(disk->sample_direct({3, 0, 0}, 0, {0.5f, 0.5f}));
  EXPECT_FALSE(disk->sample_direct({0.2f, 0, 0}, 0, {0.5f, 0.5f}));
  const auto tube = ShapeBuilder("cylinder").build_sampler();
  EXPECT_FALSE(tube->sample_direct({0.2f, 0, 0.5f}, 0, {0.5f, 0.5f}));
  EXPECT_EQ(tube->pdf_direct({0.2f, 0, 0.5f}, 0, SurfacePoint{}), 0);
}

}  // namespace
}  // namespace aureole

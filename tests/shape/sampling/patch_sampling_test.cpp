// SPDX-License-Identifier: Apache-2.0
// Sampling of patches by solid angle against quadrature over their surface and closed forms.
#include <array>
#include <functional>

#include "aureole/shape/geometry/double3.h"
#include "aureole/shape/mesh/mesh.h"
#include "aureole/shape/sampling/spherical_sampling.h"
#include "shape/shape_test_support.h"

namespace aureole {
namespace {

using test::Random;
using test::ShapeBuilder;

constexpr double kPiD = 3.14159265358979323846;

TEST(SolidAngle, OctantAndCorners) {
  // The octant x + y + z = 1 seen from the origin is an eighth of the sphere.
  EXPECT_NEAR(triangle_solid_angle({0, 0, 0}, {Vec3{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}), kPiD / 2, 1e-12);
  // In the plane and outside: nothing.
  EXPECT_EQ(triangle_solid_angle({5, 5, 0}, {Vec3{1, 0, 0}, {0, 1, 0}, {0, 0, 0}}), 0);
  // Far away: projected area over squared distance.
  EXPECT_NEAR(triangle_solid_angle({0, 0, 1e6f}, {Vec3{1, 0, 0}, {0, 1, 0}, {0, 0, 0}}) * 1e12 / 0.5, 1,
              1e-9);
  // Very near: half the sphere.
  EXPECT_NEAR(triangle_solid_angle({0.3f, 0.3f, 1e-9f}, {Vec3{1, 0, 0}, {0, 1, 0}, {0, 0, 0}}), 2 * kPiD,
              1e-7);
}

/// Solid angle of a rectangle a x b seen from height h above a corner: asin-form of the closed expression.
double corner_rectangle(double a, double b, double h) {
  return std::atan(a * b / (h * std::sqrt(a * a + b * b + h * h)));
}

TEST(SolidAngle, RectangleClosedForm) {
  const auto shape = ShapeBuilder("rectangle").build_sampler();
  ASSERT_EQ(shape->patch_count(), 1u);
  for (const double h : {0.01, 0.1, 1.0, 10.0, 30.0}) {
    const auto s = shape->sample_direct({0, 0, float(h)}, 0, {0.3f, 0.6f});
    ASSERT_TRUE(s);
    // From afar it is sampled by area, whose density varies little.
    const double tolerance = h < 3 ? 2e-6 : 1 / (h * h);
    EXPECT_NEAR(1 / s->pdf / (4 * corner_rectangle(1, 1, double(float(h)))), 1, tolerance) << h;
  }
}

TEST(SolidAngle, SphereClosedForm) {
  const auto shape = ShapeBuilder("sphere").build_sampler();
  for (const double d : {1.1, 2.0, 50.0, 1e4}) {
    const double cone = 2 * kPiD * (1 - std::sqrt(1 - 1 / (d * d)));
    const auto s = shape->sample_direct({0, 0, float(d)}, 0, {0.3f, 0.6f});
    ASSERT_TRUE(s);
    EXPECT_NEAR(1 / s->pdf / cone, 1, d > 100 ? 1e-4 : 2e-6) << d;
  }
}

struct Case {
  const char* name;
  std::function<ShapePtr()> make;
  std::vector<Vec3> references;
  AreaUse use = AreaUse::emitter;

  std::shared_ptr<const AreaSampler> make_sampler() const { return test::sampler_of(make(), use); }
};

ShapePtr skewed_parallelogram() {
  Transform::Matrix m = Transform().matrix();
  m[0][1] = 0.7;  // shear: the two triangles form a parallelogram that is no rectangle
  return ShapeBuilder("rectangle").to_world(Transform::rotate(1, 2, 3, 40) * Transform(m)).build();
}

ShapePtr turned_rectangle() {
  return ShapeBuilder("rectangle")
      .to_world(Transform::translate(1, 2, 3) * Transform::rotate(1, 1, 0, 70) * Transform::scale(3, 0.5, 1))
      .build();
}

std::vector<Case> cases() {
  const std::vector<Vec3> references = {
      {0, 0, 5},   {0.3f, 0.2f, 1}, {0.1f, -0.2f, 0.05f},  {4, 0, 0.1f}, {1.5f, 1.5f, 2},
      {-3, 2, -4}, {100, 40, 60},   {0.99f, 0.99f, 0.01f}, {2, 3, 4},    {1.01f, 0, 0.003f}};
  return {
      {"rectangle", [] { return ShapeBuilder("rectangle").build(); }, references},
      {"turned rectangle", turned_rectangle, references},
      {"parallelogram", skewed_parallelogram, references},
      // For a sensor every triangle is a patch.
      {"triangle", [] { return ShapeBuilder("rectangle").build(); }, references, AreaUse::sensor},
      {"sphere",
       [] { return ShapeBuilder("sphere").build(); },
       {{0, 0, 5}, {1.05f, 0, 0}, {3, 4, 5}, {200, 10, 0}, {0.2f, 0.3f, 0}, {0.9f, 0, 0}, {0, 0, 0}}},
  };
}

/// The values of several test functions of the point p.
using Moments = std::array<double, 5>;
Moments moments(const Double3& p, const Bounds3& box) {
  const Double3 q = (p - Double3(box.center())) * (1 / double(length(box.diagonal())));
  return {1, 1 + q.x, 1 + q.y, 1 + q.z * q.x, 1 + q.x * q.y};
}

/// Adds the integral of the moments over the solid angle of a triangle, by subdivision until it looks small.
void add_triangle(const Double3& o, const Double3& a, const Double3& b, const Double3& c, const Bounds3& box,
                  Moments& sum, int depth = 0) {
  const double size = std::max({length(b - a), length(c - b), length(a - c)});
  const Double3 middle = (a + b + c) * (1 / 3.0);
  if (depth < 18 && size > 0.1 * length(middle - o)) {
    const Double3 ab = (a + b) * 0.5, bc = (b + c) * 0.5, ca = (c + a) * 0.5;
    add_triangle(o, a, ab, ca, box, sum, depth + 1), add_triangle(o, ab, b, bc, box, sum, depth + 1);
    add_triangle(o, ca, bc, c, box, sum, depth + 1), add_triangle(o, ab, bc, ca, box, sum, depth + 1);
    return;
  }
  const Double3 n = cross(b - a, c - a) * 0.5;  // length: area
  for (const Double3& p : {(a + b) * 0.5, (b + c) * 0.5, (c + a) * 0.5}) {
    const Double3 w = p - o;
    const double weight = std::abs(dot(n, w)) / std::pow(dot(w, w), 1.5) / 3;
    const Moments m = moments(p, box);
    for (std::size_t k = 0; k < m.size(); ++k) sum[k] += weight * m[k];
  }
}

/// Integral of the moments over the directions in which a unit sphere at the origin is seen, by double
/// quadrature.
Moments sphere_quadrature(const Double3& o, const Bounds3& box) {
  const double d = length(o), cos_max = d > 1 ? std::sqrt(1 - 1 / (d * d)) : -1;
  const Frame frame = Frame::from_normal(d > 0 ? normalize(-o).to_float() : Vec3{0, 0, 1});
  constexpr int kN = 1000;
  Moments sum{};
  for (int i = 0; i < kN; ++i)
    for (int j = 0; j < 64; ++j) {
      const double z = 1 - (1 - cos_max) * (i + 0.5) / kN, phi = 2 * kPiD * j / 64, r = std::sqrt(1 - z * z);
      const Double3 w = Double3(frame.s) * (r * std::cos(phi)) + Double3(frame.t) * (r * std::sin(phi)) +
                        Double3(frame.n) * z;
      const double b = dot(o, w), discriminant = std::max(0.0, b * b - dot(o, o) + 1);
      const Moments m =
          moments(o + w * (d > 1 ? -b - std::sqrt(discriminant) : -b + std::sqrt(discriminant)), box);
      for (std::size_t k = 0; k < m.size(); ++k) sum[k] += m[k] * 2 * kPiD * (1 - cos_max) / (kN * 64.0);
    }
  return sum;
}

Moments quadrature(const Shape& shape, const AreaSampler& area, const Vec3& reference) {
  const Bounds3 box = area.patch_bounds(0);
  const auto* mesh = dynamic_cast<const Mesh*>(&shape);
  if (!mesh) return sphere_quadrature(Double3(reference), box);
  Moments sum{};
  for (std::uint32_t i = 0; i < shape.primitive_count(); ++i)
    if (area.patch_of_primitive(i) == 0) {
      const TriangleIndices& t = mesh->data().triangles[i];
      const auto& p = mesh->data().positions;
      add_triangle(Double3(reference), Double3(p[t[0]]), Double3(p[t[1]]), Double3(p[t[2]]), box, sum);
    }
  return sum;
}

TEST(DirectSampling, MomentsAgreeWithQuadrature) {
  for (const Case& c : cases()) {
    const ShapePtr shape = c.make();
    const auto area = test::sampler_of(shape, c.use);
    const Bounds3 box = area->patch_bounds(0);
    for (const Vec3& reference : c.references) {
      Random random(3);
      constexpr int kSamples = 100000;
      Moments sum{}, sum2{};
      for (int i = 0; i < kSamples; ++i) {
        const auto s = area->sample_direct(reference, 0, random.square());
        if (!s) continue;
        const Moments m = moments(Double3(s->p), box);
        for (std::size_t k = 0; k < m.size(); ++k)
          sum[k] += m[k] / s->pdf, sum2[k] += m[k] * m[k] / s->pdf / s->pdf;
      }
      const Moments expected = quadrature(*shape, *area, reference);
      for (std::size_t k = 0; k < expected.size(); ++k) {
        const double mean = sum[k] / kSamples;
        const double error = std::sqrt(std::max(0.0, sum2[k] / kSamples - mean * mean) / kSamples);
        EXPECT_NEAR(mean, expected[k], 5 * error + 1e-4 * expected[0])
            << c.name << " from " << reference.x << ' ' << reference.y << ' ' << reference.z << " moment "
            << k;
      }
    }
  }
}

TEST(DirectSampling, DensityAgreesWithSample) {
  for (const Case& c : cases()) {
    const ShapePtr shape = c.make();
    const auto area = test::sampler_of(shape, c.use);
    const test::OneShapeScene scene(*shape);
    for (const Vec3& reference : c.references) {
      Random random(5);
      for (int i = 0; i < 2000; ++i) {
        const auto s = area->sample_direct(reference, 0, random.square());
        if (!s) continue;
        ASSERT_TRUE(std::isfinite(s->pdf) && s->pdf > 0);
        SurfacePoint p;
        p.p = s->p, p.ng = s->ng, p.uv = s->uv, p.shape = shape.get();
        EXPECT_EQ(area->pdf_direct(reference, 0, p), s->pdf) << c.name;
        // A ray towards the sample meets it, with the same texture coordinates.
        const Vec3 d = normalize(s->p - reference);
        const auto hit = scene.intersect({reference, d});
        if (!hit || std::abs(dot(d, s->ng)) < 0.05f || std::string(c.name) == "sphere") continue;
        EXPECT_NEAR(length(hit->point.p - s->p), 0, 2e-5f * (1 + length(s->p - reference))) << c.name;
        EXPECT_NEAR(hit->point.uv.x, s->uv.x, 3e-4f);
        EXPECT_NEAR(hit->point.uv.y, s->uv.y, 3e-4f);
        EXPECT_GT(dot(hit->point.ng, s->ng), 0.9999f);
      }
    }
  }
}

TEST(DirectSampling, UniformInSolidAngle) {
  // Chi-square over equal-probability cells: the share of samples whose direction lies in a cone bin equals
  // the bin's solid angle. For the rectangle seen from above its centre the four quadrants and 2 x 2 x 4
  // sub-rectangles have known shares.
  const auto shape = ShapeBuilder("rectangle").build_sampler();
  const double h = 0.4;
  constexpr int kCells = 8, kSamples = 400000;
  std::vector<double> expected(kCells * kCells), count(kCells * kCells);
  const auto edge = [](int i) { return -1 + 2.0 * i / kCells; };
  const auto signed_corner = [&](double x, double y) {
    return std::copysign(1.0, x) * std::copysign(1.0, y) * corner_rectangle(std::abs(x), std::abs(y), h);
  };
  const double total = 4 * corner_rectangle(1, 1, h);
  for (int j = 0; j < kCells; ++j)
    for (int i = 0; i < kCells; ++i)
      expected[j * kCells + i] =
          (signed_corner(edge(i + 1), edge(j + 1)) - signed_corner(edge(i), edge(j + 1)) -
           signed_corner(edge(i + 1), edge(j)) + signed_corner(edge(i), edge(j))) /
          total * kSamples;
  Random random(11);
  for (int n = 0; n < kSamples; ++n) {
    const auto s = shape->sample_direct({0, 0, float(h)}, 0, random.square());
    ASSERT_TRUE(s);
    const int i = std::min(kCells - 1, int((s->p.x + 1) / 2 * kCells)),
              j = std::min(kCells - 1, int((s->p.y + 1) / 2 * kCells));
    count[j * kCells + i] += 1;
  }
  double chi2 = 0;
  for (std::size_t i = 0; i < count.size(); ++i)
    chi2 += (count[i] - expected[i]) * (count[i] - expected[i]) / expected[i];
  EXPECT_LT(chi2, 63 + 5 * std::sqrt(2 * 63.0));
}

/// Where in the shape's first patch a point lies: one of `kAreaBins` cells of equal area, with what the
/// surface is like there.
constexpr int kAreaBins = 64;
struct AreaPoint {
  int bin;
  Double3 p, normal;
  Vec2 uv;
};
AreaPoint locate(const Shape& shape, const AreaSampler& area, const Double3& p) {
  const auto* mesh = dynamic_cast<const Mesh*>(&shape);
  if (!mesh) {  // the unit sphere
    const double turn = std::atan2(p.y, p.x) / (2 * kPiD) + (p.y < 0 ? 1 : 0),
                 height = 0.5 + 0.5 * p.z / length(p);
    return {std::min(7, int(turn * 8)) * 8 + std::min(7, int(height * 8)), normalize(p), normalize(p), {}};
  }
  // The triangle whose barycentrics are the least negative; 32 or 64 cells of each by halving it again and
  // again.
  AreaPoint best{};
  double least = -1e9;
  std::vector<std::uint32_t> triangles;
  for (std::uint32_t i = 0; i < shape.primitive_count(); ++i)
    if (area.patch_of_primitive(i) == 0) triangles.push_back(i);
  for (std::size_t k = 0; k < triangles.size(); ++k) {
    const TriangleIndices& t = mesh->data().triangles[triangles[k]];
    Double3 c[3];
    for (int i = 0; i < 3; ++i) c[i] = Double3(mesh->data().positions[t[i]]);
    const Double3 n = cross(c[1] - c[0], c[2] - c[0]);
    const double b1 = dot(cross(p - c[0], c[2] - c[0]), n) / dot(n, n),
                 b2 = dot(cross(c[1] - c[0], p - c[0]), n) / dot(n, n), b0 = 1 - b1 - b2;
    if (std::min({b0, b1, b2}) <= least) continue;
    least = std::min({b0, b1, b2});
    const auto& uv = mesh->data().uvs;
    const TriangleIndices& at =
        mesh->data().uv_triangles.empty() ? t : mesh->data().uv_triangles[triangles[k]];
    best.uv = uv.empty() ? Vec2{float(b1), float(b2)}
                         : uv[at[0]] * float(b0) + uv[at[1]] * float(b1) + uv[at[2]] * float(b2);
    best.p = c[0] * b0 + c[1] * b1 + c[2] * b2;
    best.normal = normalize(n);
    // Corners a, b, c become (a + b)/2, c, a or (a + b)/2, b, c: in barycentrics of the half, both exact.
    double a = b0, b = b1, d = b2;
    int bin = 0;
    const int halvings = triangles.size() == 2 ? 5 : 6;
    for (int h = 0; h < halvings; ++h) {
      const bool first = a > b;
      const double at_middle = 2 * std::min(a, b), at_corner = std::abs(a - b);
      bin = 2 * bin + first;
      a = d, b = at_corner, d = at_middle;
    }
    best.bin = bin + (halvings == 5 ? 32 * int(k) : 0);
  }
  return best;
}

TEST(DirectSampling, ThePositionAloneIsTheSame) {
  for (const Case& c : cases()) {
    const auto area = c.make_sampler();
    Random random(23);
    int found = 0;
    for (int i = 0; i < 4000; ++i) {
      const Vec2 a = random.square(), b = random.square(), u = random.square();
      const Vec3 reference{6 * a.x - 3, 6 * a.y - 3, 4 * b.x - 1};
      const auto all = area->sample_direct(reference, 0, u);
      const PositionSample position = area->sample_direct_position(reference, 0, u);
      ASSERT_EQ(all.has_value(), position.pdf > 0) << c.name;
      if (!all) continue;
      ++found;
      ASSERT_EQ(all->p, position.p) << c.name;
      ASSERT_EQ(all->p_error, position.p_error) << c.name;
      ASSERT_EQ(all->ng, position.ng) << c.name;
      ASSERT_EQ(all->pdf, position.pdf) << c.name;
    }
    EXPECT_GT(found, 1000) << c.name;
  }
}

TEST(AreaSampling, UniformOverThePatch) {
  for (const Case& c : cases()) {
    const ShapePtr shape = c.make();
    const auto area = test::sampler_of(shape, c.use);
    Random random(17);
    constexpr int kSamples = 200000;
    std::vector<int> count(kAreaBins);
    for (int i = 0; i < kSamples; ++i) {
      const Vec2 ends[] = {
          {0, 0}, {0, 0x1.fffffep-1f}, {0x1.fffffep-1f, 0}, {0x1.fffffep-1f, 0x1.fffffep-1f}};
      const auto s = area->sample_area(0, i < 4 ? ends[i] : random.square());
      ASSERT_TRUE(s);
      EXPECT_NEAR(s->pdf * area->patch_area(0), 1, 1e-6);
      const AreaPoint at = locate(*shape, *area, Double3(s->p));
      ++count[std::size_t(at.bin)];
      // On the surface to within the stated error, and with the surface's normal and texture coordinates.
      const Double3 off = Double3(s->p) - at.p;
      ASSERT_LE(std::abs(dot(off, at.normal)), dot(Double3(abs(s->ng)), Double3(s->p_error)) + 1e-12)
          << c.name;
      ASSERT_LT(length(off), 1e-5) << c.name;
      ASSERT_GT(dot(Double3(s->ng), at.normal), 0.99999) << c.name;
      if (std::string(c.name) == "sphere") continue;
      ASSERT_NEAR(s->uv.x, at.uv.x, 1e-5) << c.name;
      ASSERT_NEAR(s->uv.y, at.uv.y, 1e-5) << c.name;
    }
    double chi2 = 0;
    for (const int n : count) {
      const double expected = double(kSamples) / kAreaBins;
      chi2 += (n - expected) * (n - expected) / expected;
    }
    // One in a thousand and one for 63 degrees of freedom.
    EXPECT_LT(chi2, 103.4) << c.name;
    EXPECT_GT(chi2, 33.9) << c.name;
  }
}

TEST(DirectSampling, NothingFromThePlane) {
  const auto shape = ShapeBuilder("rectangle").build_sampler();
  EXPECT_FALSE(shape->sample_direct({5, 0, 0}, 0, {0.5f, 0.5f}));
  EXPECT_FALSE(shape->sample_direct({0.2f, 0.3f, 0}, 0, {0.5f, 0.5f}));
  SurfacePoint p;
  p.p = {0, 0, 0}, p.ng = {0, 0, 1};
  EXPECT_EQ(shape->pdf_direct({5, 0, 0}, 0, p), 0);
}

}  // namespace
}  // namespace aureole

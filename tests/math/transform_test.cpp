// SPDX-License-Identifier: Apache-2.0
// Transforms by their effect on points, directions and normals.
#include "aureole/math/transform.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace aureole {
namespace {

void expect_near(const Vec3& a, const Vec3& b, double tolerance = 1e-5) {
  for (int i = 0; i < 3; ++i)
    EXPECT_NEAR(a[i], b[i], tolerance) << "(" << a.x << ", " << a.y << ", " << a.z << ") is not (" << b.x
                                       << ", " << b.y << ", " << b.z << ")";
}

class Transforms : public ::testing::Test {
protected:
  float uniform() { return std::uniform_real_distribution<float>(-1, 1)(random_); }
  Vec3 vec() {
    const float x = uniform(), y = uniform();
    return {x, y, uniform()};
  }
  Transform affine() {
    Transform::Matrix m{};
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 4; ++j) m[std::size_t(i)][std::size_t(j)] = double(uniform()) + (i == j ? 1.5 : 0);
    m[3][3] = 1;
    return Transform(m);
  }
  std::mt19937 random_{4};
};

TEST_F(Transforms, Elements) {
  expect_near(Transform().point({1, 2, 3}), {1, 2, 3}, 0);
  expect_near(Transform::translate(1, -2, 3).point({4, 5, 6}), {5, 3, 9}, 0);
  expect_near(Transform::translate(1, -2, 3).vector({4, 5, 6}), {4, 5, 6}, 0);
  expect_near(Transform::scale(2, 3, -4).point({1, 1, 1}), {2, 3, -4}, 0);
  expect_near(Transform::rotate(0, 0, 5, 90).point({1, 0, 2}), {0, 1, 2}, 1e-7);
  expect_near(Transform::rotate(1, 0, 0, 90).point({0, 1, 0}), {0, 0, 1}, 1e-7);
  expect_near(Transform::rotate(0, 3, 0, 90).point({0, 0, 1}), {1, 0, 0}, 1e-7);
  // A third of a turn about the diagonal permutes the axes.
  expect_near(Transform::rotate(2, 2, 2, 120).point({1, 2, 3}), {3, 1, 2}, 1e-6);
  EXPECT_EQ(Transform(), Transform::translate(0, 0, 0));
  EXPECT_FALSE(Transform() == Transform::translate(0, 0, 1e-9));
}

TEST_F(Transforms, RotationsKeepLengthsAndTurnRight) {
  for (int k = 0; k < 100; ++k) {
    const Vec3 axis = vec();
    const float degrees = 180 * uniform();
    const Transform r = Transform::rotate(axis.x, axis.y, axis.z, degrees);
    expect_near(r.vector(axis), axis, 1e-6);
    const Vec3 v = normalize(cross(axis, vec()));
    const Vec3 turned = r.vector(v);
    EXPECT_NEAR(dot(turned, v), std::cos(degrees * M_PI / 180), 1e-5);
    EXPECT_NEAR(dot(cross(v, turned), normalize(axis)), std::sin(degrees * M_PI / 180), 1e-5);
    EXPECT_NEAR(r.determinant3(), 1, 1e-12);
  }
}

TEST_F(Transforms, ProductAppliesTheRightOneFirst) {
  for (int k = 0; k < 50; ++k) {
    const Transform a = affine(), b = affine();
    const Vec3 p = vec();
    expect_near((a * b).point(p), a.point(b.point(p)), 1e-5);
    expect_near((a * b).vector(p), a.vector(b.vector(p)), 1e-5);
    EXPECT_NEAR((a * b).determinant3(), a.determinant3() * b.determinant3(), 1e-9);
  }
}

TEST_F(Transforms, InverseUndoes) {
  for (int k = 0; k < 200; ++k) {
    const Transform t = affine();
    if (t.is_singular() || std::abs(t.determinant3()) < 0.05) continue;
    const Transform::Matrix e = (t * t.inverse()).matrix();
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = 0; j < 4; ++j) EXPECT_NEAR(e[i][j], i == j, 1e-12);
    const Vec3 p = vec();
    expect_near(t.inverse().point(t.point(p)), p, 1e-4);
  }
  // Needs pivoting.
  const Transform swap({{{0, 1, 0, 2}, {0, 0, 1, 3}, {1, 0, 0, 4}, {0, 0, 0, 1}}});
  expect_near(swap.inverse().point(swap.point({5, 6, 7})), {5, 6, 7}, 0);
}

TEST_F(Transforms, NormalsStayPerpendicularOnTheirSide) {
  for (int k = 0; k < 200; ++k) {
    const Transform t = affine() * Transform::scale(1, k % 2 ? -1 : 1, 1);
    const Vec3 a = vec(), b = vec();
    const Vec3 n = cross(a, b), side = vec();
    const Vec3 turned = t.normal(n);
    const float scale = length(turned) + 1e-6f;
    EXPECT_NEAR(dot(turned, t.vector(a)) / scale, 0, 2e-5);
    EXPECT_NEAR(dot(turned, t.vector(b)) / scale, 0, 2e-5);
    if (std::abs(dot(n, side)) > 0.05f && std::abs(t.determinant3()) > 0.05) {
      EXPECT_EQ(dot(turned, t.vector(side)) > 0, dot(n, side) > 0) << "mirrored: " << (t.determinant3() < 0);
    }
  }
}

TEST_F(Transforms, LookAt) {
  for (int k = 0; k < 100; ++k) {
    const Vec3 o = vec(), target = vec(), up = vec();
    const Transform t =
        Transform::look_at({o.x, o.y, o.z}, {target.x, target.y, target.z}, {up.x, up.y, up.z});
    ASSERT_FALSE(t.is_singular());
    expect_near(t.point({0, 0, 0}), o, 1e-6);
    expect_near(t.vector({0, 0, 1}), normalize(target - o), 1e-5);
    EXPECT_NEAR(dot(t.vector({1, 0, 0}), up), 0, 1e-5) << "the image's horizon is level";
    EXPECT_GT(dot(t.vector({0, 1, 0}), up), 0);
    EXPECT_NEAR(t.determinant3(), 1, 1e-9);
    for (int i = 0; i < 3; ++i) {
      Vec3 axis;
      axis[i] = 1;
      EXPECT_NEAR(length(t.vector(axis)), 1, 1e-6);
    }
  }
  // +x is to the left of the viewing direction.
  expect_near(Transform::look_at({0, 0, 0}, {0, 0, -1}, {0, 1, 0}).vector({1, 0, 0}), {-1, 0, 0}, 1e-7);
}

TEST_F(Transforms, Singular) {
  EXPECT_TRUE(Transform::scale(1, 0, 1).is_singular());
  EXPECT_TRUE(Transform::look_at({1, 2, 3}, {1, 2, 3}, {0, 1, 0}).is_singular());
  EXPECT_TRUE(Transform::look_at({0, 0, 0}, {0, 5, 0}, {0, 1, 0}).is_singular());
  EXPECT_TRUE(Transform::scale(NAN, 1, 1).is_singular());
  EXPECT_TRUE(Transform::scale(1, 5e-324, 1).is_singular());
  EXPECT_TRUE(Transform::scale(1e-200, 1e-200, 1).is_singular());
  EXPECT_FALSE(Transform::scale(1e-60, 1e-60, 1e-60).is_singular());
  EXPECT_TRUE(Transform::translate(INFINITY, 0, 0).is_singular());
  EXPECT_TRUE(Transform({{{1, 2, 3, 0}, {2, 4, 6, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}}).is_singular());
  EXPECT_TRUE(Transform({{{1, 2, 3, 0}, {0, 0, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}}).is_singular());
  // Small and uneven is not singular: nanometres in metres, a thin plate.
  EXPECT_FALSE(Transform::scale(1e-9, 1e-9, 1e-9).is_singular());
  EXPECT_FALSE(Transform::scale(1e6, 1e-6, 1).is_singular());
  EXPECT_FALSE(Transform::translate(1e8, 0, 0).is_singular());
}

TEST_F(Transforms, TextureCoordinates) {
  const Vec2 p = (Transform::translate(10, 20, 30) * Transform::scale(2, 3, 4)).point2({1, 1});
  EXPECT_EQ(p.x, 12);
  EXPECT_EQ(p.y, 23);
  const Vec2 q = Transform::rotate(0, 0, 1, 90).point2({1, 0});
  EXPECT_NEAR(q.x, 0, 1e-7);
  EXPECT_NEAR(q.y, 1, 1e-7);
}

TEST_F(Transforms, FramesAreOrthonormalAndRightHanded) {
  for (int k = 0; k < 1000; ++k) {
    Vec3 n = normalize(vec());
    if (k < 2) n = {0, 0, k ? -1.f : 1.f};
    for (const Frame& f : {Frame::from_normal(n), Frame::from_normal_tangent(n, vec()),
                           Frame::from_normal_tangent(n, n), Frame::from_normal_tangent(n, {})}) {
      expect_near(f.n, n, 0);
      expect_near(cross(f.s, f.t), f.n, 2e-6);
      EXPECT_NEAR(length(f.s), 1, 1e-6);
      EXPECT_NEAR(dot(f.s, f.n), 0, 1e-5);
      const Vec3 v = vec();
      expect_near(f.to_world(f.to_local(v)), v, 1e-5);
      expect_near(f.to_local(f.n), {0, 0, 1}, 1e-5);
    }
    const Vec3 tangent = vec();
    const Frame f = Frame::from_normal_tangent(n, tangent);
    EXPECT_NEAR(dot(f.t, tangent), 0, 2e-5) << "s lies in the plane of n and the tangent";
    EXPECT_GE(dot(f.s, tangent), 0);
  }
}

TEST_F(Transforms, OrthogonalPart) {
  for (int n = 0; n < 100; ++n) {
    // A turn after a stretch along any axes: the turn is the orthogonal factor (Higham 1986).
    const Vec3 a = vec(), b = vec();
    const double mirror = n % 2 ? -1 : 1;
    const Transform turn = Transform::rotate(double(a.x), double(a.y), double(a.z), 170 * double(uniform())) *
                           Transform::scale(mirror, mirror, mirror);
    const Transform axes = Transform::rotate(double(b.x), double(b.y), double(b.z), 170 * double(uniform()));
    const Transform stretch =
        axes * Transform::scale(std::exp(6 * double(uniform())), std::exp(double(uniform())), 0.01) *
        axes.inverse();
    const Transform q = (Transform::translate(1, 2, 3) * turn * stretch).orthogonal_part();
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(q.matrix()[i][k], turn.matrix()[i][k], 1e-9) << n;
  }
}

}  // namespace
}  // namespace aureole

// SPDX-License-Identifier: Apache-2.0
#include "aureole/math/motion.h"

#include <gtest/gtest.h>

#include <cmath>

#include "aureole/core/error.h"

namespace aureole {
namespace {

void expect_near(const Vec3& a, const Vec3& b, float tolerance = 1e-6f) {
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(a[i], b[i], tolerance);
}

TEST(Motion, TranslatesEvenlyAndStaysAtItsEnds) {
  const Motion m({{1, Transform::translate(1, 0, 0)}, {3, Transform::translate(5, 2, 0)}});
  EXPECT_TRUE(m.is_moving());
  expect_near(m.at(1.5).point({0, 0, 1}), {2, 0.5f, 1});
  expect_near(m.at(-7).point({0, 0, 1}), {1, 0, 1});
  expect_near(m.at(9).point({0, 0, 1}), {5, 2, 1});
}

TEST(Motion, RotatesEvenlyAboutAnyAxis) {
  // A third of the way between 20 and 140 degrees, about all axes, so that every branch of the quaternion is taken.
  const double axes[][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 2, -0.5}, {-3, 0.1, 2}};
  for (const auto& a : axes)
    for (const double start : {20.0, 170.0, 250.0}) {
      const auto turned = [&](double angle) { return Transform::rotate(a[0], a[1], a[2], angle); };
      const Motion m({{0, turned(start)}, {3, turned(start + 120)}});
      for (const Vec3 p : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0.3f, -2, 1}})
        expect_near(m.at(1).point(p), turned(start + 40).point(p), 3e-6f);
    }
}

TEST(Motion, KeepsStretchAndReflection) {
  const Transform stretch = Transform::scale(2, 0.5, -1);
  const Motion m({{0, stretch}, {1, Transform::rotate(0, 0, 1, 90) * Transform::scale(4, 0.5, -1)}});
  expect_near(m.at(0).point({1, 1, 1}), {2, 0.5f, -1});
  expect_near(m.at(1).point({1, 1, 1}), {-0.5f, 4, -1});
  expect_near(m.at(0.5).point({1, 1, 1}),
              (Transform::rotate(0, 0, 1, 45) * Transform::scale(3, 0.5, -1)).point({1, 1, 1}));
}

TEST(Motion, EqualKeyFramesAreRest) {
  EXPECT_FALSE(Motion({{0, Transform::scale(2, 2, 2)}, {1, Transform::scale(2, 2, 2)}}).is_moving());
}

TEST(Motion, WrongKeyFrames) {
  EXPECT_THROW(Motion(std::vector<KeyFrame>{}), Error);
  EXPECT_THROW(Motion({{1, Transform()}, {1, Transform::translate(1, 0, 0)}}), Error);
  EXPECT_THROW(Motion({{0, Transform()}, {NAN, Transform::translate(1, 0, 0)}}), Error);
  EXPECT_THROW(Motion({{0, Transform()}, {1, Transform::scale(-1, 1, 1)}}), Error);
  EXPECT_THROW(Motion({{0, Transform()}, {1, Transform::scale(0, 1, 1)}}), Error);
}

}  // namespace
}  // namespace aureole

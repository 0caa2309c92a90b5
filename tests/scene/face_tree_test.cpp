// SPDX-License-Identifier: Apache-2.0
#include "aureole/scene/edge/face_tree.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>

#include "scene/triangles.h"

namespace aureole {
namespace {

struct Faces : test::Triangles {
  void add_quad(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) { add(a, b, c), add(a, c, d); }
  void add_box(const Vec3& low, const Vec3& high) {
    const auto at = [&](int x, int y, int z) {
      return Vec3{x ? high.x : low.x, y ? high.y : low.y, z ? high.z : low.z};
    };
    for (const int s : {0, 1}) {
      add_quad(at(s, 0, 0), at(s, 1, 0), at(s, 1, 1), at(s, 0, 1));
      add_quad(at(0, s, 0), at(1, s, 0), at(1, s, 1), at(0, s, 1));
      add_quad(at(0, 0, s), at(1, 0, s), at(1, 1, s), at(0, 1, s));
    }
  }
  void add_floor(float half, float z) {
    add_quad({-half, -half, z}, {half, -half, z}, {half, half, z}, {-half, half, z});
  }
  std::size_t crossing() const {
    const TriangleSet set{positions, triangles};
    return count_crossing_faces(FaceTree({&set, 1}));
  }
};

TEST(CrossingFaces, OfABoxInTheFloorAreCounted) {
  for (const float far : {0.f, 1e4f}) {
    Faces faces;
    const auto floor = [&](float z) {
      faces.add_quad({far - 9, -9, z}, {far + 9, -9, z}, {far + 9, 9, z}, {far - 9, 9, z});
    };
    faces.add_box({far - 1, -1, 0}, {far + 1, 1, 2});
    EXPECT_EQ(faces.crossing(), 0u) << "a closed box";
    floor(0);
    EXPECT_EQ(faces.crossing(), 0u) << "it stands on the floor";
    floor(1);
    // The triangles of its four sides, and both of the floor that cuts them.
    EXPECT_EQ(faces.crossing(), 10u);
    floor(2);
    EXPECT_EQ(faces.crossing(), 10u) << "its lid lies in the plane of another floor";
  }
}

TEST(CrossingFaces, TouchingOnesAreNone) {
  Faces sheets;
  sheets.add_floor(3, 0);
  sheets.add_floor(1, 0);                                           // in the same plane
  sheets.add_quad({-2, -2, 0}, {2, 2, 0}, {2, 2, 1}, {-2, -2, 1});  // a wall on it
  sheets.add({-3, -3, 0}, {-5, 0, 2}, {0, -5, 2});                  // with a common corner
  EXPECT_EQ(sheets.crossing(), 0u);

  Faces ball;
  constexpr int kRings = 24, kSides = 40;
  const auto at = [](int i, int j) {
    const double theta = M_PI * i / kRings, phi = 2 * M_PI * (j % kSides) / kSides;
    return Vec3{float(std::sin(theta) * std::cos(phi)), float(std::sin(theta) * std::sin(phi)),
                float(std::cos(theta))};
  };
  for (int i = 0; i < kRings; ++i)
    for (int j = 0; j < kSides; ++j) ball.add_quad(at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
  EXPECT_EQ(ball.crossing(), 0u);
  // A needle through it cuts a face on each side, and its own two.
  ball.add_quad({-2, 0.011f, 0.013f}, {-2, 0.012f, 0.013f}, {2, 0.012f, 0.013f}, {2, 0.011f, 0.013f});
  EXPECT_EQ(ball.crossing(), 4u);
}

// Their borders meet, too.
TEST(CrossingFaces, OfEqualSheetsAcrossEachOtherAreCounted) {
  Faces sheets;
  sheets.add_quad({-1, 0, 0}, {1, 0, 0}, {1, 0, 1}, {-1, 0, 1});
  sheets.add_quad({0, -1, 0}, {0, 1, 0}, {0, 1, 1}, {0, -1, 1});
  EXPECT_EQ(sheets.crossing(), 4u);
}

// Four times the faces shall take about four times as long, not sixteen times.
TEST(CrossingFaces, OfAFanTakesNoLongTime) {
  const auto seconds = [](int count) {
    Faces fan;
    for (int i = 0; i < count; ++i) {
      const auto at = [&](int j) {
        const double phi = 2 * M_PI * j / count;
        return Vec3{float(std::cos(phi)), float(std::sin(phi)), 0};
      };
      fan.add({0, 0, 0}, at(i), at(i + 1));
    }
    const TriangleSet set{fan.positions, fan.triangles};
    const FaceTree faces({&set, 1});
    double least = INFINITY;
    for (int i = 0; i < 3; ++i) {
      const auto begin = std::chrono::steady_clock::now();
      EXPECT_EQ(count_crossing_faces(faces), 0u);
      least =
          std::min(least, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
    }
    return least;
  };
  EXPECT_LT(seconds(80000), 10 * seconds(20000));
}

}  // namespace
}  // namespace aureole

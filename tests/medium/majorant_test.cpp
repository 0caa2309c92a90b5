// SPDX-License-Identifier: Apache-2.0
// The bounds that a medium gives along rays: never below the extinction, and all of the box is covered.
#include <gtest/gtest.h>

#include <cmath>

#include "aureole/math/significance.h"
#include "aureole/medium/medium.h"
#include "volume/volume_test_support.h"

namespace aureole::test {
namespace {

/// Where a ray is inside of [0, 1]^3, in double precision by the definition, and how far single precision may
/// be from there: an error of the position that grows with the distance from the origin, over the speed.
struct Inside {
  double begin, end, error;
};
Inside inside_box(const Transform& to_box, const Ray& ray) {
  const Transform::Matrix& m = to_box.matrix();
  const double o[3] = {ray.o.x, ray.o.y, ray.o.z}, d[3] = {ray.d.x, ray.d.y, ray.d.z};
  Inside in{0, 1e30, 0};
  for (std::size_t i = 0; i < 3; ++i) {
    double at = m[i][3], slope = 0, size = 1 + std::abs(at);
    for (std::size_t j = 0; j < 3; ++j) {
      at += m[i][j] * o[j], slope += m[i][j] * d[j];
      size += std::abs(m[i][j] * o[j]);
    }
    const double t0 = -at / slope, t1 = (1 - at) / slope;
    in.begin = std::max(in.begin, std::min(t0, t1)), in.end = std::min(in.end, std::max(t0, t1));
    in.error = std::max(in.error, 5e-7 * size / std::abs(slope));
  }
  return in;
}

class MajorantBounds : public ::testing::TestWithParam<int> {};

TEST_P(MajorantBounds, AreAboveTheExtinctionAndCoverTheBox) {
  const int round = GetParam();
  VolumeFolder folder;
  SeededRandom random(std::uint64_t(100 + round));
  const auto below = [&](int n) { return int(random.next() * float(n)); };
  const auto between = [&](float a, float b) { return a + (b - a) * random.next(); };
  const std::array<int, 3> n{1 + below(70), 1 + below(40), 1 + below(40)};
  const int channels = round % 2 ? 3 : 1;
  std::vector<float> values(std::size_t(n[0] * n[1] * n[2] * channels));
  for (float& v : values) v = std::max(random.next() - .7f, 0.f);
  if (round % 3 != 0) {
    // Empty but for a box, so that there are blocks of empty cells to cross.
    std::array<std::array<int, 2>, 3> box;
    for (std::size_t i = 0; i < 3; ++i) box[i] = {below(n[i]), 1 + below(6)};
    for (std::size_t k = 0; k < values.size(); ++k) {
      const int voxel = int(k) / channels;
      const std::array<int, 3> at{voxel % n[0], voxel / n[0] % n[1], voxel / n[0] / n[1]};
      for (std::size_t i = 0; i < 3; ++i)
        if (at[i] < box[i][0] || at[i] >= box[i][0] + box[i][1]) values[k] = 0;
    }
  }
  const auto file = write_bytes(folder.path() / "m.vol", make_vol(n, channels, values).bytes());
  const auto number = [&](const char* name, float v) {
    return std::string(" ") + name + "=\"" + std::to_string(v) + "\"";
  };
  const std::string transform =
      "<transform name=\"to_world\"><scale" + number("x", between(.2f, 3)) + number("y", between(.2f, 3)) +
      number("z", -between(.2f, 3)) + "/><rotate" + number("x", between(-1, 1)) +
      number("y", between(-1, 1)) + " z=\"1\"" + number("angle", between(0, 180)) + "/><translate" +
      number("x", between(-20, 20)) + number("z", between(-20, 20)) + "/></transform>";
  std::string grid = grid_xml(
      file, choice("filter_type", round % 4 < 2 ? "trilinear" : "nearest") +
                choice("wrap_mode", std::array{"clamp", "repeat", "mirror"}[std::size_t(round / 4 % 3)]) +
                transform);
  grid.insert(grid.find(' '), " name=\"sigma_t\"");
  const auto medium = testing::build<Medium>("<medium type=\"heterogeneous\">" + grid +
                                             R"(<float name="scale" value="7"/></medium>)");
  ASSERT_TRUE(medium->majorants());
  const Transform to_box = *testing::build<Volume>(grid)->to_box(), from_box = to_box.inverse();
  const Wavelengths w =
      Wavelengths::at(SpectralGrid::over(360, 830), make_spectrum([](int i) { return 370 + 57 * float(i); }));
  MediumCoefficients at;
  int hits = 0;
  for (int r = 0; r < 300; ++r) {
    const Vec3 a = from_box.point({between(-.5f, 1.5f), between(-.5f, 1.5f), between(-.5f, 1.5f)});
    const Vec3 b = from_box.point({between(0, 1), between(0, 1), between(0, 1)});
    const Ray ray{a, normalize(b - a)};
    const auto [begin, end, slack] = inside_box(to_box, ray);
    const Spectrum majorant = medium->majorant(ray.d, w);
    std::vector<MajorantSegment> segments;
    medium->majorants().visit_segments(ray, std::numeric_limits<float>::infinity(),
                                       [&](const MajorantSegment& segment) {
                                         segments.push_back(segment);
                                         return false;
                                       });
    double covered_to = begin;
    bool first = true;
    const auto check_gap = [&](double from, double to) {
      // Nothing is left out but where there is nothing.
      for (int i = 0; i < 8 && to - from > 2 * slack; ++i) {
        const double t = from + slack + (to - from - 2 * slack) * double(random.next());
        medium->eval(ray.o + ray.d * float(t), ray.d, w, at);
        for (int j = 0; j < kWavelengths; ++j) ASSERT_EQ(at.sigma_t[j], 0) << "at " << t;
      }
    };
    for (const MajorantSegment& piece : segments) {
      ++hits;
      ASSERT_LT(piece.begin, piece.end);
      ASSERT_GE(piece.begin, first ? begin - slack : covered_to);
      first = false;
      ASSERT_LE(piece.end, end + slack);
      check_gap(covered_to, piece.begin);
      covered_to = piece.end;
      for (int i = 0; i < 12; ++i) {
        const float t = i == 0 ? piece.begin : i == 1 ? piece.end : between(piece.begin, piece.end);
        medium->eval(ray.o + ray.d * t, ray.d, w, at);
        for (int j = 0; j < kWavelengths; ++j)
          ASSERT_LE(at.sigma_t[j], piece.bound * majorant[j]) << "ray " << r << " at " << t;
      }
    }
    check_gap(covered_to, end);
  }
  if (round % 3 == 0) {
    EXPECT_GT(hits, 100);
  }
}

INSTANTIATE_TEST_SUITE_P(Grids, MajorantBounds, ::testing::Range(0, 24));

}  // namespace
}  // namespace aureole::test

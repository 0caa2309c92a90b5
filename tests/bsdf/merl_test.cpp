// SPDX-License-Identifier: Apache-2.0
// The BSDF `merl` against bins found by rotations (tests/bsdf/data/measured/make_tables.py), and damaged files.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <functional>
#include <optional>

#include "aureole/bsdf/measured/merl_table.h"
#include "aureole/core/error.h"
#include "aureole/math/warp.h"
#include "bsdf/bsdf_test_support.h"
#include "harness/bsdf_harness.h"
#include "harness/effort.h"
#include "harness/paths.h"

namespace aureole::testing {
namespace {

std::filesystem::path merl_data(const std::string& name) {
  return test::source_dir() / "tests/bsdf/data/measured" / name;
}

TEST(Merl, BinsAreThoseOfTheAngles) {
  const MerlTable table(merl_data("small_merl.binary"));
  EXPECT_GT(table.missing(), 0u);
  std::ifstream in(merl_data("merl_reference.txt"));
  Vec3 wi, wo;
  double rgb[3];
  int lines = 0;
  while (in >> wi.x >> wi.y >> wi.z >> wo.x >> wo.y >> wo.z >> rgb[0] >> rgb[1] >> rgb[2]) {
    const std::array<float, 3> found = table.rgb(wi, wo, false), exchanged = table.rgb(wo, wi, false);
    for (std::size_t c = 0; c < 3; ++c) {
      EXPECT_NEAR(found[c], rgb[c], 1e-5 * rgb[c] + 1e-7) << lines;
      EXPECT_NEAR(exchanged[c], rgb[c], 1e-5 * rgb[c] + 1e-7) << lines;
    }
    ++lines;
  }
  EXPECT_EQ(lines, 100);
}

// The table was made from a smooth function; interpolation comes nearer to it than bins do.
TEST(Merl, InterpolationIsSmooth) {
  const MerlTable table(merl_data("small_merl.binary"));
  double steps = 0, smooth = 0;
  std::array<float, 3> before{}, before_linear{};
  for (int i = 0; i < 2000; ++i) {
    const Vec3 wi = direction(0.4, 0), wo = direction(0.2 + 0.0004 * i, 2.5);
    const std::array<float, 3> bins = table.rgb(wi, wo, false), linear = table.rgb(wi, wo, true);
    if (i > 0) {
      steps = std::max(steps, std::abs(double(bins[0] - before[0])));
      smooth = std::max(smooth, std::abs(double(linear[0] - before_linear[0])));
    }
    before = bins, before_linear = linear;
  }
  EXPECT_LT(smooth, 0.1 * steps);
}

std::string merl_error(const std::function<void(std::string&)>& damage) {
  std::ifstream in(merl_data("small_merl.binary"), std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(in), {}};
  damage(bytes);
  const std::string path = ::testing::TempDir() + "damaged.binary";
  std::ofstream(path, std::ios::binary) << bytes;
  try {
    const MerlTable table(path);
  } catch (const Error& e) {
    EXPECT_EQ(e.where().file.str(), path);
    return e.message();
  }
  return "no error";
}

TEST(Merl, DamagedFilesAreLocatedErrors) {
  EXPECT_NE(merl_error([](std::string& b) { b.resize(b.size() - 1); }).find("truncated"), std::string::npos);
  EXPECT_NE(merl_error([](std::string& b) { b.resize(5); }).find("too short"), std::string::npos);
  EXPECT_NE(merl_error([](std::string& b) { b += 'x'; }).find("need 196620"), std::string::npos);
  EXPECT_NE(merl_error([](std::string& b) { std::memset(b.data(), 0xff, 4); }).find("sizes -1 x 16 x 32"),
            std::string::npos);
  EXPECT_NE(merl_error([](std::string& b) { std::memset(b.data(), 0x7f, 12); }).find("90 x 90 x 180"),
            std::string::npos);
  EXPECT_NE(merl_error([](std::string& b) { b[8] = 48; }).find("bins of phi_d"), std::string::npos);
  EXPECT_NE(merl_error([](std::string& b) { std::memset(&b[1000], 0xff, 8); }).find("not finite"),
            std::string::npos);
}

// A full circle of phi_d with the halves of a reciprocal table repeated is the reciprocal table.
TEST(Merl, FullCirclesAreRead) {
  std::ifstream in(merl_data("small_merl.binary"), std::ios::binary);
  const std::string half{std::istreambuf_iterator<char>(in), {}};
  std::string full = half.substr(0, 12);
  full[8] = 64;
  for (std::size_t row = 0; row < 3 * 16 * 16; ++row)
    for (int twice = 0; twice < 2; ++twice) full += half.substr(12 + row * 32 * 8, 32 * 8);
  const std::string path = ::testing::TempDir() + "full.binary";
  std::ofstream(path, std::ios::binary) << full;
  const MerlTable a(merl_data("small_merl.binary")), b(path);
  EXPECT_FALSE(a.is_full_circle());
  EXPECT_TRUE(b.is_full_circle());
  for (int i = 0; i < 50; ++i) {
    const Vec3 wi = direction(0.03 * i, 0.4), wo = direction(1.5 - 0.02 * i, 0.9 * i);
    EXPECT_NEAR(a.rgb(wi, wo, true)[1], b.rgb(wi, wo, true)[1], 1e-6);
  }
}

/// Relative variance of f cos / pdf of a sampler, for light at all directions alike; samples that fail count as 0.
double relative_variance(const Bsdf& surface, const std::function<std::optional<Vec3>(float, Vec2)>& sample,
                         const std::function<double(const Vec3&)>& pdf, const Vec3& wi) {
  const Setting s;
  double sum = 0, squares = 0;
  constexpr int kSamples = 40000;
  for (int k = 0; k < kSamples; ++k) {
    const Vec2 u{float(std::fmod(0.7548776662466927 * k, 1.0)),
                 float(std::fmod(0.5698402909980532 * k, 1.0))};
    const auto wo = sample(float(std::fmod(0.3819660112501051 * k, 1.0)), u);
    if (!wo || !(wo->z > 0)) continue;
    const double estimate = double(surface.eval(wi, *wo, s.context())[3]) / pdf(*wo);
    sum += estimate, squares += estimate * estimate;
  }
  return squares * kSamples / (sum * sum) - 1;
}

/// The least relative variance of mixtures of GGX's visible normals and a cosine, over roughnesses and weights.
double best_fit_variance(const Bsdf& surface, const Vec3& wi) {
  const Setting s;
  double least = HUGE_VAL;
  for (const double alpha : {0.05, 0.1, 0.18, 0.25, 0.35, 0.5, 0.8}) {
    const auto ggx =
        bsdf_of("roughconductor", R"(<string name="distribution" value="ggx"/>)" + number("alpha", alpha));
    for (const double weight : {0.2, 0.4, 0.6, 0.8, 0.95})
      least = std::min(least, relative_variance(
                                  surface,
                                  [&](float u1, Vec2 u2) -> std::optional<Vec3> {
                                    if (double(u1) > weight) return square_to_cosine_hemisphere(u2);
                                    const auto found = ggx->sample(wi, u1, u2, s.context());
                                    return found ? std::optional(found->wo) : std::nullopt;
                                  },
                                  [&](const Vec3& wo) {
                                    return weight * double(ggx->pdf(wi, wo, s.context())[0]) +
                                           (1 - weight) * double(cosine_hemisphere_pdf(wo.z));
                                  },
                                  wi));
  }
  return least;
}

// The table of a rough metal, which GGX fits, and one whose half vectors lie on a ring 25 degrees from the normal, which no
// such model describes.
TEST(Merl, SamplingIsAsGoodAsTheBestFit) {
  std::ifstream in(merl_data("small_merl.binary"), std::ios::binary);
  std::string ring{std::istreambuf_iterator<char>(in), {}};
  for (std::size_t k = 0; k < 3 * 16 * 16 * 32; ++k) {
    const double theta_h = 90 * std::pow((double(k / (16 * 32) % 16) + 0.5) / 16, 2);
    const double value = 1500 * (0.02 + std::exp(-std::pow((theta_h - 25) / 5, 2)));
    std::memcpy(&ring[12 + 8 * k], &value, 8);
  }
  const std::string path = ::testing::TempDir() + "ring.binary";
  std::ofstream(path, std::ios::binary) << ring;
  for (const std::string& file : {merl_data("small_merl.binary").string(), path}) {
    const auto surface = bsdf_of("merl", "<string name=\"filename\" value=\"" + file + "\"/>");
    const Setting s;
    for (const double theta : {0.1, 0.6, 1.1}) {
      const Vec3 wi = direction(theta, 0.5);
      const double own = relative_variance(
          *surface,
          [&](float u1, Vec2 u2) {
            const auto found = surface->sample(wi, u1, u2, s.context());
            return found ? std::optional(found->wo) : std::nullopt;
          },
          [&](const Vec3& wo) { return double(surface->pdf(wi, wo, s.context())[0]); }, wi);
      const double best = best_fit_variance(*surface, wi);
      EXPECT_LT(own, 1.3 * best) << file << " at " << theta;
      if (test::is_thorough())
        std::printf("%s at %.1f rad: variance %.4f, best fit %.4f\n", file.c_str(), theta, own, best);
    }
  }
}

// Tables of other kinds: a file of RGL's format and a table of directions.
TEST(MeasuredTables, SamplingIsAsGoodAsTheBestFit) {
  for (const auto& [type, file] :
       {std::pair("measured", "golden_paint.bsdf"), {"tabulated", "glossy_table.csv"}}) {
    const auto surface =
        bsdf_of(type, "<string name=\"filename\" value=\"" + merl_data(file).string() + "\"/>");
    const Setting s;
    for (const double theta : {0.1, 0.6, 1.1}) {
      const Vec3 wi = direction(theta, 0.5);
      const double own = relative_variance(
          *surface,
          [&](float u1, Vec2 u2) {
            const auto found = surface->sample(wi, u1, u2, s.context());
            return found ? std::optional(found->wo) : std::nullopt;
          },
          [&](const Vec3& wo) { return double(surface->pdf(wi, wo, s.context())[0]); }, wi);
      const double best = best_fit_variance(*surface, wi);
      EXPECT_LT(own, 1.3 * best) << file << " at " << theta;
      if (test::is_thorough())
        std::printf("%s at %.1f rad: variance %.4f, best fit %.4f\n", file, theta, own, best);
    }
  }
}

const BsdfCases kMerl("merl", [](BsdfCase& c) { c.black_below = true, c.may_fail = true; }, {});

}  // namespace
}  // namespace aureole::testing

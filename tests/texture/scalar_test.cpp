// SPDX-License-Identifier: Apache-2.0
// The other outputs of textures: numbers, gradients and raw RGB.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>

#include "aureole/core/image.h"
#include "aureole/math/significance.h"
#include "aureole/spectrum/upsampling_fit.h"
#include "aureole/texture/texture.h"
#include "harness/properties_builder.h"

namespace aureole {
namespace {

using testing::build;
using testing::make_context;

SurfacePoint at(Vec2 uv) {
  SurfacePoint point;
  point.uv = uv;
  return point;
}

template <class F>
std::string message_of(F&& f) {
  try {
    f();
  } catch (const Error& e) {
    return e.what();
  }
  return "";
}

/// A picture of `width` x `height` random values in [low, high).
Image noise(int width, int height, int channels, float low = 0, float high = 1) {
  SeededRandom random(std::uint64_t(100 * width + 10 * height + channels));
  Image image;
  image.width = width, image.height = height;
  image.channels = channels == 1 ? std::vector<std::string>{"Y"} : std::vector<std::string>{"R", "G", "B"};
  for (int i = 0; i < width * height * channels; ++i)
    image.pixels.push_back(low + (high - low) * random.next());
  return image;
}

std::shared_ptr<const Texture> bitmap(const Image& image, const std::string& more = "") {
  std::string name = ::testing::UnitTest::GetInstance()->current_test_info()->name();
  std::replace(name.begin(), name.end(), '/', '_');
  const auto file = std::filesystem::path(::testing::TempDir()) / ("aureole_scalar_" + name + ".exr");
  write_exr(file, image, ExrPixel::float32, {});
  return build<Texture>(R"(<texture type="bitmap"><string name="filename" value="x"/>)" + more + "</texture>",
                        make_context(), [&](const std::string&) { return file; });
}
const std::string kRaw = R"(<boolean name="raw" value="true"/>)";

std::string modes(const char* wrap, const char* filter) {
  return std::string(R"(<string name="wrap_mode" value=")") + wrap +
         R"("/><string name="filter_type" value=")" + filter + R"("/>)";
}

/// The gradient by differences of eval_scalar, in double; nothing where the interpolation has an edge within
/// the step.
std::optional<Vec2> differences(const Texture& t, Vec2 uv) {
  const float h = 1e-3f;
  const auto f = [&](float u, float v) { return double(t.eval_scalar(at({u, v}))); };
  const double centre = f(uv.x, uv.y);
  const double left = (centre - f(uv.x - h, uv.y)) / h, right = (f(uv.x + h, uv.y) - centre) / h;
  const double below = (centre - f(uv.x, uv.y - h)) / h, above = (f(uv.x, uv.y + h) - centre) / h;
  if (std::abs(left - right) > 0.02 * (1 + std::abs(left)) ||
      std::abs(below - above) > 0.02 * (1 + std::abs(below)))
    return {};
  return Vec2{float((left + right) / 2), float((below + above) / 2)};
}

struct Mode {
  const char *wrap, *to_uv;
  int channels;
  bool raw;
};

/// For the names of tests: a struct is printed as its bytes otherwise, pointers and all.
void PrintTo(const Mode& m, std::ostream* out) {
  *out << m.wrap << (*m.to_uv ? ", to_uv, " : ", ") << m.channels << (m.raw ? " raw channels" : " channels");
}

class Gradient : public ::testing::TestWithParam<Mode> {};

TEST_P(Gradient, IsThatOfTheInterpolation) {
  const Mode m = GetParam();
  const auto t = bitmap(noise(5, 3, m.channels), modes(m.wrap, "bilinear") + (m.raw ? kRaw : "") + m.to_uv);
  ASSERT_TRUE(t->has_gradient());
  SeededRandom random(3);
  int tested = 0;
  double largest = 0;
  for (int k = 0; k < 400; ++k) {
    const float u = random.next(), v = random.next();
    const Vec2 uv{5 * u - 2, 5 * v - 2};
    const auto expected = differences(*t, uv);
    if (!expected) continue;
    ++tested;
    const Vec2 g = t->gradient(at(uv));
    EXPECT_NEAR(g.x, expected->x, 0.01 + 0.01 * std::abs(expected->x)) << uv.x << ", " << uv.y;
    EXPECT_NEAR(g.y, expected->y, 0.01 + 0.01 * std::abs(expected->y)) << uv.x << ", " << uv.y;
    largest = std::max({largest, double(std::abs(g.x)), double(std::abs(g.y))});
  }
  EXPECT_GT(tested, 200);
  EXPECT_GT(largest, 1);
}

constexpr const char* kTurned = R"(<transform name="to_uv"><rotate z="1" angle="33"/><scale x="0.7" y="1.3"/>
    <translate x="0.3" y="-0.2"/></transform>)";
INSTANTIATE_TEST_SUITE_P(Modes, Gradient,
                         ::testing::Values(Mode{"repeat", "", 1, true}, Mode{"mirror", "", 1, true},
                                           Mode{"clamp", "", 1, true}, Mode{"repeat", kTurned, 1, false},
                                           Mode{"mirror", kTurned, 1, true}, Mode{"clamp", kTurned, 3, true},
                                           Mode{"repeat", kTurned, 3, true},
                                           Mode{"mirror", kTurned, 3, false}));

TEST(Gradient, IsZeroWithoutInterpolation) {
  const auto t = bitmap(noise(4, 4, 1), modes("repeat", "nearest"));
  EXPECT_TRUE(t->has_gradient());
  const Vec2 g = t->gradient(at({0.3f, 0.4f}));
  EXPECT_EQ(g.x, 0);
  EXPECT_EQ(g.y, 0);
}

TEST(Gradient, OfOtherTextures) {
  const auto constant =
      build<Texture>(R"(<spectrum type="uniform"><float name="value" value="0.3"/></spectrum>)");
  EXPECT_TRUE(constant->has_gradient());
  EXPECT_EQ(constant->gradient(at({0.3f, 0.4f})).x, 0);
  const auto squares = build<Texture>(R"(<texture type="checkerboard"/>)");
  EXPECT_TRUE(squares->has_gradient());
  EXPECT_EQ(squares->gradient(at({0.3f, 0.4f})).y, 0);
  const auto d65 = build<Texture>(R"(<texture type="d65"><texture type="checkerboard"/></texture>)");
  EXPECT_FALSE(d65->has_gradient());
  EXPECT_THROW(d65->gradient(at({})), std::logic_error);
}

TEST(Scalar, ConstantsAreTheirMean) {
  EXPECT_FLOAT_EQ(build<Texture>(R"(<spectrum type="uniform"><float name="value" value="0.3"/></spectrum>)")
                      ->eval_scalar(at({})),
                  0.3f);
  // Linear from 0 at 360 nm to 0.94 at 830 nm.
  EXPECT_NEAR(build<Texture>(R"(<spectrum type="irregular"><string name="wavelengths" value="360, 830"/>
                               <string name="values" value="0, 0.94"/></spectrum>)")
                  ->eval_scalar(at({})),
              0.47, 1e-3);
}

TEST(Scalar, CheckerboardIsThatOfItsSquares) {
  const auto t = build<Texture>(R"(<texture type="checkerboard"><float name="color0" value="0.9"/>
      <float name="color1" value="0.1"/></texture>)");
  EXPECT_FLOAT_EQ(t->eval_scalar(at({0.25f, 0.25f})), 0.9f);
  EXPECT_FLOAT_EQ(t->eval_scalar(at({0.75f, 0.25f})), 0.1f);
}

TEST(Scalar, WhatKnowsNothingBetterIsItsMeanSpectrum) {
  const auto d65 = build<Texture>(R"(<texture type="d65"><texture type="checkerboard"/></texture>)");
  const double mean = build<Texture>(R"(<spectrum type="d65"/>)")->average().average();
  EXPECT_NEAR(d65->eval_scalar(at({0.25f, 0.25f})), 0.4 * mean, 0.05);
}

TEST(Scalar, PicturesOfColoursAreTheirLuminance) {
  // Greys are exact, also where they are stored as colours; of colours only the spectrum is kept.
  Image grey;
  grey.width = 2, grey.height = 1;
  grey.channels = {"R", "G", "B"};
  grey.pixels = {0, 0, 0, 1, 1, 1};
  const auto black_and_white = bitmap(grey, modes("clamp", "bilinear"));
  EXPECT_EQ(black_and_white->eval_scalar(at({0, 0})), 0.f);
  EXPECT_EQ(black_and_white->eval_scalar(at({1, 0})), 1.f);
  EXPECT_EQ(black_and_white->eval_scalar(at({0.5f, 0})), 0.5f);
  EXPECT_EQ(black_and_white->minimum(), 0.f);
  EXPECT_EQ(black_and_white->maximum(), 1.f);

  double largest = 0;
  for (const double r : {0., .3, 1.})
    for (const double g : {0., .3, 1.})
      for (const double b : {0., .3, 1.}) {
        Image image = grey;
        image.pixels = {float(r), float(g), float(b), 1, 0, 0};
        const double luminance = 0.212671 * r + 0.715160 * g + 0.072169 * b;
        EXPECT_NEAR(bitmap(image, modes("clamp", "nearest") + kRaw)->eval_scalar(at({0, 0})), luminance,
                    1e-6);
        const double error = bitmap(image, modes("clamp", "nearest"))->eval_scalar(at({0, 0})) - luminance;
        largest = std::max(largest, std::abs(error));
      }
  EXPECT_LT(largest, 6e-3);
}

TEST(Rgb, OnlyRawColoursHaveIt) {
  const Image image = noise(4, 3, 3);
  EXPECT_FALSE(bitmap(image)->has_rgb());
  EXPECT_FALSE(bitmap(noise(4, 3, 1), kRaw)->has_rgb());
  EXPECT_THROW(build<Texture>(R"(<texture type="checkerboard"/>)")->eval_rgb(at({})), std::logic_error);
  const auto t = bitmap(image, kRaw + modes("repeat", "bilinear"));
  ASSERT_TRUE(t->has_rgb());
  for (int x = 0; x < 4; ++x)
    for (int y = 0; y < 3; ++y) {
      const Vec3 centre = t->eval_rgb(at({(float(x) + 0.5f) / 4, (float(y) + 0.5f) / 3}));
      const Vec3 between = t->eval_rgb(at({(float(x) + 1) / 4, (float(y) + 0.5f) / 3}));
      for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(centre[c], image.at(x, y, std::size_t(c)), 1e-5);
        EXPECT_NEAR(between[c],
                    0.5 * (image.at(x, y, std::size_t(c)) + image.at((x + 1) % 4, y, std::size_t(c))), 1e-5);
      }
    }
}

TEST(Raw, MayBeNegative) {
  const auto t = bitmap(noise(4, 3, 1, -2, -1), kRaw);
  EXPECT_LT(t->maximum(), -1);
  EXPECT_GE(t->minimum(), -2);
  EXPECT_LT(t->eval_scalar(at({0.4f, 0.6f})), -1);
  EXPECT_NE(message_of([] { bitmap(noise(4, 3, 1, -2, -1)); }).find("not negative"), std::string::npos);
  EXPECT_NE(message_of([] { bitmap(noise(4, 3, 1, NAN, NAN), kRaw); }).find("finite"), std::string::npos);
}

TEST(Pictures, OfOneTexel) {
  for (const char* wrap : {"repeat", "mirror", "clamp"})
    for (const char* filter : {"nearest", "bilinear"}) {
      const auto t = bitmap(noise(1, 1, 1, 0.25f, 0.25f), modes(wrap, filter));
      for (const float u : {-0.7f, 0.f, 0.2f, 1.f, 3.3f}) EXPECT_EQ(t->eval_scalar(at({u, 0.4f})), 0.25f);
      EXPECT_EQ(t->gradient(at({0.3f, 0.4f})).x, 0);
    }
}

}  // namespace
}  // namespace aureole

// SPDX-License-Identifier: Apache-2.0
// PFM and Radiance HDR: pictures survive writing and reading; damaged files are errors.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <fstream>

#include "aureole/core/error.h"
#include "aureole/core/image.h"
#include "aureole/math/significance.h"
#include "tests/loading/load_text.h"

namespace aureole::test {
namespace {

Image picture(int width, int height, bool color, double (*value)(double)) {
  Image image{width, height, {"Y"}, {}, false};
  if (color) image.channels = {"R", "G", "B"};
  SeededRandom random(std::uint64_t(width * 1000 + height));
  for (std::size_t i = 0; i < std::size_t(width * height) * image.channels.size(); ++i)
    image.pixels.push_back(float(value(random.next())));
  return image;
}
std::string content(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST(Pfm, KeepsEveryBit) {
  const TemporaryFolder folder;
  for (const bool color : {false, true}) {
    const Image image = picture(7, 5, color, [](double u) { return std::tan(3 * (u - 0.5)) * 1e3; });
    write_pfm(folder.path / "a.pfm", image);
    const Image read = read_image(folder.path / "a.pfm");
    EXPECT_EQ(read.channels, image.channels);
    EXPECT_EQ(read.width, 7);
    EXPECT_EQ(read.pixels, image.pixels);
    EXPECT_FALSE(read.srgb_encoded);
  }
  // The bottom row comes first; both byte orders and a scale are read.
  const auto file = folder.write("big.pfm", std::string("Pf\n1 2\n2.0\n\x3f\x80\0\0\x40\0\0\0", 19));
  const Image big = read_image(file);
  ASSERT_EQ(big.pixels.size(), 2u);
  EXPECT_EQ(big.at(0, 0, 0), 4.f);
  EXPECT_EQ(big.at(0, 1, 0), 2.f);
}

TEST(Pfm, DamagedFilesAreErrors) {
  const TemporaryFolder folder;
  write_pfm(folder.path / "good.pfm", picture(4, 4, true, [](double u) { return u; }));
  const std::string good = content(folder.path / "good.pfm");
  for (std::size_t n = 0; n < good.size(); ++n) {
    const auto cut = folder.write("cut.pfm", good.substr(0, n));
    EXPECT_THROW(read_image(cut), Error) << n;
  }
  for (const char* header :
       {"PF\n4 x\n-1\n", "PF\n-4 4\n-1\n", "PF\n4 4\n0\n", "PF\n4 4\nnan\n", "PF\n0 4\n-1\n",
        "PF\n99999999999 4\n-1\n", "PF\n99999999999999999999 4\n-1\n", "PF\n1000000 1000000\n-1\n"}) {
    const auto file = folder.write("bad.pfm", header + std::string(192, 'x'));
    EXPECT_THROW(read_image(file), Error) << header;
  }
}

TEST(Hdr, IsWithinTheRoundingOfItsMantissas) {
  const TemporaryFolder folder;
  const auto wide = [](double u) { return std::exp(40 * u - 20); };
  const auto smooth = [](double u) { return u < 0.7 ? 1.0 : 0.25 * std::floor(8 * u); };
  // Narrow lines are stored without runs, others with and without.
  for (const int width : {3, 8, 200, 700})
    for (const bool color : {false, true})
      for (const auto value :
           {static_cast<double (*)(double)>(wide), static_cast<double (*)(double)>(smooth)}) {
        const Image image = picture(width, 6, color, value);
        write_hdr(folder.path / "a.hdr", image);
        const Image read = read_image(folder.path / "a.hdr");
        ASSERT_EQ(read.channels.size(), 3u);
        ASSERT_EQ(read.width, width);
        ASSERT_EQ(read.height, 6);
        for (int y = 0; y < 6; ++y)
          for (int x = 0; x < width; ++x) {
            float largest = 0;
            for (std::size_t c = 0; c < image.channels.size(); ++c)
              largest = std::max(largest, image.at(x, y, c));
            for (std::size_t c = 0; c < 3; ++c)
              ASSERT_NEAR(read.at(x, y, c), image.at(x, y, color ? c : 0), largest / 255);
          }
      }
}

TEST(Hdr, HoldsExtremesAndIsUnbiased) {
  const TemporaryFolder folder;
  Image image{9, 1, {"Y"}, {0, -1, 1e-30f, 0.998f, 0.9999f, 1, 1e30f, 3e38f, 1e-45f}, false};
  write_hdr(folder.path / "a.hdr", image);
  const Image read = read_image(folder.path / "a.hdr");
  EXPECT_EQ(read.at(0, 0, 0), 0);
  EXPECT_EQ(read.at(1, 0, 0), 0);
  for (const int x : {2, 3, 4, 5, 6}) EXPECT_NEAR(read.at(x, 0, 1) / image.at(x, 0, 0), 1, 1. / 256);
  EXPECT_EQ(read.at(5, 0, 2), 1);
  EXPECT_GT(read.at(7, 0, 0), 1e38f);
  EXPECT_EQ(read.at(8, 0, 0), 0);

  const Image noise = picture(600, 50, true, [](double u) { return 0.5 + 0.5 * u; });
  write_hdr(folder.path / "n.hdr", noise);
  const Image back = read_image(folder.path / "n.hdr");
  double sum = 0;
  for (std::size_t i = 0; i < noise.pixels.size(); ++i) sum += double(back.pixels[i]) - noise.pixels[i];
  EXPECT_NEAR(sum / double(noise.pixels.size()), 0, 3e-5);
}

/// A picture of 2 x 3 pixels without runs, whose red mantissas are 1 to 6 in the order of the file.
std::string hdr_text(const std::string& header, const std::string& resolution) {
  std::string text = "#?RADIANCE\n" + header + "\n" + resolution + "\n";
  for (int i = 0; i < 6; ++i) text += {char(128 + 4 * i), char(64), char(32), char(129)};
  return text;
}

TEST(Hdr, AllEightOrders) {
  const TemporaryFolder folder;
  // Pixels of the file by rows of the picture, from the top left.
  const std::pair<const char*, std::array<int, 6>> orders[] = {
      {"-Y 3 +X 2", {0, 1, 2, 3, 4, 5}}, {"-Y 3 -X 2", {1, 0, 3, 2, 5, 4}}, {"+Y 3 +X 2", {4, 5, 2, 3, 0, 1}},
      {"+Y 3 -X 2", {5, 4, 3, 2, 1, 0}}, {"+X 2 -Y 3", {0, 3, 1, 4, 2, 5}}, {"-X 2 -Y 3", {3, 0, 4, 1, 5, 2}},
      {"+X 2 +Y 3", {2, 5, 1, 4, 0, 3}}, {"-X 2 +Y 3", {5, 2, 4, 1, 3, 0}}};
  for (const auto& [resolution, order] : orders) {
    const Image image = read_image(folder.write("a.hdr", hdr_text("FORMAT=32-bit_rle_rgbe\n", resolution)));
    ASSERT_EQ(image.width, 2) << resolution;
    ASSERT_EQ(image.height, 3) << resolution;
    for (int i = 0; i < 6; ++i)
      EXPECT_EQ(image.pixels[std::size_t(3 * i)], float(128 + 4 * order[std::size_t(i)]) / 128) << resolution;
    EXPECT_TRUE(image.notes.empty());
  }
}

TEST(Hdr, ExposureAndColourCorrectionAreDividedOut) {
  const TemporaryFolder folder;
  const Image image = read_image(folder.write(
      "a.hdr", hdr_text("pfilt -e 2\nEXPOSURE=2\nEXPOSURE= 4.0e+00\nCOLORCORR= 1 .5 2\n", "-Y 3 +X 2")));
  EXPECT_FLOAT_EQ(image.pixels[0], 1 / 8.f);
  EXPECT_FLOAT_EQ(image.pixels[1], 0.5f / 4);
  EXPECT_FLOAT_EQ(image.pixels[2], 0.25f / 16);
  ASSERT_EQ(image.notes.size(), 1u);
  EXPECT_NE(image.notes[0].find("8 4 16"), std::string::npos);
}

TEST(Hdr, PrimariesAndXyz) {
  const TemporaryFolder folder;
  // White of other primaries stays white; sRGB's are no conversion.
  const auto one = [&](const std::string& header, std::string pixel) {
    return read_image(folder.write("a.hdr", "#?RADIANCE\n" + header + "\n-Y 1 +X 1\n" + pixel));
  };
  const std::string white = {char(128), char(128), char(128), char(129)};
  const std::string radiance = "PRIMARIES= .64 .33 .29 .6 .15 .06 .3333 .3333\n";
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(one(radiance, white).pixels[std::size_t(k)], 1, 1e-3);
  EXPECT_FALSE(one("PRIMARIES=0.64 0.33 0.3 0.6 0.15 0.06 0.3127 0.329\n", white).conversion);
  // Green of Radiance is a little more saturated: its red in sRGB is negative.
  const Image green = one(radiance, {0, char(128), 0, char(129)});
  EXPECT_LT(green.pixels[0], -0.005f);
  EXPECT_NEAR(green.pixels[1], 1, 0.02f);
  // XYZ of equal energy is white, 179 lumens are a watt.
  const Image xyz = one("FORMAT=32-bit_rle_xyze\n", {char(179), char(179), char(179), char(136)});
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(xyz.pixels[std::size_t(k)], 1, 1e-3);
  ASSERT_EQ(xyz.notes.size(), 1u);
  for (const char* bad : {"FORMAT=32-bit_rle_abcd\n", "EXPOSURE=0\n", "EXPOSURE=x\n", "COLORCORR=1 1\n",
                          "PRIMARIES=1 2 3\n", "PRIMARIES=0 0 0 0 0 0 0 0\n"})
    EXPECT_THROW(one(bad, white), Error) << bad;
  for (const char* bad : {"-Y 1 -Y 1", "1 1", "+Z 1 +X 1", "", "-Y 0 +X 1", "-Y x +X 1"})
    EXPECT_THROW(read_image(folder.write("b.hdr", std::string("#?RADIANCE\n\n") + bad + "\n" + white)), Error)
        << bad;
}

TEST(Hdr, OldRuns) {
  const TemporaryFolder folder;
  std::string text = "#?RADIANCE\n\n-Y 2 +X 300\n";
  for (const char first : {char(128), char(200)}) {
    text += {first, 0, 0, char(129)};
    text += {1, 1, 1, char(43)};
    text += {1, 1, 1, 1};  // 43 + 256 repetitions
  }
  const Image image = read_image(folder.write("a.hdr", text));
  ASSERT_EQ(image.width, 300);
  for (int x = 0; x < 300; ++x) {
    EXPECT_EQ(image.at(x, 0, 0), 1);
    EXPECT_EQ(image.at(x, 1, 0), 200 / 128.f);
  }
  EXPECT_THROW(read_image(folder.write("b.hdr", text.substr(0, text.size() - 4))), Error);
}

}  // namespace
}  // namespace aureole::test

// SPDX-License-Identifier: Apache-2.0
// PFM and Radiance HDR: pictures survive writing and reading; damaged files are errors.
#include <gtest/gtest.h>

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

}  // namespace
}  // namespace aureole::test

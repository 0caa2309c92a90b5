// SPDX-License-Identifier: Apache-2.0
#include "aureole/core/image.h"

#include <ImfChannelList.h>
#include <ImfEnvmap.h>
#include <ImfFrameBuffer.h>
#include <ImfOutputFile.h>
#include <ImfStandardAttributes.h>
#include <gtest/gtest.h>
#include <png.h>
#include <sys/resource.h>
#include <tiffio.h>
#include <unistd.h>
#include <zlib.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>

#include "aureole/core/color_profile.h"
#include "aureole/core/error.h"
#include "aureole/math/vec.h"

#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#endif
#include <stb/stb_image_write.h>
#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

namespace aureole {
namespace {

namespace fs = std::filesystem;

class ImageTest : public ::testing::Test {
protected:
  ImageTest() {
    const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ = fs::temp_directory_path() /
              ("aureole-image-" + std::string(info->name()) + "-" + std::to_string(::getpid()));
    fs::create_directories(folder_);
  }
  ~ImageTest() override { fs::remove_all(folder_); }

  fs::path path(const std::string& name) const { return folder_ / name; }
  static std::string bytes_of(const fs::path& p) {
    std::ifstream in(p, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  static void put(const fs::path& p, const std::string& bytes) {
    fs::remove(p);  // overwriting a file flushes it on some file systems: slow
    std::ofstream(p, std::ios::binary) << bytes;
  }
  static std::string error_of(const fs::path& p, std::size_t max_pixels = std::size_t(1) << 30) {
    try {
      read_image(p, nullptr, max_pixels);
      return "";
    } catch (const Error& e) {
      return e.what();
    }
  }
  /// Every truncation is an Error that names the file; `most_missing` bytes at the end carry no pixels.
  void expect_truncations_fail(const fs::path& p, std::size_t most_missing) const {
    const std::string whole = bytes_of(p);
    const fs::path cut = path("cut" + p.extension().string());
    for (std::size_t n = 0; n + most_missing < whole.size();
         n += n < 400 || whole.size() - n < 200 ? 1 : 37) {
      put(cut, whole.substr(0, n));
      const std::string error = error_of(cut);
      ASSERT_FALSE(error.empty()) << p << " cut to " << n << " of " << whole.size();
      ASSERT_NE(error.find(cut.string()), std::string::npos) << error;
    }
  }
  /// Single damaged bytes give an image or an Error, nothing else.
  void expect_damage_survived(const fs::path& p) const {
    const std::string whole = bytes_of(p);
    const fs::path bad = path("bad" + p.extension().string());
    for (std::size_t n = 0; n < whole.size(); n += n < 500 ? 1 : 53)
      for (const char flip : {'\x01', '\x80', '\xff'}) {
        std::string bytes = whole;
        bytes[n] = char(bytes[n] ^ flip);
        put(bad, bytes);
        error_of(bad);
      }
  }

  fs::path folder_;
};

Image gradient(int width, int height, std::vector<std::string> channels, float scale = 1) {
  Image image;
  image.width = width, image.height = height, image.channels = std::move(channels);
  image.pixels.resize(std::size_t(width) * height * image.channels.size());
  for (std::size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = scale * float(i % 251) / 250;
  return image;
}

std::vector<unsigned char> gradient8(std::size_t n) {
  std::vector<unsigned char> v(n);
  for (std::size_t i = 0; i < n; ++i) v[i] = static_cast<unsigned char>(i * 7 + i / 11);
  return v;
}

TEST_F(ImageTest, ExrRoundTripFloat) {
  Image image = gradient(13, 7, {"R", "G", "B", "A", "depth.Z"}, 1000);
  image.pixels[3] = -2, image.pixels[4] = std::numeric_limits<float>::infinity();
  ExrAttributes written;
  written.strings["scene"] = "tests/ring.xml", written.integers["seed"] = -7,
  written.floats["exposure"] = 0.25f;
  write_exr(path("a.exr"), image, ExrPixel::float32, written);
  ExrAttributes attributes;
  const Image back = read_image(path("a.exr"), &attributes);
  ASSERT_EQ(back.width, 13);
  ASSERT_EQ(back.height, 7);
  EXPECT_FALSE(back.srgb_encoded);
  EXPECT_EQ(back.channels, (std::vector<std::string>{"A", "B", "G", "R", "depth.Z"}));  // a file sorts them
  for (const std::string& name : image.channels)
    for (int y = 0; y < 7; ++y)
      for (int x = 0; x < 13; ++x)
        ASSERT_EQ(image.at(x, y, std::size_t(image.channel(name))),
                  back.at(x, y, std::size_t(back.channel(name))));
  EXPECT_EQ(attributes.strings["scene"], "tests/ring.xml");
  EXPECT_EQ(attributes.integers["seed"], -7);
  EXPECT_EQ(attributes.floats["exposure"], 0.25f);
  EXPECT_NE(bytes_of(path("a.exr")).find("chromaticities"), std::string::npos);
  EXPECT_EQ(back.channel("nothing"), -1);
}

TEST_F(ImageTest, ExrHalf) {
  Image image = gradient(5, 4, {"Y"}, 3);
  image.pixels[0] = 1e9f;  // not representable: the largest half, not infinity
  write_exr(path("h.exr"), image, ExrPixel::half, {});
  const Image back = read_image(path("h.exr"));
  EXPECT_EQ(back.pixels[0], 65504.f);
  for (std::size_t i = 1; i < image.pixels.size(); ++i) EXPECT_NEAR(back.pixels[i], image.pixels[i], 2e-3f);
  EXPECT_EQ(bytes_of(path("h.exr")).find("chromaticities"), std::string::npos);
}

TEST_F(ImageTest, ExrTruncatedOrDamaged) {
  write_exr(path("t.exr"), gradient(17, 33, {"R", "G", "B"}), ExrPixel::float32, {});
  expect_truncations_fail(path("t.exr"), 0);
  expect_damage_survived(path("t.exr"));
}

TEST_F(ImageTest, ExrHugeWindowIsRefused) {
  write_exr(path("e.exr"), gradient(4, 4, {"Y"}), ExrPixel::float32, {});
  std::string bytes = bytes_of(path("e.exr"));
  const std::size_t at =
      bytes.find("dataWindow") + std::strlen("dataWindow") + 1 + std::strlen("box2i") + 1 + 4;
  for (const std::int32_t most : {20000, 2000000, 0x7fffffff}) {
    std::memcpy(bytes.data() + at + 8, &most, 4), std::memcpy(bytes.data() + at + 12, &most, 4);
    put(path("huge.exr"), bytes);
    const std::string error = error_of(path("huge.exr"));
    EXPECT_TRUE(error.find("cannot be in") != std::string::npos || error.find("limit") != std::string::npos)
        << error;
  }
  rusage usage;
  getrusage(RUSAGE_SELF, &usage);
  EXPECT_LT(usage.ru_maxrss, 1 << 20) << "more than 1 GiB taken";
  EXPECT_NE(error_of(path("e.exr"), 15).find("limit of 15"), std::string::npos);
}

TEST_F(ImageTest, PngRoundTrip) {
  for (const auto& channels : {std::vector<std::string>{"Y"}, {"R", "G", "B"}, {"R", "G", "B", "A"}}) {
    const Image image = gradient(19, 11, channels);
    write_png(path("a.png"), image);
    const Image back = read_image(path("a.png"));
    EXPECT_EQ(back.channels, channels);
    EXPECT_TRUE(back.srgb_encoded);
    for (std::size_t i = 0; i < image.pixels.size(); ++i)
      EXPECT_NEAR(back.pixels[i], image.pixels[i], 0.5f / 255 + 1e-6f);
    expect_truncations_fail(path("a.png"), 0);
  }
  expect_damage_survived(path("a.png"));
  EXPECT_THROW(write_png(path("b.png"), gradient(2, 2, {"a", "b", "c", "d", "e"})), Error);
  Image odd = gradient(3, 1, {"Y"});
  odd.pixels = {-1, 2, std::numeric_limits<float>::quiet_NaN()};
  write_png(path("c.png"), odd);
  EXPECT_EQ(read_image(path("c.png")).pixels, (std::vector<float>{0, 1, 0}));
}

TEST_F(ImageTest, Png16AndPalette) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION, png.width = 2, png.height = 1, png.format = PNG_FORMAT_LINEAR_Y;
  const std::uint16_t values[2] = {0x1234, 0xffff};
  ASSERT_TRUE(png_image_write_to_file(&png, path("p16.png").c_str(), 0, values, 0, nullptr));
  const Image back = read_image(path("p16.png"));
  EXPECT_EQ(back.channels, std::vector<std::string>{"Y"});
  // The file states that its values are linear; stored values are the file's own.
  EXPECT_NEAR(back.pixels[0], srgb_encode(0x1234 / 65535.f), 1e-5);
  EXPECT_NEAR(back.pixels[1], 1, 1e-5);
  ASSERT_EQ(back.notes.size(), 1u);
  const Image stored = read_image(path("p16.png"), nullptr, 100, ImageColors::stored);
  EXPECT_FLOAT_EQ(stored.pixels[0], 0x1234 / 65535.f);
  EXPECT_EQ(stored.pixels[1], 1);

  png_image palette{};
  palette.version = PNG_IMAGE_VERSION, palette.width = 2, palette.height = 1,
  palette.format = PNG_FORMAT_RGB_COLORMAP;
  palette.colormap_entries = 2;
  const unsigned char colours[6] = {255, 0, 51, 0, 255, 0}, indices[2] = {1, 0};
  ASSERT_TRUE(png_image_write_to_file(&palette, path("pal.png").c_str(), 0, indices, 0, colours));
  const Image p = read_image(path("pal.png"));
  EXPECT_EQ(p.channels, (std::vector<std::string>{"R", "G", "B"}));
  EXPECT_EQ(p.pixels, (std::vector<float>{0, 1, 0, 1, 0, 51 / 255.f}));
}

TEST_F(ImageTest, IntegersOfEveryFormat) {
  for (const auto& channels :
       {std::vector<std::string>{"Y"}, {"Y", "A"}, {"R", "G", "B"}, {"R", "G", "B", "A"}}) {
    const Image image = gradient(19, 11, channels);
    const auto expect_back = [&](const std::string& name, float error) {
      const Image back = read_image(path(name));
      EXPECT_EQ(back.channels, channels) << name;
      EXPECT_TRUE(back.notes.empty()) << name << back.notes.front();
      ASSERT_EQ(back.pixels.size(), image.pixels.size());
      for (std::size_t i = 0; i < image.pixels.size(); ++i)
        EXPECT_NEAR(back.pixels[i], image.pixels[i], error) << name << i;
    };
    write_png(path("w16.png"), image, 16), expect_back("w16.png", 0.5f / 65535 + 1e-6f);
    write_tiff(path("w8.tif"), image, TiffPixel::integer8), expect_back("w8.tif", 0.5f / 255 + 1e-6f);
    write_tiff(path("w16.tif"), image, TiffPixel::integer16), expect_back("w16.tif", 0.5f / 65535 + 1e-6f);
    write_tiff(path("w32.tif"), image, TiffPixel::float32), expect_back("w32.tif", 0);
    EXPECT_FALSE(read_image(path("w32.tif")).srgb_encoded);
    if (channels.back() == "A") {
      EXPECT_THROW(write_jpeg(path("w.jpg"), image), Error);
    } else {
      write_jpeg(path("w.jpg"), image, 100), expect_back("w.jpg", 4.f / 255);
      expect_damage_survived(path("w.jpg")), expect_damage_survived(path("w16.tif"));
    }
  }
  EXPECT_THROW(write_tiff(path("b.tif"), gradient(2, 2, {"a", "b", "c", "d", "e"}), TiffPixel::float32),
               Error);
}

/// A PNG whose chunks state other primaries and a linear scale, against the matrix of Display P3's primaries.
TEST_F(ImageTest, PrimariesOfAPng) {
  std::vector<unsigned char> profile;
  const auto write = [&](const std::string& name, double gamma, bool p3, bool srgb) {
    FILE* const file = std::fopen(path(name).c_str(), "wb");
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
    png_infop info = png_create_info_struct(png);
    png_init_io(png, file);
    png_set_IHDR(png, info, 1, 1, 8, PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
                 PNG_FILTER_TYPE_DEFAULT);
    if (gamma > 0) png_set_gAMA(png, info, gamma);
    if (p3) png_set_cHRM(png, info, 0.3127, 0.3290, 0.680, 0.320, 0.265, 0.690, 0.150, 0.060);
    if (srgb) png_set_sRGB(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
    if (!profile.empty())
      png_set_iCCP(png, info, "x", PNG_COMPRESSION_TYPE_BASE, profile.data(), png_uint_32(profile.size()));
    png_write_info(png, info);
    const unsigned char row[3] = {204, 102, 51};
    png_write_row(png, row);
    png_write_end(png, info);
    png_destroy_write_struct(&png, &info);
    std::fclose(file);
  };
  const std::vector<float> as_stored = {0.8f, 0.4f, 0.2f};
  write("p3.png", 1, true, false);
  const Image p3 = read_image(path("p3.png"));
  const double m[3][3] = {{1.2249, -0.2247, 0}, {-0.0420, 1.0419, 0}, {-0.0197, -0.0786, 1.0979}};
  for (std::size_t k = 0; k < 3; ++k)
    EXPECT_NEAR(p3.pixels[k], srgb_encode(float(m[k][0] * 0.8 + m[k][1] * 0.4 + m[k][2] * 0.2)), 3e-3) << k;
  ASSERT_EQ(p3.notes.size(), 1u);
  EXPECT_NE(p3.notes[0].find("converted to sRGB"), std::string::npos);
  // sRGB, nothing, and the usual exponent stand for sRGB; sRGB goes before other chunks.
  for (const auto& [gamma, srgb] : {std::pair{0., false}, {1 / 2.2, false}, {1 / 2.2, true}}) {
    write("plain.png", gamma, false, srgb);
    EXPECT_EQ(read_image(path("plain.png")).pixels, as_stored) << gamma << srgb;
  }
  // A profile goes before the chunks: of sRGB's primaries with an exponent of 1.8.
  profile = profile_of_primaries({0.64, 0.33, 0.30, 0.60, 0.15, 0.06, 0.3127, 0.3290}, 1.8);
  write("icc.png", 1, true, false);
  const Image icc = read_image(path("icc.png"));
  for (std::size_t k = 0; k < 3; ++k)
    EXPECT_NEAR(icc.pixels[k], srgb_encode(std::pow(as_stored[k], 1.8f)), 2e-3) << k;
  expect_damage_survived(path("icc.png"));
  EXPECT_THROW(profile_of_primaries({0.3, 0.3, 0.3, 0.3, 0.3, 0.3, 0.3, 0}, 1), Error);
}

TEST_F(ImageTest, Jpeg) {
  std::vector<unsigned char> pixels(32 * 24 * 3);
  for (int i = 0; i < 32 * 24; ++i)
    pixels[i * 3] = static_cast<unsigned char>(i % 32 * 8), pixels[i * 3 + 1] = 100, pixels[i * 3 + 2] = 30;
  ASSERT_TRUE(stbi_write_jpg(path("a.jpg").c_str(), 32, 24, 3, pixels.data(), 95));
  const Image back = read_image(path("a.jpg"));
  EXPECT_EQ(back.channels, (std::vector<std::string>{"R", "G", "B"}));
  EXPECT_TRUE(back.srgb_encoded);
  for (std::size_t i = 0; i < pixels.size(); ++i) EXPECT_NEAR(back.pixels[i], pixels[i] / 255.f, 0.04f);
  expect_truncations_fail(path("a.jpg"), 2);  // the end marker
  expect_damage_survived(path("a.jpg"));
}

void write_tiff(const fs::path& p, int bits, int format, int planar, bool tiled, int compression,
                int photometric) {
  TIFF* t = TIFFOpen(p.c_str(), "w");
  const int w = 21, h = 18, samples = photometric == PHOTOMETRIC_RGB ? 3 : 1;
  TIFFSetField(t, TIFFTAG_IMAGEWIDTH, w), TIFFSetField(t, TIFFTAG_IMAGELENGTH, h);
  TIFFSetField(t, TIFFTAG_BITSPERSAMPLE, bits), TIFFSetField(t, TIFFTAG_SAMPLESPERPIXEL, samples);
  TIFFSetField(t, TIFFTAG_SAMPLEFORMAT, format), TIFFSetField(t, TIFFTAG_PLANARCONFIG, planar);
  TIFFSetField(t, TIFFTAG_COMPRESSION, compression), TIFFSetField(t, TIFFTAG_PHOTOMETRIC, photometric);
  if (tiled)
    TIFFSetField(t, TIFFTAG_TILEWIDTH, 16), TIFFSetField(t, TIFFTAG_TILELENGTH, 16);
  else
    TIFFSetField(t, TIFFTAG_ROWSPERSTRIP, 5);
  const auto value = [&](int x, int y, int c) { return float((x * 5 + y * 3 + c * 50) % 256) / 255; };
  const auto encode = [&](unsigned char* to, float v) {
    if (format == SAMPLEFORMAT_IEEEFP)
      std::memcpy(to, &v, 4);
    else if (bits == 8)
      *to = static_cast<unsigned char>(v * 255 + 0.5f);
    else {
      const auto n = std::uint16_t(v * 65535 + 0.5f);
      std::memcpy(to, &n, 2);
    }
  };
  const bool planes = planar == PLANARCONFIG_SEPARATE;
  const int piece_w = tiled ? 16 : w, piece_h = tiled ? 16 : 1, bytes = bits / 8;
  std::vector<unsigned char> piece(std::size_t(piece_w * piece_h * samples * bytes));
  for (int plane = 0; plane < (planes ? samples : 1); ++plane)
    for (int y0 = 0; y0 < h; y0 += piece_h)
      for (int x0 = 0; x0 < w; x0 += piece_w) {
        const int per = planes ? 1 : samples;
        for (int y = 0; y < piece_h; ++y)
          for (int x = 0; x < piece_w; ++x)
            for (int c = 0; c < per; ++c)
              encode(piece.data() + ((y * piece_w + x) * per + c) * bytes,
                     value(x0 + x, y0 + y, planes ? plane : c));
        if (tiled)
          TIFFWriteTile(t, piece.data(), x0, y0, 0, plane);
        else
          TIFFWriteScanline(t, piece.data(), y0, plane);
      }
  TIFFClose(t);
}

TEST_F(ImageTest, TiffKinds) {
  for (const bool tiled : {false, true})
    for (const int planar : {PLANARCONFIG_CONTIG, PLANARCONFIG_SEPARATE})
      for (const int compression : {COMPRESSION_NONE, COMPRESSION_LZW, COMPRESSION_ADOBE_DEFLATE})
        for (const auto& [bits, format] :
             {std::pair{8, SAMPLEFORMAT_UINT}, {16, SAMPLEFORMAT_UINT}, {32, SAMPLEFORMAT_IEEEFP}})
          for (const int photometric : {PHOTOMETRIC_RGB, PHOTOMETRIC_MINISBLACK}) {
            write_tiff(path("a.tif"), bits, format, planar, tiled, compression, photometric);
            const Image image = read_image(path("a.tif"));
            ASSERT_EQ(image.width, 21);
            ASSERT_EQ(image.height, 18);
            ASSERT_EQ(image.channel_count(), photometric == PHOTOMETRIC_RGB ? 3u : 1u);
            EXPECT_EQ(image.srgb_encoded, bits != 32);
            for (int y = 0; y < 18; ++y)
              for (int x = 0; x < 21; ++x)
                for (int c = 0; c < int(image.channel_count()); ++c)
                  ASSERT_NEAR(image.at(x, y, std::size_t(c)), float((x * 5 + y * 3 + c * 50) % 256) / 255,
                              1e-4f);
          }
  write_tiff(path("w.tif"), 8, SAMPLEFORMAT_UINT, PLANARCONFIG_CONTIG, false, COMPRESSION_NONE,
             PHOTOMETRIC_MINISWHITE);
  EXPECT_NEAR(read_image(path("w.tif")).at(0, 0, 0), 1, 1e-4f);
}

/// A grey TIFF of one line with these samples, and as many more pages as wished.
template <class T>
void write_grey_tiff(const fs::path& p, const std::vector<T>& samples, int format, int pages = 1,
                     int orientation = ORIENTATION_TOPLEFT) {
  TIFF* t = TIFFOpen(p.c_str(), "w");
  for (int page = 0; page < pages; ++page) {
    TIFFSetField(t, TIFFTAG_IMAGEWIDTH, int(samples.size())), TIFFSetField(t, TIFFTAG_IMAGELENGTH, 1);
    TIFFSetField(t, TIFFTAG_BITSPERSAMPLE, int(8 * sizeof(T))), TIFFSetField(t, TIFFTAG_SAMPLESPERPIXEL, 1);
    TIFFSetField(t, TIFFTAG_SAMPLEFORMAT, format), TIFFSetField(t, TIFFTAG_ORIENTATION, orientation);
    TIFFSetField(t, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
    std::vector<T> line = samples;
    for (T& v : line) v = T(v + page);
    TIFFWriteScanline(t, line.data(), 0);
    TIFFWriteDirectory(t);
  }
  TIFFClose(t);
}

TEST_F(ImageTest, SignedTiffKeepsItsOrder) {
  const auto check = [&](const Image& image, double smallest) {
    ASSERT_EQ(image.pixels.size(), 4u);
    EXPECT_FLOAT_EQ(image.pixels[0], float(smallest));
    EXPECT_EQ(image.pixels[1], 0);
    EXPECT_GT(image.pixels[2], 0);
    EXPECT_EQ(image.pixels[3], 1);
    EXPECT_FALSE(image.srgb_encoded);
    ASSERT_EQ(image.notes.size(), 1u);
    EXPECT_NE(image.notes[0].find("signed integers"), std::string::npos);
  };
  write_grey_tiff<std::int8_t>(path("8.tif"), {-128, 0, 1, 127}, SAMPLEFORMAT_INT);
  check(read_image(path("8.tif")), -128. / 127);
  write_grey_tiff<std::int16_t>(path("16.tif"), {-32768, 0, 1, 32767}, SAMPLEFORMAT_INT);
  check(read_image(path("16.tif")), -32768. / 32767);
  write_grey_tiff<std::int32_t>(path("32.tif"), {-2147483647 - 1, 0, 1, 2147483647}, SAMPLEFORMAT_INT);
  check(read_image(path("32.tif")), -1);
  write_grey_tiff<std::int64_t>(path("64.tif"), {-1, 0, 1, 2}, SAMPLEFORMAT_INT);
  EXPECT_NE(error_of(path("64.tif")).find("64 bits, sample format 2"), std::string::npos);
  write_grey_tiff<std::int32_t>(path("c.tif"), {-1, 0, 1, 2}, SAMPLEFORMAT_COMPLEXINT);
  EXPECT_NE(error_of(path("c.tif")).find("sample format 5"), std::string::npos);
}

TEST_F(ImageTest, LogLuvTiffKeepsItsRange) {
  TIFF* t = TIFFOpen(path("a.tif").c_str(), "w");
  TIFFSetField(t, TIFFTAG_IMAGEWIDTH, 2), TIFFSetField(t, TIFFTAG_IMAGELENGTH, 1);
  TIFFSetField(t, TIFFTAG_SAMPLESPERPIXEL, 3), TIFFSetField(t, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_LOGLUV);
  TIFFSetField(t, TIFFTAG_COMPRESSION, COMPRESSION_SGILOG),
      TIFFSetField(t, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
  TIFFSetField(t, TIFFTAG_SGILOGDATAFMT, SGILOGDATAFMT_FLOAT), TIFFSetField(t, TIFFTAG_ROWSPERSTRIP, 1);
  float xyz[6] = {95.047f, 100, 108.883f, 0.33701f, 0.27782f, 0.13045f};
  TIFFWriteScanline(t, xyz, 0);
  TIFFClose(t);
  const Image image = read_image(path("a.tif"));
  ASSERT_EQ(image.channel_count(), 3u);
  const float expected[6] = {100, 100, 100, 0.6f, 0.2f, 0.1f};
  for (std::size_t i = 0; i < 6; ++i)
    EXPECT_NEAR(image.pixels[i], expected[i], 0.025f * expected[i] + 0.004f) << i;
  EXPECT_FALSE(image.srgb_encoded);
}

TEST_F(ImageTest, StacksSayWhichSliceIsRead) {
  write_grey_tiff<std::uint8_t>(path("a.tif"), {10, 20}, SAMPLEFORMAT_UINT, 3);
  const Image image = read_image(path("a.tif"));
  EXPECT_FLOAT_EQ(image.pixels[0], 10 / 255.f);
  ASSERT_EQ(image.notes.size(), 1u);
  EXPECT_EQ(image.notes[0], "the first of 3 pages of the TIFF is read");
}

TEST_F(ImageTest, TiffOrientation) {
  write_grey_tiff<std::uint8_t>(path("a.tif"), {0, 255}, SAMPLEFORMAT_UINT, 1, ORIENTATION_BOTRIGHT);
  EXPECT_EQ(read_image(path("a.tif")).pixels, (std::vector<float>{1, 0}));
  write_grey_tiff<std::uint8_t>(path("a.tif"), {0, 255}, SAMPLEFORMAT_UINT, 1, ORIENTATION_RIGHTTOP);
  const Image turned = read_image(path("a.tif"));
  EXPECT_EQ(turned.width, 1);
  EXPECT_EQ(turned.height, 2);
  EXPECT_EQ(turned.pixels, (std::vector<float>{0, 1}));
}

/// An EXR of one pixel whose header states these chromaticities.
void write_exr_of_primaries(const fs::path& p, const std::vector<float>& rgb, const Imf::Chromaticities& c,
                            bool cube = false, int shift = 0) {
  Imf::Header header(Imath::Box2i({0, 0}, {0, 0}), Imath::Box2i({shift, 0}, {shift, 0}));
  Imf::addChromaticities(header, c);
  if (cube) Imf::addEnvmap(header, Imf::ENVMAP_CUBE);
  Imf::FrameBuffer frame;
  const char* names[] = {"R", "G", "B"};
  for (std::size_t k = 0; k < 3; ++k) {
    header.channels().insert(names[k], Imf::Channel(Imf::FLOAT));
    frame.insert(names[k], Imf::Slice(Imf::FLOAT, (char*)(rgb.data() + k) - shift * 4, 4, 12));
  }
  Imf::OutputFile file(p.c_str(), header);
  file.setFrameBuffer(frame);
  file.writePixels(1);
}

TEST_F(ImageTest, ExrPrimariesAreConverted) {
  const auto rgb = [](const Image& image) {
    return Vec3{image.at(0, 0, std::size_t(image.channel("R"))),
                image.at(0, 0, std::size_t(image.channel("G"))),
                image.at(0, 0, std::size_t(image.channel("B")))};
  };
  const auto expect = [&](const Vec3& got, Vec3 wanted) {
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(got[k], wanted[k], 3e-4f) << k;
  };
  // XYZ of the colour (0.6, 0.2, 0.1) of sRGB, by the matrix of IEC 61966-2-1.
  const Imf::Chromaticities xyz({1, 0}, {0, 1}, {0, 0}, {1 / 3.f, 1 / 3.f});
  write_exr_of_primaries(path("xyz.exr"), {0.33701f, 0.27782f, 0.13045f}, xyz);
  const Image image = read_image(path("xyz.exr"));
  expect(rgb(image), {0.6f, 0.2f, 0.1f});
  ASSERT_EQ(image.notes.size(), 1u);
  EXPECT_NE(image.notes[0].find("red (1, 0)"), std::string::npos);
  const Image stored = read_image(path("xyz.exr"), nullptr, 100, ImageColors::stored);
  expect(rgb(stored), {0.33701f, 0.27782f, 0.13045f});
  EXPECT_TRUE(stored.notes.empty());
  // Rec. 2020: published matrix to Rec. 709 (ITU-R BT.2087), of equal white points.
  write_exr_of_primaries(path("2020.exr"), {1, 0.5f, 0},
                         {{0.708f, 0.292f}, {0.17f, 0.797f}, {0.131f, 0.046f}, {0.3127f, 0.329f}});
  expect(rgb(read_image(path("2020.exr"))),
         {1.6605f - 0.5f * 0.5876f, -0.1246f + 0.5f * 1.1329f, -0.0182f - 0.5f * 0.1006f});
  // The primaries of sRGB change nothing.
  write_exr_of_primaries(path("709.exr"), {0.6f, 0.2f, 0.1f}, Imf::Chromaticities());
  EXPECT_FALSE(read_image(path("709.exr")).conversion);
  write_exr_of_primaries(path("line.exr"), {1, 1, 1},
                         {{0.1f, 0.1f}, {0.2f, 0.2f}, {0.3f, 0.3f}, {0.3f, 0.3f}});
  EXPECT_NE(error_of(path("line.exr")).find("line.exr"), std::string::npos);
}

TEST_F(ImageTest, ExrWindowsAndCubesAreSaid) {
  write_exr_of_primaries(path("a.exr"), {1, 1, 1}, Imf::Chromaticities(), true, 5);
  const Image image = read_image(path("a.exr"));
  EXPECT_TRUE(image.cube_map);
  EXPECT_EQ(image.pixels, (std::vector<float>{1, 1, 1}));
  ASSERT_EQ(image.notes.size(), 1u);
  EXPECT_NE(image.notes[0].find("at (5, 0)"), std::string::npos);
}

TEST_F(ImageTest, TiffTruncatedOrDamaged) {
  for (const int compression : {COMPRESSION_NONE, COMPRESSION_LZW}) {
    write_tiff(path("a.tif"), 8, SAMPLEFORMAT_UINT, PLANARCONFIG_CONTIG, false, compression, PHOTOMETRIC_RGB);
    expect_truncations_fail(path("a.tif"), 40);  // resolution and the like may be last
    expect_damage_survived(path("a.tif"));
  }
}

TEST_F(ImageTest, TgaBmpHdr) {
  const int w = 23, h = 9;
  const auto pixels = gradient8(w * h * 4);
  for (const int channels : {3, 4}) {
    for (const int rle : {0, 1}) {
      stbi_write_tga_with_rle = rle;
      ASSERT_TRUE(stbi_write_tga(path("a.tga").c_str(), w, h, channels, pixels.data()));
      const Image tga = read_image(path("a.tga"));
      ASSERT_EQ(int(tga.channel_count()), channels);
      EXPECT_TRUE(tga.srgb_encoded);
      for (int i = 0; i < w * h * channels; ++i)
        ASSERT_EQ(tga.pixels[std::size_t(i)], float(pixels[std::size_t(i)]) * (1 / 255.f));
      expect_truncations_fail(path("a.tga"), 0);
      expect_damage_survived(path("a.tga"));
    }
    ASSERT_TRUE(stbi_write_bmp(path("a.bmp").c_str(), w, h, channels, pixels.data()));
    const Image bmp = read_image(path("a.bmp"));
    ASSERT_EQ(int(bmp.channel_count()), channels);
    EXPECT_FLOAT_EQ(bmp.at(5, 6, 1), pixels[std::size_t((6 * w + 5) * channels + 1)] / 255.f);
    expect_truncations_fail(path("a.bmp"), 3);  // padding of the last row
    expect_damage_survived(path("a.bmp"));
  }
  const Image bright = gradient(w, h, {"R", "G", "B"}, 40);
  ASSERT_TRUE(stbi_write_hdr(path("a.hdr").c_str(), w, h, 3, bright.pixels.data()));
  const Image hdr = read_image(path("a.hdr"));
  EXPECT_FALSE(hdr.srgb_encoded);
  for (std::size_t i = 0; i < bright.pixels.size(); ++i) ASSERT_NEAR(hdr.pixels[i], bright.pixels[i], 0.26f);
  expect_truncations_fail(path("a.hdr"), 0);
  expect_damage_survived(path("a.hdr"));
}

// The headers of small files that claim large pictures, and what the library would allocate for them.
TEST_F(ImageTest, SmallFilesMayNotNeedMuchMemory) {
  write_exr(path("a.exr"), gradient(8, 8, {"R", "G", "B"}), ExrPixel::half, {});
  const std::string good = bytes_of(path("a.exr"));
  const auto text = [](std::initializer_list<std::int32_t> numbers) {
    return std::string(reinterpret_cast<const char*>(numbers.begin()), 4 * numbers.size());
  };
  const auto attribute = [&](const std::string& name, const std::string& type, const std::string& value) {
    return name + '\0' + type + '\0' + text({std::int32_t(value.size())}) + value;
  };
  const auto exr_error = [&](std::initializer_list<std::int32_t> window, char compression,
                             const std::string& more = "") {
    std::string bytes = good;
    bytes.replace(bytes.find("dataWindow") + 11 + 6 + 4, 16, text(window));
    bytes[bytes.find("compression") + 12 + 12 + 4] = compression;
    put(path("bad.exr"), bytes.insert(8, more) + std::string(90000, '\0'));
    return error_of(path("bad.exr"));
  };
  EXPECT_NE(exr_error({0, 0, 1048639, 63}, 9).find("its content needs 768 MiB"), std::string::npos);
  // 256 lines of DWAB are together, however many there are.
  EXPECT_NE(exr_error({0, 0, 1048639, 0}, 9).find("its content needs 3072 MiB"), std::string::npos);
  EXPECT_NE(
      exr_error({0, 0, 7, 7}, 3, attribute("chunkCount", "int", text({1 << 30}))).find("table of 1073741824"),
      std::string::npos);
  const std::string tiles = attribute("tiles", "tiledesc", text({1, 1}) + '\0');
  EXPECT_NE(exr_error({0, 0, 4095, 4095}, 3, tiles).find("table of 16777216"), std::string::npos);
  const std::string large = attribute("tiles", "tiledesc", text({16384, 16384}) + '\0');
  EXPECT_NE(exr_error({0, 0, 7, 7}, 3, large).find("its content needs"), std::string::npos);
  EXPECT_NE(exr_error({0, 0, 7, 7}, 3, attribute("type", "string", "deepscanline")).find("deep EXR"),
            std::string::npos);

  write_png(path("a.png"), gradient(8, 8, {"Y"}));
  std::string png = bytes_of(path("a.png"));
  const auto big_endian = [](std::uint32_t v) {
    return std::string{char(v >> 24), char(v >> 16), char(v >> 8), char(v)};
  };
  png.replace(16, 8, big_endian(20000) + big_endian(20000));
  png.replace(29, 4, big_endian(std::uint32_t(crc32(0, reinterpret_cast<const Bytef*>(&png[12]), 17))));
  put(path("bad.png"), png + std::string(60000, '\0'));
  EXPECT_NE(error_of(path("bad.png")).find("its content needs 1525 MiB"), std::string::npos);
}

TEST_F(ImageTest, WrongFiles) {
  EXPECT_NE(error_of(path("absent.png")).find("absent.png: no such file"), std::string::npos);
  EXPECT_NE(error_of(folder_).find("not a regular file but a folder"), std::string::npos);
  put(path("empty.exr"), "");
  EXPECT_NE(error_of(path("empty.exr")).find("empty"), std::string::npos);
  put(path("text.png"),
      "This is not an image at all, but a text of some length that no reader should take for one.");
  EXPECT_NE(error_of(path("text.png")).find("EXR, PNG"), std::string::npos);
}

TEST_F(ImageTest, ContentDecidesNotTheName) {
  write_png(path("a.exr"), gradient(3, 3, {"Y"}));
  EXPECT_TRUE(read_image(path("a.exr")).srgb_encoded);
}

TEST(Srgb, InverseOfEachOther) {
  for (int i = 0; i <= 255; ++i) EXPECT_NEAR(srgb_encode(srgb_decode(float(i) / 255)), float(i) / 255, 1e-6f);
  EXPECT_NEAR(srgb_decode(0.5f), 0.21404114f, 1e-7f);
}

}  // namespace
}  // namespace aureole

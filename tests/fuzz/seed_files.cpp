// SPDX-License-Identifier: Apache-2.0
#include "fuzz/seed_files.h"

#include <ImfArray.h>
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfOutputFile.h>
#include <ImfTiledOutputFile.h>
#include <png.h>
#include <tiffio.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
// jpeglib.h needs size_t and FILE first.
#include <jpeglib.h>

#include "aureole/core/color_profile.h"

namespace aureole::fuzz {

namespace {

constexpr int kWidth = 7, kHeight = 5;

/// 0 to 255, different everywhere.
unsigned char value(int x, int y, int c) { return static_cast<unsigned char>(31 * x + 53 * y + 90 * c); }

std::string pixels(int channels, int bytes_per_value = 1) {
  std::string all;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      for (int c = 0; c < channels; ++c)
        for (int b = 0; b < bytes_per_value; ++b) all += char(value(x, y, c));
  return all;
}

/// The profile of a display that sRGB is not: its values have an exponent of 1.8.
std::vector<unsigned char> other_profile() {
  return profile_of_primaries({0.68, 0.32, 0.265, 0.69, 0.15, 0.06, 0.3127, 0.3290}, 1.8);
}

std::string png(int color_type, int bits, bool interlaced, bool with_profile = false) {
  std::string out;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  png_set_write_fn(
      png, &out,
      [](png_structp p, png_bytep from, std::size_t n) {
        static_cast<std::string*>(png_get_io_ptr(p))->append(reinterpret_cast<char*>(from), n);
      },
      [](png_structp) {});
  png_set_IHDR(png, info, kWidth, kHeight, bits, color_type,
               interlaced ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
               PNG_FILTER_TYPE_DEFAULT);
  png_color palette[4] = {{0, 0, 0}, {255, 0, 0}, {0, 200, 0}, {90, 90, 255}};
  png_byte transparency[2] = {0, 128};
  if (color_type == PNG_COLOR_TYPE_PALETTE) {
    png_set_PLTE(png, info, palette, 4);
    png_set_tRNS(png, info, transparency, 2, nullptr);
  }
  const std::vector<unsigned char> profile = other_profile();
  if (with_profile)
    png_set_iCCP(png, info, "x", PNG_COMPRESSION_TYPE_BASE, profile.data(), png_uint_32(profile.size()));
  png_write_info(png, info);
  std::string data = pixels(4, 2);  // more than any kind needs
  if (color_type == PNG_COLOR_TYPE_PALETTE)
    for (char& c : data) c = char(c & 3);
  std::vector<png_bytep> rows;
  for (int y = 0; y < kHeight; ++y) rows.push_back(reinterpret_cast<png_bytep>(data.data()) + y * kWidth);
  png_write_image(png, rows.data());
  png_write_end(png, nullptr);
  png_destroy_write_struct(&png, &info);
  return out;
}

std::string jpeg(int components, bool progressive, bool with_profile = false) {
  jpeg_compress_struct jpeg{};
  jpeg_error_mgr errors{};
  jpeg.err = jpeg_std_error(&errors);
  jpeg_create_compress(&jpeg);
  unsigned char* buffer = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&jpeg, &buffer, &size);
  jpeg.image_width = kWidth, jpeg.image_height = kHeight, jpeg.input_components = components;
  jpeg.in_color_space = components == 1 ? JCS_GRAYSCALE : components == 3 ? JCS_RGB : JCS_CMYK;
  jpeg_set_defaults(&jpeg);
  if (progressive) jpeg_simple_progression(&jpeg);
  jpeg_start_compress(&jpeg, TRUE);
  const std::vector<unsigned char> profile = other_profile();
  if (with_profile) jpeg_write_icc_profile(&jpeg, profile.data(), unsigned(profile.size()));
  std::string data = pixels(components);
  while (jpeg.next_scanline < jpeg.image_height) {
    JSAMPROW row =
        reinterpret_cast<JSAMPROW>(data.data()) + jpeg.next_scanline * unsigned(kWidth * components);
    jpeg_write_scanlines(&jpeg, &row, 1);
  }
  jpeg_finish_compress(&jpeg);
  jpeg_destroy_compress(&jpeg);
  std::string out(reinterpret_cast<char*>(buffer), size);
  std::free(buffer);
  return out;
}

/// The bytes that `write(path)` writes to a file.
template <class Write>
std::string written(const Write& write) {
  std::string path = (std::filesystem::temp_directory_path() / "aureole-seed-XXXXXX").string();
  const int descriptor = mkstemp(path.data());
  if (descriptor < 0) return {};
  close(descriptor);
  write(path);
  std::ifstream in(path, std::ios::binary);
  std::string out{std::istreambuf_iterator<char>(in), {}};
  std::filesystem::remove(path);
  return out;
}

struct TiffKind {
  int samples, bits, format, compression, planar, photometric;
  bool tiled;
};
std::string tiff(const TiffKind& k) {
  return written([&](const std::string& path) {
    TIFF* t = TIFFOpen(path.c_str(), "w");
    TIFFSetField(t, TIFFTAG_IMAGEWIDTH, kWidth), TIFFSetField(t, TIFFTAG_IMAGELENGTH, kHeight);
    TIFFSetField(t, TIFFTAG_SAMPLESPERPIXEL, k.samples), TIFFSetField(t, TIFFTAG_BITSPERSAMPLE, k.bits);
    TIFFSetField(t, TIFFTAG_SAMPLEFORMAT, k.format), TIFFSetField(t, TIFFTAG_COMPRESSION, k.compression);
    TIFFSetField(t, TIFFTAG_PLANARCONFIG, k.planar), TIFFSetField(t, TIFFTAG_PHOTOMETRIC, k.photometric);
    if (k.tiled)
      TIFFSetField(t, TIFFTAG_TILEWIDTH, 16), TIFFSetField(t, TIFFTAG_TILELENGTH, 16);
    else
      TIFFSetField(t, TIFFTAG_ROWSPERSTRIP, 2);
    std::string data = pixels(k.samples, (k.bits + 7) / 8);
    data.resize(1 << 14);
    if (k.format == SAMPLEFORMAT_IEEEFP)
      for (std::size_t i = 3; i < data.size(); i += 4) data[i] = 0x3e;  // floats of about 0.2
    const int planes = k.planar == PLANARCONFIG_SEPARATE ? k.samples : 1;
    for (int plane = 0; plane < planes; ++plane)
      if (k.tiled)
        TIFFWriteTile(t, data.data(), 0, 0, 0, std::uint16_t(plane));
      else
        for (int y = 0; y < kHeight; ++y)
          TIFFWriteScanline(t, data.data() + 32 * y, std::uint32_t(y), std::uint16_t(plane));
    TIFFClose(t);
  });
}

std::string exr(Imf::PixelType type, Imf::Compression compression, bool tiled, const char* channels) {
  return written([&](const std::string& path) {
    Imf::Header header(kWidth, kHeight);
    header.compression() = compression;
    const std::size_t size = type == Imf::HALF ? 2 : 4;
    std::string data;
    for (int i = 0; i < kWidth * kHeight; ++i) data += std::string("\x00\x34\x50\x3e", 4).substr(4 - size);
    Imf::FrameBuffer frame;
    for (const char* c = channels; *c; ++c) {
      header.channels().insert(std::string(1, *c), Imf::Channel(type));
      frame.insert(std::string(1, *c), Imf::Slice(type, data.data(), size, size * kWidth));
    }
    if (tiled) {
      header.setTileDescription(Imf::TileDescription(4, 4, Imf::ONE_LEVEL));
      Imf::TiledOutputFile file(path.c_str(), header, 0);
      file.setFrameBuffer(frame);
      file.writeTiles(0, file.numXTiles() - 1, 0, file.numYTiles() - 1);
    } else {
      Imf::OutputFile file(path.c_str(), header, 0);
      file.setFrameBuffer(frame);
      file.writePixels(kHeight);
    }
  });
}

std::string little(unsigned v, int bytes) {
  std::string s;
  for (int i = 0; i < bytes; ++i) s += char(i < 4 ? v >> 8 * i : 0);
  return s;
}

std::string tga(bool packed) {
  std::string s = little(0, 2) + char(packed ? 10 : 2) + little(0, 9) + little(kWidth, 2) +
                  little(kHeight, 2) + char(24) + char(0x20);
  if (!packed) return s + pixels(3);
  for (int y = 0; y < kHeight; ++y) s += char(0x80 | (kWidth - 1)) + std::string("abc");
  return s;
}

std::string bmp() {
  const std::string row_padding(3, 0);
  std::string data;
  for (int y = 0; y < kHeight; ++y)
    data += pixels(3).substr(std::size_t(y) * kWidth * 3, kWidth * 3) + row_padding;
  return "BM" + little(54 + unsigned(data.size()), 4) + little(0, 4) + little(54, 4) + little(40, 4) +
         little(kWidth, 4) + little(kHeight, 4) + little(1, 2) + little(24, 2) + little(0, 24) + data;
}

/// Radiance's format; runs need at least 8 pixels in a row.
std::string hdr(bool packed) {
  std::string s = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 3 +X 9\n";
  for (int y = 0; y < 3; ++y) {
    if (packed) {
      s += std::string("\x02\x02\x00\x09", 4);
      for (const char v : {'\x40', '\x50', '\x60', '\x80'}) s += std::string("\x89") + v;
    } else {
      for (int x = 0; x < 9; ++x) s += std::string("\x40\x50\x60\x80");
    }
  }
  return s;
}

}  // namespace

std::vector<std::pair<std::string, std::string>> seed_files() {
  const int rgb = PHOTOMETRIC_RGB, grey = PHOTOMETRIC_MINISBLACK, together = PLANARCONFIG_CONTIG,
            unsigned_ = SAMPLEFORMAT_UINT;
  return {
      {"rgb.png", png(PNG_COLOR_TYPE_RGB, 8, false)},
      {"grey16.png", png(PNG_COLOR_TYPE_GRAY, 16, false)},
      {"grey1.png", png(PNG_COLOR_TYPE_GRAY, 1, true)},
      {"palette.png", png(PNG_COLOR_TYPE_PALETTE, 8, true)},
      {"grey_alpha.png", png(PNG_COLOR_TYPE_GRAY_ALPHA, 8, false)},
      {"rgb.jpg", jpeg(3, false)},
      {"profile.png", png(PNG_COLOR_TYPE_RGB, 8, false, true)},
      {"profile.jpg", jpeg(3, false, true)},
      {"progressive.jpg", jpeg(3, true)},
      {"grey.jpg", jpeg(1, false)},
      {"cmyk.jpg", jpeg(4, false)},
      {"rgb.tif", tiff({3, 8, unsigned_, COMPRESSION_NONE, together, rgb, false})},
      {"lzw16.tif", tiff({3, 16, unsigned_, COMPRESSION_LZW, together, rgb, false})},
      {"float.tif", tiff({1, 32, SAMPLEFORMAT_IEEEFP, COMPRESSION_ADOBE_DEFLATE, together, grey, false})},
      {"tiled.tif", tiff({3, 8, unsigned_, COMPRESSION_ADOBE_DEFLATE, together, rgb, true})},
      {"planes.tif", tiff({3, 8, unsigned_, COMPRESSION_PACKBITS, PLANARCONFIG_SEPARATE, rgb, false})},
      {"grey4.tif", tiff({1, 4, unsigned_, COMPRESSION_NONE, together, grey, false})},
      {"half.exr", exr(Imf::HALF, Imf::ZIP_COMPRESSION, false, "RGB")},
      {"float.exr", exr(Imf::FLOAT, Imf::PIZ_COMPRESSION, false, "RGBA")},
      {"tiled.exr", exr(Imf::HALF, Imf::RLE_COMPRESSION, true, "Y")},
      {"pxr24.exr", exr(Imf::FLOAT, Imf::PXR24_COMPRESSION, false, "RGB")},
      {"b44.exr", exr(Imf::HALF, Imf::B44_COMPRESSION, false, "RGB")},
      {"dwaa.exr", exr(Imf::HALF, Imf::DWAA_COMPRESSION, false, "RGB")},
      {"uint.exr", exr(Imf::UINT, Imf::ZIPS_COMPRESSION, false, "Y")},
      {"rgb.tga", tga(false)},
      {"packed.tga", tga(true)},
      {"rgb.bmp", bmp()},
      {"flat.hdr", hdr(false)},
      {"packed.hdr", hdr(true)},
      {"warm.spd", "# nm, value\n400 0.2\n500 0.4\n600, 0.6\n700 0.9\n"},
      {"curve.txt",
       "0 0 0 0.1\n1 0 1 0.2\n2 1 1 0.1\n3 1 2 0.1\n\n0 1 0 0.1\n0 2 0 0.1\n0 3 1 0.1\n0 4 1 0.1\n"},
  };
}

}  // namespace aureole::fuzz

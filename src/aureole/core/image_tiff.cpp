// SPDX-License-Identifier: Apache-2.0
#include <half.h>
#include <tiffio.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <memory>

#include "aureole/core/color_profile.h"
#include "aureole/core/error.h"
#include "aureole/core/image_codecs.h"

namespace aureole::codec {

namespace {

struct Memory {
  Bytes bytes;
  std::size_t position = 0;
};

tmsize_t on_read(thandle_t handle, void* to, tmsize_t n) {
  auto& m = *static_cast<Memory*>(handle);
  const std::size_t left = m.bytes.size() - std::min(m.position, m.bytes.size());
  const std::size_t count = std::min(left, std::size_t(n));
  std::memcpy(to, m.bytes.data() + m.position, count);
  m.position += count;
  return tmsize_t(count);
}
tmsize_t on_write(thandle_t, void*, tmsize_t) { return 0; }
toff_t on_seek(thandle_t handle, toff_t offset, int whence) {
  auto& m = *static_cast<Memory*>(handle);
  const std::size_t base = whence == SEEK_CUR ? m.position : whence == SEEK_END ? m.bytes.size() : 0;
  m.position = std::min(base + std::size_t(offset), m.bytes.size());
  return m.position;
}
int on_close(thandle_t) { return 0; }
toff_t on_size(thandle_t handle) { return static_cast<Memory*>(handle)->bytes.size(); }

/// A file in memory that grows while libtiff writes it.
struct Growing {
  std::vector<char> bytes;
  std::size_t position = 0;
};

tmsize_t on_append(thandle_t handle, void* from, tmsize_t n) {
  auto& g = *static_cast<Growing*>(handle);
  if (g.position + std::size_t(n) > g.bytes.size()) g.bytes.resize(g.position + std::size_t(n));
  std::memcpy(g.bytes.data() + g.position, from, std::size_t(n));
  g.position += std::size_t(n);
  return n;
}
tmsize_t on_read_back(thandle_t handle, void* to, tmsize_t n) {
  auto& g = *static_cast<Growing*>(handle);
  const std::size_t count = std::min(g.bytes.size() - std::min(g.position, g.bytes.size()), std::size_t(n));
  std::memcpy(to, g.bytes.data() + g.position, count);
  g.position += count;
  return tmsize_t(count);
}
toff_t on_seek_growing(thandle_t handle, toff_t offset, int whence) {
  auto& g = *static_cast<Growing*>(handle);
  const std::size_t base = whence == SEEK_CUR ? g.position : whence == SEEK_END ? g.bytes.size() : 0;
  g.position = base + std::size_t(offset);
  return g.position;
}
toff_t size_of_growing(thandle_t handle) { return static_cast<Growing*>(handle)->bytes.size(); }

/// Silences libtiff, which would print messages to stderr; our own errors are sufficient.
void silence() {
  static const bool quiet = (TIFFSetErrorHandler(nullptr), TIFFSetWarningHandler(nullptr), true);
  (void)quiet;
}

struct Layout {
  std::uint32_t width = 0, height = 0;
  std::uint16_t bits = 1, samples = 1, format = SAMPLEFORMAT_UINT, planar = PLANARCONFIG_CONTIG,
                photometric = 0;
};

/// Converts a stored sample to a float: integers, signed or not, are divided by the largest value of their type.
float sample_value(const unsigned char* at, const Layout& l) {
  const auto as = [&](auto value) {
    std::memcpy(&value, at, sizeof value);
    return value;
  };
  const bool real = l.format == SAMPLEFORMAT_IEEEFP;
  if (l.format == SAMPLEFORMAT_INT)
    return l.bits == 8    ? float(as(std::int8_t())) / 127
           : l.bits == 16 ? float(as(std::int16_t())) / 32767
                          : float(as(std::int32_t()) / 2147483647.0);
  switch (l.bits) {
    case 8:
      return float(*at) / 255;
    case 16: {
      const std::uint16_t raw = as(std::uint16_t());
      if (!real) return float(raw) / 65535;
      half h;
      h.setBits(raw);
      return float(h);
    }
    default:
      return real ? (l.bits == 64 ? float(as(double())) : as(float()))
                  : float(as(std::uint32_t()) / 4294967295.0);
  }
}

/// Reads strips or tiles of the simple types: grey or RGB of 8, 16, 32 or 64 bits, interleaved or planar.
Image read_plain(TIFF* tiff, const Layout& l, bool encoded) {
  const int channels = std::min<int>(l.samples, 4);
  Image image = make_image(int(l.width), int(l.height), channels, encoded, [](std::size_t) { return 0.f; });
  const std::size_t sample_bytes = l.bits / 8;
  const bool tiled = TIFFIsTiled(tiff), planes = l.planar == PLANARCONFIG_SEPARATE;
  const int per_piece = planes ? 1 : l.samples;
  std::uint32_t piece_width = l.width, piece_height = 1;
  if (tiled) {
    TIFFGetField(tiff, TIFFTAG_TILEWIDTH, &piece_width);
    TIFFGetField(tiff, TIFFTAG_TILELENGTH, &piece_height);
  }
  const tmsize_t piece_bytes = tiled ? TIFFTileSize(tiff) : TIFFScanlineSize(tiff);
  const double needed = double(piece_width) * piece_height * per_piece * sample_bytes;
  if (piece_width == 0 || piece_height == 0 || double(piece_bytes) < needed ||
      needed > double(image.pixels.size()) * 8 + (1 << 26))
    throw Error("damaged TIFF: impossible tiles");
  std::vector<unsigned char> piece(static_cast<std::size_t>(piece_bytes));
  for (int plane = 0; plane < (planes ? channels : 1); ++plane)
    for (std::uint32_t y0 = 0; y0 < l.height; y0 += piece_height)
      for (std::uint32_t x0 = 0; x0 < l.width; x0 += piece_width) {
        const auto got = tiled ? TIFFReadTile(tiff, piece.data(), x0, y0, 0, std::uint16_t(plane))
                               : TIFFReadScanline(tiff, piece.data(), y0, std::uint16_t(plane));
        if (got < 0) throw Error("the TIFF is truncated or damaged");
        for (std::uint32_t y = y0; y < std::min(l.height, y0 + piece_height); ++y)
          for (std::uint32_t x = x0; x < std::min(l.width, x0 + piece_width); ++x)
            for (int c = 0; c < (planes ? 1 : channels); ++c) {
              const std::size_t at = (std::size_t(y - y0) * piece_width + (x - x0)) * per_piece + c;
              image.at(int(x), int(y), std::size_t(planes ? plane : c)) =
                  sample_value(piece.data() + at * sample_bytes, l);
            }
      }
  return image;
}

/// Reads all other types (palettes, fewer bits, white-is-zero, inks, YCbCr) by libtiff's conversion to 8-bit
/// RGBA.
Image read_converted(TIFF* tiff, const Layout& l) {
  char why[1024] = "";
  if (!TIFFRGBAImageOK(tiff, why)) throw Error(std::string("this kind of TIFF is not supported: ") + why);
  std::vector<std::uint32_t> rgba(std::size_t(l.width) * l.height);
  if (!TIFFReadRGBAImageOriented(tiff, l.width, l.height, rgba.data(), ORIENTATION_TOPLEFT, 1))
    throw Error("the TIFF is truncated or damaged, or of a kind that libtiff does not convert");
  return make_image(int(l.width), int(l.height), 4, true,
                    [&](std::size_t i) { return float(rgba[i / 4] >> (8 * (i % 4)) & 255) / 255; });
}

/// Reads the resolution tags and the description into attributes with their TIFF names, if present.
void read_attributes(TIFF* tiff, ExrAttributes& attributes) {
  const char* description = nullptr;
  if (TIFFGetField(tiff, TIFFTAG_IMAGEDESCRIPTION, &description) && description)
    attributes.strings["ImageDescription"] = description;
  float x = 0, y = 0;
  if (TIFFGetField(tiff, TIFFTAG_XRESOLUTION, &x)) attributes.floats["XResolution"] = x;
  if (TIFFGetField(tiff, TIFFTAG_YRESOLUTION, &y)) attributes.floats["YResolution"] = y;
  std::uint16_t unit = RESUNIT_INCH;
  TIFFGetFieldDefaulted(tiff, TIFFTAG_RESOLUTIONUNIT, &unit);
  attributes.integers["ResolutionUnit"] = unit;
}

Orientation orientation(TIFF* tiff) {
  std::uint16_t o = ORIENTATION_TOPLEFT;
  TIFFGetFieldDefaulted(tiff, TIFFTAG_ORIENTATION, &o);
  return {.transposed = o >= ORIENTATION_LEFTTOP && o <= ORIENTATION_LEFTBOT,
          .from_right = o == ORIENTATION_TOPRIGHT || o == ORIENTATION_BOTRIGHT || o == ORIENTATION_RIGHTTOP ||
                        o == ORIENTATION_RIGHTBOT,
          .from_bottom = o == ORIENTATION_BOTRIGHT || o == ORIENTATION_BOTLEFT || o == ORIENTATION_RIGHTBOT ||
                         o == ORIENTATION_LEFTBOT};
}

/// The number of pictures of full size: pages of a document, slices of a stack. Leaves the first page. ImageJ
/// writes large stacks behind one page and their number in its description.
int page_count(TIFF* tiff) {
  const char* description = nullptr;
  int pages = 0;
  if (TIFFGetField(tiff, TIFFTAG_IMAGEDESCRIPTION, &description) && description)
    if (const char* images = std::strstr(description, "\nimages=");
        images && std::strncmp(description, "ImageJ=", 7) == 0)
      pages = std::max(0, std::atoi(images + 8));
  int found = 0;
  do {
    std::uint32_t kind = 0;
    TIFFGetFieldDefaulted(tiff, TIFFTAG_SUBFILETYPE, &kind);
    if (!(kind & (FILETYPE_REDUCEDIMAGE | FILETYPE_MASK))) ++found;
  } while (TIFFReadDirectory(tiff));
  return std::max(pages, found);
}

}  // namespace

Image read_tiff(Bytes bytes, ExrAttributes* attributes, std::size_t max_pixels) {
  silence();
  Memory memory{bytes};
  const std::unique_ptr<TIFF, void (*)(TIFF*)> tiff(
      TIFFClientOpen("image", "rm", &memory, on_read, on_write, on_seek, on_close, on_size, nullptr, nullptr),
      TIFFClose);
  if (!tiff) throw Error("damaged TIFF");
  if (attributes) read_attributes(tiff.get(), *attributes);
  Layout l;
  if (!TIFFGetField(tiff.get(), TIFFTAG_IMAGEWIDTH, &l.width) ||
      !TIFFGetField(tiff.get(), TIFFTAG_IMAGELENGTH, &l.height))
    throw Error("damaged TIFF: no size");
  TIFFGetField(tiff.get(), TIFFTAG_PHOTOMETRIC, &l.photometric);
  // Logarithms of luminance and CIE u', v' are decoded to XYZ or Y in single precision.
  const bool logarithmic = l.photometric == PHOTOMETRIC_LOGL || l.photometric == PHOTOMETRIC_LOGLUV;
  if (logarithmic) TIFFSetField(tiff.get(), TIFFTAG_SGILOGDATAFMT, SGILOGDATAFMT_FLOAT);
  TIFFGetFieldDefaulted(tiff.get(), TIFFTAG_BITSPERSAMPLE, &l.bits);
  TIFFGetFieldDefaulted(tiff.get(), TIFFTAG_SAMPLESPERPIXEL, &l.samples);
  TIFFGetFieldDefaulted(tiff.get(), TIFFTAG_SAMPLEFORMAT, &l.format);
  TIFFGetFieldDefaulted(tiff.get(), TIFFTAG_PLANARCONFIG, &l.planar);
  const bool whole = l.format == SAMPLEFORMAT_UINT || l.format == SAMPLEFORMAT_VOID;
  const bool real = l.format == SAMPLEFORMAT_IEEEFP, is_signed = l.format == SAMPLEFORMAT_INT;
  const bool known_bits = l.bits == 16 || l.bits == 32 || l.bits == (real ? 64 : 8);
  const bool known_colour =
      l.photometric == PHOTOMETRIC_MINISBLACK || l.photometric == PHOTOMETRIC_RGB || logarithmic;
  const bool is_plain =
      known_bits && (whole || real || is_signed) && known_colour && l.samples >= 1 && l.samples <= 64;
  // Bound of the pixels: no compression in use exceeds a ratio of some thousands.
  check_size(l.width, l.height, is_plain ? std::min<int>(l.samples, 4) : 4, max_pixels, bytes.size(), 20000);
  Image image;
  if (is_plain) {
    image = reoriented(read_plain(tiff.get(), l, whole), orientation(tiff.get()));
    if (l.photometric == PHOTOMETRIC_LOGLUV && l.samples == 3)
      image.conversion = {{3.2404542f, -1.5371385f, -0.4985314f, -0.9692660f, 1.8760108f, 0.0415560f,
                           // matrix from XYZ to linear sRGB (IEC 61966-2-1)
                           0.0556434f, -0.2040259f, 1.0572252f},
                          {"colours of the LogLuv TIFF are converted to sRGB"}};
    if (is_signed)
      image.notes.push_back("signed integers of the TIFF are read as fractions of the largest: " +
                            std::to_string(l.bits == 8    ? 127
                                           : l.bits == 16 ? 32767
                                                          : 2147483647) +
                            " is 1");
  } else if (whole) {
    image = read_converted(tiff.get(), l);
  } else {
    throw Error("TIFF samples of " + std::to_string(l.bits) + " bits, sample format " +
                std::to_string(l.format) + ", photometric interpretation " + std::to_string(l.photometric) +
                " are not supported; unsigned and signed integers and floats of grey and RGB are");
  }
  const void* profile = nullptr;
  std::uint32_t profile_size = 0;
  const bool keeps_colors = is_plain && !logarithmic && (image.channel("R") >= 0 || image.channel("Y") >= 0);
  if (TIFFGetField(tiff.get(), TIFFTAG_ICCPROFILE, &profile_size, &profile) && profile_size > 0) {
    const auto* bytes_of = static_cast<const unsigned char*>(profile);
    if (keeps_colors)
      image.profile.assign(bytes_of, bytes_of + profile_size);
    else
      image.notes.push_back("the colour profile of this kind of TIFF is not used");
  }
  image.format = "TIFF, " + std::to_string(l.bits) +
                 (real        ? "-bit float"
                  : is_signed ? "-bit signed integer"
                              : "-bit integer") +
                 (logarithmic ? ", logarithmic" : "");
  if (const int pages = page_count(tiff.get()); pages > 1)
    image.notes.push_back("the first of " + std::to_string(pages) + " pages of the TIFF is read");
  return image;
}

std::vector<char> encode_tiff(const Image& image, TiffPixel pixel) {
  silence();
  const int channels = int(image.channel_count());
  if (channels < 1 || channels > 4)
    throw Error("a TIFF is written with one to four channels, not " + std::to_string(channels));
  if (image.width <= 0 || image.height <= 0) throw Error("the image has no pixels");
  Growing file;
  const bool is_real = pixel == TiffPixel::float32;
  const std::size_t bytes = pixel == TiffPixel::integer8 ? 1 : is_real ? 4 : 2;
  // Files near 4 GB use BigTIFF, since offsets of the classic format end there.
  const bool is_big = double(image.pixels.size()) * double(bytes) > 3.9e9;
  TIFF* const tiff = TIFFClientOpen("image", is_big ? "w8" : "w", &file, on_read_back, on_append,
                                    on_seek_growing, on_close, size_of_growing, nullptr, nullptr);
  if (!tiff) throw Error("the TIFF cannot be made");
  const std::vector<unsigned char>& profile = srgb_profile(is_real);
  const bool has_alpha = channels == 2 || channels == 4;
  TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, image.width);
  TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, image.height);
  TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, int(8 * bytes));
  TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, channels);
  TIFFSetField(tiff, TIFFTAG_SAMPLEFORMAT, is_real ? SAMPLEFORMAT_IEEEFP : SAMPLEFORMAT_UINT);
  TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, channels < 3 ? PHOTOMETRIC_MINISBLACK : PHOTOMETRIC_RGB);
  TIFFSetField(tiff, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
  TIFFSetField(tiff, TIFFTAG_ORIENTATION, ORIENTATION_TOPLEFT);
  TIFFSetField(tiff, TIFFTAG_COMPRESSION, COMPRESSION_ADOBE_DEFLATE);
  TIFFSetField(tiff, TIFFTAG_PREDICTOR, is_real ? PREDICTOR_FLOATINGPOINT : PREDICTOR_HORIZONTAL);
  TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, TIFFDefaultStripSize(tiff, 0));
  if (has_alpha) {
    const std::uint16_t kind = is_real ? EXTRASAMPLE_ASSOCALPHA : EXTRASAMPLE_UNASSALPHA;
    TIFFSetField(tiff, TIFFTAG_EXTRASAMPLES, 1, &kind);
  }
  if (channels >= 3) TIFFSetField(tiff, TIFFTAG_ICCPROFILE, std::uint32_t(profile.size()), profile.data());
  const std::size_t row_values = std::size_t(image.width) * std::size_t(channels);
  std::vector<unsigned char> row(row_values * bytes);
  bool good = true;
  for (int y = 0; y < image.height && good; ++y) {
    const float* values = image.pixels.data() + std::size_t(y) * row_values;
    for (std::size_t i = 0; i < row_values; ++i) {
      if (pixel == TiffPixel::integer8) {
        row[i] = integer_value<unsigned char>(values[i]);
      } else if (is_real) {
        std::memcpy(row.data() + 4 * i, values + i, 4);
      } else {
        const std::uint16_t v = integer_value<std::uint16_t>(values[i]);
        std::memcpy(row.data() + 2 * i, &v, 2);
      }
    }
    good = TIFFWriteScanline(tiff, row.data(), std::uint32_t(y), 0) >= 0;
  }
  good = TIFFWriteDirectory(tiff) && good;
  TIFFClose(tiff);
  if (!good) throw Error("the TIFF cannot be made");
  return std::move(file.bytes);
}

std::vector<char> encode_raw(const RawImage& raw, bool is_dng) {
  silence();
  if (raw.width <= 0 || raw.height <= 0 ||
      raw.values.size() != std::size_t(raw.width) * std::size_t(raw.height))
    throw Error("the raw picture has no pixels");
  if (double(raw.values.size()) * 2 > 3.9e9) throw Error("the raw picture is larger than the 4 GB of a TIFF");
  Growing file;
  TIFF* const tiff = TIFFClientOpen("image", "w", &file, on_read_back, on_append, on_seek_growing, on_close,
                                    size_of_growing, nullptr, nullptr);
  if (!tiff) throw Error("the TIFF cannot be made");
  const bool is_mono = raw.mosaic.size() == 1;
  TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, raw.width);
  TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, raw.height);
  TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, 16);
  TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, 1);
  TIFFSetField(tiff, TIFFTAG_SAMPLEFORMAT, SAMPLEFORMAT_UINT);
  TIFFSetField(tiff, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
  TIFFSetField(tiff, TIFFTAG_ORIENTATION, ORIENTATION_TOPLEFT);
  TIFFSetField(tiff, TIFFTAG_COMPRESSION, is_dng ? COMPRESSION_NONE : COMPRESSION_ADOBE_DEFLATE);
  TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, raw.height);
  TIFFSetField(tiff, TIFFTAG_SOFTWARE, "aureole");
  TIFFSetField(tiff, TIFFTAG_MAKE, "aureole");
  TIFFSetField(tiff, TIFFTAG_MODEL, raw.model.c_str());
  if (!is_dng) {
    TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
  } else {
    constexpr std::uint8_t kVersion[4] = {1, 4, 0, 0}, kOldestReader[4] = {1, 1, 0, 0},
                           kPlanes[3] = {0, 1, 2};
    constexpr int kCfa = 32803, kLinearRaw = 34892, kD65 = 21;
    TIFFSetField(tiff, TIFFTAG_SUBFILETYPE, 0);
    TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, is_mono ? kLinearRaw : kCfa);
    TIFFSetField(tiff, TIFFTAG_DNGVERSION, kVersion);
    TIFFSetField(tiff, TIFFTAG_DNGBACKWARDVERSION, kOldestReader);
    TIFFSetField(tiff, TIFFTAG_UNIQUECAMERAMODEL, raw.model.c_str());
    const float black = float(raw.black_level);
    const std::uint16_t once[2] = {1, 1};
    const std::uint32_t white = std::uint32_t(raw.white_level);
    TIFFSetField(tiff, TIFFTAG_BLACKLEVELREPEATDIM, once);
    TIFFSetField(tiff, TIFFTAG_BLACKLEVEL, 1, &black);
    TIFFSetField(tiff, TIFFTAG_WHITELEVEL, 1, &white);
    if (!is_mono) {
      const std::uint16_t size[2] = {std::uint16_t(raw.mosaic_height), std::uint16_t(raw.mosaic_width)};
      TIFFSetField(tiff, TIFFTAG_CFAREPEATPATTERNDIM, size);
      TIFFSetField(tiff, TIFFTAG_CFAPATTERN, int(raw.mosaic.size()), raw.mosaic.data());
      TIFFSetField(tiff, TIFFTAG_CFAPLANECOLOR, 3, kPlanes);
      TIFFSetField(tiff, TIFFTAG_CFALAYOUT, 1);
      float matrix[9], neutral[3];
      for (std::size_t i = 0; i < 9; ++i) matrix[i] = float(raw.color_matrix[i]);
      for (std::size_t i = 0; i < 3; ++i) neutral[i] = float(raw.neutral[i]);
      TIFFSetField(tiff, TIFFTAG_COLORMATRIX1, 9, matrix);
      TIFFSetField(tiff, TIFFTAG_CALIBRATIONILLUMINANT1, kD65);
      TIFFSetField(tiff, TIFFTAG_ASSHOTNEUTRAL, 3, neutral);
    }
  }
  bool good = true;
  std::vector<std::uint16_t> row(std::size_t(raw.width));
  for (int y = 0; y < raw.height && good; ++y) {
    std::copy_n(raw.values.begin() + std::ptrdiff_t(y) * raw.width, raw.width, row.begin());
    good = TIFFWriteScanline(tiff, row.data(), std::uint32_t(y), 0) >= 0;
  }
  good = TIFFWriteDirectory(tiff) && good;
  TIFFClose(tiff);
  if (!good) throw Error("the TIFF cannot be made");
  return std::move(file.bytes);
}

}  // namespace aureole::codec

// SPDX-License-Identifier: Apache-2.0
// Files `.spz` of the versions 1 to 4 (Niantic, github.com/nianticlabs/spz, "File format"). Versions 1 to 3 are one stream
// of gzip with a header of 16 bytes; version 4 is a header of 32 bytes, a table of lengths and one stream of zstd for each
// attribute. Attributes follow each other: positions, opacities, colours, scales, rotations, harmonics.
#include <fmt/format.h>
#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <array>
#include <limits>

#include "aureole/core/memory.h"
#include "aureole/core/parallel.h"
#include "aureole/parameter/grid/grid_reader.h"
#include "aureole/parameter/splat/spherical_harmonics.h"
#include "aureole/parameter/splat/splat_reader.h"

namespace aureole::splat_reader {

namespace {

struct SpzHeader {
  std::uint32_t version, count;
  int degree, fractional_bits;
  unsigned flags;

  std::size_t position_bytes() const { return version == 1 ? 6 : 9; }
  std::size_t rotation_bytes() const { return version >= 3 ? 4 : 3; }
  std::size_t harmonic_bytes() const { return std::size_t(3 * ((degree + 1) * (degree + 1) - 1)); }
  /// Returns the bytes per splat of each attribute, in the order of the file.
  std::array<std::size_t, 6> sizes() const {
    return {position_bytes(), 1, 3, 3, rotation_bytes(), harmonic_bytes()};
  }
};

constexpr unsigned kSpzAntialiased = 1, kSpzExtensions = 2;
/// Largest ratio of content to file size: deflate compresses at most 1032 to 1; zstd may exceed it on
/// constant data.
constexpr double kSpzContentPerByte = 1100;

SpzHeader read_spz_header(std::span<const std::byte> bytes) {
  SpzHeader h{load<std::uint32_t>(&bytes[4]), load<std::uint32_t>(&bytes[8]), int(bytes[12]), int(bytes[13]),
              unsigned(bytes[14])};
  if (h.version < 1 || h.version > 4)
    throw Error(fmt::format("has version {} of the format .spz; 1 to 4 are known", h.version));
  if (h.count == 0) throw Error("holds no splats");
  if (h.count > kMaxSplats)
    throw Error(fmt::format("claims {} splats; {} are possible", h.count, kMaxSplats));
  if (h.degree > 4)
    throw Error(fmt::format("has spherical harmonics of degree {}; 0 to 4 are possible", h.degree));
  if (h.version > 1 && h.fractional_bits > 24)
    throw Error(
        fmt::format("has {} fractional bits of 24-bit coordinates; 0 to 24 are possible", h.fractional_bits));
  return h;
}

[[noreturn]] void truncated_spz(double wanted, double found) {
  throw Error(fmt::format("is truncated: its splats need {:.0f} bytes, decompressed, but there are {:.0f}",
                          wanted, found));
}

float of_half(std::uint16_t h) {
  const int exponent = h >> 10 & 31, fraction = h & 1023;
  const float magnitude = exponent == 0    ? std::ldexp(float(fraction), -24)
                          : exponent == 31 ? (fraction ? NAN : INFINITY)
                                           : std::ldexp(float(fraction + 1024), exponent - 25);
  return h & 0x8000 ? -magnitude : magnitude;
}

/// Decodes a rotation of the versions 1 and 2: a unit quaternion with w >= 0 whose x, y, z are one byte each.
std::array<float, 4> first_three(const std::byte* at) {
  std::array<float, 4> q;
  float rest = 1;
  for (std::size_t k = 0; k < 3; ++k) {
    q[k + 1] = float(at[k]) / 127.5f - 1;
    rest -= q[k + 1] * q[k + 1];
  }
  q[0] = std::sqrt(std::max(0.f, rest));
  return q;
}

/// Decodes a rotation of the versions 3 and 4: two bits with the index in x, y, z, w of the largest
/// component, and for each of the others a sign and 9 bits of its magnitude in units of 1/sqrt(2) / 511.
std::array<float, 4> smallest_three(const std::byte* at) {
  std::uint32_t bits = load<std::uint32_t>(at);
  const std::uint32_t largest = bits >> 30;
  float xyzw[4], rest = 1;
  for (std::uint32_t k = 4; k-- > 0;) {
    if (k == largest) continue;
    const float magnitude = float(bits & 511) / 511 * 0.70710678f;
    xyzw[k] = bits & 512 ? -magnitude : magnitude;
    rest -= magnitude * magnitude;
    bits >>= 10;
  }
  xyzw[largest] = std::sqrt(std::max(0.f, rest));
  return {xyzw[3], xyzw[0], xyzw[1], xyzw[2]};
}

/// Reads the records of extensions: type, length, content. The coordinate system is applied; other extensions
/// are noted.
void read_spz_extensions(std::span<const std::byte> bytes, SplatCloud& c) {
  while (bytes.size() >= 8) {
    const std::uint32_t type = load<std::uint32_t>(bytes.data()), size = load<std::uint32_t>(&bytes[4]);
    if (size > bytes.size() - 8)
      throw Error(
          fmt::format("has an extension of {} bytes, but {} are left for it", size, bytes.size() - 8));
    constexpr std::uint32_t kCoordinateSystem = 0xADBE0003;
    if (type == kCoordinateSystem && size >= 4) {
      constexpr const char* kNames[] = {"",    "LDB", "RDB", "LUB", "RUB", "LDF", "RDF", "LUF", "RUF",
                                        "LFD", "RFD", "LFU", "RFU", "LBD", "RBD", "LBU", "RBU"};
      const std::uint32_t system = load<std::uint32_t>(&bytes[8]);
      if (system < 1 || system > 8)
        throw Error(
            fmt::format("is stored in the coordinate system {}, which is not supported: convert it to RUB",
                        system <= 16 && system > 0 ? kNames[system] : std::to_string(system).c_str()));
      c.axes = kNames[system];
    } else {
      c.notes.push_back(
          fmt::format("has an extension of the type 0x{:08X} and {} bytes, which has no effect", type, size));
    }
    bytes = bytes.subspan(8 + size);
  }
}

/// Decompresses one stream of zstd, which must give exactly `wanted` bytes.
SharedBytes unzstd(std::span<const std::byte> source, std::size_t wanted) {
  // The size that the stream itself states is checked before memory is allocated.
  const unsigned long long stated = ZSTD_getFrameContentSize(source.data(), source.size());
  if (stated == ZSTD_CONTENTSIZE_ERROR) throw Error("holds data that are not compressed by zstd");
  if (stated != ZSTD_CONTENTSIZE_UNKNOWN && stated != wanted) truncated_spz(double(wanted), double(stated));
  require_content(double(wanted), double(source.size()), kSpzContentPerByte);
  std::vector<std::byte> out(wanted);
  const std::size_t found = ZSTD_decompress(out.data(), out.size(), source.data(), source.size());
  if (ZSTD_isError(found))
    throw Error(fmt::format("holds damaged data compressed by zstd: {}", ZSTD_getErrorName(found)));
  if (found != wanted) truncated_spz(double(wanted), double(found));
  return grid_reader::shared(std::move(out));
}

/// Returns the attributes of version 4, by the table of lengths.
std::array<SharedBytes, 6> split_streams(const SharedBytes& bytes, const SpzHeader& h, SplatCloud& c) {
  constexpr std::size_t kHeader = 32, kRow = 16;
  const std::size_t streams = std::size_t(bytes.bytes[15]), table = load<std::uint32_t>(&bytes.bytes[16]);
  const auto sizes = h.sizes();
  const std::size_t expected = h.degree > 0 ? 6 : 5;
  if (streams != expected)
    throw Error(fmt::format("has {} compressed streams; {} are expected with harmonics of degree {}", streams,
                            expected, h.degree));
  if (table < kHeader || table > bytes.size() || bytes.size() - table < kRow * streams)
    throw Error(
        fmt::format("is truncated: its table of lengths should begin at byte {} of {}", table, bytes.size()));
  if (h.flags & kSpzExtensions) read_spz_extensions(bytes.bytes.subspan(kHeader, table - kHeader), c);
  std::array<SharedBytes, 6> parts;
  std::size_t at = table + kRow * streams;
  for (std::size_t i = 0; i < streams; ++i) {
    const std::uint64_t packed = load<std::uint64_t>(&bytes.bytes[table + kRow * i]),
                        unpacked = load<std::uint64_t>(&bytes.bytes[table + kRow * i + 8]);
    const std::uint64_t needed = std::uint64_t(sizes[i]) * h.count;
    if (unpacked != needed)
      throw Error(fmt::format("has a stream {} of {} bytes, decompressed; {} splats need {}", i, unpacked,
                              h.count, needed));
    if (packed > bytes.size() - at)
      throw Error(
          fmt::format("is truncated: stream {} has {} bytes, but {} are left", i, packed, bytes.size() - at));
    parts[i] = unzstd(bytes.bytes.subspan(at, std::size_t(packed)), std::size_t(needed));
    at += std::size_t(packed);
  }
  if (at != bytes.size())
    c.notes.push_back(
        fmt::format("has {} bytes behind its last stream, which have no effect", bytes.size() - at));
  return parts;
}

/// Returns the attributes of the versions 1 to 3.
std::array<SharedBytes, 6> split_gzip(const SharedBytes& all, const SpzHeader& h, SplatCloud& c) {
  std::array<SharedBytes, 6> parts;
  std::size_t at = 16, i = 0;
  for (const std::size_t size : h.sizes()) {
    const std::size_t needed = size * h.count;
    if (needed > all.size() - at) {
      std::size_t wanted = 16;
      for (const std::size_t s : h.sizes()) wanted += s * h.count;
      truncated_spz(double(wanted), double(all.size()));
    }
    parts[i++] = {all.bytes.subspan(at, needed), all.owner};
    at += needed;
  }
  if (h.flags & kSpzExtensions)
    read_spz_extensions(all.bytes.subspan(at), c);
  else if (at != all.size())
    c.notes.push_back("has bytes behind its splats, which have no effect");
  return parts;
}

void decode_spz(const SpzHeader& h, const std::array<SharedBytes, 6>& parts, SplatCloud& c) {
  const int degree = std::min(h.degree, kMaxHarmonicDegree);
  c.resize(h.count, degree);
  const std::size_t harmonics = 3 * (c.coefficients() - 1), stored = h.harmonic_bytes();
  const float unit = std::ldexp(1.f, -h.fractional_bits);
  const auto part = [&](std::size_t k) { return parts[k].bytes.data(); };
  for_ranges(h.count, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const std::byte* p = part(0) + h.position_bytes() * i;
      for (int k = 0; k < 3; ++k) {
        if (h.version == 1) {
          c.positions[i][k] = of_half(load<std::uint16_t>(p + 2 * k));
          continue;
        }
        std::int32_t fixed =
            std::int32_t(p[3 * k]) | std::int32_t(p[3 * k + 1]) << 8 | std::int32_t(p[3 * k + 2]) << 16;
        if (fixed & 0x800000) fixed -= 0x1000000;
        c.positions[i][k] = float(fixed) * unit;
      }
      c.opacities[i] = float(part(1)[i]) / 255;
      float* to = &c.harmonics[3 * c.coefficients() * i];
      for (std::size_t k = 0; k < 3; ++k) {
        // The constant term is stored in units that leave room for colours outside of [0, 1].
        to[k] = (float(part(2)[3 * i + k]) / 255 - 0.5f) / 0.15f;
        c.scales[i][int(k)] = std::exp(float(part(3)[3 * i + k]) / 16 - 10);
      }
      const std::byte* q = part(4) + h.rotation_bytes() * i;
      c.rotations[i] = h.version >= 3 ? smallest_three(q) : first_three(q);
      const std::byte* s = part(5) + stored * i;
      for (std::size_t k = 0; k < harmonics; ++k) to[3 + k] = (float(s[k]) - 128) / 128;
    }
  });
}

}  // namespace

SplatCloud read_spz(const Path&, const SharedBytes& bytes, const SplatFileOptions&) {
  SplatCloud c;
  c.axes = "RUB";
  const bool is_plain = bytes.size() >= 4 && std::memcmp(bytes.bytes.data(), "NGSP", 4) == 0;
  SharedBytes all = bytes;
  if (!is_plain) {
    // The header is decompressed first, since it determines the size of the content.
    const SharedBytes start = grid_reader::inflate_bytes(bytes, 16);
    if (start.size() < 16 || std::memcmp(start.bytes.data(), "NGSP", 4) != 0)
      throw Error("is compressed by gzip, but is no .spz file: the letters NGSP are expected first");
    const SpzHeader h = read_spz_header(start.bytes);
    if (h.version == 4)
      throw Error("says that it has version 4 of the format .spz, but is compressed by gzip as a whole");
    double wanted = 16;
    for (const std::size_t size : h.sizes()) wanted += double(size) * h.count;
    // Upper bound of the bytes of extensions, which follow the splats.
    constexpr double kMaxExtensions = 1 << 20;
    if (h.flags & kSpzExtensions) wanted += kMaxExtensions;
    all = grid_reader::inflate_bytes(bytes, std::uint64_t(wanted) + 1);
  }
  if (all.size() < (is_plain ? 32u : 16u)) throw Error("is truncated in its header");
  const SpzHeader h = read_spz_header(all.bytes);
  if (is_plain && h.version < 4)
    throw Error(fmt::format("says that it has version {} of the format .spz, but is not compressed by gzip",
                            h.version));
  const auto parts = is_plain ? split_streams(all, h, c) : split_gzip(all, h, c);
  c.format = fmt::format("SPZ, version {}", h.version);
  c.hints.antialiased = (h.flags & kSpzAntialiased) != 0;
  if (h.degree > kMaxHarmonicDegree)
    c.notes.push_back("has spherical harmonics of degree 4; those up to degree 3 are used");
  decode_spz(h, parts, c);
  return c;
}

}  // namespace aureole::splat_reader

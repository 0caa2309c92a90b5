// SPDX-License-Identifier: Apache-2.0
// Reads and writes Radiance's pictures: three 8-bit mantissas with a common exponent (Ward 1991, "Real
// pixels"), run-length encoded line by line. The header is that of "The Radiance 5.1 synthetic imaging
// system", section "Picture files".
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "aureole/core/color_profile.h"
#include "aureole/core/error.h"
#include "aureole/core/image_codecs.h"

namespace aureole::codec {

namespace {

using Rgbe = std::array<unsigned char, 4>;

/// Primaries of CIE XYZ, with the white point of an equal-energy spectrum.
constexpr Primaries kXyz = {1, 0, 0, 1, 0, 0, 1 / 3., 1 / 3.};
constexpr double kLumensPerWatt = 179;  ///< Radiance's efficacy of white, the unit of XYZE over that of RGBE

using Matrix = std::array<std::array<double, 3>, 3>;
using Triple = std::array<double, 3>;

Matrix operator*(const Matrix& a, const Matrix& b) {
  Matrix r{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      for (std::size_t k = 0; k < 3; ++k) r[i][j] += a[i][k] * b[k][j];
  return r;
}
Triple operator*(const Matrix& a, const Triple& v) {
  Triple r{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = 0; k < 3; ++k) r[i] += a[i][k] * v[k];
  return r;
}
Matrix inverse(const Matrix& m) {
  Matrix r{};
  const auto minor_at = [&](std::size_t i, std::size_t j) {
    return m[(i + 1) % 3][(j + 1) % 3] * m[(i + 2) % 3][(j + 2) % 3] -
           m[(i + 1) % 3][(j + 2) % 3] * m[(i + 2) % 3][(j + 1) % 3];
  };
  const double determinant = m[0][0] * minor_at(0, 0) + m[0][1] * minor_at(0, 1) + m[0][2] * minor_at(0, 2);
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) r[j][i] = minor_at(i, j) / determinant;
  return r;
}

Triple white_xyz(const Primaries& p) { return {p[6] / p[7], 1, (1 - p[6] - p[7]) / p[7]}; }

Matrix to_xyz(const Primaries& p) {
  Matrix m;
  for (std::size_t k = 0; k < 3; ++k) {
    const double x = p[2 * k], y = p[2 * k + 1];
    m[0][k] = x, m[1][k] = y, m[2][k] = 1 - x - y;
  }
  const Triple scale = inverse(m) * white_xyz(p);
  for (Triple& row : m)
    for (std::size_t k = 0; k < 3; ++k) row[k] *= scale[k];
  return m;
}

/// Returns the matrix from colours of these primaries to sRGB. White becomes white, by von Kries's rule with
/// Bradford's cone responses, as Radiance's own programs convert.
Matrix to_srgb(const Primaries& p) {
  constexpr Matrix kBradford = {
      {{0.8951, 0.2664, -0.1614}, {-0.7502, 1.7135, 0.0367}, {0.0389, -0.0685, 1.0296}}};
  const Triple from = kBradford * white_xyz(p), to = kBradford * white_xyz(kSrgbPrimaries);
  Matrix scale{};
  for (std::size_t k = 0; k < 3; ++k) scale[k][k] = to[k] / from[k];
  return inverse(to_xyz(kSrgbPrimaries)) * inverse(kBradford) * scale * kBradford * to_xyz(p);
}

struct Header {
  bool xyz = false;
  std::optional<Primaries> primaries;
  double exposure = 1;
  Triple correction = {1, 1, 1};
  int line_length = 0, lines = 0;
  Orientation orientation;
  Bytes body;
};

template <std::size_t N>
std::array<double, N> numbers(std::string_view name, std::string_view text) {
  std::array<double, N> r;
  std::string_view rest = text;
  for (double& v : r) {
    while (!rest.empty() && (rest[0] == ' ' || rest[0] == '\t' || rest[0] == '+')) rest.remove_prefix(1);
    const auto [next, code] = std::from_chars(rest.data(), rest.data() + rest.size(), v);
    if (code != std::errc() || !std::isfinite(v))
      throw Error(fmt::format("{}={} in the header is not {}", name, text,
                              N == 1 ? std::string("a number") : fmt::format("{} numbers", N)));
    rest.remove_prefix(std::size_t(next - rest.data()));
  }
  return r;
}

/// Reads "-Y 480 +X 640" or another of the eight orders: the first axis counts lines, the second pixels of a line.
void read_resolution(std::string_view line, Header& h) {
  const auto fail = [&] {
    throw Error(
        fmt::format("the HDR has no resolution such as \"-Y 480 +X 640\" but \"{}\"", line.substr(0, 40)));
  };
  char sign[2], axis[2];
  int size[2];
  for (int k = 0; k < 2; ++k) {
    while (!line.empty() && line[0] == ' ') line.remove_prefix(1);
    if (line.size() < 4 || (line[0] != '+' && line[0] != '-') || (line[1] != 'X' && line[1] != 'Y')) fail();
    sign[k] = line[0], axis[k] = line[1];
    line.remove_prefix(2);
    while (!line.empty() && line[0] == ' ') line.remove_prefix(1);
    const auto [next, code] = std::from_chars(line.data(), line.data() + line.size(), size[k]);
    if (code != std::errc()) fail();
    line.remove_prefix(std::size_t(next - line.data()));
  }
  if (axis[0] == axis[1]) fail();
  h.lines = size[0], h.line_length = size[1];
  h.orientation.transposed = axis[0] == 'X';
  for (int k = 0; k < 2; ++k) {
    if (axis[k] == 'X') h.orientation.from_right = sign[k] == '-';
    if (axis[k] == 'Y') h.orientation.from_bottom = sign[k] == '+';  // in this format y points upwards
  }
}

Header read_header(Bytes bytes) {
  Header h;
  std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const auto next_line = [&] {
    const std::size_t end = text.find('\n');
    if (end == std::string_view::npos) throw Error("the file is truncated: its header does not end");
    std::string_view line = text.substr(0, end);
    text.remove_prefix(end + 1);
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    return line;
  };
  next_line();
  for (std::string_view line = next_line(); !line.empty(); line = next_line()) {
    const std::size_t equals = line.find('=');
    if (equals == std::string_view::npos) continue;
    const std::string_view name = line.substr(0, equals), value = line.substr(equals + 1);
    if (name == "FORMAT") {
      const std::string_view format = value.substr(0, value.find_last_not_of(' ') + 1);
      h.xyz = format == "32-bit_rle_xyze";
      if (!h.xyz && format != "32-bit_rle_rgbe")
        throw Error(fmt::format("the HDR has the unknown FORMAT \"{}\"", value.substr(0, 40)));
    } else if (name == "EXPOSURE") {
      h.exposure *= numbers<1>(name, value)[0];
    } else if (name == "COLORCORR") {
      const Triple c = numbers<3>(name, value);
      for (std::size_t k = 0; k < 3; ++k) h.correction[k] *= c[k];
    } else if (name == "PRIMARIES") {
      h.primaries = numbers<8>(name, value);
    }
  }
  read_resolution(next_line(), h);
  h.body = bytes.last(text.size());
  return h;
}

/// The conversion that a header requests, if any.
std::optional<ColorConversion> conversion(const Header& h) {
  std::vector<std::string> notes;
  Matrix m = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  if (h.xyz) {
    m = to_srgb(kXyz);
    for (Triple& row : m)
      for (double& v : row) v /= kLumensPerWatt;
    notes.push_back("colours are converted to sRGB from XYZ, and from lumens to watts (179 lm/W)");
  } else if (h.primaries) {
    bool same = true;
    for (std::size_t k = 0; k < 8; ++k) same &= std::abs((*h.primaries)[k] - kSrgbPrimaries[k]) < 5e-4;
    if (!same) {
      m = to_srgb(*h.primaries);
      std::string text;
      for (const double v : *h.primaries) text += fmt::format(" {:.4g}", v);
      notes.push_back("colours are converted to sRGB from PRIMARIES=" + text.substr(1) +
                      "; white stays white");
    }
  }
  bool scaled = false;
  for (std::size_t k = 0; k < 3; ++k) {
    const double by = h.exposure * h.correction[k];
    if (!(by > 0)) throw Error("EXPOSURE and COLORCORR of the HDR must be positive");
    scaled |= std::abs(by - 1) > 1e-6;
    for (Triple& row : m) row[k] /= by;
  }
  if (scaled)
    notes.push_back(fmt::format("values are divided by EXPOSURE and COLORCORR: {:.4g} {:.4g} {:.4g}",
                                h.exposure * h.correction[0], h.exposure * h.correction[1],
                                h.exposure * h.correction[2]));
  if (notes.empty()) return {};
  ColorConversion r{{}, std::move(notes)};
  for (std::size_t i = 0; i < 9; ++i) {
    const double v = m[i / 3][i % 3];
    if (!(std::abs(v) < 1e30)) throw Error("PRIMARIES of the HDR are of no colour space");
    r.to_srgb[i] = float(v);
  }
  return r;
}

/// Reads lines of pixels.
class LineReader {
public:
  explicit LineReader(Bytes bytes) : bytes_(bytes) {}

  /// Reads a line in one of three forms: components apart with runs, pixels with repeat counts, or plain.
  void read(std::vector<Rgbe>& line) {
    const std::size_t n = line.size();
    if (n < 8 || n > 32767) return read_pixels(line);
    require(4);
    if (bytes_[0] != 2 || bytes_[1] != 2 || (bytes_[2] & 128)) return read_pixels(line);
    if (std::size_t(bytes_[2]) * 256 + bytes_[3] != n)
      throw Error("the HDR is damaged: a line of another length");
    bytes_ = bytes_.subspan(4);
    for (std::size_t k = 0; k < 4; ++k)
      for (std::size_t x = 0; x < n;) {
        require(2);
        const bool run = bytes_[0] > 128;
        const std::size_t count = run ? bytes_[0] - 128u : bytes_[0];
        if (count == 0 || count > n - x) throw Error("the HDR is damaged: a run beyond its line");
        require(run ? 2 : 1 + count);
        for (std::size_t i = 0; i < count; ++i) line[x + i][k] = bytes_[run ? 1 : 1 + i];
        bytes_ = bytes_.subspan(run ? 2 : 1 + count);
        x += count;
      }
  }

private:
  void require(std::size_t n) const {
    if (bytes_.size() < n) throw Error("the file is truncated");
  }
  /// Reads pixels with repeat counts. A pixel with the mantissas 1, 1, 1 repeats the one before; several in
  /// sequence are digits to base 256 of the count.
  void read_pixels(std::vector<Rgbe>& line) {
    int shift = 0;
    for (std::size_t x = 0; x < line.size();) {
      require(4);
      const Rgbe e = {bytes_[0], bytes_[1], bytes_[2], bytes_[3]};
      bytes_ = bytes_.subspan(4);
      if (e[0] != 1 || e[1] != 1 || e[2] != 1) {
        line[x++] = e;
        shift = 0;
        continue;
      }
      const std::size_t count = shift > 24 ? 0 : std::size_t(e[3]) << shift;
      if (x == 0 || count > line.size() - x) throw Error("the HDR is damaged: a run beyond its line");
      for (std::size_t i = 0; i < count; ++i, ++x) line[x] = line[x - 1];
      shift += 8;
    }
  }

  Bytes bytes_;
};

/// Encodes a pixel. Mantissas are rounded to nearest, for readers that use them directly, as most do
/// (Radiance itself adds one half).
Rgbe to_rgbe(float r, float g, float b) {
  const float c[3] = {std::max(r, 0.f), std::max(g, 0.f), std::max(b, 0.f)};
  const float largest = std::max({c[0], c[1], c[2]});
  if (!(largest >= 0x1p-126f)) return {};
  int exponent;
  if (std::lround(std::ldexp(std::frexp(largest, &exponent), 8)) > 255) ++exponent;
  if (exponent > 127) return {255, 255, 255, 255};
  Rgbe e;
  for (int k = 0; k < 3; ++k)
    e[std::size_t(k)] = static_cast<unsigned char>(std::lround(std::ldexp(c[k], 8 - exponent)));
  e[3] = static_cast<unsigned char>(exponent + 128);
  return e;
}

/// Run-length encodes a line of one component: runs of more than two equal bytes become (128 + length, byte),
/// other bytes (length, bytes).
void append_runs(std::vector<char>& out, const std::vector<unsigned char>& line) {
  const auto run_at = [&](std::size_t i) {
    std::size_t end = i + 1;
    while (end < line.size() && end - i < 127 && line[end] == line[i]) ++end;
    return end - i;
  };
  for (std::size_t i = 0; i < line.size();) {
    if (const std::size_t run = run_at(i); run > 2) {
      out.push_back(char(128 + run));
      out.push_back(char(line[i]));
      i += run;
      continue;
    }
    std::size_t end = i + 1;
    while (end < line.size() && end - i < 128 && run_at(end) <= 2) ++end;
    out.push_back(char(end - i));
    out.insert(out.end(), line.begin() + std::ptrdiff_t(i), line.begin() + std::ptrdiff_t(end));
    i = end;
  }
}

}  // namespace

Image read_hdr(Bytes bytes, std::size_t max_pixels) {
  const Header header = read_header(bytes);
  // No upper bound of the compression exists, since four bytes may repeat a pixel any number of times.
  check_size(header.line_length, header.lines, 3, max_pixels, bytes.size(), 20000);
  Image image = make_image(header.line_length, header.lines, 3, false, [](std::size_t) { return 0.f; });
  LineReader reader(header.body);
  std::vector<Rgbe> line(std::size_t(header.line_length));
  for (int y = 0; y < header.lines; ++y) {
    reader.read(line);
    for (int x = 0; x < header.line_length; ++x) {
      const Rgbe& e = line[std::size_t(x)];
      for (std::size_t k = 0; k < 3 && e[3] != 0; ++k)
        image.at(x, y, k) = std::ldexp(float(e[k]), int(e[3]) - 136);
    }
  }
  image = reoriented(std::move(image), header.orientation);
  image.conversion = conversion(header);
  image.format = header.xyz ? "Radiance HDR, XYZE (8-bit mantissas, a common exponent)"
                            : "Radiance HDR, RGBE (8-bit mantissas, a common exponent)";
  if (header.primaries) image.primaries = fmt::format("{:.4g}", fmt::join(*header.primaries, " "));
  return image;
}

std::vector<char> encode_hdr(const Image& image) {
  const std::string header = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y " + std::to_string(image.height) +
                             " +X " + std::to_string(image.width) + "\n";
  std::vector<char> out(header.begin(), header.end());
  const bool color = image.channels.size() == 3, packed = image.width >= 8 && image.width < 32768;
  std::vector<unsigned char> lines[4];
  for (int y = 0; y < image.height; ++y) {
    for (auto& line : lines) line.clear();
    for (int x = 0; x < image.width; ++x) {
      const Rgbe e = to_rgbe(image.at(x, y, 0), image.at(x, y, color ? 1 : 0), image.at(x, y, color ? 2 : 0));
      if (!packed) out.insert(out.end(), e.begin(), e.end());
      for (std::size_t k = 0; k < 4; ++k) lines[k].push_back(e[k]);
    }
    if (!packed) continue;
    out.insert(out.end(), {2, 2, char(image.width >> 8), char(image.width & 255)});
    for (const auto& line : lines) append_runs(out, line);
  }
  return out;
}

}  // namespace aureole::codec

// SPDX-License-Identifier: Apache-2.0
// Writes Radiance's RGBE pictures: three 8-bit mantissas with a common exponent (Ward 1991, "Real pixels"),
// run-length encoded line by line.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "aureole/core/image_codecs.h"

namespace aureole::codec {

namespace {

using Rgbe = std::array<unsigned char, 4>;

/// Rounds mantissas to nearest, for readers that use them directly, as most do (Radiance itself adds one
/// half).
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

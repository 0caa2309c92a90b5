// SPDX-License-Identifier: Apache-2.0
#include "aureole/spectrum/upsampling.h"

#include <cstdint>
#include <cstring>

// Table that tools/make_upsampling_table.cpp writes during the build, embedded by upsampling_table.S.
extern "C" {
extern const char aureole_upsampling_table[];
extern const char aureole_upsampling_table_end[];
}

namespace aureole {
namespace {

/// Header: "AURU", then the resolution N as uint32. Coefficients [l][k][j][i][3] follow. l is the index of
/// the largest component z. k, i and j index z and the next two components (cyclically) divided by z, all of
/// them warped. This is the paper's layout with two changes that cut the largest round-trip error at N = 48
/// from Delta E 2.1 to 0.17. First, the ratios are warped like z, by a function with a cheap inverse. Second,
/// coefficients are multiplied by sqrt(z), because coefficients of dark colours of one chromaticity grow
/// about as 1/sqrt(z). Byte order is the machine's: the table is written and read by the same build.
struct Table {
  int resolution = 0;
  const float* coefficients = nullptr;

  Table() {
    std::uint32_t n = 0;
    std::memcpy(&n, aureole_upsampling_table + 4, sizeof n);
    resolution = static_cast<int>(n);
    // the cast is valid, since the symbol is aligned
    coefficients = reinterpret_cast<const float*>(aureole_upsampling_table + 8);
  }
};

const Table& table() {
  static const Table instance;
  return instance;
}

/// Solves v/z = u^2 / (u^2 + (1 - u)^2) for u, 0 <= v <= z.
float unwarped(float v, float z) {
  const float a = std::sqrt(v), b = std::sqrt(z - v);
  return a / (a + b);
}

/// Clamps v to [0, most]; NaN becomes 0.
float clamped(float v, float most) { return v > 0.f ? std::min(v, most) : 0.f; }

/// Returns the sigmoid of a colour in [0, 1], not scaled.
SigmoidPolynomial look_up(const float (&rgb)[3]) {
  if (rgb[0] == rgb[1] && rgb[1] == rgb[2]) {
    const float v = rgb[0], spread = v * (1.f - v);
    if (!(spread > 0.f)) return {0.f, 0.f, std::copysign(SigmoidPolynomial::kSaturated, v - 0.5f)};
    return {0.f, 0.f, (v - 0.5f) / std::sqrt(spread)};
  }
  const Table& the_table = table();
  const int n = the_table.resolution;
  const int l = rgb[0] >= rgb[1] ? (rgb[0] >= rgb[2] ? 0 : 2) : (rgb[1] >= rgb[2] ? 1 : 2);
  const float z = rgb[l], last = static_cast<float>(n - 1);
  const float x = last * unwarped(rgb[(l + 1) % 3], z), y = last * unwarped(rgb[(l + 2) % 3], z);
  const float w = last * unwarped(z, 1.f), scale = 1.f / std::sqrt(z);
  const int i = std::min(static_cast<int>(x), n - 2), j = std::min(static_cast<int>(y), n - 2);
  const int k = std::min(static_cast<int>(w), n - 2);
  const float fx = x - static_cast<float>(i), fy = y - static_cast<float>(j), fz = w - static_cast<float>(k);

  const int stride_j = 3 * n, stride_k = stride_j * n;
  const float* corner = the_table.coefficients + ((l * n + k) * n + j) * stride_j + i * 3;
  // The three coefficients are interpolated side by side; a fourth number is read with them and ignored.
  using Four = float __attribute__((vector_size(16)));
  const auto node = [](const float* q) {
    Four values;
    std::memcpy(&values, q, sizeof values);
    return values;
  };
  const auto along_x = [&](const float* q) {
    const Four low = node(q);
    return low + fx * (node(q + 3) - low);
  };
  const auto along_y = [&](const float* q) {
    const Four low = along_x(q);
    return low + fy * (along_x(q + stride_j) - low);
  };
  const Four low = along_y(corner), c = scale * (low + fz * (along_y(corner + stride_k) - low));
  return {c[0], c[1], c[2]};
}

}  // namespace

SigmoidSpectrum upsample_srgb(float r, float g, float b) {
  r = clamped(r, 1.f), g = clamped(g, 1.f), b = clamped(b, 1.f);
  if (r == g && g == b) return {look_up({r, g, b}), 1.f};
  const float scale = scale_below_white(r, g, b);
  if (scale < 1.f) return {look_up({(1.f - r) / scale, (1.f - g) / scale, (1.f - b) / scale}), -scale};
  // In this range a sigmoid S, and 1 minus the sigmoid of the complementary colour, are equal except for the
  // errors of the table, which differ. Coefficients are blended, so that spectra do not jump where k becomes
  // 1.
  constexpr float kFrom = 0.3f, kTo = 0.5f;  // range of 1 - min(r, g, b)
  SigmoidPolynomial p = look_up({r, g, b});
  const float weight = (1.f - std::min({r, g, b}) - kFrom) / (kTo - kFrom);
  if (weight < 1.f) {
    const SigmoidPolynomial opposite = look_up({1.f - r, 1.f - g, 1.f - b});
    p.c0 = weight * p.c0 - (1.f - weight) * opposite.c0;
    p.c1 = weight * p.c1 - (1.f - weight) * opposite.c1;
    p.c2 = weight * p.c2 - (1.f - weight) * opposite.c2;
  }
  return {p, 1.f};
}

SigmoidSpectrum upsample_unbounded(float r, float g, float b) {
  constexpr float kMaxValue = 1e37f;  // upper bound, since infinity would become NaN in the division
  r = clamped(r, kMaxValue), g = clamped(g, kMaxValue), b = clamped(b, kMaxValue);
  const float scale = 2.f * std::max({r, g, b});
  if (!(scale > 0.f)) return {};
  return {look_up({r / scale, g / scale, b / scale}), scale};
}

}  // namespace aureole

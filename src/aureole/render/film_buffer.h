// SPDX-License-Identifier: Apache-2.0
// The film's memory: sums in 128-bit fixed point. Their addition is exact and independent of order, so that a
// picture is the same bit for bit, whatever the threads, parts and merges that make it.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

namespace aureole {

using Fixed = __int128;  ///< units of 2^-64

/// Largest magnitude that `to_fixed` accepts. Eight such numbers in units of 2^-64 overflow 128 bits, but
/// real values are many orders of magnitude smaller.
inline constexpr float kFixedLimit = 0x1p60f;
/// Rounds towards zero. It shifts the mantissa, because the built-in conversion is a call, several times
/// slower.
inline Fixed to_fixed(float x) {
  const std::uint32_t bits = std::bit_cast<std::uint32_t>(x);
  const int exponent = int(bits >> 23 & 0xff);
  const std::uint32_t mantissa = (bits & 0x7fffff) | (exponent > 0 ? 0x800000u : 0u);
  const int shift = exponent - 86;  // 64 - 150: x = mantissa 2^(exponent - 150)
  const Fixed magnitude = shift >= 0    ? Fixed(static_cast<unsigned __int128>(mantissa) << (shift & 127))
                          : shift > -24 ? Fixed(mantissa >> -shift)
                                        : Fixed(0);
  return bits >> 31 ? -magnitude : magnitude;
}
inline double from_fixed(Fixed x) { return double(x) * 0x1p-64; }

/// The sums per pixel: the film's measured channels, then alpha, then the sum of filter weights.
class FilmBuffer {
public:
  FilmBuffer() = default;
  FilmBuffer(int width, int height, int measured_channels)
      : width_(width),
        height_(height),
        channels_(measured_channels),
        data_(std::size_t(width) * height * (measured_channels + 2)) {}

  int width() const { return width_; }
  int height() const { return height_; }
  int measured_channels() const { return channels_; }
  int stride() const { return channels_ + 2; }
  Fixed* pixel(int x, int y) { return &data_[(std::size_t(y) * width_ + x) * stride()]; }
  const Fixed* pixel(int x, int y) const { return &data_[(std::size_t(y) * width_ + x) * stride()]; }
  std::vector<Fixed>& data() { return data_; }
  const std::vector<Fixed>& data() const { return data_; }

  /// Adds a block of float sums whose top left pixel is (x0, y0); pixels outside the film are ignored.
  void add(int x0, int y0, int block_width, int block_height, const float* sums) {
    for (int y = 0; y < block_height; ++y) {
      if (y0 + y < 0 || y0 + y >= height_) continue;
      for (int x = 0; x < block_width; ++x) {
        if (x0 + x < 0 || x0 + x >= width_) continue;
        const float* s = sums + (std::size_t(y) * block_width + x) * stride();
        if (s[stride() - 1] == 0) continue;
        Fixed* p = pixel(x0 + x, y0 + y);
        for (int c = 0; c < stride(); ++c) p[c] += to_fixed(s[c]);
      }
    }
  }

  void add(const FilmBuffer& b) {
    for (std::size_t i = 0; i < data_.size(); ++i) data_[i] += b.data_[i];
  }

  /// Weighted means of the measured channels and of alpha of one pixel; zero if the sum of weights is zero.
  void mean(int x, int y, double* measured, double* alpha) const {
    const Fixed* p = pixel(x, y);
    const double w = from_fixed(p[channels_ + 1]);
    const double inverse = w != 0 ? 1 / w : 0;
    for (int c = 0; c < channels_; ++c) measured[c] = from_fixed(p[c]) * inverse;
    *alpha = from_fixed(p[channels_]) * inverse;
  }

  /// Adds to `measured` the weighted means of one pixel's channels, of which this film may have fewer than
  /// `measured`.
  void add_means(int x, int y, double* measured) const {
    const Fixed* p = pixel(x, y);
    const double w = from_fixed(p[channels_ + 1]);
    const double inverse = w != 0 ? 1 / w : 0;
    for (int c = 0; c < channels_; ++c) measured[c] += from_fixed(p[c]) * inverse;
  }

private:
  int width_ = 0, height_ = 0, channels_ = 0;
  std::vector<Fixed> data_;
};

}  // namespace aureole

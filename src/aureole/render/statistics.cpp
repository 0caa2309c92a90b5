// SPDX-License-Identifier: Apache-2.0
#include "aureole/render/statistics.h"

#include <algorithm>
#include <boost/math/distributions/normal.hpp>
#include <cmath>

#include "aureole/core/error.h"

namespace aureole {

Comparison compare_images(const Image& a, const Image& b, double rounding) {
  if (a.width != b.width || a.height != b.height)
    throw Error("the pictures differ in size: " + std::to_string(a.width) + " x " + std::to_string(a.height) +
                " and " + std::to_string(b.width) + " x " + std::to_string(b.height));
  Comparison c;
  for (const auto& name : a.channels)
    if (name != "A" && !name.starts_with("variance.") && b.channel(name) >= 0) c.channels.push_back(name);
  if (c.channels.empty()) throw Error("the pictures have no colour channel in common");

  const double n = double(a.width) * a.height * double(c.channels.size());
  bool variances = true;
  for (const auto& name : c.channels)
    variances &= a.channel("variance." + name) >= 0 || b.channel("variance." + name) >= 0;
  for (const auto& name : c.channels)
    for (int y = 0; y < a.height; ++y)
      for (int x = 0; x < a.width; ++x) {
        const float va = a.at(x, y, size_t(a.channel(name))), vb = b.at(x, y, size_t(b.channel(name)));
        if (!std::isfinite(va) || !std::isfinite(vb)) {
          ++c.not_finite;
          continue;
        }
        c.mean_a += va / n;
        c.mean_b += vb / n;
      }
  ZTest z;
  double variance_of_mean = 0;
  std::size_t noisy = 0;  // values whose noise exceeds rounding: only these have a z^2 of 1 on average
  std::vector<double> zs;
  c.z_map.width = a.width, c.z_map.height = a.height, c.z_map.channels = {"Z"};
  c.z_map.pixels.assign(size_t(a.width) * size_t(a.height), 0.f);
  // A small channel of a saturated colour is a difference of large numbers and has their rounding error.
  const int rgb[3] = {b.channel("R"), b.channel("G"), b.channel("B")};
  const auto largest = [&](int x, int y, int channel) {
    float m = 0;
    if (std::find(rgb, rgb + 3, channel) == rgb + 3) return m;
    for (const int k : rgb)
      if (k >= 0) m = std::max(m, std::abs(b.at(x, y, size_t(k))));
    return m;
  };
  for (const auto& name : c.channels) {
    const size_t ca = size_t(a.channel(name)), cb = size_t(b.channel(name));
    const int va = a.channel("variance." + name), vb = b.channel("variance." + name);
    for (int y = 0; y < a.height; ++y)
      for (int x = 0; x < a.width; ++x) {
        const double d = double(a.at(x, y, ca)) - b.at(x, y, cb), reference = b.at(x, y, cb);
        if (!std::isfinite(d)) continue;
        c.rmse += d * d / n;
        c.relative_mse += d * d / (reference * reference + 1e-2 * c.mean_b * c.mean_b) / n;
        if (std::abs(d) > c.max) c.max = std::abs(d), c.max_x = x, c.max_y = y;
        if (!variances) continue;
        const double variance =
            (va >= 0 ? a.at(x, y, size_t(va)) : 0.0) + (vb >= 0 ? b.at(x, y, size_t(vb)) : 0.0);
        variance_of_mean += variance / (n * n);
        const double floor = rounding * std::max({std::abs(reference), 0.5 * double(largest(x, y, int(cb))),
                                                  0.01 * std::abs(c.mean_b)});
        const double value = d / std::sqrt(variance + floor * floor);
        zs.push_back(value);
        if (variance > 10 * floor * floor) z.mean_square += value * value, ++noisy;
        float& map = c.z_map.at(x, y, 0);
        if (std::abs(value) > std::abs(map)) map = float(value);
      }
  }
  c.rmse = std::sqrt(c.rmse);
  if (!variances) return c;
  z.count = zs.size();
  const double alpha = 1 - std::pow(1 - 0.01, 1.0 / double(z.count));
  const double bound = boost::math::quantile(boost::math::complement(boost::math::normal(), alpha / 2));
  z.mean_square = noisy > 0 ? z.mean_square / double(noisy) : 1;
  for (double v : zs) z.outside += (std::abs(v) > bound) / double(zs.size());
  z.mean_relative = c.mean_b != 0 ? c.mean_a / c.mean_b - 1 : 0;
  z.mean_difference = variance_of_mean > 0 ? (c.mean_a - c.mean_b) / std::sqrt(variance_of_mean) : 0;
  z.is_within =
      c.not_finite == 0 && z.mean_square <= kZMeanSquareMax && z.outside <= kZOutsideMax &&
      (std::abs(z.mean_difference) <= kZMeanStandardErrors || std::abs(z.mean_relative) <= kZMeanRelative);
  z.passes = z.is_within && z.mean_square >= kZMeanSquareMin;
  c.z = z;
  return c;
}

void write_z_map(const Comparison& c, const std::filesystem::path& file) {
  Image image;
  image.width = c.z_map.width, image.height = c.z_map.height;
  image.channels = {"R", "G", "B"};
  image.srgb_encoded = true;
  for (float z : c.z_map.pixels) {
    const float t = std::clamp(z / 4, -1.f, 1.f);
    image.pixels.insert(image.pixels.end(), {t > 0 ? 1.f : 1 + t, 1 - std::abs(t), t < 0 ? 1.f : 1 - t});
  }
  write_png(file, image);
}

}  // namespace aureole

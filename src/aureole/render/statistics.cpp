// SPDX-License-Identifier: Apache-2.0
#include "aureole/render/statistics.h"

#include <algorithm>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <limits>
#include <string_view>

#include "aureole/core/error.h"

namespace aureole {

namespace {

/// Maps a value of Student's t to the normal value of equal probability, by a table over asinh(t).
class NormalOfStudent {
public:
  explicit NormalOfStudent(double degrees_of_freedom) {
    if (!(degrees_of_freedom < kNormal)) return;
    const boost::math::students_t student(degrees_of_freedom);
    for (int i = 0; i <= kNodes; ++i) {
      const double p = boost::math::cdf(boost::math::complement(student, std::sinh(i * kStep)));
      z_.push_back(
          boost::math::quantile(boost::math::complement(boost::math::normal(), std::max(p, 1e-300))));
    }
  }
  double operator()(double t) const {
    if (z_.empty()) return t;
    const double x = std::min(std::asinh(std::abs(t)) / kStep, double(kNodes) - 1);
    const auto i = std::size_t(x);
    return std::copysign(z_[i] + (x - double(i)) * (z_[i + 1] - z_[i]), t);
  }

private:
  static constexpr double
      kNormal = 1000,
      kStep = 0.01;  // degrees of freedom treated as infinite: z^2 is 1.002 on average at 1000
  static constexpr int kNodes = 3000;
  std::vector<double> z_;
};

/// Degrees of freedom of the sum of two estimated variances (Welch 1947, Satterthwaite 1946), whose ratio is
/// taken from the whole channel.
double degrees_of_freedom(double variance_a, double variance_b, const Replicates& n) {
  const auto part = [](double variance, int replicates) {
    return replicates > 1 ? variance * variance / (replicates - 1) : 0;
  };
  const double sum = variance_a + variance_b, parts = part(variance_a, n.a) + part(variance_b, n.b);
  return parts > 0 ? sum * sum / parts : std::numeric_limits<double>::infinity();
}

std::string layer_name(const std::string& channel) {
  const std::size_t dot = channel.rfind('.');
  if (dot != channel.npos) return channel.substr(0, dot);
  return channel == "R" || channel == "G" || channel == "B" || channel == "Y" ? "" : channel;
}

}  // namespace

std::vector<std::string> common_layers(const Image& a, const Image& b) {
  std::vector<std::string> layers;
  for (const std::string& name : a.channels) {
    if (name == "A" || name.ends_with(".A") || name.starts_with("variance.") || b.channel(name) < 0) continue;
    if (std::find(layers.begin(), layers.end(), layer_name(name)) == layers.end())
      layers.push_back(layer_name(name));
  }
  return layers;
}

Image layer_of(const Image& image, const std::string& layer) {
  Image r;
  r.width = image.width, r.height = image.height, r.srgb_encoded = image.srgb_encoded;
  std::vector<std::size_t> from;
  constexpr std::string_view kVariance = "variance.";
  for (std::size_t c = 0; c < image.channel_count(); ++c) {
    std::string name = image.channels[c];
    if (name.starts_with(kVariance)) name = name.substr(kVariance.size());
    if (name != "A" && !name.ends_with(".A") && layer_name(name) == layer)
      from.push_back(c), r.channels.push_back(image.channels[c]);
  }
  for (std::size_t i = 0; i < image.pixels.size(); i += image.channel_count())
    for (const std::size_t c : from) r.pixels.push_back(image.pixels[i + c]);
  return r;
}

Comparison compare_images(const Image& a, const Image& b, double rounding, Replicates replicates) {
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
  // A dark channel of a saturated colour is a difference of large numbers and has their rounding error.
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
    const auto mean_variance = [](const Image& image, int channel) {
      double sum = 0;
      if (channel >= 0)
        for (std::size_t i = std::size_t(channel); i < image.pixels.size(); i += image.channel_count())
          if (std::isfinite(image.pixels[i])) sum += double(image.pixels[i]);
      return sum;
    };
    const double freedom = degrees_of_freedom(mean_variance(a, va), mean_variance(b, vb), replicates);
    z.degrees_of_freedom = std::min(z.degrees_of_freedom, freedom);
    const NormalOfStudent normal(freedom);
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
        const bool is_noisy = variance > 10 * floor * floor;
        double value = d / std::sqrt(variance + floor * floor);
        if (is_noisy) value = normal(value);
        zs.push_back(value);
        if (is_noisy) z.mean_square += value * value, ++noisy;
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
      c.not_finite == 0 && z.mean_square <= kZMeanSquareMax &&
      (z.outside <= kZOutsideMax || !z.judges_values()) &&
      (std::abs(z.mean_difference) <= kZMeanStandardErrors || std::abs(z.mean_relative) <= kZMeanRelative);
  z.passes = z.is_within && z.mean_square >= kZMeanSquareMin && !z.has_too_few_replicates();
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

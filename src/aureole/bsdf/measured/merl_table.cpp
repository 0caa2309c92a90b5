// SPDX-License-Identifier: Apache-2.0
#include "aureole/bsdf/measured/merl_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "aureole/bsdf/measured/half_vector_square.h"
#include "aureole/core/error.h"
#include "aureole/core/input_file.h"

namespace aureole {
namespace {

/// Factors that turn the file's red, green and blue values into the BRDF in 1/sr.
constexpr double kMerlScale[3] = {1.0 / 1500, 1.15 / 1500, 1.66 / 1500};

}  // namespace

MerlTable::MerlTable(const std::filesystem::path& path) {
  InputFile file(path);
  const auto fail = [&](const std::string& message) { return Error({path.string(), 0, 0}, message); };
  std::int32_t sizes[3];
  if (file.size() < sizeof sizes)
    throw fail("too short for a MERL table, which begins with three sizes (int32)");
  file.read(sizes, sizeof sizes);
  for (const std::int32_t n : sizes)
    if (n < 1 || n > 4096)
      throw fail(fmt::format("states the sizes {} x {} x {}; a MERL table has 90 x 90 x 180 (or 360) bins",
                             sizes[0], sizes[1], sizes[2]));
  half_ = std::size_t(sizes[0]), difference_ = std::size_t(sizes[1]), azimuths_ = std::size_t(sizes[2]);
  // Bins of theta_d and phi_d have equal widths, so that their numbers have a fixed ratio.
  if (azimuths_ != 2 * difference_ && azimuths_ != 4 * difference_)
    throw fail(fmt::format(
        "has {} bins of phi_d for {} of theta_d; twice as many (180 degrees) or four times as many (360) "
        "are expected",
        azimuths_, difference_));
  is_full_circle_ = azimuths_ == 4 * difference_;
  const std::uint64_t expected = sizeof sizes + 3 * sizeof(double) * std::uint64_t(bins());
  if (file.size() != expected)
    throw fail(fmt::format("has {} bytes; {} x {} x {} bins of three numbers need {}{}", file.size(),
                           sizes[0], sizes[1], sizes[2], expected,
                           file.size() < expected ? ": the file is truncated" : ""));
  file.require_at_most(expected);
  values_.resize(3 * bins());
  std::vector<double> part(std::min<std::size_t>(bins(), 1 << 16));
  std::vector<bool> is_missing(bins());
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t first = 0; first < bins(); first += part.size()) {
      const std::size_t count = std::min(part.size(), bins() - first);
      file.read(part.data(), count * sizeof(double));
      for (std::size_t i = 0; i < count; ++i) {
        const double value = part[i] * kMerlScale[c];
        if (!std::isfinite(value) || value > 1e30)
          throw fail(fmt::format("number {} of channel {} is not finite", first + i + 1, c + 1));
        if (value < 0) is_missing[first + i] = true;
        values_[3 * (first + i) + c] = float(value);
      }
    }
  for (std::size_t i = 0; i < bins(); ++i)
    if (is_missing[i]) std::fill_n(values_.begin() + std::ptrdiff_t(3 * i), 3, 0.f), ++missing_;
}

std::array<float, 3> MerlTable::rgb(const Vec3& wi, const Vec3& wo, bool is_linear) const {
  const Vec3 h = normalize(wi + wo);
  const float sine = std::sqrt(h.x * h.x + h.y * h.y);
  const float cos_phi = sine > 0 ? h.x / sine : 1.f, sin_phi = sine > 0 ? h.y / sine : 0.f;
  // Components of wi in the frame of the half vector.
  const float x = (wi.x * cos_phi + wi.y * sin_phi) * h.z - wi.z * sine, y = wi.y * cos_phi - wi.x * sin_phi,
              z = dot(wi, h);
  const float theta_h = angle_above_axis(sine, h.z), theta_d = angle_above_axis(std::sqrt(x * x + y * y), z);
  float phi_d = azimuth_of({x, y, 0});
  if (phi_d < 0) phi_d += is_full_circle_ ? 2 * kPi : kPi;
  const float at_h = std::sqrt(theta_h * (2 * kInvPi)) * float(half_),
              at_d = theta_d * (2 * kInvPi) * float(difference_),
              at_p = phi_d * (is_full_circle_ ? 0.5f * kInvPi : kInvPi) * float(azimuths_);
  const auto node = [&](std::size_t i, std::size_t j, std::size_t k) {
    return values_.data() + 3 * ((i * difference_ + j) * azimuths_ + k);
  };
  const auto bin = [](float t, std::size_t n) {
    return t > 0 ? std::min(std::size_t(t), n - 1) : std::size_t(0);
  };
  std::array<float, 3> sum{};
  if (!is_linear) {
    const float* v = node(bin(at_h, half_), bin(at_d, difference_), bin(at_p, azimuths_));
    return {v[0], v[1], v[2]};
  }
  struct Pair {
    std::size_t index[2];
    float weight[2];
  };
  const auto between = [&](float t, std::size_t n, bool is_periodic) {
    const float centre = t - 0.5f, low = std::floor(centre), f = centre - low;
    const auto wrapped = [&](float i) {
      if (is_periodic) return std::size_t(i < 0 ? i + float(n) : i >= float(n) ? i - float(n) : i) % n;
      return i < 0 ? std::size_t(0) : std::min(std::size_t(i), n - 1);
    };
    return Pair{{wrapped(low), wrapped(low + 1)}, {1 - f, f}};
  };
  const Pair i = between(at_h, half_, false), j = between(at_d, difference_, false),
             k = between(at_p, azimuths_, true);
  for (int corner = 0; corner < 8; ++corner) {
    const int a = corner & 1, b = corner >> 1 & 1, c = corner >> 2;
    const float weight = i.weight[a] * j.weight[b] * k.weight[c];
    const float* v = node(i.index[a], j.index[b], k.index[c]);
    for (std::size_t channel = 0; channel < 3; ++channel) sum[channel] += weight * v[channel];
  }
  return sum;
}

}  // namespace aureole

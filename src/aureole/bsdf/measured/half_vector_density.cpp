// SPDX-License-Identifier: Apache-2.0
#include "aureole/bsdf/measured/half_vector_density.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "aureole/bsdf/measured/half_vector_square.h"
#include "aureole/core/parallel.h"

namespace aureole {
namespace {

/// Probability of a cosine-distributed direction, which bounds value / pdf where the table misses a lobe.
constexpr float kCosinePart = 0.05f;

/// Largest angle of incidence of the table, less than 90 degrees, at which nothing is reflected.
constexpr float kLargestAngle = 0.998f * 0.5f * kPi;

}  // namespace

HalfVectorDensity::HalfVectorDensity(const Resolution& r,
                                     const std::function<float(const Vec3& wi, const Vec3& wo)>& value)
    : is_isotropic_(r.azimuths == 1) {
  for (int i = 0; i < r.azimuths; ++i)
    nodes_.first.push_back(r.azimuths == 1 ? 0.f : kPi * (2 * float(i) / float(r.azimuths - 1) - 1));
  for (int i = 0; i < r.angles; ++i) nodes_.second.push_back(kLargestAngle * float(i) / float(r.angles - 1));
  const std::size_t width = std::size_t(r.width), height = std::size_t(r.height), area = width * height;
  std::vector<float> values(nodes_.count() * area);
  std::vector<double> fractions(nodes_.count());
  const auto fill_slice = [&](std::size_t slice) {
    const float phi = nodes_.first[slice / nodes_.second.size()],
                theta = nodes_.second[slice % nodes_.second.size()];
    const Vec3 wi{std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
    const auto at = [&](float u, float v) {
      Vec3 m = square_to_half_vector({std::clamp(u, 0.f, 1.f), v - std::floor(v)});
      const float sine = std::sqrt(m.x * m.x + m.y * m.y);
      if (is_isotropic_)
        m = {m.x * std::cos(phi) - m.y * std::sin(phi), m.y * std::cos(phi) + m.x * std::sin(phi), m.z};
      const float cosine = dot(wi, m);
      const Vec3 wo = 2 * cosine * m - wi;
      return cosine > 0 && wo.z > 0 ? value(wi, wo) * half_vector_area(u, sine) * 4 * cosine : 0.f;
    };
    const float du = 0.25f / float(width - 1), dv = 0.25f / float(height - 1);
    for (std::size_t y = 0; y < height; ++y)
      for (std::size_t x = 0; x < width; ++x) {
        const float u = float(x) / float(width - 1), v = float(y) / float(height - 1);
        // Each node averages the cells around it, so that no lobe between two nodes is missed.
        float sum = 0;
        for (const float a : {-du, du})
          for (const float b : {-dv, dv}) sum += at(u + a, v + b);
        values[slice * area + y * width + x] = 0.25f * sum;
        const bool on_rim_x = x == 0 || x + 1 == width, on_rim_y = y == 0 || y + 1 == height;
        fractions[slice] += double(0.25f * sum) * (on_rim_x ? 0.5 : 1) * (on_rim_y ? 0.5 : 1) /
                            (double(width - 1) * double(height - 1));
      }
  };
  for_ranges(
      nodes_.count(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t slice = begin; slice < end; ++slice) fill_slice(slice);
      },
      1);
  warp_ = BilinearWarp(r.width, r.height, nodes_.count(), values);
  for (std::size_t j = 0; j < nodes_.second.size(); ++j) {
    energies_.push_back({double(nodes_.second[j]), 0});
    for (std::size_t i = 0; i < nodes_.first.size(); ++i)
      energies_.back().fraction =
          std::max(energies_.back().fraction, fractions[i * nodes_.second.size() + j]);
  }
}

HalfVectorDensity::Incidence HalfVectorDensity::incidence(const Vec3& wi) const {
  const float sine = std::sqrt(wi.x * wi.x + wi.y * wi.y);
  Incidence i{nodes_.at(is_isotropic_ ? 0.f : azimuth_of(wi), angle_above_axis(sine, wi.z)), 1, 0};
  if (is_isotropic_ && sine > 0) i.cos_phi = wi.x / sine, i.sin_phi = wi.y / sine;
  return i;
}

float HalfVectorDensity::pdf(const Vec3& wi, const Vec3& wo) const {
  const Incidence i = incidence(wi);
  Vec3 m = normalize(wi + wo);
  const float cosine = dot(wi, m), sine = std::sqrt(m.x * m.x + m.y * m.y);
  m = {m.x * i.cos_phi + m.y * i.sin_phi, m.y * i.cos_phi - m.x * i.sin_phi, m.z};
  const Vec2 square = half_vector_to_square(m);
  const float table =
      cosine > 0 ? warp_.pdf(square, i.blend) / (half_vector_area(square.x, sine) * 4 * cosine) : 0.f;
  return (1 - kCosinePart) * table + kCosinePart * cosine_hemisphere_pdf(wo.z);
}

Vec3 HalfVectorDensity::sample(const Vec3& wi, Vec2 u) const {
  if (u.x < kCosinePart) return square_to_cosine_hemisphere({remap_below(u.x, kCosinePart), u.y});
  const Incidence i = incidence(wi);
  const Vec3 m = square_to_half_vector(warp_.sample({remap_above(u.x, kCosinePart), u.y}, i.blend).p);
  const Vec3 turned{m.x * i.cos_phi - m.y * i.sin_phi, m.y * i.cos_phi + m.x * i.sin_phi, m.z};
  return 2 * dot(wi, turned) * turned - wi;
}

std::string energy_note(const std::vector<HalfVectorDensity::Energy>& energies) {
  const auto largest = std::max_element(energies.begin(), energies.end(),
                                        [](const auto& a, const auto& b) { return a.fraction < b.fraction; });
  if (largest == energies.end() || largest->fraction < 1.005) return "";
  return fmt::format(
      "the table reflects {:.1f} % of the light that arrives at {:.0f} degrees; it is used as it is",
      100 * largest->fraction, largest->theta / kDegree);
}

}  // namespace aureole

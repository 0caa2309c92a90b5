// SPDX-License-Identifier: Apache-2.0
#include "aureole/emitter/directions/intensity_sampler.h"

#include <algorithm>
#include <cmath>

namespace aureole {

namespace {

/// Divides the intervals of increasing angles [degrees] so that none is wider than `step`.
std::vector<double> divide_angles(const std::vector<double>& angles, double step) {
  std::vector<double> all{angles.front()};
  for (std::size_t i = 1; i < angles.size(); ++i) {
    const int parts = std::max(1, int(std::ceil((angles[i] - angles[i - 1]) / step - 1e-9)));
    for (int k = 1; k <= parts; ++k) all.push_back(std::lerp(angles[i - 1], angles[i], double(k) / parts));
  }
  return all;
}

}  // namespace

IntensitySampler::IntensitySampler(const optics::IntensityDistribution& d) : axes_(d.axes()) {
  // Largest size of a cell in degrees, within which the intensity of usual luminaires varies little.
  constexpr double kAzimuthStep = 5, kPolarStep = 1;
  constexpr std::size_t kMostDivided = 1 << 17;
  std::vector<double> azimuths = d.is_rotational() ? std::vector<double>{0, 360} : d.azimuths();
  std::vector<double> polar = d.polar_angles();
  const std::vector<double> fine_azimuths =
                                d.is_rotational() ? azimuths : divide_angles(azimuths, kAzimuthStep),
                            fine_polar = divide_angles(polar, kPolarStep);
  if (fine_azimuths.size() * fine_polar.size() <= kMostDivided) azimuths = fine_azimuths, polar = fine_polar;
  constexpr double kRadians = M_PI / 180;
  for (const double a : azimuths) azimuths_.push_back(a * kRadians);
  for (const double p : polar) cosines_.push_back(std::cos(p * kRadians));
  const std::size_t columns = azimuths.size() - 1, rows = polar.size() - 1;
  std::vector<float> weights;
  weights.reserve(columns * rows);
  for (std::size_t j = 0; j < rows; ++j)
    for (std::size_t i = 0; i < columns; ++i) {
      // The corners are moved slightly into the cell, so that the table's last angles count as inside.
      double mean = 0;
      for (const double a : {azimuths[i], azimuths[i + 1]})
        for (const double p : {polar[j], polar[j + 1]}) mean += 0.25 * d.at(a, p);
      weights.push_back(float(mean * solid_angle(i, j)));
    }
  cells_ = Piecewise2D(weights, int(columns), int(rows));
}

double IntensitySampler::solid_angle(std::size_t column, std::size_t row) const {
  return (azimuths_[column + 1] - azimuths_[column]) * (cosines_[row] - cosines_[row + 1]);
}

Vec3 IntensitySampler::sample(Vec2 u, float* pdf) const {
  float density = 0;
  const Vec2 p = cells_.sample(u, &density);
  const std::size_t columns = azimuths_.size() - 1, rows = cosines_.size() - 1;
  const double x = double(p.x) * double(columns), y = double(p.y) * double(rows);
  const std::size_t i = std::min(std::size_t(x), columns - 1), j = std::min(std::size_t(y), rows - 1);
  const double area = solid_angle(i, j);
  *pdf = area > 0 ? float(double(density) / (double(columns * rows) * area)) : 0;
  const double azimuth = std::lerp(azimuths_[i], azimuths_[i + 1], x - double(i)),
               cosine = std::lerp(cosines_[j], cosines_[j + 1], y - double(j)),
               sine = std::sqrt(std::max(0.0, (1 - cosine) * (1 + cosine)));
  float d[3];
  for (std::size_t k = 0; k < 3; ++k)
    d[k] = float(cosine * axes_.pole[k] +
                 sine * (std::cos(azimuth) * axes_.zero[k] + std::sin(azimuth) * axes_.quarter[k]));
  return normalize(Vec3{d[0], d[1], d[2]});
}

float IntensitySampler::pdf(const Vec3& local) const {
  const auto along = [&](const optics::LuminaireVector& axis) {
    return double(local.x) * axis[0] + double(local.y) * axis[1] + double(local.z) * axis[2];
  };
  const double x = along(axes_.zero), y = along(axes_.quarter), z = along(axes_.pole);
  const double cosine = z / std::sqrt(x * x + y * y + z * z), turn = 2 * M_PI;
  double azimuth = std::atan2(y, x);
  azimuth -= turn * std::floor((azimuth - azimuths_.front()) / turn);
  if (!(azimuth <= azimuths_.back() && cosine <= cosines_.front() && cosine >= cosines_.back())) return 0;
  const auto column = std::upper_bound(azimuths_.begin(), azimuths_.end(), azimuth) - azimuths_.begin(),
             row = std::upper_bound(cosines_.begin(), cosines_.end(), cosine, std::greater<>()) -
                   cosines_.begin();
  const std::size_t columns = azimuths_.size() - 1, rows = cosines_.size() - 1;
  const std::size_t i = std::min(std::size_t(column), columns) - 1, j = std::min(std::size_t(row), rows) - 1;
  const double area = solid_angle(i, j);
  if (!(area > 0)) return 0;
  const Vec2 middle{float((double(i) + 0.5) / double(columns)), float((double(j) + 0.5) / double(rows))};
  return float(double(cells_.pdf(middle)) / (double(columns * rows) * area));
}

}  // namespace aureole

// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/photometry/intensity_distribution.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "aureole/optics/constants.h"

namespace aureole::optics {

namespace {

/// The cell of an increasing table that contains x, and the position of x in it from 0 to 1.
struct CellOfTable {
  std::size_t index = 0;
  double fraction = 0;
  bool is_inside = false;
};

CellOfTable find_cell(const std::vector<double>& table, double x) {
  if (!(x >= table.front() && x <= table.back())) return {};
  if (table.size() == 1) return {0, 0, true};
  const auto above = std::upper_bound(table.begin(), table.end(), x) - table.begin();
  const std::size_t i = std::min(std::size_t(above), table.size() - 1) - 1;
  return {i, (x - table[i]) / (table[i + 1] - table[i]), true};
}

void require_increasing(const std::vector<double>& angles, double min, double max, const char* name) {
  if (angles.empty()) throw std::domain_error(std::string("there are no ") + name);
  for (std::size_t i = 0; i < angles.size(); ++i) {
    if (!(angles[i] >= min && angles[i] <= max))
      throw std::domain_error(std::string(name) + " are out of their range");
    if (i > 0 && !(angles[i] > angles[i - 1])) throw std::domain_error(std::string(name) + " must increase");
  }
}

/// Integrals of (1 - t) sin(angle) and t sin(angle) over angles in [a, b] rad, with t = (angle - a) / (b -
/// a).
struct SineWeights {
  double first, second;

  SineWeights(double a, double b) {
    const double h = b - a;
    // the integral of sin, cos a - cos b
    const double whole = 2 * std::sin(0.5 * (a + b)) * std::sin(0.5 * h);
    // The integral of (x - a) sin x is sin b - sin a - h cos b.
    double moment = std::sin(b) - std::sin(a) - h * std::cos(b);
    // For short intervals the difference loses digits, and two terms of its series are exact.
    if (h < 1e-3) moment = h * h * (0.5 * std::sin(a) + h * std::cos(a) / 3);
    second = moment / h;
    first = whole - second;
  }
};

}  // namespace

PhotometricAxes photometric_axes(PhotometricType type) {
  switch (type) {
    case PhotometricType::a:
      return {{0, 1, 0}, {0, 0, 1}, {-1, 0, 0}};
    case PhotometricType::b:
      return {{-1, 0, 0}, {0, 0, 1}, {0, 1, 0}};
    default:
      return {{0, 0, 1}, {1, 0, 0}, {0, -1, 0}};
  }
}

IntensityDistribution::IntensityDistribution(const PhotometricAxes& axes, std::vector<double> azimuths,
                                             std::vector<double> polar_angles, std::vector<double> candela)
    : axes_(axes),
      azimuths_(std::move(azimuths)),
      polar_angles_(std::move(polar_angles)),
      candela_(std::move(candela)) {
  require_increasing(azimuths_, -360, 360, "azimuths");
  require_increasing(polar_angles_, 0, 180, "polar angles");
  if (azimuths_.back() - azimuths_.front() > 360)
    throw std::domain_error("azimuths span more than a full circle");
  if (candela_.size() != azimuths_.size() * polar_angles_.size())
    throw std::domain_error("the number of intensities is not that of the angles");
  for (const double cd : candela_)
    if (!(cd >= 0 && std::isfinite(cd)))
      throw std::domain_error("intensities must be finite and not negative");
}

LuminaireVector IntensityDistribution::direction(double azimuth, double polar_angle) const {
  const double s = std::sin(polar_angle * kDegree), c = std::cos(polar_angle * kDegree),
               x = s * std::cos(azimuth * kDegree), y = s * std::sin(azimuth * kDegree);
  LuminaireVector d;
  for (std::size_t i = 0; i < 3; ++i) d[i] = c * axes_.pole[i] + x * axes_.zero[i] + y * axes_.quarter[i];
  return d;
}

double IntensityDistribution::intensity(const LuminaireVector& d) const {
  const auto along = [&](const LuminaireVector& axis) {
    return d[0] * axis[0] + d[1] * axis[1] + d[2] * axis[2];
  };
  const double x = along(axes_.zero), y = along(axes_.quarter);
  return at(std::atan2(y, x) / kDegree, std::atan2(std::hypot(x, y), along(axes_.pole)) / kDegree);
}

double IntensityDistribution::at(double azimuth, double polar_angle) const {
  CellOfTable column{0, 0, true};
  if (!is_rotational()) {
    const double low = azimuths_.front();
    azimuth -= 360 * std::floor((azimuth - low) / 360);
    // Tolerance at the seam, since directions there are computed with rounding errors.
    constexpr double kSeam = 1e-9;
    if (azimuth > azimuths_.back() && azimuth < azimuths_.back() + kSeam) azimuth = azimuths_.back();
    if (azimuth > low + 360 - kSeam && azimuths_.back() < azimuth) azimuth = low;
    column = find_cell(azimuths_, azimuth);
  }
  const CellOfTable row = find_cell(polar_angles_, polar_angle);
  if (!column.is_inside || !row.is_inside) return 0;
  const auto in_column = [&](std::size_t i) {
    const double a = value(i, row.index);
    return row.fraction > 0 ? a + (value(i, row.index + 1) - a) * row.fraction : a;
  };
  const double a = in_column(column.index);
  return column.fraction > 0 ? a + (in_column(column.index + 1) - a) * column.fraction : a;
}

double IntensityDistribution::flux(double from_polar, double to_polar) const {
  // Mean over each half-plane's azimuths by the trapezoidal rule, which is exact for linear functions.
  const auto over_azimuth = [&](std::size_t row) {
    if (is_rotational()) return 2 * M_PI * value(0, row);
    double sum = 0;
    for (std::size_t i = 0; i + 1 < azimuths_.size(); ++i)
      sum += 0.5 * (azimuths_[i + 1] - azimuths_[i]) * (value(i, row) + value(i + 1, row));
    return sum * kDegree;
  };
  double total = 0;
  double before = over_azimuth(0);
  for (std::size_t j = 0; j + 1 < polar_angles_.size(); ++j) {
    const double after = over_azimuth(j + 1), low = polar_angles_[j], high = polar_angles_[j + 1];
    const double a = std::max(low, from_polar), b = std::min(high, to_polar);
    if (a < b) {
      const SineWeights w(a * kDegree, b * kDegree);
      total += w.first * std::lerp(before, after, (a - low) / (high - low)) +
               w.second * std::lerp(before, after, (b - low) / (high - low));
    }
    before = after;
  }
  return total;
}

double IntensityDistribution::maximum() const { return *std::max_element(candela_.begin(), candela_.end()); }

double IntensityDistribution::widest_angle() const {
  double lowest = 1;
  const auto look_at = [&](std::size_t i, std::size_t j) {
    const std::size_t columns = azimuths_.size(), rows = polar_angles_.size();
    bool shines = false;
    for (std::size_t a = i > 0 ? i - 1 : 0; a <= std::min(i + 1, columns - 1); ++a)
      for (std::size_t b = j > 0 ? j - 1 : 0; b <= std::min(j + 1, rows - 1); ++b) shines |= value(a, b) > 0;
    if (shines) lowest = std::min(lowest, direction(azimuths_[i], polar_angles_[j])[2]);
  };
  for (std::size_t i = 0; i < azimuths_.size(); ++i)
    for (std::size_t j = 0; j < polar_angles_.size(); ++j) look_at(i, j);
  if (is_rotational() && axes_.pole[2] != 1) return M_PI;  // tables about another axis may reach any angle
  return std::acos(std::max(lowest, -1.0));
}

void IntensityDistribution::scale(double factor) {
  for (double& cd : candela_) cd *= factor;
}

}  // namespace aureole::optics

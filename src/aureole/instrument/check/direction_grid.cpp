// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/check/direction_grid.h"

#include <algorithm>
#include <cmath>

namespace aureole {

std::size_t DirectionGrid::find(const Vec3& d) const {
  double turn = std::atan2(double(d.y), double(d.x)) / (2 * M_PI);
  if (turn < 0) turn += 1;
  const int row = std::min(rows_ - 1, int((1 - double(d.z)) / 2 * rows_));
  const int column = std::min(columns_ - 1, int(turn * columns_));
  return std::size_t(row * columns_ + column);
}

std::vector<double> DirectionGrid::integrate(const std::function<double(const Vec3&)>& density,
                                             int fine) const {
  std::vector<double> masses(size());
  const int rows = rows_ * fine, columns = columns_ * fine;
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < columns; ++j) {
      const double z = 1 - 2 * (i + 0.5) / rows, phi = 2 * M_PI * (j + 0.5) / columns;
      const double r = std::sqrt(1 - z * z);
      const Vec3 d{float(r * std::cos(phi)), float(r * std::sin(phi)), float(z)};
      masses[find(d)] += density(d) * 4 * M_PI / (double(rows) * columns);
    }
  return masses;
}

Vec3 fibonacci_direction(int k, int n) {
  const double z = 1 - (2 * k + 1.0) / n, phi = 2 * M_PI * k * 0.61803398874989485, r = std::sqrt(1 - z * z);
  return {float(r * std::cos(phi)), float(r * std::sin(phi)), float(z)};
}

}  // namespace aureole

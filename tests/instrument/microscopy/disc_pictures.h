// SPDX-License-Identifier: Apache-2.0
// Pictures of hard discs (and other shapes on the same places) as a microscope would give them, with all
// that is known about them.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "aureole/instrument/microscopy/micrograph.h"

namespace aureole::test {

struct Disc {
  double x, y, radius, angle;
};

/// Equilibrium hard discs of one radius in a periodic square: Metropolis moves from a hexagonal lattice,
/// which melts at these densities within some tens of sweeps.
inline std::vector<Disc> hard_discs(double area_fraction, double radius, double& side, int wanted,
                                    unsigned seed, int sweeps = 400) {
  const int columns = std::max(4, int(std::lround(std::sqrt(wanted * std::sqrt(3) / 2)))) / 2 * 2;
  const int rows = std::max(4, int(std::lround(columns * 2 / std::sqrt(3)))) / 2 * 2, n = columns * rows;
  side = std::sqrt(n * M_PI * radius * radius / area_fraction);
  std::vector<Disc> d;
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i)
      d.push_back({(i + 0.5 * (j % 2) + 0.25) * side / columns, (j + 0.5) * side / rows, radius, 0});
  const int cells = std::max(3, int(side / (2 * radius)));
  std::vector<std::vector<int>> cell(size_t(cells) * cells);
  const auto wrap = [&](double v) { return v - side * std::floor(v / side); };
  const auto cell_of = [&](double x, double y) {
    return size_t(std::min(int(y / side * cells), cells - 1)) * cells +
           size_t(std::min(int(x / side * cells), cells - 1));
  };
  for (int i = 0; i < n; ++i) cell[cell_of(d[size_t(i)].x, d[size_t(i)].y)].push_back(i);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> u(-1, 1);
  const double step = radius * std::min(1.0, 0.35 / area_fraction);
  for (long move = 0; move < long(sweeps) * n; ++move) {
    const int i = int(random() % unsigned(n));
    Disc& a = d[size_t(i)];
    const double x = wrap(a.x + step * u(random)), y = wrap(a.y + step * u(random));
    const int cx = int(cell_of(x, y)) % cells, cy = int(cell_of(x, y)) / cells;
    bool free = true;
    for (int j = -1; j <= 1 && free; ++j)
      for (int k = -1; k <= 1 && free; ++k)
        for (const int o :
             cell[size_t((cy + j + cells) % cells) * cells + size_t((cx + k + cells) % cells)]) {
          if (o == i) continue;
          double dx = std::abs(d[size_t(o)].x - x), dy = std::abs(d[size_t(o)].y - y);
          dx = std::min(dx, side - dx), dy = std::min(dy, side - dy);
          if (dx * dx + dy * dy < 4 * radius * radius) free = false;
        }
    if (!free) continue;
    auto& from = cell[cell_of(a.x, a.y)];
    from.erase(std::find(from.begin(), from.end(), i));
    cell[cell_of(x, y)].push_back(i);
    a.x = x, a.y = y;
  }
  for (Disc& a : d) a.angle = M_PI * u(random);
  return d;
}

struct PictureOptions {
  int width = 512, height = 512;
  bool bright = false;
  double blur = 1, noise = 0.04, shading = 0.3;  ///< pixels; of the contrast; of the brightness across
  double low = 0.25, high = 0.7;                 ///< grey levels in the middle
  int levels = 255;                              ///< of the file: 255 or 65535
  unsigned seed = 7;
  /// Inside (1) or outside of a shape of unit area-radius at (x, y) from its centre; discs if empty.
  std::function<bool(double, double)> shape;
};

/// The discs that the picture shows, some in part. A picture cuts a window out of the periodic square.
inline Micrograph picture_of(const std::vector<Disc>& discs, double side, const PictureOptions& o) {
  constexpr int kSub = 5;
  const int w = o.width, h = o.height;
  std::vector<double> cover(size_t(w) * h, 0);
  for (const Disc& d : discs)
    for (int sy = -1; sy <= 1; ++sy)
      for (int sx = -1; sx <= 1; ++sx) {
        const double cx = d.x + sx * side, cy = d.y + sy * side, reach = (o.shape ? 2 : 1) * d.radius + 1;
        for (int y = std::max(0, int(cy - reach)); y < std::min(h, int(cy + reach) + 1); ++y)
          for (int x = std::max(0, int(cx - reach)); x < std::min(w, int(cx + reach) + 1); ++x) {
            const double far = std::hypot(x + 0.5 - cx, y + 0.5 - cy) - d.radius;
            double in = 0;
            if (!o.shape && std::abs(far) > 0.75) {
              in = far < 0;
            } else {
              for (int j = 0; j < kSub; ++j)
                for (int i = 0; i < kSub; ++i) {
                  const double px = x + (i + 0.5) / kSub - cx, py = y + (j + 0.5) / kSub - cy;
                  if (o.shape) {
                    const double c = std::cos(d.angle), s = std::sin(d.angle);
                    in += o.shape((c * px + s * py) / d.radius, (c * py - s * px) / d.radius);
                  } else {
                    in += std::hypot(px, py) < d.radius;
                  }
                }
              in /= kSub * kSub;
            }
            double& at = cover[size_t(y) * w + x];
            at = std::min(1.0, at + in);
          }
      }
  const int reach = int(4 * o.blur) + 1;
  std::vector<double> gaussian;
  for (int k = -reach; k <= reach; ++k) gaussian.push_back(std::exp(-0.5 * k * k / (o.blur * o.blur)));
  const auto blur = [&](int dx, int dy) {
    std::vector<double> out(cover.size());
    for (int y = 0; y < h; ++y)
      for (int x = 0; x < w; ++x) {
        double sum = 0, weight = 0;
        for (int k = -reach; k <= reach; ++k) {
          const double g = gaussian[size_t(k + reach)];
          const int i = std::clamp(x + k * dx, 0, w - 1), j = std::clamp(y + k * dy, 0, h - 1);
          sum += g * cover[size_t(j) * w + i], weight += g;
        }
        out[size_t(y) * w + x] = sum / weight;
      }
    cover = std::move(out);
  };
  if (o.blur > 0) blur(1, 0), blur(0, 1);
  std::mt19937 random(o.seed);
  std::normal_distribution<double> normal;
  Micrograph m;
  m.name = "picture", m.width = w, m.height = h, m.pixel_m = 0.2e-6;
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      const double c = cover[size_t(y) * w + x], particle = o.bright ? o.high : o.low,
                   ground = o.bright ? o.low : o.high;
      // Darker towards a corner and away from a spot.
      const double sx = double(x) / w, sy = double(y) / h;
      const double light =
          1 - o.shading * (0.6 * sx * sy + 0.4 * ((sx - 0.4) * (sx - 0.4) + (sy - 0.3) * (sy - 0.3)) * 2);
      double v = light * (ground + (particle - ground) * c) + o.noise * (o.high - o.low) * normal(random);
      v = std::round(std::clamp(v, 0.0, 1.0) * o.levels) / o.levels;
      m.grey.push_back(float(v));
    }
  return m;
}

}  // namespace aureole::test

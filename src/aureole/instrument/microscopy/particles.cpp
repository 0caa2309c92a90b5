// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/microscopy/particles.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace aureole {
namespace {

struct Sums {
  double area = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0;
  int left = 1 << 30, right = -1, top = 1 << 30, bottom = -1;
  bool touching = false;
};

/// Marching squares over the pixel centres of one particle's coverage, linked to closed loops; the longest
/// loop is the outline. `value(x, y)` must be 0 outside the rectangle.
template <class Value>
Outline level_half(int left, int right, int top, int bottom, const Value& value) {
  // Vertices are on edges between neighbouring centres: (x, y, 0) to the right of a centre, (x, y, 1) below
  // it.
  using Edge = std::array<int, 3>;
  std::map<Edge, Edge> next;
  const auto link = [&](const Edge& a, const Edge& b) { next[a] = b; };
  for (int y = top - 1; y <= bottom; ++y)
    for (int x = left - 1; x <= right; ++x) {
      const bool a = value(x, y) > 0.5f, b = value(x + 1, y) > 0.5f, c = value(x + 1, y + 1) > 0.5f,
                 d = value(x, y + 1) > 0.5f;
      const Edge up{x, y, 0}, right_edge{x + 1, y, 1}, down{x, y + 1, 0}, left_edge{x, y, 1};
      const int code = a + 2 * b + 4 * c + 8 * d;
      // The inside is on the left of the direction of travel, if y is up.
      switch (code) {
        case 1:
          link(left_edge, up);
          break;
        case 2:
          link(up, right_edge);
          break;
        case 3:
          link(left_edge, right_edge);
          break;
        case 4:
          link(right_edge, down);
          break;
        case 5:
          link(left_edge, up), link(right_edge, down);
          break;
        case 6:
          link(up, down);
          break;
        case 7:
          link(left_edge, down);
          break;
        case 8:
          link(down, left_edge);
          break;
        case 9:
          link(down, up);
          break;
        case 10:
          link(up, right_edge), link(down, left_edge);
          break;
        case 11:
          link(down, right_edge);
          break;
        case 12:
          link(right_edge, left_edge);
          break;
        case 13:
          link(right_edge, up);
          break;
        case 14:
          link(up, left_edge);
          break;
        default:
          break;
      }
    }
  const auto point = [&](const Edge& e) -> std::array<double, 2> {
    const double p = value(e[0], e[1]), q = e[2] ? value(e[0], e[1] + 1) : value(e[0] + 1, e[1]);
    const double t = p == q ? 0.5 : std::clamp((0.5 - p) / (q - p), 0.0, 1.0);
    return {e[0] + 0.5 + (e[2] ? 0 : t), e[1] + 0.5 + (e[2] ? t : 0)};
  };
  Outline best;
  while (!next.empty()) {
    Outline loop;
    for (auto at = next.begin(); at != next.end();) {
      loop.push_back(point(at->first));
      const Edge to = at->second;
      next.erase(at);
      at = next.find(to);
    }
    if (loop.size() > best.size()) best = std::move(loop);
  }
  return best;
}

/// The outline with its points averaged over neighbours within `sigma`, so that noise does not lengthen the
/// perimeter.
Outline smoothed(const Outline& outline, double sigma) {
  const size_t n = outline.size();
  std::vector<double> at(n + 1, 0);
  for (size_t i = 0; i < n; ++i) {
    const auto &a = outline[i], &b = outline[(i + 1) % n];
    at[i + 1] = at[i] + std::hypot(b[0] - a[0], b[1] - a[1]);
  }
  const double total = at[n];
  const int reach = std::clamp(int(3 * sigma / (total / double(n))), 1, int(n) / 3);
  Outline out;
  for (int i = 0; i < int(n); ++i) {
    double sum = 0, x = 0, y = 0;
    for (int k = -reach; k <= reach; ++k) {
      const size_t j = size_t((i + k + int(n)) % int(n));
      double d = std::abs(at[j] - at[size_t(i)]);
      d = std::min(d, total - d) / sigma;
      const double w = std::exp(-0.5 * d * d);
      sum += w, x += w * outline[j][0], y += w * outline[j][1];
    }
    out.push_back({x / sum, y / sum});
  }
  return out;
}

void measure_outline(Particle& p, double noise) {
  double perimeter = 0, area = 0;
  const Outline line =
      p.outline.size() < 8 ? p.outline : smoothed(p.outline, p.radius * std::min(0.03 + 0.6 * noise, 0.2));
  for (size_t i = 0; i < line.size(); ++i) {
    const auto &a = line[i], &b = line[(i + 1) % line.size()];
    perimeter += std::hypot(b[0] - a[0], b[1] - a[1]);
    area += 0.5 * (a[0] * b[1] - a[1] * b[0]);
  }
  if (perimeter > 0) p.circularity = std::min(4 * M_PI * std::abs(area) / (perimeter * perimeter), 1.0);
  if (area > 0) std::reverse(p.outline.begin(), p.outline.end());
}

}  // namespace

std::vector<Particle> measure_particles(const Segmentation& s, const ObservationWindow& window, int index) {
  const int w = s.width, h = s.height;
  std::vector<Sums> sums(size_t(s.count) + 1);
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      const size_t i = size_t(y) * w + x;
      const int l = s.labels[i];
      if (l == 0) continue;
      Sums& m = sums[size_t(l)];
      // Deep inside a particle, grey values show its texture, not its edge.
      const double v = s.depth[i] > s.band + 1 ? 1.0 : double(s.coverage[i]);
      m.area += v, m.x += v * (x + 0.5), m.y += v * (y + 0.5);
      m.xx += v * (x + 0.5) * (x + 0.5), m.xy += v * (x + 0.5) * (y + 0.5), m.yy += v * (y + 0.5) * (y + 0.5);
      if (!(s.depth[i] > 0)) continue;
      m.left = std::min(m.left, x), m.right = std::max(m.right, x);
      m.top = std::min(m.top, y), m.bottom = std::max(m.bottom, y);
      const auto other = [&](size_t j) {
        if (s.labels[j] != 0 && s.labels[j] != l && s.depth[j] > 0)
          m.touching = sums[size_t(s.labels[j])].touching = true;
      };
      if (x + 1 < w) other(i + 1);
      if (y + 1 < h) other(i + size_t(w));
    }

  std::vector<Particle> particles;
  for (int l = 1; l <= s.count; ++l) {
    const Sums& m = sums[size_t(l)];
    if (!(m.area > 0) || m.right < 0) continue;
    Particle p;
    p.field = index;
    p.area = m.area, p.radius = std::sqrt(m.area / M_PI);
    p.x = m.x / m.area, p.y = m.y / m.area;
    const double xx = m.xx / m.area - p.x * p.x, yy = m.yy / m.area - p.y * p.y,
                 xy = m.xy / m.area - p.x * p.y;
    // Blur and pixel size add the same amount to both moments.
    const double blur2 = s.blur * s.blur + 1.0 / 12;
    const double half = 0.5 * (xx + yy) - blur2, difference = std::hypot(0.5 * (xx - yy), xy);
    p.aspect = half > difference ? std::sqrt((half + difference) / std::max(half - difference, 1e-3)) : 1;
    p.angle = std::fmod(0.5 * std::atan2(2 * xy, xx - yy) * 180 / M_PI + 180, 180.0);
    p.touching = m.touching;
    p.reach = 0.5 * (std::max(m.right - m.left, m.bottom - m.top) + 1) + 1;
    p.cut = window.free(0.5 * (m.left + m.right + 1), 0.5 * (m.top + m.bottom + 1)) < p.reach;
    if (!p.cut) {
      const auto value = [&](int x, int y) -> float {
        if (x < 0 || y < 0 || x >= w || y >= h || s.labels[size_t(y) * w + x] != l) return 0;
        return s.smooth[size_t(y) * w + x];
      };
      p.outline = level_half(m.left, m.right, m.top, m.bottom, value);
      measure_outline(p, s.noise);
    }
    particles.push_back(std::move(p));
  }
  return particles;
}

}  // namespace aureole

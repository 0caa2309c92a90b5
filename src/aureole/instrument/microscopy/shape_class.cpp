// SPDX-License-Identifier: Apache-2.0
// Classifies particles as circular or not, and computes the mean outline of non-circular ones: outlines as
// r(angle) about the centroid, rotated so that their strongest common harmonic agrees, then averaged.
#include <algorithm>
#include <cmath>
#include <complex>

#include "aureole/instrument/microscopy/microstructure.h"

namespace aureole {
namespace {

constexpr int kAngles = 90, kLastHarmonic = 8;
// Limits between round and other particles: discs with a radius of a few pixels and 10 % noise have
// circularity 0.96 and aspect 1.06. A hexagon has circularity 0.907; an ellipse with axes 1.2 : 1 has 0.975
// and 1.2.
constexpr double kRoundCircularity = 0.935, kRoundAspect = 1.13;

double median(std::vector<double> v) {
  std::nth_element(v.begin(), v.begin() + long(v.size() / 2), v.end());
  return v[v.size() / 2];
}

/// Distances of the outline from its centroid by angle, y up, relative to sqrt(area/pi); empty if the outline
/// does not enclose the centroid.
std::vector<double> polar(const Particle& p) {
  std::vector<double> r(kAngles, 0);
  const size_t n = p.outline.size();
  for (size_t i = 0; i < n; ++i) {
    const double ax = p.outline[i][0] - p.x, ay = p.y - p.outline[i][1];
    const double bx = p.outline[(i + 1) % n][0] - p.x, by = p.y - p.outline[(i + 1) % n][1];
    for (int k = 0; k < kAngles; ++k) {
      const double c = std::cos(2 * M_PI * k / kAngles), s = std::sin(2 * M_PI * k / kAngles);
      const double across_a = c * ay - s * ax, across_b = c * by - s * bx;
      if ((across_a > 0) == (across_b > 0)) continue;
      const double t = across_a / (across_a - across_b);
      const double along = (ax + t * (bx - ax)) * c + (ay + t * (by - ay)) * s;
      r[size_t(k)] = std::max(r[size_t(k)], along / p.radius);
    }
  }
  for (const double v : r)
    if (!(v > 0)) return {};
  return r;
}

std::complex<double> harmonic(const std::vector<double>& r, int m) {
  std::complex<double> sum = 0;
  for (int k = 0; k < kAngles; ++k) sum += r[size_t(k)] * std::polar(1.0, -2 * M_PI * m * k / kAngles);
  return sum / double(kAngles);
}

}  // namespace

void classify_shapes(Microstructure& m) {
  std::vector<const Particle*> free;
  for (const bool touching : {false, true}) {
    if (free.size() >= 10) break;
    for (const Particle& p : m.particles)
      if (!p.cut && p.touching == touching && p.outline.size() >= 8) free.push_back(&p);
  }
  if (free.empty()) return;
  std::vector<double> circularity, aspect, area;
  std::complex<double> alignment = 0;
  for (const Particle* p : free) {
    circularity.push_back(p->circularity), aspect.push_back(p->aspect);
    area.push_back(p->area * std::pow(m.fields[size_t(p->field)].pixel_m, 2));
    alignment += std::polar(1.0, 2 * p->angle * M_PI / 180);
  }
  m.circularity = median(circularity), m.aspect = median(aspect);
  m.alignment = std::abs(alignment) / double(free.size());
  m.round = m.circularity >= kRoundCircularity && m.aspect <= kRoundAspect;
  if (m.round) return;

  std::vector<std::vector<double>> outlines;
  double power[kLastHarmonic + 1] = {};
  for (const Particle* p : free) {
    std::vector<double> r = polar(*p);
    if (r.empty()) continue;
    for (int k = 2; k <= kLastHarmonic; ++k) power[k] += std::norm(harmonic(r, k));
    outlines.push_back(std::move(r));
  }
  m.symmetry = int(std::max_element(power + 2, power + kLastHarmonic + 1) - power);
  const double median_radius = std::sqrt(median(area) / M_PI);
  if (!outlines.empty()) {
    std::vector<double> mean(kAngles, 0);
    std::complex<double> phases = 0;
    for (const auto& r : outlines) {
      const std::complex<double> strongest = harmonic(r, m.symmetry);
      phases += std::polar(1.0, -std::arg(strongest));
      const double turn = std::arg(strongest) / m.symmetry * kAngles / (2 * M_PI);
      for (int k = 0; k < kAngles; ++k) {
        // The maximum of the harmonic of r(angle) is at -arg/m of its Fourier coefficient.
        const double at = k - turn, low = std::floor(at);
        const auto value = [&](double i) { return r[size_t((int(i) % kAngles + kAngles) % kAngles)]; };
        mean[size_t(k)] +=
            (value(low) + (at - low) * (value(low + 1) - value(low))) / double(outlines.size());
      }
    }
    m.orientation = std::arg(phases) / m.symmetry * 180 / M_PI;
    double area_of = 0;
    for (int k = 0; k < kAngles; ++k)
      area_of += 0.5 * mean[size_t(k)] * mean[size_t((k + 1) % kAngles)] * std::sin(2 * M_PI / kAngles);
    const double scale = median_radius * std::sqrt(M_PI / area_of);
    for (int k = 0; k < kAngles; ++k)
      m.mean_outline.push_back({scale * mean[size_t(k)] * std::cos(2 * M_PI * k / kAngles),
                                scale * mean[size_t(k)] * std::sin(2 * M_PI * k / kAngles)});
  }
  // The typical outline is the one nearest to the medians of area, circularity and aspect.
  const Particle* typical = nullptr;
  double least = INFINITY;
  for (size_t i = 0; i < free.size(); ++i) {
    const double d = std::abs(std::log(area[i] * M_1_PI) - 2 * std::log(median_radius)) +
                     std::abs(circularity[i] - m.circularity) + std::abs(std::log(aspect[i] / m.aspect));
    if (d < least) least = d, typical = free[i];
  }
  if (!typical) return;
  const double pixel = m.fields[size_t(typical->field)].pixel_m;
  for (const auto& q : typical->outline)
    m.typical_outline.push_back({(q[0] - typical->x) * pixel, (typical->y - q[1]) * pixel});
}

}  // namespace aureole

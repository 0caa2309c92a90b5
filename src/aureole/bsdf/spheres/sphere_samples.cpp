// SPDX-License-Identifier: Apache-2.0
#include "aureole/bsdf/spheres/sphere_samples.h"

#include <array>
#include <numbers>

#include "aureole/math/warp.h"

namespace aureole {
namespace {

constexpr double kPiDouble = std::numbers::pi;

/// Maps half a turn to 1 - x/(|x| + |y|) in [0, 2], which increases with the angle and needs no arctangent.
float pseudo_angle(float x, float y) {
  const float sum = std::abs(x) + std::abs(y);
  return sum > 0 ? 1 - x / sum : 1;
}
double angle_of(double pseudo) { return std::atan2(1 - std::abs(1 - pseudo), 1 - pseudo); }

/// Unit vectors perpendicular to the forward direction -wi: in the plane of incidence as `Scattered::in`, and
/// out of it.
struct Across {
  Vec3 in, out;
  explicit Across(const Vec3& wi) {
    const float sine = std::sqrt(wi.x * wi.x + wi.y * wi.y);
    const Vec2 along = sine > 0 ? Vec2{wi.x / sine, wi.y / sine} : Vec2{1, 0};
    in = {along.x * std::abs(wi.z), along.y * std::abs(wi.z), -std::copysign(sine, wi.z)};
    out = {-along.y, along.x, 0};
  }
};

}  // namespace

SphereSamples::SphereSamples(const SphereAngles& angles, int wavelengths)
    : angles_(angles), wavelengths_(wavelengths) {
  const std::size_t n = std::size_t(angles.cells()), w = std::size_t(wavelengths);
  ring_.resize(kTilts * n * w);
  cdf_.resize(kTilts * (n + 1) * w);
  azimuth_.assign(std::size_t(kTilts) * (kGroups + 1) * kBins * w, 1.f);
}

void SphereSamples::prepare(int wavelength, const std::vector<double>& phase, const Factor& factor) {
  // Weights in the mixture of densities: of one that follows the phase function alone, of a uniform one, and
  // of uniform azimuths. They cover angles and wavelengths between those of the tables.
  constexpr double kPhaseShare = 0.04, kUniformShare = 0.02, kUniformAzimuths = 0.1;
  const std::size_t n = std::size_t(angles_.cells()), w = std::size_t(wavelengths_),
                    at = std::size_t(wavelength);
  std::array<double, kBins> widths, middles;  // widths and middles of the bins of azimuth, over half a turn
  for (int b = 0; b < kBins; ++b) {
    const double from = angle_of(2.0 * b / kBins), to = angle_of(2.0 * (b + 1) / kBins);
    widths[b] = (to - from) / kPiDouble, middles[b] = 0.5 * (from + to);
  }
  std::vector<double> mass(n);
  for (int tilt = 0; tilt < kTilts; ++tilt) {
    const double cosine = tilt == 0 ? 0.02 : double(tilt) / (kTilts - 1);
    const float cos_i = float(cosine), sin_i = float(std::sqrt(1 - cosine * cosine));
    std::vector<std::array<double, kBins>> groups(kGroups + 1);
    double total = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const bool forward = angles_.is_forward(int(i));
      const double r = angles_.radius(angles_.ring(int(i)) + 0.5), other = std::sqrt(4 - r * r);
      auto& bins = groups[std::size_t(group(int(i)))];
      double sum = 0;
      for (int b = 0; b < kBins; ++b) {
        const Scattered s(forward ? r : other, forward ? other : r, middles[b]);
        const double value = factor(s.transverse(cos_i, sin_i), s.cosine(cos_i, sin_i));
        bins[b] += value;
        sum += widths[b] * value;
      }
      mass[i] = angles_.area(int(i)) * 0.5 * (phase[i] + phase[i + 1]) * sum;
      total += mass[i];
    }
    double sum = 0, below = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const double area = angles_.area(int(i));
      mass[i] = (total > 0 ? (1 - kPhaseShare - kUniformShare) * mass[i] / total : 0) +
                kPhaseShare * area * 0.5 * (phase[i] + phase[i + 1]) + kUniformShare * area / (4 * kPiDouble);
      sum += mass[i];
    }
    float* cdf = &cdf_[(std::size_t(tilt) * w + at) * (n + 1)];
    for (std::size_t i = 0; i < n; below += mass[i++]) cdf[i] = float(below / sum);
    cdf[n] = 1;
    // The density is computed from the table as rounded to single precision.
    for (std::size_t i = 0; i < n; ++i)
      ring_[(std::size_t(tilt) * n + i) * w + at] =
          float((double(cdf[i + 1]) - double(cdf[i])) / angles_.area(int(i)));

    for (int g = 0; g < kGroups; ++g) {
      double mean = 0;
      for (int b = 0; b < kBins; ++b) mean += widths[b] * groups[g][b];
      if (!(mean > 0)) continue;
      for (int b = 0; b < kBins; ++b)
        azimuth_[azimuth_row(tilt, g, b) + at] =
            float(kUniformAzimuths + (1 - kUniformAzimuths) * groups[g][b] / mean);
    }
  }
}

SphereSamples::Density SphereSamples::density(const Vec3& wi, const Vec3& wo, int cell) const {
  const int t = tilt(wi.z);
  const Across across(wi);
  const Vec3 sum = wi + wo;
  const float pseudo = pseudo_angle(dot(sum, across.in), dot(sum, across.out));
  const int bin = std::min(int(pseudo * (kBins / 2)), kBins - 1);
  return {
      &ring_[(std::size_t(t) * std::size_t(angles_.cells()) + std::size_t(cell)) * std::size_t(wavelengths_)],
      &azimuth_[azimuth_row(t, group(cell), bin)]};
}

Vec3 SphereSamples::sample(const Vec3& wi, Vec2 u, int wavelength) const {
  static const auto edges = [] {
    std::array<float, kBins + 1> e;
    for (int b = 0; b <= kBins; ++b) e[b] = float(angle_of(2.0 * b / kBins) / (2 * kPiDouble));
    return e;
  }();
  const int t = tilt(wi.z);
  const std::size_t n = std::size_t(angles_.cells());
  const float* cdf = &cdf_[(std::size_t(t) * std::size_t(wavelengths_) + std::size_t(wavelength)) * (n + 1)];
  const int cell = int(std::upper_bound(cdf + 1, cdf + n, u.x) - (cdf + 1));
  const float share = (u.x - cdf[cell]) / std::max(cdf[cell + 1] - cdf[cell], 1e-30f);
  // The position within the ring is uniform over its area.
  const bool forward = angles_.is_forward(cell);
  const float a = float(angles_.radius(angles_.ring(cell))),
              b = float(angles_.radius(angles_.ring(cell) + 1));
  const float r = std::sqrt(a * a + std::clamp(share, 0.f, 1.f) * (b - a) * (b + a)),
              other = std::sqrt(std::max(4 - r * r, 0.f));
  const float cosine = forward ? 1 - 0.5f * r * r : 0.5f * r * r - 1, sine = 0.5f * r * other;

  // The azimuth: a half of the turn, a bin in it, and a uniform position in the bin.
  const float* row = &azimuth_[azimuth_row(t, group(cell), 0) + std::size_t(wavelength)];
  float rest = u.y < 0.5f ? 2 * u.y : 2 * u.y - 1;
  int bin = 0;
  float mass = 0;
  for (;; ++bin) {
    mass = row[std::size_t(bin) * std::size_t(wavelengths_)] * 2 * (edges[bin + 1] - edges[bin]);
    if (rest < mass || bin == kBins - 1) break;
    rest -= mass;
  }
  const float inside = std::clamp(rest / mass, 0.f, 1.f);
  const Vec2 azimuth = cos_sin_2pi(edges[bin] + inside * (edges[bin + 1] - edges[bin]));
  const Across across(wi);
  return normalize(wi * -cosine + across.in * (azimuth.x * sine) +
                   across.out * (u.y < 0.5f ? azimuth.y * sine : -azimuth.y * sine));
}

}  // namespace aureole

// SPDX-License-Identifier: Apache-2.0
// Monte Carlo transport in a half-space, the reference for BSSRDFs. It shares nothing with them or with the renderer:
// photons with a weight, in double precision, scattered by Henyey & Greenstein's phase function (L. Wang, S. Jacques, L.
// Zheng, MCML, Computer Methods and Programs in Biomedicine 47, 1995, has the method).
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

namespace aureole::testing {

/// A half-space of extinction 1, lit by a thin beam along its normal. Light that the surface reflects on the way in does
/// not count.
struct HalfSpace {
  double albedo, g, index;

  double reduced_mean_free_path() const { return 1 / (1 - albedo * g); }
};

/// The part of the light that leaves, by its distance from the beam.
struct RadialProfile {
  std::vector<double> radii;   ///< edges of the rings, increasing, the first is 0
  std::vector<double> leaves;  ///< part of the light that has entered, per ring
  double beyond = 0;           ///< outside of the last ring

  double total() const {
    double sum = beyond;
    for (const double part : leaves) sum += part;
    return sum;
  }
};

inline double reflected_inside(double cosine, double index) {
  const double sin2 = index * index * (1 - cosine * cosine);
  if (sin2 >= 1) return 1;
  const double out = std::sqrt(1 - sin2);
  const double s = (index * cosine - out) / (index * cosine + out);
  const double p = (cosine - index * out) / (cosine + index * out);
  return (s * s + p * p) / 2;
}

inline RadialProfile follow_photons(const HalfSpace& h, std::vector<double> radii, std::size_t photons,
                                    std::uint64_t seed = 1) {
  std::mt19937_64 engine(seed);
  const auto random = [&] { return (double(engine() >> 11) + 0.5) * 0x1p-53; };
  RadialProfile found{std::move(radii), {}, 0};
  found.leaves.assign(found.radii.size() - 1, 0.0);
  const auto leave = [&](double r, double weight) {
    const auto ring = std::upper_bound(found.radii.begin(), found.radii.end(), r) - found.radii.begin();
    (std::size_t(ring) < found.radii.size() ? found.leaves[std::size_t(ring - 1)] : found.beyond) +=
        weight / double(photons);
  };
  for (std::size_t i = 0; i < photons; ++i) {
    // z counts downwards.
    double x = 0, y = 0, z = 0, dx = 0, dy = 0, dz = 1, weight = 1;
    while (weight > 0) {
      const double step = -std::log(random());
      x += dx * step, y += dy * step, z += dz * step;
      while (z < 0) {
        // Where it crossed the surface; a part leaves, the rest is mirrored.
        const double back = z / dz, r = std::hypot(x - dx * back, y - dy * back);
        const double kept = reflected_inside(-dz, h.index);
        leave(r, weight * (1 - kept));
        weight *= kept, z = -z, dz = -dz;
      }
      weight *= h.albedo;
      if (weight < 1e-2) weight = random() < 0.1 ? weight * 10 : 0;
      const double c = h.g == 0 ? 2 * random() - 1 : [&] {
        const double q = (1 - h.g * h.g) / (1 - h.g + 2 * h.g * random());
        return (1 + h.g * h.g - q * q) / (2 * h.g);
      }();
      const double s = std::sqrt(std::max(0.0, 1 - c * c)), phi = 2 * std::numbers::pi * random();
      const double u = s * std::cos(phi), v = s * std::sin(phi), across = std::sqrt(1 - dz * dz);
      if (across < 1e-6) {
        dx = u, dy = v, dz = dz > 0 ? c : -c;
      } else {
        const double ox = dx, oy = dy, oz = dz;
        dx = (ox * oz * u - oy * v) / across + ox * c;
        dy = (oy * oz * u + ox * v) / across + oy * c;
        dz = -across * u + oz * c;
      }
      const double norm = 1 / std::sqrt(dx * dx + dy * dy + dz * dz);
      dx *= norm, dy *= norm, dz *= norm;
    }
  }
  return found;
}

}  // namespace aureole::testing

// SPDX-License-Identifier: Apache-2.0
#include "aureole/bsdf/caps/cap_tables.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "aureole/core/parallel.h"

namespace aureole {
namespace {

constexpr double kTwoPi = 2 * std::numbers::pi;
constexpr float kMinCosine = 1e-3f;
/// Upper bound of the factor N near grazing angles, where the approximation fails.
constexpr float kMaxFactor = 4;

double largest_phase(const CapLayer& layer, const SpectralGrid& grid) {
  return kTwoPi * layer.radius_nm *
         std::max(layer.medium(grid.min_nm) / grid.min_nm, layer.medium(grid.max_nm) / grid.max_nm);
}

double largest_index(const CapLayer& layer, const SpectralGrid& grid) {
  double most = 0;
  for (int i = 0; i <= grid.cells; ++i) most = std::max(most, layer.relative_index(grid.node(i)));
  return most;
}

}  // namespace

CapTables::CapTables(const CapLayer& layer, const SpectralGrid& grid)
    : layer_(layer),
      covered_(float(layer.area_fraction)),
      height_(float(layer.height)),
      structure_scale_(float(std::sqrt(layer.sizes.moment(2)))),
      is_curved_(layer.profile.contact_angle > 0),
      phase_nm_(kTwoPi * layer.radius_nm),
      first_(1 / grid.max_nm),
      scale_((kWavelengthNodes - 1) / (1 / grid.min_nm - 1 / grid.max_nm)),
      structure_([&](double u) { return layer.structure->eval(u) - 1; }, 1024, false),
      // The normal components of both directions differ at most by the index of refraction of the scatterers.
      scatterer_(layer.profile, layer.sizes, 2 * largest_phase(layer, grid),
                 largest_phase(layer, grid) * layer.height * largest_index(layer, grid), for_ranges) {
  density_ = float(layer.area_fraction / (std::numbers::pi * scatterer_.mean_square()));
  waves_.reserve(kWavelengthNodes);
  for (int node = 0; node < kWavelengthNodes; ++node) {
    const Light l = node_light(node);
    // Radial distributions for light that arrives or leaves along the normal, and for light at 60 degrees.
    const auto radial = [&](double u) {
      const float p = std::min(float(u) / l.phase, 0.99f), c = std::sqrt(1 - p * p),
                  w = std::sqrt(std::max(l.index * l.index - p * p, 0.f)),
                  oblique = std::sqrt(std::max(l.index * l.index - 0.75f, 0.f)) - 0.5f;
      float sum = 0;
      for (const float difference : {l.index - c, w - 1, oblique}) {
        const auto i = scatterer_.intensity(float(u), std::abs(l.phase * height_ * difference), l.amplitude);
        sum += (i.uncorrelated + i.coherent * structure(float(u))) / 3;
      }
      return double(sum);
    };
    const int end = std::max(2, int(std::ceil(2 * l.phase)));
    double power = 0;
    for (int i = 0; i < 512; ++i) {
      const double u = (i + 0.5) / 512 * end;
      power += radial(u) * u * end / 512;
    }
    // A small uniform part, for directions where the density of these three angles is too low for other angles of
    // incidence.
    const double uniform = 0.03 * power / (0.5 * end * end);
    const auto density = [&](double u) { return (radial(u) + uniform) * u; };
    waves_.emplace_back(density, end, density(end) * end * end);
  }
  passing_.assign(std::size_t(kWavelengthNodes) * 2 * (kCosines + 1), 0.f);
  reduction_ = passing_;
  mean_back_.assign(std::size_t(kWavelengthNodes) * 2, 0.f);
  for_ranges(
      kWavelengthNodes,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t node = begin; node < end; ++node) sum_scattered(int(node));
      },
      1);
  for (int node = 0; node < kWavelengthNodes; ++node) {
    const Light l = node_light(node);
    for (int side = 0; side < 2; ++side) {
      constexpr int kSteps = 512;
      double sum = 0;
      for (int i = 0; i < kSteps; ++i) {
        const float cosine = (float(i) + 0.5f) / kSteps;
        sum += 2 * double(cosine) / kSteps * double(shares(l, side == 0, cosine).turned_back);
      }
      mean_back_[std::size_t(2 * node + side)] = float(sum);
    }
  }
  layer_ = {};  // needed no longer
}

CapTables::Light CapTables::light(float nm, float medium, float relative_index, float transmittance) const {
  return {float(phase_nm_) * medium / nm, relative_index, std::sqrt(transmittance),
          std::clamp(float((1 / double(nm) - first_) * scale_), 0.f, float(kWavelengthNodes - 1))};
}

CapTables::Light CapTables::node_light(int node) const {
  const double nm = 1 / (first_ + node / scale_);
  Light l = light(float(nm), float(layer_.medium(nm)), float(layer_.relative_index(nm)),
                  float(layer_.transmittance(nm)));
  l.node = float(node);
  return l;
}

/// Sums scattered light over directions of a rank-1 lattice in (cumulative power, azimuth).
void CapTables::sum_scattered(int node) {
  constexpr int kPoints = 4096, n = kCosines + 1;
  constexpr double kGolden = 0.6180339887498949;
  const Light l = node_light(node);
  const optics::RadialDistribution& waves = waves_[std::size_t(node)];
  const double end = 2 * double(l.phase), scale = waves.cdf(end) * double(density_) / kTwoPi / kPoints;
  std::vector<float> us(kPoints), densities(kPoints), cosines(kPoints), sines(kPoints);
  for (std::size_t k = 0; k < kPoints; ++k) {
    const double azimuth = std::numbers::pi * std::fmod((double(k) + 0.5) * kGolden, 1.0);
    us[k] = float(waves.sample((double(k) + 0.5) / kPoints, end));
    densities[k] = waves.eval(us[k]), cosines[k] = float(std::cos(azimuth)),
    sines[k] = float(std::sin(azimuth));
  }
  // power[side][i n + j]: the power scattered from the cosine of node i to node j on the other side.
  std::vector<double> power[2], left[2], s[2];
  for (int side = 0; side < 2; ++side) {
    power[side].assign(std::size_t(n) * n, 0.0);
    s[side].assign(n, 1.0);
    for (int i = 0; i < n; ++i) {
      const float t = float(i) / kCosines, cosine = std::max(t * t, kMinCosine),
                  sine = std::sqrt(1 - cosine * cosine);
      const Vec3 wi{sine, 0, side == 0 ? cosine : -cosine};
      left[side].push_back(std::max(1 - double(undiffracted(l, cosine)) - double(absorbed(l)), 0.0));
      for (std::size_t k = 0; k < kPoints; ++k) {
        const float v = us[k] / l.phase, x = v * cosines[k] - sine, y = v * sines[k], square = x * x + y * y;
        if (!(square < 1)) continue;
        const float z = std::sqrt(1 - square);
        // The density over the plane of u is the radial distribution over 2 pi.
        const double value =
            scale * double(intensity(l, pair(wi, {x, y, side == 0 ? -z : z}))) / double(densities[k]);
        const float position = std::min(std::sqrt(z) * kCosines, kCosines - 1e-3f);
        const int j = int(position);
        power[side][std::size_t(i * n + j)] += value * double(1 - (position - float(j)));
        power[side][std::size_t(i * n + j + 1)] += value * double(position - float(j));
      }
    }
  }
  const auto sum = [&](int side, int i) {
    double all = 0;
    for (int j = 0; j < n; ++j) all += power[side][std::size_t(i * n + j)] * s[1 - side][std::size_t(j)];
    return all;
  };
  for (int iteration = 0; iteration < 60; ++iteration)
    for (int side = 0; side < 2; ++side)
      for (int i = 0; i < n; ++i) {
        double& factor = s[side][std::size_t(i)];
        const double all = sum(side, i), most = left[side][std::size_t(i)];
        factor = std::sqrt(factor * (all > most ? most / all : 1.0));
      }
  for (int side = 0; side < 2; ++side)
    for (int i = 0; i < n; ++i) {
      const double most = left[side][std::size_t(i)], factor = s[side][std::size_t(i)];
      const std::size_t at = std::size_t((2 * node + side) * n + i);
      reduction_[at] = float(factor);
      passing_[at] = float(most > 1e-9 ? std::min(factor * sum(side, i) / most, 1.0) : 1);
    }
}

CapTables::Pair CapTables::pair(const Vec3& wi, const Vec3& wo) {
  const Vec3 &caps = wi.z > 0 ? wi : wo, &flat = wi.z > 0 ? wo : wi;
  return {{caps.x, caps.y},
          {flat.x, flat.y},
          std::max(std::abs(caps.z), kMinCosine),
          std::max(std::abs(flat.z), kMinCosine)};
}

float CapTables::intensity(const Light& l, const Pair& pair) const {
  const float x = pair.on_caps.x + pair.on_flat.x, y = pair.on_caps.y + pair.on_flat.y,
              transverse = std::sqrt(x * x + y * y);
  const float square_sine_flat = 1 - pair.cos_flat * pair.cos_flat;
  const float within = std::sqrt(std::max(l.index * l.index - square_sine_flat, 1e-6f)), c = pair.cos_caps;
  const float difference = within - c;
  // The slope at which light is refracted between the two directions; its sign is that of the difference.
  const float limited = std::copysign(std::max(std::abs(difference), 0.02f), difference);
  const float on_caps = (pair.on_caps.x * x + pair.on_caps.y * y) / limited,
              on_flat = (pair.on_flat.x * x + pair.on_flat.y * y) / limited;
  const float factor =
      is_curved_ ? std::clamp((c - on_caps) * (within + on_flat) / (c * within), 0.f, kMaxFactor) : 1;
  const float u = l.phase * transverse;
  const auto i =
      scatterer_.intensity(u, std::abs(l.phase * height_ * difference), l.amplitude * std::sqrt(factor));
  return i.uncorrelated + i.coherent * structure(u);
}

float CapTables::undiffracted(const Light& l, float cosine) const {
  const float within = std::sqrt(std::max(l.index * l.index - (1 - cosine * cosine), 0.f));
  return scatterer_.undiffracted(std::abs(l.phase * height_ * (within - cosine)), l.amplitude, covered_);
}

float CapTables::look_up(const std::vector<float>& table, const Light& l, bool on_caps, float cosine) const {
  const float x = std::min(std::sqrt(cosine), 1.f) * kCosines;
  const int i = std::min(int(x), kCosines - 1), node = std::min(int(l.node), kWavelengthNodes - 2);
  const float s = x - float(i), t = l.node - float(node);
  const float* row = &table[std::size_t((2 * node + (on_caps ? 0 : 1)) * (kCosines + 1) + i)];
  const float* next = row + 2 * (kCosines + 1);
  const float a = row[0] + s * (row[1] - row[0]), b = next[0] + s * (next[1] - next[0]);
  return a + t * (b - a);
}

CapTables::Shares CapTables::shares(const Light& l, bool from_caps, float cosine) const {
  Shares s;
  s.undiffracted = std::min(undiffracted(l, cosine), 1 - absorbed(l));
  const float rest = std::max(1 - s.undiffracted - absorbed(l), 0.f);
  s.scattered = rest * look_up(passing_, l, from_caps, cosine);
  s.turned_back = rest - s.scattered;
  return s;
}

float CapTables::scattered(const Light& l, const Vec3& wi, const Vec3& wo) const {
  return l.phase * l.phase * float(1 / (kTwoPi * kTwoPi)) * density_ * intensity(l, pair(wi, wo)) *
         std::abs(wo.z) * look_up(reduction_, l, wi.z > 0, std::abs(wi.z)) *
         look_up(reduction_, l, wo.z > 0, std::abs(wo.z));
}

float CapTables::turned_back(const Light& l, float share, const Vec3& wo) const {
  const int node = std::min(int(l.node), kWavelengthNodes - 2), side = wo.z > 0 ? 0 : 1;
  const float t = l.node - float(node);
  const float mean =
      mean_back_[std::size_t(2 * node + side)] * (1 - t) + mean_back_[std::size_t(2 * node + 2 + side)] * t;
  if (!(mean > 0)) return 0;
  return share * shares(l, wo.z > 0, std::abs(wo.z)).turned_back / mean * std::abs(wo.z) *
         float(1 / std::numbers::pi);
}

bool CapTables::sample(const Light& l, const Vec3& wi, Vec2 xi, Vec3& wo) const {
  const double sine = std::sqrt(double(wi.x) * double(wi.x) + double(wi.y) * double(wi.y));
  const optics::RadialDistribution& waves = waves_[std::size_t(l.node + 0.5f)];
  const double u = waves.sample(double(xi.x), double(l.phase) * (1 + sine)) / double(l.phase),
               azimuth = kTwoPi * double(xi.y);
  const double x = u * std::cos(azimuth) - double(wi.x), y = u * std::sin(azimuth) - double(wi.y),
               square = x * x + y * y;
  if (!(square < 1)) return false;
  const double z = std::sqrt(1 - square);
  wo = {float(x), float(y), float(wi.z > 0 ? -z : z)};
  return wo.z != 0;
}

float CapTables::density(const Light& l, const Vec3& wi, const Vec3& wo) const {
  const float sine = std::sqrt(wi.x * wi.x + wi.y * wi.y), x = wi.x + wo.x, y = wi.y + wo.y;
  const optics::RadialDistribution& waves = waves_[std::size_t(l.node + 0.5f)];
  const double whole = waves.cdf(double(l.phase) * (1 + double(sine)));
  return waves.eval(l.phase * std::sqrt(x * x + y * y)) * float(1 / (kTwoPi * whole)) * l.phase * l.phase *
         std::abs(wo.z);
}

std::size_t CapTables::bytes() const {
  std::size_t sum =
      scatterer_.bytes() + structure_.bytes() + sizeof(float) * (2 * passing_.size() + mean_back_.size());
  for (const auto& w : waves_) sum += w.bytes();
  return sum;
}

}  // namespace aureole

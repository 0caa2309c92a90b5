// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/measured/scattering_probe.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "aureole/core/keyed_random.h"
#include "aureole/core/parallel.h"
#include "aureole/math/warp.h"

namespace aureole {
namespace {

/// Points of the R2 sequence, an additive recurrence of low discrepancy (M. Roberts 2018).
Vec2 recurrent_point(std::size_t i) {
  const double x = 0.5 + 0.7548776662466927 * double(i), y = 0.5 + 0.5698402909980532 * double(i);
  return {float(x - std::floor(x)), float(y - std::floor(y))};
}

Vec3 turned(const Vec3& w, double phi) {
  const float c = float(std::cos(phi)), s = float(std::sin(phi));
  return {w.x * c - w.y * s, w.x * s + w.y * c, w.z};
}

Vec3 direction_of(double theta, double phi) {
  return {float(std::sin(theta) * std::cos(phi)), float(std::sin(theta) * std::sin(phi)),
          float(std::cos(theta))};
}

constexpr std::size_t kEnergySamples = 4096, kPairs = 4000;

/// Reflected and transmitted fractions of light from wi, by the BSDF's own samples; each is the largest over
/// the wavelengths.
ScatteringReport::Energy energy_at(const ScatteringProbe& probe, double angle, bool& refracts) {
  const Vec3 wi = direction_of(angle * kDegree, 0.3);
  const SurfacePoint point;
  std::vector<double> reflected(probe.channels()), transmitted(probe.channels());
  const std::size_t sets = (probe.channels() + kWavelengths - 1) / kWavelengths;
  for (std::size_t set = 0; set < sets; ++set)
    for (std::size_t k = 0; k < kEnergySamples; ++k) {
      // Every wavelength is the hero of equally many samples.
      const std::size_t hero = k % kWavelengths;
      const auto channel = [&](std::size_t j) {
        return std::min(set * kWavelengths + (j + hero) % kWavelengths, probe.channels() - 1);
      };
      const Wavelengths w = Wavelengths::at(
          probe.grid(), make_spectrum([&](int j) { return float(probe.nm()[channel(std::size_t(j))]); }));
      const Vec2 u = recurrent_point(k), more = recurrent_point(k * 7 + 3);
      const auto s =
          probe.bsdf().sample(wi, more.x, u, {w, point, TransportMode::importance, std::uint32_t(k)});
      if (!s) continue;
      refracts |= s->eta != 1;
      const float density = mean(s->pdf);
      if (!(density > 0)) continue;
      auto& sums = s->wo.z * wi.z > 0 ? reflected : transmitted;
      std::vector<bool> done(probe.channels());
      for (std::size_t j = 0; j < kWavelengths; ++j)
        if (!done[channel(j)])
          sums[channel(j)] += double(s->value[int(j)] / density) / kEnergySamples, done[channel(j)] = true;
    }
  ScatteringReport::Energy e{angle, 0, 0};
  for (std::size_t c = 0; c < probe.channels(); ++c)
    if (reflected[c] + transmitted[c] > e.reflected + e.transmitted)
      e.reflected = reflected[c], e.transmitted = transmitted[c];
  return e;
}

}  // namespace

ScatteringProbe::ScatteringProbe(std::shared_ptr<const Bsdf> bsdf, const SpectralGrid& grid,
                                 std::vector<double> nm, bool make_reciprocal)
    : bsdf_(std::move(bsdf)), grid_(grid), nm_(std::move(nm)), make_reciprocal_(make_reciprocal) {
  for (std::size_t first = 0; first < nm_.size(); first += kWavelengths)
    sets_.push_back(Wavelengths::at(grid, make_spectrum([&](int j) {
                                      return float(nm_[std::min(first + std::size_t(j), nm_.size() - 1)]);
                                    })));
  point_.uv = {0.5f, 0.5f};
}

void ScatteringProbe::f(const Vec3& wi, const Vec3& wo, std::vector<double>& out) const {
  check_stop();
  out.resize(nm_.size());
  for (std::size_t set = 0; set < sets_.size(); ++set) {
    const BsdfContext ctx{sets_[set], point_};
    const Spectrum forward = bsdf_->eval(wi, wo, ctx) * (1 / std::abs(wo.z));
    const Spectrum value =
        make_reciprocal_ ? 0.5f * (forward + bsdf_->eval(wo, wi, ctx) * (1 / std::abs(wi.z))) : forward;
    for (std::size_t j = 0; j < kWavelengths && set * kWavelengths + j < nm_.size(); ++j)
      out[set * kWavelengths + j] = double(value[int(j)]);
  }
}

double ScatteringProbe::mean(const Vec3& wi, const Vec3& wo) const {
  thread_local std::vector<double> values;
  f(wi, wo, values);
  double sum = 0;
  for (const double v : values) sum += v;
  return sum / double(values.size());
}

double ScatteringReport::largest_energy() const {
  double largest = 0;
  for (const Energy& e : energies) largest = std::max(largest, e.reflected + e.transmitted);
  return largest;
}

ScatteringReport examine(const ScatteringProbe& probe) {
  ScatteringReport r;
  const Lobe lobes = probe.bsdf().lobes();
  r.has_delta = has(lobes, Lobe::delta);
  r.transmits = has(lobes, Lobe::transmit) || has(lobes, Lobe::null);
  for (const double angle : {0.0, 15.0, 30.0, 45.0, 60.0, 75.0, 85.0})
    r.energies.push_back(energy_at(probe, angle, r.refracts));
  // for each pair of directions, the sum of f over both orders and its difference
  std::vector<std::pair<double, double>> found;
  double weights = 0, faults = 0, largest = 0;
  for (std::size_t k = 0; k < kPairs; ++k) {
    Vec3 wi = square_to_cosine_hemisphere(recurrent_point(k));
    Vec3 wo = square_to_cosine_hemisphere(recurrent_point(3 * k + 1));
    // Half of the pairs lie near the mirror direction, where smooth surfaces reflect.
    if (k % 2) wo = normalize(reflect(wi) + 0.3f * Vec3{wo.x, wo.y, 0});
    if (k % 2 && !(wo.z > 0.01f)) continue;
    if (k % 16 == 0 && probe.mean({wi.x, wi.y, -wi.z}, {wo.x, wo.y, -wo.z}) > 0) r.reflects_below = true;
    if (r.transmits && k % 4 >= 2) wo.z = -wo.z;
    // Light from below, of which every eighth pair is, once a reflection there is found.
    if (r.reflects_below && k % 8 == 5) wi.z = -wi.z, wo.z = -wo.z;
    const double a = probe.mean(wi, wo), b = probe.mean(wo, wi),
                 weight = std::abs(double(wi.z) * double(wo.z));
    found.emplace_back(a + b, std::abs(a - b));
    weights += weight * (a + b), faults += weight * std::abs(a - b), largest = std::max(largest, a + b);
    // At normal incidence the azimuth of the incident direction is arbitrary.
    if (k % 16 == 0 && a + b > 0 && wi.z < 0.999f) {
      const double phi = 0.7 + 0.01 * double(k);
      if (std::abs(probe.mean(turned(wi, phi), turned(wo, phi)) - a) > 1e-3 * a) r.is_isotropic = false;
    }
  }
  r.has_values = weights > 0;
  r.mean_asymmetry = weights > 0 ? faults / weights : 0;
  for (const auto& [sum, difference] : found)
    if (sum > 0.01 * largest) r.largest_asymmetry = std::max(r.largest_asymmetry, difference / sum);
  return r;
}

std::string report_text(const ScatteringReport& r) {
  std::string text = "angle of incidence   reflected   transmitted   (largest over the wavelengths)\n";
  for (const auto& e : r.energies)
    text += fmt::format("{:>10.0f} degrees {:>11.4f} {:>13.4f}\n", e.angle, e.reflected, e.transmitted);
  text += fmt::format(
      "reciprocity: f(i, o) and f(o, i) differ from their mean by {:.2f} % on average, by {:.1f} % at most\n",
      100 * r.mean_asymmetry, 100 * r.largest_asymmetry);
  if (r.refracts)
    text +=
        "the BSDF refracts into a medium; tables stand for sheets in air and are too bright by the squared ratio of the indices\n";
  text += r.is_isotropic ? "isotropic: turning about the normal changes nothing\n" : "anisotropic\n";
  return text;
}

}  // namespace aureole

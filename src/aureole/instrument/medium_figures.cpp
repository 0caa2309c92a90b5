// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/medium_figures.h"

#include <algorithm>
#include <cmath>

#include "aureole/core/parallel.h"
#include "aureole/math/vec.h"
#include "aureole/optics/medium/absorption.h"
#include "aureole/phase/mean_cosine.h"
#include "aureole/spectrum/observer.h"

namespace aureole {

namespace {

const SpectralGrid& grid_of(const Medium& medium) { return medium.properties().context().grid; }

/// Returns up to 8 wavelengths from index `first` on; the last one is repeated.
Wavelengths group(const SpectralGrid& grid, std::span<const double> nm, std::size_t first) {
  return Wavelengths::at(
      grid, make_spectrum([&](int i) { return float(nm[std::min(first + std::size_t(i), nm.size() - 1)]); }));
}

}  // namespace

double MediumFigures::transmittance(double length) const {
  return optics::transmittance(extinction(), length);
}

// Absorbances are taken from the coefficients, to which they are proportional: the transmittance of an opaque
// medium would be rounded to 0.
double MediumFigures::absorbance(double length) const {
  return absorption / optics::absorption_of_decadic(1, length);
}
double MediumFigures::optical_density(double length) const {
  return extinction() / optics::absorption_of_decadic(1, length);
}

std::vector<MediumFigures> measure_medium(const Medium& medium, std::span<const double> nm, const Vec3& p,
                                          const Vec3& d) {
  const SpectralGrid& grid = grid_of(medium);
  const double per_metre = 1 / medium.properties().context().length_unit_m;
  const Frame about = Frame::from_normal(d);
  std::vector<MediumFigures> all(nm.size());
  const std::size_t groups = (nm.size() + kWavelengths - 1) / kWavelengths;
  const auto measure = [&](std::size_t g) {
    const std::size_t first = g * kWavelengths;
    const Wavelengths w = group(grid, nm, first);
    MediumCoefficients c;
    medium.eval(p, d, w, c);
    std::array<double, kWavelengths> asymmetry{};
    if (any(c.sigma_s.v > 0.f)) asymmetry = mean_cosine(medium.phase(), about, p, w);
    for (std::size_t k = 0; k < kWavelengths && first + k < nm.size(); ++k) {
      const double s = double(c.sigma_s[int(k)]), t = double(c.sigma_t[int(k)]);
      all[first + k] = {nm[first + k], std::max(t - s, 0.0) * per_metre, s * per_metre,
                        s > 0 ? asymmetry[k] : 0};
    }
  };
  for_ranges(
      groups,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t g = begin; g < end; ++g) measure(g);
      },
      1);
  return all;
}

std::vector<double> phase_over_angle(const Medium& medium, double nm, std::span<const double> angles,
                                     const Vec3& p, const Vec3& d) {
  const Wavelengths w = Wavelengths::at(grid_of(medium), float(nm));
  const Frame about = Frame::from_normal(d);
  std::vector<double> values;
  for (const double angle : angles)
    values.push_back(double(mean_over_azimuth(medium.phase(), about, angle, p, w)[0]));
  return values;
}

std::array<double, 3> colour_behind(const Medium& medium, double length, bool scattered_too, const Vec3& p,
                                    const Vec3& d) {
  const SpectralGrid& grid = grid_of(medium);
  const float distance = float(length / medium.properties().context().length_unit_m);
  const auto xyz = observer_xyz(grid);
  const SampledSpectrum lamp = d65_spectrum(grid, 1);
  std::vector<float> seen(lamp.nodes().begin(), lamp.nodes().end());
  for (int i = 0; i <= grid.cells; ++i) {
    MediumCoefficients c;
    medium.eval(p, d, Wavelengths::at(grid, float(grid.node(i))), c);
    const float lost = scattered_too ? std::max(c.sigma_t[0] - c.sigma_s[0], 0.f) : c.sigma_t[0];
    seen[std::size_t(i)] *= std::exp(-lost * distance);
  }
  const SampledSpectrum light(grid, std::move(seen));
  std::array<double, 3> sum{};
  const double white = overlap(lamp, xyz[1]);
  for (std::size_t i = 0; i < 3; ++i) sum[i] = white > 0 ? overlap(light, xyz[i]) / white : 0;
  return sum;
}

}  // namespace aureole

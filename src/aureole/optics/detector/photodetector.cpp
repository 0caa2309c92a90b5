// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/detector/photodetector.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "aureole/core/random.h"

namespace aureole::optics {

void DetectorModel::check() const {
  const auto require = [](bool good, const char* what) {
    if (!good) throw std::domain_error(what);
  };
  constexpr double kMost = 1e12;
  require(full_well > 0 && full_well <= kMost, "the full well must be positive, in electrons");
  require(read_noise >= 0 && read_noise <= kMost, "the read noise must not be negative");
  require(dark_current >= 0 && dark_current <= kMost, "the dark current must not be negative");
  require(dark_nonuniformity >= 0 && dark_nonuniformity <= kMost,
          "the dark non-uniformity must not be negative");
  require(photo_nonuniformity >= 0 && photo_nonuniformity <= 1,
          "the non-uniformity of the response lies between 0 and 1");
  require(gain > 0 && gain <= kMost, "the gain must be positive, in digital numbers per electron");
  require(bits >= 1 && bits <= 16, "the converter has 1 to 16 bits");
  require(black_level >= 0 && black_level < double(white_level()),
          "the black level must lie below the largest number");
}

double DetectorModel::saturation() const { return std::min(full_well, (white_level() - black_level) / gain); }

double DetectorModel::temporal_variance(double electrons) const {
  return gain * gain * (read_noise * read_noise + electrons) + 1.0 / 12;
}

double DetectorRandom::uniform() {
  state_ += 0x9e3779b97f4a7c15u;
  return (double(mix_bits(state_) >> 12) + 0.5) * 0x1p-52;
}

double DetectorRandom::normal() {
  // Box & Muller 1958; the second number is not kept, so that a pixel's numbers have fixed places in its stream.
  const double u = uniform(), v = uniform();
  return std::sqrt(-2 * std::log(u)) * std::cos(2 * std::numbers::pi * v);
}

double DetectorRandom::poisson(double mean) {
  if (!(mean > 0)) return 0;
  if (mean < 10) {
    const double limit = std::exp(-mean);
    double product = uniform(), count = 0;
    while (product > limit) product *= uniform(), ++count;
    return count;
  }
  const double root = std::sqrt(mean), log_mean = std::log(mean);
  const double b = 0.931 + 2.53 * root, a = -0.059 + 0.02483 * b;
  const double inverse_alpha = 1.1239 + 1.1328 / (b - 3.4), v_r = 0.9277 - 3.6224 / (b - 2);
  for (;;) {
    const double u = uniform() - 0.5, v = uniform(), us = 0.5 - std::abs(u);
    const double k = std::floor((2 * a / us + b) * u + mean + 0.43);
    if (us >= 0.07 && v <= v_r) return k;
    if (k < 0 || (us < 0.013 && v > us)) continue;
    if (std::log(v) + std::log(inverse_alpha) - std::log(a / (us * us) + b) <=
        -mean + k * log_mean - std::lgamma(k + 1))
      return k;
  }
}

std::uint16_t read_pixel(const DetectorModel& d, double photoelectrons, double exposure, std::uint64_t pixel,
                         std::uint64_t sensor, std::uint64_t frame) {
  constexpr std::uint64_t kPattern = 1, kFrame = 2;
  DetectorRandom fixed(combine_bits(combine_bits(sensor, kPattern), pixel));
  DetectorRandom noise(combine_bits(combine_bits(combine_bits(sensor, kFrame), frame), pixel));
  const double response = 1 + d.photo_nonuniformity * fixed.normal(),
               offset = d.dark_nonuniformity * fixed.normal();
  double electrons = noise.poisson(std::max(0.0, photoelectrons * response) + d.dark_current * exposure);
  electrons = std::min(electrons, d.full_well);
  const double number = d.gain * (electrons + offset + d.read_noise * noise.normal()) + d.black_level;
  return std::uint16_t(std::clamp(std::floor(number + 0.5), 0.0, double(d.white_level())));
}

double mean_signal(const DetectorModel& d, double photoelectrons, double exposure) {
  return d.gain * (photoelectrons + d.dark_current * exposure) + d.black_level;
}

ColorMosaic ColorMosaic::named(std::string_view name) {
  if (name == "mono") return {};
  if (name == "xtrans")
    return {6, 6, {1, 2, 1, 1, 0, 1, 0, 1, 0, 2, 1, 2, 1, 2, 1, 1, 0, 1,
                   1, 0, 1, 1, 2, 1, 2, 1, 2, 0, 1, 0, 1, 0, 1, 1, 2, 1}};
  for (const char* bayer : {"rggb", "bggr", "grbg", "gbrg"})
    if (name == bayer) {
      ColorMosaic mosaic{2, 2, {}};
      for (int i = 0; i < 4; ++i) mosaic.filters.push_back(bayer[i] == 'r' ? 0 : bayer[i] == 'g' ? 1 : 2);
      return mosaic;
    }
  throw std::domain_error("unknown mosaic \"" + std::string(name) +
                          "\"; there are: mono, rggb, bggr, grbg, gbrg, xtrans");
}

double aperture_solid_angle(double f_number, ApertureLaw law) {
  if (!(f_number > 0)) throw std::domain_error("an f-number must be positive");
  if (law == ApertureLaw::sine) {
    if (f_number < 0.5) throw std::domain_error("by the sine condition no f-number is below 0.5");
    return std::numbers::pi / (4 * f_number * f_number);
  }
  const double sine = std::sin(std::atan(0.5 / f_number));
  return std::numbers::pi * sine * sine;
}

double pixel_mtf(double cycles_per_pixel) {
  const double x = std::numbers::pi * cycles_per_pixel;
  return x == 0 ? 1 : std::abs(std::sin(x) / x);
}

double diffraction_mtf(double frequency, double cutoff) {
  const double x = std::abs(frequency) / cutoff;
  if (!(x < 1)) return 0;
  return 2 / std::numbers::pi * (std::acos(x) - x * std::sqrt(1 - x * x));
}

}  // namespace aureole::optics

// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <tuple>

#include "aureole/instrument/corona/corona_fit.h"
#include "aureole/optics/interface/fresnel_equations.h"

namespace aureole {
namespace {

constexpr double kStepU = 0.02;
constexpr int kTableU = 10000, kTableS = 1500;

/// Mean and its standard error without outliers (other light sources), which are farther than five standard
/// deviations from the median. The deviation is estimated from the median absolute deviation.
std::pair<double, double> clipped_mean(std::vector<double>& v) {
  const auto median = [](std::vector<double>& x) {
    std::nth_element(x.begin(), x.begin() + long(x.size() / 2), x.end());
    return x[x.size() / 2];
  };
  const double middle = median(v);
  std::vector<double> far;
  for (const double x : v) far.push_back(std::abs(x - middle));
  const double limit = 5 * 1.4826 * median(far);
  double n = 0, sum = 0, square = 0;
  for (const double x : v)
    if (!(std::abs(x - middle) > limit)) n += 1, sum += x - middle, square += (x - middle) * (x - middle);
  const double mean = sum / n;
  return {middle + mean, std::sqrt(std::max(square / n - mean * mean, 0.0) / std::max(n - 1, 1.0))};
}

}  // namespace

CoronaModel::CoronaModel(const LampSpectrum& lamp, double largest_s, double blur)
    : largest_s_(largest_s + 2 * blur), step_(largest_s_ / kTableS), blur_(blur) {
  for (Table* t : {&sharp_, &blurred_}) t->values.resize(kTableS + 2), t->known.resize(kTableS + 2);
  constexpr int kRings = 3, kSpokes = 8;
  for (int ring = 0; ring < kRings; ++ring)
    for (int spoke = 0; spoke < kSpokes; ++spoke) {
      const double r = blur_ * std::sqrt((ring + 0.5) / kRings),
                   f = 2 * M_PI * (spoke + 0.5 * (ring % 2)) / kSpokes;
      disc_.push_back({r * std::cos(f), r * std::sin(f)});
    }
  // Spectra are summed over wavelengths 5 nm apart, each with the power up to the next one. The resulting
  // blur is a hundredth of a ring. Single lines keep their wavelength.
  for (size_t i = 0; i < lamp.nm.size();) {
    double power = 0, moment = 0;
    size_t k = i;
    for (; k < lamp.nm.size() && lamp.nm[k] < lamp.nm[i] + 5; ++k)
      power += lamp.power[k], moment += lamp.power[k] * lamp.nm[k];
    if (power > 0) {
      const double nm = moment / power;
      LampSpectrum part;
      part.nm.assign(lamp.nm.begin() + long(i), lamp.nm.begin() + long(k));
      part.power.assign(lamp.power.begin() + long(i), lamp.power.begin() + long(k));
      const auto rgb = corona_colour(part, [](double) { return 1.0; });
      lines_.push_back({1 / (nm * 1e-9), {rgb[0], rgb[1], rgb[2]}});
    }
    i = k;
  }
}

void CoronaModel::tabulate(double area_fraction, double largest_u) {
  if (area_fraction != tabulated_) g_.clear();
  tabulated_ = area_fraction;
  // Most fits use a small part of the table's range of u.
  const size_t needed = size_t(std::min(largest_u / kStepU, double(kTableU))) + 2;
  while (waves_.size() < needed) waves_.emplace_back(double(waves_.size()) * kStepU);
  while (g_.size() < needed) {
    const optics::HardDiscWave& w = waves_[g_.size()];
    g_.push_back(w.disc * w.disc * w.structure_factor(area_fraction));
  }
}

const CoronaModel::Colour& CoronaModel::sharp(size_t i) {
  Colour& out = sharp_.values[i];
  if (sharp_.known[i]) return out;
  sharp_.known[i] = true;
  out = {0, 0, 0};
  const double path = 2 * M_PI * double(i) * step_ * radius_;
  for (const Line& l : lines_) {
    const double at = std::min(path * l.inverse_m / kStepU, double(kTableU));
    const size_t k = size_t(at);
    const double g = g_[k] + (at - double(k)) * (g_[k + 1] - g_[k]);
    for (size_t c = 0; c < 3; ++c) out[c] += l.rgb[c] * g;
  }
  return out;
}

const CoronaModel::Colour& CoronaModel::blurred(size_t i) {
  if (!(blur_ > 0)) return sharp(i);
  Colour& out = blurred_.values[i];
  if (blurred_.known[i]) return out;
  blurred_.known[i] = true;
  out = {0, 0, 0};
  for (const auto& [x, y] : disc_) {
    const double at = std::min(std::hypot(double(i) * step_ + x, y) / step_, double(kTableS));
    const size_t k = size_t(at);
    const Colour &a = sharp(k), &b = sharp(k + 1);
    for (size_t c = 0; c < 3; ++c) out[c] += (a[c] + (at - double(k)) * (b[c] - a[c])) / double(disc_.size());
  }
  return out;
}

void CoronaModel::set(double radius, double area_fraction) {
  radius_ = radius;
  double largest_inverse_m = 0;
  for (const Line& l : lines_) largest_inverse_m = std::max(largest_inverse_m, l.inverse_m);
  tabulate(area_fraction, 2 * M_PI * double(sharp_.values.size()) * step_ * radius * largest_inverse_m);
  for (Table* t : {&sharp_, &blurred_}) std::fill(t->known.begin(), t->known.end(), char(false));
}

std::array<double, 3> CoronaModel::at(double s) {
  const double at = std::clamp(s / largest_s_ * kTableS, 0.0, double(kTableS));
  const size_t k = size_t(at);
  const Colour &a = blurred(k), &b = blurred(k + 1);
  Colour out;
  for (size_t c = 0; c < 3; ++c) out[c] = a[c] + (at - double(k)) * (b[c] - a[c]);
  return out;
}

ScatteredProfile scattered_profile(const Image& image, const PinholeCamera& camera, Direction lamp,
                                   const PictureParts& parts, const PaneGeometry& g, double inner,
                                   double clip) {
  const size_t channel[3] = {size_t(image.channel("R")), size_t(image.channel("G")),
                             size_t(image.channel("B"))};
  const double step = camera.tangent_per_pixel, end = 0.5;
  const size_t bins = size_t(end / step) + 1;
  struct Bin {
    double s = 0;
    std::vector<double> value[3];
    bool clipped = false;
  };
  std::vector<Bin> bin(bins);
  const Direction far{lamp.x / lamp.z * g.lamp_m, lamp.y / lamp.z * g.lamp_m, g.lamp_m};
  const double specular = g.slab_index > 0 ? optics::thin_slab_reflectance(lamp.z, 1, g.slab_index) : 0;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const Direction v = camera.direction(x + 0.5, y + 0.5);
      Direction w = lamp;
      if (g.lamp_m > 0) {
        const double t = g.pane_m / v.z;
        w = unit({far.x - t * v.x, far.y - t * v.y, far.z - t * v.z});
      }
      const double s = std::hypot(w.x - v.x, w.y - v.y);
      if (s < inner || s >= end || parts.is_masked(x + 0.5, y + 0.5)) continue;
      if (!parts.has_azimuth(polar_about(lamp, v).second)) continue;
      Bin& b = bin[size_t(s / step)];
      const double through =
          g.slab_index > 0 ? 1 - std::sqrt(optics::thin_slab_reflectance(v.z, 1, g.slab_index) * specular)
                           : 1;
      b.s += s;
      for (size_t c = 0; c < 3; ++c) {
        const double value = image.at(x, y, channel[c]);
        b.clipped |= !(value < clip);
        b.value[c].push_back(value / through);
      }
    }
  ScatteredProfile out;
  out.step = step;
  size_t most = 0;
  for (Bin& b : bin) {
    const size_t n = b.value[0].size();
    most = std::max(most, n);
    // Rings visible only in the corners of the picture are too sensitive to single objects in them.
    if (n < 8 || b.clipped || 4 * n < most) continue;
    std::array<double, 3> mean, sd;
    for (size_t c = 0; c < 3; ++c) std::tie(mean[c], sd[c]) = clipped_mean(b.value[c]);
    out.s.push_back(b.s / double(n)), out.mean.push_back(mean), out.sd.push_back(sd);
  }
  return out;
}

}  // namespace aureole

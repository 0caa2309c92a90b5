// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <tuple>

#include "aureole/instrument/corona/corona_fit.h"
#include "aureole/optics/aperture/aperture_transform.h"
#include "aureole/optics/arrangement/cholesky.h"
#include "aureole/optics/arrangement/equilibrium_structure_factor.h"
#include "aureole/optics/interface/fresnel_equations.h"
#include "aureole/optics/particle/size_distribution.h"

namespace aureole {
namespace {

// Step of u for one size, and a wider step for several sizes, which take a hundred times as long.
constexpr double kStepU = 0.02, kMixtureStepU = 0.04;
constexpr double kEndU = 200;
constexpr int kTableS = 1500;

/// Mean and its standard error without outliers (other light sources): values farther than five standard
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

CoronaModel::CoronaModel(const LampSpectrum& lamp, double largest_s, double blur, Positions positions)
    : largest_s_(largest_s + 2 * blur), step_(largest_s_ / kTableS), blur_(blur), positions_(positions) {
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

void CoronaModel::tabulate(const CoronaScatterers& x, double largest_u) {
  using optics::SizeDistribution;
  if (x.spread > 0 || x.second_share > 0) {
    g_.clear(), tabulated_ = -1;
    sizes_.clear();
    step_u_ = kMixtureStepU;
    constexpr size_t kMaxClasses = 5;
    if (x.spread > 0) {
      const SizeDistribution distribution = SizeDistribution::log_normal(x.spread);
      const auto& nodes = distribution.nodes();
      for (size_t i = 0; i < nodes.size(); ++i)
        sizes_.push_back({nodes[i].size, nodes[i].weight, int(i * kMaxClasses / nodes.size())});
    } else {
      const double ratio = x.second_radius / x.radius, second = x.second_share / (ratio * ratio),
                   all = 1 - x.second_share + second;
      sizes_ = {{1, (1 - x.second_share) / all, 0}, {ratio, second / all, 1}};
    }
    std::vector<double> numbers(size_t(sizes_.back().size_class) + 1), radii(numbers.size());
    for (const Size& size : sizes_)
      numbers[size_t(size.size_class)] += size.number,
          radii[size_t(size.size_class)] += size.number * size.radius * size.radius;
    for (size_t m = 0; m < radii.size(); ++m) radii[m] = std::sqrt(radii[m] / numbers[m]);
    mixture_.emplace(radii, numbers, x.area_fraction);
  } else {
    sizes_.clear(), mixture_.reset();
    step_u_ = kStepU;
    if (x.area_fraction != tabulated_) g_.clear();
    tabulated_ = x.area_fraction;
  }
  // The table is extended on demand, since most fits use a small part of its range of u.
  const size_t needed = size_t(std::min(largest_u, kEndU) / step_u_) + 2;
  while (!mixture_ && waves_.size() < needed) waves_.emplace_back(double(waves_.size()) * step_u_);
  while (g_.size() < needed) {
    const double u = double(g_.size()) * step_u_;
    if (mixture_) {
      g_.push_back(mixture_intensity(u));
    } else {
      const optics::HardDiscWave& w = waves_[g_.size()];
      g_.push_back(w.disc * w.disc /
                   (1 / w.structure_factor(x.area_fraction) + correction(u, x.area_fraction)));
    }
  }
}

double CoronaModel::correction(double u, double area_fraction) const {
  return positions_ == Positions::equilibrium ? optics::equilibrium_correction(u, area_fraction) : 0;
}

/// Each class of sizes has one amplitude, and the matrix of structure factors of classes is (1 - C)^-1. The
/// correction of equal discs in equilibrium is applied to each pair of classes at the mean of their radii, so
/// that a small spread changes little.
double CoronaModel::mixture_intensity(double u) const {
  const int n = mixture_->classes();
  std::vector<double> amplitude(size_t(n), 0.0), matrix(size_t(n * n));
  double intensity = 0;
  for (const Size& size : sizes_) {
    const double f = size.radius * size.radius * optics::circle_transform(u * size.radius);
    amplitude[size_t(size.size_class)] += size.number * f;
    intensity += size.number * f * f;
  }
  for (int m = 0; m < n; ++m) {
    const double p = mixture_->fraction(m);
    amplitude[size_t(m)] /= std::sqrt(p);
    intensity -= amplitude[size_t(m)] * amplitude[size_t(m)];
    for (int l = 0; l <= m; ++l)
      matrix[size_t(m * n + l)] =
          double(m == l) - mixture_->direct(m, l, u) +
          std::sqrt(p * mixture_->fraction(l)) *
              correction(u * 0.5 * (mixture_->radius(m) + mixture_->radius(l)), mixture_->area_fraction());
  }
  const optics::Cholesky cholesky(std::move(matrix), n);
  if (!cholesky.is_definite()) return NAN;  // NaN makes the fit reject these parameters
  const std::vector<double> x = cholesky.solve(amplitude);
  for (int m = 0; m < n; ++m) intensity += amplitude[size_t(m)] * x[size_t(m)];
  return std::max(intensity, 0.0);
}

const CoronaModel::Colour& CoronaModel::sharp(size_t i) {
  Colour& out = sharp_.values[i];
  if (sharp_.known[i]) return out;
  sharp_.known[i] = true;
  out = {0, 0, 0};
  const double path = 2 * M_PI * double(i) * step_ * radius_;
  for (const Line& l : lines_) {
    const double at = std::min(path * l.inverse_m, kEndU) / step_u_;
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

void CoronaModel::set(const CoronaScatterers& scatterers) {
  radius_ = scatterers.radius;
  double largest_inverse_m = 0;
  for (const Line& l : lines_) largest_inverse_m = std::max(largest_inverse_m, l.inverse_m);
  tabulate(scatterers, 2 * M_PI * double(sharp_.values.size()) * step_ * radius_ * largest_inverse_m);
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

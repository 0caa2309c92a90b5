// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/sky/sky_model.h"

#include <algorithm>
#include <cmath>

/// Table written by tools/make_sky_table.py, which describes the layout; float32, little-endian.
extern "C" {
extern const float aureole_sky_data[];
}

namespace aureole::optics {

namespace {

constexpr std::size_t kChannels = SkyModel::kChannels, kTurbidities = 10, kSegments = 45, kSunTerms = 4,
                      kLimbTerms = 6, kControlPoints = 6, kSkyTerms = 10;
constexpr std::size_t kSkySize = kTurbidities * 2 * kControlPoints * kChannels * kSkyTerms;
constexpr std::size_t kSunSize = kTurbidities * kSegments * kChannels * kSunTerms;

double sky_datum(std::size_t turbidity, std::size_t albedo, std::size_t point, std::size_t channel,
                 std::size_t term) {
  return aureole_sky_data[(((turbidity * 2 + albedo) * kControlPoints + point) * kChannels + channel) *
                              kSkyTerms +
                          term];
}
const float* sun_data(std::size_t turbidity, std::size_t segment, std::size_t channel) {
  return aureole_sky_data + kSkySize + ((turbidity * kSegments + segment) * kChannels + channel) * kSunTerms;
}

/// Two neighbouring integer turbidities and the weight of the second.
struct Turbidities {
  std::size_t low;
  double weight;
  explicit Turbidities(double turbidity)
      : low(std::min(std::size_t(turbidity - 1), kTurbidities - 2)), weight(turbidity - 1 - double(low)) {}
};

}  // namespace

SkyModel::SkyModel(double turbidity, const std::array<double, kChannels>& albedo, double solar_elevation)
    : turbidity_(std::clamp(turbidity, 1.0, double(kTurbidities))) {
  // The data are control points of quintic Bezier curves over the cube root of the elevation (2012, section
  // 5).
  const double x = std::cbrt(std::clamp(solar_elevation / (M_PI / 2), 0.0, 1.0)), y = 1 - x;
  const double bernstein[kControlPoints] = {y * y * y * y * y,      5 * x * y * y * y * y,
                                            10 * x * x * y * y * y, 10 * x * x * x * y * y,
                                            5 * x * x * x * x * y,  x * x * x * x * x};
  const Turbidities t(turbidity_);
  for (std::size_t channel = 0; channel < kChannels; ++channel) {
    const double a = std::clamp(albedo[channel], 0.0, 1.0);
    const double weights[2][2] = {{(1 - t.weight) * (1 - a), (1 - t.weight) * a},
                                  {t.weight * (1 - a), t.weight * a}};
    for (std::size_t term = 0; term < kSkyTerms; ++term) {
      double sum = 0;
      for (std::size_t i = 0; i < 2; ++i)
        for (std::size_t j = 0; j < 2; ++j)
          for (std::size_t k = 0; k < kControlPoints; ++k)
            sum += weights[i][j] * bernstein[k] * sky_datum(t.low + i, j, k, channel, term);
      sky_[channel][term] = sum;
    }
  }
}

double SkyModel::horizon(std::size_t channel, double cos_zenith) const {
  const auto& p = sky_[channel];
  return p[9] * (1 + p[0] * std::exp(p[1] / (cos_zenith + 0.01)));
}

double SkyModel::glow(std::size_t channel, double gamma) const {
  const auto& p = sky_[channel];
  const double c = std::cos(gamma);
  const double chi = (1 + c * c) / std::pow(1 + p[8] * p[8] - 2 * p[8] * c, 1.5);
  return p[2] + p[3] * std::exp(p[4] * gamma) + p[5] * c * c + p[6] * chi;
}

double SkyModel::sky(std::size_t channel, double cos_zenith, double gamma) const {
  return horizon(channel, cos_zenith) * (glow(channel, gamma) + zenith_gain(channel) * std::sqrt(cos_zenith));
}

double SkyModel::sun(std::size_t channel, double elevation) const {
  if (!(elevation >= 0)) return 0;
  // The ends of the segments grow as the cube of their index, since the radiance changes rapidly near the horizon.
  const std::size_t segment =
      std::min(std::size_t(std::cbrt(elevation / (M_PI / 2)) * kSegments), kSegments - 1);
  const double x = elevation - M_PI / 2 * std::pow(double(segment) / kSegments, 3);
  const Turbidities t(turbidity_);
  double radiance = 0;
  for (std::size_t i = 0; i < 2; ++i) {
    const float* c = sun_data(t.low + i, segment, channel);
    radiance += (i ? t.weight : 1 - t.weight) * (c[0] + x * (c[1] + x * (c[2] + x * double(c[3]))));
  }
  return std::max(radiance, 0.0);
}

double SkyModel::limb_darkening(std::size_t channel, double cosine) {
  const float* c = aureole_sky_data + kSkySize + kSunSize + channel * kLimbTerms;
  double sum = 0;
  for (std::size_t k = kLimbTerms; k-- > 0;) sum = sum * cosine + c[k];
  return sum;
}

}  // namespace aureole::optics

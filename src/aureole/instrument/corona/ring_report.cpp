// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/corona/ring_report.h"

#include <algorithm>
#include <cmath>

#include "aureole/core/error.h"
#include "aureole/core/units.h"
#include "aureole/math/vec.h"
#include "aureole/optics/layer/scatterer_layer.h"

namespace aureole {
namespace {

/// Finds the first maximum from one degree on, and the minimum behind it.
RingAngles ring_angles_of(const CoronaProfile& profile, int channel, double smooth) {
  constexpr double kFrom_deg = 1, kStep_deg = 0.3;
  RingAngles found;
  found.first_maximum = profile.extremum(channel, kFrom_deg, true, smooth);
  if (found.first_maximum > 0)
    found.next_minimum = profile.extremum(channel, found.first_maximum + kStep_deg, false, smooth);
  return found;
}

CoronaProfile measured_profile(const PictureParts& parts, const Image& image, const PinholeCamera& camera,
                               Direction lamp) {
  CoronaProfile p;
  const int r = image.channel("R"), g = image.channel("G"), b = image.channel("B");
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const auto [angle, azimuth] = polar_about(lamp, camera.direction(x + 0.5, y + 0.5));
      if (!parts.has_azimuth(azimuth) || parts.is_masked(x + 0.5, y + 0.5)) continue;
      const double rgb[3] = {image.at(x, y, r), image.at(x, y, g), image.at(x, y, b)};
      p.add(angle, rgb, 1);
    }
  return p;
}

CoronaProfile predicted_profile(const RingSettings& o, const PictureParts& parts, const PinholeCamera& camera,
                                int width, int height, Direction lamp_direction) {
  const double a = parse_length_m(o.radius), pane = parse_length_m(o.pane_distance),
               depth = parse_length_m(o.lamp_distance);
  const double correlation = o.correlation_radius.empty() ? a : parse_length_m(o.correlation_radius);
  const double lamp_radius = parse_length_m(o.lamp_diameter) / 2;
  const optics::ScattererLayer layer(a, correlation, o.area_fraction);
  const LampSpectrum spectrum = lamp_spectrum(o.illuminant);

  // One sum over wavelengths serves all directions: it depends on s = |(w - v)_xy| only.
  constexpr int kTable = 4000;
  constexpr double kLargest = 0.2;
  std::vector<std::array<double, 3>> rgb(kTable + 1);
  for (int i = 0; i <= kTable; ++i)
    rgb[i] =
        corona_colour(spectrum, [&, s = kLargest * i / kTable](double k) { return layer.intensity(k * s); });

  const Direction lamp{lamp_direction.x / lamp_direction.z * depth,
                       lamp_direction.y / lamp_direction.z * depth, depth};
  const Direction right = unit({lamp_direction.z, 0, -lamp_direction.x}), up = cross(lamp_direction, right);
  constexpr int kAzimuths = 144, kRings = 3, kSpokes = 8;
  CoronaProfile p;
  for (int m = 0; m < kAzimuths; ++m) {
    const double azimuth = 360.0 * (m + 0.5) / kAzimuths;
    if (!parts.has_azimuth(azimuth)) continue;
    for (int i = 0; i < CoronaProfile::kBins; ++i) {
      const double angle = (i + 0.5) * CoronaProfile::kStep, c = std::cos(azimuth * kDegree),
                   s = std::sin(azimuth * kDegree);
      const double t = std::tan(angle * kDegree);
      const Direction v = unit({lamp_direction.x + t * (c * right.x + s * up.x),
                                lamp_direction.y + t * (c * right.y + s * up.y),
                                lamp_direction.z + t * (c * right.z + s * up.z)});
      // Uses only angles inside the picture.
      const double px = camera.center_x + v.x / v.z / camera.tangent_per_pixel;
      const double py = camera.center_y - v.y / v.z / camera.tangent_per_pixel;
      if (px < 0 || py < 0 || px >= width || py >= height) continue;
      if (parts.is_masked(px, py)) continue;
      const Direction on_pane{v.x / v.z * pane, v.y / v.z * pane, pane};
      double sum[3] = {};
      for (int ring = 0; ring < kRings; ++ring)
        for (int spoke = 0; spoke < kSpokes; ++spoke) {
          // Rings of equal area of the source's disc.
          const double r = lamp_radius * std::sqrt((ring + 0.5) / kRings),
                       f = 2 * M_PI * (spoke + 0.5 * (ring % 2)) / kSpokes;
          const double e = r * std::cos(f), h = r * std::sin(f);
          const Direction to{lamp.x + e * right.x + h * up.x - on_pane.x,
                             lamp.y + e * right.y + h * up.y - on_pane.y,
                             lamp.z + e * right.z + h * up.z - on_pane.z};
          const Direction w = unit(to);
          // 1/d^2 for the solid angle of the source from here; w.z for the cosine at the pane.
          const double weight = w.z / dot(to, to) / (kRings * kSpokes);
          const double x = std::min(std::hypot(w.x - v.x, w.y - v.y) / kLargest, 1.0) * kTable;
          const int k = std::min(int(x), kTable - 1);
          for (int ch = 0; ch < 3; ++ch)
            sum[ch] += weight * (rgb[k][ch] + (x - k) * (rgb[k + 1][ch] - rgb[k][ch]));
        }
      p.add(angle, sum, i + 0.5);
    }
  }
  return p;
}

}  // namespace

bool RingReport::is_complete() const {
  const auto has_both = [](const RingAngles& r) { return r.first_maximum > 0 && r.next_minimum > 0; };
  return std::all_of(measured_rings.begin(), measured_rings.end(), has_both) &&
         std::all_of(predicted_rings.begin(), predicted_rings.end(), has_both);
}

RingReport measure_rings(const Image& image, const std::string& name, const RingSettings& o) {
  if (image.channel("R") < 0 || image.channel("G") < 0 || image.channel("B") < 0)
    throw Error(name + ": needs the channels R, G and B");
  if (!(o.fov > 0 && o.fov < 180)) throw Error("--fov must be between 0 and 180 degrees");
  const PinholeCamera camera{2 * std::tan(0.5 * o.fov * kDegree) / image.width, 0.5 * image.width,
                             0.5 * image.height};
  const PictureParts parts = picture_parts(o.azimuths, o.masks);
  RingReport report;
  report.at = o.at.size() == 2 ? std::array{o.at[0], o.at[1]} : brightest_spot(image, parts);
  const Direction lamp = camera.direction(report.at[0], report.at[1]);
  report.measured = measured_profile(parts, image, camera, lamp);
  report.predicted = predicted_profile(o, parts, camera, image.width, image.height, lamp);
  for (int c = 0; c < 3; ++c) {
    report.measured_rings[std::size_t(c)] = ring_angles_of(report.measured, c, o.smooth);
    report.predicted_rings[std::size_t(c)] = ring_angles_of(report.predicted, c, o.smooth);
  }
  return report;
}

}  // namespace aureole

// SPDX-License-Identifier: Apache-2.0
// aureole rings: measures the corona of a light source in a picture and compares it with a prediction by
// quadrature. Inputs are the spectrum of the source, the size of the scatterers and the positions of camera,
// pane and source. The prediction is
//     L(v) = integral over the source and over wavelengths of
//            S(lambda) xyz(lambda) (1/lambda^2) J(k |(w - v)_xy|) dw,
// with v from the camera to a point of the pane, w from there to a point of the source, and J of
// `optics::ScattererLayer` (Yang, Kim, Pediredla & Jarosz, "A wave-optics BSDF for correlated scatterers",
// 2025, equation 14). It uses no BSDF. The camera axis is perpendicular to the pane. Factors that are smooth
// over the corona (reflection of the pane) are omitted.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "aureole/core/error.h"
#include "aureole/core/image.h"
#include "aureole/core/units.h"
#include "aureole/instrument/corona/corona.h"
#include "aureole/math/vec.h"
#include "aureole/optics/layer/scatterer_layer.h"
#include "command.h"
#include "picture_file.h"

namespace aureole {
namespace {

struct RingsOptions {
  std::string picture, illuminant = "LED-B3", radius = "5um", correlation_radius;
  std::string pane_distance = "0.5m", lamp_distance = "14m", lamp_diameter = "36mm";
  double area_fraction = 0.5, fov = 30, smooth = 0.25;
  std::vector<double> at, azimuths{0, 360};
  std::vector<double> masks;  ///< excluded discs: x, y and radius in pixels of each
};

CoronaProfile measure(const PictureParts& parts, const Image& image, const PinholeCamera& camera,
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

CoronaProfile predict(const RingsOptions& o, const PictureParts& parts, const PinholeCamera& camera,
                      int width, int height, Direction lamp_direction) {
  const double a = parse_length_m(o.radius), pane = parse_length_m(o.pane_distance),
               depth = parse_length_m(o.lamp_distance);
  const double correlation = o.correlation_radius.empty() ? a : parse_length_m(o.correlation_radius);
  const double lamp_radius = parse_length_m(o.lamp_diameter) / 2;
  const optics::ScattererLayer layer(a, correlation, o.area_fraction);
  const LampSpectrum spectrum = lamp_spectrum(o.illuminant);

  // Size of a table of the sum over wavelengths, which serves all directions: it depends on s = |(w - v)_xy|
  // only.
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
      // Uses only directions inside the picture.
      const double px = camera.center_x + v.x / v.z / camera.tangent_per_pixel;
      const double py = camera.center_y - v.y / v.z / camera.tangent_per_pixel;
      if (px < 0 || py < 0 || px >= width || py >= height) continue;
      if (parts.is_masked(px, py)) continue;
      const Direction on_pane{v.x / v.z * pane, v.y / v.z * pane, pane};
      double sum[3] = {};
      for (int ring = 0; ring < kRings; ++ring)
        for (int spoke = 0; spoke < kSpokes; ++spoke) {
          // Radii of rings of equal area of the source's disc.
          const double r = lamp_radius * std::sqrt((ring + 0.5) / kRings),
                       f = 2 * M_PI * (spoke + 0.5 * (ring % 2)) / kSpokes;
          const double e = r * std::cos(f), h = r * std::sin(f);
          const Direction to{lamp.x + e * right.x + h * up.x - on_pane.x,
                             lamp.y + e * right.y + h * up.y - on_pane.y,
                             lamp.z + e * right.z + h * up.z - on_pane.z};
          const Direction w = unit(to);
          // Weight with 1/d^2 for the solid angle of the source from the pane, and w.z for the cosine at the
          // pane.
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

int rings(const RingsOptions& o) {
  const Image image = read_picture(o.picture);
  if (image.channel("R") < 0 || image.channel("G") < 0 || image.channel("B") < 0)
    throw Error(o.picture + ": needs the channels R, G and B");
  if (!(o.fov > 0 && o.fov < 180)) throw Error("--fov must be between 0 and 180 degrees");
  const PinholeCamera camera{2 * std::tan(0.5 * o.fov * kDegree) / image.width, 0.5 * image.width,
                             0.5 * image.height};

  const PictureParts parts = picture_parts(o.azimuths, o.masks);
  double x, y;
  if (o.at.size() == 2) {
    x = o.at[0], y = o.at[1];
  } else {
    const auto spot = brightest_spot(image, parts);
    x = spot[0], y = spot[1];
  }
  const Direction lamp = camera.direction(x, y);
  const CoronaProfile measured = measure(parts, image, camera, lamp);
  const CoronaProfile predicted = predict(o, parts, camera, image.width, image.height, lamp);

  fmt::print("lamp at pixel ({:.1f}, {:.1f}); angles from it in degrees\n", x, y);
  fmt::print("{:8} {:>28} {:>28}\n", "", "first maximum", "next minimum");
  fmt::print("{:8} {:>9} {:>9} {:>8} {:>9} {:>9} {:>8}\n", "channel", "measured", "predicted", "differ",
             "measured", "predicted", "differ");
  bool complete = true;
  for (int c = 0; c < 3; ++c) {
    const double from = 1;
    const double m1 = measured.extremum(c, from, true, o.smooth),
                 p1 = predicted.extremum(c, from, true, o.smooth);
    const double m2 = m1 > 0 ? measured.extremum(c, m1 + 0.3, false, o.smooth) : -1;
    const double p2 = p1 > 0 ? predicted.extremum(c, p1 + 0.3, false, o.smooth) : -1;
    const auto percent = [](double m, double p) {
      return m > 0 && p > 0 ? fmt::format("{:+.1f} %", 100 * (m / p - 1)) : std::string("-");
    };
    const auto degrees = [](double d) { return d > 0 ? fmt::format("{:.3f}", d) : std::string("none"); };
    fmt::print("{:8} {:>9} {:>9} {:>8} {:>9} {:>9} {:>8}\n", "RGB"[c], degrees(m1), degrees(p1),
               percent(m1, p1), degrees(m2), degrees(p2), percent(m2, p2));
    complete = complete && m1 > 0 && p1 > 0 && m2 > 0 && p2 > 0;
  }
  return complete ? 0 : 1;
}

std::function<int()> declare(CommandOptions& options) {
  auto o = std::make_shared<RingsOptions>();
  options.add("picture", o->picture, "EXR with the channels R, G, B; the source must not be clipped")
      .required();
  options.add("--at", o->at, "pixel of the source, x y (default: the brightest white one)").takes(2);
  options
      .add(
          "--azimuths", o->azimuths,
          "use only the azimuths around the source from one to another, degrees, 0 right, 90 up; 300 60 is through 0")
      .takes(2);
  options.add("--mask", o->masks, "exclude a disc of the picture, x y radius in pixels; may be repeated")
      .takes_each_time(3);
  options.add("--fov", o->fov, "horizontal field of view, degrees").shows_default();
  options.add("--illuminant", o->illuminant, "CIE name of the source's spectrum").shows_default();
  options.add("--radius", o->radius, "radius of the circular scatterers").shows_default();
  options.add("--correlation-radius", o->correlation_radius, "radius of the hard discs (default: radius)");
  options.add("--area-fraction", o->area_fraction, "fraction of the plane covered by the hard discs")
      .shows_default();
  options.add("--pane-distance", o->pane_distance, "distance of the pane along the camera axis")
      .shows_default();
  options.add("--lamp-distance", o->lamp_distance, "distance of the source along the camera axis")
      .shows_default();
  options.add("--lamp-diameter", o->lamp_diameter, "diameter of a circular source").shows_default();
  options.add("--smooth", o->smooth, "half-width of the window of fits to extrema, degrees").shows_default();
  return [=] { return rings(*o); };
}

AUREOLE_COMMAND("rings", "Measure the rings of a corona in a picture and compare them with theory", declare);

}  // namespace
}  // namespace aureole

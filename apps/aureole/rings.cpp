// SPDX-License-Identifier: Apache-2.0
// aureole rings: the corona of one lamp in a picture, measured, beside its prediction by quadrature from the
// lamp's spectrum, the size of the scatterers and the places of camera, pane and lamp. The prediction is
//     L(v) = integral over the lamp and over wavelengths of S(lambda) xyz(lambda) (1/lambda^2) J(k |(w -
//     v)_xy|) dw,
// v from the camera to a point of the pane, w from there to a point of the lamp, J of
// `optics::ScattererLayer` (Yang, Kim, Pediredla & Jarosz, "A wave-optics BSDF for correlated scatterers",
// 2025, equation 14); it uses no BSDF. Camera axis and pane are perpendicular. Factors that are smooth over
// the corona (reflection of the pane) are left out.
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
#include "aureole/optics/scatterer_layer.h"
#include "aureole/spectrum/observer.h"
#include "aureole/spectrum/tables.h"
#include "commands.h"

namespace aureole {
namespace {

constexpr double kDegree = M_PI / 180;

struct RingsOptions {
  std::string picture, illuminant = "LED-B3", radius = "5um", correlation_radius;
  std::string pane_distance = "0.5m", lamp_distance = "14m", lamp_diameter = "36mm";
  double area_fraction = 0.5, fov = 30, smooth = 0.25;
  std::vector<double> at, azimuths{0, 360};
  std::vector<double> masks;  ///< x, y, radius in pixels of parts to leave out
};

/// Angles from the lamp's centre, in degrees: R, G, B means over the azimuths that are looked at.
struct Profile {
  static constexpr double kStep = 0.04, kEnd = 7;
  static constexpr int kBins = int(kEnd / kStep);
  std::vector<std::array<double, 3>> sum = std::vector<std::array<double, 3>>(kBins);
  std::vector<double> weight = std::vector<double>(kBins);

  void add(double degrees, const double rgb[3], double w) {
    const int i = int(degrees / kStep);
    if (degrees < 0 || i >= kBins) return;
    for (int c = 0; c < 3; ++c) sum[i][c] += w * rgb[c];
    weight[i] += w;
  }
  /// The parabola through the bins within `window` degrees of x, by least squares: its value and slope at x.
  std::array<double, 2> fit(int c, double x, double window) const {
    double m[3][4] = {};
    for (int i = 0; i < kBins; ++i) {
      const double t = ((i + 0.5) * kStep - x) / window;
      if (std::abs(t) >= 1 || !(weight[i] > 0)) continue;
      const double w = (1 - t * t) * weight[i] / (i + 0.5), y = sum[i][c] / weight[i];
      for (int a = 0; a < 3; ++a) {
        for (int b = 0; b < 3; ++b) m[a][b] += w * std::pow(t, a + b);
        m[a][3] += w * std::pow(t, a) * y;
      }
    }
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) {
        if (b == a || m[a][a] == 0) continue;
        const double f = m[b][a] / m[a][a];
        for (int k = 0; k < 4; ++k) m[b][k] -= f * m[a][k];
      }
    return {m[0][0] != 0 ? m[0][3] / m[0][0] : 0, m[1][1] != 0 ? m[1][3] / m[1][1] : 0};
  }
  /// The first extremum beyond `from`: where the slope changes its sign to negative (a maximum) or positive.
  /// Negative if none.
  double extremum(int c, double from, bool maximum, double window) const {
    const double s = maximum ? 1 : -1;
    double before = s * fit(c, from, window)[1];
    for (double x = from + 0.005; x < kEnd - window; x += 0.005) {
      const double slope = s * fit(c, x, window)[1];
      if (before > 0 && slope <= 0) return x - 0.005 * slope / (slope - before);
      before = slope;
    }
    return -1;
  }
};

struct Vector {
  double x, y, z;
};
Vector unit(Vector v) {
  const double l = std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z);
  return {v.x / l, v.y / l, v.z / l};
}
Vector cross(Vector a, Vector b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
double length(Vector v) { return std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z); }
double dot(Vector a, Vector b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

/// The camera at the origin looks along +z, x to the right and y up in the picture.
struct Camera {
  double tangent_per_pixel, center_x, center_y;
  Vector direction(double x, double y) const {
    return unit({(x - center_x) * tangent_per_pixel, (center_y - y) * tangent_per_pixel, 1});
  }
};

/// Angle from the lamp in degrees and azimuth around it, 0 to the right and 90 upwards.
std::pair<double, double> polar(Vector lamp, Vector v) {
  const Vector right = unit({lamp.z, 0, -lamp.x}), up = cross(lamp, right);
  const double a = std::atan2(dot(v, up), dot(v, right)) / kDegree;
  return {std::atan2(length(cross(lamp, v)), dot(lamp, v)) / kDegree, a < 0 ? a + 360 : a};
}

bool looked_at(const RingsOptions& o, double azimuth) {
  const double from = o.azimuths[0], to = o.azimuths[1];
  const double a = azimuth - 360 * std::floor((azimuth - from) / 360);
  return a <= to;
}

Profile measure(const RingsOptions& o, const Image& image, const Camera& camera, Vector lamp) {
  Profile p;
  const int r = image.channel("R"), g = image.channel("G"), b = image.channel("B");
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const auto [angle, azimuth] = polar(lamp, camera.direction(x + 0.5, y + 0.5));
      if (!looked_at(o, azimuth)) continue;
      bool masked = false;
      for (size_t m = 0; m + 2 < o.masks.size(); m += 3)
        masked |= std::hypot(x + 0.5 - o.masks[m], y + 0.5 - o.masks[m + 1]) < o.masks[m + 2];
      if (masked) continue;
      const double rgb[3] = {image.at(x, y, r), image.at(x, y, g), image.at(x, y, b)};
      p.add(angle, rgb, 1);
    }
  return p;
}

Profile predict(const RingsOptions& o, const Camera& camera, int width, int height, Vector lamp_direction) {
  const double a = parse_length_m(o.radius), pane = parse_length_m(o.pane_distance),
               depth = parse_length_m(o.lamp_distance);
  const double correlation = o.correlation_radius.empty() ? a : parse_length_m(o.correlation_radius);
  const double lamp_radius = parse_length_m(o.lamp_diameter) / 2;
  const optics::ScattererLayer layer(a, correlation, o.area_fraction);
  const auto illuminant = find_illuminant(o.illuminant);
  if (!illuminant)
    throw Error("unknown illuminant \"" + o.illuminant + "\"" +
                did_you_mean(o.illuminant, illuminant_names()));

  // One sum over wavelengths serves all directions: it depends on s = |(w - v)_xy| alone.
  constexpr int kTable = 4000;
  constexpr double kLargest = 0.2;
  const Observer& observer = cie_1931_observer();
  std::vector<std::array<double, 3>> rgb(kTable + 1);
  for (int i = 0; i <= kTable; ++i) {
    const double s = kLargest * i / kTable;
    double xyz[3] = {};
    for (size_t k = 0; k < observer.y.size(); ++k) {
      const double nm = observer.start_nm + observer.step_nm * double(k), spectrum = illuminant->at(nm);
      if (spectrum == 0) continue;
      const double j = spectrum / (nm * nm) * layer.intensity(2 * M_PI / (nm * 1e-9) * s);
      xyz[0] += observer.x[k] * j, xyz[1] += observer.y[k] * j, xyz[2] += observer.z[k] * j;
    }
    float out[3];
    // Scaled so that single precision is far from its limits.
    for (double& v : xyz) v *= 1e12;
    xyz_to_srgb(xyz, out);
    for (int c = 0; c < 3; ++c) rgb[i][c] = out[c];
  }

  const Vector lamp{lamp_direction.x / lamp_direction.z * depth, lamp_direction.y / lamp_direction.z * depth,
                    depth};
  const Vector right = unit({lamp_direction.z, 0, -lamp_direction.x}), up = cross(lamp_direction, right);
  constexpr int kAzimuths = 144, kRings = 3, kSpokes = 8;
  Profile p;
  for (int m = 0; m < kAzimuths; ++m) {
    const double azimuth = 360.0 * (m + 0.5) / kAzimuths;
    if (!looked_at(o, azimuth)) continue;
    for (int i = 0; i < Profile::kBins; ++i) {
      const double angle = (i + 0.5) * Profile::kStep, c = std::cos(azimuth * kDegree),
                   s = std::sin(azimuth * kDegree);
      const double t = std::tan(angle * kDegree);
      const Vector v = unit({lamp_direction.x + t * (c * right.x + s * up.x),
                             lamp_direction.y + t * (c * right.y + s * up.y),
                             lamp_direction.z + t * (c * right.z + s * up.z)});
      // Only what the picture shows.
      const double px = camera.center_x + v.x / v.z / camera.tangent_per_pixel;
      const double py = camera.center_y - v.y / v.z / camera.tangent_per_pixel;
      if (px < 0 || py < 0 || px >= width || py >= height) continue;
      bool masked = false;
      for (size_t k = 0; k + 2 < o.masks.size(); k += 3)
        masked |= std::hypot(px - o.masks[k], py - o.masks[k + 1]) < o.masks[k + 2];
      if (masked) continue;
      const Vector on_pane{v.x / v.z * pane, v.y / v.z * pane, pane};
      double sum[3] = {};
      for (int ring = 0; ring < kRings; ++ring)
        for (int spoke = 0; spoke < kSpokes; ++spoke) {
          // Rings of equal area of the disc as which the lamp is seen.
          const double r = lamp_radius * std::sqrt((ring + 0.5) / kRings),
                       f = 2 * M_PI * (spoke + 0.5 * (ring % 2)) / kSpokes;
          const double e = r * std::cos(f), h = r * std::sin(f);
          const Vector to{lamp.x + e * right.x + h * up.x - on_pane.x,
                          lamp.y + e * right.y + h * up.y - on_pane.y,
                          lamp.z + e * right.z + h * up.z - on_pane.z};
          const Vector w = unit(to);
          // 1/d^2: the solid angle of the lamp from here; w.z: the cosine at the pane.
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
  const Image image = read_image(o.picture);
  if (image.channel("R") < 0 || image.channel("G") < 0 || image.channel("B") < 0)
    throw Error(o.picture + ": needs the channels R, G and B");
  if (o.azimuths.size() != 2 || o.at.size() % 2 || o.masks.size() % 3)
    throw Error("rings: too few numbers in an option");
  if (!(o.fov > 0 && o.fov < 180)) throw Error("--fov must be between 0 and 180 degrees");
  const Camera camera{2 * std::tan(0.5 * o.fov * kDegree) / image.width, 0.5 * image.width,
                      0.5 * image.height};

  double x, y;
  if (o.at.size() == 2) {
    x = o.at[0], y = o.at[1];
  } else {
    // The middle of the pixels near the brightest white one that have a good part of its brightness.
    const auto white = [&image](int i, int j) {
      const auto value = [&](const char* name) { return image.at(i, j, size_t(image.channel(name))); };
      return std::min({value("R"), value("G"), value("B")});
    };
    int bx = 0, by = 0;
    for (int j = 0; j < image.height; ++j)
      for (int i = 0; i < image.width; ++i)
        if (white(i, j) > white(bx, by)) bx = i, by = j;
    double w = 0, sx = 0, sy = 0;
    for (int j = std::max(by - 8, 0); j < std::min(by + 9, image.height); ++j)
      for (int i = std::max(bx - 8, 0); i < std::min(bx + 9, image.width); ++i)
        if (const double v = white(i, j); v > 0.1 * white(bx, by))
          w += v, sx += v * (i + 0.5), sy += v * (j + 0.5);
    x = sx / w, y = sy / w;
  }
  const Vector lamp = camera.direction(x, y);
  const Profile measured = measure(o, image, camera, lamp);
  const Profile predicted = predict(o, camera, image.width, image.height, lamp);

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

}  // namespace

void add_rings_command(CLI::App& app, CommandResult& result) {
  CLI::App* c =
      app.add_subcommand("rings", "Measure the rings of a corona in a picture and compare them with theory");
  auto o = std::make_shared<RingsOptions>();
  c->add_option("picture", o->picture, "EXR with the channels R, G, B; the lamp must not be clipped")
      ->required();
  c->add_option("--at", o->at, "pixel of the lamp, x y (default: the brightest white one)")->expected(2);
  c->add_option("--azimuths", o->azimuths,
                "look only at these directions from the lamp, degrees, 0 right, 90 up")
      ->expected(2);
  c->add_option("--mask", o->masks, "leave out a disc of the picture, x y radius in pixels; may be repeated")
      ->type_size(3);
  c->add_option("--fov", o->fov, "horizontal field of view, degrees")->capture_default_str();
  c->add_option("--illuminant", o->illuminant, "CIE name of the lamp's spectrum")->capture_default_str();
  c->add_option("--radius", o->radius, "radius of the circles")->capture_default_str();
  c->add_option("--correlation-radius", o->correlation_radius, "of the hard discs (default: radius)");
  c->add_option("--area-fraction", o->area_fraction, "covered by the hard discs")->capture_default_str();
  c->add_option("--pane-distance", o->pane_distance, "from the camera along its axis")->capture_default_str();
  c->add_option("--lamp-distance", o->lamp_distance, "from the camera along its axis")->capture_default_str();
  c->add_option("--lamp-diameter", o->lamp_diameter, "of a round lamp")->capture_default_str();
  c->add_option("--smooth", o->smooth, "half the width of the fit that finds extrema, degrees")
      ->capture_default_str();
  c->callback([=, &result] { result.exit_code = rings(*o); });
}

}  // namespace aureole

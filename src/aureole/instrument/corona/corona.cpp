// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/corona/corona.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "aureole/core/error.h"
#include "aureole/core/units.h"
#include "aureole/loading/values.h"
#include "aureole/math/vec.h"
#include "aureole/spectrum/observer.h"
#include "aureole/spectrum/tables.h"

namespace aureole {
Direction unit(Direction v) {
  const double l = std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z);
  return {v.x / l, v.y / l, v.z / l};
}
Direction cross(Direction a, Direction b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
double length(Direction v) { return std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z); }
double dot(Direction a, Direction b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

std::pair<double, double> polar_about(Direction lamp, Direction v) {
  const Direction right = unit({lamp.z, 0, -lamp.x}), up = cross(lamp, right);
  const double a = std::atan2(dot(v, up), dot(v, right)) / kDegree;
  return {std::atan2(length(cross(lamp, v)), dot(lamp, v)) / kDegree, a < 0 ? a + 360 : a};
}

bool PictureParts::has_azimuth(double azimuth) const {
  double end = to;
  while (end <= from) end += 360;  // the range of azimuths passes through 0
  return azimuth - 360 * std::floor((azimuth - from) / 360) <= end;
}

PictureParts picture_parts(const std::vector<double>& azimuths, const std::vector<double>& masks) {
  if (azimuths.size() != 2) throw Error("--azimuths: two numbers are needed, in degrees");
  for (const double a : azimuths)
    if (!(std::abs(a) <= 360)) throw Error(fmt::format("--azimuths: {:g} degrees are not in [-360, 360]", a));
  if (azimuths[0] == azimuths[1])
    throw Error(fmt::format("--azimuths: the range from {0:g} to {0:g} degrees is empty", azimuths[0]));
  const PictureParts parts{azimuths[0], azimuths[1], masks};
  if (masks.size() % 3)
    throw Error("--mask: three numbers are needed for each disc: x, y and radius in pixels");
  for (size_t m = 0; m < masks.size(); m += 3) {
    if (!std::isfinite(masks[m]) || !std::isfinite(masks[m + 1]) || !std::isfinite(masks[m + 2]))
      throw Error("--mask: a number is not finite");
    if (!(masks[m + 2] > 0))
      throw Error(fmt::format("--mask: the radius {:g} is not positive", masks[m + 2]));
  }
  return parts;
}

bool PictureParts::is_masked(double x, double y) const {
  bool masked = false;
  for (size_t m = 0; m + 2 < discs.size(); m += 3)
    masked |= std::hypot(x - discs[m], y - discs[m + 1]) < discs[m + 2];
  return masked;
}

void CoronaProfile::add(double degrees, const double rgb[3], double w) {
  const int i = int(degrees / kStep);
  if (degrees < 0 || i >= kBins) return;
  for (int c = 0; c < 3; ++c) sum[i][c] += w * rgb[c];
  weight[i] += w;
}

std::array<double, 2> CoronaProfile::fit(int c, double x, double window) const {
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

double CoronaProfile::extremum(int c, double from, bool maximum, double window) const {
  const double s = maximum ? 1 : -1;
  double before = s * fit(c, from, window)[1];
  for (double x = from + 0.005; x < kEnd - window; x += 0.005) {
    const double slope = s * fit(c, x, window)[1];
    if (before > 0 && slope <= 0) return x - 0.005 * slope / (slope - before);
    before = slope;
  }
  return -1;
}

std::array<double, 2> brightest_spot(const Image& image, const PictureParts& parts) {
  // Finds the centroid of the white pixels near the brightest white pixel that have at least a certain
  // fraction of its brightness.
  const auto white = [&](int i, int j) {
    if (parts.is_masked(i + 0.5, j + 0.5)) return -INFINITY;
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
  if (!(w > 0)) return {bx + 0.5, by + 0.5};
  return {sx / w, sy / w};
}

LampSpectrum lamp_spectrum(const std::string& name) {
  LampSpectrum out;
  const Observer& observer = cie_1931_observer();
  const auto sample = [&](const TabulatedSpectrum& t) {
    for (size_t k = 0; k < observer.y.size(); ++k) {
      const double nm = observer.start_nm + observer.step_nm * double(k), power = t.at(nm);
      if (power != 0) out.nm.push_back(nm), out.power.push_back(power);
    }
  };
  if (const auto illuminant = find_illuminant(name)) {
    sample(*illuminant);
    return out;
  }
  std::error_code code;
  if (std::filesystem::exists(name, code)) {
    const SpectrumLiteral s = read_spectrum_file(name);
    sample({s.nm, s.values});
    for (const double p : out.power)
      if (p < 0) throw Error({name, 0, 0}, "a lamp has no negative power");
    if (out.nm.empty()) throw Error({name, 0, 0}, "has no power between 360 and 830 nm");
    return out;
  }
  try {
    const double nm = parse_wavelength_nm(name);
    if (!(nm >= 380 && nm <= 780)) throw Error("the wavelength " + name + " is not visible (380 to 780 nm)");
    return {{nm}, {1}};
  } catch (const Error& e) {
    if (!name.empty() && (name[0] >= '0' && name[0] <= '9')) throw;
  }
  throw Error("unknown illuminant \"" + name + "\"" + did_you_mean_or_all(name, illuminant_names()) +
              " (and there is no file of that name)");
}

std::array<double, 3> corona_colour(const LampSpectrum& lamp,
                                    const std::function<double(double)>& intensity) {
  const Observer& observer = cie_1931_observer();
  double xyz[3] = {};
  for (size_t i = 0; i < lamp.nm.size(); ++i) {
    const double nm = lamp.nm[i], at = (nm - observer.start_nm) / observer.step_nm;
    const size_t k = std::min(size_t(at), observer.y.size() - 2);
    const double t = at - double(k);
    const auto response = [&](std::span<const double> v) {
      return t == 0 ? v[k] : v[k] + t * (v[k + 1] - v[k]);
    };
    const double j = lamp.power[i] / (nm * nm) * intensity(2 * M_PI / (nm * 1e-9));
    xyz[0] += response(observer.x) * j, xyz[1] += response(observer.y) * j,
        xyz[2] += response(observer.z) * j;
  }
  float out[3];
  // The sum is scaled to keep single precision away from its limits.
  for (double& v : xyz) v *= 1e12;
  xyz_to_srgb(xyz, out);
  return {out[0], out[1], out[2]};
}

}  // namespace aureole

// SPDX-License-Identifier: Apache-2.0
// The corona of one lamp in a picture: the directions of pixels, the profile around the lamp, and colours of
// light diffracted by a given angle. Camera axis and pane of scatterers are perpendicular.
#pragma once

#include <array>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "aureole/core/image.h"

namespace aureole {

struct Direction {
  double x, y, z;
};
Direction unit(Direction v);
Direction cross(Direction a, Direction b);
double length(Direction v);
double dot(Direction a, Direction b);

/// The camera at the origin looks along +z, x to the right and y up in the picture.
struct PinholeCamera {
  double tangent_per_pixel, center_x, center_y;
  Direction direction(double x, double y) const {
    return unit({(x - center_x) * tangent_per_pixel, (center_y - y) * tangent_per_pixel, 1});
  }
};

/// Angle from the lamp in degrees and azimuth around it, 0 to the right and 90 upwards.
std::pair<double, double> polar_about(Direction lamp, Direction v);

/// The pixels that count: azimuths from ... to in degrees, discs (x, y, radius in pixels) left out.
struct PictureParts {
  double from = 0, to = 360;
  std::vector<double> discs;
  bool has_azimuth(double azimuth) const;
  bool is_masked(double x, double y) const;
};

/// Angles from the lamp's centre, in degrees: R, G, B means over the azimuths that count.
struct CoronaProfile {
  static constexpr double kStep = 0.04, kEnd = 7;
  static constexpr int kBins = int(kEnd / kStep);
  std::vector<std::array<double, 3>> sum = std::vector<std::array<double, 3>>(kBins);
  std::vector<double> weight = std::vector<double>(kBins);

  void add(double degrees, const double rgb[3], double w);
  /// The parabola through the bins within `window` degrees of x, by least squares: its value and slope at x.
  std::array<double, 2> fit(int c, double x, double window) const;
  /// The first extremum beyond `from`: where the slope changes its sign to negative (a maximum) or positive.
  /// Negative if none.
  double extremum(int c, double from, bool maximum, double window) const;
};

/// Centre of the brightest white spot, pixels.
std::array<double, 2> brightest_spot(const Image& image);

/// Power of a lamp at wavelengths in nm; any scale.
struct LampSpectrum {
  std::vector<double> nm, power;
};
/// A CIE illuminant, a text file of two columns (nm, power) or one wavelength such as "589nm". Every 1 nm of
/// the observer. Throws Error.
LampSpectrum lamp_spectrum(const std::string& name);

/// Linear sRGB of sum over wavelengths of power xyz `intensity`(2 pi/lambda)/lambda^2, in metres.
std::array<double, 3> corona_colour(const LampSpectrum& lamp, const std::function<double(double)>& intensity);

}  // namespace aureole

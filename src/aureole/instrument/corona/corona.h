// SPDX-License-Identifier: Apache-2.0
// The corona around a light source in a picture: the directions of pixels, the profile around the source, and
// colours of light diffracted by a given angle. The camera's axis is perpendicular to the pane of scatterers.
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

/// A camera at the origin that looks along +z, with x to the right and y up in the picture.
struct PinholeCamera {
  double tangent_per_pixel, center_x, center_y;
  Direction direction(double x, double y) const {
    return unit({(x - center_x) * tangent_per_pixel, (center_y - y) * tangent_per_pixel, 1});
  }
};

/// Returns the angle between a direction and the light source in degrees, and the azimuth around the light
/// source in degrees: 0 to the right, 90 upwards.
std::pair<double, double> polar_about(Direction lamp, Direction v);

/// The pixels to be used: azimuths `from` ... `to` in degrees, without discs (x, y, radius in pixels). `from` 300 and
/// `to` 60 are the 120 degrees through 0.
struct PictureParts {
  double from = 0, to = 360;
  std::vector<double> discs;
  bool has_azimuth(double azimuth) const;
  bool is_masked(double x, double y) const;
};

/// Reads the options --azimuths (two numbers) and --mask (three numbers for each disc). Throws Error that names the
/// option for azimuths beyond [-360, 360], for an empty range, and for a disc without a positive radius.
PictureParts picture_parts(const std::vector<double>& azimuths, const std::vector<double>& masks);

/// Profile over the angle from the source's centre [degrees]: means of R, G, B over the selected azimuths.
struct CoronaProfile {
  static constexpr double kStep = 0.04, kEnd = 7;
  static constexpr int kBins = int(kEnd / kStep);
  std::vector<std::array<double, 3>> sum = std::vector<std::array<double, 3>>(kBins);
  std::vector<double> weight = std::vector<double>(kBins);

  void add(double degrees, const double rgb[3], double w);
  /// Fits a parabola to the bins within `window` degrees of x, by least squares; returns its value and slope
  /// at x.
  std::array<double, 2> fit(int c, double x, double window) const;
  /// Returns the first extremum beyond `from`, where the slope becomes negative (a maximum) or positive (a
  /// minimum). Negative if there is none.
  double extremum(int c, double from, bool maximum, double window) const;
};

/// Centre of the brightest white spot [pixels] outside of the masked discs.
std::array<double, 2> brightest_spot(const Image& image, const PictureParts& parts = {});

/// Centre of a corona [pixels]: the brightest spot or, where values of at least `clip` cover an area, the point about
/// which the picture is most symmetric. Masked discs are left out; the range of azimuths is not applied,
/// since azimuths need a centre.
std::array<double, 2> corona_centre(const Image& image, double clip, const PictureParts& parts);

/// Relative power of a light source at wavelengths in nm.
struct LampSpectrum {
  std::vector<double> nm, power;
};
/// Reads a spectrum: a CIE illuminant, a text file of two columns (nm, power) or one wavelength such as
/// "589nm". It is sampled every 1 nm over the observer's range. Throws Error.
LampSpectrum lamp_spectrum(const std::string& name);

/// Linear sRGB of the sum over wavelengths (in metres) of power xyz `intensity`(2 pi/lambda)/lambda^2.
std::array<double, 3> corona_colour(const LampSpectrum& lamp, const std::function<double(double)>& intensity);

}  // namespace aureole

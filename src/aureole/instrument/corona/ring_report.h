// SPDX-License-Identifier: Apache-2.0
// Measures the rings of a corona around a light source in a picture and compares them with a prediction by
// quadrature. Inputs are the spectrum of the source, the size of the scatterers and the positions of camera,
// pane and source. The prediction is
//     L(v) = integral over the source and over wavelengths of
//            S(lambda) xyz(lambda) (1/lambda^2) J(k |(w - v)_xy|) dw,
// with v from the camera to a point of the pane, w from there to a point of the source, and J of
// `optics::ScattererLayer` (Yang, Kim, Pediredla & Jarosz, "A wave-optics BSDF for correlated scatterers",
// 2025, equation 14). It uses no BSDF. The camera axis is perpendicular to the pane. Factors that are smooth
// over the corona (reflection of the pane) are omitted.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "aureole/core/image.h"
#include "aureole/instrument/corona/corona.h"

namespace aureole {

/// Lengths are texts with their units.
struct RingSettings {
  std::string illuminant = "LED-B3", radius = "5um", correlation_radius;  ///< empty: as `radius`
  std::string pane_distance = "0.5m", lamp_distance = "14m", lamp_diameter = "36mm";
  double area_fraction = 0.5;
  double fov = 30;                       ///< horizontal field of view [degrees]
  double smooth = 0.25;                  ///< half-width of the window of fits to extrema [degrees]
  std::vector<double> at;                ///< pixel of the source, x and y; empty: the brightest white one
  std::vector<double> azimuths{0, 360};  ///< as in `picture_parts`
  std::vector<double> masks;             ///< as in `picture_parts`
};

/// Angles from the source in degrees; negative for an extremum that is not there.
struct RingAngles {
  double first_maximum = -1, next_minimum = -1;
};

struct RingReport {
  std::array<double, 2> at{};  ///< pixel of the source
  CoronaProfile measured, predicted;
  std::array<RingAngles, 3> measured_rings, predicted_rings;  ///< of R, G, B

  bool is_complete() const;  ///< whether all extrema are there
};

/// Measures a picture with the channels R, G, B, in which the source is not clipped. Throws Error that names the option, or
/// `name`, the picture.
RingReport measure_rings(const Image& image, const std::string& name, const RingSettings& settings);

}  // namespace aureole

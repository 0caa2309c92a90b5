// SPDX-License-Identifier: Apache-2.0
// Radius and area fraction of clear circular scatterers (droplets, spores, powder) on a pane, from the rings around a light
// source in a photo, or from angles read off a photo.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "aureole/core/image.h"
#include "aureole/instrument/corona/corona_fit.h"

namespace aureole {

/// Lengths and angles are texts with their units; empty where they are not given.
struct DropletSettings {
  std::string photo;  ///< the name of the picture, for messages; empty: `angles` are fitted
  std::string pixel_angle, lamp = "D65", angles, angle_error = "0.05deg", substrate = "none";
  std::string pane_distance, lamp_distance, lamp_angle, inner, correlation = "simulated";
  double fov = 0;             ///< horizontal field of view [degrees]; 0: `pixel_angle` is given
  double area_fraction = -1;  ///< fixed area fraction of angles; -1: fitted
  double index = 1.5;         ///< IOR of the pane, if `substrate` is thindielectric
  bool spread = false, second_size = false;
  std::vector<double> center;            ///< of the source in pixels, x and y; empty: found
  std::vector<double> azimuths{0, 360};  ///< as in `picture_parts`
  std::vector<double> masks;             ///< as in `picture_parts`
};

struct DropletMeasurement {
  CoronaFit fit;
  std::array<double, 2> center{};  ///< of the source [pixels]
  ScatteredProfile profile;        ///< empty where angles were fitted
  std::vector<std::string> notes;  ///< doubts about the result

  /// Angle of a ring of the profile [degrees].
  double ring_deg(std::size_t ring) const;
};

/// Throws Error that names the option, for contradictions before the picture is looked at.
void require_droplet_settings(const DropletSettings& settings);

/// Measures `image`, the photo as it was read, or fits the angles of the settings. Throws Error as
/// `require_droplet_settings` does, and for a photo without rings.
DropletMeasurement measure_droplets(const DropletSettings& settings, const Image& image);

}  // namespace aureole

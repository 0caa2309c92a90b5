// SPDX-License-Identifier: Apache-2.0
// The scenes of goniometers and of instruments like them: a lamp, detectors or a cosine receiver about a specimen in the plane z = 0.
#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include "aureole/core/image.h"
#include "aureole/instrument/laboratory/goniometer.h"

namespace aureole {

/// A unit vector at a polar angle from +z and an azimuth from +x [degrees].
std::array<double, 3> gonio_direction(double theta, double phi);

class GonioScenes {
public:
  /// Both are referred to while scenes are made.
  GonioScenes(const Bench& bench, const GoniometerSettings& settings) : bench_(bench), s_(settings) {}

  /// The specimen, turned about its normal by -turn degrees: as if lamp and detectors had turned.
  void add_specimen(const Specimen& specimen, double turn = 0);
  /// A lamp at an angle in the plane y = 0, which the sample sees under `half_angle` [degrees].
  void add_lamp(double theta, double half_angle);
  /// Light of the radiance 1 from everywhere. A black floor keeps it from the back of what transmits.
  void add_even_light();
  /// Light of a map in latitude and longitude, whose upper half is above the sample, with the same floor.
  void add_light(const Image& map);
  /// Detectors at pairs of a polar angle and an azimuth [degrees].
  void add_detectors(const std::vector<std::array<double, 2>>& directions);
  /// A cosine receiver of the viewed area, for light that has been scattered (it faces the sample) or comes from everywhere.
  void add_receiver(bool faces_up);
  /// A cosine receiver that faces the sample: a disc of this radius at x [m], or a strip across x, as long as the sample.
  void add_receiver_beside(double x_m, double radius_m, bool is_strip);
  /// A perfect diffuser, viewed along the normal: it has the irradiance of the viewed area over pi for radiance.
  void add_diffuser();
  /// Traced from the detectors, or by `ptracer` from the lamp.
  Readings read(const char* integrator = "path") const {
    return bench_.trace(content_, given_, detectors_, integrator);
  }

private:
  void add_disc(const Transform& place, double radius, const std::string& inner);
  void add_floor();

  const Bench& bench_;
  const GoniometerSettings& s_;
  std::string content_;
  std::map<std::string, ObjectPtr> given_;
  std::size_t detectors_ = 1;
};

}  // namespace aureole

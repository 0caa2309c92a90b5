// SPDX-License-Identifier: Apache-2.0
// A goniometer: a lamp and detectors with apertures around a specimen, which is traced. Its table is a material again.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "aureole/instrument/laboratory/bench.h"
#include "aureole/instrument/laboratory/specimen.h"

namespace aureole {

struct GoniometerSettings {
  double lamp_angle = 0.5;      ///< half of the angle under which the sample sees the lamp [degrees]
  double detector_angle = 0.5;  ///< half of the angle under which it sees a detector [degrees]
  double distance_m =
      0.5;  ///< of the detectors; the lamp is 5 % farther, so that a detector can stand before it
  double viewed_m = 10e-3;    ///< diameter of the viewed area [m]
  double lit_m = 20e-3;       ///< diameter of the lit area [m]
  double sample_m = 60e-3;    ///< extent of the specimen [m]
  bool by_reference = false;  ///< compare with a Lambertian standard; else measure the incident irradiance
  double standard = 0.99;     ///< reflectance of that standard
  double noise = 0;           ///< of a detector's signal, relative to it
  double dark_noise = 0;      ///< of a detector without light [1/sr]
  double angle_error = 0;     ///< standard deviation of the polar angles of lamp and detectors [degrees]
};

/// Which pairs of directions are measured.
struct GonioPlan {
  enum class Kind { in_plane, hemispherical, adaptive } kind = Kind::hemispherical;
  std::vector<double> incident{0, 15, 30, 45, 60, 75};  ///< angles of incidence [degrees]
  std::vector<double> azimuths{0};  ///< of incidence [degrees]; several: the sample is turned
  int directions = 200;             ///< of detectors for each direction of incidence and side
  bool transmits = false;           ///< also below the sample
};
/// Directions (polar angle, azimuth relative to the incident one) [degrees] of a plan that does not adapt: rings of equal
/// width, or both sides of the plane of incidence.
std::vector<std::array<double, 2>> outgoing_directions(GonioPlan::Kind kind, int count);

/// Distance of the lamp over the one of the detectors.
inline constexpr double kLampFarther = 1.05;

struct GonioReading {
  double theta_i, phi_i, theta_o, phi_o;  ///< [degrees]; theta_o above 90: transmitted
  std::vector<double> f, error;           ///< [1/sr] and its standard uncertainty, by band
};
struct GonioTable {
  std::vector<double> nm;
  std::vector<GonioReading> readings;
  std::vector<std::string> notes;
};

/// Measures f = L/E, flux over (irradiance, projected solid angle and area), as F. E. Nicodemus and others defined it (NBS
/// Monograph 160, 1977). A mirror reads its reflectance over the detector's projected solid angle. Throws Error for sizes that do not
/// fit each other, and for angles outside of [0, 89].
GonioTable measure_scattering(const Bench& bench, const Specimen& specimen,
                              const GoniometerSettings& settings, const GonioPlan& plan);

/// The table as `tabulated` reads it, with standard uncertainties.
std::string gonio_table_content(const GonioTable& table);
/// Reads a table of any goniometer, as `tabulated` does, for fits; notes say where it has no uncertainties. Throws Error located at
/// the line.
GonioTable read_gonio_table(const std::string& file);

/// Reflectances of a specimen by traced instruments, of one band each: means over the bands.
struct ReflectanceReport {
  struct Directional {
    double angle;  ///< [degrees]
    Ratio dh;      ///< directional-hemispherical: light of a lamp, collected by a cosine receiver
    Ratio hd;      ///< hemispherical-directional: even light, viewed at this angle
  };
  std::vector<Directional> angles;
  Ratio hh;  ///< hemispherical-hemispherical
  /// The part of the light of a stated distribution that is scattered into the hemisphere, E_o/E_i.
  std::optional<Ratio> of_light;
  /// Light of a cone that is scattered into a cone (biconical reflectance), over the light that arrives.
  struct Cones {
    double theta_i, half_i, theta_o, half_o;  ///< angles of the axes and half-angles [degrees]
    Ratio reflectance;
    double factor = 0;  ///< over that of a perfect diffuser, sin^2(half_o) cos(theta_o)
  };
  std::vector<Cones> cones;
  /// f(i, o) and f(o, i) at pairs of angles in the plane of incidence, on both sides of the normal [1/sr].
  struct Pair {
    double i, o;
    Ratio forward, backward;
  };
  std::vector<Pair> pairs;
  /// f at incidence of 45 degrees, viewed at 30 degrees 90 degrees aside, while the specimen turns.
  std::vector<std::array<double, 3>> turns;  ///< azimuth [degrees], f, standard error [1/sr]
  /// The largest difference of `turns` over their mean, and whether it exceeds their errors.
  double anisotropy = 0;
  bool is_isotropic = true;
};
struct ReportSettings {
  /// Radiance of the incident light: pairs of an angle from the normal [degrees] and a radiance, as "0:1, 60:0.5, 90:0.1", linear
  /// between them; or a picture in latitude and longitude, whose upper half is above the sample; empty: none.
  std::string light;
  /// theta_i, half_i, theta_o, half_o of pairs of cones [degrees], the outgoing one at the azimuth of the mirror direction
  std::vector<std::array<double, 4>> cones;
};
/// Throws Error, which begins with the name of an option, for light and cones that are none.
ReflectanceReport report_reflectances(const Bench& bench, const Specimen& specimen,
                                      const GoniometerSettings& settings, const ReportSettings& report = {});
std::string report_text(const ReflectanceReport& report);

}  // namespace aureole

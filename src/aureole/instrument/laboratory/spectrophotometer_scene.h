// SPDX-License-Identifier: Apache-2.0
// The scenes of spectrophotometers: lamps, detectors, integrating spheres with ports and baffles, around a specimen in the plane
// z = 0. Lengths are in metres here and in scene units in the text.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "aureole/instrument/laboratory/spectrophotometer.h"

namespace aureole {

/// The text of a scene under construction, with the objects that it is given and its number of detectors.
struct InstrumentScene {
  std::string content;
  std::map<std::string, ObjectPtr> given;
  std::size_t detectors = 1;
  /// A beam into a sphere is followed from its lamp: paths from the wall rarely find what it lights in the sample.
  const char* integrator = "path";
};

class SpectrophotometerScenes {
public:
  /// Throws Error for sizes that do not fit each other.
  SpectrophotometerScenes(const Bench& bench, const SpectrophotometerSettings& settings);

  enum class Reads { sample, standard_beside, reference_beam, irradiance };
  /// The instrument with this specimen. With a `beside` both are in the sphere at once. `reference_beam`: the light of the
  /// reference beam instead of what passes the specimen. `irradiance` is what arrives at the sample's surface, without a
  /// sample where the instrument has no sphere.
  InstrumentScene instrument(const Specimen& specimen, const Specimen* beside, Reads reads) const;
  /// The specimen in even light from all directions of the sphere, less the ports, as the instrument views it. Geometries
  /// with a collecting sphere are reversed (Helmholtz).
  InstrumentScene in_even_light(const Specimen& specimen, Reads reads) const;
  /// The specimen in even light, read by a cosine receiver that faces it: its reflectance for diffuse light.
  InstrumentScene diffuse_reflection(const Specimen& specimen) const;

  /// Whether a sphere that collects transmitted light has a second beam, which falls on its wall beside the specimen's light: both
  /// readings have the specimen and all ports in place, so that the sphere is equally bright.
  bool has_reference_beam() const;
  /// The flux of the reference beam over the one that falls on the specimen.
  double reference_flux() const;

  /// The sphere as closed formulas see it.
  IntegratingSphere sphere() const;

private:
  using End = MeasuringGeometry::End;
  double radius() const { return 0.5 * s_.sphere_m; }
  double port() const { return 0.5 * s_.port_m; }
  /// Distance of the sphere's centre from the plane of its port.
  double height() const;
  /// Length of the chord from the centre of the port at this angle from the axis [radians].
  double chord(double angle) const;
  double view_angle() const;
  double specular_radius() const;
  /// Positions of the ports other than the sample's: directions from the centre of the sphere, and radii.
  struct Port {
    std::array<double, 3> direction;
    double radius;
  };
  std::vector<Port> ports() const;
  bool light_is_reversed() const;
  /// Radius of the reference beam's lamp, and its distance from the sphere's centre.
  double reference_radius() const;
  double reference_depth() const;

  void add_disc(InstrumentScene& scene, const Transform& place, double r, const std::string& inner) const;
  void add_port(InstrumentScene& scene, const Transform& station, const Port& port) const;
  void add_specimen(InstrumentScene& scene, const Specimen& specimen, const Transform& station,
                    const char* key) const;
  void add_lamp(InstrumentScene& scene, double theta, double phi, double distance, double r,
                double target) const;
  /// A lamp inside the sphere, a disc of radius r whose light all passes the target: a disc as wide as the lit area.
  void add_lamp_in_port(InstrumentScene& scene, const Transform& place, double r, const Vec3& target,
                        const Vec3& target_normal) const;
  void add_detectors(InstrumentScene& scene, const std::string& directions, std::size_t count,
                     double distance, double field, double aperture, const Transform& station) const;
  void add_receiver(InstrumentScene& scene, double z, bool faces_up, const Transform& station) const;
  void add_sphere(InstrumentScene& scene, const Transform& station, bool has_hole) const;
  void add_baffle(InstrumentScene& scene, const Transform& station, const std::array<double, 3>& from,
                  const std::array<double, 3>& to, double r) const;
  void add_view(InstrumentScene& scene, const Transform& station) const;
  /// A black box below the plane z = 0, with a hole of the port's size for the sample.
  void add_dark_room(InstrumentScene& scene) const;
  std::string text(double metres) const { return bench_.length(metres); }
  Transform placed(double x, double y, double z, const std::array<double, 3>& normal) const;

  const Bench& bench_;
  SpectrophotometerSettings s_;
};

}  // namespace aureole

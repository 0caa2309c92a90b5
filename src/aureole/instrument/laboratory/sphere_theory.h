// SPDX-License-Identifier: Apache-2.0
// The integrating sphere in closed form: its ports, its throughput, and the error of measuring by substitution.
#pragma once

#include <vector>

namespace aureole {

/// The part of a sphere's surface that a round port of this radius cuts off: (1 - sqrt(1 - (r/R)^2))/2.
double port_fraction(double port_radius, double sphere_radius);

/// A sphere of even, diffuse walls (D. G. Goebel, "Generalized integrating-sphere theory", Applied Optics 6(1), 1967). Ports are
/// fractions of its surface.
struct IntegratingSphere {
  double wall = 0.97;  ///< reflectance of the wall
  double ports = 0;    ///< all ports but that of the sample: black, or with the mean reflectance `in_ports`
  double sample_port = 0;  ///< the port of the sample
  double in_ports = 0;     ///< mean reflectance of what is in the other ports
  double baffles =
      0;  ///< area of the baffles, both sides, over the sphere's surface; they are as white as the wall
  /// Whether the sample is flat, so that none of its light returns to it at once. A curved one is a part of the sphere.
  bool is_flat = false;

  /// The fraction of diffuse light that each passage through the sphere keeps, with a sample of this reflectance for
  /// diffuse light in its port.
  double kept(double sample) const {
    const double area = 1 + baffles, f = sample_port / area;
    const double others = wall * (1 - (ports + sample_port) / area) + in_ports * ports / area;
    return is_flat ? others * (1 + sample * f / (1 - f)) : others + sample * f;
  }
  /// The flux on the whole surface over the flux that the lamp sends into the sphere.
  double throughput(double sample) const { return 1 / (1 - kept(sample)); }
  /// The reading of an instrument of one beam for a sample of the reflectance factor `sample`, whose reflectance for diffuse
  /// light is `sample_diffuse`: the standard of reflectance `standard` was in the port before, and a darker sample makes the
  /// sphere darker.
  double by_substitution(double sample, double sample_diffuse, double standard) const {
    return sample * throughput(sample_diffuse) / throughput(standard);
  }
};

}  // namespace aureole

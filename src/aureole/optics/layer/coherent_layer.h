// SPDX-License-Identifier: Apache-2.0
// Coherent transmission and reflection of a disordered monolayer of spherical particles that do not overlap,
// and the remaining power of diffuse light and absorption. Model: Garcia-Valenzuela, Gutierrez-Reyes &
// Barrera, "Multiple-scattering model for the coherent reflection and transmission of light from a disordered
// monolayer of particles", J. Opt. Soc. Am. A 29 (2012) 1161, in one medium. With alpha = 2 Fa/(x^2 cos_i),
// S_j at the scattering angle pi - 2 theta_i and D = 1 + alpha S(0) + (alpha^2/4)(S(0)^2 - S_j^2),
//     r_j = -alpha S_j/D,   t_j = (1 - (alpha^2/4)(S(0)^2 - S_j^2))/D.
//
// Energy. The layer is symmetric: it multiplies an even pair of incident waves by t + r, an odd one by t - r,
//     t +- r = (1 - s)/(1 + s),   s = (alpha/2)(S(0) +- S_j).
// Neither magnitude exceeds 1 if Re s >= 0, which holds for every passive sphere: |pi_n| and |tau_n| are
// largest forward, where the terms of S(0), n + 1/2 times a_n and b_n, have no negative real part. Hence
// |t|^2 + |r|^2 <= 1 for all sizes, indices, coverages and angles.
//
// Validity. For small coverages |t|^2 = 1 - Fa Qext/cos_i. Spheres much larger than the wavelength have
//     |t| = |1 - g|/(1 + g),   g = Fa/(2 cos_i).
// This is 0 at cos_i = Fa/2 and increases again for smaller cos_i, although real layers transmit less and
// less. The model is invalid there.
#pragma once

#include <array>
#include <complex>

#include "aureole/optics/particle/mie_sphere.h"

namespace aureole::optics {

struct CoherentLayer {
  /// Amplitudes relative to the incident wave, for light polarised perpendicular (0) and parallel (1) to the
  /// plane of incidence.
  std::array<std::complex<double>, 2> transmission, reflection;

  /// Returns the coherently transmitted fraction of unpolarised power.
  double transmittance() const { return 0.5 * (std::norm(transmission[0]) + std::norm(transmission[1])); }
  double reflectance() const { return 0.5 * (std::norm(reflection[0]) + std::norm(reflection[1])); }
  /// Returns the remaining fraction of power, which is scattered into other directions or absorbed.
  double loss() const {
    const double rest = 1 - transmittance() - reflectance();
    return rest > 0 ? rest : 0;
  }
};

/// The particles of a layer, by means over their distribution.
struct LayerSpheres {
  double size_squared;           ///< mean of x^2, with x = k radius in the medium
  std::complex<double> forward;  ///< mean forward amplitude S(0)
};

/// Returns the amplitudes of the layer. `specular`: the S_j. cos_i is in [0, 1]; at 0, grazing incidence, all
/// light is reflected.
CoherentLayer coherent_layer(double cos_i, double area_fraction, const LayerSpheres& spheres,
                             const MieAmplitudes& specular);

/// Returns the amplitudes of a layer of spheres of one size. Throws std::domain_error, with the value, unless
/// cos_i is in [0, 1] and the area fraction in [0, kMaxAreaFraction].
CoherentLayer coherent_layer(double cos_i, double area_fraction, const Mie& sphere);

}  // namespace aureole::optics

// SPDX-License-Identifier: Apache-2.0
// Transparent scatterers on a plane that change the phase of light: caps of spheres (droplets on glass) and flat
// discs. Each adds to the plane wave that passes the plane an amplitude of
//     F = sqrt(N) R - D,   D = pi circle_transform(u),
//     R(u, psi) = integral over the unit disc of t(r) exp(i psi h(r)) exp(-i u.x) d2x,
// the amplitude through the scatterer minus that which its base would transmit if it were empty. Lengths are
// relative to the radius a of the base, u = |q| a with the change q of the transverse wave vector, and h is the
// height over the largest height h0. The surface of the cap is a source of waves in Kirchhoff's approximation:
// at the height z light arrives with the phase k w z and leaves with k c z, where w and c are the normal components
// of the wave vectors within the cap and outside it, divided by the wave number k outside, so that
//     psi = k h0 (w - c).
// Where this phase is stationary, light is refracted by Snell's law at the slope of the cap, at any angle, and
//     N = (c - p_c.h')(w + p_f.h')/(c w),   h' = (p_c + p_f)/(w - c)
// makes its power that of geometrical optics, in which each tube of rays keeps its flux; p_c and p_f are the
// transverse vectors of the two directions, both outward, on the side of the cap and on its flat side, and h' is the
// gradient of the height. Far from grazing angles N is near 1.
// t is the amplitude that passes the surface at a slope, for light along the axis, over that of a flat surface; 0
// beyond the critical angle.
//
// Limits. For psi -> 0 and t = 1 F vanishes; a disc has F = (exp(i psi) - 1) D. For large psi R spreads over the angles
// to which rays are refracted, and near the forward direction F -> -D: an opaque disc (Babinet). Light that is
// reflected within a cap, by total reflection at slopes steeper than the critical angle (48.6 degrees in water), is
// not part of F.
//
// Source: the layer of complex amplitudes is that of Yang, Kim, Pediredla & Jarosz, "A wave-optics BSDF for
// correlated scatterers", 2025, with F in place of the transforms of apertures; the amplitude of thin phase objects is
// that of van de Hulst's anomalous diffraction (Light Scattering by Small Particles, 1957, chapter 11) for other
// shapes.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "aureole/core/parallel_for.h"
#include "aureole/optics/particle/size_distribution.h"

namespace aureole::optics {

/// The height of a scatterer above its base, and the amplitude of the transmitted light.
struct PhaseProfile {
  /// Contact angle of a cap [rad], in (0, pi/2]; 0: a flat disc.
  double contact_angle = 0;
  /// Index of the scatterer over that outside it, above 1; for the amplitude t of caps.
  double relative_index = 1;

  /// Returns h0/a of a cap.
  double cap_height() const;
};

/// Means over the sizes of a layer whose heights are in proportion to its radii. Lengths are relative to the
/// median size.
class PhaseScatterer {
public:
  /// Means of |R|^2, Re R D, Re R and Im R.
  struct Means {
    float squared, cross, real, imaginary;
  };

  /// A scatterer without tables, to be read.
  PhaseScatterer() = default;
  /// Tabulates up to `largest_u` and `largest_psi`. Throws std::domain_error for an invalid profile, if the table
  /// would exceed kMaxBytes, and if `largest_psi` exceeds kMaxPhase.
  PhaseScatterer(const PhaseProfile& profile, const SizeDistribution& sizes, double largest_u,
                 double largest_psi, const ParallelFor& parallel_for = serial_for);
  static constexpr std::size_t kMaxBytes = std::size_t(72) << 20;
  static constexpr double kMaxPhase = 2000;

  /// Interpolates the table by cubics; the error is 1e-3 of R(0, 0) for one size, and up to
  /// 4e-3 for a spread of 0.3. u and psi are clamped to the table.
  Means at(float u, float psi) const;

  /// Terms of the intensity of a layer, J = rho (U + C S') with the density rho of scatterers: C = |<F>|^2
  /// and U = <|F|^2> - C, both relative to a^4.
  struct Intensity {
    float uncorrelated, coherent;
  };
  /// Returns the terms of the intensity. `amplitude` is a factor of R beside sqrt(N).
  Intensity intensity(float u, float psi, float amplitude) const;

  /// Returns |1 + rho <F>|^2, the fraction of power in the undiffracted beam, for scatterers whose bases cover the
  /// fraction `covered` of the plane.
  float undiffracted(float psi, float amplitude, float covered) const;

  /// Returns the integral of t^2 over the base, over its area: the fraction of the light along the axis that
  /// a scatterer transmits.
  double transmittance() const { return transmittance_; }
  /// Returns the mean square of the sizes, which is the mean area of the bases over the area for the median
  /// size.
  double mean_square() const { return mean_square_; }
  std::size_t bytes() const { return (table_.size() + base_.size()) * sizeof(float); }
  /// Calls `all` with the members, for tables that are kept; `self` is constant or not.
  template <class Self, class Fields>
  static void fields(Self& self, Fields& all) {
    all(self.columns_, self.rows_, self.table_, self.base_, self.transmittance_, self.mean_square_,
        self.uniform_);
  }

private:
  /// The cubic through four neighbouring nodes of a table, at a position in nodes that is clamped to the table.
  struct Cubic {
    int first;  ///< index of the first of the four nodes
    std::array<float, 4> weights;
    Cubic(float position, int nodes);
  };
  Means means(const Cubic& u, float psi) const;

  static constexpr double kStepU = 0.25, kStepPsi = 0.4;

  int columns_ = 0, rows_ = 0;  // numbers of nodes of psi and of u
  std::vector<float> table_;    // the four means by [u][psi][4]
  std::vector<float> base_;     // means of D^2 and of D at the nodes of u
  double transmittance_ = 1, mean_square_ = 1;
  bool uniform_ = true;
};

}  // namespace aureole::optics

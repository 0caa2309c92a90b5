// SPDX-License-Identifier: Apache-2.0
// A Gaussian beam in the plane perpendicular to its direction: the coherent light about a ray that edges
// diffract. Uniform illumination is an incoherent sum of such beams with centres everywhere. The integral
// over centres c of |amplitude(x - c)|^2 is 1, and the integral of amplitude(x - c) amplitude(x' - c) is
// exp(-|x - x'|^2/(8 sigma^2)), the coherence of the light.
#pragma once

#include <span>

#include "aureole/optics/diffraction/edge_wave.h"

namespace aureole::optics {

/// A Gaussian beam of power 1, so that amplitudes are 1/length. Points are relative to the beam's centre.
class GaussianBeam {
public:
  /// `sigma` is the standard deviation of the intensity along each axis. Throws std::domain_error unless it
  /// is positive and finite.
  explicit GaussianBeam(double sigma);

  double sigma() const { return sigma_; }
  double amplitude(PlanePoint p) const;
  /// Returns the intensity, power per area. It is also the density of the beam's centre about a point that a
  /// ray has hit.
  double intensity(PlanePoint p) const;
  /// Returns the beam's spectrum of least uncertainty, a Gaussian of standard deviation 1/(2 sigma), which is
  /// removed as the 0th order.
  ZerothOrder zeroth_order() const { return ZerothOrder::of_beam(0.5 / sigma_); }
  /// Samples a centre, or a point of the beam, from two numbers in [0, 1), with the density intensity().
  PlanePoint sample(double u1, double u2) const;

  /// Returns the part of the beam's power that falls into a ring, positive for a counter-clockwise ring and
  /// negative for a clockwise one, by Owen's function T (Owen 1956, "Tables for computing bivariate normal
  /// probabilities", Ann. Math. Stat. 27(4)). The error is 1e-14.
  double power(std::span<const PlanePoint> ring) const;
  double power(const PolygonRegion& region) const;

  /// Writes to `out` the irradiated part of an edge: clipped to `reach` sigma about the centre and cut evenly
  /// into pieces of at most `piece` sigma, with the beam's amplitudes at their ends. Returns the number of
  /// pieces; if it exceeds the size of `out`, nothing is written.
  std::size_t light(PlanePoint from, PlanePoint to, double reach, double piece,
                    std::span<DiffractingEdge> out) const;

private:
  double sigma_, peak_;  ///< standard deviation of the intensity, peak of the amplitude
};

}  // namespace aureole::optics

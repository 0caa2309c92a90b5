// SPDX-License-Identifier: Apache-2.0
// A Gaussian beam in the plane across its direction, the light that edges see of a ray. Even illumination is an
// incoherent sum of such beams with centres everywhere: the integral over centres c of |amplitude(x - c)|^2 is 1, and that
// of amplitude(x - c) amplitude(x' - c) is exp(-|x - x'|^2/(8 sigma^2)), the coherence of the light.
#pragma once

#include <span>

#include "aureole/optics/diffraction/edge_wave.h"

namespace aureole::optics {

/// Points of the plane are relative to the beam's centre. Power 1, so that amplitudes are 1/length.
class GaussianBeam {
public:
  /// `sigma` is the standard deviation of the intensity along each axis. Throws std::domain_error unless it is positive
  /// and finite.
  explicit GaussianBeam(double sigma);

  double sigma() const { return sigma_; }
  double amplitude(PlanePoint p) const;
  /// Per area: that of a centre about a point that a ray has hit, too.
  double intensity(PlanePoint p) const;
  /// The least uncertain spectrum, a Gaussian of standard deviation 1/(2 sigma): what is removed as the 0th order.
  ZerothOrder zeroth_order() const { return ZerothOrder::of_beam(0.5 / sigma_); }
  /// A centre, or a point of the beam, from two numbers in [0, 1), with the density intensity().
  PlanePoint sample(double u1, double u2) const;

  /// Part of the beam's power that falls into a ring, counter-clockwise (the negative of it clockwise), by Owen's function T
  /// (Owen 1956, "Tables for computing bivariate normal probabilities", Ann. Math. Stat. 27(4)). Error 1e-14.
  double power(std::span<const PlanePoint> ring) const;
  double power(const PolygonRegion& region) const;

  /// Writes what the beam lights of an edge to `out`: clipped to `reach` sigma about the centre and cut evenly into pieces of at most
  /// `piece` sigma, with its amplitudes at their ends. Returns how many pieces there are; where that is more than `out`
  /// holds, nothing is written.
  std::size_t light(PlanePoint from, PlanePoint to, double reach, double piece,
                    std::span<DiffractingEdge> out) const;

private:
  double sigma_, peak_;  ///< peak of the amplitude
};

}  // namespace aureole::optics

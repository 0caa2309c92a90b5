// SPDX-License-Identifier: Apache-2.0
// Edge-diffracted waves (Steinberg, Ramamoorthi, Bitterli, Mollazainali, d'Eon & Pharr 2024, "A free-space
// diffraction BSDF", ACM Trans. Graph. 43(4), supplemental section S2): the far field of an irradiated region
// as a sum over its edges, along which the amplitude is linear.
//
// Conventions. q is a transverse wave vector in rad per unit of length: k times the change of direction. A
// field is F(q) = integral of amplitude(x) exp(-i q.x) dx dy, amplitude x area. Its power per d2q is |F|^2/(4
// pi^2), and per steradian (k/2 pi)^2 |F|^2, if the amplitude squared is power per area.
#pragma once

#include <complex>
#include <span>
#include <utility>
#include <vector>

#include "aureole/optics/aperture/polygon_region.h"

namespace aureole::optics {

/// Returns alpha_1 (Steinberg et al., equation S2.20), the wave of an amplitude that changes linearly along
/// an edge. `along` and `across` are q.e and q.m for the edge vector e and its outward normal m of the same
/// length. Finite except at q = 0.
double edge_alpha1(double along, double across);
/// Returns alpha_2 (equation S2.21), the wave of a constant amplitude.
double edge_alpha2(double along, double across);

/// An edge of a region that lies to its left. The amplitude is linear between the values `a` and `b` at its
/// ends.
struct DiffractingEdge {
  PlanePoint from, to;
  std::complex<double> a, b;

  PlanePoint vector() const { return {to.x - from.x, to.y - from.y}; }
  double length() const;
  std::complex<double> mean() const { return 0.5 * (a + b); }
};

/// The removal of the 0th-order lobe, the undiffracted beam. The remaining power of a wave is 1 - chi(q), chi
/// being a Gaussian of standard deviation `sigma` about q = 0.
/// - `kept`: nothing is removed (their section S3, for methods that trace beams).
/// - `beam`: one chi for all edges, that of the beam's own spectrum; the power does not depend on how edges
///   are cut.
/// - `edge`: one chi for each edge by its length, sigma = sqrt(3)/length, as published (S2.23 to S2.26).
struct ZerothOrder {
  enum class Removal { kept, beam, edge };
  Removal removal = Removal::kept;
  double sigma = 0;  ///< of `beam`, rad per unit of length

  static ZerothOrder kept() { return {}; }
  static ZerothOrder of_beam(double sigma) { return {Removal::beam, sigma}; }
  static ZerothOrder of_edges() { return {Removal::edge, 0}; }

  /// Returns the standard deviation of chi times `length`, its value in canonical coordinates; 0 if nothing
  /// is removed.
  double canonical_sigma(double length) const;
  /// Returns 1 - chi(q) for an edge of `length`, with |q|^2 = q2.
  double remainder(double q2, double length) const;
};

/// Returns F of one edge (their S2.19 times 2 pi R/k). It has a pole of first order at q = 0.
std::complex<double> edge_wave(const DiffractingEdge& edge, PlanePoint q);
/// Returns the sum over edges with the 0th order removed; 0 at q = 0 if it is removed.
std::complex<double> edge_field(std::span<const DiffractingEdge> edges, PlanePoint q,
                                ZerothOrder zeroth = {});

/// Returns the two parts of an edge, cut at the fraction t of its length. Their waves add up to that of the
/// whole exactly.
std::pair<DiffractingEdge, DiffractingEdge> split(const DiffractingEdge& edge, double t = 0.5);
/// Returns the straight edge from the start of `first` to the end of `second`, which must begin where `first`
/// ends.
DiffractingEdge join(const DiffractingEdge& first, const DiffractingEdge& second);

/// Returns the edges of a uniformly irradiated region.
std::vector<DiffractingEdge> region_edges(const PolygonRegion& region, std::complex<double> amplitude = 1);

}  // namespace aureole::optics

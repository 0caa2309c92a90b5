// SPDX-License-Identifier: Apache-2.0
// An edge as an operator that scatters light. K(x; d_i -> d_o) [m/sr] is the intensity in W/sr per length of
// edge that a point x of the edge radiates along d_o, under an irradiance of 1 W/m^2 perpendicular to d_i.
// d_i and d_o are unit vectors along which light travels.
//
// The transverse wave vector q = k (d_o - d_i) lies in the plane perpendicular to d_i + d_o. Edges are
// projected onto that plane along d_i + d_o: then positions along the light add no phase, and K is the same
// for reversed light. Uniform illumination is a sum of beams with centres c in that plane (gaussian_beam.h).
// With the field F_c of a beam of power 1
//   K = (k/2 pi)^2 integral over c of (1 - chi(q)) |F_c(q)|^2 W(x | c, q) d2c,
// where W per length of edge is the ratio |F_j|^2/sum |F_l|^2 for the edge j on which x lies, constant along
// that edge. W only says where on the edges of one beam a path continues; its integral over the edges is 1.
// `edge_waves` has both factors for a sampled centre. `mean_edge_kernel` is the integral over all centres in
// closed form, with another W. For a straight edge, in shadow and integrated over all directions along the
// edge, K is lambda/(4 pi^2 theta^2) per radian, Keller's coefficient.
//
// Diffracted power is removed from the light that passes beside the edge: under the irradiance E that light
// loses E S per length of edge, S being the integral of K over directions (`mean_edge_powers`).
// `GaussianBeam::power` and `interfering_power` are the powers of single beams.
#pragma once

#include <optional>
#include <span>

#include "aureole/optics/diffraction/edge_wave.h"

namespace aureole::optics {

struct SpaceVector {
  double x = 0, y = 0, z = 0;
};

/// Map between directions of light and transverse wave vectors relative to a reference direction: |q| = 2 k
/// sin(theta/2), theta being the angle to the reference direction. It is Lambert's equal-area map of the
/// sphere: a density per d2q times k^2 is one per steradian, and |q| < 2 k is the whole sphere.
class DirectionMap {
public:
  /// `along` is the reference direction, a unit vector; the directions of the other axes are arbitrary.
  DirectionMap(SpaceVector along, double k);

  PlanePoint project(SpaceVector v) const;
  /// Returns the direction of the wave vector q. Empty for |q| >= 2 k, to which no direction belongs
  /// (evanescent waves).
  std::optional<SpaceVector> direction(PlanePoint q) const;
  PlanePoint wave_vector(SpaceVector direction) const;

private:
  SpaceVector x_, y_, z_;
  double k_;
};

/// The plane perpendicular to d_i + d_o, in which K is defined. For d_o = -d_i it is any plane that contains
/// q.
class ScatteringPlane {
public:
  ScatteringPlane(SpaceVector d_i, SpaceVector d_o, double k);

  PlanePoint q() const { return {q_, 0}; }
  PlanePoint project(SpaceVector v) const;
  /// Returns the Jacobian d2c/d2c' = cos(theta/2) of a beam centre: c in this plane, c' its projection along
  /// d_i + d_o onto the plane perpendicular to d_i.
  double centre_jacobian() const { return cosine_; }

private:
  SpaceVector x_, y_;
  double q_, cosine_;
};

/// The waves of all edges in one direction.
struct EdgeWaves {
  std::complex<double> field;  ///< sum of the waves, without removal of the 0th order
  double squares = 0;          ///< sum of |F_j|^2
};
/// Returns the waves of the edges and writes |F_j|^2 of each edge to `squares`. W of edge j is
/// squares[j]/(sum length_j), or 0 if the sum is 0. No allocation.
EdgeWaves edge_waves(std::span<const DiffractingEdge> edges, PlanePoint q, std::span<double> squares);

/// Returns (k/2 pi)^2 (1 - chi) |F|^2, per steradian and over the power of the beam: the first factor of K,
/// without W. chi is that of the beam, or none.
double diffracted_intensity(const EdgeWaves& waves, PlanePoint q, double k, ZerothOrder zeroth);

/// A straight edge projected onto the scattering plane, with the region on its left.
struct ProjectedEdge {
  PlanePoint from, to;
  double length = 0;  ///< in space
};

/// Returns the integral of K over the centres in closed form. The wave of the edge at x, with its own
/// amplitude, interferes with the waves of all others within the coherence of the light,
///   K = (k/2 pi)^2 (1 - chi)/q^4 (m.q) sum over edges of (m_l.q) Re integral exp(-|x - x'|^2/(8 sigma^2) - i q.(x - x')) dl',
/// with normals m per length. Its integral along the edges is that of the K with sampled centres, but x and
/// its neighbours share the power in another way: it is exact for Gaussian amplitudes and edges of any
/// length, and it may be negative where waves of edges cancel. `at` is the position of x as a fraction of the
/// length of edges[index].
double mean_edge_kernel(std::span<const ProjectedEdge> edges, std::size_t index, double at, PlanePoint q,
                        double k, double sigma);

/// Evaluates `mean_edge_kernel` for edges[0] at many wavelengths at once, for rendering. `k`, `sigma` and
/// `result` have one number for each wavelength, and their size is a multiple of four. q is k `turn` along x;
/// `turn` > 0 is the length of the difference of the two directions. Faddeeva's function is evaluated by
/// Weideman's rational approximation (1994, "Computation of the complex error function", SIAM J. Numer. Anal.
/// 31(5)) with 24 terms, of relative error 5e-10. Terms below 2e-9 of the edge's own power are left out. No
/// allocation.
void mean_edge_kernels(std::span<const ProjectedEdge> edges, double at, double turn,
                       std::span<const double> k, std::span<const double> sigma, std::span<double> result);

/// Evaluates S, the integral of `mean_edge_kernel` over all outgoing directions, for beams that are wide
/// compared with the wavelength. `edges` are projected along the incident light. The integral over the whole
/// plane of q has a closed form but for a quadrature along the edges,
///   S = m/(8 pi) . sum over edges of integral exp(-u) [E1(u) n_l + (1 - exp(-u))/u (n_l - 2 e (e.n_l))] ds',   u = r^2/(8 sigma^2),
/// where e is the direction of r = x - x', n_l are normals of length 1, and ds' lies in the plane. |cos b|/(4
/// k), b being the angle between light and edge, is subtracted, since no direction belongs to |q| > 2 k and K
/// is defined in the plane perpendicular to the mean of both directions. Evaluates many wavelengths at once
/// [unit of length]. The errors are in docs/optics.md. No allocation.
void mean_edge_powers(std::span<const ProjectedEdge> edges, std::size_t index, double at,
                      std::span<const double> k, std::span<const double> sigma, std::span<double> result);

/// Evaluates K on an edge that is straight and alone for many sigma around. There it can have the gradient of
/// the amplitude along the edge, which the waves above leave out: without it waves are smaller by (1 -
/// a^2)^2, a being the part of the turn along the edge, 16 % of the power at 3/(2 k sigma). With the gradient
///   K = (8/pi)^(1/2) k^2 sigma/(4 pi) shown (1 - exp(-b (sigma q_n)^2))^2/q_n^2 exp(-2 (sigma q_t)^2)   [q_n = k across, q_t = k along]
/// Its integral over the directions along the edge is Keller's coefficient lambda/(4 pi^2 theta^2) within 1 %
/// from theta = 3/(2 k sigma) on. The 0th order is removed across the edge only. `across` and `along` are the
/// components, across and along the edge, of the difference of the two directions, in the plane perpendicular
/// to their mean. `shown` is the length of the edge projected onto that plane, over its length. Evaluates
/// many wavelengths at once, a multiple of four. No allocation.
void straight_edge_kernels(double across, double along, double shown, std::span<const double> k,
                           std::span<const double> sigma, std::span<double> result);
/// Returns the integral of `straight_edge_kernels` over all outgoing directions [unit of length]; `cosine` is
/// that of the angle between light and edge.
double straight_edge_power(double cosine, double k, double sigma);

/// Evaluates, for each sigma (a multiple of four of them), the fraction of the coherent light about a point
/// of an edge that belongs to the edge's own straight line: 1/2 (e(before) + e(after)) times, for every edge
/// in `others`, 1 - exp(-h^2/(8 sigma^2)) 1/2 (e(t1) - e(t0)). `before` and `after` are the projected
/// distances from the point to the ends of the line. `others` are the edges that are no part of that line; h
/// is the distance of the point from the line of such an edge, and t0 and t1 are the edge's ends, measured
/// from the foot of the point on it. e(t) = sign(t) (1 - exp(-t^2/(2 pi sigma^2)))^(1/2) is within 0.7 % of
/// erf(t/(8^(1/2) sigma)). No allocation.
void straight_edge_weights(PlanePoint place, double before, double after,
                           std::span<const ProjectedEdge> others, std::span<const double> sigma,
                           std::span<double> weights);
/// Interpolates between both kernels near corners and other edges: adds to `result` the difference of
/// `straight_edge_kernels` and `mean_edge_kernel` of an infinite straight edge, times `weights`. No
/// allocation.
void add_straight_edge_corrections(double across, double along, double shown, std::span<const double> weights,
                                   std::span<const double> k, std::span<const double> sigma,
                                   std::span<double> result);
/// Returns the integral over all directions of what `add_straight_edge_corrections` adds, for a weight of 1
/// [unit of length].
double straight_edge_power_correction(double cosine, double sigma);

}  // namespace aureole::optics

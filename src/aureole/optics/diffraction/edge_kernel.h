// SPDX-License-Identifier: Apache-2.0
// An edge as an operator that scatters light: K(x; d_i -> d_o), intensity in W/sr per length of edge, under an irradiance of
// 1 W/m^2 across d_i, in m/sr, for a point x of the edge and directions of travel d_i, d_o (unit vectors).
//
// The transverse wave vector q = k (d_o - d_i) lies in the plane across d_i + d_o. Edges are projected there, along
// d_i + d_o: then positions along the light add no phase, and K is the same when the light runs backwards. Even light is a sum
// of beams with centres c in that plane (gaussian_beam.h), so that with the field F_c of a beam of power 1
//   K = (k/2 pi)^2 integral over c of (1 - chi(q)) |F_c(q)|^2 W(x | c, q) d2c,
// W per length of edge: the share |F_j|^2/sum |F_l|^2 of the edge j that x lies on, even along it. W only says where on the edges
// of one beam a path goes; its integral over them is 1. `edge_waves` has both factors for a drawn centre, `mean_edge_kernel` the
// integral over all centres in closed form, with another W. Over a straight edge, in shadow and over all directions along the
// edge, K is lambda/(4 pi^2 theta^2) per radian, Keller's coefficient.
//
// Light that is diffracted is missing in what passes beside the edge: light of the irradiance E loses E S per length of edge, S the
// integral of K over directions, `mean_edge_powers`. `GaussianBeam::power` and `interfering_power` have the powers of single beams.
#pragma once

#include <optional>
#include <span>

#include "aureole/optics/diffraction/edge_wave.h"

namespace aureole::optics {

struct SpaceVector {
  double x = 0, y = 0, z = 0;
};

/// Directions of light about one that it had, by transverse wave vectors: |q| = 2 k sin(theta/2), theta the angle between them. It is
/// Lambert's map of the sphere, which keeps areas: a density per d2q times k^2 is one per steradian, and |q| < 2 k is the whole sphere.
class DirectionMap {
public:
  /// `along` is a unit vector; the other axes are any.
  DirectionMap(SpaceVector along, double k);

  PlanePoint project(SpaceVector v) const;
  /// Nothing for |q| >= 2 k, waves that fade without a direction.
  std::optional<SpaceVector> direction(PlanePoint q) const;
  PlanePoint wave_vector(SpaceVector direction) const;

private:
  SpaceVector x_, y_, z_;
  double k_;
};

/// The plane across d_i + d_o, in which K is defined. Where light turns back by pi the plane is any that contains q.
class ScatteringPlane {
public:
  ScatteringPlane(SpaceVector d_i, SpaceVector d_o, double k);

  PlanePoint q() const { return {q_, 0}; }
  PlanePoint project(SpaceVector v) const;
  /// d2c of a centre in this plane over d2c of the same centre, seen along d_i + d_o, in the plane across d_i: cos(theta/2).
  double centre_jacobian() const { return cosine_; }

private:
  SpaceVector x_, y_;
  double q_, cosine_;
};

/// The waves of all edges in one direction.
struct EdgeWaves {
  std::complex<double> field;  ///< their sum, without removal of the 0th order
  double squares = 0;          ///< sum of |F_j|^2
};
/// With |F_j|^2 in `squares`, one per edge: W of the edge j is squares[j]/(sum length_j), 0 where the sum is 0. No allocation.
EdgeWaves edge_waves(std::span<const DiffractingEdge> edges, PlanePoint q, std::span<double> squares);

/// (k/2 pi)^2 (1 - chi) |F|^2, per steradian and for the power of the beam: what is multiplied with W. chi is that of the beam, or none.
double diffracted_intensity(const EdgeWaves& waves, PlanePoint q, double k, ZerothOrder zeroth);

/// A straight edge projected into the scattering plane, the region on its left.
struct ProjectedEdge {
  PlanePoint from, to;
  double length = 0;  ///< in space
};

/// The integral of K over the centres in closed form. The edge at x has the wave of its own amplitude with that of all others
/// within the coherence of the light,
///   K = (k/2 pi)^2 (1 - chi)/q^4 (m.q) sum over edges of (m_l.q) Re integral exp(-|x - x'|^2/(8 sigma^2) - i q.(x - x')) dl',
/// m normals per length. What it integrates to along the edges is what the K of drawn centres does, but x and its neighbours share
/// it otherwise: it is exact for Gaussian amplitudes of any length of edge, and may be negative where waves of edges cancel. `at` is
/// the fraction of the way along edges[index].
double mean_edge_kernel(std::span<const ProjectedEdge> edges, std::size_t index, double at, PlanePoint q,
                        double k, double sigma);

/// The same for edges[0] at many wavelengths at once, for rendering: `k`, `sigma` and `result` have one number for each, a multiple of
/// four of them. q is k `turn` along x, `turn` the difference of the two directions, which must be more than 0. Faddeeva's function by
/// Weideman's rational approximation (1994, "Computation of the complex error function", SIAM J. Numer. Anal. 31(5)) with 24 terms, of
/// relative error 5e-10, and what is less than 2e-9 of the edge's own light left out. No allocation.
void mean_edge_kernels(std::span<const ProjectedEdge> edges, double at, double turn,
                       std::span<const double> k, std::span<const double> sigma, std::span<double> result);

/// The integral S of `mean_edge_kernel` over all directions of light that goes on, for beams that are wide against the wavelength, from the
/// edges as they are seen along the light that arrives: over the whole plane of q, in closed form but for a quadrature along the edges,
///   S = m/(8 pi) . sum over edges of integral exp(-u) [E1(u) n_l + (1 - exp(-u))/u (n_l - 2 e (e.n_l))] ds',   u = r^2/(8 sigma^2),
/// e the direction of r = x - x', n_l normals of length 1, ds' in the plane; less |cos b|/(4 k), b the angle between light and edge, since
/// light has no directions beyond |q| = 2 k and K is defined across the mean of both directions. For many wavelengths at once, [unit of
/// length]. Errors: docs/optics.md. No allocation.
void mean_edge_powers(std::span<const ProjectedEdge> edges, std::size_t index, double at,
                      std::span<const double> k, std::span<const double> sigma, std::span<double> result);

/// K on an edge that is straight and alone for many sigma around, where it can do without what the waves above leave out: they drop the
/// gradient of the amplitude along the edge, which makes them smaller by (1 - a^2)^2, a the part of the turn along the edge, 16 % in all at
/// 3/(2 k sigma). With it
///   K = (8/pi)^(1/2) k^2 sigma/(4 pi) shown (1 - exp(-b (sigma q_n)^2))^2/q_n^2 exp(-2 (sigma q_t)^2)   [q_n = k across, q_t = k along]
/// whose integral over the directions along the edge is Keller's coefficient lambda/(4 pi^2 theta^2) within 1 % from theta = 3/(2 k sigma) on,
/// and whose 0th order is removed across the edge only. `across` and `along`: of the difference of the two directions, in the plane across
/// their mean; `shown`: the length of the edge that is seen there over its length. For many wavelengths at once, a multiple of four of
/// them. No allocation.
void straight_edge_kernels(double across, double along, double shown, std::span<const double> k,
                           std::span<const double> sigma, std::span<double> result);
/// The integral of that over all directions of light that goes on; `cosine`: of the angle between the light and the edge [unit of length].
double straight_edge_power(double cosine, double k, double sigma);

/// How much of the coherent light about a place is that of the straight line of its edge alone, for each sigma (a multiple of four of them):
/// 1/2 (e(before) + e(after)), the distances from the place to the ends of the line as they are seen, times, for every other edge, which is no
/// part of that line, 1 - exp(-h^2/(8 sigma^2)) 1/2 (e(t1) - e(t0)), h the distance of the place from the other one's line, t0 and t1 the ends of that edge
/// counted from the place's foot on it. e(t) = sign(t) (1 - exp(-t^2/(2 pi sigma^2)))^(1/2), within .7 % of erf(t/(8^(1/2) sigma)). No allocation.
void straight_edge_weights(PlanePoint place, double before, double after,
                           std::span<const ProjectedEdge> others, std::span<const double> sigma,
                           std::span<double> weights);
/// Near corners and other edges both kernels are weighed: `weights` times what an endless straight edge has by `straight_edge_kernels` more
/// than by `mean_edge_kernel` is added to `result`. No allocation.
void add_straight_edge_corrections(double across, double along, double shown, std::span<const double> weights,
                                   std::span<const double> k, std::span<const double> sigma,
                                   std::span<double> result);
/// The integral of that over all directions, for a weight of 1 [unit of length].
double straight_edge_power_correction(double cosine, double sigma);

}  // namespace aureole::optics

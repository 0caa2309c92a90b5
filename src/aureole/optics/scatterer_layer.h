// SPDX-License-Identifier: Apache-2.0
// Light diffracted by a layer of equal circles (apertures or opaque discs) that do not overlap: each circle,
// of `shape_radius`, lies in the middle of a hard disc of `correlation_radius`, and those discs cover
// `area_fraction` of the plane. Model: Yang, Kim, Pediredla & Jarosz, "A wave-optics BSDF for correlated
// scatterers", 2025, equation 14. Lengths in one unit of the caller's choice, q in rad per that unit. The
// scale-free variable is u = |q| correlation_radius. All constructors and functions throw std::domain_error,
// with the value, for radii that are not positive, an area fraction outside [0, kMaxAreaFraction] or a size
// ratio shape_radius/correlation_radius outside [kMinSizeRatio, 1].
#pragma once

#include <vector>

namespace aureole::optics {

/// Smallest shape_radius/correlation_radius: below it tables would end before the shape's transform decays.
inline constexpr double kMinSizeRatio = 1.0 / 64;

/// Intensity of one layer per scatterer, relative to |F(0)|^2: circle_transform(size_ratio u)^2 S'(u).
double radial_intensity(double u, double size_ratio, double area_fraction);

/// Integral of radial_intensity(u) u du over u in [0, infinity), relative error below 1e-6. Random positions
/// (S' = 1) give 2/size_ratio^2 exactly.
double radial_intensity_integral(double size_ratio, double area_fraction);

/// Intensity per unit area and what it adds up to. A renderer reads it from the scale-free `RadialTable`.
class ScattererLayer {
public:
  ScattererLayer(double shape_radius, double correlation_radius, double area_fraction);

  /// J(q) = rho0 |F(q)|^2 S'(q), length^2, before normalisation;
  /// rho0 = area_fraction/(pi correlation_radius^2).
  double intensity(double q) const;

  /// Fr, the part of the plane that the circles cover; 1 - Fr is what is between them.
  double shape_fraction() const { return shape_fraction_; }

  /// (1/4 pi^2) * integral of J(q) d2q, dimensionless: the diffracted part of the incident power. Exact
  /// layers have Fr (1 - Fr), the variance of a two-phase medium (Torquato, Random Heterogeneous Materials,
  /// 2002, section 2.2); the Percus-Yevick S' misses it by -1 % at 0.5, and by +5 % (equal radii) to +14 %
  /// (size ratio 0.7) at 0.7.
  double total() const { return total_; }

  /// Factor of J that gives the exact total, Fr (1 - Fr)/total(), so that no layer gains or loses energy.
  double normalisation() const { return normalisation_; }

private:
  double shape_radius_, correlation_radius_, area_fraction_;
  double shape_fraction_, total_, normalisation_;
};

/// Table of the normalised radial intensity g(u), with integral of u g(u) du over [0, infinity) exactly 1,
/// shared by all radii and wavelengths of one size ratio and area fraction. In its terms the normalised
/// intensity is
///     J(q) = 2 pi correlation_radius^2 Fr (1 - Fr) g(u).
///
/// u g(u) is piecewise linear (steps of 1/512 up to u = 32, of 1/8 up to 4096), then c/u^2, the mean over the
/// rings of Airy's pattern, which nobody resolves there. `pdf`, `cdf` and `sample` belong to that same
/// function, so that sampling in proportion to it is exact; `eval` is it in single precision. About 0.6 MB.
class RadialTable {
public:
  RadialTable(double size_ratio, double area_fraction);

  /// g(u) for u >= 0, by look-up alone, without a transcendental function. GCC 12 vectorises a loop of it
  /// with -O3 -fno-trapping-math -mtune=haswell (its generic tuning avoids gathers).
  float eval(float u) const {
    u = u > 1e-15f ? u : 1e-15f;
    return density(u) / u;
  }

  /// Density of u, u g(u), over [0, infinity). Divide by cdf(u_max) for that of `sample(xi, u_max)`.
  double pdf(double u) const { return u > 0 ? density(u) / total_ : 0; }

  /// Integral of u' g(u') du' over [0, u], in [0, 1].
  double cdf(double u) const { return power(u) / total_; }

  /// The u in [0, u_max] with cdf(u) = xi cdf(u_max), for xi in [0, 1) and u_max > 0, solved in closed form
  /// in its cell of the table.
  double sample(double xi, double u_max) const;

private:
  static constexpr int kFineRate = 512, kCoarseRate = 8;  // cells per unit of u
  static constexpr int kSplit = 32, kEnd = 4096;
  static constexpr int kFineCells = kSplit * kFineRate;
  static constexpr int kCells = kFineCells + (kEnd - kSplit) * kCoarseRate;

  struct Cell {
    double start, width;
  };
  static Cell cell(int index);

  /// Index of the cell that holds u in [0, kEnd], and how far u is through it, in [0, 1). The lines of both
  /// parts cross at kSplit and the table follows the lower one, which saves a branch. In single precision the
  /// fraction then has an error of 0.002 at most, about what the rounding of u itself costs it there.
  template <class Real>
  static int find_cell(Real u, Real& fraction) {
    const Real fine = u * Real(kFineRate);
    const Real coarse = u * Real(kCoarseRate) + Real(kFineCells - kSplit * kCoarseRate);
    const Real position = fine < coarse ? fine : coarse;
    const int index = static_cast<int>(position);
    fraction = position - static_cast<Real>(index);
    return index;
  }

  /// u g(u) total_ for u > 0; g keeps the rounding of total_, below a float's.
  template <class Real>
  Real density(Real u) const {
    const Real inside = u < Real(kEnd) ? u : Real(kEnd);
    Real fraction;
    const int i = find_cell(inside, fraction);
    const Real a = static_cast<Real>(nodes_[i]), b = static_cast<Real>(nodes_[i + 1]);
    const Real decay = inside / u;  // 1 inside the table
    return (a + fraction * (b - a)) * decay * decay;
  }

  double power(double u) const;

  std::vector<float> nodes_;   // u g(u) at the start of each cell, at kEnd, and a last node that counts as 0
  std::vector<double> power_;  // integral up to the start of each cell and up to kEnd
  double tail_;                // c of c/u^2, whose integral beyond u is c/u
  double total_;               // integral up to infinity: 1 but for the rounding of the nodes, some 1e-8
};

}  // namespace aureole::optics

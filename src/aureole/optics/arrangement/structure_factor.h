// SPDX-License-Identifier: Apache-2.0
// Interference of scatterers on correlated positions. The structure factor is their scattered power over that
// of scatterers on random positions, S'(u) = 1 + rho0 * integral of (g(r) - 1) exp(-i q.r) d2r, without the
// delta at q = 0. Here g is the pair correlation, rho0 the number of scatterers per area, a the correlation
// radius and u = q a.
#pragma once

#include <cmath>
#include <memory>
#include <utility>
#include <vector>

namespace aureole::optics {

/// Largest area fraction of `hard_disc_structure_factor`: the fluid phase of hard discs ends near it.
inline constexpr double kMaxAreaFraction = 0.7;
/// The largest area fraction of discs of one size is pi/sqrt(12).
inline constexpr double kClosestDiscPacking = 0.9068996821171089;

/// Area fractions that exceed a limit by at most this much count as the limit: they may have been rounded to
/// single precision or to the digits given here.
inline constexpr double kFractionTolerance = 1e-5;

/// Returns the structure factor, without its delta, of a fluid of equal hard discs at area fraction Fa = rho0
/// pi a^2. It has the Percus-Yevick form of Rosenfeld ("Free-energy model for the inhomogeneous hard-sphere
/// fluid in D dimensions", 1990, equations 4.4-4.6), written as in Yang, Kim, Pediredla & Jarosz ("A
/// wave-optics BSDF for correlated scatterers", 2025, equations 15 and 16).
/// S' is always positive; S'(0) = (1-Fa)^3/(1+Fa); S' is 1 for large u. 1/S' is a cubic polynomial in Fa/(1 -
/// Fa). Throws std::domain_error, with the value, unless 0 <= area_fraction <= kMaxAreaFraction.
double hard_disc_structure_factor(double u, double area_fraction);

/// `hard_disc_structure_factor` for many area fractions at one u: computes the Bessel functions, which take
/// most of the time, only once.
struct HardDiscWave {
  explicit HardDiscWave(double u);
  double structure_factor(double area_fraction) const;

  double disc, double_disc;  ///< `circle_transform` of u and of 2u
  double j0;
};

class StructureFactor {
public:
  virtual ~StructureFactor() = default;
  /// Returns S' for |u|; for an anisotropic arrangement its mean over the ring. Never negative.
  virtual double eval(double u) const = 0;
  /// Returns S' for a vector u = (ux, uy).
  virtual double eval(double ux, double uy) const { return eval(std::hypot(ux, uy)); }
  virtual bool is_isotropic() const { return true; }
};

/// The structure factor of equal hard discs, `hard_disc_structure_factor`.
class PercusYevickStructureFactor final : public StructureFactor {
public:
  explicit PercusYevickStructureFactor(double area_fraction);
  using StructureFactor::eval;
  double eval(double u) const override { return hard_disc_structure_factor(u, area_fraction_); }

private:
  double area_fraction_;
};

/// Independent positions: S' = 1 everywhere.
class PoissonStructureFactor final : public StructureFactor {
public:
  using StructureFactor::eval;
  double eval(double) const override { return 1; }
};

/// A table of S', linearly interpolated in u. It has the first value below the first u and 1 above the last.
class TabulatedStructureFactor final : public StructureFactor {
public:
  /// Throws std::domain_error if u does not increase or a value is negative or not finite.
  TabulatedStructureFactor(std::vector<double> u, std::vector<double> values);
  /// Makes the table from a pair correlation g(r/a): the transform of its table, tapered to 1 at its end.
  /// Negative values, from noise and truncation, become 0.
  static TabulatedStructureFactor from_pair_correlation(const std::vector<double>& r,
                                                        const std::vector<double>& g, double area_fraction);
  using StructureFactor::eval;
  double eval(double u) const override;

private:
  std::vector<double> u_, values_;
};

/// A table over the plane, bilinear in a square grid of (ux, uy) in [-extent, extent]^2 and made symmetric,
/// S'(-u) = S'(u). It is 1 outside the grid.
class MappedStructureFactor final : public StructureFactor {
public:
  /// `values` has rows from uy = extent downwards, in the order of an image.
  MappedStructureFactor(std::vector<float> values, int width, int height, double extent);
  double eval(double u) const override;
  double eval(double ux, double uy) const override;
  bool is_isotropic() const override { return false; }

private:
  std::vector<float> values_;
  int width_, height_;
  double extent_;
};

/// A lattice whose order fades: scatterers are displaced independently by a Gaussian, and the correlation of
/// pairs at a distance r by the factor exp(-r^2/(2 L^2)) of a finite domain. Then
///     S'(q) = 1 - D + D sum over G != 0 of B exp(-|q - G|^2 L^2/2) L^2/(2 pi),  D = exp(-q^2 sigma^2),
/// G the reciprocal lattice and B the area of its cell (Guinier, X-ray Diffraction, 1963, chapter 7).
class LatticeStructureFactor final : public StructureFactor {
public:
  enum class Kind { hexagonal, square };
  /// `jitter` is sigma along each axis in lattice spacings; `domain` is L in spacings; `angle` is the angle
  /// between one lattice vector and x [rad]. With `random_orientation` the result is the mean over angles,
  /// for many domains.
  LatticeStructureFactor(Kind kind, double area_fraction, double jitter, double domain, double angle,
                         bool random_orientation);
  double eval(double u) const override;
  double eval(double ux, double uy) const override;
  bool is_isotropic() const override { return random_; }
  /// Returns the area fraction at which discs of the correlation radius touch: pi/sqrt(12) or pi/4.
  static double closest_packing(Kind kind);

private:
  /// Upper bound of L in correlation radii: spots are 1/L wide, and tables have points 1/48 apart.
  static constexpr double kLongestOrder = 25;

  Kind kind_;
  // lengths relative to a, and the area of a cell of the reciprocal lattice
  double spacing_, sigma_, length_, cosine_, sine_, cell_;
  double bx_[2], by_[2];  // reciprocal basis before the rotation by `angle`
  bool random_;
  std::vector<std::pair<double, int>> shells_;  ///< |G| of each shell, and the number of its lattice points
};

/// The structure factor S'(u) of positions that are stretched by sqrt(ratio) in one direction and compressed
/// by that factor across it.
class StretchedStructureFactor final : public StructureFactor {
public:
  StretchedStructureFactor(std::shared_ptr<const StructureFactor> unstretched, double ratio, double angle);
  double eval(double u) const override;
  double eval(double ux, double uy) const override;
  bool is_isotropic() const override { return false; }

private:
  std::shared_ptr<const StructureFactor> unstretched_;
  double stretch_, cosine_, sine_;
};

}  // namespace aureole::optics

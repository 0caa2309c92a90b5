// SPDX-License-Identifier: Apache-2.0
// A mixture of scatterers of several shapes and sizes that sit, labelled at random, on one set of positions,
// and the two parts of their intensity J(q) (Yang, Kim, Pediredla & Jarosz, "A wave-optics BSDF for
// correlated scatterers", 2025, equations 25 and 26, with amplitudes kept complex: |F_m||F_l| there stands
// for Re(F_m conj F_l), which differs where transforms change sign). Per unit area
//     J(q) = rho0 (U(q) + C(q) S'(q)),   C = |sum_m P_m <F_m>|^2,   U = sum_m P_m <|F_m|^2> - C,
// <> the mean over sizes and, for those that are turned at random, over angles.
//
// Scale-free: lengths are relative to the correlation radius a, u = q a; U and C carry a^4.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "aureole/core/parallel_for.h"
#include "aureole/optics/aperture/aperture_shape.h"
#include "aureole/optics/arrangement/partial_structure_factors.h"
#include "aureole/optics/layer/radial_function.h"
#include "aureole/optics/particle/size_distribution.h"

namespace aureole::optics {

struct Scatterer {
  std::shared_ptr<const ApertureShape> shape;
  double fraction = 1;  ///< P_m
  double rotation = 0;  ///< rad, counter-clockwise
  bool random_rotation = false;
  SizeDistribution sizes{};  ///< relative to the shape
};

/// The two parts of the intensity; both >= 0.
struct MixtureIntensity {
  double uncorrelated = 0;  ///< U
  double coherent = 0;      ///< C
};

class ScattererMixture {
public:
  /// Throws std::domain_error where fractions do not sum to 1, or a shape is larger than the correlation
  /// radius (in the unit of the shapes). Shapes turned at random are tabulated by `parallel_for`.
  ScattererMixture(std::vector<Scatterer> scatterers, double correlation_radius,
                   const ParallelFor& parallel_for = serial_for);
  ~ScattererMixture();

  /// Gives every scatterer a hard disc of its own size, in the proportion of the largest shape to the
  /// correlation radius, instead of equal discs: discs of several sizes pack differently. From then on C = 0,
  /// and U has the interference of the amplitudes with the partial structure factors
  ///     U = sum_m P_m (<|F_m|^2> - |<F_m>|^2) + sum_ml sqrt(P_m P_l) Re(<F_m> conj <F_l>) S_ml,
  /// m the classes of sizes, at most `kMaxClasses`, for this one `area_fraction` of the discs.
  void correlate_sizes(
      double area_fraction,
      const std::function<std::shared_ptr<const PartialStructureFactors>(const HardDiscMixture&)>& structure);
  bool has_correlated_sizes() const { return partial_ != nullptr; }
  static constexpr int kMaxClasses = 8;

  MixtureIntensity eval(double ux, double uy) const;
  /// Ring mean of sum P <|F|^2>, the intensity of random positions.
  double independent_ring(double u) const;
  bool is_isotropic() const { return isotropic_; }
  /// Whether all scatterers are alike, so that U = 0.
  bool is_uniform() const { return uniform_ && !partial_; }

  /// Fr/Fa: the mean area of the shapes, sum P |A|, over that of their discs.
  double covered_per_fraction() const { return mean_area_ / mean_disc_area_; }
  /// sum P |A|.
  double mean_area() const { return mean_area_; }
  /// sum P integral of A^2.
  double mean_squared_area() const { return mean_squared_area_; }

private:
  struct Part;
  std::vector<Part> parts_;
  bool isotropic_ = true, uniform_ = false;
  double mean_area_ = 0, mean_squared_area_ = 0, mean_disc_area_;
  std::shared_ptr<const PartialStructureFactors> partial_;
};

/// Integral over [0, infinity) of f(u) u du, f the change of the ring mean by correlation, C (S' - 1): to be
/// added to 2 pi mean_squared_area(), the integral for random positions.
double correlation_power(const std::function<double(double)>& change);

}  // namespace aureole::optics

// SPDX-License-Identifier: Apache-2.0
// A mixture of scatterers of several shapes and sizes, randomly assigned to one set of positions, and the two
// parts of their intensity J(q) (Yang, Kim, Pediredla & Jarosz, "A wave-optics BSDF for correlated
// scatterers", 2025, equations 25 and 26). Amplitudes are kept complex here: their |F_m||F_l| is replaced by
// Re(F_m conj F_l), which differs where transforms change sign. Per unit area
//     J(q) = rho0 (U(q) + C(q) S'(q)),   C = |sum_m P_m <F_m>|^2,   U = sum_m P_m <|F_m|^2> - C,
// with <> the mean over sizes and, for shapes with random rotation, over angles.
//
// Quantities are scale-free: lengths are relative to the correlation radius a, and u = q a; U and C carry
// a^4.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "aureole/core/parallel_for.h"
#include "aureole/optics/aperture/aperture_shape.h"
#include "aureole/optics/arrangement/partial_structure_factors.h"
#include "aureole/optics/layer/overlapping_scatterers.h"
#include "aureole/optics/layer/radial_function.h"
#include "aureole/optics/particle/size_distribution.h"

namespace aureole::optics {

struct Scatterer {
  std::shared_ptr<const ApertureShape> shape;
  double fraction = 1;  ///< P_m
  double rotation = 0;  ///< rotation [rad], counter-clockwise
  bool random_rotation = false;
  SizeDistribution sizes{};  ///< distribution of sizes relative to the shape
};

/// The two parts of the intensity; both >= 0.
struct MixtureIntensity {
  double uncorrelated = 0;  ///< U
  double coherent = 0;      ///< C
};

class ScattererMixture {
public:
  /// Makes a mixture. Throws std::domain_error if fractions do not sum to 1, or if a shape is larger than the
  /// correlation radius (in the unit of the shapes). Shapes with random rotation are tabulated by
  /// `parallel_for`.
  ScattererMixture(std::vector<Scatterer> scatterers, double correlation_radius,
                   const ParallelFor& parallel_for = serial_for);
  ScattererMixture(const ScattererMixture&);
  ~ScattererMixture();

  /// Gives every scatterer a hard disc of its own size, in the ratio of the correlation radius to the largest
  /// shape, instead of equal discs: discs of several sizes pack differently. From then on C = 0, and U
  /// includes the interference of the amplitudes by the partial structure factors
  ///     U = sum_m P_m (<|F_m|^2> - |<F_m>|^2) + sum_ml sqrt(P_m P_l) Re(<F_m> conj <F_l>) S_ml,
  /// with m over at most `kMostClasses` classes of sizes, for this `area_fraction` of the discs.
  void correlate_sizes(
      double area_fraction,
      const std::function<std::shared_ptr<const PartialStructureFactors>(const HardDiscMixture&)>& structure);
  bool has_correlated_sizes() const { return partial_ != nullptr; }
  static constexpr int kMaxClasses = 8;

  /// Returns the mixture at independent positions, where scatterers overlap, with `area_fraction` of the discs:
  /// the number of scatterers per area times the area of a disc. There C = 0, and U is that of
  /// `OverlappingScatterers`. Throws std::domain_error if sizes are correlated.
  ScattererMixture overlapping(double area_fraction, const ParallelFor& parallel_for = serial_for) const;
  /// Whether C = 0.
  bool has_no_coherent_part() const { return partial_ != nullptr || overlapping_ != nullptr; }

  MixtureIntensity eval(double ux, double uy) const;
  /// Returns the ring mean of sum P <|F|^2>, the intensity for random positions.
  double independent_ring(double u) const;
  bool is_isotropic() const { return isotropic_; }
  /// Whether all scatterers are equal, so that U = 0.
  bool is_uniform() const { return uniform_ && !has_no_coherent_part(); }
  /// Returns the integral of U + C over the plane of u, divided by 2 pi.
  double total() const;

  /// Returns Fr/Fa: the mean area of the shapes, sum P |A|, over the mean area of their discs.
  double covered_per_fraction() const { return mean_area_ / mean_disc_area_; }
  /// Returns the mean area of the shapes, sum P |A|.
  double mean_area() const { return mean_area_; }
  /// Returns the mean of the squared transmittances, sum P integral of A^2.
  double mean_squared_area() const { return mean_squared_area_; }

private:
  struct Part;
  std::vector<Part> parts_;
  bool isotropic_ = true, uniform_ = false;
  double mean_area_ = 0, mean_squared_area_ = 0, mean_disc_area_;
  std::shared_ptr<const PartialStructureFactors> partial_;
  std::shared_ptr<const OverlappingScatterers> overlapping_;
};

/// Returns the integral of f(u) u du over [0, infinity), where f = C (S' - 1) is the change of the ring mean
/// by correlation. The sum with 2 pi mean_squared_area(), the integral for random positions, is the total.
double correlation_power(const std::function<double(double)>& change);

}  // namespace aureole::optics

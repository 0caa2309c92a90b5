// SPDX-License-Identifier: Apache-2.0
// How many particles have which radius, in metres, and the nodes by which optical quantities are averaged
// over them. (`SizeDistribution` has relative sizes of the scatterers of a layer, in few nodes.)
#pragma once

#include <functional>
#include <span>
#include <vector>

namespace aureole::optics {

/// A radius in m, and its share of the number of particles.
struct RadiusNode {
  double radius, weight;
};

/// By which quantity a distribution of radii is stated: particles counted, or their volume.
enum class SizeWeighting { number, volume };

class RadiusDistribution {
public:
  static RadiusDistribution monodisperse(double radius);

  /// Log-normal: `sigma` in [0, 1.5] is the standard deviation of ln(radius), the logarithm of the geometric
  /// standard deviation; `median` is that of the number or of the volume.
  static RadiusDistribution log_normal(double median, double sigma, SizeWeighting by = SizeWeighting::number);
  /// Log-normal distribution by mean radius and coefficient of variation (standard deviation over mean), both
  /// of the number or of the volume.
  static RadiusDistribution log_normal_of_mean(double mean, double variation,
                                               SizeWeighting by = SizeWeighting::number);

  /// Hansen's gamma distribution, r^((1 - 3 v)/v) exp(-r/(a v)), a the effective radius and v in (0, 0.5) the
  /// effective variance (Hansen, "Multiple scattering of polarized light in planetary atmospheres. Part II",
  /// J. Atmos. Sci. 28 (1971) 1400, equation 6).
  static RadiusDistribution gamma(double effective_radius, double effective_variance);

  /// Modified gamma distribution of fog and clouds, r^alpha exp(-(alpha/gamma) (r/mode)^gamma) (Deirmendjian,
  /// Electromagnetic Scattering on Spherical Polydispersions, 1969, equation 60). `alpha` and `gamma` > 0.
  static RadiusDistribution modified_gamma(double mode_radius, double alpha, double gamma);

  /// Measured counts. Radii between two neighbours' midpoints are equally frequent; the first and the last
  /// class reach as far outwards as inwards. One radius alone is monodisperse. In any order.
  static RadiusDistribution histogram(std::span<const RadiusNode> counts);

  /// Any density over [smallest, largest], smooth on the scale of its own width and negligible at both ends
  /// (or zero beyond them). It is normalised here.
  static RadiusDistribution of_density(const std::function<double(double)>& density, double smallest,
                                       double largest, SizeWeighting by = SizeWeighting::number);
  // All of these throw std::domain_error, with the value, for what is negative, not finite or inverted, and
  // where there is no mass.

  /// Mean of radius^power, m^power.
  double moment(double power) const { return moment_(power); }
  /// <r^3>/<r^2>, m.
  double effective_radius() const { return moment(3) / moment(2); }
  /// <(r - effective radius)^2 r^2>/(effective radius^2 <r^2>).
  double effective_variance() const;
  double mean_area() const;    ///< mean of pi r^2, m^2
  double mean_volume() const;  ///< mean of 4/3 pi r^3, m^3
  bool is_single() const { return single_; }

  /// Midpoints of equal steps of t(r) = per_metre r + per_unit_of_log ln(r): the sum of weight times
  /// f(radius) is the mean of f. Smooth f converge faster than any power of the number of nodes, as the
  /// densities vanish smoothly at their ends (classes of a histogram: as its square). Intensities of
  /// particles oscillate in proportion to their radius; `per_metre` follows those, and the logarithm small
  /// particles. Never more than `most` nodes, in the same proportion, or one per class of a histogram.
  std::vector<RadiusNode> nodes(double per_metre, double per_unit_of_log, std::size_t most) const;

private:
  struct Interval {
    double low, high, weight;  // weight 0: `density_` has it
  };
  RadiusDistribution() = default;
  static RadiusDistribution power_exponential(double alpha, double gamma, double rate);

  bool single_ = false;
  std::vector<Interval> intervals_;
  std::function<double(double)> density_;  ///< per m, integral 1
  std::function<double(double)> moment_;
};

}  // namespace aureole::optics

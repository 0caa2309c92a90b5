// SPDX-License-Identifier: Apache-2.0
// Distributions of particle radii in metres, and quadrature nodes for averages of optical quantities.
// (`SizeDistribution` has the relative sizes of a layer's scatterers, with few nodes.)
#pragma once

#include <functional>
#include <span>
#include <vector>

namespace aureole::optics {

/// A radius in m and its fraction of the number of particles.
struct RadiusNode {
  double radius, weight;
};

/// The quantity that a distribution of radii weights: number or volume of particles.
enum class SizeWeighting { number, volume };

class RadiusDistribution {
public:
  static RadiusDistribution monodisperse(double radius);

  /// Log-normal distribution: `sigma` in [0, 1.5] is the standard deviation of ln(radius), the logarithm of
  /// the geometric standard deviation; `median` is the median radius by number or by volume.
  static RadiusDistribution log_normal(double median, double sigma, SizeWeighting by = SizeWeighting::number);
  /// Log-normal distribution with given mean radius and coefficient of variation (standard deviation over
  /// mean), both by number or by volume.
  static RadiusDistribution log_normal_of_mean(double mean, double variation,
                                               SizeWeighting by = SizeWeighting::number);

  /// Hansen's gamma distribution, r^((1 - 3 v)/v) exp(-r/(a v)), a the effective radius and v in (0, 0.5) the
  /// effective variance (Hansen, "Multiple scattering of polarized light in planetary atmospheres. Part II",
  /// J. Atmos. Sci. 28 (1971) 1400, equation 6).
  static RadiusDistribution gamma(double effective_radius, double effective_variance);

  /// Modified gamma distribution of fog and clouds, r^alpha exp(-(alpha/gamma) (r/mode)^gamma) (Deirmendjian,
  /// Electromagnetic Scattering on Spherical Polydispersions, 1969, equation 60). `alpha` and `gamma` > 0.
  static RadiusDistribution modified_gamma(double mode_radius, double alpha, double gamma);

  /// A histogram: classes between neighbouring `edges`, which increase, and the number or volume of particles in each,
  /// in any unit. Within a class the quantity is uniform in ln(radius).
  static RadiusDistribution histogram(std::span<const double> edges, std::span<const double> weights,
                                      SizeWeighting by = SizeWeighting::number);
  /// A histogram of classes given by increasing radii within them. Neighbours meet at the geometric mean of their
  /// radii; the first and the last class extend as far outwards as inwards in ln(radius). A single radius is
  /// monodisperse.
  static RadiusDistribution histogram_of_midpoints(std::span<const double> radii,
                                                   std::span<const double> weights,
                                                   SizeWeighting by = SizeWeighting::number);

  /// An arbitrary density over [smallest, largest], which is normalised here. It must be smooth on the scale
  /// of its own width and negligible at both ends (or zero beyond them).
  static RadiusDistribution of_density(const std::function<double(double)>& density, double smallest,
                                       double largest, SizeWeighting by = SizeWeighting::number);
  // All these functions throw std::domain_error, with the value, for negative, non-finite or inverted
  // arguments and for a distribution without mass.

  /// Returns the mean of radius^power, m^power.
  double moment(double power) const { return moment_(power); }
  /// Returns the effective radius <r^3>/<r^2>, m.
  double effective_radius() const { return moment(3) / moment(2); }
  /// Returns the effective variance <(r - effective radius)^2 r^2>/(effective radius^2 <r^2>).
  double effective_variance() const;
  double mean_area() const;    ///< mean of pi r^2, m^2
  double mean_volume() const;  ///< mean of 4/3 pi r^3, m^3
  bool is_single() const { return single_; }

  /// Returns nodes at midpoints of equal steps of t(r) = per_metre r + per_unit_of_log ln(r). The sum of
  /// weight times f(radius) is the mean of f. For smooth f it converges faster than any power of the number
  /// of nodes, as the densities vanish smoothly at their ends (for a histogram: quadratically).
  /// Scattered intensities oscillate in proportion to the radius: `per_metre` resolves these oscillations,
  /// and the logarithm resolves small particles. There are at most `most` nodes, in the same proportion, or
  /// one per class of a histogram.
  std::vector<RadiusNode> nodes(double per_metre, double per_unit_of_log, std::size_t most) const;

private:
  struct Interval {
    // bounds of an interval, and its fraction of the number of particles; 0: given by `density_`
    double low, high, weight;
  };
  RadiusDistribution() = default;
  static RadiusDistribution power_exponential(double alpha, double gamma, double rate);

  bool single_ = false;
  std::vector<Interval> intervals_;
  /// exponent of the radius to which the density is proportional within an interval with a weight
  double class_power_ = 0;
  std::function<double(double)> density_;  ///< density per m, with integral 1
  std::function<double(double)> moment_;
};

}  // namespace aureole::optics

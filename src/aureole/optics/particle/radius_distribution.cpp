// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/particle/radius_distribution.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <string>

#include "aureole/optics/constants.h"

namespace aureole::optics {
namespace {

/// Cutoff of log-normal distributions in standard deviations of ln(radius): below the median by number, and
/// above the median of radius^6, to which scattering by small particles is proportional.
constexpr double kReach = 5;

void require(bool holds, const char* what, double value) {
  if (holds) return;
  std::ostringstream text;
  text << what << ", got " << value;
  throw std::domain_error(text.str());
}

void require_length(double value, const char* name) {
  require(value > 0 && std::isfinite(value), (std::string(name) + " must be positive and finite").c_str(),
          value);
}

/// Returns the x in [low, high] at which the monotonic `f` crosses `level`.
double crossing(const std::function<double(double)>& f, double low, double high, double level) {
  const bool rising = f(high) > f(low);
  for (int i = 0; i < 200; ++i) {
    const double middle = 0.5 * (low + high);
    ((f(middle) > level) == rising ? high : low) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace

RadiusDistribution RadiusDistribution::monodisperse(double radius) {
  require_length(radius, "radius");
  RadiusDistribution d;
  d.single_ = true;
  d.intervals_ = {{radius, radius, 1}};
  d.moment_ = [radius](double power) { return std::pow(radius, power); };
  return d;
}

RadiusDistribution RadiusDistribution::log_normal(double median, double sigma, SizeWeighting by) {
  require_length(median, "median radius");
  require(sigma >= 0 && sigma <= 1.5, "standard deviation of ln(radius) must be in [0, 1.5]", sigma);
  if (sigma == 0) return monodisperse(median);
  const double s2 = sigma * sigma;
  const double mu = std::log(median) - (by == SizeWeighting::volume ? 3 * s2 : 0);
  RadiusDistribution d;
  d.intervals_ = {{std::exp(mu - kReach * sigma), std::exp(mu + 6 * s2 + kReach * sigma), 0}};
  d.density_ = [mu, sigma](double r) {
    const double z = (std::log(r) - mu) / sigma;
    return std::exp(-0.5 * z * z) / (r * sigma * std::sqrt(2 * kPi));
  };
  d.moment_ = [mu, s2](double power) { return std::exp(power * mu + 0.5 * power * power * s2); };
  return d;
}

RadiusDistribution RadiusDistribution::log_normal_of_mean(double mean, double variation, SizeWeighting by) {
  require_length(mean, "mean radius");
  require(variation >= 0 && variation <= 2.9, "coefficient of variation must be in [0, 2.9]", variation);
  const double s2 = std::log1p(variation * variation);
  return log_normal(mean * std::exp(-0.5 * s2), std::sqrt(s2), by);
}

/// Makes the distribution r^alpha exp(-rate r^gamma).
RadiusDistribution RadiusDistribution::power_exponential(double alpha, double gamma, double rate) {
  // In units of `scale` the exponential is exp(-t^gamma), so that no power of a radius overflows.
  const double scale = std::pow(rate, -1 / gamma);
  const double log_mass = std::lgamma((alpha + 1) / gamma) - std::log(gamma);
  const auto log_density = [=](double t) { return alpha * std::log(t) - std::pow(t, gamma) - log_mass; };
  // Cutoffs where, per step of ln(r), the remaining area (below) and sixth power (above) are 1e-9 of their
  // maximum.
  const auto end = [&](double power, double factor) {
    const auto log_share = [&](double y) { return log_density(std::exp(y)) + (power + 1) * y; };
    const double top = std::log((alpha + power + 1) / gamma) / gamma, level = log_share(top) - std::log(1e9);
    double far = top + factor;
    while (log_share(far) > level) far = top + 2 * (far - top);
    return std::exp(crossing(log_share, std::min(top, far), std::max(top, far), level));
  };
  RadiusDistribution d;
  d.intervals_ = {{scale * end(2, -1), scale * end(6, 1), 0}};
  d.density_ = [=](double r) { return std::exp(log_density(r / scale)) / scale; };
  d.moment_ = [=](double power) {
    return std::pow(scale, power) *
           std::exp(std::lgamma((alpha + power + 1) / gamma) - std::lgamma((alpha + 1) / gamma));
  };
  return d;
}

RadiusDistribution RadiusDistribution::gamma(double effective_radius, double effective_variance) {
  require_length(effective_radius, "effective radius");
  require(effective_variance > 0 && effective_variance < 0.5, "effective variance must be in (0, 0.5)",
          effective_variance);
  return power_exponential((1 - 3 * effective_variance) / effective_variance, 1,
                           1 / (effective_radius * effective_variance));
}

RadiusDistribution RadiusDistribution::modified_gamma(double mode_radius, double alpha, double gamma) {
  require_length(mode_radius, "mode radius");
  require(alpha > 0 && alpha <= 1000, "exponent alpha of a modified gamma distribution must be in (0, 1000]",
          alpha);
  require(gamma >= 0.1 && gamma <= 10, "exponent gamma of a modified gamma distribution must be in [0.1, 10]",
          gamma);
  return power_exponential(alpha, gamma, alpha / (gamma * std::pow(mode_radius, gamma)));
}

namespace {

/// Throws std::domain_error for lengths that are invalid or do not increase, and for invalid weights.
void check_classes(std::span<const double> lengths, std::span<const double> weights) {
  double total = 0;
  // upper bound of the number of classes: Mie's series is summed for at least one size of each
  constexpr std::size_t kMaxClasses = 1000;
  require(lengths.size() <= kMaxClasses, "a histogram of radii has at most 1000 classes",
          double(lengths.size()));
  for (std::size_t i = 0; i < lengths.size(); ++i) {
    require_length(lengths[i], "radius in a histogram");
    require(i == 0 || lengths[i] > lengths[i - 1], "radii in a histogram must increase", lengths[i]);
  }
  for (const double w : weights) {
    require(w >= 0 && std::isfinite(w), "weight in a histogram must not be negative", w);
    total += w;
  }
  require(total > 0 && std::isfinite(total), "the weights of a histogram need a positive sum", total);
}

}  // namespace

RadiusDistribution RadiusDistribution::histogram(std::span<const double> edges,
                                                 std::span<const double> weights, SizeWeighting by) {
  check_classes(edges, weights);
  require(edges.size() == weights.size() + 1, "a histogram has one edge more than weights; number of edges",
          double(edges.size()));
  // Relative to the largest radius, no power of a radius overflows. A weight w of a class of the width l in ln(r) is the
  // density dN/dln(r) = w r^-p/l, with p = 0 by number and 3 by volume.
  const double unit = edges.back(), p = by == SizeWeighting::volume ? 3 : 0;
  const auto integral = [](double low, double high, double power) {
    return power == 0 ? std::log(high / low) : (std::pow(high, power) - std::pow(low, power)) / power;
  };
  RadiusDistribution d;
  d.class_power_ = -p - 1;
  double total = 0;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    if (!(weights[i] > 0)) continue;
    const double low = edges[i], high = edges[i + 1];
    const double number = weights[i] * integral(low / unit, high / unit, -p) / std::log(high / low);
    d.intervals_.push_back({low, high, number});
    total += number;
  }
  require(total > 0 && std::isfinite(total), "the number of particles in a histogram is not finite", total);
  for (Interval& c : d.intervals_) c.weight /= total;
  // Classes with negligible contents, whose weights may underflow, are removed.
  std::erase_if(d.intervals_, [](const Interval& c) { return !(c.weight > 0); });
  d.moment_ = [=, intervals = d.intervals_](double power) {
    double sum = 0;
    for (const Interval& c : intervals)
      sum += c.weight * integral(c.low / unit, c.high / unit, power - p) /
             integral(c.low / unit, c.high / unit, -p);
    return sum * std::pow(unit, power);
  };
  return d;
}

RadiusDistribution RadiusDistribution::histogram_of_midpoints(std::span<const double> radii,
                                                              std::span<const double> weights,
                                                              SizeWeighting by) {
  check_classes(radii, weights);
  require(radii.size() == weights.size(), "a histogram has as many midpoints as weights; number of midpoints",
          double(radii.size()));
  if (radii.size() == 1) return monodisperse(radii[0]);
  std::vector<double> edges;
  for (std::size_t i = 1; i < radii.size(); ++i)
    edges.push_back(std::sqrt(radii[i - 1]) * std::sqrt(radii[i]));
  edges.insert(edges.begin(), radii.front() * (radii.front() / edges.front()));
  edges.push_back(radii.back() * (radii.back() / edges.back()));
  return histogram(edges, weights, by);
}

RadiusDistribution RadiusDistribution::of_density(const std::function<double(double)>& density,
                                                  double smallest, double largest, SizeWeighting by) {
  require_length(smallest, "smallest radius");
  require_length(largest, "largest radius");
  require(largest > smallest, "largest radius must exceed the smallest", largest);
  // Tabulates over equal steps of ln(r), far more than a plotted table would need.
  constexpr int kSteps = 8192;
  const double step = std::log(largest / smallest) / kSteps;
  std::vector<RadiusNode> table;
  double total = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double r = smallest * std::exp((i + 0.5) * step), value = density(r);
    require(value >= 0 && std::isfinite(value), "density of radii must not be negative", value);
    const double weight = value * r * step * (by == SizeWeighting::volume ? std::pow(smallest / r, 3) : 1);
    table.push_back({r, weight});
    total += weight;
  }
  if (!(total > 0)) throw std::domain_error("the density of radii has no mass");
  for (RadiusNode& n : table) n.weight /= total;
  RadiusDistribution d;
  d.intervals_ = {{smallest, largest, 0}};
  d.density_ = [=](double r) {
    return density(r) * (by == SizeWeighting::volume ? std::pow(smallest / r, 3) : 1) / total;
  };
  d.moment_ = [table = std::move(table)](double power) {
    double sum = 0;
    for (const RadiusNode& n : table) sum += n.weight * std::pow(n.radius, power);
    return sum;
  };
  return d;
}

double RadiusDistribution::effective_variance() const {
  const double m2 = moment(2), m3 = moment(3);
  return single_ ? 0 : moment(4) * m2 / (m3 * m3) - 1;
}
double RadiusDistribution::mean_area() const { return kPi * moment(2); }
double RadiusDistribution::mean_volume() const { return 4 * kPi / 3 * moment(3); }

std::vector<RadiusNode> RadiusDistribution::nodes(double per_metre, double per_unit_of_log,
                                                  std::size_t most) const {
  if (single_) return {{intervals_[0].low, 1}};
  require(per_metre >= 0 && per_unit_of_log >= 0 && per_metre + per_unit_of_log > 0,
          "densities of nodes must not be negative, and one of them positive",
          std::min(per_metre, per_unit_of_log));
  double length = 0;
  for (const Interval& c : intervals_)
    length += per_metre * (c.high - c.low) + per_unit_of_log * std::log(c.high / c.low);
  const double share = std::min(1.0, double(most) / length);
  const double a = per_metre * share, b = per_unit_of_log * share;
  std::vector<RadiusNode> nodes;
  for (const Interval& c : intervals_) {
    const double span = a * (c.high - c.low) + b * std::log(c.high / c.low);
    const int count = std::max(1, int(std::ceil(span)));
    const double step = span / count;
    double sum = 0, r = c.low;
    const std::size_t first = nodes.size();
    for (int i = 0; i < count; ++i) {
      // Newton's method in ln(r) for a (r - low) + b ln(r/low) = t. The left side is convex in ln(r), so from
      // above it converges without overshooting.
      const double t = (i + 0.5) * step;
      double y = i > 0 ? std::log(r) + step / (a * r + b) : std::log(c.low) + t / (a * c.low + b);
      for (int k = 0; k < 60; ++k) {
        const double e = std::exp(y), move = (a * (e - c.low) + b * (y - std::log(c.low)) - t) / (a * e + b);
        y -= move;
        if (std::abs(move) < 1e-14) break;
      }
      r = std::exp(y);
      const double width = step * r / (a * r + b);
      nodes.push_back({r, width * (c.weight > 0 ? std::pow(r / c.high, class_power_) : density_(r))});
      sum += nodes.back().weight;
    }
    if (c.weight > 0)
      for (std::size_t i = first; i < nodes.size(); ++i) nodes[i].weight *= c.weight / sum;
  }
  return nodes;
}

}  // namespace aureole::optics

// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/particle/radius_distribution.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

namespace aureole::optics {
namespace {

/// Mean of radius^power by the nodes.
double node_moment(const std::vector<RadiusNode>& nodes, double power) {
  double sum = 0;
  for (const RadiusNode& n : nodes) sum += n.weight * std::pow(n.radius, power);
  return sum;
}

void expect_nodes_agree(const RadiusDistribution& d, double tolerance) {
  const double size = d.effective_radius();
  for (const double power : {0.0, 2.0, 3.0, 4.0}) {
    // Nodes equal in ln(radius), equal in radius, and both.
    EXPECT_NEAR(node_moment(d.nodes(0, 100, 10000), power) / d.moment(power), 1, tolerance) << power;
    EXPECT_NEAR(node_moment(d.nodes(300 / size, 30, 10000), power) / d.moment(power), 1, tolerance) << power;
  }
}

TEST(RadiusDistribution, LogNormalMoments) {
  for (const double sigma : {0.03, 0.3, 0.8}) {
    const auto d = RadiusDistribution::log_normal(2e-6, sigma);
    for (const double power : {-1.0, 1.0, 2.0, 3.0, 6.0})
      EXPECT_NEAR(d.moment(power) / (std::pow(2e-6, power) * std::exp(power * power * sigma * sigma / 2)), 1,
                  1e-12);
    EXPECT_NEAR(d.effective_radius() / (2e-6 * std::exp(2.5 * sigma * sigma)), 1, 1e-12);
    EXPECT_NEAR(d.effective_variance(), std::expm1(sigma * sigma), 1e-12);
    expect_nodes_agree(d, 1e-5);
  }
}

TEST(RadiusDistribution, ByVolumeIsByVolume) {
  const auto d = RadiusDistribution::log_normal_of_mean(0.5e-6, 0.6, SizeWeighting::volume);
  // Mean and standard deviation of the radius where each is weighted by its volume.
  const double mean = d.moment(4) / d.moment(3), square = d.moment(5) / d.moment(3);
  EXPECT_NEAR(mean, 0.5e-6, 1e-18);
  EXPECT_NEAR(std::sqrt(square - mean * mean) / mean, 0.6, 1e-9);
  const auto n = RadiusDistribution::log_normal_of_mean(0.5e-6, 0.6);
  EXPECT_NEAR(n.moment(1), 0.5e-6, 1e-18);
  EXPECT_NEAR(std::sqrt(n.moment(2) - n.moment(1) * n.moment(1)) / n.moment(1), 0.6, 1e-9);
}

TEST(RadiusDistribution, GammaHasItsEffectiveRadiusAndVariance) {
  for (const double v : {0.01, 0.1, 0.2, 0.4}) {
    const auto d = RadiusDistribution::gamma(7e-6, v);
    EXPECT_NEAR(d.effective_radius() / 7e-6, 1, 1e-10);
    EXPECT_NEAR(d.effective_variance(), v, 1e-10);
    // Number alone diverges slowly at small radii where v > 1/3: those nodes are left out, not their area.
    EXPECT_NEAR(node_moment(d.nodes(50 / 7e-6, 50, 20000), 2) / d.moment(2), 1, 1e-5) << v;
    if (v < 0.3) expect_nodes_agree(d, 1e-5);
  }
}

TEST(RadiusDistribution, DeirmendjianClouds) {
  // Cloud C1 has 100 droplets per cm^3 and 0.0625 g of water per m^3 (0.063 in Deirmendjian 1969), moments in
  // closed form: <r^n> = (6 + n)!/(6! 1.5^n) um^n.
  const auto c1 = RadiusDistribution::modified_gamma(4e-6, 6, 1);
  EXPECT_NEAR(c1.moment(1) / (7 / 1.5 * 1e-6), 1, 1e-10);
  EXPECT_NEAR(c1.effective_radius() / 6e-6, 1, 1e-10);
  EXPECT_NEAR(c1.effective_variance(), 1.0 / 9, 1e-10);
  EXPECT_NEAR(100e6 * c1.mean_volume() * 1e6, 0.0625, 1e-4);
  expect_nodes_agree(c1, 1e-6);
  // Its mode.
  const auto nodes = c1.nodes(1e9, 0, 100000);
  double best = 0, at = 0;
  for (const RadiusNode& n : nodes)
    if (n.weight > best) best = n.weight, at = n.radius;
  EXPECT_NEAR(at, 4e-6, 0.02e-6);
  // Haze M, exponent 1/2: <r> = 12!/(4 ...) by the gamma function.
  const auto haze = RadiusDistribution::modified_gamma(0.05e-6, 1, 0.5);
  const double rate = 2 / std::sqrt(0.05e-6);
  EXPECT_NEAR(haze.moment(1) / (std::tgamma(6.0) / std::tgamma(4.0) / (rate * rate)), 1, 1e-10);
  expect_nodes_agree(haze, 2e-4);  // 1e-4 of the number, and no area, is too small to have nodes
}

TEST(RadiusDistribution, HistogramsSpreadOverTheirClasses) {
  const double edges[] = {0.5e-6, 1.5e-6, 2.5e-6, 3.5e-6}, weights[] = {20, 30, 10};
  // Means of r^p over ln(r) in the classes.
  const auto mean = [](double low, double high, double p) {
    return (std::pow(high, p) - std::pow(low, p)) / p / std::log(high / low);
  };
  const auto d = RadiusDistribution::histogram(edges, weights);
  const double square = (20 * mean(0.5, 1.5, 2) + 30 * mean(1.5, 2.5, 2) + 10 * mean(2.5, 3.5, 2)) / 60;
  EXPECT_NEAR(d.moment(2) / (square * 1e-12), 1, 1e-12);
  EXPECT_NEAR(d.moment(0), 1, 1e-12);
  expect_nodes_agree(d, 1e-3);
  // By volume, mean volume per volume is 1, and the mean inverse volume is the number.
  const auto v = RadiusDistribution::histogram(edges, weights, SizeWeighting::volume);
  const double number = (20 * mean(0.5, 1.5, -3) + 30 * mean(1.5, 2.5, -3) + 10 * mean(2.5, 3.5, -3)) / 60;
  EXPECT_NEAR(v.moment(3) * number / 1e-18, 1, 1e-12);
  EXPECT_NEAR(v.moment(5) / v.moment(3) / (square * 1e-12), 1, 1e-12);
  EXPECT_NEAR(v.moment(0), 1, 1e-12);
  expect_nodes_agree(v, 2e-3);
}

TEST(RadiusDistribution, MidpointsOfClasses) {
  const double radii[] = {1e-6, 2e-6, 4e-6}, weights[] = {20, 0, 10};
  const double edges[] = {1e-6 / std::sqrt(2), 1e-6 * std::sqrt(2), 2e-6 * std::sqrt(2), 4e-6 * std::sqrt(2)};
  const auto d = RadiusDistribution::histogram_of_midpoints(radii, weights, SizeWeighting::volume);
  const auto same = RadiusDistribution::histogram(edges, weights, SizeWeighting::volume);
  for (const double power : {-1.0, 2.0, 4.0}) EXPECT_NEAR(d.moment(power) / same.moment(power), 1, 1e-12);
  const double one[] = {3e-6}, seven[] = {7};
  EXPECT_TRUE(RadiusDistribution::histogram_of_midpoints(one, seven).is_single());
  EXPECT_NEAR(RadiusDistribution::histogram_of_midpoints(one, seven).mean_area(), 2.8274333882e-11, 1e-20);
}

TEST(RadiusDistribution, FineHistogramsAreTheirDistribution) {
  // Classes 0.1 wide in ln(radius) of a log-normal distribution: moments converge with the square of the width.
  for (const auto by : {SizeWeighting::number, SizeWeighting::volume}) {
    const auto moment_error = [&](int classes) {
      std::vector<double> edges, weights;
      for (int i = 0; i <= classes; ++i) edges.push_back(1e-6 * std::exp(0.4 * (12.0 * i / classes - 6)));
      for (int i = 0; i < classes; ++i) {
        const auto below = [&](double r) {
          return 0.5 * std::erfc(-std::log(r / 1e-6) / 0.4 / std::sqrt(2.0));
        };
        weights.push_back(below(edges[std::size_t(i) + 1]) - below(edges[std::size_t(i)]));
      }
      return RadiusDistribution::histogram(edges, weights, by).moment(3) /
                 RadiusDistribution::log_normal(1e-6, 0.4, by).moment(3) -
             1;
    };
    EXPECT_NEAR(moment_error(48), 0, 0.008);
    EXPECT_NEAR(moment_error(48) / moment_error(96), 4, 0.2);
  }
}

TEST(RadiusDistribution, AnyDensity) {
  const auto shape = [](double r) { return std::exp(-0.5 * std::pow(std::log(r / 1e-6) / 0.4, 2)) / r; };
  const auto d = RadiusDistribution::of_density(shape, 0.05e-6, 30e-6);
  const auto same = RadiusDistribution::log_normal(1e-6, 0.4);
  for (const double power : {1.0, 3.0}) EXPECT_NEAR(d.moment(power) / same.moment(power), 1, 1e-7);
  expect_nodes_agree(d, 1e-6);
  const auto by_volume = RadiusDistribution::of_density(shape, 0.05e-6, 30e-6, SizeWeighting::volume);
  const auto same_volume = RadiusDistribution::log_normal(1e-6, 0.4, SizeWeighting::volume);
  EXPECT_NEAR(by_volume.mean_volume() / same_volume.mean_volume(), 1, 1e-6);
}

TEST(RadiusDistribution, FewerNodesThanAskedKeepTheRange) {
  const auto d = RadiusDistribution::log_normal(1e-6, 0.3);
  EXPECT_LE(d.nodes(1e9, 10, 500).size(), 500u);
  EXPECT_NEAR(node_moment(d.nodes(1e9, 10, 500), 3) / d.moment(3), 1, 1e-6);
  EXPECT_EQ(RadiusDistribution::monodisperse(1e-6).nodes(1e9, 10, 500).size(), 1u);
}

TEST(RadiusDistribution, BadInputIsNamed) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto fails_with = [](const std::function<void()>& make, const std::string& part) {
    try {
      make();
      ADD_FAILURE() << part;
    } catch (const std::domain_error& e) {
      EXPECT_NE(std::string(e.what()).find(part), std::string::npos) << e.what();
    }
  };
  using R = RadiusDistribution;
  fails_with([] { R::monodisperse(-1e-6); }, "-1e-06");
  fails_with([=] { R::monodisperse(nan); }, "nan");
  fails_with([] { R::log_normal(1e-6, -0.1); }, "-0.1");
  fails_with([] { R::log_normal(0, 0.1); }, "median radius");
  fails_with([] { R::log_normal_of_mean(1e-6, -2); }, "variation");
  fails_with([] { R::gamma(1e-6, 0.5); }, "0.5");
  fails_with([] { R::modified_gamma(1e-6, 0, 1); }, "alpha");
  fails_with([] { R::modified_gamma(1e-6, 6, 20); }, "20");
  using V = std::vector<double>;
  fails_with([] { R::histogram_of_midpoints({}, {}); }, "positive sum");
  fails_with([] { R::histogram_of_midpoints(V{1e-6, 2e-6}, V{0, 0}); }, "positive sum");
  fails_with([] { R::histogram_of_midpoints(V{1e-6}, V{-3}); }, "-3");
  fails_with([] { R::histogram_of_midpoints(V{1e-6, 1e-6}, V{1, 2}); }, "must increase");
  fails_with([] { R::histogram_of_midpoints(V{1e-6, 2e-6}, V{1}); }, "as many midpoints");
  fails_with([=] { R::histogram_of_midpoints(V{nan}, V{1}); }, "nan");
  fails_with([=] { R::histogram(V{1e-6, 2e-6}, V{nan}); }, "nan");
  fails_with([] { R::histogram(V{0, 2e-6}, V{1}); }, "radius in a histogram");
  fails_with([] { R::histogram(V{1e-6, 2e-6}, V{1, 2}); }, "one edge more");
  fails_with([] { R::of_density([](double) { return 0.0; }, 1e-6, 2e-6); }, "no mass");
  fails_with([] { R::of_density([](double) { return -1.0; }, 1e-6, 2e-6); }, "-1");
  fails_with([] { R::of_density([](double) { return 1.0; }, 2e-6, 1e-6); }, "exceed");
}

}  // namespace
}  // namespace aureole::optics

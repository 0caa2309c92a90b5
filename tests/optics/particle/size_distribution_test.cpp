// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/particle/size_distribution.h"

#include <gtest/gtest.h>

#include <cmath>
#include <sstream>
#include <stdexcept>
#include <string>

#include "aureole/optics/two_columns.h"

namespace aureole::optics {
namespace {

/// Mean of exp(sigma power x) over a normal x cut at 3 standard deviations.
double cut_moment(double sigma, int power) {
  const double t = sigma * power;
  const auto normal = [](double x) { return 0.5 * std::erfc(-x / std::sqrt(2.0)); };
  return std::exp(t * t / 2) * (normal(3 - t) - normal(-3 - t)) / (normal(3) - normal(-3));
}

TEST(SizeDistribution, LogNormalMoments) {
  for (const double sigma : {0.02, 0.2, 0.7}) {
    const SizeDistribution sizes = SizeDistribution::log_normal(sigma);
    EXPECT_NEAR(sizes.moment(0), 1, 1e-14);
    for (const int power : {1, 2, 4})
      EXPECT_NEAR(sizes.moment(power) / cut_moment(sigma, power), 1, 4e-3) << sigma << " " << power;
    EXPECT_LT(sizes.largest(), std::exp(3 * sigma));
  }
  EXPECT_TRUE(SizeDistribution::log_normal(0).is_single());
  for (const double wrong : {-0.1, 0.71, std::nan("")})
    EXPECT_THROW(SizeDistribution::log_normal(wrong), std::domain_error) << wrong;
}

TEST(SizeDistribution, Histograms) {
  std::istringstream text("size count\n2, 30\n1 10  # comment\n\n3 0\n");
  const SizeDistribution sizes = SizeDistribution::histogram(text);
  ASSERT_EQ(sizes.nodes().size(), 2u);
  EXPECT_EQ(sizes.nodes()[0].size, 1);
  EXPECT_DOUBLE_EQ(sizes.nodes()[1].weight, 0.75);
  std::string many;
  for (int i = 0; i < 1000; ++i) many += std::to_string(1 + 0.001 * i) + " 1\n";
  std::istringstream fine(many);
  const SizeDistribution grouped = SizeDistribution::histogram(fine);
  EXPECT_LE(grouped.nodes().size(), 64u);
  // Groups keep the mean square.
  double square = 0;
  for (int i = 0; i < 1000; ++i) square += std::pow(1 + 0.001 * i, 2) / 1000;
  EXPECT_NEAR(grouped.moment(2), square, 1e-9);
  for (const char* wrong : {"", "0 1\n", "1 -1\n", "1 0\n", "1 2\n3\n"}) {
    std::istringstream bad(wrong);
    EXPECT_THROW(SizeDistribution::histogram(bad), std::domain_error) << wrong;
  }
}

TEST(TwoColumns, ErrorsNameTheLine) {
  std::istringstream text("r g\n1 2\n\n3 four\n");
  try {
    read_two_columns(text);
    FAIL();
  } catch (const std::domain_error& e) {
    EXPECT_NE(std::string(e.what()).find("line 4"), std::string::npos) << e.what();
  }
}

TEST(TwoColumns, SeparatorsAndQuotesOfExports) {
  const std::vector<std::pair<double, double>> rows = {{0.5, 10}, {1.25, 0.5}};
  for (const char* text :
       {"a b\n0.5 10\n1.25 0.5\n", "0.5,10\n1.25,0.5\n", "Size;Part\n0,5;10\n1,25;0,5\n",
        "\"Size\",\"Part\"\n\"0.5\",\"10\"\n\"1.25\",\"0.5\"\n", "0.5\t10\r\n1.25\t0.5\r\n"}) {
    std::istringstream in(text);
    EXPECT_EQ(read_two_columns(in), rows) << text;
  }
  for (const char* text : {"1 2 3\n", "1,2,10\n", "1;2;3\n"}) {
    std::istringstream in(text);
    try {
      read_two_columns(in);
      ADD_FAILURE() << text;
    } catch (const std::domain_error& e) {
      EXPECT_NE(std::string(e.what()).find("no third column"), std::string::npos) << e.what();
    }
  }
}

}  // namespace
}  // namespace aureole::optics

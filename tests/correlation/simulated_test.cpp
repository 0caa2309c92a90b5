// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "aureole/correlation/correlation.h"
#include "harness/properties_builder.h"

namespace aureole {
namespace {

using testing::build;

std::shared_ptr<Correlation> small(const std::string& more = "") {
  return build<Correlation>(R"(<correlation type="simulated"><integer name="discs" value="150"/>)"
                            R"(<integer name="snapshots" value="64"/>)" +
                            more + "</correlation>");
}

TEST(SimulatedCorrelation, KeepsWhatItKnows) {
  const auto correlation = small();
  const auto a = correlation->at(0.5);
  EXPECT_EQ(a, correlation->at(0.5));
  EXPECT_NEAR(a->eval(2.9), 1.92, 0.2);
  EXPECT_EQ(a->eval(2.9), small()->at(0.5)->eval(2.9));
  EXPECT_NE(a->eval(2.9), small(R"(<integer name="seed" value="1"/>)")->at(0.5)->eval(2.9));
  EXPECT_EQ(correlation->at(0)->eval(2.9), 1);
  EXPECT_FALSE(correlation->may_overlap());
}

TEST(SimulatedCorrelation, SaysWhichFractionsItKnows) {
  try {
    small()->at(0.69);
    FAIL();
  } catch (const std::domain_error& e) {
    EXPECT_NE(std::string(e.what()).find("0.68"), std::string::npos) << e.what();
  }
  EXPECT_THROW(build<Correlation>(R"(<correlation type="simulated"><integer name="discs" value="5"/>
                                     </correlation>)"),
               Error);
  EXPECT_THROW(build<Correlation>(R"(<correlation type="simulated"><integer name="snapshots" value="900000"/>
                                     </correlation>)"),
               Error);
}

TEST(SimulatedCorrelation, InterpolatesBetweenNodes) {
  const auto correlation = small();
  for (const auto& [least, most] : {std::pair{0.0, 0.68}, {0.3, 0.5}, {0.4, 0.4}}) {
    const auto nodes = correlation->nodes(least, most);
    EXPECT_EQ(nodes.front(), least);
    EXPECT_EQ(nodes.back(), most);
    EXPECT_TRUE(std::is_sorted(nodes.begin(), nodes.end()));
    EXPECT_LE(nodes.size(), 18u);
    // The error of 1/S' piecewise linear in Fa/(1 - Fa), for the theory, which has no noise.
    double worst = 0;
    for (size_t i = 0; i + 1 < nodes.size(); ++i)
      for (double u = 0; u < 15; u += 0.05) {
        const auto t = [](double fa) { return fa / (1 - fa); };
        const double middle = 0.5 * (t(nodes[i]) + t(nodes[i + 1]));
        const double linear = 0.5 / optics::hard_disc_structure_factor(u, nodes[i]) +
                              0.5 / optics::hard_disc_structure_factor(u, nodes[i + 1]);
        const double exact = optics::hard_disc_structure_factor(u, middle / (1 + middle));
        worst = std::max(worst, std::abs(1 / linear / exact - 1));
      }
    EXPECT_LT(worst, 0.015) << least << " " << most;
  }
}

}  // namespace
}  // namespace aureole

// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/interface/radio_material.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace aureole::optics {
namespace {

// eps'' = 17.98 sigma/f in GHz (Recommendation ITU-R P.2040-3, equation 10).
TEST(RadioMaterial, PermittivityAtWorkingFrequencies) {
  const std::complex<double> concrete = radio_permittivity("concrete", 3.5e9);
  EXPECT_DOUBLE_EQ(concrete.real(), 5.24);
  EXPECT_NEAR(concrete.imag(), 17.98 * 0.0462 * std::pow(3.5, 0.7822) / 3.5, 2e-4);
  const std::complex<double> ground = radio_permittivity("wet_ground", 2e9);
  EXPECT_NEAR(ground.real(), 30 * std::pow(2, -0.4), 1e-12);
  EXPECT_NEAR(ground.imag(), 17.98 * 0.15 * std::pow(2, 1.3) / 2, 1e-3);
  EXPECT_NEAR(radio_permittivity("metal", 28e9).imag(), 17.98e7 / 28, 1e4);
  EXPECT_EQ(radio_permittivity("vacuum", 1e9), 1.0);
  // Two ranges of one material.
  EXPECT_DOUBLE_EQ(radio_permittivity("glass", 28e9).real(), 6.31);
  EXPECT_DOUBLE_EQ(radio_permittivity("glass", 300e9).real(), 5.79);
}

std::string message(const char* name, double frequency) {
  try {
    radio_permittivity(name, frequency);
  } catch (const std::domain_error& e) {
    return e.what();
  }
  return "";
}

TEST(RadioMaterial, SaysNamesAndLimits) {
  EXPECT_NE(message("cheese", 1e9).find("concrete, brick"), std::string::npos);
  EXPECT_EQ(message("brick", 60e9),
            "frequency: the permittivity of brick is known for 1 to 40 GHz, got 60 GHz");
  EXPECT_EQ(
      message("glass", 150e9),
      "frequency: the permittivity of glass is known for 0.1 to 100 GHz and 220 to 450 GHz, got 150 GHz");
  EXPECT_NE(message("wood", NAN), "");
}

}  // namespace
}  // namespace aureole::optics

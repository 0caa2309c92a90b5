// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/medium/absorption.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "aureole/optics/medium/diffusion.h"

namespace aureole::optics {
namespace {

TEST(Absorption, OneLawManyNames) {
  // Optical density 2: one per cent passes.
  EXPECT_NEAR(transmittance_of_decadic(2), 0.01, 1e-16);
  EXPECT_NEAR(decadic_absorbance(0.01), 2, 1e-14);
  EXPECT_NEAR(napierian_absorbance(0.01), 4.605170185988091, 1e-14);
  EXPECT_NEAR(transmittance_of_napierian(1), 0.36787944117144233, 1e-16);
  EXPECT_NEAR(transmittance(absorption_of_decadic(2, 0.05), 0.05), 0.01, 1e-15);
  EXPECT_NEAR(absorption_of_napierian(0.3, 0.1), 3, 1e-14);
  EXPECT_NEAR(transmittance(0.4, 3) + absorptance(0.4, 3), 1, 1e-15);
  // Thin: absorptance is absorbance.
  EXPECT_NEAR(absorptance(1e-12, 1) / 1e-12, 1, 1e-11);
}

TEST(Absorption, FromIndexMoleculesAndMixtures) {
  // Water at 700 nm: 0.624 /m is k = 3.476e-8.
  EXPECT_NEAR(index_of_absorption(0.624, 700), 3.476e-8, 0.001e-8);
  EXPECT_NEAR(absorption_of_index(index_of_absorption(0.624, 700), 700), 0.624, 1e-14);
  // 1e-5 mol/L of 10000 L/(mol cm) in 1 cm is an optical density of 0.1.
  EXPECT_NEAR(decadic_absorbance(transmittance(absorption_of_molar(10000, 1e-5), 0.01)), 0.1, 1e-14);
  // Absorption cross section of a molecule: 3.82e-21 cm^2 per L/(mol cm).
  EXPECT_NEAR(cross_section_of_molar(1), 3.8235e-25, 0.0001e-25);
  EXPECT_NEAR(absorption_of_number(cross_section_of_molar(10000), 1e-5 * 1000 * kAvogadro) /
                  absorption_of_molar(10000, 1e-5),
              1, 1e-14);
  EXPECT_NEAR(absorption_of_mass(500, 0.02), 10, 1e-14);
  const AbsorbingShare shares[] = {{0.2, 5}, {3, 0.5}};
  EXPECT_NEAR(mixture_absorption(shares), 2.5, 1e-15);
}

TEST(Absorption, BadInputIsNamed) {
  EXPECT_THROW(napierian_absorbance(0), std::domain_error);
  EXPECT_THROW(decadic_absorbance(1.1), std::domain_error);
  EXPECT_THROW(transmittance(-1, 1), std::domain_error);
  EXPECT_THROW(absorptance(1, -1), std::domain_error);
  EXPECT_THROW(absorption_of_napierian(1, 0), std::domain_error);
  EXPECT_THROW(absorption_of_molar(1, std::nan("")), std::domain_error);
  EXPECT_THROW(absorption_of_index(1e-3, 0), std::domain_error);
  const AbsorbingShare wrong[] = {{-0.2, 5}};
  EXPECT_THROW(mixture_absorption(wrong), std::domain_error);
}

TEST(Diffusion, Coefficients) {
  const auto d = diffusion_coefficients(2, 1000, 0.9);
  EXPECT_NEAR(d.reduced_scattering, 100, 1e-10);
  EXPECT_NEAR(d.transport, 102, 1e-10);
  EXPECT_NEAR(d.diffusion, 1 / 306.0, 1e-15);
  EXPECT_NEAR(d.effective, std::sqrt(3 * 2 * 102.0), 1e-12);
  EXPECT_NEAR(d.mean_free_path, 1 / 1002.0, 1e-15);
  EXPECT_NEAR(d.reduced_albedo, 100 / 102.0, 1e-14);
  // The power absorbed around a point source is what it emits: integral of sigma_a times fluence.
  double sum = 0;
  constexpr int kSteps = 100000;
  const double end = 40 / d.effective;
  for (int i = 0; i < kSteps; ++i) {
    const double r = (i + 0.5) * end / kSteps;
    sum += 2 * diffusion_fluence(d, r) * 4 * 3.14159265358979 * r * r * end / kSteps;
  }
  EXPECT_NEAR(sum, 1, 1e-6);
  EXPECT_EQ(diffusion_coefficients(0, 0, 0).reduced_albedo, 1);
  EXPECT_THROW(diffusion_coefficients(-1, 0, 0), std::domain_error);
  EXPECT_THROW(diffusion_coefficients(1, 1, 1.5), std::domain_error);
}

}  // namespace
}  // namespace aureole::optics

// SPDX-License-Identifier: Apache-2.0
// The multipole of a slab against the dipole of a half-space, against its own integrals, and against the known reflectance of diffusion.
#include "aureole/optics/medium/diffusion_multipole.h"

#include <gtest/gtest.h>

#include <cmath>

#include "aureole/optics/medium/diffusion_dipole.h"

namespace aureole::optics {
namespace {

TEST(DiffusionMultipole, ThickSlabsAreHalfSpaces) {
  const DiffusionCoefficients medium = diffusion_coefficients(20, 2000, 0.3);
  const Dipole half_space(medium, 1.4);
  const Multipole slab(medium, 1.4, 0.1);
  for (const double r : {1e-4, 1e-3, 3e-3})
    EXPECT_NEAR(slab.profile(r) / half_space.profile(r), 1, 1e-6) << r;
  EXPECT_NEAR(slab.total() / half_space.total(), 1, 1e-6);
}

TEST(DiffusionMultipole, ProfilesAddUpToTheirIntegrals) {
  const Multipole slab(diffusion_coefficients(1, 1000, 0), 1, 5e-3);
  double disc = 0, line = 0;
  constexpr double from = 1e-6, to = 0.2;
  constexpr int kSteps = 4000;
  double before = from;
  for (int k = 1; k <= kSteps; ++k) {
    const double at = from * std::pow(to / from, double(k) / kSteps), middle = std::sqrt(before * at);
    disc += 2 * M_PI * middle * slab.profile(middle) * (at - before);
    if (k == kSteps / 2) EXPECT_NEAR(slab.within(at) / disc, 1, 1e-3);
    before = at;
  }
  // Fewer steps suffice for the smoother profile along a line.
  before = from;
  for (int k = 1; k <= 200; ++k) {
    const double at = from * std::pow(to / from, double(k) / 200), middle = std::sqrt(before * at);
    line += 2 * slab.line_profile(middle) * (at - before);
    before = at;
  }
  EXPECT_NEAR(disc / slab.total(), 1, 1e-3);
  EXPECT_NEAR(slab.within(10) / slab.total(), 1, 1e-9);
  // The profile along a line, integrated across it, is the whole again.
  EXPECT_NEAR(line / slab.total(), 1, 0.01);
}

TEST(DiffusionMultipole, ThinAndAbsorbingSlabsReturnLess) {
  const auto total = [](double absorption, double thickness) {
    return Multipole(diffusion_coefficients(absorption, 1000, 0), 1, thickness).total();
  };
  EXPECT_LT(total(1, 2e-3), total(1, 5e-3));
  EXPECT_LT(total(10, 5e-3), total(1, 5e-3));
  // Without absorption the reflectance of a slab of optical thickness t under a thin beam is known from diffusion:
  // 1 - (z + 2 D)/(t + 4 D) with the source at z, all in transport lengths (extrapolated boundaries, index 1).
  const double t = 10, extrapolated = 2.0 / 3;
  EXPECT_NEAR(total(0, 10e-3), 1 - (1 + extrapolated) / (t + 2 * extrapolated), 1e-6);
  EXPECT_NEAR(total(1e-3, 10e-3), total(0, 10e-3), 1e-3);
}

TEST(DiffusionMultipole, PortsLoseLight) {
  const Multipole slab(diffusion_coefficients(1, 1000, 0), 1, 20e-3);
  // A port about a tiny viewed spot returns what leaves within its radius.
  EXPECT_NEAR(port_part(slab, 1e-6, 5e-3), slab.within(5e-3) / slab.total(), 1e-4);
  double before = 0;
  for (const double port : {2e-3, 5e-3, 10e-3, 30e-3, 0.1}) {
    const double part = port_part(slab, 1e-3, port);
    EXPECT_GT(part, before);
    before = part;
  }
  EXPECT_GT(before, 0.99);
  // Which of two discs is lit and which is viewed makes no difference but for their areas (reciprocity).
  EXPECT_NEAR(port_part(slab, 4e-3, 3e-3), port_part(slab, 3e-3, 3e-3), 1e-12);
  EXPECT_THROW(Multipole(diffusion_coefficients(0, 0, 0), 1, 1e-3), std::domain_error);
  EXPECT_THROW(Multipole(diffusion_coefficients(1, 1, 0), 1, 0), std::domain_error);
}

}  // namespace
}  // namespace aureole::optics

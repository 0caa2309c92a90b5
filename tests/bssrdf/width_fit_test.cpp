// SPDX-License-Identifier: Apache-2.0
// The widths of normalised diffusion profiles (optics/medium/diffusion_width.cpp): the fit that made the numbers, and a
// check of some of them by fewer photons.
#include <gtest/gtest.h>

#include <cstdio>

#include "aureole/optics/medium/diffusion_width.h"
#include "bssrdf/half_space_photons.h"

namespace aureole::testing {
namespace {

std::vector<double> rings() {
  std::vector<double> edges = {0};
  for (double r = 1 / 16.; r < 130; r *= std::sqrt(2.)) edges.push_back(r);
  return edges;
}

/// The part of the light that a profile of the scale s has in a wrong ring.
double misplaced(const RadialProfile& truth, double s) {
  const auto within = [&](double r) { return 1 - std::exp(-r * s) / 4 - 3 * std::exp(-r * s / 3) / 4; };
  double sum = 0;
  for (std::size_t i = 0; i < truth.leaves.size(); ++i)
    sum +=
        std::abs(within(truth.radii[i + 1]) - within(truth.radii[i]) - truth.leaves[i] / truth.total()) / 2;
  return sum;
}

double best_scale(const RadialProfile& truth) {
  double best = 0, least = 2;
  for (double s = 0.1; s < 10; s *= 1.005)
    if (const double m = misplaced(truth, s); m < least) least = m, best = s;
  return best;
}

TEST(DiffusionWidth, DISABLED_MakesItsNumbers) {
  for (const double index : {1.0, 1.25, 1.5, 2.0}) {
    std::printf("    {");
    for (const double loss : {.7, .5, .3, .2, .1, .05, .02, .01, .005, .002, .001})
      std::printf("%.3f, ", best_scale(follow_photons({1 - loss, 0, index}, rings(), 400000)));
    std::printf("},  // index %g\n", index);
  }
}

TEST(DiffusionWidth, IsThatOfTransport) {
  for (const HalfSpace& h : {HalfSpace{.9, 0, 1}, HalfSpace{.98, 0, 1.375}}) {
    const RadialProfile truth = follow_photons(h, rings(), 20000, 3);
    const optics::DiffusionWidth width(h.index, optics::Illumination::normal);
    const double s =
        width.scale(optics::half_space_reflectance(h.albedo, h.index, optics::Illumination::normal));
    // The number between nodes is nearly as good as the best one.
    EXPECT_LT(misplaced(truth, s), misplaced(truth, best_scale(truth)) + 0.01);
  }
}

}  // namespace
}  // namespace aureole::testing

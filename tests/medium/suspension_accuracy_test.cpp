// SPDX-License-Identifier: Apache-2.0
// Coefficients and phase functions of the medium `suspension`, as tabulated for rendering, against sums of
// another program's Mie series over densely spaced radii.
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "aureole/instrument/medium_figures.h"
#include "aureole/medium/medium.h"
#include "harness/properties_builder.h"

namespace aureole::test {
namespace {

constexpr double kDegrees[] = {0, 2, 10, 45, 90, 120, 150, 165, 170, 175, 178};

struct SuspensionReference {
  const char *radius, *sizes;
  double host, n, k;
  int nm;
  double absorption, scattering, g;  // um^2
  double phase[std::size(kDegrees)];
};
#include "medium/references/suspension_references.inc"

TEST(SuspensionAccuracy, AgainstAnotherProgram) {
  constexpr double kPerCubicMetre = 1e12;  // so that a coefficient in 1/m is a cross section in um^2
  std::map<std::string, MediumPtr> media;
  std::vector<double> angles;
  for (const double degrees : kDegrees) angles.push_back(degrees * M_PI / 180);
  double worst_s = 0, worst_a = 0, worst_g = 0, worst_single = 0, worst_phase = 0;
  for (const SuspensionReference& r : kSuspensions) {
    char text[600];
    std::snprintf(
        text, sizeof text,
        "<medium type=\"suspension\"><float name=\"host\" value=\"%g\"/><ingredient type=\"spheres\">"
        "<string name=\"radius\" value=\"%s\"/>%s<float name=\"int_ior\" value=\"%g\"/>"
        "<float name=\"k\" value=\"%g\"/><float name=\"number_density\" value=\"%g\"/>"
        "</ingredient></medium>",
        r.host, r.radius, r.sizes, r.n, r.k, kPerCubicMetre);
    MediumPtr& medium = media[text];
    if (!medium) medium = testing::build<Medium>(text);
    const double nm[] = {double(r.nm)};
    MediumCoefficients c;
    medium->eval({}, {0, 0, 1}, Wavelengths::at(medium->properties().context().grid, float(r.nm)), c);
    const double s = c.sigma_s[0] / r.scattering - 1;
    const double a = (c.sigma_t[0] - c.sigma_s[0] - r.absorption) /
                     std::max(r.absorption, 1e-5 * (r.scattering + r.absorption));
    const double g = measure_medium(*medium, nm, {}, {0, 0, 1})[0].asymmetry - r.g;
    EXPECT_NEAR(s, 0, 1e-3) << text << r.nm;
    EXPECT_NEAR(a, 0, 1e-3) << text << r.nm;
    EXPECT_NEAR(g, 0, 1e-3) << text << r.nm;
    worst_s = std::max(worst_s, std::abs(s)), worst_a = std::max(worst_a, std::abs(a));
    worst_g = std::max(worst_g, std::abs(g));
    const std::vector<double> p = phase_over_angle(*medium, r.nm, angles, {}, {0, 0, 1});
    for (std::size_t i = 0; i < angles.size(); ++i) {
      // Relative to the value, or to 1e-3 of the mean over the sphere in the deep minima of spheres of one size.
      const double e = (p[i] - r.phase[i]) / std::max(r.phase[i], 1e-3 / (4 * M_PI));
      EXPECT_NEAR(e, 0, 0.025) << text << r.nm << " at " << kDegrees[i] << " degrees";
      double& worst = *r.sizes ? worst_phase : worst_single;
      worst = std::max(worst, std::abs(e));
    }
  }
  std::printf("worst errors: sigma_s %.1e, sigma_a %.1e, g %.1e, phase function %.1e (one size %.1e)\n",
              worst_s, worst_a, worst_g, worst_phase, worst_single);
}

}  // namespace
}  // namespace aureole::test

// SPDX-License-Identifier: Apache-2.0
#include "aureole/pigment/grains.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "aureole/optics/medium/spectral_table.h"
#include "aureole/optics/particle/mie.h"
#include "aureole/pigment/hiding.h"

namespace aureole::pigment {
namespace {

constexpr double kBinder = 1.5;

optics::Suspension grains(const optics::IndexFunction& index, double radius, double fraction,
                          bool crowded = false) {
  const optics::Ingredient i{.name = "grains",
                             .particles = optics::sphere_kind(index),
                             .radii = optics::RadiusDistribution::monodisperse(radius),
                             .amount = {optics::Amount::Kind::volume, fraction},
                             .density = 0,
                             .hard_spheres = crowded};
  return optics::Suspension({.index = optics::spectral_constant(kBinder)}, {i});
}

TEST(Grains, OneSizeByHand) {
  // Number density, Mie's cross sections and mean cosine, and the convention, written out.
  const double radius = 0.12e-6, fraction = 0.1, nm[] = {450, 550, 650};
  for (const Convention convention : conventions()) {
    const Paint paint = paint_of_grains(grains(carbon_black_index(), radius, fraction), nm, convention);
    for (std::size_t i = 0; i < 3; ++i) {
      const double size = 2 * M_PI * radius * kBinder / (nm[i] * 1e-9);
      const optics::Mie mie(size, std::complex<double>(1.95, 0.79) / kBinder);
      const double per_length = fraction / (4.0 / 3 * M_PI * std::pow(radius, 3)) * M_PI * radius * radius;
      const double scattering = per_length * mie.scattering(),
                   absorption = per_length * (mie.extinction() - mie.scattering());
      const double g = mie.asymmetry();
      const double s =
          convention == Convention::double_gauss
              ? scattering * (1 - 0.75 * g)
              : 0.75 * scattering * (1 - g) - (convention == Convention::diffusion ? absorption / 4 : 0);
      EXPECT_NEAR(paint[i].k / (2 * absorption), 1, 1e-9);
      EXPECT_NEAR(paint[i].s, std::max(s, 0.0), 1e-9 * scattering) << name_of(convention);
    }
  }
}

TEST(Grains, RutileOfAQuarterMicrometreIsTheBestWhite) {
  EXPECT_NEAR(rutile_index()(589).real(), (2 * 2.613 + 2.909) / 3, 4e-3);  // handbooks, sodium D
  const double nm[] = {550};
  double best = 0, at = 0;
  for (double diameter = 0.1e-6; diameter < 1.05e-6; diameter += 0.02e-6) {
    const double s = paint_of_grains(grains(rutile_index(), diameter / 2, 0.1), nm)[0].s;
    if (s > best) best = s, at = diameter;
  }
  // What makers of pigments aim at: some half of the wavelength in the binder.
  EXPECT_GT(at, 0.18e-6);
  EXPECT_LT(at, 0.30e-6);
  const Coefficients white = paint_of_grains(grains(rutile_index(), at / 2, 0.15), nm)[0];
  const Coefficients crowded = paint_of_grains(grains(rutile_index(), at / 2, 0.15, true), nm)[0];
  EXPECT_EQ(white.k, 0);
  EXPECT_LT(crowded.s, white.s);
  EXPECT_GT(crowded.s, 0.8 * white.s);
  std::printf("best diameter %.2f um, S at 15 %% %.0f /mm (crowded %.0f), hides from %.0f um\n", at * 1e6,
              white.s * 1e-3, crowded.s * 1e-3, 1e6 * hiding_thickness(crowded));
  EXPECT_THROW(paint_of_grains(grains(rutile_index(), 1e-7, 0.9), nm), std::domain_error);
}

}  // namespace
}  // namespace aureole::pigment

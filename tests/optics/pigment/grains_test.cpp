// SPDX-License-Identifier: Apache-2.0
#include "aureole/pigment/grains.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <limits>
#include <stdexcept>

#include "aureole/optics/medium/spectral_table.h"
#include "aureole/optics/particle/mie_sphere.h"
#include "aureole/pigment/grain_index.h"
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
    const Paint paint =
        paint_of_grains(grains(find_grain_index("carbon black")->index, radius, fraction), nm, convention);
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
  EXPECT_NEAR(find_grain_index("rutile")->index(589).real(), (2 * 2.613 + 2.909) / 3,
              4e-3);  // handbooks, sodium D
  const double nm[] = {550};
  double best = 0, at = 0;
  for (double diameter = 0.1e-6; diameter < 1.05e-6; diameter += 0.02e-6) {
    const double s = paint_of_grains(grains(find_grain_index("rutile")->index, diameter / 2, 0.1), nm)[0].s;
    if (s > best) best = s, at = diameter;
  }
  // The diameter that makers of pigments aim at: some half of the wavelength in the binder.
  EXPECT_GT(at, 0.18e-6);
  EXPECT_LT(at, 0.30e-6);
  const Coefficients white = paint_of_grains(grains(find_grain_index("rutile")->index, at / 2, 0.15), nm)[0];
  const Coefficients crowded =
      paint_of_grains(grains(find_grain_index("rutile")->index, at / 2, 0.15, true), nm)[0];
  EXPECT_EQ(white.k, 0);
  EXPECT_LT(crowded.s, white.s);
  EXPECT_GT(crowded.s, 0.8 * white.s);
  std::printf("best diameter %.2f um, S at 15 %% %.0f /mm (crowded %.0f), hides from %.0f um\n", at * 1e6,
              white.s * 1e-3, crowded.s * 1e-3, 1e6 * hiding_thickness(crowded));
  EXPECT_THROW(paint_of_grains(grains(find_grain_index("rutile")->index, 1e-7, 0.9), nm), std::domain_error);
}

TEST(Grains, IndicesByName) {
  // Sodium D, from other handbooks than the sources: (2 n_o + n_e)/3, or the mean of three.
  const auto n = [](const char* name) { return find_grain_index(name)->index(589.3); };
  EXPECT_NEAR(n("titanium white").real(), (2 * 2.613 + 2.909) / 3, 4e-3);
  EXPECT_NEAR(n("calcite").real(), (2 * 1.6584 + 1.4864) / 3, 5e-4);
  EXPECT_NEAR(n("quartz").real(), (2 * 1.5442 + 1.5533) / 3, 5e-4);
  EXPECT_NEAR(n("zinc oxide").real(), (2 * 2.008 + 2.029) / 3, 0.012);
  EXPECT_NEAR(n("zinc sulfide").real(), 2.368, 5e-3);  // sphalerite
  EXPECT_NEAR(n("anatase").real(), (2 * 2.561 + 2.488) / 3, 0.04);
  // Red: hematite absorbs blue light far more than red light.
  const auto red = find_grain_index("Iron Oxide Red")->index;
  EXPECT_GT(red(450).imag(), 5 * red(650).imag());
  EXPECT_EQ(red(100), red(360));
  EXPECT_EQ(red(550), (2.0 * std::complex<double>(3.318, 0.498) + std::complex<double>(2.927, 0.460)) / 3.0);
  EXPECT_FALSE(find_grain_index("ochre"));
  for (const std::string& name : grain_index_names()) {
    const auto g = find_grain_index(name);
    ASSERT_TRUE(g) << name;
    EXPECT_FALSE(g->source.empty()) << name;
    for (const double nm : {360.0, 550.0, 830.0}) EXPECT_EQ(g->index(nm).imag() > 0, g->absorbs) << name;
  }
}

}  // namespace
}  // namespace aureole::pigment

// SPDX-License-Identifier: Apache-2.0
// Colour strength, tint tone and spreading rates against closed forms.
#include "aureole/pigment/colour_strength.h"

#include <gtest/gtest.h>

#include <cmath>

#include "aureole/pigment/hiding.h"
#include "aureole/pigment/kubelka_munk_layer.h"

namespace aureole::pigment {
namespace {

/// K/S of a dye with one band at 520 nm, over a base.
struct Dyeing {
  std::vector<double> nm, ratio, base;

  Dyeing() {
    for (double l = 390; l <= 710; l += 10) {
      nm.push_back(l), base.push_back(0.01 + 1e-5 * l);
      ratio.push_back(3 * std::exp(-std::pow((l - 520) / 40, 2)));
    }
  }
  std::vector<double> reflectance(double amount, const Surface& surface) const {
    std::vector<double> r;
    for (std::size_t i = 0; i < nm.size(); ++i)
      r.push_back(outer_reflectance(surface, opaque_reflectance(base[i] + amount * ratio[i])));
    return r;
  }
};

Observation flat_observer(const std::vector<double>& nm) {
  const auto bell = [](double centre, double width) {
    return [=](double l) { return std::exp(-std::pow((l - centre) / width, 2)); };
  };
  return Observation("flat", nm, [](double) { return 1.0; }, {bell(600, 50), bell(550, 50), bell(450, 30)});
}

TEST(ColourStrength, OfTheAmountOfADye) {
  const Dyeing dye;
  const Observation lamp = flat_observer(dye.nm);
  for (const Surface& surface : {Surface{}, saunderson_surface(0.04, 0.6, Specular::included)}) {
    const StrengthSettings settings{surface, dye.reflectance(0, surface)};
    const std::vector<double> standard = dye.reflectance(1, surface), sample = dye.reflectance(1.3, surface);
    const ColourStrength s = colour_strength(dye.nm, standard, sample, lamp, settings);
    EXPECT_EQ(s.nm, 520);
    EXPECT_NEAR(s.at_maximum, 1.3, 1e-9);
    EXPECT_NEAR(s.summed, 1.3, 1e-9);
    EXPECT_NEAR(s.weighted, 1.3, 1e-9);
    const std::vector<double> even = at_equal_strength(dye.nm, sample, s.at_maximum, settings);
    for (std::size_t i = 0; i < even.size(); ++i) EXPECT_NEAR(even[i], standard[i], 1e-9);
  }
  // Without the white its K/S counts as the dye's: (base + 1.3 dye)/(base + dye) at 520 nm.
  const double base = 0.01 + 520e-5;
  EXPECT_NEAR(colour_strength(dye.nm, dye.reflectance(1, {}), dye.reflectance(1.3, {}), lamp).at_maximum,
              (base + 3.9) / (base + 3), 1e-9);
  // The standard is the white.
  EXPECT_THROW(colour_strength(dye.nm, dye.reflectance(0, {}), dye.reflectance(1, {}), lamp,
                               {{}, dye.reflectance(0, {})}),
               std::domain_error);
  EXPECT_THROW(colour_strength(dye.nm, std::vector<double>(dye.nm.size(), 1.2), dye.reflectance(1, {}), lamp),
               std::domain_error);
}

/// A litre in a wet film of 100 um covers 10 m^2; with 40 % of solids it dries to 40 um.
TEST(ColourStrength, SpreadingRate) {
  EXPECT_NEAR(spreading_rate(40e-6, 0.4), 10, 1e-12);
  EXPECT_NEAR(dry_thickness(10, 0.4), 40e-6, 1e-18);
  EXPECT_THROW(spreading_rate(40e-6, 1.4), std::domain_error);
  EXPECT_THROW(dry_thickness(0, 0.4), std::domain_error);
}

/// Excluded to included adds k1 = ((n - 1)/(n + 1))^2 of normal incidence nearly, 4.0 % at 8 degrees for n = 1.5, and
/// nothing else, since both see the light from within alike.
TEST(ColourStrength, SpecularComponentIsAddedAndRemoved) {
  const Surface excluded = smooth_surface(1.5, Geometry::diffuse_8, Specular::excluded),
                included = smooth_surface(1.5, Geometry::diffuse_8, Specular::included);
  for (const double r : {0.01, 0.2, 0.8}) {
    EXPECT_NEAR(converted_reflectance(excluded, included, r) - r, 0.04, 1e-4);
    EXPECT_NEAR(converted_reflectance(included, excluded, converted_reflectance(excluded, included, r)), r,
                1e-12);
  }
}

}  // namespace
}  // namespace aureole::pigment

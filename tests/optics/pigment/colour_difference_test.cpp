// SPDX-License-Identifier: Apache-2.0
#include "aureole/pigment/colour_difference.h"

#include <gtest/gtest.h>

#include <cmath>

#include "aureole/pigment/observation.h"

namespace aureole::pigment {
namespace {

/// G. Sharma, W. Wu, E. N. Dalal, Color Res. Appl. 30, 2005, table 1.
struct Pair {
  Lab a, b;
  double difference;
};
constexpr Pair kPairs[] = {{{50, 2.6772, -79.7751}, {50, 0, -82.7485}, 2.0425},
                           {{50, 3.1571, -77.2803}, {50, 0, -82.7485}, 2.8615},
                           {{50, 2.8361, -74.02}, {50, 0, -82.7485}, 3.4412},
                           {{50, -1.3802, -84.2814}, {50, 0, -82.7485}, 1},
                           {{50, -1.1848, -84.8006}, {50, 0, -82.7485}, 1},
                           {{50, -0.9009, -85.5211}, {50, 0, -82.7485}, 1},
                           {{50, 0, 0}, {50, -1, 2}, 2.3669},
                           {{50, -1, 2}, {50, 0, 0}, 2.3669},
                           {{50, 2.49, -0.001}, {50, -2.49, 0.0009}, 7.1792},
                           {{50, 2.49, -0.001}, {50, -2.49, 0.001}, 7.1792},
                           {{50, 2.49, -0.001}, {50, -2.49, 0.0011}, 7.2195},
                           {{50, 2.49, -0.001}, {50, -2.49, 0.0012}, 7.2195},
                           {{50, -0.001, 2.49}, {50, 0.0009, -2.49}, 4.8045},
                           {{50, -0.001, 2.49}, {50, 0.001, -2.49}, 4.8045},
                           {{50, -0.001, 2.49}, {50, 0.0011, -2.49}, 4.7461},
                           {{50, 2.5, 0}, {50, 0, -2.5}, 4.3065},
                           {{50, 2.5, 0}, {73, 25, -18}, 27.1492},
                           {{50, 2.5, 0}, {61, -5, 29}, 22.8977},
                           {{50, 2.5, 0}, {56, -27, -3}, 31.903},
                           {{50, 2.5, 0}, {58, 24, 15}, 19.4535},
                           {{50, 2.5, 0}, {50, 3.1736, 0.5854}, 1},
                           {{50, 2.5, 0}, {50, 3.2972, 0}, 1},
                           {{50, 2.5, 0}, {50, 1.8634, 0.5757}, 1},
                           {{50, 2.5, 0}, {50, 3.2592, 0.335}, 1},
                           {{60.2574, -34.0099, 36.2677}, {60.4626, -34.1751, 39.4387}, 1.2644},
                           {{63.0109, -31.0961, -5.8663}, {62.8187, -29.7946, -4.0864}, 1.263},
                           {{61.2901, 3.7196, -5.3901}, {61.4292, 2.248, -4.962}, 1.8731},
                           {{35.0831, -44.1164, 3.7933}, {35.0232, -40.0716, 1.5901}, 1.8645},
                           {{22.7233, 20.0904, -46.694}, {23.0331, 14.973, -42.5619}, 2.0373},
                           {{36.4612, 47.858, 18.3852}, {36.2715, 50.5065, 21.2231}, 1.4146},
                           {{90.8027, -2.0831, 1.441}, {91.1528, -1.6435, 0.0447}, 1.4441},
                           {{90.9257, -0.5406, -0.9208}, {88.6381, -0.8985, -0.7239}, 1.5381},
                           {{6.7747, -0.2908, -2.4247}, {5.8714, -0.0985, -2.2286}, 0.6377},
                           {{2.0776, 0.0795, -1.135}, {0.9033, -0.0636, -0.5514}, 0.9082}};

TEST(ColourDifference, PublishedPairs) {
  for (const Pair& p : kPairs) {
    EXPECT_NEAR(ciede2000(p.a, p.b), p.difference, 5.1e-5) << p.a.l << " " << p.a.a << " " << p.a.b;
    EXPECT_NEAR(ciede2000(p.b, p.a), p.difference, 5.1e-5) << p.a.l << " " << p.a.a << " " << p.a.b;
  }
  EXPECT_EQ(ciede2000({50, 0, 0}, {50, 0, 0}), 0);
}

/// By colour-science 0.4.7 and, for DIN99o, coloraide 8: tests/references/colour_figures.py prints these numbers.
TEST(ColourDifference, OtherFormulasAgreeWithOtherPrograms) {
  struct Reference {
    Lab a, b;
    double cie1976, cmc21, cmc11, graphic_arts, textiles, din99o;
  };
  const Reference references[] = {
      {{50, 2.6772, -79.7751}, {50, 0, -82.7485}, 4.001063, 1.738736, 1.738736, 1.395039, 1.423046, 1.767769},
      {{60.2574, -34.0099, 36.2677},
       {60.4626, -34.1751, 39.4387},
       3.181924,
       1.420486,
       1.428230,
       1.390995,
       1.389733,
       1.710469},
      {{10, 5, 4}, {12, 3, 6}, 3.464102, 4.768942, 5.850789, 3.261589, 2.777393, 4.080523},
      {{90, -2, 60}, {88, 4, 55}, 8.062258, 4.109348, 4.285418, 4.002173, 3.679736, 4.690548},
      {{40, 30, -50}, {41, 25, -52}, 5.477226, 3.167056, 3.292843, 3.028856, 2.992120, 4.039487},
      {{75, 0, 0}, {74, 1, 1}, 1.732051, 2.248647, 2.342059, 1.732051, 1.500000, 2.458477},
      {{30, -40, 10}, {33, -38, 16}, 7.000000, 4.094271, 5.216627, 4.926509, 4.281274, 5.647552},
      {{55, 0.5, 50}, {55, -0.5, 50}, 1.000000, 0.664920, 0.664920, 0.571416, 0.588223, 0.739096}};
  for (const Reference& r : references) {
    EXPECT_NEAR(cie1976(r.a, r.b), r.cie1976, 1e-6);
    EXPECT_NEAR(cmc(r.a, r.b), r.cmc21, 1e-6);
    EXPECT_NEAR(cmc(r.a, r.b, 1, 1), r.cmc11, 1e-6);
    EXPECT_NEAR(cie94(r.a, r.b), r.graphic_arts, 1e-6);
    EXPECT_NEAR(cie94(r.a, r.b, Cie94::textiles), r.textiles, 1e-6);
    EXPECT_NEAR(din99o(r.a, r.b), r.din99o, 1e-5);
    const LchDifference d = lch_difference(r.a, r.b);
    EXPECT_NEAR(std::hypot(d.l, d.c, d.h), r.cie1976, 1e-6);
  }
  // From red (h = 0) to yellowish red the hue angle increases; opposite hues differ by the sum of the chromas.
  EXPECT_GT(lch_difference({50, 10, 0}, {50, 10, 1}).h, 0);
  EXPECT_NEAR(lch_difference({50, 10, 0}, {50, -10, 0}).h, 20, 1e-9);
  EXPECT_NEAR(hue_degrees({50, 0, -1}), 270, 1e-12);
}

TEST(ColourDifference, LabBothWays) {
  const Xyz white{0.9505, 1, 1.089};
  const Lab grey = lab_of_xyz({0.18 * 0.9505, 0.18, 0.18 * 1.089}, white);
  EXPECT_NEAR(grey.l, 116 * std::cbrt(0.18) - 16, 1e-12);
  EXPECT_NEAR(grey.a, 0, 1e-12);
  for (const Xyz& xyz : {Xyz{0.3, 0.2, 0.1}, {0.001, 0.002, 0.003}, {0, 0, 0}, {0.9, 1, 1.1}}) {
    const Xyz back = xyz_of_lab(lab_of_xyz(xyz, white), white);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(back[i], xyz[i], 1e-14);
  }
  EXPECT_NEAR(lab_of_xyz({0, 0.001, 0}, white).l, 0.9033, 1e-4);  // linear below (6/29)^3
}

TEST(Observation, SumsEveryNanometre) {
  std::vector<double> nm, flat, ramp;
  for (int l = 380; l <= 780; l += 10) nm.push_back(l), flat.push_back(0.4), ramp.push_back(l * 1e-3);
  const auto bell = [](double centre, double width) {
    return [=](double l) { return std::exp(-std::pow((l - centre) / width, 2)); };
  };
  const Observation o("bells", nm, [](double l) { return 1 + 0.001 * l; },
                      {bell(600, 50), bell(550, 50), bell(450, 30)});
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(o.xyz(flat)[i], 0.4 * o.white()[i], 1e-12);
  EXPECT_NEAR(o.white()[1], 1, 1e-12);
  EXPECT_NEAR(o.lab(flat).a, 0, 1e-9);
  // A straight reflectance is interpolated without error: the plain sum.
  double sum = 0, white = 0;
  for (int l = 360; l <= 830; ++l) {
    const double w = (1 + 0.001 * l) * std::exp(-std::pow((l - 550.0) / 50, 2));
    sum += w * std::clamp(double(l), 380.0, 780.0) * 1e-3, white += w;
  }
  EXPECT_NEAR(o.xyz(ramp)[1], sum / white, 1e-12);

  const std::vector<double> infrared{700, 800};
  EXPECT_THROW(
      Observation("x", infrared, [](double) { return 1.0; }, {bell(600, 50), bell(550, 50), bell(450, 30)}),
      std::domain_error);
  EXPECT_THROW(o.xyz(infrared), std::domain_error);
}

}  // namespace
}  // namespace aureole::pigment

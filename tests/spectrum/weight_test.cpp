// SPDX-License-Identifier: Apache-2.0
// The throughput of a path is composed in the order of the light, whatever a weight is: with maps that do not
// commute, as polarised light needs, paths from the sensor and from the lights find the product that light
// sees.
#include <gtest/gtest.h>

#include "aureole/spectrum/path_density.h"
#include "harness/matrix_light.h"

namespace aureole::testing {
namespace {

using Map = MatrixLight::Weight;

const Map kFirst(1.f, 0.3f, 0.8f, 0.1f, 0.6f), kSecond(1.f, 0.9f, 0.2f, 0.7f, 0.4f),
    kThird(1.f, 0.2f, 0.5f, 0.8f, 0.1f);
const Spectrum kRadiance = make_spectrum([](int i) { return 1 + 0.2f * float(i); });
/// Light passes the third map, the second, the first.
const MatrixLight::Light kExpected = kFirst.of(kSecond.of(kThird.of(MatrixLight::emitted(kRadiance))));

TEST(Weight, MapsOfTheTestDoNotCommute) {
  EXPECT_GT(std::abs(kThird.of(kSecond.of(kFirst.of(MatrixLight::emitted(kRadiance)))).a[0] - kExpected.a[0]),
            0.01f);
}

TEST(Weight, PathsFromTheSensorMeetTheLastMapOfLightFirst) {
  BasicPathDensity<MatrixLight, PathStart::sensor> path;
  path.extend(kFirst, Spectrum(2.f), false);
  path.extend(kSecond, Spectrum(1.f), false);
  path.attenuate(0.5f);
  path.extend(kThird, Spectrum(1.f), false);
  path.pass({.value = 2.f});
  path.survive(0.5f);
  for (int i = 0; i < kWavelengths; ++i) EXPECT_NEAR(path.seen(kRadiance)[i], kExpected.a[i], 1e-5f);
}

TEST(Weight, LightPathsComposeAsLightGoes) {
  BasicPathDensity<MatrixLight, PathStart::emitter> path;
  path.beta = MatrixLight::emitted(kRadiance);
  path.extend(kThird, Spectrum(2.f), false);
  path.attenuate(0.5f);
  path.extend(kSecond, Spectrum(1.f), false);
  path.pass({.value = 2.f});
  path.survive(0.5f);
  const Wavelengths w = Wavelengths::at(SpectralGrid{}, Spectrum(500.f));
  const Spectrum reached = path.reached(kFirst, 3, w) * w.pdf * sum(path.r_u);
  for (int i = 0; i < kWavelengths; ++i) EXPECT_NEAR(reached[i], 3 * kExpected.a[i], 1e-5f);
}

TEST(PathDensity, WavelengthsOfALightPathShareIt) {
  // Each wavelength could have been the hero that chose the direction: the path counts over the sum of their pdfs.
  const Spectrum pdf = make_spectrum([](int i) { return 0.5f + 0.25f * float(i); });
  const Spectrum value = make_spectrum([](int i) { return 2.f - 0.2f * float(i); });
  LightPathDensity path;
  path.beta = Unpolarised::emitted(kRadiance);
  path.extend(Weight(value), pdf, false);
  const Wavelengths w = Wavelengths::at(SpectralGrid{}, Spectrum(500.f));
  const Spectrum reached = path.reached(Weight(0.5f), 3, w),
                 expected = kRadiance * value * 1.5f / (w.pdf * sum(pdf));
  for (int i = 0; i < kWavelengths; ++i) EXPECT_NEAR(reached[i], expected[i], 1e-6f);
}

TEST(PathDensity, RatiosOfWalkingAndOfLightSampling) {
  const Spectrum pdf = make_spectrum([](int i) { return 0.5f + 0.25f * float(i); });
  PathDensity path;
  EXPECT_FALSE(path.has_light_ratio());
  path.extend(Weight(pdf), pdf, false);
  ASSERT_TRUE(path.has_light_ratio());
  // The pdf of light sampling, where it would have been 3 per steradian, over the hero's.
  EXPECT_FLOAT_EQ((path.r_l * 3.f)[1], 3.f / pdf[0]);
  EXPECT_FLOAT_EQ(path.r_u[1], pdf[1] / pdf[0]);
  // The two techniques share the path: each counts the integrand over the sum of both pdfs.
  const Wavelengths w = Wavelengths::at(SpectralGrid{}, Spectrum(500.f));
  const Spectrum walked = path.met(2.f, 3.f, w), expected = pdf * 2.f / (w.pdf * sum(pdf + 3.f));
  for (int i = 0; i < kWavelengths; ++i) EXPECT_NEAR(walked[i], expected[i], 1e-6f);
  // A passage multiplies each by what its technique would have had.
  path.pass({.value = 1.f, .flight = 0.5f, .connection = 0.25f});
  EXPECT_FLOAT_EQ((path.r_l * 3.f)[1], 0.75f / pdf[0]);
  EXPECT_FLOAT_EQ(path.r_u[1], 0.5f * pdf[1] / pdf[0]);
  path.extend(Weight(), pdf, true);
  EXPECT_FALSE(path.has_light_ratio()) << "light sampling finds nothing behind a mirror";
}

}  // namespace
}  // namespace aureole::testing

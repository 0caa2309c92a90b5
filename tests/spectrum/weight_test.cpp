// SPDX-License-Identifier: Apache-2.0
// The throughput of a path is composed in the order of the light, whatever a weight is: with a matrix per
// wavelength in its place, as polarised light needs, both kinds of paths find the product that light sees.
#include <gtest/gtest.h>

#include "aureole/spectrum/path_density.h"

namespace aureole::test {
namespace {

/// A 4 x 4 matrix per wavelength, without any physics. Light is the first component of what it is applied to.
class Mueller {
public:
  Mueller() {
    for (int i = 0; i < 4; ++i) m_[i][i] = Spectrum(1.f);
  }
  static Mueller numbered(float seed) {
    Mueller a;
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j)
        a.m_[i][j] =
            make_spectrum([&](int k) { return 0.1f + std::abs(std::sin(seed * float(4 * i + j + 1 + k))); });
    return a;
  }

  Spectrum of(const Spectrum& light) const { return m_[0][0] * light; }
  Mueller after(const Mueller& first) const {
    Mueller r;
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j) {
        r.m_[i][j] = 0.f;
        for (int k = 0; k < 4; ++k) r.m_[i][j] += m_[i][k] * first.m_[k][j];
      }
    return r;
  }
  Mueller scaled(const Spectrum& s) const {
    Mueller r = *this;
    for (auto& row : r.m_)
      for (Spectrum& x : row) x *= s;
    return r;
  }
  float largest() const { return max_component(m_[0][0]); }
  bool is_black() const { return aureole::is_black(m_[0][0]); }

private:
  Spectrum m_[4][4];
};

void expect_same(const Mueller& a, const Mueller& b) {
  for (int k = 0; k < kWavelengths; ++k)
    EXPECT_NEAR(a.of(1.f)[k], b.of(1.f)[k], 1e-5f * std::abs(b.of(1.f)[k]));
}

const Mueller kFirst = Mueller::numbered(0.3f), kSecond = Mueller::numbered(0.7f),
              kThird = Mueller::numbered(1.1f);
/// As light goes: through the third, the second, the first.
const Mueller kProduct = kFirst.after(kSecond.after(kThird));

TEST(Weight, MatricesDoNotCommute) {
  EXPECT_GT(std::abs(kProduct.of(1.f)[0] - kThird.after(kSecond.after(kFirst)).of(1.f)[0]), 0.01f);
}

TEST(Weight, PathsFromTheSensorMeetTheLastFactorOfLightFirst) {
  BasicPathDensity<Mueller, PathStart::sensor> path;
  path.extend(kFirst, Spectrum(2.f), false);
  path.attenuate(kSecond);
  path.pass({.value = kThird});
  path.survive(0.5f);
  expect_same(path.beta, kProduct);
}

TEST(Weight, PathsFromEmittersComposeAsLightGoes) {
  BasicPathDensity<Mueller, PathStart::emitter> path;
  path.extend(kThird, Spectrum(2.f), false);
  path.attenuate(kSecond);
  path.pass({.value = kFirst});
  path.survive(0.5f);
  expect_same(path.beta, kProduct);
}

TEST(PathDensity, RatiosOfWalkingAndOfLightSampling) {
  const Spectrum pdf = make_spectrum([](int i) { return 0.5f + 0.25f * float(i); });
  PathDensity path;
  EXPECT_FALSE(path.has_light_ratio());
  path.extend(Weight(pdf), pdf, false);
  ASSERT_TRUE(path.has_light_ratio());
  // The density of light sampling, where it would have been 3 per steradian, over the hero's.
  EXPECT_FLOAT_EQ((path.light_ratio * 3.f)[1], 3.f / pdf[0]);
  EXPECT_FLOAT_EQ(path.ratio[1], pdf[1] / pdf[0]);
  // The two techniques share the path: their estimates add up to the integrand over its densities.
  const Wavelengths w = Wavelengths::at(SpectralGrid{}, Spectrum(500.f));
  PathDensity before;
  const Spectrum walked = path.met(2.f, 3.f, w), connected = before.connected(Weight(pdf), 2.f, 3.f, pdf, w);
  for (int i = 0; i < kWavelengths; ++i) EXPECT_NEAR(walked[i], connected[i] * 1.f, 1e-6f);
  // A passage multiplies each by what its technique would have had.
  path.pass({.value = {}, .flight = 0.5f, .connection = 0.25f});
  EXPECT_FLOAT_EQ((path.light_ratio * 3.f)[1], 0.75f / pdf[0]);
  EXPECT_FLOAT_EQ(path.ratio[1], 0.5f * pdf[1] / pdf[0]);
  path.extend(Weight(), pdf, true);
  EXPECT_FALSE(path.has_light_ratio()) << "light sampling finds nothing behind a mirror";
}

}  // namespace
}  // namespace aureole::test

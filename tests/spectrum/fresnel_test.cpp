// SPDX-License-Identifier: Apache-2.0
// The renderer's single-precision Fresnel terms against those in double precision, which have their own
// tests.
#include "aureole/spectrum/fresnel.h"

#include <gtest/gtest.h>

#include <cmath>

#include "aureole/optics/interface/fresnel_equations.h"

namespace aureole {
namespace {

/// Cosines spread over (0, 1], dense at both ends.
std::vector<float> cosines() {
  std::vector<float> c;
  for (int i = 1; i <= 200; ++i) c.push_back(float(i) / 200);
  for (float x = 1e-7f; x < 5e-3f; x *= 2) c.push_back(x), c.push_back(1 - x);
  return c;
}

/// eta as the product of two floats, so that both precisions see the same index.
constexpr float kEtas[] = {0.25f,  0.5f, 0.66f, 0.75f, 0.9f, 0.999f, 1.f,
                           1.001f, 1.1f, 1.33f, 1.5f,  1.9f, 2.42f,  4.f};

TEST(BsdfFresnel, DielectricAgreesWithDoublePrecision) {
  double largest = 0, largest_cosine = 0;
  for (const float eta : kEtas)
    for (const float c : cosines()) {
      const DielectricFresnel f = fresnel_dielectric(c, eta);
      const double expected = optics::fresnel_reflectance(c, 1, eta);
      // Near the critical angle the reflectance has an infinite slope: there the float cosine itself limits
      // the accuracy.
      const double sin2_t = (1 - double(c) * c) / (double(eta) * eta);
      const double slack = eta < 1 && std::abs(1 - sin2_t) < 1e-4 ? 2e-3 : 2e-6;
      EXPECT_NEAR(f.reflectance, expected, slack) << "cos " << c << ", eta " << eta;
      if (slack < 1e-5) largest = std::max(largest, std::abs(f.reflectance - expected));
      if (sin2_t < 1) {
        EXPECT_NEAR(f.cos_t, std::sqrt(1 - sin2_t), slack) << "cos " << c << ", eta " << eta;
        largest_cosine =
            std::max(largest_cosine, slack < 1e-5 ? std::abs(f.cos_t - std::sqrt(1 - sin2_t)) : 0);
      }
    }
  RecordProperty("largest_error", std::to_string(largest));
  RecordProperty("largest_error_of_cosine", std::to_string(largest_cosine));
}

TEST(BsdfFresnel, SpectrumIsTheScalar) {
  for (const float c : cosines()) {
    const Spectrum eta = make_spectrum([](int i) { return kEtas[i + 3]; });
    const Spectrum r = fresnel_dielectric(c, eta);
    for (int i = 0; i < kWavelengths; ++i)
      EXPECT_NEAR(r[i], fresnel_dielectric(c, eta[i]).reflectance, 2e-6f);
  }
}

TEST(BsdfFresnel, ExactValues) {
  EXPECT_FLOAT_EQ(fresnel_dielectric(1.f, 1.5f).reflectance, 0.04f);
  EXPECT_FLOAT_EQ(fresnel_dielectric(1.f, 2.f / 3).reflectance, 0.04f);
  for (const float c : cosines()) {
    EXPECT_EQ(fresnel_dielectric(c, 1.f).reflectance, 0.f) << c;  // matched indices, at grazing, too
    EXPECT_FLOAT_EQ(fresnel_dielectric(c, 1.f).cos_t, c);
  }
  EXPECT_EQ(fresnel_dielectric(0.f, 1.5f).reflectance, 1.f);
  EXPECT_EQ(fresnel_dielectric(0.f, 1.f).reflectance, 1.f);
  EXPECT_EQ(fresnel_dielectric(0.5f, 0.5f).reflectance, 1.f);  // beyond the critical angle
  // Brewster's angle: the s part only.
  const float cos_b = 1 / std::sqrt(1 + 1.5f * 1.5f), r_s = (1 - 1.5f * 1.5f) / (1 + 1.5f * 1.5f);
  EXPECT_NEAR(fresnel_dielectric(cos_b, 1.5f).reflectance, 0.5f * r_s * r_s, 1e-7f);
}

TEST(BsdfFresnel, ConductorAgreesWithDoublePrecision) {
  double largest = 0;
  for (const float eta : {0.05f, 0.2f, 1.f, 1.5f, 3.f, 6.f})
    for (const float k : {0.f, 0.01f, 1.f, 3.f, 9.f})
      for (const float c : cosines()) {
        const float r = fresnel_conductor(c, eta, k)[0];
        const double expected = optics::fresnel_reflectance_conductor(c, 1, {eta, k});
        // Without absorption and with eta < 1 there is a critical angle, where the slope is infinite.
        const double sin2_t = (1 - double(c) * c) / (double(eta) * eta);
        const double slack = k < 0.1f && eta < 1 && std::abs(1 - sin2_t) < 0.1 ? 5e-3 : 3e-6;
        EXPECT_NEAR(r, expected, slack) << "cos " << c << ", eta " << eta << ", k " << k;
        if (slack < 1e-3) largest = std::max(largest, std::abs(r - expected));
      }
  RecordProperty("largest_error", std::to_string(largest));
}

TEST(BsdfFresnel, PerfectMirror) {
  for (const float c : cosines()) EXPECT_EQ(fresnel_conductor(c, 0.f, 1.f)[0], 1.f) << c;
}

TEST(BsdfFresnel, ConductorStaysInRange) {
  for (const float eta : {0.f, 1e-6f, 1.f, 1e3f})
    for (const float k : {0.f, 1e-6f, 1.f, 1e3f})
      for (const float c : cosines()) {
        const float r = fresnel_conductor(c, eta, k)[0];
        EXPECT_TRUE(r >= 0 && r <= 1) << r << " at cos " << c << ", eta " << eta << ", k " << k;
      }
}

TEST(BsdfFresnel, ThinSlabIsTheSeries) {
  for (const float c : {1.f, 0.5f, 0.1f}) {
    const double r = optics::fresnel_reflectance(c, 1, 1.5), t = 1 - r;
    double sum = r, term = t * t * r;
    for (int i = 0; i < 200; ++i) sum += term, term *= r * r;
    EXPECT_NEAR(thin_slab(fresnel_dielectric(c, 1.5f).reflectance), sum, 1e-6);
    EXPECT_NEAR(optics::thin_slab_reflectance(c, 1, 1.5), sum, 1e-12);
  }
}

}  // namespace
}  // namespace aureole

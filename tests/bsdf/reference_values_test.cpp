// SPDX-License-Identifier: Apache-2.0
// The smooth BSDFs against values of Mitsuba 3.9.1 (scalar_spectral; wi at azimuth 0.2, wo at 2.5), and the
// texts of their errors.
#include <gtest/gtest.h>

#include <cmath>

#include "aureole/bsdf/bsdf.h"
#include "harness/properties_builder.h"

namespace aureole {
namespace {

using testing::build;

const SpectralGrid kGrid = SpectralGrid::over(360, 830);

Vec3 direction(double theta, double phi) {
  return {float(std::sin(theta) * std::cos(phi)), float(std::sin(theta) * std::sin(phi)),
          float(std::cos(theta))};
}

/// A context whose wavelengths are `nm`, with nm[0] as hero; it keeps what it refers to.
struct Setting {
  explicit Setting(std::vector<float> nm)
      : wavelengths(Wavelengths::at(kGrid, make_spectrum([&](int i) { return nm[i % nm.size()]; }))) {}
  BsdfContext context() const { return {wavelengths, point, TransportMode::radiance, 0}; }
  Wavelengths wavelengths;
  SurfacePoint point;
};

TEST(ReferenceValues, Plastic) {
  struct Row {
    bool nonlinear;
    double ior, theta_i, theta_o, value, specular;
  };
  constexpr Row kRows[] = {
      {false, 1.49, 0.3, 0.7, 0.1230399, 0.03886465},   {false, 1.49, 1.2, 0.5, 0.1248162, 0.1542375},
      {false, 1.49, 1.45, 1.4, 0.008836499, 0.5106782}, {false, 1.9, 0.3, 0.7, 0.1156308, 0.09649361},
      {false, 1.9, 1.2, 0.5, 0.1163655, 0.2122418},     {false, 1.9, 1.45, 1.4, 0.008354858, 0.5373765},
      {true, 1.49, 0.3, 0.7, 0.07146439, 0.03886465},   {true, 1.49, 1.45, 1.4, 0.005132442, 0.5106782},
      {true, 1.9, 0.3, 0.7, 0.04420105, 0.09649361},    {true, 1.9, 1.45, 1.4, 0.003193729, 0.5373765}};
  const Setting s({450, 500, 550, 600});
  for (const Row& r : kRows) {
    const auto bsdf =
        build<Bsdf>("<bsdf type=\"plastic\"><float name=\"int_ior\" value=\"" + std::to_string(r.ior) +
                    "\"/><float name=\"ext_ior\" value=\"1\"/><boolean name=\"nonlinear\" value=\"" +
                    (r.nonlinear ? "true" : "false") + "\"/></bsdf>");
    const Vec3 wi = direction(r.theta_i, 0.2), wo = direction(r.theta_o, 2.5);
    // Mitsuba approximates the internal diffuse reflectance to a part in a thousand.
    EXPECT_NEAR(bsdf->eval(wi, wo, s.context())[0] / r.value, 1, 2e-3) << r.ior << " " << r.theta_i;
    const auto specular = bsdf->sample(wi, 0, {0.5f, 0.5f}, s.context());
    ASSERT_TRUE(specular && specular->is_delta());
    EXPECT_NEAR(specular->value[0] / r.specular, 1, 1e-5);
  }
}

TEST(ReferenceValues, Conductors) {
  struct Row {
    const char* parameters;
    double theta;
    double value[4];
  };
  constexpr const char* kGold = R"(<string name="material" value="Au"/>)";
  constexpr const char* kCopper = R"(<string name="material" value="Cu"/>)";
  constexpr const char* kNumbers = R"(<spectrum name="eta" value="0.2"/><spectrum name="k" value="3.5"/>)";
  constexpr Row kRows[] = {{kGold, 0.3, {0.3858292, 0.5128391, 0.8474122, 0.9159552}},
                           {kGold, 1.2, {0.4573443, 0.5928345, 0.848886, 0.9113641}},
                           {kGold, 1.45, {0.6834805, 0.7911987, 0.9159058, 0.9478459}},
                           {kCopper, 0.3, {0.55252, 0.5943427, 0.6340876, 0.8526449}},
                           {kCopper, 1.45, {0.7540979, 0.7650227, 0.7938504, 0.9100852}},
                           {kNumbers, 0.3, {0.9415201, 0.9415201, 0.9415201, 0.9415201}},
                           {kNumbers, 1.2, {0.933367, 0.933367, 0.933367, 0.933367}}};
  const Setting s({450, 500, 550, 600});
  for (const Row& r : kRows) {
    const auto bsdf = build<Bsdf>(std::string("<bsdf type=\"conductor\">") + r.parameters + "</bsdf>");
    const auto sample = bsdf->sample(direction(r.theta, 0.2), 0.5f, {0.5f, 0.5f}, s.context());
    ASSERT_TRUE(sample);
    for (int i = 0; i < 4; ++i) EXPECT_NEAR(sample->value[i], r.value[i], 5e-4) << r.parameters << " " << i;
    EXPECT_EQ(sample->pdf[0], 1);
  }
}

/// Named materials without dispersion have Mitsuba's indices; radiance is scaled by (n_i/n_t)^2.
TEST(ReferenceValues, Dielectrics) {
  const auto glass =
      build<Bsdf>(R"(<bsdf type="dielectric"><boolean name="dispersion" value="false"/></bsdf>)");
  const Setting s({450, 500, 550, 600});
  constexpr double kTheta[] = {0.3, 1.2, 1.45}, kReflectance[] = {0.04067888, 0.1568778, 0.5126771};
  constexpr double kRefracted[][3] = {{-0.192549, -0.0390317, -0.980511},
                                      {-0.60728, -0.123102, -0.784893},
                                      {-0.646813, -0.131115, -0.751294}};
  for (int i = 0; i < 3; ++i) {
    const Vec3 wi = direction(kTheta[i], 0.2);
    const auto r = glass->sample(wi, 0, {}, s.context()), t = glass->sample(wi, 0.999f, {}, s.context());
    ASSERT_TRUE(r && t);
    EXPECT_NEAR(r->pdf[0], kReflectance[i], 1e-6);
    EXPECT_NEAR(r->value[3], kReflectance[i], 1e-6);
    EXPECT_NEAR(t->value[0] / t->pdf[0], 0.4419758, 1e-6);
    EXPECT_LT(length(t->wo - Vec3{float(kRefracted[i][0]), float(kRefracted[i][1]), float(kRefracted[i][2])}),
              2e-6f);
  }
  const auto up = glass->sample({std::sin(0.5f), 0, -std::cos(0.5f)}, 0.999f, {}, s.context());
  ASSERT_TRUE(up);
  EXPECT_NEAR(up->value[0] / up->pdf[0], 2.26257, 1e-5);
  EXPECT_NEAR(up->pdf[0], 0.9477718, 1e-6);
  EXPECT_LT(length(up->wo - Vec3{-0.721144f, 0, 0.692785f}), 2e-6f);

  const auto pane = build<Bsdf>(R"(<bsdf type="thindielectric"><float name="int_ior" value="1.5"/></bsdf>)");
  constexpr double kPane[] = {0.07708649, 0.2699396, 0.6772862};
  for (int i = 0; i < 3; ++i) {
    const Vec3 wi = direction(kTheta[i], 0.2);
    const auto r = pane->sample(wi, 0, {}, s.context()), t = pane->sample(wi, 0.999f, {}, s.context());
    ASSERT_TRUE(r && t);
    EXPECT_NEAR(r->value[0], kPane[i], 1e-6);
    EXPECT_NEAR(t->value[0], 1 - kPane[i], 1e-6);
    EXPECT_EQ(t->wo, -wi);
    EXPECT_TRUE(has(t->lobe, Lobe::null));
  }

  // A quarter wave of 2: ((4 - 1)/(4 + 1))^2. The hero has the wavelength of the context.
  const std::string quarter = std::to_string(double(s.context().wavelengths.nm[0]) / 8) + "nm";
  const auto film = build<Bsdf>(
      "<bsdf type=\"slab\"><float name=\"int_ior\" value=\"2\"/><float name=\"ext_ior\" "
      "value=\"1\"/><string name=\"thickness\" value=\"" +
      quarter + "\"/></bsdf>");
  for (const Vec3 wi : {Vec3{0, 0, 1}, Vec3{0, 0, -1}}) {
    const auto r = film->sample(wi, 0, {}, s.context()), t = film->sample(wi, 0.999f, {}, s.context());
    ASSERT_TRUE(r && t);
    EXPECT_NEAR(r->value[0], 0.36, 1e-5);
    EXPECT_NEAR(t->value[0], 0.64, 1e-5);
    EXPECT_NEAR(film->null_transmittance(wi, s.context())[0], 0.64, 1e-5);
  }
}

/// With dispersion each hero refracts by Snell's law with its own index; the others keep no part in that
/// direction.
TEST(Dispersion, FollowsTheHero) {
  const auto glass = build<Bsdf>(R"(<bsdf type="dielectric"><string name="int_ior" value="bk7"/></bsdf>)");
  // Schott's data sheet of N-BK7, relative to air: n_F' = 1.52283 (479.99 nm), n_d = 1.51680, n_C = 1.51432
  // (656.27 nm).
  constexpr double kAir = 1.000277;
  const struct {
    float nm;
    double n;
  } lines[] = {{479.99f, 1.52283}, {587.56f, 1.51680}, {656.27f, 1.51432}};
  for (const auto& line : lines) {
    const Setting s({line.nm, 500, 550, 610});
    const Vec3 wi = direction(1.0, 0);
    const auto t = glass->sample(wi, 0.999f, {}, s.context());
    ASSERT_TRUE(t && has(t->lobe, Lobe::transmit));
    EXPECT_NEAR(std::sin(1.0) / std::hypot(t->wo.x, t->wo.y), line.n / kAir, 2e-5) << line.nm;
    for (int j = 0; j < kWavelengths; ++j) {
      const bool same = s.wavelengths.nm[j] == line.nm;
      EXPECT_EQ(t->pdf[j] > 0, same) << j;
      EXPECT_EQ(t->value[j] > 0, same) << j;
    }
    const auto r = glass->sample(wi, 0, {}, s.context());
    ASSERT_TRUE(r && has(r->lobe, Lobe::reflect));
    EXPECT_GT(min_component(r->pdf), 0);
  }
}

std::string error_of(const std::string& xml) {
  try {
    build<Bsdf>(xml);
  } catch (const Error& e) {
    return e.what();
  }
  return "";
}

TEST(BsdfErrors, NameThePlaceAndTheRemedy) {
  const auto says = [](const std::string& xml, const std::string& text) {
    const std::string message = error_of(xml);
    EXPECT_NE(message.find(text), std::string::npos) << message;
    EXPECT_EQ(message.rfind("snippet:1:", 0), 0u) << message;
  };
  says(R"(<bsdf type="dielectric"><string name="int_ior" value="bk77"/></bsdf>)", "did you mean \"bk7\"");
  says(R"(<bsdf type="dielectric"><string name="int_ior" value="Au"/></bsdf>)", "absorbs");
  says(R"(<bsdf type="dielectric"><float name="int_ior" value="-1.5"/></bsdf>)", "> 0");
  says(R"(<bsdf type="dielectric"><boolean name="int_ior" value="true"/></bsdf>)",
       "expected a number or the name");
  says(R"(<bsdf type="conductor"><string name="material" value="bk7"/></bsdf>)", "not a known conductor");
  says(R"(<bsdf type="conductor"><string name="material" value="Au"/><float name="k" value="3"/></bsdf>)",
       "not both");
  says(R"(<bsdf type="twosided"/>)", "one or two nested BSDFs, got 0");
  says(R"(<bsdf type="twosided"><bsdf type="dielectric"/></bsdf>)", "transmits");
  says(R"(<bsdf type="diffuse"><float name="reflectance" value="1.1"/></bsdf>)", "[0, 1]");
  says(R"(<bsdf type="diffuse"><float name="reflectence" value="0.5"/></bsdf>)",
       "did you mean \"reflectance\"");
}

}  // namespace
}  // namespace aureole

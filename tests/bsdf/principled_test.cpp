// SPDX-License-Identifier: Apache-2.0
// The principled BSDFs: the harness over many parameter sets, values of Mitsuba 3.9.1, and the tint, which
// differs from Mitsuba's on purpose.
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "aureole/bsdf/microfacet/ggx.h"
#include "bsdf/bsdf_test_support.h"
#include "harness/bsdf_harness.h"

namespace aureole::testing {
namespace {

using Adapt = std::function<void(BsdfCase&)>;

/// "metallic=1 roughness=0.3" as elements of XML.
std::string parameters(const std::string& assignments) {
  std::istringstream words(assignments);
  std::string xml;
  for (std::string word; words >> word;) {
    const std::size_t at = word.find('=');
    xml += "<float name=\"" + word.substr(0, at) + "\" value=\"" + word.substr(at + 1) + "\"/>";
  }
  return xml;
}
BsdfCase make_case(const std::string& type, const std::string& name, const std::string& xml,
                   const Adapt& adapt) {
  BsdfCase c;
  c.name = type + "_" + name;
  c.xml = "<bsdf type=\"" + type + "\">" + xml + "</bsdf>";
  adapt(c);
  return c;
}

// Microfacets send samples below the surface.
void opaque(BsdfCase& c) { c.may_fail = c.black_below = true; }
Adapt gaining(const char* reason, double energy) {
  return [=](BsdfCase& c) {
    opaque(c);
    c.gains_energy = reason;
    c.largest_energy = energy;
  };
}
Adapt glass(double eta) {
  return [=](BsdfCase& c) {
    c.may_fail = true;
    c.n_below = [eta](float) { return float(eta); };
  };
}
constexpr const char* kAdded = "rough diffuse lobes do so at grazing, and other lobes are added to them";

BsdfCase solid(const char* name, const std::string& assignments, const Adapt& adapt = opaque) {
  return make_case("principled", name, parameters(assignments), adapt);
}
const BsdfCases kPrincipled(
    "principled", [](BsdfCase& c) { (c.name == "principled_example_2" ? glass(1.5) : Adapt(opaque))(c); },
    {solid("default", ""), solid("smooth", "roughness=0.1"),
     solid("white", "base_color=1 roughness=0.9", gaining(kAdded, 1.6)),
     solid("flat", "base_color=0.8 roughness=0.8 flatness=1", gaining(kAdded, 1.2)),
     solid("metal", "base_color=1 metallic=1 roughness=0.4"),
     solid("metal_brushed", "base_color=0.9 metallic=1 roughness=0.4 anisotropic=0.9 specular=1"),
     solid("metal_without_interface", "base_color=0.9 metallic=1 specular=0"),
     solid("thinner_inside", "base_color=0.7 metallic=0.3 eta=0.7 spec_tint=0.5 clearcoat=0.5",
           gaining(kAdded, 1.31)),
     solid("sheen", "base_color=0.5 sheen=1 sheen_tint=0.5"),
     solid("clearcoat", "base_color=0.3 roughness=0.5 clearcoat=1 clearcoat_gloss=0.5"),
     solid("no_diffuse_samples", "base_color=0.3 diffuse_reflectance_sampling_rate=0"),
     solid("no_specular_samples", "base_color=0.3 main_specular_sampling_rate=0 clearcoat=1"),
     solid("glass", "base_color=1 spec_trans=1 roughness=0.5 eta=1.5", glass(1.5)),
     solid("glass_brushed", "base_color=0.8 spec_trans=1 roughness=0.6 anisotropic=0.8 eta=1.3", glass(1.3)),
     solid("bubble", "base_color=0.9 spec_trans=1 roughness=0.6 eta=0.75", glass(0.75)),
     solid("half_glass",
           "base_color=0.5 spec_trans=0.5 metallic=0.3 roughness=0.5 eta=1.5 clearcoat=0.5 sheen=0.3",
           glass(1.5)),
     make_case("principled", "coloured_tints",
               R"(<rgb name="base_color" value="0.6, 0.3, 0.1"/><float name="spec_tint" value="1"/>
               <float name="sheen" value="0.3"/><float name="sheen_tint" value="1"/>)",
               gaining(kAdded, 1.1)),
     make_case(
         "principled", "infrared",
         R"(<spectrum name="base_color" value="900:0.2, 1700:0.6"/><float name="spec_tint" value="0.5"/>)",
         [](BsdfCase& c) {
           opaque(c);
           c.min_nm = 900, c.max_nm = 1700;
         }),
     make_case("principled", "textured", R"(
               <texture type="checkerboard" name="base_color">
                 <rgb name="color0" value="0.7, 0.2, 0.2"/><rgb name="color1" value="0.2, 0.5, 0.7"/></texture>
               <texture type="checkerboard" name="roughness">
                 <float name="color0" value="0.3"/><float name="color1" value="0.6"/></texture>
               <texture type="checkerboard" name="metallic">
                 <float name="color0" value="0.2"/><float name="color1" value="0.7"/></texture>
               <float name="spec_tint" value="0.5"/>)",
               opaque)});

constexpr const char* kRetro = "rough diffuse lobes reflect more than they receive at grazing";
constexpr const char* kOneSidedMask = "rough transmission is cut off by one of the two directions only";
void sheet(BsdfCase& c) { c.may_fail = true; }
void cut_sheet(BsdfCase& c) {
  sheet(c);
  c.not_reciprocal = kOneSidedMask;
}
BsdfCase thin(const char* name, const std::string& assignments, const Adapt& adapt) {
  return make_case("principledthin", name, parameters(assignments), adapt);
}
const BsdfCases kThin(
    "principledthin", [](BsdfCase& c) { (c.name == "principledthin_example_1" ? cut_sheet : sheet)(c); },
    {thin("default", "", sheet),
     thin("leaf", "base_color=0.9 diff_trans=1 roughness=0.8",
          [](BsdfCase& c) {
            sheet(c);
            c.gains_energy = kRetro;
            c.largest_energy = 1.02;
          }),
     thin("paper", "base_color=0.8 diff_trans=2", sheet),
     thin("cloth", "base_color=0.6 sheen=1 sheen_tint=0.5 flatness=1 diff_trans=0.5", sheet),
     thin("pane", "base_color=1 spec_trans=1 roughness=0.4", cut_sheet),
     thin("pane_brushed", "base_color=0.9 spec_trans=1 roughness=0.6 anisotropic=0.9 eta=1.3 spec_tint=0.5",
          cut_sheet),
     thin("everything", "base_color=0.7 spec_trans=0.5 diff_trans=0.7 roughness=0.5 eta=1.8 sheen=0.4",
          cut_sheet),
     thin("no_diffuse_samples", "spec_trans=0.5 diff_trans=0.5 diffuse_reflectance_sampling_rate=0",
          cut_sheet)});

// Values and densities of Mitsuba 3.9.1 (scalar_rgb; wi at azimuth 0.2, wo at that plus phi).
struct Row {
  double theta_i, theta_o, phi, value, pdf;
};
struct Reference {
  const char* assignments;
  std::vector<Row> rows;
};
const Reference kReflecting[] = {
    {"base_color=0.6",
     {{0.3, 0.6, 3, 0.1871926, 0.4964197},
      {1.2, 1.1, 2.8, 0.1230792, 0.260632},
      {0.5, 1.4, 1, 0.03547867, 0.03407409},
      {1.45, 0.4, 0.3, 0.2005603, 0.1757063}}},
    {"base_color=0.6 roughness=0.9 flatness=0.7 sheen=0.8 sheen_tint=0.6",
     {{0.3, 0.6, 3, 0.1294008, 0.1923678},
      {1.2, 1.1, 2.8, 0.1460095, 0.1609806},
      {0.5, 1.4, 1, 0.03903475, 0.06497498},
      {1.45, 0.4, 0.3, 0.217195, 0.2198065}}},
    {"base_color=0.6 roughness=0.3 metallic=0.8 anisotropic=0.7 specular=0.9",
     {{0.3, 0.6, 3, 1.179695, 1.983255},
      {1.2, 1.1, 2.8, 0.02358858, 0.03578222},
      {0.5, 1.4, 1, 0.006587968, 0.009538986},
      {1.45, 0.4, 0.3, 0.05067632, 0.07672314}}},
    {"base_color=0.6 roughness=0.4 spec_tint=0.5 specular=0.2 clearcoat=0.9 clearcoat_gloss=0.3 "
     "clearcoat_sampling_rate=2",
     {{0.3, 0.6, 3, 0.1879912, 0.5861536},
      {1.2, 1.1, 2.8, 0.1025082, 0.2009032},
      {0.5, 1.4, 1, 0.033445, 0.02789043},
      {1.45, 0.4, 0.3, 0.1854185, 0.135276}}},
    {"base_color=0.6 roughness=0.6 metallic=0.3 spec_tint=0.7 eta=0.8 clearcoat=0.4 "
     "main_specular_sampling_rate=0.5",
     {{0.3, 0.6, 3, 0.2062802, 0.3692481},
      {1.2, 1.1, 2.8, 0.450825, 0.2579486},
      {0.5, 1.4, 1, 0.02891818, 0.041012},
      {1.45, 0.4, 0.3, 0.1653816, 0.193689}}},
};

const Reference kTransmitting[] = {
    {"base_color=0.6 roughness=0.5 spec_trans=0.8 eta=1.5 diffuse_reflectance_sampling_rate=0.3",
     {{0.5, 0.6, 2.9, 0.07951125, 0.2693619},
      {0.5, 2.75, 3.1, 5.186883, 14.25148},
      {1.2, 2.5, 2.9, 0.4507789, 1.245956},
      {2.8, 2.5, 2.9, 0.02763904, 0.03484746},
      {2.7, 0.6, 3, 7.597575, 5.48869},
      {2, 1.1, 2.9, 0.1565229, 0.118667}}},
    {"base_color=0.6 roughness=0.4 spec_trans=1 anisotropic=0.6 specular=0.4",
     {{0.5, 0.6, 2.9, 0.05561528, 0.05597467},
      {0.5, 2.75, 3.1, 22.15842, 59.10246},
      {1.2, 2.5, 2.9, 0.09011137, 0.2416398},
      {2.8, 2.5, 2.9, 0.0484066, 0.04877905},
      {2.7, 0.6, 3, 4.630271, 2.918694},
      {2, 1.1, 2.9, 0.07306654, 0.04809752}}},
    {"base_color=0.6 roughness=0.6 spec_trans=0.5 metallic=0.4 eta=0.7 spec_tint=0.3 clearcoat=0.5 sheen=0.5",
     {{0.5, 0.6, 2.9, 0.2278959, 0.4665404},
      {0.5, 2.75, 3.1, 0.342524, 0.1528889},
      {1.2, 2.5, 2.9, 0, 0},
      {2.8, 2.5, 2.9, 0.004456331, 0.01511832},
      {2.7, 0.6, 3, 0.07031777, 0.6267772},
      {2, 1.1, 2.9, 0.07345392, 0.7176216}}},
};

const Reference kSheets[] = {
    {"base_color=0.6",
     {{0.5, 0.6, 2.9, 0.1576344, 0.2627125},
      {1.2, 1.1, 2.8, 0.08254559, 0.1443841},
      {0.5, 2.75, 3.1, 0, 0},
      {1.2, 2.1, 2.6, 0, 0},
      {2.8, 2.5, 2.9, 0.1530205, 0.2550119},
      {2.7, 0.6, 3, 0, 0}}},
    {"base_color=0.6 roughness=0.4 spec_trans=0.7 eta=1.3 spec_tint=0.4 anisotropic=0.5",
     {{0.5, 0.6, 2.9, 0.0695171, 0.7092259},
      {1.2, 1.1, 2.8, 0.02864325, 0.07198293},
      {0.5, 2.75, 3.1, 4.24982, 3.60493},
      {1.2, 2.1, 2.6, 0.0007509571, 0.0006629411},
      {2.8, 2.5, 2.9, 0.0603172, 0.4924699},
      {2.7, 0.6, 3, 1.145148, 0.9720274}}},
    {"base_color=0.6 roughness=0.6 spec_trans=0.3 diff_trans=0.8 sheen=0.6 sheen_tint=0.3 flatness=0.6 "
     "diffuse_transmittance_sampling_rate=2 specular_transmittance_sampling_rate=0.5 "
     "specular_reflectance_sampling_rate=3 diffuse_reflectance_sampling_rate=0.7",
     {{0.5, 0.6, 2.9, 0.06338431, 0.2600436},
      {1.2, 1.1, 2.8, 0.06396965, 0.1662069},
      {0.5, 2.75, 3.1, 0.6464064, 0.3076772},
      {1.2, 2.1, 2.6, 0.03760114, 0.06882989},
      {2.8, 2.5, 2.9, 0.05906105, 0.2079067},
      {2.7, 0.6, 3, 0.4407025, 0.2319809}}},
};

void compare(const char* type, const Reference& reference) {
  const Setting s;
  const auto bsdf = bsdf_of(type, parameters(reference.assignments));
  for (const Row& r : reference.rows) {
    const BsdfEval e =
        bsdf->eval_pdf(direction(r.theta_i, 0.2), direction(r.theta_o, 0.2 + r.phi), s.context());
    // Mitsuba's half vectors are single precision, too.
    EXPECT_NEAR(e.value[0], r.value, 1e-4 * r.value)
        << reference.assignments << ", " << r.theta_i << ", " << r.theta_o;
    EXPECT_NEAR(e.pdf[0], r.pdf, 1e-4 * r.pdf)
        << reference.assignments << ", " << r.theta_i << ", " << r.theta_o;
    EXPECT_EQ(min_component(e.value), max_component(e.value));
  }
}

TEST(Principled, HasMitsubasValues) {
  for (const Reference& r : kReflecting) compare("principled", r);
  for (const Reference& r : kTransmitting) compare("principled", r);
}
TEST(PrincipledThin, HasMitsubasValues) {
  for (const Reference& r : kSheets) compare("principledthin", r);
}

/// sheen alone: f = sheen ((1 - sheen_tint) + sheen_tint color/luminance) Fd, less the black diffuse lobe.
Spectrum sheen_color(const Bsdf& with, const Bsdf& without, const Setting& s) {
  const Vec3 wi = direction(1.3, 0), wo = direction(1.2, 2.9);
  return with.eval(wi, wo, s.context()) - without.eval(wi, wo, s.context());
}

/// Mitsuba's spectral mode takes for the luminance the mean of y-bar times colour at the wavelengths of a
/// sample and does not divide by their density: for a grey it is 2.5 to 2.8 times too small, and the tint so
/// much too bright. Its rgb mode takes that of the colour, as we do.
TEST(Principled, TintIsColourOverItsLuminance) {
  const Setting s;
  const std::string sheen = parameters("roughness=0.3 sheen=1");
  const std::string tinted = sheen + parameters("sheen_tint=1");
  const auto tint_of = [&](const std::string& color) {
    const auto plain = bsdf_of("principled", color + sheen), with = bsdf_of("principled", color + tinted);
    const auto none = bsdf_of("principled", color + parameters("roughness=0.3"));
    return safe_divide(sheen_color(*with, *none, s), sheen_color(*plain, *none, s));
  };
  const Spectrum grey = tint_of(R"(<rgb name="base_color" value="0.4, 0.4, 0.4"/>)");
  for (int j = 0; j < kWavelengths; ++j) EXPECT_NEAR(grey[j], 1, 2e-3);

  // The luminance of a colour is that of linear sRGB.
  const std::string rgb = R"(<rgb name="reflectance" value="0.6, 0.3, 0.1"/>)";
  const auto diffuse = bsdf_of("diffuse", rgb);
  const Spectrum color = diffuse->eval({0, 0, 1}, {0, 0, 1}, s.context()) * kPi,
                 tint = tint_of(R"(<rgb name="base_color" value="0.6, 0.3, 0.1"/>)");
  const double luminance = 0.212671 * 0.6 + 0.715160 * 0.3 + 0.072169 * 0.1;
  for (int j = 0; j < kWavelengths; ++j) EXPECT_NEAR(tint[j] * luminance / color[j], 1, 5e-3) << j;

  // A texture takes its luminance from a few wavelengths.
  const Spectrum texture = tint_of(R"(<texture type="checkerboard" name="base_color">
      <rgb name="color0" value="0.6, 0.3, 0.1"/><rgb name="color1" value="0.1, 0.1, 0.1"/></texture>)");
  for (int j = 0; j < kWavelengths; ++j) EXPECT_NEAR(texture[j] / tint[j], 1, 2e-3) << j;
}

TEST(Principled, TintNeedsNoVisibleLight) {
  const auto context = make_context(1000, 1600);
  const auto bsdf =
      build<Bsdf>(R"(<bsdf type="principled"><spectrum name="base_color" value="1000:0.2, 1600:0.8"/>
      <float name="spec_tint" value="1"/><float name="metallic" value="0"/></bsdf>)",
                  context);
  Setting s;
  s.wavelengths = Wavelengths::at(SpectralGrid::over(1000, 1600),
                                  make_spectrum([](int i) { return 1000 + 80 * float(i); }));
  const Vec3 n{0, 0, 1};
  // The specular part is the difference to the diffuse one, which is the colour over pi at normal incidence.
  const Spectrum f = bsdf->eval(n, n, s.context());
  for (int j = 0; j < kWavelengths; ++j) {
    const double color = 0.2 + 0.6 * (80.0 * j) / 600, d = 1 / (kPiDouble * std::pow(0.5, 4));
    EXPECT_NEAR(f[j], color / kPiDouble + color / 0.5 * 0.04 * d / 4, 2e-3 * f[j]);
  }
}

/// A texture in place of a number acts at each point as its number there would; Mitsuba 3.9.1 exchanges the
/// colours of a checkerboard where it is asked for numbers.
TEST(Principled, TexturesOfNumbers) {
  const auto textured = bsdf_of("principled", R"(<texture type="checkerboard" name="metallic">
      <float name="color0" value="0"/><float name="color1" value="0.8"/></texture>)");
  const auto first = bsdf_of("principled", parameters("metallic=0"));
  const auto second = bsdf_of("principled", parameters("metallic=0.8"));
  Setting s;
  const Vec3 wi = direction(0.5, 0), wo = direction(0.7, 3);
  s.point.uv = {0.1f, 0.1f};
  EXPECT_EQ(textured->eval(wi, wo, s.context())[0], first->eval(wi, wo, s.context())[0]);
  s.point.uv = {0.1f, 0.6f};
  EXPECT_EQ(textured->eval(wi, wo, s.context())[0], second->eval(wi, wo, s.context())[0]);
}

TEST(Ggx, IsNormalised) {
  for (const Ggx ggx : {Ggx{0.5f, 0.5f}, Ggx{0.2f, 0.8f}}) {
    const Vec3 w = direction(1.1, 0.7);
    double normals = 0, visible = 0;
    constexpr int kN = 800;
    for (int i = 0; i < kN; ++i)
      for (int j = 0; j < kN; ++j) {
        const double theta = (i + 0.5) / kN * kPiDouble / 2;
        const Vec3 m = direction(theta, (j + 0.5) / kN * 2 * kPiDouble);
        const double solid_angle = std::sin(theta) * kPiDouble / 2 / kN * 2 * kPiDouble / kN;
        normals += double(ggx.d(m) * m.z) * solid_angle;
        visible += double(ggx.visible_pdf(w, m)) * solid_angle;
      }
    EXPECT_NEAR(normals, 1, 1e-4);
    EXPECT_NEAR(visible, 1, 1e-4);
  }
}

TEST(Principled, ErrorsNameThePlace) {
  expect_error("principled", parameters("eta=1.5 specular=0.5"), "either eta or specular");
  expect_error("principled", parameters("roughness=1.5"), "from 0 to 1");
  expect_error("principled", parameters("eta=-1"), "> 0");
  expect_error("principled", parameters("main_specular_sampling_rate=-1"), ">= 0");
  expect_error("principled", R"(<rgb name="metallic" value="0.1, 0.5, 0.9"/>)",
               "one number for all wavelengths");
  expect_error("principledthin", parameters("diff_trans=2.5"), "from 0 to 2");
  expect_error("principledthin", parameters("eta=0"), "above 0");
  expect_error("principledthin", parameters("metallic=1"), "metallic");
}

}  // namespace
}  // namespace aureole::testing

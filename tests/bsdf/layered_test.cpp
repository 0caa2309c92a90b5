// SPDX-License-Identifier: Apache-2.0
// `layered`: the rules of the harness, and values against radiances of single beams (optics/stack), between the
// nodes of its table. tests/medium/layered_slab_test.cpp follows paths through the same layers.
#include <gtest/gtest.h>

#include <array>
#include <cstdio>

#include "aureole/bsdf/stack/layered_stack.h"
#include "bsdf/bsdf_test_support.h"
#include "harness/bsdf_harness.h"
#include "harness/effort.h"
#include "harness/properties_builder.h"

namespace aureole::testing {
namespace {

/// Grey, by optical thickness (the layer is 10 um thick).
std::string medium(double thickness, double albedo, double g) {
  return "<medium type=\"homogeneous\">" + number("sigma_t", thickness * 1e5) + number("albedo", albedo) +
         "<phase type=\"hg\">" + number("g", g) + "</phase></medium>";
}
std::string stack(const std::string& content, const std::string& thickness = "10um") {
  return "<bsdf type=\"layered\"><string name=\"thickness\" value=\"" + thickness + "\"/>" + content +
         "</bsdf>";
}
const std::string kWhite = "<bsdf type=\"diffuse\"><float name=\"reflectance\" value=\"1\"/></bsdf>";
const std::string kSmall =
    "<integer name=\"directions\" value=\"12\"/><integer name=\"azimuths\" value=\"8\"/>";

BsdfCase layered_case(std::string name, const std::string& xml, bool open, bool lossless) {
  BsdfCase c;
  c.name = std::move(name), c.xml = xml, c.black_below = !open, c.lossless = lossless;
  return c;
}

const BsdfCases kLayered(
    "layered",
    [](BsdfCase& c) {
      c.black_below = c.name == "layered_example_1";
      c.lossless = c.name == "layered_example_2";
      if (c.lossless) c.n_below = [](float) { return 1.33f; };
    },
    {layered_case("layered_white", stack(medium(1, 1, 0.3) + kWhite + kSmall), false, true),
     layered_case("layered_rough_white", stack(medium(1, 1, 0) + kWhite + kSmall + number("alpha", 0.4)),
                  false, true),
     layered_case("layered_rough_slab",
                  stack(medium(0.5, 1, 0) + kSmall + "<string name=\"alpha\" value=\"0.5, 0.5\"/>"), true,
                  true),
     layered_case("layered_varnished_gold",
                  stack(medium(0.3, 0.5, 0) + kSmall +
                        "<bsdf type=\"conductor\"><string name=\"material\" value=\"Au\"/></bsdf>"),
                  false, false),
     layered_case("layered_varnished_rough_gold",
                  stack(medium(0.3, 0.5, 0) + kSmall +
                        "<bsdf type=\"roughconductor\"><string name=\"material\" value=\"Au\"/>" +
                        number("alpha", 0.3) + "</bsdf>"),
                  false, false),
     layered_case("layered_clear_slide", stack(medium(0, 0, 0) + kSmall), true, true)});

optics::StackDescription description(double thickness, double albedo, double g, double index) {
  optics::StackDescription d;
  d.layers = {optics::StackLayer::of_optical_thickness(thickness, albedo,
                                                       optics::LegendrePhase::henyey_greenstein(g), index)};
  return d;
}

TEST(LayeredBsdf, IsTheRadianceOfEachBeam) {
  struct Layer {
    double thickness, albedo, g, index;
  };
  for (const Layer& l : {Layer{1, 0.9, 0, 1.5}, {0.3, 0.5, 0.7, 1}}) {
    optics::StackDescription d = description(l.thickness, l.albedo, l.g, l.index);
    const auto bsdf = build<Bsdf>(stack(medium(l.thickness, l.albedo, l.g) + number("int_ior", l.index)));
    const std::vector<optics::StackLight> lights{
        optics::StackLight::beam(0.15), optics::StackLight::beam(0.6), optics::StackLight::beam(0.97)};
    const std::vector<double> cosines{0.2, 0.45, 0.8, -0.2, -0.45, -0.8}, azimuths{0.1, 0.8, 2.5};
    const std::vector<double> expected = optics::PlaneStack(d, {32}).radiance(lights, cosines, azimuths);
    std::size_t i = 0;
    for (const optics::StackLight& light : lights)
      for (const double out : cosines)
        for (const double phi : azimuths) {
          const Vec3 wi = direction(std::acos(*light.cosine), kPiDouble), wo = direction(std::acos(out), phi);
          EXPECT_NEAR(brdf(*bsdf, wi, wo), expected[i], 0.04 * expected[i] + 5e-4)
              << l.index << " " << l.g << ": " << *light.cosine << " " << out << " " << phi;
          ++i;
        }
  }
}

TEST(LayeredBsdf, EnergyIsThatOfTheStackForAllDirections) {
  const auto bsdf = build<Bsdf>(stack(medium(1, 0.9, 0.5)));
  const Setting s(TransportMode::importance);
  for (const double mu : {0.05, 0.33, 0.71, 1.0}) {
    const optics::StackFluxes f =
        optics::PlaneStack(description(1, 0.9, 0.5, 1.5), {64}).fluxes(optics::StackLight::beam(mu));
    const Vec3 wi = direction(std::acos(mu), 0.3);
    // value/pdf is the whole energy, the same for each sample.
    for (const float u : {0.001f, 0.4f, 0.6f}) {
      const auto x = bsdf->sample(wi, u, {0.3f, 0.7f}, s.context());
      ASSERT_TRUE(x);
      EXPECT_NEAR(x->value[0] / x->pdf[0], f.reflectance + f.transmittance, 1e-3) << mu;
    }
  }
}

/// Of light from all directions, those between the nodes of the table and close to the horizon among them.
TEST(LayeredBsdf, EnergyIsExactAtTheHorizon) {
  struct Case {
    const char* name;
    double thickness, albedo, g, index;
    std::string more;
    bool open;
    double most;       ///< difference from the energy of the stack
    double alpha = 0;  ///< of its upper interface, where something is absorbed
  };
  const std::string one = "<string name=\"alpha\" value=\"0.3\"/>",
                    both = "<string name=\"alpha\" value=\"0.3, 0.3\"/>";
  const Case cases[] = {{"smooth slab", 1, 1, 0.3, 1.5, "", true, 2e-5},
                        {"rough slab", 1, 1, 0.3, 1.5, kSmall + both, true, 2e-5},
                        {"bare slab", 1, 1, 0.3, 1, "", true, 2e-5},
                        {"white", 1, 1, 0.3, 1.5, "", false, 2e-5},
                        {"rough white", 1, 1, 0.3, 1.5, kSmall + one, false, 2e-5},
                        {"absorbing slab", 1, 0.9, 0.5, 1.5, "", true, 4e-4},
                        {"absorbing bare slab", 1, 0.9, 0.5, 1, "", true, 3e-4},
                        {"absorbing, on white", 1, 0.9, 0.5, 1.5, "", false, 4e-4},
                        {"dark, on white", 1, 0.3, 0, 1.33, "", false, 1.2e-3},
                        {"rough, absorbing, on white", 1, 0.9, 0.5, 1.5, one, false, 8e-4, 0.3}};
  const Setting s(TransportMode::importance);
  for (const Case& c : cases) {
    const auto bsdf = build<Bsdf>(stack(medium(c.thickness, c.albedo, c.g) + number("int_ior", c.index) +
                                        number("ext_ior", 1) + c.more + (c.open ? "" : kWhite)));
    optics::StackDescription d = description(c.thickness, c.albedo, c.g, c.index);
    if (!c.open) d.substrate = 1;
    if (c.alpha > 0) d.layers.front().top = {optics::InterfaceKind::beckmann, c.alpha};
    const optics::PlaneStack truth(d, {48});
    double worst = 0, at = 0;
    std::vector<double> angles;
    for (double angle = 0; angle < 85; angle += test::effort(7.5, 1.0)) angles.push_back(angle);
    for (double angle = 85; angle < 89.95; angle += test::effort(0.35, 0.05)) angles.push_back(angle);
    std::vector<optics::StackLight> lights;
    for (const double angle : angles)
      lights.push_back(optics::StackLight::beam(std::cos(angle * kPiDouble / 180)));
    const std::vector<optics::StackFluxes> expected =
        c.albedo < 1 ? truth.fluxes(lights) : std::vector<optics::StackFluxes>(lights.size(), {1, 0});
    for (std::size_t i = 0; i < angles.size(); ++i) {
      // Value over density is the whole energy, the same for each sample.
      const auto x =
          bsdf->sample(direction(angles[i] * kPiDouble / 180, 0.3), 0.999f, {0.3f, 0.7f}, s.context());
      ASSERT_TRUE(x) << c.name << " " << angles[i];
      const double energy = x->value[0] / x->pdf[0],
                   difference =
                       std::abs(energy - expected[i].reflectance - (c.open ? expected[i].transmittance : 0));
      if (difference > worst) worst = difference, at = angles[i];
    }
    std::printf("%-26s energy off by %.1e at most, at %.1f degrees\n", c.name, worst, at);
    EXPECT_LT(worst, c.most) << c.name << " at " << at;
  }
}

TEST(LayeredBsdf, NodesAreFineEnough) {
  // Sums over the table's nodes miss little of the energy before it is made exact.
  for (const auto& [g, alpha, most] : {std::array{0.8, 0.0, 0.005}, {0.0, 0.3, 0.06}}) {
    const Properties p =
        read_properties(stack(medium(1, 0.9, g) + kWhite + (alpha > 0 ? number("alpha", alpha) : "")));
    const auto table = LayeredStack(p).tabulate();
    EXPECT_LT(table->correction(), most) << g << " " << alpha;
    std::printf("g %.1f, alpha %.1f: nodes miss %.2g of the energy, %.1f MB\n", g, alpha, table->correction(),
                double(table->bytes()) * 1e-6);
  }
}

/// A stack over a Lambertian substrate whose reflectance is written to the left and to the right of a checkerboard.
TEST(LayeredBsdf, ADiffuseSubstrateMayBeTextured) {
  const auto bsdf = build<Bsdf>(stack(
      medium(0.6, 0.9, 0.5) +
      "<bsdf type=\"diffuse\"><texture name=\"reflectance\" type=\"checkerboard\"><float name=\"color0\" "
      "value=\"0.3\"/><float name=\"color1\" value=\"0.95\"/></texture></bsdf>"));
  for (const auto& [u, reflectance] : {std::pair{0.2f, 0.3}, {0.7f, 0.95}}) {
    Setting s(TransportMode::importance);
    s.point.uv = {u, 0.2f};
    optics::StackDescription d = description(0.6, 0.9, 0.5, 1.5);
    d.substrate = reflectance;
    const optics::PlaneStack truth(d, {64});
    for (const double mu : {0.1, 0.5, 1.0}) {
      const optics::StackLight light = optics::StackLight::beam(mu);
      const Vec3 wi = direction(std::acos(mu), 0.3 + kPiDouble);
      for (const float choice : {0.1f, 0.6f, 0.95f}) {
        const auto x = bsdf->sample(wi, choice, {0.3f, 0.7f}, s.context());
        ASSERT_TRUE(x);
        EXPECT_NEAR(x->value[0] / x->pdf[0], truth.fluxes(light).reflectance, 2e-3) << mu << " " << u;
      }
      const std::vector<double> out{0.3, 0.8}, phi{1.2};
      const std::vector<double> expected = truth.radiance(std::span(&light, 1), out, phi);
      for (std::size_t o = 0; o < out.size(); ++o)
        EXPECT_NEAR(brdf(*bsdf, wi, direction(std::acos(out[o]), 0.3 + phi[0]), s) / expected[o], 1, 1e-2)
            << mu << " " << out[o];
    }
  }
}

TEST(LayeredBsdf, WhiteUnderACoatThatLetsNothingPassIsFinite) {
  const auto bsdf = build<Bsdf>(stack(
      medium(1e9, 1, 0) +
      "<bsdf type=\"diffuse\"><texture name=\"reflectance\" type=\"checkerboard\"><float name=\"color0\" "
      "value=\"0\"/><float name=\"color1\" value=\"1\"/></texture></bsdf>"));
  for (const float u : {0.2f, 0.7f}) {
    Setting s(TransportMode::importance);
    s.point.uv = {u, 0.2f};
    for (const double angle : {0.1, 0.8, 1.4}) {
      const double value = brdf(*bsdf, direction(angle, 0.3), direction(0.5, 2), s);
      EXPECT_TRUE(std::isfinite(value) && value > 0 && value < 1) << u << " " << angle << " " << value;
    }
  }
}

TEST(LayeredBsdf, LayersDisperse) {
  const std::string glass = "<string name=\"int_ior\" value=\"sf11\"/>";
  const auto bsdf = build<Bsdf>(stack(medium(1, 0.9, 0) + kSmall + kWhite + glass));
  const auto constant = build<Bsdf>(
      stack(medium(1, 0.9, 0) + kSmall + kWhite + glass + "<boolean name=\"dispersion\" value=\"false\"/>"));
  const SpectralGrid grid = SpectralGrid::over(360, 830);
  const SurfacePoint point;
  const auto mirrored = [&](const Bsdf& b, float nm) {
    const Wavelengths w = Wavelengths::at(grid, Spectrum(nm));
    const auto x = b.sample({0, 0, 1}, 0.f, {0.3f, 0.7f}, {w, point, TransportMode::importance});
    return x && x->is_delta() ? double(x->value[0]) : -1;
  };
  // The Schott catalogue: 1.82518 at 435.8 nm, 1.77599 at 656.3 nm, 1.78472 at 587.6 nm.
  const auto fresnel = [](double n) { return std::pow((n - 1) / (n + 1), 2); };
  EXPECT_NEAR(mirrored(*bsdf, 435.8f), fresnel(1.82518), 2e-4);
  EXPECT_NEAR(mirrored(*bsdf, 656.3f), fresnel(1.77599), 1e-4);
  EXPECT_NEAR(mirrored(*constant, 435.8f), fresnel(1.7847), 2e-4);
  // And energy: a white film on white under glass loses none.
  const auto white = build<Bsdf>(stack(medium(1, 1, 0) + kSmall + kWhite + glass));
  for (const float nm : {400.f, 433.f, 641.f}) {
    const Wavelengths w = Wavelengths::at(grid, Spectrum(nm));
    const auto x = white->sample({0.6f, 0, 0.8f}, 0.9f, {0.3f, 0.7f}, {w, point, TransportMode::importance});
    ASSERT_TRUE(x);
    EXPECT_NEAR(x->value[0] / x->pdf[0], 1, 1e-5) << nm;
  }
  // An index below that outside would move the critical angle: it counts at 589 nm.
  EXPECT_NEAR(
      mirrored(*build<Bsdf>(stack(medium(1, 0.9, 0) + kSmall + kWhite + number("ext_ior", 2) + glass)),
               435.8f),
      std::pow((2 - 1.7847) / (2 + 1.7847), 2), 1e-5);
}

TEST(LayeredBsdf, WrongParametersAreLocated) {
  const auto says = [](const std::string& content, const std::string& text,
                       const std::string& thickness = "10um") {
    try {
      build<Bsdf>(stack(content, thickness));
      ADD_FAILURE() << "no error: " << content;
    } catch (const Error& e) {
      EXPECT_NE(std::string(e.what()).find(text), std::string::npos) << e.what();
    }
  };
  const std::string m = medium(1, 0.9, 0);
  says("", "medium");
  says(m, "each of the 1", "10um, 5um");
  says(m, "unit", "10");
  says(m, "above 0", "0um");
  says(m + number("alpha", 0.01), "[0.05, 1]");
  says(m + "<string name=\"alpha\" value=\"0.1, 0.1, 0.1\"/>", "2 interfaces");
  says(m + "<string name=\"int_ior\" value=\"wter\"/>", "did you mean \"water\"?");
  says(m + number("int_ior", 0.5), "[1, 10]");
  says(m + kWhite + kWhite, "one nested BSDF");
  says(m + "<bsdf type=\"dielectric\"/>", "let light through");
  says(m + kWhite + number("below_ior", 1.3), "below_ior");
  says("<medium type=\"homogeneous\">" + number("emission", 1) + "</medium>", "emit");
  says(m +
           "<integer name=\"directions\" value=\"128\"/><integer name=\"azimuths\" value=\"128\"/>"
           "<integer name=\"wavelengths\" value=\"256\"/>" +
           kWhite + "<medium type=\"homogeneous\"><rgb name=\"albedo\" value=\"0.9, 0.5, 0.1\"/></medium>",
       "MB", "10um, 10um");
  // The side below has all channels of three indices: 180 MB of tables, and two times as many of solutions.
  says(number("below_ior", 1.3) +
           "<integer name=\"directions\" value=\"48\"/><integer name=\"azimuths\" value=\"40\"/>"
           "<integer name=\"wavelengths\" value=\"64\"/>"
           "<medium type=\"homogeneous\"><rgb name=\"albedo\" value=\"0.9, 0.5, 0.1\"/></medium>",
       "MB while they are made");
}

TEST(LayeredBsdf, NumbersKeepAllTheirDigits) {
  const auto below = [](const std::string& indices) {
    const Properties p = read_properties(stack(medium(1, 0.9, 0) + indices));
    return LayeredStack(p).index_below();
  };
  EXPECT_EQ(below("<float name=\"ext_ior\" value=\"1.2345678\"/>"), 1.2345678f);
  EXPECT_EQ(below(number("ext_ior", 1) + "<float name=\"below_ior\" value=\"1.00000036\"/>"), 1.00000036f);
}

TEST(LayeredBsdf, IsotropicRoughSubstratesPass) {
  const auto under = [](const std::string& bsdf) {
    Diagnostics diagnostics;
    std::string text;
    try {
      build<Bsdf>(stack(medium(0.3, 0.5, 0) + kSmall + bsdf), make_context(540, 560, &diagnostics));
    } catch (const Error& e) {
      text = e.what();
    }
    for (const std::string& note : diagnostics.notes()) text += note;
    return text;
  };
  for (
      const char* bsdf :
      {R"(<bsdf type="roughconductor"><float name="alpha" value="0.3"/></bsdf>)",
       R"(<bsdf type="roughplastic"><float name="alpha" value="0.3"/></bsdf>)",
       R"(<bsdf type="principled"/>)", R"(<bsdf type="phong"/>)", R"(<bsdf type="ward"/>)",
       R"(<bsdf type="cook_torrance"/>)", R"(<bsdf type="oren_nayar"/>)",
       R"(<bsdf type="blendbsdf"><float name="weight" value="0.5"/><bsdf type="diffuse"/><bsdf type="phong"/></bsdf>)"})
    EXPECT_EQ(under(bsdf), "") << bsdf;
  EXPECT_NE(under(R"(<bsdf type="roughconductor"><float name="alpha_u" value="0.1"/>
      <float name="alpha_v" value="0.3"/></bsdf>)")
                .find("must not change when it is turned"),
            std::string::npos);
  EXPECT_NE(under(R"(<bsdf type="phong"><texture type="checkerboard" name="diffuse_reflectance"/></bsdf>)")
                .find("is taken at one point"),
            std::string::npos);
}

TEST(LayeredBsdf, ARoughMetalUnderAClearCoatIsItsOwnLobeBelowTheInterface) {
  // A clear layer of index 1 adds nothing: the table has the metal's own values, apart from its interpolation.
  const std::string metal =
      R"(<bsdf type="roughconductor"><string name="distribution" value="ggx"/><float name="alpha" value="0.5"/></bsdf>)";
  const auto context = make_context(540, 560);
  const auto bare = build<Bsdf>(metal, context);
  const auto coated = build<Bsdf>(R"(<bsdf type="layered"><string name="thickness" value="10um"/>
      <float name="int_ior" value="1"/><float name="ext_ior" value="1"/>
      <medium type="homogeneous"><float name="sigma_t" value="0"/></medium>)" +
                                      metal + "</bsdf>",
                                  context);
  const Wavelengths w = Wavelengths::at(SpectralGrid::over(540, 560), Spectrum(550.f));
  SurfacePoint point;
  point.shading.n = point.ng = {0, 0, 1};
  const BsdfContext at{w, point};
  for (const double in : {0.9, 0.6}) {
    const Vec3 wi{float(std::sqrt(1 - in * in)), 0, float(in)};
    double own = 0, of_layered = 0;
    for (int i = 0; i < 40; ++i)
      for (int k = 0; k < 40; ++k) {
        const double mu = (i + 0.5) / 40, phi = 2 * M_PI * (k + 0.5) / 40, s = std::sqrt(1 - mu * mu);
        const Vec3 wo{float(s * std::cos(phi)), float(s * std::sin(phi)), float(mu)};
        own += double(bare->eval(wi, wo, at)[0]), of_layered += double(coated->eval(wi, wo, at)[0]);
      }
    EXPECT_NEAR(of_layered / own, 1, 0.02) << in;
  }
}

TEST(LayeredBsdf, ASmoothSubstrateMirrors) {
  const auto reflects = [](const std::string& substrate) {
    // Through a clear layer of the index of what is above.
    const auto bsdf = build<Bsdf>(
        stack(medium(0, 0, 0) + kSmall + number("int_ior", 1) + number("ext_ior", 1) + substrate));
    const Setting s(TransportMode::importance);
    const auto x = bsdf->sample({0, 0, 1}, 0.01f, {0.3f, 0.7f}, s.context());
    return x && x->is_delta() ? x->value[0] : 0;
  };
  EXPECT_NEAR(reflects("<bsdf type=\"conductor\"><string name=\"material\" value=\"none\"/></bsdf>"), 1,
              1e-4);
  EXPECT_NEAR(reflects("<bsdf type=\"plastic\"><float name=\"diffuse_reflectance\" value=\"0.5\"/>"
                       "<float name=\"int_ior\" value=\"1.5\"/></bsdf>"),
              0.04, 1e-4);
}

}  // namespace
}  // namespace aureole::testing

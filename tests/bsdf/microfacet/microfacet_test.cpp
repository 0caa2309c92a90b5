// SPDX-License-Identifier: Apache-2.0
// The rough BSDFs: harness cases, limits, dispersion, the white furnace, errors.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "aureole/spectrum/fresnel.h"
#include "aureole/spectrum/refractive_index.h"
#include "harness/bsdf_harness.h"
#include "harness/effort.h"
#include "harness/properties_builder.h"

namespace aureole::testing {
namespace {

Vec3 direction(double theta, double phi) {
  return {float(std::sin(theta) * std::cos(phi)), float(std::sin(theta) * std::sin(phi)),
          float(std::cos(theta))};
}

std::string text(double v) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%g", v);
  return buffer;
}

std::string rough(const std::string& type, const std::string& distribution, double alpha,
                  const std::string& more = "") {
  return "<bsdf type=\"" + type + "\"><string name=\"distribution\" value=\"" + distribution +
         "\"/><float name=\"alpha\" value=\"" + text(alpha) + "\"/>" + more + "</bsdf>";
}

constexpr const char* kPreserving = R"(<boolean name="energy_preserving" value="true"/>)";
constexpr const char* kAllNormals = R"(<boolean name="sample_visible" value="false"/>)";
constexpr const char* kWhiteBase = R"(<float name="diffuse_reflectance" value="1"/>)";
constexpr const char* kGlass = R"(<float name="int_ior" value="1.5"/><float name="ext_ior" value="1"/>)";
constexpr const char* kFlint = R"(<string name="int_ior" value="sf11"/><float name="ext_ior" value="1"/>)";

std::function<float(float)> sf11() {
  return [index = *find_refractive_index("sf11")](float nm) { return float(index.at(nm).real()); };
}

BsdfCase make_case(std::string name, std::string xml, const std::function<void(BsdfCase&)>& adapt) {
  BsdfCase c;
  c.name = std::move(name);
  c.xml = std::move(xml);
  adapt(c);
  return c;
}

void one_sided(BsdfCase& c) { c.black_below = c.may_fail = true; }
void white(BsdfCase& c) {
  one_sided(c);
  c.lossless = true;
  c.tolerance = 0.01;
}
void glass(BsdfCase& c) {
  c.may_fail = true;
  c.n_below = [](float) { return 1.5f; };
}
void white_glass(BsdfCase& c) {
  glass(c);
  c.lossless = true;
  c.tolerance = 0.01;
}
void flint(BsdfCase& c) {
  c.may_fail = true;
  c.n_below = sf11();
}
void white_flint(BsdfCase& c) {
  flint(c);
  c.lossless = true;
  c.tolerance = 0.01;
}

constexpr const char* kCu =
    R"(<string name="material" value="Cu"/><float name="alpha_u" value="0.08"/><float name="alpha_v" value="0.5"/>)";

const BsdfCases kConductors(
    "roughconductor", one_sided,
    {make_case("roughconductor_beckmann_05", rough("roughconductor", "beckmann", 0.05), one_sided),
     make_case("roughconductor_ggx_05", rough("roughconductor", "ggx", 0.05), one_sided),
     make_case("roughconductor_ggx_1", rough("roughconductor", "ggx", 1), one_sided),
     make_case("roughconductor_beckmann_3", rough("roughconductor", "beckmann", 3), one_sided),
     make_case("roughconductor_aniso_beckmann",
               std::string("<bsdf type=\"roughconductor\">") + kCu + "</bsdf>", one_sided),
     make_case("roughconductor_aniso_ggx_all",
               std::string("<bsdf type=\"roughconductor\"><string name=\"distribution\" value=\"ggx\"/>") +
                   kCu + kAllNormals + "</bsdf>",
               one_sided),
     make_case("roughconductor_beckmann_all", rough("roughconductor", "beckmann", 0.3, kAllNormals),
               one_sided),
     make_case("roughconductor_white_beckmann", rough("roughconductor", "beckmann", 0.7, kPreserving), white),
     make_case("roughconductor_white_ggx", rough("roughconductor", "ggx", 0.3, kPreserving), white),
     make_case(
         "roughconductor_white_aniso",
         std::string(
             R"(<bsdf type="roughconductor"><string name="distribution" value="ggx"/><float name="alpha_u" value="0.1"/>
                <float name="alpha_v" value="0.8"/>)") +
             kPreserving + "</bsdf>",
         white),
     make_case("roughconductor_white_textured", R"(<bsdf type="roughconductor">
               <texture type="checkerboard" name="alpha"><float name="color0" value="0.8"/>
               <float name="color1" value="0.1"/></texture><boolean name="energy_preserving" value="true"/></bsdf>)",
               white),
     make_case("roughconductor_white_textured_aniso", R"(<bsdf type="roughconductor">
               <texture type="checkerboard" name="alpha_u"><float name="color0" value="0.8"/>
               <float name="color1" value="0.1"/></texture><float name="alpha_v" value="0.3"/>
               <boolean name="energy_preserving" value="true"/></bsdf>)",
               white)});

const BsdfCases kDielectrics(
    "roughdielectric",
    [](BsdfCase& c) {
      c.may_fail = true;
      c.n_above = [](float) { return 1.000277f; };
      c.n_below = [index = *find_refractive_index(c.name == "roughdielectric_example_1" ? "water" : "bk7")](
                      float nm) { return float(index.at(nm).real()); };
    },
    {make_case("roughdielectric_beckmann_05", rough("roughdielectric", "beckmann", 0.05, kGlass), glass),
     make_case("roughdielectric_ggx_1", rough("roughdielectric", "ggx", 1, kGlass), glass),
     make_case("roughdielectric_beckmann_all",
               rough("roughdielectric", "beckmann", 0.3, std::string(kGlass) + kAllNormals), glass),
     make_case("roughdielectric_ggx_all",
               rough("roughdielectric", "ggx", 0.2, std::string(kGlass) + kAllNormals), glass),
     make_case("roughdielectric_aniso", R"(<bsdf type="roughdielectric"><float name="int_ior" value="1.5"/>
               <float name="ext_ior" value="1"/><float name="alpha_u" value="0.5"/><float name="alpha_v" value="0.1"/></bsdf>)",
               glass),
     make_case("roughdielectric_dispersive_beckmann", rough("roughdielectric", "beckmann", 0.1, kFlint),
               flint),
     make_case("roughdielectric_dispersive_ggx", rough("roughdielectric", "ggx", 0.05, kFlint), flint),
     make_case("roughdielectric_dispersive_all",
               rough("roughdielectric", "ggx", 0.3, std::string(kFlint) + kAllNormals), flint),
     make_case("roughdielectric_white_beckmann",
               rough("roughdielectric", "beckmann", 0.5, std::string(kGlass) + kPreserving), white_glass),
     make_case("roughdielectric_white_ggx",
               rough("roughdielectric", "ggx", 0.5, std::string(kGlass) + kPreserving), white_glass),
     make_case("roughdielectric_white_dispersive",
               rough("roughdielectric", "ggx", 0.4, std::string(kFlint) + kPreserving), white_flint),
     make_case("roughdielectric_white_aniso",
               R"(<bsdf type="roughdielectric"><float name="int_ior" value="1.5"/>
               <float name="ext_ior" value="1"/><float name="alpha_u" value="0.7"/><float name="alpha_v" value="0.1"/>
               <boolean name="energy_preserving" value="true"/></bsdf>)",
               white_glass)});

const BsdfCases kPlastics(
    "roughplastic", one_sided,
    {make_case("roughplastic_beckmann_05", rough("roughplastic", "beckmann", 0.05), one_sided),
     make_case("roughplastic_ggx_all",
               rough("roughplastic", "ggx", 0.3, std::string(kAllNormals) + kWhiteBase), one_sided),
     make_case("roughplastic_ggx_1", rough("roughplastic", "ggx", 1), one_sided),
     make_case("roughplastic_nonlinear",
               rough("roughplastic", "beckmann", 0.2,
                     R"(<rgb name="diffuse_reflectance" value="0.9, 0.2, 0.1"/>
               <boolean name="nonlinear" value="true"/>)"),
               one_sided),
     make_case("roughplastic_white_beckmann",
               rough("roughplastic", "beckmann", 0.3, std::string(kPreserving) + kWhiteBase), white),
     make_case("roughplastic_white_dispersive",
               rough("roughplastic", "ggx", 0.5, std::string(kFlint) + kPreserving + kWhiteBase), white)});

struct Setting {
  Wavelengths wavelengths = Wavelengths::at(SpectralGrid::over(360, 830),
                                            make_spectrum([](int i) { return 400 + 50.f * float(i % 8); }));
  SurfacePoint point;
  BsdfContext context(TransportMode mode = TransportMode::importance) const {
    return {wavelengths, point, mode, 0};
  }
};

/// Points that fill the unit cube evenly (Roberts' sequence of the generalised golden ratio).
struct Cube {
  float u1;
  Vec2 u2;
};
Cube cube(int i) {
  const auto turn = [&](double a) {
    const double x = 0.5 + a * (i + 1);
    return std::min(float(x - std::floor(x)), 0x1.fffffep-1f);
  };
  return {turn(0.8191725133961645), {turn(0.6710436067037893), turn(0.5497004779019703)}};
}

/// Light that leaves, above and below, by sampling.
struct Energy {
  double reflected = 0, transmitted = 0;
  double total() const { return reflected + transmitted; }
};
Energy energy(const Bsdf& bsdf, const Vec3& wi, int samples = 1 << 15) {
  const Setting s;
  Energy e;
  for (int i = 0; i < samples; ++i) {
    const Cube c = cube(i);
    if (const auto b = bsdf.sample(wi, c.u1, c.u2, s.context()))
      (b->wo.z * wi.z > 0 ? e.reflected : e.transmitted) += b->value[0] / b->pdf[0] / samples;
  }
  return e;
}

TEST(RoughLimits, SmoothSurfacesAreReached) {
  const Setting s;
  for (const char* distribution : {"beckmann", "ggx"})
    for (const double theta : {0.3, 1.0, 1.3}) {
      const Vec3 wi = direction(theta, 0.4), mirrored = reflect(wi);
      const auto metal =
          build<Bsdf>(rough("roughconductor", distribution, 1e-3, R"(<string name="material" value="Cu"/>)"));
      const auto smooth =
          build<Bsdf>(R"(<bsdf type="conductor"><string name="material" value="Cu"/></bsdf>)");
      const auto b = smooth->sample(wi, 0, {0.5f, 0.5f}, s.context());
      const auto near = metal->sample(wi, 0, {0.3f, 0.4f}, s.context());
      ASSERT_TRUE(near && b);
      EXPECT_LT(length(near->wo - mirrored), 0.01f);
      EXPECT_NEAR(energy(*metal, wi).total(), b->value[0], 2e-3);

      const auto ground = build<Bsdf>(rough("roughdielectric", distribution, 1e-3, kGlass));
      for (const bool below : {false, true}) {
        const Vec3 w{wi.x, wi.y, below ? -wi.z : wi.z};
        const float eta = below ? 1 / 1.5f : 1.5f;
        const DielectricFresnel f = fresnel_dielectric(wi.z, eta);
        const Energy e = energy(*ground, w);
        EXPECT_NEAR(e.reflected, f.reflectance, 2e-3) << theta << below;
        EXPECT_NEAR(e.transmitted, 1 - f.reflectance, 2e-3) << theta << below;
        if (f.reflectance == 1) continue;
        const auto t = ground->sample(w, 0.999f, {0.3f, 0.4f}, s.context());
        ASSERT_TRUE(t && has(t->lobe, Lobe::transmit));
        EXPECT_EQ(t->eta, eta);
        const Vec3 snell{-w.x / eta, -w.y / eta, below ? f.cos_t : -f.cos_t};
        EXPECT_LT(length(t->wo - snell), 0.02f);
      }

      const auto plastic = build<Bsdf>(rough("roughplastic", distribution, 1e-3)),
                 polished = build<Bsdf>(R"(<bsdf type="plastic"/>)");
      const Vec3 aside = direction(0.8, 2.0);
      EXPECT_NEAR(plastic->eval(wi, aside, s.context())[0] / polished->eval(wi, aside, s.context())[0], 1,
                  2e-3);
    }
}

TEST(RoughLimits, StayFinite) {
  const Setting s;
  for (const char* type : {"roughconductor", "roughdielectric", "roughplastic"})
    for (const char* distribution : {"beckmann", "ggx"})
      for (const double alpha : {1e-6, 1e-4, 30.0, 100.0})
        for (const char* more : {"", kPreserving}) {
          const auto bsdf = build<Bsdf>(rough(type, distribution, alpha, more));
          int found = 0;
          for (int i = 0; i < 2000; ++i) {
            const Vec3 wi = direction(1.57079 * (i % 100) / 99, i);
            const Cube c = cube(i);
            const auto b = bsdf->sample(wi, c.u1, c.u2, s.context());
            if (!b) continue;
            ++found;
            ASSERT_TRUE(is_valid_radiance(b->value) && is_valid_radiance(b->pdf) && b->pdf[0] > 0);
            if (!*more && type != std::string("roughplastic")) {
              EXPECT_LE(b->value[0] / b->pdf[0], 1.001f) << type << " " << alpha;
            }
          }
          EXPECT_GT(found, alpha < 1 ? 1900 : 20) << type << " " << distribution << " " << alpha;
        }
}

/// Each wavelength of a dispersive interface is the interface of its own index.
TEST(RoughDispersion, EveryWavelengthHasItsOwnNormal) {
  const Setting s;
  const auto index = sf11();
  for (const char* distribution : {"beckmann", "ggx"})
    for (const char* sampling : {"", kAllNormals}) {
      const auto flint =
          build<Bsdf>(rough("roughdielectric", distribution, 0.15, std::string(kFlint) + sampling));
      for (const int j : {0, 3, 7}) {
        const auto plain = build<Bsdf>(rough("roughdielectric", distribution, 0.15,
                                             "<float name=\"int_ior\" value=\"" +
                                                 std::to_string(index(s.wavelengths.nm[j])) +
                                                 "\"/><float name=\"ext_ior\" value=\"1\"/>" + sampling));
        int compared = 0;
        for (int i = 0; i < 400; ++i) {
          const Vec3 wi = direction(0.1 + 0.007 * i + (i % 2 ? 0.3 : 0), 0.3);
          const Cube c = cube(i);
          const auto b = flint->sample(wi, c.u1, c.u2, s.context());
          if (!b) continue;
          const BsdfEval all = flint->eval_pdf(wi, b->wo, s.context(TransportMode::radiance));
          const BsdfEval one = plain->eval_pdf(wi, b->wo, s.context(TransportMode::radiance));
          EXPECT_NEAR(all.value[j], one.value[j], 2e-4f * one.value[j] + 1e-7f);
          EXPECT_NEAR(all.pdf[j], one.pdf[j], 2e-4f * one.pdf[j] + 1e-7f);
          ++compared;
        }
        EXPECT_GT(compared, 300);
      }
    }
}

/// Energy that white surfaces return, smallest and largest over directions, scattered once and preserved.
TEST(WhiteFurnace, NothingIsGainedAndNothingLost) {
  struct Kind {
    const char *name, *type, *parameters;
    bool both_sides;
  };
  const std::string glass = kGlass, plastic = glass + kWhiteBase;
  const Kind kinds[] = {{"conductor", "roughconductor", "", false},
                        {"dielectric", "roughdielectric", glass.c_str(), true},
                        {"plastic", "roughplastic", plastic.c_str(), false}};
  std::printf("%-11s%-9s%6s   scattered once     energy_preserving\n", "", "", "alpha");
  for (const Kind& k : kinds)
    for (const char* distribution : {"beckmann", "ggx"})
      for (const double alpha : {0.05, 0.1, 0.2, 0.3, 0.5, 0.7, 1.0}) {
        if (!test::is_thorough() && (alpha == 0.1 || alpha == 0.3 || alpha == 0.7)) continue;
        double low[2] = {2, 2}, high[2] = {0, 0};
        for (const int preserving : {0, 1}) {
          const auto bsdf = build<Bsdf>(rough(k.type, distribution, alpha,
                                              std::string(k.parameters) + (preserving ? kPreserving : "")));
          for (const double degrees : {0.0, 20.0, 40.0, 55.0, 70.0, 80.0, 87.0})
            for (const bool below : {false, true}) {
              if (below && !k.both_sides) continue;
              Vec3 wi = direction(degrees * M_PI / 180, 1.0);
              if (below) wi.z = -wi.z;
              const double e = energy(*bsdf, wi).total();
              low[preserving] = std::min(low[preserving], e);
              high[preserving] = std::max(high[preserving], e);
            }
        }
        std::printf("%-11s%-9s%6g   %.4f .. %.4f   %.4f .. %.4f\n", k.name, distribution, alpha, low[0],
                    high[0], low[1], high[1]);
        EXPECT_LE(high[0], 1 + 1e-3) << k.name << " " << distribution << " " << alpha;
        EXPECT_LT(low[0], high[0]);
        EXPECT_NEAR(low[1], 1, 0.01) << k.name << " " << distribution << " " << alpha;
        EXPECT_NEAR(high[1], 1, 0.01) << k.name << " " << distribution << " " << alpha;
      }
}

TEST(RoughErrors, NameThePlaceAndTheRemedy) {
  const auto says = [](const std::string& xml, const std::string& expected) {
    std::string message;
    try {
      build<Bsdf>(xml);
    } catch (const Error& e) {
      message = e.what();
    }
    EXPECT_NE(message.find(expected), std::string::npos) << message;
    EXPECT_EQ(message.rfind("snippet:1:", 0), 0u) << message;
  };
  for (const std::string type : {"roughconductor", "roughdielectric", "roughplastic"}) {
    const std::string head = "<bsdf type=\"" + type + "\">";
    says(head + R"(<float name="alpha" value="0"/></bsdf>)", "(0, 100]");
    says(head + R"(<float name="alpha" value="-0.1"/></bsdf>)", "(0, 100]");
    says(head + R"(<float name="alpha" value="1000"/></bsdf>)", "(0, 100]");
    says(head + R"(<string name="distribution" value="gxx"/></bsdf>)", "did you mean \"ggx\"");
    says(head + R"(<rgb name="alpha" value="0.1, 0.3, 0.2"/></bsdf>)", "wavelength");
    says(head + R"(<spectrum name="alpha" value="0"/></bsdf>)", "> 0");
  }
  says(R"(<bsdf type="roughconductor"><float name="alpha_u" value="0.1"/></bsdf>)", "alpha_v is missing");
  says(
      R"(<bsdf type="roughconductor"><float name="alpha" value="0.1"/><float name="alpha_v" value="0.1"/></bsdf>)",
      "not both");
  says(R"(<bsdf type="roughplastic"><texture type="checkerboard" name="alpha"/></bsdf>)",
       "expected a number");
  says(
      R"(<bsdf type="roughdielectric"><float name="int_ior" value="1.3"/><float name="ext_ior" value="1.3"/></bsdf>)",
      "no interface");
  says(
      R"(<bsdf type="roughplastic"><float name="int_ior" value="1.3"/><float name="ext_ior" value="1.3"/></bsdf>)",
      "no coating");
}

}  // namespace
}  // namespace aureole::testing

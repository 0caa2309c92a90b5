// SPDX-License-Identifier: Apache-2.0
// The layer of correlated scatterers against its formulas written out anew in double precision, through
// optics:: only.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "bsdf/layer_cases.h"
#include "harness/effort.h"

namespace aureole {
namespace {

using namespace testing::layer_cases;
constexpr double kPi = std::numbers::pi;
using Mode = TransportMode;

/// f |cos theta_o| of the diffracted lobe by the formulas of the source with O = `obliquity`.
double expected_value(const LayerCase& s, const Vec3& wi, const Vec3& wo, double nm, Mode mode,
                      double obliquity = 1) {
  const bool reflected = wi.z * wo.z > 0;
  if (s.substrate == "none" && reflected) return 0;
  const double n_i = s.index(wi.z), n_o = s.index(wo.z), lambda = nm * 1e-9;
  const double x = n_o * wo.x + n_i * wi.x, y = n_o * wo.y + n_i * wi.y;
  const auto& layer = s.layer();
  const double j = layer.intensity(2 * kPi / lambda * std::hypot(x, y)) * layer.normalisation();
  const double root = std::sqrt(s.reflectance(n_i * std::hypot(wi.x, wi.y), n_i) *
                                s.reflectance(n_o * std::hypot(wo.x, wo.y), n_o));
  const double n_leaving = mode == Mode::radiance ? n_i : n_o;
  const double share = s.substrate == "none" ? 1 : reflected ? root : 1 - root;
  return n_leaving * n_leaving / (lambda * lambda) * j * share * std::abs(wo.z) * obliquity;
}

TEST(CorrelatedScatterers, ValueIsTheFormula) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform;
  for (const char* substrate : {"none", "thindielectric", "dielectric"}) {
    const LayerCase s{.substrate = substrate, .radius = "4um"};
    const auto bsdf = s.build();
    for (double degrees : {0., 20., 75., 105., 130., 150., 180.})
      for (Mode mode : {Mode::radiance, Mode::importance}) {
        const Context c(mode);
        const Vec3 wi = direction(degrees, 40);
        for (int i = 0; i < 100; ++i) {
          // Near the specular directions, where the rings are, on both sides of the layer.
          const double side = i % 2 ? 1 : -1, n_i = s.index(wi.z), n_o = s.index(side);
          const double r = 0.2 * uniform(random), f = 2 * kPi * uniform(random);
          const double x = (r * std::cos(f) - n_i * wi.x) / n_o, y = (r * std::sin(f) - n_i * wi.y) / n_o;
          if (x * x + y * y >= 0.999) continue;
          const Vec3 wo{float(x), float(y), float(side * std::sqrt(1 - x * x - y * y))};
          const Spectrum v = bsdf->eval(wi, wo, c.ctx);
          const double scale = expected_value(s, wi, wi * -1.f, 550, mode) + 1;
          for (int j = 0; j < kWavelengths; ++j) {
            const double e = expected_value(s, wi, wo, kLambdas[j], mode);
            EXPECT_NEAR(v[j], e, 1e-3 * e + 1e-5 * scale) << substrate << degrees << " r " << r;
          }
        }
      }
  }
}

TEST(CorrelatedScatterers, LargeScatterersKeepTheirRings) {
  // 100 um: rings are milliradians wide and the two directions nearly cancel in q.
  const LayerCase s{.radius = "100um", .correlation_radius = "100um"};
  const auto bsdf = s.build();
  const Context c;
  for (double degrees : {0., 45.})
    for (double u : {1., 2.548, 5.392, 20.}) {
      const Vec3 wi = direction(degrees);
      const double x = u / (2 * kPi / 550e-9 * 100e-6) - wi.x;
      const Vec3 wo{float(x), 0, float(-std::sqrt(1 - x * x))};
      for (int j = 0; j < kWavelengths; ++j) {
        const double e = expected_value(s, wi, wo, kLambdas[j], Mode::radiance);
        EXPECT_NEAR(bsdf->eval(wi, wo, c.ctx)[j], e, 2e-3 * e + 0.02) << u;
      }
    }
}

TEST(CorrelatedScatterers, ObliquityAtPoints) {
  for (const char* substrate : {"none", "dielectric", "thindielectric"}) {
    const LayerCase s{.substrate = substrate, .radius = "1um", .correlation_radius = "1um"};
    LayerCase f = s, k = s;
    f.extra = text("obliquity", "fraunhofer");
    k.extra = text("obliquity", "kirchhoff");
    const auto reciprocal = s.build(), fraunhofer = f.build(), kirchhoff = k.build();
    for (Mode mode : {Mode::radiance, Mode::importance})
      for (double ti : {10., 50., 120., 160.})
        for (double to : {15., 55., 125., 165.}) {
          const Vec3 wi = direction(ti), wo = direction(to, 170);
          const Context c(mode);
          // In Radiance mode the light comes along wo and leaves along wi.
          const Vec3 from = mode == Mode::radiance ? wo : wi, to_w = mode == Mode::radiance ? wi : wo;
          const double sine = s.index(from.z) / s.index(to_w.z) * std::hypot(from.x, from.y);
          const double cs = sine < 1 ? std::sqrt(1 - sine * sine) : 0, co = std::abs(to_w.z);
          const double of = cs / co, ok = cs > 0 ? (cs + co) * (cs + co) / (4 * cs * co) : 0;
          const double e = expected_value(s, wi, wo, kLambdas[0], mode);
          EXPECT_NEAR(reciprocal->eval(wi, wo, c.ctx)[0], e, 3e-3 * e + 1e-6);
          EXPECT_NEAR(fraunhofer->eval(wi, wo, c.ctx)[0], e * of, (3e-3 * e + 1e-6) * std::max(of, 1.));
          EXPECT_NEAR(kirchhoff->eval(wi, wo, c.ctx)[0], e * ok, (3e-3 * e + 1e-6) * std::max(ok, 1.));
        }
  }
}

/// Fr (1 - Fr) minus the power of evanescent waves, computed without the BSDF over |q| and the arc of real
/// directions.
double expected_energy(const LayerCase& s, const Vec3& wi, double nm) {
  const double phase = 2 * kPi / (nm * 1e-9) * s.a(), n_i = s.index(wi.z), n_t = s.index(-wi.z);
  const double p = n_i * std::hypot(wi.x, wi.y), root_i = std::sqrt(s.reflectance(p, n_i));
  const double u_max = phase * (std::max(n_i, n_t) + p);
  const auto& layer = s.layer();
  const int steps = std::max(4000, int(u_max * 40));
  double sum = 0;
  for (int i = 0; i < steps; ++i) {
    const double u = (i + 0.5) * u_max / steps, v = u / phase;
    const double j = layer.intensity(u / s.a()) * layer.normalisation() / (s.a() * s.a());
    double share = 0;
    if (s.substrate == "none") {
      // The arc of the circle of radius v around the specular point that lies in the unit disc.
      const double c = p > 0 ? (v * v + p * p - 1) / (2 * v * p) : (v < 1 ? -1 : 1);
      share = std::acos(std::clamp(c, -1., 1.)) / kPi;
    } else {
      const int azimuths = 400;
      for (int m = 0; m < azimuths; ++m) {
        const double p_o = std::sqrt(v * v + p * p - 2 * v * p * std::cos(kPi * (m + 0.5) / azimuths));
        if (p_o < n_i) share += root_i * std::sqrt(s.reflectance(p_o, n_i)) / azimuths;
        if (p_o < n_t) share += (1 - root_i * std::sqrt(s.reflectance(p_o, n_t))) / azimuths;
      }
    }
    sum += j * share * u * (u_max / steps) / (2 * kPi);
  }
  return sum;
}

TEST(CorrelatedScatterers, EnergyIsAllButTheEvanescentPart) {
  const Context c(Mode::importance);
  for (const char* substrate : {"none", "thindielectric", "dielectric"})
    for (const char* radius : {"0.8um", "5um"}) {
      const LayerCase s{.substrate = substrate, .radius = radius, .correlation_radius = radius};
      const auto bsdf = s.build();
      for (double degrees : {0., 45., 80., 125., 140., 175.}) {
        if (substrate != std::string("dielectric") && degrees > 90) continue;
        if (!test::is_thorough() && (degrees == 45 || degrees == 125)) continue;
        const Vec3 wi = direction(degrees, 25);
        const double fr = s.area_fraction;
        const Energies energies =
            integrate(s, wi, kLambdas[0], [&](const Vec3& wo) { return bsdf->eval(wi, wo, c.ctx); });
        for (int j : {0, kWavelengths - 1}) {
          const double energy = energies[std::size_t(j)];
          const double expected = expected_energy(s, wi, kLambdas[j]);
          EXPECT_NEAR(energy / expected, 1, 3e-3) << substrate << radius << degrees;
          EXPECT_LT(expected, fr * (1 - fr));
          std::printf("%-14s %-6s %5.0f deg %.0f nm: diffracted %.5f of %.5f, lost %.2f %%\n", substrate,
                      radius, degrees, kLambdas[j], energy, fr * (1 - fr),
                      100 * (1 - energy / (fr * (1 - fr))));
        }
      }
    }
}

TEST(CorrelatedScatterers, RenormalizedEnergyIsComplete) {
  const Context c(Mode::importance);
  for (const char* substrate : {"none", "thindielectric", "dielectric"})
    for (const char* radius : {"0.8um", "5um"}) {
      const LayerCase s{.substrate = substrate,
                        .radius = radius,
                        .correlation_radius = radius,
                        .extra = R"(<boolean name="renormalize" value="true"/>)"};
      const auto bsdf = s.build();
      for (double degrees : {0., 45., 80., 88., 125., 140., 175.}) {
        if (substrate != std::string("dielectric") && degrees > 90) continue;
        const Vec3 wi = direction(degrees, 25);
        const Energies energies =
            integrate(s, wi, kLambdas[0], [&](const Vec3& wo) { return bsdf->eval(wi, wo, c.ctx); });
        for (int j : {0, kWavelengths / 2 + 1})
          EXPECT_NEAR(energies[std::size_t(j)] / 0.25, 1, 4e-3)
              << substrate << radius << degrees << " " << kLambdas[j];
      }
    }
}

TEST(CorrelatedScatterers, RenormalizedEnergyOfSmallScatterersIsComplete) {
  // Where k a is small, h oscillates with the wavelength and with the angle.
  double worst = 0;
  for (const char* radius : {"0.2um", "0.5um"}) {
    const LayerCase s{.radius = radius,
                      .correlation_radius = radius,
                      .area_fraction = 0.3,
                      .extra = R"(<boolean name="renormalize" value="true"/>)"};
    const auto bsdf = s.build();
    for (const float nm : {380.f, 437.f, 561.f, 689.f, 803.f}) {
      const Context c(Mode::importance, Spectrum(nm));
      for (const double degrees : {0., 33., 61., 85.}) {
        const Vec3 wi = direction(degrees, 25);
        const Energies energies =
            integrate(s, wi, nm, [&](const Vec3& wo) { return bsdf->eval(wi, wo, c.ctx); });
        worst = std::max(worst, std::abs(energies[0] / 0.21 - 1));
      }
    }
  }
  std::printf("largest error of the energy: %.1e\n", worst);
  EXPECT_LT(worst, 1.5e-3);
}

TEST(CorrelatedScatterers, Reciprocity) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> uniform;
  for (const char* substrate : {"none", "thindielectric", "dielectric"})
    for (const char* extra : {"", R"(<boolean name="renormalize" value="true"/>)"}) {
      const LayerCase s{.substrate = substrate, .radius = "1um", .correlation_radius = "1um", .extra = extra};
      const auto bsdf = s.build();
      const Context radiance(Mode::radiance), importance(Mode::importance);
      int beyond_critical = 0;
      for (int i = 0; i < 2000; ++i) {
        // Uniform over the sphere: in the dielectric most directions are beyond the critical angle.
        const auto draw = [&] {
          const float z = 2 * uniform(random) - 1, f = 2 * float(kPi) * uniform(random),
                      r = std::sqrt(1 - z * z);
          return Vec3{r * std::cos(f), r * std::sin(f), z};
        };
        const Vec3 wi = draw(), wo = draw();
        const double ni = s.index(wi.z), no = s.index(wo.z);
        if (ni * std::hypot(wi.x, wi.y) > 1) ++beyond_critical;
        const Spectrum f = bsdf->eval(wi, wo, radiance.ctx), g = bsdf->eval(wo, wi, radiance.ctx);
        const Spectrum h = bsdf->eval(wi, wo, importance.ctx);
        for (int j = 0; j < kWavelengths; ++j) {
          const double a = f[j] / std::abs(wo.z) / (ni * ni), b = g[j] / std::abs(wi.z) / (no * no);
          EXPECT_NEAR(a, b, 2e-3 * (a + b) + 2e-6);
          // Either mode finds equal light from wi to wo.
          const double d = h[j] / std::abs(wo.z), e = g[j] / std::abs(wi.z);
          EXPECT_NEAR(d, e, 2e-3 * (d + e) + 2e-6);
        }
      }
      EXPECT_TRUE(substrate != std::string("dielectric") || beyond_critical > 300);
    }
}

TEST(CorrelatedScatterers, DeltaLobesCarryTheirWeights) {
  const double fr = 0.3 * 16 / 25;
  for (const char* scatterer : {"apertures", "discs"})
    for (const char* substrate : {"none", "thindielectric", "dielectric"})
      for (double degrees : {0., 60., 130., 160.}) {
        const LayerCase s{
            .scatterer = scatterer, .substrate = substrate, .radius = "4um", .area_fraction = 0.3};
        const auto bsdf = s.build();
        const bool discs = scatterer == std::string("discs"), none = substrate == std::string("none");
        const double weight = discs ? (1 - fr) * (1 - fr) : fr * fr + (none ? 0 : 1 - fr);
        const Vec3 wi = direction(degrees);
        const double n_i = s.index(wi.z), n_t = s.index(-wi.z), p = n_i * std::hypot(wi.x, wi.y);
        const double r = s.reflectance(p, n_i);
        const Context c;
        double mass = 0, reflected = 0, transmitted = 0;
        const int samples = 20000;
        for (int i = 0; i < samples; ++i) {
          const auto x = bsdf->sample(wi, float((i + 0.5) / samples), {0.4f, 0.7f}, c.ctx);
          if (!x || !x->is_delta()) continue;
          mass += 1.0 / samples;
          const double estimate = x->value[0] / x->pdf[0] / samples;
          if (has(x->lobe, Lobe::reflect)) {
            EXPECT_EQ(x->wo, reflect(wi));
            EXPECT_NEAR(x->value[1], weight * r, 1e-5);
            reflected += estimate;
          } else {
            EXPECT_NEAR(x->wo.x * n_t, -wi.x * n_i, 1e-6);
            EXPECT_NEAR(length(x->wo), 1, 1e-6);
            EXPECT_EQ(x->wo.z > 0, wi.z < 0);
            EXPECT_NEAR(x->value[1], weight * (1 - r) * n_i * n_i / (n_t * n_t), 1e-5);
            transmitted += estimate;
          }
        }
        const double all = weight + fr * (1 - fr);
        EXPECT_NEAR(mass, weight / all, 2e-4) << scatterer << substrate;
        EXPECT_NEAR(reflected, weight * r, 2e-4);
        EXPECT_NEAR(transmitted, weight * (1 - r) * n_i * n_i / (n_t * n_t), 3e-4) << substrate << degrees;
      }
}

TEST(CorrelatedScatterers, BlockedLightGoesToTheNestedBsdf) {
  const double fr = 0.4;
  const LayerCase s{.scatterer = "discs",
                    .area_fraction = fr,
                    .extra = R"(<bsdf type="diffuse"><float name="reflectance" value="0.6"/></bsdf>)"};
  const auto bsdf = s.build();
  const Context c;
  const Vec3 wi = direction(30), wo = direction(50, 100);
  const BsdfEval e = bsdf->eval_pdf(wi, wo, c.ctx);
  EXPECT_NEAR(e.value[0], fr * 0.6 / kPi * wo.z, 1e-6);
  EXPECT_NEAR(e.pdf[0], fr / kPi * wo.z, 1e-6);  // (1 - fr)^2 + fr (1 - fr) + fr is one
  const auto x = bsdf->sample(wi, 0.999f, {0.3f, 0.6f}, c.ctx);
  ASSERT_TRUE(x);
  EXPECT_GT(x->wo.z, 0);
  EXPECT_NEAR(x->value[2] / x->pdf[2], 0.6, 1e-5);
}

TEST(CorrelatedScatterers, Babinet) {
  // Discs and apertures of the same size and places diffract alike; only the light that keeps its direction
  // differs.
  for (const char* substrate : {"none", "dielectric"}) {
    const LayerCase a{.substrate = substrate, .area_fraction = 0.4};
    LayerCase d = a;
    d.scatterer = "discs";
    const auto apertures = a.build(), discs = d.build();
    const Context c;
    for (double to = 0.5; to < 180; to += 7.3) {
      const Vec3 wi = direction(35), wo = direction(to, 185);
      const Spectrum x = apertures->eval(wi, wo, c.ctx), y = discs->eval(wi, wo, c.ctx);
      for (int j = 0; j < kWavelengths; ++j) EXPECT_EQ(x[j], y[j]);
    }
  }
}

TEST(CorrelatedScatterers, WavelengthsAreExchangeable) {
  Spectrum rotated;
  for (int j = 0; j < kWavelengths; ++j) rotated[j] = kLambdas[(j + 3) % kWavelengths];
  for (const char* substrate : {"thindielectric", "dielectric"}) {
    const auto bsdf = testing::build<Bsdf>(
        std::string(R"(<bsdf type="correlated_scatterers"><string name="radius" value="3um"/>
        <float name="area_fraction" value="0.5"/><string name="substrate" value=")") +
        substrate + R"("/><string name="int_ior" value="bk7"/></bsdf>)");
    const Context a, b(Mode::radiance, rotated);
    for (double to : {5., 40., 100., 150., 165.}) {
      const BsdfEval x = bsdf->eval_pdf(direction(20), direction(to, 180), a.ctx);
      const BsdfEval y = bsdf->eval_pdf(direction(20), direction(to, 180), b.ctx);
      for (int j = 0; j < kWavelengths; ++j) {
        EXPECT_NEAR(x.value[(j + 3) % kWavelengths], y.value[j], 1e-5 * y.value[j]);
        EXPECT_NEAR(x.pdf[(j + 3) % kWavelengths], y.pdf[j], 1e-5 * y.pdf[j]);
      }
    }
    // A refracted direction belongs to the hero alone; through a pane all wavelengths go the same way.
    const auto s = bsdf->sample(direction(30), 0.5f, {0.5f, 0.5f}, a.ctx);
    ASSERT_TRUE(s && s->is_delta());
    EXPECT_GT(s->value[0], 0);
    if (substrate == std::string("dielectric")) {
      EXPECT_EQ(s->value[1], 0);
      EXPECT_EQ(s->pdf[1], 0);
    } else {
      EXPECT_GT(s->value[1], 0);
    }
  }
}

TEST(CorrelatedScatterers, GrazingIsFinite) {
  for (const char* substrate : {"none", "thindielectric", "dielectric"})
    for (const std::string& extra :
         {text("obliquity", "reciprocal"), text("obliquity", "fraunhofer"), text("obliquity", "kirchhoff"),
          std::string(R"(<boolean name="renormalize" value="true"/>)")}) {
      const LayerCase s{.substrate = substrate, .extra = extra};
      const auto bsdf = s.build();
      for (Mode mode : {Mode::radiance, Mode::importance}) {
        const Context c(mode);
        const std::vector<Vec3> directions = {{1, 0, 1e-7f},   {-1, 0, 1e-7f},   {-1, 0, -1e-7f},
                                              {0, 1, -1e-20f}, {0, 0, 1},        {0, 0, -1},
                                              {1, 0, 0},       direction(89.99), direction(90.01, 180)};
        for (const Vec3& wi : directions)
          for (const Vec3& wo : directions) {
            const BsdfEval e = bsdf->eval_pdf(wi, wo, c.ctx);
            EXPECT_TRUE(is_valid_radiance(e.value)) << substrate << extra;
            EXPECT_TRUE(is_valid_radiance(e.pdf));
            EXPECT_TRUE((wi.z != 0 && wo.z != 0) || is_black(e.value));
            for (float u : {0.f, 0.3f, 0.9f, 0x1.fffffep-1f}) {
              const auto x = bsdf->sample(wi, u, {u, 0.1f}, c.ctx);
              if (!x) continue;
              EXPECT_GT(x->pdf[0], 0);
              EXPECT_TRUE(is_valid_radiance(x->value) && is_valid_radiance(x->pdf) && is_finite(x->wo));
            }
          }
      }
    }
}

TEST(CorrelatedScatterers, RotationTurnsThePattern) {
  const std::string slits =
      R"(<aperture type="rectangle"><string name="width" value="6um"/><string name="height" value="2um"/></aperture>
      <float name="area_fraction" value="0.5"/>)";
  const auto build = [&](const std::string& more) {
    return testing::build<Bsdf>("<bsdf type=\"correlated_scatterers\">" + slits + more + "</bsdf>");
  };
  const auto plain = build(""), turned = build(R"(<float name="rotation" value="30"/>)");
  EXPECT_TRUE(plain->needs_tangent());  // the shapes follow uv
  EXPECT_FALSE(LayerCase{}.build()->needs_tangent());
  const Context c;
  const auto turn = [](const Vec3& w, double degrees) {
    const float s = float(std::sin(degrees * kPi / 180)), co = float(std::cos(degrees * kPi / 180));
    return Vec3{w.x * co - w.y * s, w.x * s + w.y * co, w.z};
  };
  const Vec3 wi = direction(25, 10);
  bool differs = false;
  for (double f = 0; f < 360; f += 13) {
    const Vec3 wo = direction(150, 190 + f / 60);
    const Spectrum a = plain->eval(wi, wo, c.ctx), b = turned->eval(turn(wi, 30), turn(wo, 30), c.ctx);
    const Spectrum same = turned->eval(wi, wo, c.ctx);
    for (int j = 0; j < kWavelengths; ++j) {
      EXPECT_NEAR(a[j], b[j], 1e-3 * a[j] + 1e-4);
      differs |= std::abs(a[j] - same[j]) > 0.1 * a[j] + 0.01;
    }
  }
  EXPECT_TRUE(differs);
}

TEST(CorrelatedScatterers, RadiusScaleIsTheRadius) {
  LayerCase scaled{
      .radius = "2um", .correlation_radius = "2um", .extra = R"(<float name="radius_scale" value="2.5"/>)"};
  const auto a = scaled.build(), b = LayerCase{}.build();
  const Context c;
  for (double to = 150; to < 180; to += 1.7) {
    const Spectrum x = a->eval(direction(5), direction(to, 170), c.ctx),
                   y = b->eval(direction(5), direction(to, 170), c.ctx);
    for (int j = 0; j < kWavelengths; ++j) EXPECT_NEAR(x[j], y[j], 1e-3 * y[j] + 1e-4);
  }
}

TEST(CorrelatedScatterers, TheGroundBetweenAperturesHasItsBsdf) {
  const double fr = 0.4;
  const LayerCase s{.area_fraction = fr,
                    .extra = R"(<bsdf type="diffuse"><float name="reflectance" value="0.6"/></bsdf>)"};
  const Context c;
  const BsdfEval e = s.build()->eval_pdf(direction(30), direction(50, 100), c.ctx);
  EXPECT_NEAR(e.value[0], (1 - fr) * 0.6 / kPi * direction(50).z, 1e-6);
  EXPECT_NEAR(e.pdf[0], (1 - fr) / kPi * direction(50).z, 1e-6);  // fr^2 + fr (1 - fr) + 1 - fr is one
  // The whole light: straight on, diffracted, and reflected by the ground.
  EXPECT_EQ(s.build()->eval(direction(30), direction(50, 100), c.ctx)[0], e.value[0]);
}

TEST(CorrelatedScatterers, LimitsOfFractionsAreAllowed) {
  const auto build = [](const std::string& fraction, const std::string& correlation) {
    return testing::build<Bsdf>(R"(<bsdf type="correlated_scatterers"><string name="radius" value="2um"/>)" +
                                fraction + correlation + "</bsdf>");
  };
  const auto number = [](const char* x) {
    return std::string("<float name=\"area_fraction\" value=\"") + x + "\"/>";
  };
  const Context c;
  const std::shared_ptr<Bsdf> layers[] = {
      build(number("0.7"), ""), build(number("0.9069"), R"(<correlation type="lattice"/>)"),
      build(number("0.7854"),
            R"(<correlation type="lattice"><string name="lattice" value="square"/></correlation>)"),
      build(
          number("0.68"),
          R"(<correlation type="simulated"><integer name="discs" value="100"/><integer name="snapshots" value="64"/></correlation>)"),
      // A texture that hardly varies.
      build(
          R"(<texture type="checkerboard" name="area_fraction"><float name="color0" value="0.5"/><float name="color1" value="0.5000001"/></texture>)",
          ""),
      // Finer than the wavelength: nothing is diffracted at all.
      testing::build<Bsdf>(
          R"(<bsdf type="correlated_scatterers"><string name="radius" value="0.1um"/><float name="area_fraction" value="0.5"/>
          <correlation type="lattice"><float name="jitter" value="0"/></correlation></bsdf>)")};
  for (const auto& layer : layers)
    for (double to = 91; to < 180; to += 4.3) {
      const BsdfEval e = layer->eval_pdf(direction(20), direction(to, 200), c.ctx);
      for (int j = 0; j < kWavelengths; ++j)
        EXPECT_TRUE(std::isfinite(e.value[j]) && std::isfinite(e.pdf[j]) && e.value[j] >= 0 && e.pdf[j] >= 0);
    }
}

TEST(CorrelatedScatterers, WrongInputIsNamed) {
  const auto fails_with = [](const std::string& body, const std::string& part) {
    try {
      testing::build<Bsdf>("<bsdf type=\"correlated_scatterers\">" + body + "</bsdf>");
      ADD_FAILURE() << body;
    } catch (const Error& e) {
      EXPECT_NE(std::string(e.what()).find(part), std::string::npos) << e.what();
    }
  };
  const std::string radius = text("radius", "5um"), fraction = R"(<float name="area_fraction" value="0.5"/>)";
  fails_with(fraction, "radius");
  fails_with(radius, "area_fraction");
  fails_with(radius + R"(<float name="area_fraction" value="0.71"/>)", "0.7");
  fails_with(R"(<float name="radius" value="5"/>)" + fraction, "unit");
  fails_with(radius + fraction + text("correlation_radius", "4um"), "correlation_radius");
  fails_with(radius + fraction + text("substrate", "glass"), "glass");
  fails_with(radius + fraction + text("int_ior", "water"), "int_ior");
  fails_with(
      radius + fraction + text("obliquity", "kirchhoff") + R"(<boolean name="renormalize" value="true"/>)",
      "renormalize");
  fails_with(radius + fraction + text("substrate", "dielectric") + R"(<bsdf type="diffuse"/>)",
             "between apertures");
  fails_with(
      fraction +
          R"(<aperture type="circle"><string name="radius" value="5um"/><float name="fraction" value="0.6"/></aperture>)",
      "sum to 0.6");
  fails_with(fraction + radius + R"(<aperture type="circle"><string name="radius" value="5um"/></aperture>)",
             "circles only");
  fails_with(radius + R"(<float name="area_fraction" value="0.91"/><correlation type="lattice"/>)",
             "0.90689968");
  fails_with(
      radius +
          R"(<float name="area_fraction" value="0.8"/><correlation type="lattice"><string name="lattice" value="square"/></correlation>)",
      "0.785");
  fails_with(
      radius +
          R"(<texture type="checkerboard" name="area_fraction"><float name="color0" value="0.2"/><float name="color1" value="0.4"/></texture>
             <correlation type="lattice"/>)",
      "same everywhere");
  fails_with(
      radius +
          R"(<texture type="checkerboard" name="area_fraction"><float name="color0" value="0.2"/><float name="color1" value="0.75"/></texture>)",
      "0.7");
  for (const char* extreme : {"1e300um", "1km", "1e-8nm", "1e-300m"})
    fails_with(text("radius", extreme) + fraction, "too small or too large for the wavelengths");
}

}  // namespace
}  // namespace aureole

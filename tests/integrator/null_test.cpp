// SPDX-License-Identifier: Apache-2.0
// Surfaces that light passes as if they were not there: masks and null surfaces in both integrators, against
// closed forms and against the scene without them. Spectra are flat and the film measures their mean, so that
// the only noise is that of paths.
#include <gtest/gtest.h>

#include <cmath>

#include "aureole/bsdf/bsdf.h"
#include "aureole/plugin/registry.h"
#include "aureole/render/job.h"
#include "harness/effort.h"

namespace aureole::testing {
namespace {

/// A coloured foil, whose transmittance grows from 0 at 360 nm to 1 at 830 nm. It is passed with the
/// probability `mass`, which is not the transmittance, and is black otherwise.
class TestFoil final : public Bsdf {
public:
  explicit TestFoil(const Properties& p) : Bsdf(p), mass_(float(p.get_float("mass", 1))) {}
  BsdfEval eval_pdf(const Vec3&, const Vec3&, const BsdfContext&) const override { return {}; }
  std::optional<BsdfSample> sample(const Vec3& wi, float u1, Vec2, const BsdfContext& ctx) const override {
    if (u1 >= mass_) return {};
    return BsdfSample{-wi, null_transmittance(wi, ctx), mass_, Lobe::delta | Lobe::null};
  }
  Spectrum null_transmittance(const Vec3&, const BsdfContext& ctx) const override {
    return (ctx.wavelengths.nm - 360) * (1 / 470.f);
  }
  Lobe lobes() const override { return Lobe::delta | Lobe::null; }

private:
  float mass_;
};
AUREOLE_PLUGIN(TestFoil, "bsdf", "test_foil",
               PluginDoc{"For tests.", "", {{"mass", "float", "", "1", "probability of passing"}}, {}});

constexpr int kReplicates = 16;

struct Picture {
  std::vector<double> mean, error, alpha;  ///< per pixel
  double all = 0, all_error = 0;           ///< over the film
  RenderState state;
};

Picture render(const std::string& content, std::uint64_t seed = 0) {
  const auto scene =
      load_scene_from_string("<scene version=\"3.0.0\">" + content + "</scene>", "null_test.xml");
  RenderOptions options;
  options.replicates = kReplicates;
  options.threads = 1;
  options.seed = seed;
  RenderJob job(scene, options);
  const std::atomic<bool> stop{false};
  EXPECT_EQ(job.run(stop), RenderJob::Outcome::finished);
  EXPECT_EQ(job.state().invalid_samples, 0u);
  Picture p;
  p.state = job.state();
  const int width = p.state.identity.width;
  const std::size_t n = std::size_t(width * p.state.identity.height);
  p.mean.assign(n, 0), p.error.assign(n, 0), p.alpha.assign(n, 0);
  double squares = 0;
  for (const FilmBuffer& film : p.state.films) {
    double sum = 0;
    for (std::size_t i = 0; i < n; ++i) {
      double v, alpha;
      film.mean(int(i) % width, int(i) / width, &v, &alpha);
      p.mean[i] += v / kReplicates, p.error[i] += v * v / kReplicates, p.alpha[i] += alpha / kReplicates;
      sum += v / double(n);
    }
    p.all += sum / kReplicates, squares += sum * sum / kReplicates;
  }
  const auto standard_error = [](double mean, double s) {
    return std::sqrt(std::max(0.0, s - mean * mean) / (kReplicates - 1));
  };
  for (std::size_t i = 0; i < n; ++i) p.error[i] = standard_error(p.mean[i], p.error[i]);
  p.all_error = standard_error(p.all, squares);
  return p;
}

void expect_mean(const Picture& p, double expected, double largest_error = 0.01) {
  EXPECT_NEAR(p.all, expected, 4.5 * p.all_error + 1e-4 * expected);
  EXPECT_LT(p.all_error, largest_error * expected + 1e-9);
}
/// Two pictures of one scene by z-test: means, and the mean of z^2 of the pixels.
void expect_same(const Picture& a, const Picture& b) {
  EXPECT_NEAR(a.all, b.all, 4.5 * std::hypot(a.all_error, b.all_error) + 1e-4 * a.all);
  EXPECT_LT(std::hypot(a.all_error, b.all_error), 0.02 * a.all);
  double z2 = 0;
  int count = 0;
  for (std::size_t i = 0; i < a.mean.size(); ++i) {
    const double sigma = std::hypot(a.error[i], b.error[i]);
    if (!(sigma > 1e-7)) continue;
    const double z = (a.mean[i] - b.mean[i]) / sigma;
    EXPECT_LT(std::abs(z), 6) << "pixel " << i << ": " << a.mean[i] << " and " << b.mean[i];
    z2 += z * z, ++count;
  }
  ASSERT_GT(count, 60);
  // Student's t with about 30 degrees of freedom has a variance of 30 / 28.
  EXPECT_NEAR(z2 / count, 30.0 / 28, 5 * std::sqrt(2.3 / count));
}

std::string number(const char* name, double v) {
  return "<float name=\"" + std::string(name) + "\" value=\"" + std::to_string(v) + "\"/>";
}
std::string integer(const char* name, int v) {
  return "<integer name=\"" + std::string(name) + "\" value=\"" + std::to_string(v) + "\"/>";
}
std::string path(int max_depth = -1, const std::string& more = "") {
  return "<integrator type=\"path\"><boolean name=\"count_crossings\" value=\"false\"/>" +
         integer("max_depth", max_depth) + integer("rr_depth", 50) + more + "</integrator>";
}
std::string direct(int light_samples, int bsdf_samples, const std::string& more = "") {
  return "<integrator type=\"direct\">" + integer("emitter_samples", light_samples) +
         integer("bsdf_samples", bsdf_samples) + more + "</integrator>";
}
std::string sensor(const std::string& lookat, double fov, int size, int samples,
                   const char* sampler = "sobol") {
  return "<sensor type=\"perspective\">" + number("fov", fov) + number("near_clip", 1e-4) +
         "<transform name=\"to_world\"><lookat " + lookat + "/></transform><sampler type=\"" + sampler +
         "\">" + integer("sample_count", samples) + "</sampler><film type=\"hdrfilm\">" +
         integer("width", size) + integer("height", size) +
         "<rfilter type=\"box\"/><string name=\"response\" value=\"uniform\"/></film></sensor>";
}
std::string bsdf(const std::string& type, const std::string& content = "") {
  return "<bsdf type=\"" + type + "\">" + content + "</bsdf>";
}
std::string diffuse(double reflectance) { return bsdf("diffuse", number("reflectance", reflectance)); }
std::string twosided(const std::string& nested) { return bsdf("twosided", nested); }
std::string mask(double opacity, const std::string& nested = diffuse(0)) {
  return bsdf("mask", number("opacity", opacity) + nested);
}
std::string blend(double weight, const std::string& a, const std::string& b) {
  return bsdf("blendbsdf", number("weight", weight) + a + b);
}
std::string square(const std::string& transform, const std::string& content) {
  return "<shape type=\"rectangle\"><transform name=\"to_world\">" + transform + "</transform>" + content +
         "</shape>";
}
std::string sphere(double z, double radius, const std::string& content) {
  return "<shape type=\"sphere\"><point name=\"center\" x=\"0\" y=\"0\" z=\"" + std::to_string(z) + "\"/>" +
         number("radius", radius) + content + "</shape>";
}
std::string area(double radiance) {
  return "<emitter type=\"area\"><spectrum name=\"radiance\" value=\"" + std::to_string(radiance) +
         "\"/></emitter>";
}
std::string constant(double radiance) {
  return "<emitter type=\"constant\"><spectrum name=\"radiance\" value=\"" + std::to_string(radiance) +
         "\"/></emitter>";
}
std::string point(double x, double y, double z, double intensity) {
  return "<emitter type=\"point\"><point name=\"position\" x=\"" + std::to_string(x) + "\" y=\"" +
         std::to_string(y) + "\" z=\"" + std::to_string(z) + "\"/><spectrum name=\"intensity\" value=\"" +
         std::to_string(intensity) + "\"/></emitter>";
}
const std::string kNull = bsdf("null");
/// Looks at the origin of the plane z = 0, from below whatever hangs over it.
const std::string kGroundView = "origin=\"0, 6, 1.5\" target=\"0, 0, 0\" up=\"0, 0, 1\"";
std::string ground(double reflectance) { return square("<scale value=\"10\"/>", diffuse(reflectance)); }
/// A pane over the origin.
std::string pane(double height, const std::string& material) {
  return square("<scale value=\"0.4\"/><translate z=\"" + std::to_string(height) + "\"/>", material);
}

struct Surface {
  const char* name;
  std::string material;  ///< three tenths of it are black, the rest is not there
};
const Surface kSurfaces[] = {
    {"mask", mask(0.3)},
    {"twosided_mask", twosided(mask(0.3))},
    {"mask_twosided", mask(0.3, twosided(diffuse(0)))},
    {"mask_mask", mask(0.6, mask(0.5))},
    {"blend_with_null", blend(0.3, kNull, diffuse(0))},
    {"blend_of_masks", blend(0.25, mask(0.2), mask(0.6))},
    {"mask_of_blend", mask(0.5, blend(0.6, kNull, diffuse(0)))},
};
/// Sampled light only, both, and the path tracer.
std::vector<std::string> integrators(bool delta_light) {
  std::vector<std::string> all = {path(), path(2), direct(1, 1), direct(2, 0), direct(2, 3)};
  if (!delta_light) all.push_back(direct(0, 2));
  return all;
}

class Shadow : public ::testing::TestWithParam<Surface> {};

TEST_P(Shadow, OfAPointLight) {
  for (const std::string& integrator : integrators(true))
    for (const char* sampler : {"sobol", "independent"})
      expect_mean(render(integrator + sensor(kGroundView, 0.05, 2, 64, sampler) + ground(0.5) +
                         pane(1, GetParam().material) + point(0, 0, 2, 10)),
                  0.7 * 0.5 / M_PI * 10 / 4, 1e-3);
}

TEST_P(Shadow, OfAnAreaLight) {
  // Irradiance below a sphere of radius r at distance d: pi L r^2 / d^2.
  for (const std::string& integrator : integrators(false))
    expect_mean(render(integrator + sensor(kGroundView, 0.05, 2, 1024) + ground(0.5) +
                       pane(1, GetParam().material) + sphere(3, 0.9, area(1))),
                0.7 * 0.5 * 0.09, 0.02);
}

TEST_P(Shadow, OfTheSky) {
  // All is inside a sphere; the ground is small, and what it sends to the sphere is lost.
  for (const std::string& integrator : integrators(false))
    expect_mean(
        render(integrator + sensor(kGroundView, 0.05, 2, 256) + square("<scale value=\"2\"/>", diffuse(0.5)) +
               sphere(0, 20, GetParam().material) + constant(1)),
        0.7 * 0.5);
}

TEST_P(Shadow, ForTheCamera) {
  const std::string view = sensor("origin=\"0, 0, 5\" target=\"0, 0, 0\" up=\"0, 1, 0\"", 5, 4, 256);
  for (const std::string& integrator : {path(), path(1), direct(1, 1), direct(0, 1)}) {
    expect_mean(render(integrator + view + pane(1, GetParam().material) + constant(2)), 0.7 * 2);
    const Picture p = render(integrator + view + pane(1, GetParam().material) + sphere(-3, 2, area(2)));
    expect_mean(p, 0.7 * 2);
    for (const double alpha : p.alpha) EXPECT_NEAR(alpha, 1, 1e-6);
  }
}

TEST_P(Shadow, HasItsAlpha) {
  const std::string view = sensor("origin=\"0, 0, 5\" target=\"0, 0, 0\" up=\"0, 1, 0\"", 5, 4, 256);
  for (const std::string& integrator : {path(), path(1), path(2), direct(1, 1)}) {
    const auto mean_alpha = [&](const std::string& rest) {
      double mean = 0;
      const Picture p = render(integrator + view + pane(1, GetParam().material) + rest);
      for (const double a : p.alpha) mean += a / double(p.alpha.size());
      return mean;
    };
    EXPECT_NEAR(mean_alpha(point(0, 0, 3, 1)), 0.3, 0.01);
    EXPECT_NEAR(mean_alpha(constant(1)), 1, 1e-6);
    EXPECT_NEAR(mean_alpha(pane(0, diffuse(0.5)) + point(0, 0, 3, 1)), 1, 1e-6);
  }
}

INSTANTIATE_TEST_SUITE_P(Surfaces, Shadow, ::testing::ValuesIn(kSurfaces),
                         [](const auto& info) { return std::string(info.param.name); });

/// With one random number for several surfaces, what passed the first would pass all.
TEST(Stack, SurfacesAreIndependent) {
  std::string panes, thin;
  for (int k = 0; k < 6; ++k) panes += pane(0.5 + 0.1 * k, mask(0.3));
  for (int k = 0; k < 60; ++k) thin += pane(0.5 + 0.01 * k, mask(0.02));
  const std::string from_above = "origin=\"0, 0, 5\" target=\"0, 0, 0\" up=\"0, 1, 0\"";
  for (const char* sampler : {"sobol", "independent"})
    for (const std::string& integrator : {path(), direct(1, 1)}) {
      if (!test::is_thorough() && sampler == std::string("independent") && integrator != path()) continue;
      const auto camera = sensor(from_above, 2, 4, 256, sampler);
      expect_mean(render(integrator + camera + panes + constant(1)), std::pow(0.7, 6), 0.03);
      expect_mean(render(integrator + camera + thin + constant(1)), std::pow(0.98, 60), 0.03);
      expect_mean(render(integrator + sensor(kGroundView, 0.05, 2, 64, sampler) + ground(0.5) + panes +
                         point(0, 0, 2, 10)),
                  std::pow(0.7, 6) * 0.5 / M_PI * 10 / 4, 1e-3);
      // Twice through the stack: light that scatters at the ground, seen from above.
      expect_mean(render(integrator + sensor(from_above, 0.05, 2, 2048, sampler) + ground(0.5) + panes +
                         point(0, 0, 2, 10)),
                  std::pow(0.7, 12) * 0.5 / M_PI * 10 / 4, 0.05);
    }
}

TEST(Foils, MultiplyTheirTransmittances) {
  for (const double mass : {1.0, 0.6}) {
    const std::string foil = bsdf("test_foil", number("mass", mass));
    for (const int count : {1, 2}) {
      std::string panes, shells;
      for (int k = 0; k < count; ++k) panes += pane(1 + 0.2 * k, foil), shells += sphere(0, 20 + k, foil);
      const double transmittance = 1.0 / (count + 1);  // the mean of T^count
      const auto at_ground = sensor(kGroundView, 0.05, 2, 512);
      for (const std::string& integrator : integrators(true))
        expect_mean(render(integrator + at_ground + ground(0.5) + panes + point(0, 0, 2, 10)),
                    transmittance * 0.5 / M_PI * 10 / 4);
      for (const std::string& integrator : integrators(false)) {
        expect_mean(render(integrator + at_ground + ground(0.5) + panes + sphere(3, 0.9, area(1))),
                    transmittance * 0.5 * 0.09, 0.03);
        expect_mean(render(integrator + at_ground + square("<scale value=\"2\"/>", diffuse(0.5)) + shells +
                           constant(1)),
                    transmittance * 0.5);
      }
      for (const std::string& integrator : {path(), direct(1, 1)})
        expect_mean(
            render(integrator + sensor("origin=\"0, 0, 5\" target=\"0, 0, 0\" up=\"0, 1, 0\"", 5, 4, 256) +
                   panes + constant(2)),
            transmittance * 2, 0.02);
    }
  }
}

TEST(Null, IsInvisibleBitForBit) {
  const std::string view = sensor("origin=\"0, 0, 5\" target=\"0, 0, 0\" up=\"0, 1, 0\"", 40, 8, 16);
  const auto with_null = [](double radius) { return sphere(0, radius, kNull); };
  for (const std::string& integrator : {path(), path(1), direct(1, 1)}) {
    const Picture without = render(integrator + view + constant(1));
    for (const double radius : {1., 10.}) {
      const Picture with = render(integrator + view + with_null(radius) + constant(1));
      EXPECT_EQ(with.mean, without.mean);
      EXPECT_EQ(with.alpha, without.alpha);
    }
    const Picture masked = render(integrator + view + sphere(0, 1, mask(0)) + constant(1));
    EXPECT_EQ(masked.mean, without.mean);
  }
}

TEST(Furnace, MasksOfWhiteVanish) {
  for (const std::string& material :
       {mask(0.4, twosided(diffuse(1))), twosided(mask(0.4, diffuse(1))),
        blend(0.3, mask(0.4, twosided(diffuse(1))), twosided(bsdf("conductor"))),
        blend(0.5, kNull, bsdf("thindielectric")),
        mask(0.5, mask(0.5, blend(0.5, twosided(diffuse(1)), bsdf("thindielectric"))))}) {
    const Picture p =
        render(path() + sensor("origin=\"1, 2, 5\" target=\"0, 0, 0\" up=\"0, 1, 0\"", 30, 6, 64) +
               sphere(0, 1, material) + constant(1));
    expect_mean(p, 1);
    for (std::size_t i = 0; i < p.mean.size(); ++i)
      EXPECT_NEAR(p.mean[i], 1, 6 * p.error[i] + 5e-4) << material;
  }
}

/// Materials, lamps and corners of every kind.
std::string stage(const std::string& pane_material, const std::string& around) {
  return square("<scale value=\"4\"/>", diffuse(0.6)) +
         R"(<shape type="sphere"><point name="center" x="0.5" y="0" z="0.8"/><float name="radius" value="0.5"/><bsdf type="plastic"/></shape>
<shape type="cube"><transform name="to_world"><scale value="0.4"/><translate x="-0.8" z="0.5"/></transform>)" +
         bsdf("conductor") + "</shape>" +
         square(R"(<scale value="0.6"/><rotate x="1" angle="180"/><translate z="3"/>)", area(5)) +
         square(R"(<scale value="1"/><rotate x="1" angle="20"/><translate x="-0.2" z="1.7"/>)",
                pane_material) +
         around + constant(0.3);
}
const std::string kStageView = "origin=\"1, -4, 3\" target=\"0, 0, 0.4\" up=\"0, 0, 1\"";

TEST(Null, ChangesNoScene) {
  const std::string around = sphere(0.5, 1.9, kNull) + sphere(0.5, 30, kNull) + pane(0.2, kNull);
  for (const std::string& integrator : {path(2), path(3), path(6), direct(1, 1), direct(0, 2)}) {
    // Sobol points get worse with the dimension, which counts passed surfaces, too.
    const auto camera = sensor(kStageView, 45, 10, 64, "independent");
    const Picture with = render(integrator + camera + stage(twosided(diffuse(0.4)), around), 1);
    const Picture without = render(integrator + camera + stage(twosided(diffuse(0.4)), ""));
    expect_same(with, without);
    // Nor the noise: light that was found through the surfaces is weighted as without them.
    double ratio = 0, pixels = 0;
    for (std::size_t i = 0; i < with.error.size(); ++i)
      if (without.error[i] > 1e-6) ratio += std::log(with.error[i] / without.error[i]), ++pixels;
    ASSERT_GT(pixels, 60);
    EXPECT_NEAR(ratio / pixels, 0, 0.15) << integrator;
  }
}

TEST(Techniques, AgreeBehindMasks) {
  const std::string material = mask(0.45, twosided(diffuse(0.7)));
  const std::string around = sphere(0.5, 12, mask(0.2, twosided(diffuse(0.5))));
  const auto camera = sensor(kStageView, 45, 10, 128);
  // Mirrors find their light by BSDF samples only, and light samples miss what the plastic's coating
  // reflects: of each kind at least one.
  const Picture reference = render(path(2) + camera + stage(material, around));
  for (const std::string& integrator : {direct(1, 1), direct(3, 1), direct(1, 4)})
    expect_same(render(integrator + camera + stage(material, around), 1), reference);
  const Picture bsdf_only = render(direct(0, 8) + camera + stage(material, around), 2);
  EXPECT_NEAR(bsdf_only.all, reference.all, 4.5 * std::hypot(bsdf_only.all_error, reference.all_error));
}

TEST(Depth, PassedSurfacesDoNotCount) {
  // A closed room that emits: each bounce adds a term of a geometric series.
  const auto room = [](const std::string& inside) {
    return "<shape type=\"sphere\">" + number("radius", 3) +
           "<boolean name=\"flip_normals\" value=\"true\"/>" + diffuse(0.5) + area(1) + "</shape>" + inside;
  };
  const std::string view = sensor("origin=\"0.2, 0.1, 0.3\" target=\"1, 0.3, 0\" up=\"0, 1, 0\"", 70, 4, 64);
  const std::string shells = sphere(0, 1, kNull) + sphere(0, 2, kNull) + sphere(0, 2.9, mask(0));
  double expected = 0, term = 1;
  for (int depth = 0; depth < 4; ++depth) {
    const Picture p = render(path(depth) + view + room(shells));
    EXPECT_NEAR(p.all, expected, 4.5 * p.all_error + 1e-4);
    expected += term;
    term *= 0.5;
  }
  // Roulette counts vertices, too: it never ends a path that has none.
  const Picture p =
      render("<integrator type=\"path\"><boolean name=\"count_crossings\" value=\"false\"/>" +
             integer("rr_depth", 1) + integer("max_depth", 1) + "</integrator>" + view + room(shells));
  EXPECT_NEAR(p.all, 1, 1e-6);
  EXPECT_EQ(p.all_error, 0);
}

TEST(Emitters, OnMasksShineAndPass) {
  const std::string view = sensor("origin=\"0, 0, 5\" target=\"0, 0, 0\" up=\"0, 1, 0\"", 5, 4, 256);
  for (const std::string& integrator : {path(), direct(1, 1)})
    expect_mean(render(integrator + view + pane(1, mask(0.3) + area(3)) + constant(1)), 3.7);
  // The ground receives equal light from the emitter and from behind it.
  for (const std::string& integrator : {path(), direct(1, 1), direct(4, 0), direct(0, 4)})
    expect_mean(render(integrator + sensor(kGroundView, 0.05, 2, 1024) +
                       square("<scale value=\"2\"/>", diffuse(0.5)) + "<shape type=\"sphere\">" +
                       number("radius", 20) + "<boolean name=\"flip_normals\" value=\"true\"/>" + mask(0.3) +
                       area(3) + "</shape>" + constant(1)),
                0.5 * 3.7);
}

TEST(HiddenEmitters, StayHiddenBehindMasks) {
  const std::string hide = "<boolean name=\"hide_emitters\" value=\"true\"/>";
  const std::string view = sensor("origin=\"0, 0, 5\" target=\"0, 0, 0\" up=\"0, 1, 0\"", 5, 4, 256);
  const std::string things = pane(1, mask(0.3, diffuse(0))) + pane(0.5, area(3)) + constant(1);
  for (const std::string& integrator : {path(2, hide), direct(1, 1, hide)}) {
    const Picture nothing = render(integrator + view + things);
    EXPECT_EQ(nothing.all, 0);
    for (const double alpha : nothing.alpha) EXPECT_NEAR(alpha, 0.3, 0.05);
    // Behind both, a lit surface: seven tenths of what the sky and the emitter's back (nothing) give.
    const Picture lit = render(integrator + view + things + square("<scale value=\"50\"/>", diffuse(0.5)));
    EXPECT_GT(lit.all, 0.2);
    EXPECT_LT(lit.all, 0.7 * 0.5);
  }
  const std::string lit = things + square("<scale value=\"50\"/>", diffuse(0.5));
  const Picture a = render(path(2, hide) + view + lit), b = render(direct(2, 2, hide) + view + lit);
  EXPECT_NEAR(a.all, b.all, 4.5 * std::hypot(a.all_error, b.all_error));
}

}  // namespace
}  // namespace aureole::testing

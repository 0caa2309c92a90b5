// SPDX-License-Identifier: Apache-2.0
// The estimates of single paths of `path`, `ptracer` and `bdpt` against `PathOracle`, which computes value,
// pdfs of all techniques and MIS weight of the same vertices by itself.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "aureole/bsdf/bsdf.h"
#include "aureole/integrator/integrator.h"
#include "aureole/loading/load.h"
#include "aureole/math/warp.h"
#include "aureole/plugin/registry.h"
#include "aureole/scene/scene.h"
#include "aureole/texture/texture.h"
#include "harness/path_check.h"
#include "loading/test_plugins.h"

namespace aureole::testing {
namespace {

/// A Lambertian lobe and a Phong lobe whose exponent and probability of being sampled depend on the
/// wavelength, so that the wavelengths of a path differ in the pdfs of its directions.
class SpectralPhong final : public Bsdf {
public:
  explicit SpectralPhong(const Properties& p)
      : Bsdf(p),
        diffuse_(get_texture(p, "diffuse_reflectance", 0.5, SpectrumRole::reflectance)),
        glossy_(get_texture(p, "glossy_reflectance", 0.5, SpectrumRole::reflectance)),
        share_(get_texture(p, "diffuse_share", 0.5, SpectrumRole::reflectance)),
        exponent_(get_texture(p, "exponent", 10, SpectrumRole::unbounded)) {}

  BsdfEval eval_pdf(const Vec3& wi, const Vec3& wo, const BsdfContext& ctx) const override {
    if (!(wi.z > 0 && wo.z > 0)) return {};
    const Spectrum n = at(exponent_, ctx), share = at(share_, ctx);
    const float cosine = std::max(dot(reflect(wi), wo), 0.f);
    const Spectrum lobe = make_spectrum([&](int i) { return 0.5f * kInvPi * std::pow(cosine, n[i]); });
    const float diffuse = wo.z * kInvPi;
    return {at(diffuse_, ctx) * diffuse + at(glossy_, ctx) * (n + Spectrum(2.f)) * lobe * wo.z,
            share * diffuse + (Spectrum(1.f) - share) * (n + Spectrum(1.f)) * lobe};
  }

  std::optional<BsdfSample> sample(const Vec3& wi, float u1, Vec2 u2, const BsdfContext& ctx) const override {
    if (!(wi.z > 0)) return {};
    Vec3 wo = square_to_cosine_hemisphere(u2);
    if (!(u1 < at(share_, ctx)[0])) {
      const float c = std::pow(1 - u2.x, 1 / (at(exponent_, ctx)[0] + 1)), s = std::sqrt((1 - c) * (1 + c));
      const Vec2 a = cos_sin_2pi(u2.y);
      wo = normalize(Frame::from_normal(reflect(wi)).to_world({s * a.x, s * a.y, c}));
    }
    const BsdfEval e = eval_pdf(wi, wo, ctx);
    if (!(e.pdf[0] > 0)) return {};
    return BsdfSample{wo, e.value, e.pdf, lobes()};
  }

  Lobe lobes() const override { return Lobe::diffuse | Lobe::glossy | Lobe::reflect; }

private:
  static Spectrum at(const TexturePtr& texture, const BsdfContext& ctx) {
    return texture->eval(ctx.point, ctx.wavelengths);
  }
  TexturePtr diffuse_, glossy_, share_, exponent_;
};

const PluginRegistration kSpectralPhong(test::test_plugin<SpectralPhong>(
    "bsdf", "test_spectral_phong",
    {"diffuse_reflectance", "glossy_reflectance", "exponent", "diffuse_share"}));

std::string name(PathOracle::Method method) {
  const char* names[] = {"path", "ptracer", "bdpt"};
  return names[int(method)];
}
/// Longest path in segments. Russian roulette never begins.
constexpr int kMaxDepth = 7;
std::string integrator(PathOracle::Method method) {
  return fmt::format(R"(<integrator type="{}"><integer name="max_depth" value="{}"/>)"
                     R"(<integer name="rr_depth" value="1000"/></integrator>)",
                     name(method), kMaxDepth);
}

/// From aureole: the tree of lights has tests of its own.
LightProbabilities probabilities(const ClosedFormScene& scene, const Scene& loaded) {
  return {[&](const Double3& p, const Double3& facing, const OracleVertex& light) -> double {
    if (loaded.emitters().size() == 1) return 1;
    std::size_t index = 0;  // lights on shapes come first, in their order
    for (const Rectangle& r : scene.rectangles) {
      if (light.rectangle == &r) break;
      index += r.radiance.has_value();
    }
    return loaded.lights().probability(p.to_float(), facing.to_float(), loaded.emitters().at(index), 0);
  }};
}

PathCheck::Counts check(const ClosedFormScene& scene, PathOracle::Method method, int paths) {
  const LoadedScene loaded = load_scene_from_string(scene.xml(integrator(method)), "oracle.xml");
  const Scene& s = *loaded.scene;
  PathCheck check(scene, PathOracle(scene, method, probabilities(scene, s)), kMaxDepth);
  const Vec2 size{float(scene.camera.width), float(scene.camera.height)};
  for (int k = 0; k < paths && !::testing::Test::HasFailure(); ++k) {
    SCOPED_TRACE("path " + std::to_string(k));
    Path path;
    path.samples = SampleStream(s.sensor().sampler(), std::uint64_t(k) * 0x9e3779b97f4a7c15u, 0);
    path.wavelengths = s.wavelengths().sample(path.samples.get1(2));
    path.ray = s.sensor().sample_ray({size.x * path.samples.get1(0), size.y * path.samples.get1(1)}, {}).ray;
    path.samples.set_first(SampleStream::camera_dimensions(false));
    check.begin(path);
    std::vector<Splat> splats;
    const PathLog log = [&](const PathEvent& e) { check(e); };
    loaded.integrator->trace(s, std::span(&path, 1), splats, BatchLog(log, 0));
    check.end(path, splats);
  }
  return check.counts();
}

// Spectra that are level near the ends.
Curve ramp(double blue, double red) { return Curve({{340, blue}, {380, blue}, {780, red}, {860, red}}); }
Curve bump(double ends, double middle) {
  return Curve({{340, ends}, {400, ends}, {560, middle}, {720, ends}, {860, ends}});
}
Material lambert(const Curve& reflectance) { return {.reflectance = reflectance}; }
Material phong(double diffuse, const Curve& glossy) {
  return {Material::Kind::phong, Curve(diffuse), glossy, ramp(40, 4), ramp(0.2, 0.7)};
}

/// A room with an open front, which a camera looks into; on the floor lies a patch of `patch`.
ClosedFormScene room(const Material& back, const Material& patch) {
  ClosedFormScene s;
  s.camera.p = {0.1, 0.05, 3.4};
  s.rectangles = {
      {{0, -1, 0}, {0, 0, 1}, {1, 0, 0}, lambert(ramp(0.7, 0.4)), {}},  // floor
      {{0, 1, 0}, {1, 0, 0}, {0, 0, 1}, lambert(Curve(0.6)), {}},       // ceiling
      {{0, 0, -1}, {1, 0, 0}, {0, 1, 0}, back, {}},                     // back
      {{-1, 0, 0}, {0, 1, 0}, {0, 0, 1}, lambert(ramp(0.2, 0.8)), {}},  // left
      {{1, 0, 0}, {0, 0, 1}, {0, 1, 0}, lambert(bump(0.3, 0.75)), {}},  // right
      {{0.3, -0.6, 0.1}, {0, 0, 0.4}, {0.4, 0, 0}, patch, {}},
  };
  return s;
}
const Material kMirror{Material::Kind::mirror, ramp(0.9, 0.7)};
const Rectangle kCeilingLight{{0, 0.9, 0}, {0.3, 0, 0}, {0, 0, 0.25}, lambert(Curve(0.4)), bump(3, 8)};
const Rectangle kSideLight{
    {-0.9, -0.5, 0.3}, {0, 0.2, 0}, {0, 0, 0.3}, lambert(Curve(0.2)), bump(3, 8).scaled(0.3)};

using Method = PathOracle::Method;
class Integrators : public ::testing::TestWithParam<Method> {
protected:
  /// Compares many paths of the scene; the techniques of the integrator must all have found some.
  PathCheck::Counts check_scene(const ClosedFormScene& scene) const {
    const Method method = GetParam();
    const PathCheck::Counts c = check(scene, method, method == Method::bdpt ? 200 : 800);
    EXPECT_GT(c.compared(), 250);
    EXPECT_LT(c.near, 0.15 * c.compared());
    const bool is_hit = has_surface_light(scene) || scene.sky;
    if (method != Method::ptracer) {
      EXPECT_GT(c.occluded, 10);
      EXPECT_GT(c.light, 150);
      EXPECT_GT(c.hit, is_hit ? 5 : -1);
    }
    if (method != Method::path) {
      EXPECT_GT(c.sensor, 25);
    }
    if (method == Method::bdpt) {
      EXPECT_GT(c.vertex, 60);
    }
    if (method == Method::ptracer) {
      EXPECT_GT(c.seen, is_hit ? 5 : -1);
    }
    return c;
  }

private:
  static bool has_surface_light(const ClosedFormScene& scene) {
    return std::ranges::any_of(scene.rectangles, [](const Rectangle& r) { return r.radiance.has_value(); });
  }
};

TEST_P(Integrators, DiffuseWalls) {
  ClosedFormScene s = room(lambert(ramp(0.8, 0.5)), lambert(Curve(0.5)));
  s.rectangles.push_back(kCeilingLight);
  check_scene(s);
}

TEST_P(Integrators, PdfsDependOnTheWavelength) {
  ClosedFormScene s = room(phong(0.3, ramp(0.3, 0.6)), phong(0.1, ramp(0.8, 0.5)));
  s.rectangles.push_back(kCeilingLight);
  EXPECT_GT(check_scene(s).spectral, 200);
}

TEST_P(Integrators, ThreeLightsAndAMirror) {
  ClosedFormScene s = room(phong(0.3, ramp(0.3, 0.6)), kMirror);
  s.rectangles.push_back(kCeilingLight);
  s.rectangles.push_back(kSideLight);
  s.point = PointLight{{0.6, 0.2, 0.5}, bump(3, 8).scaled(0.1)};
  EXPECT_GT(check_scene(s).mirror, 10);
}

TEST_P(Integrators, Sky) {
  ClosedFormScene s = room(phong(0.3, ramp(0.3, 0.6)), kMirror);
  s.sky = bump(1, 2);
  s.rectangles.erase(s.rectangles.begin() + 1);  // without the ceiling
  EXPECT_GT(check_scene(s).mirror, 10);
}

TEST_P(Integrators, FogAroundAnAreaLight) {
  ClosedFormScene s = room(phong(0.3, ramp(0.3, 0.6)), kMirror);
  s.rectangles.push_back(kCeilingLight);
  s.fog = Fog{{-0.95, -0.9, -0.9}, {0.9, 0.95, 0.8}, ramp(1.2, 0.5), bump(0.05, 0.4), 0.4};
  const PathCheck::Counts c = check_scene(s);
  EXPECT_GT(c.spectral, 500);
  EXPECT_GT(c.mirror, 10);
  if (GetParam() == Method::path) {
    EXPECT_GT(c.along, 500);
    EXPECT_GT(c.seen, 5);
  }
}

TEST_P(Integrators, FogAroundAPointLightAndTheCamera) {
  ClosedFormScene s = room(phong(0.3, ramp(0.3, 0.6)), lambert(Curve(0.5)));
  s.point = PointLight{{-0.2, 0.3, 0.1}, bump(3, 8)};
  s.fog = Fog{{-5, -5, -5}, {5, 5, 5}, ramp(0.3, 0.8), bump(0.05, 0.1), -0.3};
  const PathCheck::Counts c = check_scene(s);
  EXPECT_GT(c.spectral, 500);
  if (GetParam() == Method::path) {
    EXPECT_GT(c.along, 500);
  }
}

TEST_P(Integrators, FogUnderASky) {
  ClosedFormScene s = room(phong(0.3, ramp(0.3, 0.6)), kMirror);
  s.sky = bump(1, 2);
  s.rectangles.erase(s.rectangles.begin() + 1);
  s.fog = Fog{{-0.95, -0.9, -0.9}, {0.9, 0.95, 1.5}, ramp(1.2, 0.5), bump(0.05, 0.4), -0.3};
  EXPECT_GT(check_scene(s).spectral, 200);
}

TEST_P(Integrators, FogBesideThreeLights) {
  ClosedFormScene s = room(phong(0.3, ramp(0.3, 0.6)), kMirror);
  s.rectangles.push_back(kSideLight);
  // With several lights the oracle does not know about which of them `path` samples positions along a ray.
  if (GetParam() != Method::path) {
    s.rectangles.push_back(kCeilingLight);
    s.point = PointLight{{0.6, 0.2, 0.5}, bump(3, 8).scaled(0.1)};
  }
  s.fog = Fog{{-0.5, -1.1, -1.1}, {0.9, 0.4, 0.8}, ramp(1.2, 0.5), bump(0.05, 0.4), 0.7};
  check_scene(s);
}

INSTANTIATE_TEST_SUITE_P(PathOracle, Integrators,
                         ::testing::Values(Method::path, Method::ptracer, Method::bdpt),
                         [](const auto& info) { return name(info.param); });

}  // namespace
}  // namespace aureole::testing

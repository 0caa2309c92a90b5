// SPDX-License-Identifier: Apache-2.0
// BSDFs that contain others: cases for the harness, and values against formulas of their own.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "aureole/asset/asset.h"
#include "aureole/bsdf/bsdf.h"
#include "aureole/core/image.h"
#include "aureole/math/significance.h"
#include "aureole/math/warp.h"
#include "aureole/plugin/registry.h"
#include "aureole/spectrum/refractive_index.h"
#include "aureole/texture/texture.h"
#include "harness/bsdf_harness.h"
#include "harness/paths.h"
#include "harness/properties_builder.h"

namespace aureole::testing {
namespace {

// ---------------------------------------------------------------- cases for the harness

BsdfCase make_case(std::string name, std::string xml, const std::function<void(BsdfCase&)>& adapt = {}) {
  BsdfCase c;
  c.name = std::move(name);
  c.xml = std::move(xml);
  if (adapt) adapt(c);
  return c;
}
void lossless(BsdfCase& c) { c.lossless = true; }
void lossless_one_sided(BsdfCase& c) { c.black_below = c.lossless = true; }
void one_sided(BsdfCase& c) { c.black_below = true; }
/// The nested BSDF is black from below; the open part is not.
void may_fail(BsdfCase& c) { c.may_fail = true; }

std::string bsdf(const std::string& type, const std::string& content = "") {
  return "<bsdf type=\"" + type + "\">" + content + "</bsdf>";
}
std::string number(const std::string& name, double value) {
  return "<float name=\"" + name + "\" value=\"" + std::to_string(value) + "\"/>";
}
std::string mask(double opacity, const std::string& nested) {
  return bsdf("mask", number("opacity", opacity) + nested);
}
std::string blend(double weight, const std::string& first, const std::string& second) {
  return bsdf("blendbsdf", number("weight", weight) + first + second);
}
std::string twosided(const std::string& nested) { return bsdf("twosided", nested); }
const std::string kWhite = bsdf("diffuse", number("reflectance", 1));
const std::string kMirror = bsdf("conductor");
const std::string kCopper = bsdf("conductor", R"(<string name="material" value="Cu"/>)");
const std::string kFlint =
    bsdf("dielectric", R"(<string name="int_ior" value="sf11"/><float name="ext_ior" value="1"/>)");
const std::string kColoured = bsdf("diffuse", R"(<spectrum name="reflectance" value="400:0.1, 700:0.9"/>)");

void flint_below(BsdfCase& c) {
  c.lossless = true;
  c.n_below = [index = *find_refractive_index("sf11", true)](float nm) { return float(index.at(nm).real()); };
}

const BsdfCases kNull("null", lossless, {});

const BsdfCases kMask("mask", [](BsdfCase& c) { c.may_fail = c.name == "mask_example_1"; },
                      {make_case("mask_of_twosided", mask(0.37, twosided(kWhite)), lossless),
                       make_case("mask_of_null", mask(0.37, bsdf("null")), lossless),
                       make_case("mask_of_mask", mask(0.6, mask(0.5, twosided(kWhite))), lossless),
                       make_case("mask_of_plastic",
                                 mask(0.8, bsdf("plastic", number("diffuse_reflectance", 1))), may_fail),
                       make_case("mask_of_dispersive", mask(0.6, kFlint), flint_below),
                       make_case("mask_opaque", mask(1, kWhite), lossless_one_sided),
                       make_case("mask_open", mask(0, kColoured), lossless),
                       make_case("mask_hardly_open", mask(0.999, twosided(kWhite)), lossless)});

const BsdfCases kTwoSided(
    "twosided", {},
    {make_case("twosided_of_mask", twosided(mask(0.6, kWhite)), lossless),
     make_case("twosided_of_two_masks", twosided(mask(0.6, kColoured) + mask(0.2, bsdf("plastic")))),
     make_case("twosided_of_mask_and_mirror", twosided(mask(0.6, kWhite) + kMirror), lossless)});

const BsdfCases kBlend(
    "blendbsdf",
    [](BsdfCase& c) {
      c.may_fail = c.name == "blendbsdf_example_2";
      c.black_below = !c.may_fail;
    },
    {make_case("blendbsdf_mirror_white", blend(0.3, kMirror, kWhite), lossless_one_sided),
     make_case("blendbsdf_of_two_deltas", blend(0.4, kCopper, bsdf("plastic")), one_sided),
     make_case("blendbsdf_smooth",
               blend(0.7, kColoured, bsdf("plastic", R"(<string name="int_ior" value="sf11"/>)")), one_sided),
     make_case("blendbsdf_dispersive", blend(0.3, kFlint, twosided(kWhite)), flint_below),
     make_case("blendbsdf_of_masks", blend(0.45, mask(0.4, twosided(kWhite)), mask(0.8, twosided(kMirror))),
               lossless),
     make_case("blendbsdf_with_null", blend(0.25, bsdf("null"), twosided(kColoured))),
     make_case("blendbsdf_chain",
               blend(0.25, kMirror, blend(0.5, kWhite, bsdf("plastic", number("diffuse_reflectance", 1)))),
               lossless_one_sided),
     make_case("blendbsdf_first", blend(0, kWhite, bsdf("null")), lossless_one_sided),
     make_case("blendbsdf_second", blend(1, bsdf("null"), kWhite), lossless_one_sided)});

// A turned frame sees other cosines than the surface, of one side of the light's way only. Directions below a
// horizon are lost, and in importance mode the value is not bounded.
const char* const kNotReciprocal = "the frame is turned, and depends on the viewer";
std::string turned(const std::string& type, const std::string& more, const std::string& nested) {
  const std::string name = type == "bumpmap" ? "heights" : "normals";
  return bsdf(type, "<texture name=\"" + std::string(type == "bumpmap" ? "height" : "normalmap") +
                        "\" type=\"bitmap\"><string name=\"filename\" value=\"" + name +
                        ".png\"/><boolean name=\"raw\" value=\"true\"/></texture>" + more + nested);
}
void turned_frame(BsdfCase& c) {
  c.not_reciprocal = kNotReciprocal;
  c.may_fail = true;
}
std::function<void(BsdfCase&)> turned_in(TransportMode mode) {
  return [mode](BsdfCase& c) {
    turned_frame(c);
    c.mode = mode;
    c.tolerance = 4e-3;  // of the quadrature, with a horizon across the bins
  };
}
std::vector<BsdfCase> turned_cases(const std::string& type) {
  const std::string plain =
      R"(<boolean name="flip_invalid_normals" value="false"/><boolean name="use_shadowing_function" value="false"/>)";
  std::vector<BsdfCase> cases;
  for (const TransportMode mode : {TransportMode::radiance, TransportMode::importance}) {
    const auto add = [&](const char* name, const std::string& more, const std::string& nested) {
      cases.push_back(
          make_case(type + "_" + name + (mode == TransportMode::radiance ? "_radiance" : "_importance"),
                    turned(type, more, nested), turned_in(mode)));
    };
    add("diffuse", "", kWhite);
    add("plain", plain, kWhite);
    add("two_sides", "", twosided(bsdf("plastic")));
    add("mirror", "", kMirror);
    add("mask", "", mask(0.6, twosided(kColoured)));
    // In radiance mode refracted light gains n^2.
    if (mode == TransportMode::importance) add("dispersive", "", kFlint);
    add("twice", "", turned("normalmap", "", kColoured));
  }
  return cases;
}
const BsdfCases kBump("bumpmap", turned_frame, with_samples(100000, turned_cases("bumpmap")));
const BsdfCases kNormal("normalmap", turned_frame, with_samples(100000, turned_cases("normalmap")));

// ---------------------------------------------------------------- values

std::shared_ptr<const Bsdf> make(const std::string& xml) {
  return build<Bsdf>(xml, make_context(), test::example_file);
}

const Wavelengths kFlat = Wavelengths::at(SpectralGrid{}, 555);

/// A point of a square of the world's frame.
struct Square {
  std::shared_ptr<const Shape> shape = build<Asset>(R"(<shape type="rectangle"/>)")->shape();
  SurfacePoint at(Vec2 uv) const {
    SurfacePoint point;
    point.uv = uv;
    point.p = {2 * uv.x - 1, 2 * uv.y - 1, 0};
    point.ng = {0, 0, 1};
    point.shape = shape.get();
    return point;
  }
};

template <class F>
std::string message_of(F&& f) {
  try {
    f();
  } catch (const Error& e) {
    return e.what();
  }
  return "";
}

TEST(Mask, IsWhatItsPartsAre) {
  const Square square;
  const SurfacePoint point = square.at({0.3f, 0.4f});
  const BsdfContext ctx{kFlat, point};
  const auto once = make(mask(0.3, twosided(kColoured))),
             twice = make(mask(0.6, mask(0.5, twosided(kColoured)))),
             inside = make(twosided(mask(0.3, kColoured))), plain = make(twosided(kColoured)),
             half = make(blend(0.3, bsdf("null"), twosided(kColoured)));
  SeededRandom random(5);
  for (int k = 0; k < 50; ++k) {
    const Vec3 wi = square_to_uniform_sphere(random.next2()), wo = square_to_uniform_sphere(random.next2());
    const BsdfEval expected = plain->eval_pdf(wi, wo, ctx);
    for (const auto& b : {once, twice, inside, half}) {
      const BsdfEval e = b->eval_pdf(wi, wo, ctx);
      EXPECT_NEAR(e.value[0], 0.3f * expected.value[0], 1e-6);
      EXPECT_NEAR(e.pdf[0], 0.3f * expected.pdf[0], 1e-6);
      EXPECT_NEAR(b->null_transmittance(wi, ctx)[0], 0.7, 1e-6);
      EXPECT_NEAR(b->null_transmittance(wi, ctx)[kWavelengths - 1], 0.7, 1e-6);
      EXPECT_TRUE(b->is_passable() && b->is_smooth());
    }
  }
  EXPECT_EQ(plain->null_transmittance({0, 0, 1}, ctx)[0], 0);
  // A lobe that a constant opacity makes impossible is not among the lobes.
  EXPECT_FALSE(make(mask(1, kColoured))->is_passable());
  EXPECT_FALSE(make(mask(0, kColoured))->is_smooth());
  EXPECT_FALSE(make(blend(0, kColoured, bsdf("null")))->is_passable());
}

TEST(Mask, OpacityFollowsItsTexture) {
  const Square square;
  const auto b =
      make(bsdf("mask", R"(<texture name="opacity" type="checkerboard"><float name="color0" value="0.2"/>
      <float name="color1" value="0.9"/></texture>)" +
                            kWhite));
  for (const auto& [uv, opacity] : {std::pair{Vec2{0.25f, 0.25f}, 0.2f}, {Vec2{0.75f, 0.25f}, 0.9f}}) {
    const SurfacePoint point = square.at(uv);
    EXPECT_FLOAT_EQ(b->null_transmittance({0, 0, 1}, {kFlat, point})[0], 1 - opacity);
    EXPECT_FLOAT_EQ(b->eval_pdf({0, 0, 1}, {0, 0, 1}, {kFlat, point}).value[0], opacity * kInvPi);
  }
}

TEST(Blend, WeightIsThatOfTheSecond) {
  const Square square;
  const auto b =
      make(bsdf("blendbsdf", R"(<texture name="weight" type="checkerboard"><float name="color0" value="0.2"/>
      <float name="color1" value="0.9"/></texture>)" +
                                 bsdf("diffuse", number("reflectance", 0.8)) + kWhite));
  for (const auto& [uv, weight] : {std::pair{Vec2{0.25f, 0.25f}, 0.2f}, {Vec2{0.75f, 0.25f}, 0.9f}}) {
    const SurfacePoint point = square.at(uv);
    EXPECT_FLOAT_EQ(b->eval_pdf({0, 0, 1}, {0, 0, 1}, {kFlat, point}).value[0],
                    ((1 - weight) * 0.8f + weight) * kInvPi);
  }
}

/// Mitsuba 3.9.1 adds the density of the diffuse part to the probability of the mirror's direction, so that a
/// mirror blended with something black loses light. Each lobe has to reflect its share.
TEST(Blend, DeltaLobesAreLeftAlone) {
  const Square square;
  const SurfacePoint point = square.at({0.3f, 0.4f});
  const auto b = make(blend(0.75, kMirror, bsdf("diffuse", number("reflectance", 0))));
  double reflected = 0;
  constexpr int kSamples = 1000;
  for (int k = 0; k < kSamples; ++k) {
    const auto s = b->sample({0.6f, 0, 0.8f}, (float(k) + 0.5f) / kSamples, {0.3f, 0.6f}, {kFlat, point});
    ASSERT_TRUE(s);
    reflected += double(s->value[0]) / double(s->pdf[0]) / kSamples;
  }
  EXPECT_NEAR(reflected, 0.25, 1e-5);
}

/// Records the arguments that a nested BSDF receives.
class Recorder final : public Bsdf {
public:
  using Bsdf::Bsdf;
  BsdfEval eval_pdf(const Vec3& wi, const Vec3& wo, const BsdfContext& ctx) const override {
    seen = ctx.point.shading, seen_wi = wi, seen_wo = wo;
    return {1.f, 1.f};
  }
  std::optional<BsdfSample> sample(const Vec3&, float, Vec2, const BsdfContext&) const override { return {}; }
  Lobe lobes() const override { return Lobe::diffuse | Lobe::reflect; }

  mutable Frame seen;
  mutable Vec3 seen_wi, seen_wo;
};

struct Recorded {
  std::shared_ptr<Recorder> recorder;
  std::shared_ptr<const Bsdf> bsdf;
};
Recorded record(const std::string& type, const std::shared_ptr<Texture>& texture, bool fade = false,
                bool flip = true) {
  const auto context = make_context();
  Properties p(type, "", {}, context, Registry::instance().find("bsdf", type));
  Recorded r;
  r.recorder = std::make_shared<Recorder>(Properties("recorder", "", {}, context));
  p.add("", r.recorder, {});
  p.add("normalmap", texture, {});
  p.add("use_shadowing_function", fade, {});
  p.add("flip_invalid_normals", flip, {});
  r.bsdf = std::dynamic_pointer_cast<const Bsdf>(p.plugin()->create(p));
  return r;
}
std::shared_ptr<Texture> raw_picture(const std::string& name, const std::string& more = "") {
  return build<Texture>("<texture type=\"bitmap\"><string name=\"filename\" value=\"" + name +
                            "\"/><boolean name=\"raw\" value=\"true\"/>" + more + "</texture>",
                        make_context(), test::example_file);
}

void expect_near(const Vec3& a, const Vec3& b, double tolerance) {
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(a[i], b[i], tolerance) << i;
}
void expect_frame(const Frame& f, const Vec3& tangent) {
  EXPECT_NEAR(length(f.s), 1, 1e-5);
  EXPECT_NEAR(dot(f.s, f.n), 0, 1e-5);
  expect_near(cross(f.n, f.s), f.t, 1e-5);
  // s is the tangent as near as it can be.
  expect_near(f.s, normalize(tangent - f.n * dot(f.n, tangent)), 1e-4);
}

/// Points of a sphere that was scaled and turned, and of a mesh, by rays.
std::vector<SurfacePoint> points_of(const Shape& shape) {
  std::vector<SurfacePoint> points;
  const RTCDevice device = rtcNewDevice("threads=1");
  const RTCScene scene = rtcNewScene(device);
  const RTCGeometry geometry = shape.make_geometry(device);
  rtcAttachGeometry(scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(scene);
  SeededRandom random(11);
  for (int k = 0; k < 40; ++k) {
    const Vec3 from = square_to_uniform_sphere(random.next2()) * 10;
    const Ray ray{from, normalize(shape.bounds().center() - from)};
    RTCRayHit hit{};
    hit.ray.org_x = ray.o.x, hit.ray.org_y = ray.o.y, hit.ray.org_z = ray.o.z;
    hit.ray.dir_x = ray.d.x, hit.ray.dir_y = ray.d.y, hit.ray.dir_z = ray.d.z;
    hit.ray.tfar = kInfinity, hit.ray.mask = ~0u;
    hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(scene, &context, &hit);
    if (hit.hit.geomID == RTC_INVALID_GEOMETRY_ID) continue;
    points.push_back(shape.surface_point({0, hit.hit.primID, hit.hit.u, hit.hit.v, hit.ray.tfar}, ray));
  }
  rtcReleaseScene(scene);
  rtcReleaseDevice(device);
  return points;
}

const char* const kShapes[] = {
    R"(<shape type="sphere"><transform name="to_world"><scale value="1.7"/><rotate x="1" y="0.3" angle="50"/>
        <translate x="0.3"/></transform></shape>)",
    R"(<shape type="rectangle"><transform name="to_world"><scale x="2" y="0.7"/><rotate x="1" y="0.5" angle="70"/></transform></shape>)",
    R"(<shape type="rectangle"><boolean name="flip_normals" value="true"/></shape>)",
    R"(<shape type="cube"/>)"};

TEST(BumpMap, NormalIsThatOfTheDisplacedSurface) {
  int tested = 0;
  for (const char* xml : kShapes) {
    const auto shape = build<Asset>(xml)->shape();
    const auto height =
        raw_picture("heights.png",
                    R"(<transform name="to_uv"><rotate z="1" angle="20"/><scale x="2" y="1"/></transform>)");
    const auto [recorder, bump] = record("bumpmap", height);
    for (const SurfacePoint& point : points_of(*shape)) {
      const BsdfContext ctx{kFlat, point};
      const auto [dp_du, dp_dv] = shape->derivatives(point);
      const Vec2 slope = height->gradient(point);
      const Vec3 n = point.shading.n;
      Vec3 expected =
          normalize(cross(dp_du - n * dot(n, dp_du) + n * slope.x, dp_dv - n * dot(n, dp_dv) + n * slope.y));
      if (dot(expected, n) < 0) expected = -expected;
      const Vec3 wi{0, 0, 1}, wo = normalize(Vec3{0.1f, 0.2f, 1});
      bump->eval_pdf(wi, wo, ctx);
      expect_near(recorder->seen.n, expected, 1e-4);
      expect_frame(recorder->seen, point.shading.s);
      expect_near(recorder->seen.to_world(recorder->seen_wi), point.shading.to_world(wi), 1e-5);
      expect_near(recorder->seen.to_world(recorder->seen_wo), point.shading.to_world(wo), 1e-5);
      ++tested;
    }
  }
  EXPECT_GT(tested, 100);
}

TEST(NormalMap, NormalIsThatOfThePicture) {
  for (const char* xml : kShapes) {
    const auto shape = build<Asset>(xml)->shape();
    const auto picture = raw_picture("normals.png");
    const auto [recorder, map] = record("normalmap", picture);
    for (const SurfacePoint& point : points_of(*shape)) {
      map->eval_pdf({0, 0, 1}, {0, 0, 1}, {kFlat, point});
      const Vec3 local = normalize(picture->eval_rgb(point) * 2 - Vec3{1, 1, 1});
      expect_near(recorder->seen.n, point.shading.to_world(local), 1e-5);
      expect_frame(recorder->seen, point.shading.s);
    }
  }
}

/// As Mitsuba's formulas say, written anew for a white diffuse surface and one normal.
double expected_value(const Vec3& n, Vec3 wi, Vec3 wo, bool flip, bool fade) {
  Vec3 m = n;
  if (flip && wi.z * dot(wi, n) <= 0) m = {-n.x, -n.y, n.z};
  if (!(dot(m, wi) > 0 && dot(m, wo) > 0 && wi.z > 0 && wo.z > 0)) return 0;
  double value = double(dot(m, wo)) / M_PI;
  if (fade) {
    const auto tan2 = [](const Vec3& v) { return 1 / (double(v.z) * v.z) - 1; };
    value *= 2 / (1 + std::sqrt(1 + std::min(tan2(m) / 8, 1.0) * tan2(wo)));
  }
  return value;
}

TEST(NormalMap, ValuesOfADiffuseSurface) {
  const Square square;
  const auto picture = raw_picture("normals.png");
  SeededRandom random(8);
  int flipped = 0, lit = 0;
  for (const bool flip : {false, true})
    for (const bool fade : {false, true}) {
      const std::string choice =
          std::string("<boolean name=\"flip_invalid_normals\" value=\"") + (flip ? "true" : "false") +
          "\"/><boolean name=\"use_shadowing_function\" value=\"" + (fade ? "true" : "false") + "\"/>";
      const auto map = make(turned("normalmap", choice, kWhite));
      for (int k = 0; k < 500; ++k) {
        const SurfacePoint point = square.at(random.next2());
        const Vec3 n = normalize(picture->eval_rgb(point) * 2 - Vec3{1, 1, 1});
        const Vec3 wi = square_to_uniform_sphere(random.next2()),
                   wo = square_to_uniform_sphere(random.next2());
        const double expected = expected_value(n, wi, wo, flip, fade);
        const BsdfEval e = map->eval_pdf(wi, wo, {kFlat, point});
        EXPECT_NEAR(e.value[0], expected, 1e-5);
        flipped += wi.z * dot(wi, n) <= 0, lit += expected > 0;
        // Light paths: the same light, seen from the other end.
        const BsdfEval adjoint = map->eval_pdf(wo, wi, {kFlat, point, TransportMode::importance});
        EXPECT_NEAR(adjoint.value[0], expected * std::abs(wi.z / wo.z),
                    1e-4 * (1 + expected * std::abs(wi.z / wo.z)));
      }
    }
  EXPECT_GT(flipped, 50);
  EXPECT_GT(lit, 200);
}

TEST(NormalMap, FlatPicturesChangeNothing) {
  Image image;
  image.width = image.height = 2;
  image.channels = {"R", "G", "B"};
  for (int i = 0; i < 4; ++i) image.pixels.insert(image.pixels.end(), {0.5f, 0.5f, 1.f});
  // The vector zero is no normal; it counts as flat.
  for (int c = 0; c < 3; ++c) image.pixels[std::size_t(c)] = 0.5f;
  const auto file = std::filesystem::path(::testing::TempDir()) / "aureole_flat_normals.exr";
  write_exr(file, image, ExrPixel::float32, {});
  const auto resolve = [&](const std::string&) { return file; };
  const auto map = build<Bsdf>(turned("normalmap", "", twosided(bsdf("plastic"))), make_context(), resolve);
  const auto plain = make(twosided(bsdf("plastic")));
  const Square square;
  SeededRandom random(2);
  for (int k = 0; k < 200; ++k) {
    const SurfacePoint point = square.at(k % 2 ? Vec2{0.25f, 0.25f} : Vec2{0.75f, 0.75f});
    const Vec3 wi = square_to_uniform_sphere(random.next2()), wo = square_to_uniform_sphere(random.next2());
    for (const TransportMode mode : {TransportMode::radiance, TransportMode::importance}) {
      const BsdfContext ctx{kFlat, point, mode};
      const BsdfEval a = map->eval_pdf(wi, wo, ctx), b = plain->eval_pdf(wi, wo, ctx);
      EXPECT_NEAR(a.value[0], b.value[0], 1e-5);
      EXPECT_NEAR(a.pdf[0], b.pdf[0], 1e-5);
    }
  }
}

TEST(BumpMap, ConstantHeightsAndSurfacesWithoutCoordinatesAreFlat) {
  const Square square;
  const auto constant = record(
      "bumpmap", build<Texture>(R"(<spectrum type="uniform"><float name="value" value="0.7"/></spectrum>)"));
  SurfacePoint point = square.at({0.3f, 0.4f});
  constant.bsdf->eval_pdf({0, 0, 1}, {0, 0, 1}, {kFlat, point});
  expect_near(constant.recorder->seen.n, {0, 0, 1}, 0);

  class Degenerate final : public Shape {
  public:
    using Shape::Shape;
    RTCGeometry make_geometry(RTCDevice) const override { return nullptr; }
    SurfacePoint surface_point(const ShapeHit&, const Ray&, bool) const override { return {}; }
    SurfaceDerivatives own_derivatives(const SurfacePoint&) const override { return {}; }
    Bounds3 bounds() const override { return {}; }
    std::size_t primitive_count() const override { return 1; }
    std::shared_ptr<const AreaSampler> make_area_sampler(AreaUse) const override { return nullptr; }
  };
  const Degenerate shape(Properties("degenerate", "", {}, make_context()));
  point.shape = &shape;
  const auto bump = record("bumpmap", raw_picture("heights.png"));
  bump.bsdf->eval_pdf({0, 0, 1}, {0, 0, 1}, {kFlat, point});
  expect_near(bump.recorder->seen.n, {0, 0, 1}, 0);
}

/// Light that passes as if nothing were there is not deflected, faded or lost at a horizon.
TEST(TurnedFrames, LetLightPass) {
  const Square square;
  SeededRandom random(4);
  for (const char* type : {"bumpmap", "normalmap"}) {
    const auto b = make(turned(type, "", mask(0.3, twosided(kWhite))));
    EXPECT_TRUE(b->is_passable());
    for (const TransportMode mode : {TransportMode::radiance, TransportMode::importance})
      for (int k = 0; k < 300; ++k) {
        const SurfacePoint point = square.at(random.next2());
        const BsdfContext ctx{kFlat, point, mode};
        const Vec3 wi = square_to_uniform_sphere(random.next2());
        EXPECT_FLOAT_EQ(b->null_transmittance(wi, ctx)[0], 0.7f);
        int passed = 0;
        constexpr int kSamples = 64;
        for (int i = 0; i < kSamples; ++i)
          if (const auto s = b->sample(wi, (float(i) + 0.5f) / kSamples, random.next2(), ctx);
              s && has(s->lobe, Lobe::null)) {
            ++passed;
            expect_near(s->wo, -wi, 0);
            EXPECT_FLOAT_EQ(s->value[0], 0.7f);
            EXPECT_FLOAT_EQ(s->pdf[0], 0.7f);
          }
        EXPECT_NEAR(double(passed) / kSamples, 0.7, 2.0 / kSamples);
      }
  }
}

TEST(Adapters, WrongInputIsLocated) {
  const auto error = [](const std::string& xml) { return message_of([&] { make(xml); }); };
  const auto says = [&](const std::string& xml, const std::string& text) {
    const std::string message = error(xml);
    EXPECT_NE(message.find(text), std::string::npos) << xml << "\n" << message;
    EXPECT_EQ(message.rfind("snippet:1:", 0), 0u) << message;
  };
  says(mask(1.2, kWhite), "must lie in [0, 1], but is 1.2");
  says(mask(-0.1, kWhite), "negative");
  says(bsdf("mask", number("opacity", 0.5)), "needs one nested BSDF, got 0");
  says(bsdf("mask", kWhite + kMirror), "needs one nested BSDF, got 2");
  says(bsdf("blendbsdf", kWhite + kMirror), "needs the parameter \"weight\"");
  says(bsdf("blendbsdf", number("weight", 0.5) + kWhite), "needs two nested BSDFs, got 1");
  says(blend(7, kWhite, kWhite), "must lie in [0, 1]");
  says(bsdf("bumpmap", kWhite), "needs one nested texture, got 0");
  says(bsdf("bumpmap", kWhite + R"(<texture type="d65"><texture type="checkerboard"/></texture>)"),
       "no gradient");
  says(bsdf("normalmap", kWhite), "needs a texture with the name \"normalmap\"");
  says(bsdf("normalmap", kWhite + R"(<texture name="normalmap" type="checkerboard"/>)"), "\"raw\"");
  says(bsdf("normalmap",
            kWhite + R"(<texture name="normalmap" type="bitmap"><string name="filename" value="normals.png"/>
      </texture>)"),
       "\"raw\"");
  says(bsdf("twosided", kFlint), "two sides already");
  EXPECT_EQ(error(twosided(mask(0.5, kWhite))), "");
}

}  // namespace
}  // namespace aureole::testing

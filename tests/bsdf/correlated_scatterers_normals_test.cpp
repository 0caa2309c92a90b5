// SPDX-License-Identifier: Apache-2.0
// Layers without circular symmetry under normal and bump maps: s of the turned frame lies along dp/du as far
// as the turned normal lets it, so that the pattern turns with the normal and with uv. Frames are made anew
// here, in double precision, from the mesh's corners and uv.
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>
#include <span>

#include "aureole/asset/asset.h"
#include "aureole/core/image.h"
#include "aureole/texture/texture.h"
#include "bsdf/bsdf_test_support.h"
#include "harness/effort.h"
#include "harness/properties_builder.h"

namespace aureole::testing {
namespace {

struct Double3 {
  double x, y, z;
  Double3 operator+(const Double3& b) const { return {x + b.x, y + b.y, z + b.z}; }
  Double3 operator-(const Double3& b) const { return {x - b.x, y - b.y, z - b.z}; }
  Double3 operator*(double f) const { return {x * f, y * f, z * f}; }
};
double inner(const Double3& a, const Double3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
Double3 outer(const Double3& a, const Double3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
Double3 unit(const Double3& a) { return a * (1 / std::sqrt(inner(a, a))); }
Double3 to_double(const Vec3& v) { return {double(v.x), double(v.y), double(v.z)}; }
Vec3 to_float(const Double3& v) { return {float(v.x), float(v.y), float(v.z)}; }

struct DoubleFrame {
  Double3 s, t, n;
  /// Gram-Schmidt of `tangent` against the unit normal.
  static DoubleFrame around(const Double3& n, const Double3& tangent) {
    const Double3 s = unit(tangent - n * inner(n, tangent));
    return {s, outer(n, s), n};
  }
  Vec3 to_local(const Double3& v) const { return to_float({inner(v, s), inner(v, t), inner(v, n)}); }
  Double3 to_world(const Double3& v) const { return s * v.x + t * v.y + n * v.z; }
};

std::filesystem::path temporary(const std::string& name) {
  return std::filesystem::path(::testing::TempDir()) / (std::to_string(getpid()) + "_" + name);
}

// A unit square somewhere in the world, and uv = M (a, b) over its sides.
const Double3 kSide = unit({0.8, -0.3, 0.4});
const Double3 kUp = unit(outer({0.2, 0.5, 0.9}, kSide));
using Matrix = std::array<double, 4>;
Matrix turn(double degrees, double scale, double mirror = 1) {
  const double c = scale * std::cos(degrees * kPiDouble / 180),
               s = scale * std::sin(degrees * kPiDouble / 180);
  return {c, -s * mirror, s, c * mirror};
}
const Matrix kUvs[] = {turn(0, 1),     turn(37, 0.6),   turn(110, 2),         turn(200, 1),
                       turn(300, 0.3), turn(25, 1, -1), {0.7, 0.5, -0.1, 0.4}};

struct Square {
  Double3 dp_du, dp_dv;
  std::shared_ptr<const Shape> shape;

  explicit Square(const Matrix& m) {
    const double determinant = m[0] * m[3] - m[1] * m[2];
    dp_du = (kSide * m[3] - kUp * m[2]) * (1 / determinant);
    dp_dv = (kUp * m[0] - kSide * m[1]) * (1 / determinant);
    std::ofstream out(temporary("square.obj"));
    out.precision(9);
    for (const auto& [a, b] : {std::pair{0., 0.}, {1., 0.}, {1., 1.}, {0., 1.}}) {
      const Double3 p = kSide * a + kUp * b;
      out << "v " << p.x << " " << p.y << " " << p.z << "\nvt " << m[0] * a + m[1] * b << " "
          << m[2] * a + m[3] * b << "\n";
    }
    out << "f 1/1 2/2 3/3\nf 1/1 3/3 4/4\n";
    out.close();
    // Any map asks for the tangent, which the default BSDF would not.
    shape =
        build<Asset>(
            R"(<shape type="obj"><string name="filename" value="square.obj"/><boolean name="flip_tex_coords" value="false"/><bsdf type="normalmap"><texture
           name="normalmap" type="bitmap"><string name="filename" value="tilts.exr"/><boolean name="raw"
           value="true"/></texture><bsdf type="diffuse"/></bsdf></shape>)",
            make_context(), temporary)
            ->shape();
  }
};

/// Normals tilted about x, about y and about both, by up to 40 degrees; a bumpy height.
void write_pictures() {
  Image image;
  image.width = image.height = 4;
  image.channels = {"R", "G", "B"};
  for (int i = 0; i < 16; ++i) {
    const double tilt = (i % 4 * 13 + 1) * kPiDouble / 180,
                 angle = i / 4 * 0.5 * kPiDouble + (i % 3 == 2 ? 0.6 : 0);
    const double n[] = {std::sin(tilt) * std::cos(angle), std::sin(tilt) * std::sin(angle), std::cos(tilt)};
    for (const double c : n) image.pixels.push_back(float((c + 1) / 2));
  }
  write_exr(temporary("tilts.exr"), image, ExrPixel::float32, {});
  Image heights;
  heights.width = heights.height = 8;
  heights.channels = {"Y"};
  std::mt19937 random(4);
  for (int i = 0; i < 64; ++i) heights.pixels.push_back(float(random() % 1000) / 8000);
  write_exr(temporary("heights.exr"), heights, ExrPixel::float32, {});
}

const char* const kTilts =
    R"(<texture name="normalmap" type="bitmap"><string name="filename" value="tilts.exr"/><string name="filter_type" value="nearest"/><boolean name="raw" value="true"/></texture>)";
const char* const kHeights =
    R"(<texture name="height" type="bitmap"><string name="filename" value="heights.exr"/><boolean name="raw" value="true"/></texture>)";
const char* const kPlain =
    R"(<boolean name="flip_invalid_normals" value="false"/><boolean name="use_shadowing_function" value="false"/>)";

const char* const kLayers[] = {
    R"(<bsdf type="correlated_scatterers"><aperture type="rectangle"><string name="width" value="3um"/><string name="height" value="1um"/></aperture>
       <float name="area_fraction" value="0.4"/></bsdf>)",
    R"(<bsdf type="correlated_scatterers"><aperture type="ellipse"><string name="radius_x" value="2um"/><string name="radius_y" value="0.7um"/></aperture>
       <float name="area_fraction" value="0.3"/><float name="rotation" value="35"/><string name="substrate" value="thindielectric"/></bsdf>)",
    R"(<bsdf type="correlated_scatterers"><string name="radius" value="2um"/><float name="area_fraction" value="0.5"/>
       <correlation type="percus_yevick"><float name="stretch" value="2"/></correlation></bsdf>)"};

struct Difference {
  double worst = 0, other = 0, sum = 0;
  int values = 0, other_densities = 0;
};

/// Values and densities of the map against those of the layer in the frame of this file, for light within 50
/// degrees of the turned normal that leaves within the layer's lobe; `other`: of the same directions in a
/// frame with any s.
template <class Normal>
void compare(const Bsdf& map, const Bsdf& layer, const Square& square, Normal&& turned_normal,
             Difference& d) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> uniform(0, 1);
  Setting setting;
  for (int k = 0; k < 1500; ++k) {
    const float root = std::sqrt(uniform(random)), along = uniform(random);
    const ShapeHit hit{0, std::uint32_t(k % 2), root * (1 - along), root * along, 1};
    setting.point = square.shape->surface_point(hit, Ray{});
    const Double3 m = turned_normal(setting.point);
    const DoubleFrame frame = DoubleFrame::around(m, square.dp_du);
    const double theta = 50 * kPiDouble / 180 * double(uniform(random)),
                 phi = 2 * kPiDouble * double(uniform(random));
    Vec3 wi_t = direction(theta, phi);
    if (k % 3 == 0) wi_t.z = -wi_t.z;
    const BsdfContext ctx = setting.context();
    const auto s = layer.sample(wi_t, uniform(random), {uniform(random), uniform(random)}, ctx);
    if (!s || s->is_delta()) continue;
    const auto surface = [&](const Vec3& w) {
      return setting.point.shading.to_local(to_float(frame.to_world(to_double(w))));
    };
    const Vec3 wi = surface(wi_t), wo = surface(s->wo);
    // Other light is on different sides of the two horizons: black, which other tests look at.
    if (!(wi.z * wi_t.z > 0.01f && wo.z * s->wo.z > 0.01f)) continue;
    const BsdfEval expected = layer.eval_pdf(wi_t, s->wo, ctx), got = map.eval_pdf(wi, wo, ctx);
    const Frame any = Frame::from_normal(to_float(m));
    const BsdfEval other = layer.eval_pdf(any.to_local(to_float(frame.to_world(to_double(wi_t)))),
                                          any.to_local(to_float(frame.to_world(to_double(s->wo)))), ctx);
    EXPECT_EQ(map.eval(wi, wo, ctx)[0], got.value[0]);
    for (int j = 0; j < kWavelengths; ++j) {
      const double e = double(expected.value[j]);
      // Single precision moves a direction by 1e-7, times k a: next to nothing but at the zeros of J.
      EXPECT_NEAR(double(got.value[j]), e, 1e-3 * e + 1e-3) << k;
      // Densities are constant over small bins, and jump where such a distance crosses the end of one.
      if (j == 0)
        d.other_densities += !(std::abs(double(got.pdf[j]) - double(expected.pdf[j])) <=
                               1e-3 * double(expected.pdf[j]) + 1e-3);
      d.worst = std::max(d.worst, std::abs(double(got.value[j]) - e) / (e + 1));
      d.other += std::abs(double(other.value[j]) - e), d.sum += e;
    }
    ++d.values;
    // Samples of the map have the same values.
    const auto sampled = map.sample(wi, uniform(random), {uniform(random), uniform(random)}, ctx);
    if (!sampled || sampled->is_delta()) continue;
    const Double3 world = to_double(setting.point.shading.to_world(sampled->wo));
    const BsdfEval direct = layer.eval_pdf(wi_t, frame.to_local(world), ctx);
    for (int j = 0; j < kWavelengths; ++j)
      EXPECT_NEAR(double(sampled->value[j]), double(direct.value[j]), 1e-3 * double(direct.value[j]) + 1e-3);
  }
}

/// Of so many kinds of layers.
template <class MakeNormal>
void check(const std::string& type, const std::string& texture, int layers, MakeNormal&& make_normal) {
  write_pictures();
  const auto picture = build<Texture>(texture, make_context(), temporary);
  for (const char* xml : std::span(kLayers).first(std::size_t(layers))) {
    const auto layer = build<Bsdf>(xml);
    const auto map = build<Bsdf>("<bsdf type=\"" + type + "\">" + texture + kPlain + xml + "</bsdf>",
                                 make_context(), temporary);
    Difference d;
    for (const Matrix& uv : kUvs) {
      const Square square(uv);
      compare(
          *map, *layer, square, [&](const SurfacePoint& p) { return make_normal(*picture, square, p); }, d);
    }
    std::printf(
        "%s, %d pairs of directions: largest difference %.1e; with any other s %.0f %% of the light\n",
        type.c_str(), d.values, d.worst, 100 * d.other / d.sum);
    EXPECT_GT(d.values, 900);
    EXPECT_LT(d.other_densities, d.values / 100);
    EXPECT_GT(d.other, 0.2 * d.sum) << "the test does not test";
  }
  for (const char* name : {"square.obj", "tilts.exr", "heights.exr"})
    std::filesystem::remove(temporary(name));
}

TEST(CorrelatedScatterersNormals, NormalMapsTurnThePattern) {
  check("normalmap", kTilts, int(std::size(kLayers)),
        [](const Texture& picture, const Square& square, const SurfacePoint& point) {
          const DoubleFrame surface = DoubleFrame::around(unit(outer(kSide, kUp)), square.dp_du);
          return surface.to_world(unit(to_double(picture.eval_rgb(point)) * 2 - Double3{1, 1, 1}));
        });
}

TEST(CorrelatedScatterersNormals, BumpMapsTurnThePattern) {
  double steepest = 1;
  // Their tables take most of the time: that of the third kind is seen behind normal maps.
  check("bumpmap", kHeights, test::effort(2, 3),
        [&](const Texture& height, const Square& square, const SurfacePoint& point) {
          const Double3 n = unit(outer(kSide, kUp));
          const Vec2 slope = height.gradient(point);
          const Double3 m =
              unit(outer(square.dp_du + n * double(slope.x), square.dp_dv + n * double(slope.y)));
          steepest = std::min(steepest, std::abs(inner(m, n)));
          return inner(m, n) > 0 ? m : m * -1.0;
        });
  EXPECT_LT(steepest, 0.8);
}

}  // namespace
}  // namespace aureole::testing

// SPDX-License-Identifier: Apache-2.0
// What every emitter has to fulfil: its samples, densities, radiance, power and bounds agree with each other
// and with quadrature. The geometry of the references (ray against rectangle, sphere, triangle) is written
// here anew.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <set>

#include "aureole/core/image.h"
#include "aureole/math/warp.h"
#include "aureole/plugin/registry.h"
#include "aureole/scene/scene.h"
#include "tests/harness/statistics.h"

namespace aureole::testing {
namespace {

/// A folder of its own for every test, whose names hold slashes, removed at its end.
class TemporaryFolder {
public:
  TemporaryFolder() {
    std::string name = ::testing::UnitTest::GetInstance()->current_test_info()->name();
    std::replace(name.begin(), name.end(), '/', '-');
    path = std::filesystem::temp_directory_path() /
           ("aureole-emitter-" + name + "-" + std::to_string(::getpid()));
    std::filesystem::create_directories(path);
  }
  ~TemporaryFolder() { std::filesystem::remove_all(path); }
  std::filesystem::path path;
};

/// Geometry of an emitter on a shape, without the renderer: the nearest front-facing hit of a ray.
struct Hit {
  double t = 0;
  Vec3 normal;
  Vec2 uv;
};
using Geometry = std::function<std::optional<Hit>(const Vec3& o, const Vec3& d)>;

struct D3 {
  double x, y, z;
};
D3 d3(const Vec3& v) { return {double(v.x), double(v.y), double(v.z)}; }
D3 sub(const D3& a, const D3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
D3 cross3(const D3& a, const D3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
double dot3(const D3& a, const D3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

std::optional<Hit> hit_triangle(const Vec3 p[3], const Vec3& o, const Vec3& d) {
  // Cramer's rule for o + t d = p0 + b1 e1 + b2 e2.
  const D3 e1 = sub(d3(p[1]), d3(p[0])), e2 = sub(d3(p[2]), d3(p[0])), r = sub(d3(o), d3(p[0])),
           n = cross3(e1, e2);
  const double det = -dot3(d3(d), n);
  if (!(det > 0)) return {};  // from behind
  const D3 q = cross3(r, d3(d));
  const double t = dot3(r, n) / det, b1 = dot3(e2, q) / det, b2 = -dot3(e1, q) / det;
  if (t <= 0 || b1 < 0 || b2 < 0 || b1 + b2 > 1) return {};
  const double l = std::sqrt(dot3(n, n));
  return Hit{t, {float(n.x / l), float(n.y / l), float(n.z / l)}, {}};
}

struct Case {
  std::string name;
  std::string xml;     ///< the emitter, on its shape if it has one
  Geometry geometry;   ///< empty: at infinity or a point
  double area = 0;     ///< of the shape
  bool by_uv = false;  ///< radiance depends on uv
  std::vector<Vec3> references = {{0.3f, -0.2f, 0.1f}, {-1.5f, 0.7f, 0.4f}, {4, 3, -1}, {0.9f, 0.1f, 1.4f}};
};

std::string scene_with(const std::string& xml) {
  // The small far sphere gives the scene bounds.
  return R"(<scene version="3.0.0"><integrator type="path"/><sensor type="perspective"><film type="hdrfilm"/></sensor>
<shape type="sphere"><float name="radius" value="0.01"/><point name="center" x="0" y="0" z="-50"/></shape>)" +
         xml + "</scene>";
}

const std::string kRed = R"(<emitter type="area"><rgb name="radiance" value="3, 1, 0.5"/></emitter>)";
const std::string kTextured =
    R"(<emitter type="area"><texture name="radiance" type="checkerboard"><rgb name="color0" value="1, 1, 1"/>
  <rgb name="color1" value="0.2, 0.4, 0.1"/><transform name="to_uv"><scale x="4" y="2"/></transform></texture></emitter>)";

std::optional<Hit> hit_rectangle(const Vec3& o, const Vec3& d) {
  // scale (0.8, 0.5), turned by 180 degrees about x, at z = 2: normal -z.
  if (!(d.z > 0)) return {};
  const double t = (2 - double(o.z)) / d.z, x = o.x + t * d.x, y = o.y + t * d.y;
  if (t <= 0 || std::abs(x) > 0.8 || std::abs(y) > 0.5) return {};
  return Hit{t, {0, 0, -1}, {float(x / 1.6 + 0.5), float(0.5 - y)}};
}
const std::string kRectangle = R"(<shape type="rectangle"><transform name="to_world"><scale x="0.8" y="0.5"/>
  <rotate x="1" angle="180"/><translate z="2"/></transform>)";

std::optional<Hit> hit_ball(const Vec3& o, const Vec3& d, bool inside) {
  const D3 c = sub(d3(o), {0.5, 0.25, 2.5});
  const double b = dot3(c, d3(d)), q = b * b - dot3(c, c) + 0.75 * 0.75;
  if (q < 0) return {};
  const double t = inside ? -b + std::sqrt(q) : -b - std::sqrt(q);
  if (t <= 0) return {};
  const Vec3 n{float((c.x + t * d.x) / 0.75), float((c.y + t * d.y) / 0.75), float((c.z + t * d.z) / 0.75)};
  return Hit{t, inside ? -n : n, {}};
}
const std::string kSphere =
    R"(<shape type="sphere"><float name="radius" value="0.75"/><point name="center" x="0.5" y="0.25" z="2.5"/>)";

std::optional<Hit> hit_disc(const Vec3& o, const Vec3& d) {
  // radius 0.9, turned by 180 degrees about x, at z = 2: normal -z, so that the azimuth runs the other way.
  if (!(d.z > 0)) return {};
  const double t = (2 - double(o.z)) / d.z, x = (o.x + t * d.x) / 0.9, y = -(o.y + t * d.y) / 0.9;
  const double r = std::sqrt(x * x + y * y), v = std::atan2(y, x) / (2 * M_PI);
  if (t <= 0 || r > 1) return {};
  return Hit{t, {0, 0, -1}, {float(r), float(v < 0 ? v + 1 : v)}};
}
const std::string kDisc = R"(<shape type="disk"><transform name="to_world"><scale value="0.9"/>
  <rotate x="1" angle="180"/><translate z="2"/></transform>)";

/// The cylinder of radius 0.4 from (0.2, -1, 2) to (0.2, 1.5, 2).
std::optional<Hit> hit_tube(const Vec3& o, const Vec3& d, bool inside) {
  const double ox = o.x - 0.2, oz = o.z - 2.0, a = d.x * d.x + d.z * d.z, b = ox * d.x + oz * d.z,
               q = b * b - a * (ox * ox + oz * oz - 0.16);
  if (q < 0 || a == 0) return {};
  // Of the two points the first that is on the tube, which may be seen from behind.
  for (const double t : {(-b - std::sqrt(q)) / a, (-b + std::sqrt(q)) / a}) {
    const double y = o.y + t * d.y;
    if (t <= 0 || y < -1 || y > 1.5) continue;
    Vec3 n{float((ox + t * d.x) / 0.4), 0, float((oz + t * d.z) / 0.4)};
    if (inside) n = -n;
    if (n.x * d.x + n.z * d.z > 0) return {};
    double u = std::atan2(-(oz + t * d.z), ox + t * d.x) / (2 * M_PI);
    if (u < 0) u += 1;
    return Hit{t, n, {float(u), float((y + 1) / 2.5)}};
  }
  return {};
}
const std::string kTube = R"(<shape type="cylinder"><point name="p0" x="0.2" y="-1" z="2"/>
  <point name="p1" x="0.2" y="1.5" z="2"/><float name="radius" value="0.4"/>)";

/// A tetrahedron without its base, so that parts are triangles that face many ways.
const Vec3 kCorners[4] = {{-0.6f, -0.5f, 1.5f}, {0.8f, -0.4f, 1.7f}, {0.1f, 0.9f, 1.6f}, {0.2f, 0.1f, 2.6f}};
const int kFaces[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
std::string tetrahedron_obj() {
  std::string text;
  for (const Vec3& c : kCorners)
    text += "v " + std::to_string(c.x) + " " + std::to_string(c.y) + " " + std::to_string(c.z) + "\n";
  for (const auto& f : kFaces)
    text += "f " + std::to_string(f[0] + 1) + " " + std::to_string(f[1] + 1) + " " +
            std::to_string(f[2] + 1) + "\n";
  return text;
}
std::optional<Hit> hit_tetrahedron(const Vec3& o, const Vec3& d) {
  std::optional<Hit> nearest;
  for (const auto& f : kFaces) {
    const Vec3 p[3] = {kCorners[f[0]], kCorners[f[1]], kCorners[f[2]]};
    const auto h = hit_triangle(p, o, d);  // convex: at most one face is seen from outside
    if (h && (!nearest || h->t < nearest->t)) nearest = h;
  }
  return nearest;
}
double tetrahedron_area() {
  double sum = 0;
  for (const auto& f : kFaces) {
    const D3 n =
        cross3(sub(d3(kCorners[f[1]]), d3(kCorners[f[0]])), sub(d3(kCorners[f[2]]), d3(kCorners[f[0]])));
    sum += std::sqrt(dot3(n, n)) / 2;
  }
  return sum;
}

/// A sky with one pixel far brighter than the rest.
void write_sky(const std::filesystem::path& file) {
  Image sky;
  sky.width = 16, sky.height = 9;
  sky.channels = {"R", "G", "B"};
  sky.pixels.resize(16 * 9 * 3);
  for (int y = 0; y < 9; ++y)
    for (int x = 0; x < 16; ++x)
      for (std::size_t c = 0; c < 3; ++c)
        sky.at(x, y, c) = y < 5 ? 0.2f + 0.1f * float(c) + 0.02f * float(x) : x < 8 ? 0.f : 0.05f;
  for (std::size_t c = 0; c < 3; ++c) sky.at(11, 2, c) = 300.f - 50.f * float(c);
  write_exr(file, sky, ExrPixel::float32, {});
}

std::vector<Case> cases() {
  std::vector<Case> all;
  all.push_back({"area_rectangle", kRectangle + kRed + "</shape>", hit_rectangle, 1.6});
  all.push_back({"area_rectangle_texture", kRectangle + kTextured + "</shape>", hit_rectangle, 1.6, true});
  all.push_back({"area_sphere", kSphere + kRed + "</shape>",
                 [](auto& o, auto& d) { return hit_ball(o, d, false); }, 4 * M_PI * 0.75 * 0.75});
  Case inside{"area_sphere_inside",
              kSphere + R"(<boolean name="flip_normals" value="true"/>)" + kRed + "</shape>",
              [](auto& o, auto& d) { return hit_ball(o, d, true); }, 4 * M_PI * 0.75 * 0.75};
  inside.references = {{0.5f, 0.25f, 2.5f}, {0.7f, 0.6f, 2.3f}, {0.5f, 0.25f, 3.2f}};
  all.push_back(inside);
  all.push_back({"area_disk", kDisc + kRed + "</shape>", hit_disc, M_PI * 0.81});
  all.back().references.push_back({0.2f, 0.1f, 1.95f});
  all.push_back({"area_disk_texture", kDisc + kTextured + "</shape>", hit_disc, M_PI * 0.81});
  all.push_back({"area_cylinder", kTube + kRed + "</shape>",
                 [](auto& o, auto& d) { return hit_tube(o, d, false); }, 2 * M_PI * 0.4 * 2.5});
  all.push_back({"area_cylinder_texture", kTube + kTextured + "</shape>",
                 [](auto& o, auto& d) { return hit_tube(o, d, false); }, 2 * M_PI * 0.4 * 2.5, true});
  Case tube{"area_cylinder_inside",
            kTube + R"(<boolean name="flip_normals" value="true"/>)" + kRed + "</shape>",
            [](auto& o, auto& d) { return hit_tube(o, d, true); }, 2 * M_PI * 0.4 * 2.5};
  tube.references = {{0.2f, 0, 2}, {0.5f, 1.2f, 2.1f}, {0.1f, -0.9f, 1.8f}};
  all.push_back(tube);
  all.push_back(
      {"area_mesh",
       "<shape type=\"obj\"><string name=\"filename\" value=\"tetrahedron.obj\"/>" + kRed + "</shape>",
       hit_tetrahedron, tetrahedron_area()});
  all.push_back(
      {"constant", R"(<emitter type="constant"><rgb name="radiance" value="0.5, 0.7, 1"/></emitter>)", {}});
  const std::string sky =
      R"(<emitter type="envmap"><string name="filename" value="sky.exr"/><float name="scale" value="0.7"/>
    <transform name="to_world"><rotate x="1" angle="90"/><rotate z="1" angle="25"/></transform>)";
  all.push_back({"envmap", sky + "</emitter>", {}});
  all.push_back(
      {"envmap_compensated", sky + R"(<boolean name="mis_compensation" value="true"/></emitter>)", {}});
  all.push_back({"point",
                 R"(<emitter type="point"><point name="position" x="0.4" y="0.1" z="2"/>
    <rgb name="intensity" value="4, 5, 6"/></emitter>)",
                 {}});
  return all;
}

class EmitterHarness : public ::testing::TestWithParam<std::size_t> {
protected:
  EmitterHarness() : case_(cases()[GetParam()]) {
    std::ofstream(folder_.path / "tetrahedron.obj") << tetrahedron_obj();
    write_sky(folder_.path / "sky.exr");
    scene_ =
        std::make_unique<Scene>(load_scene_from_string(scene_with(case_.xml), folder_.path / "test.xml"));
    emitter_ = scene_->emitters().at(0);
    const SpectralGrid grid = scene_->loaded().context->grid;
    w_ = Wavelengths::at(grid,
                         make_spectrum([&](int i) { return 415.3f + 33.7f * float(i) * 8 / kWavelengths; }));
  }
  bool is_point() const { return case_.name == "point"; }

  /// Radiance arriving at `o` from the direction `d` and the density that goes with it, by the reference's
  /// geometry.
  std::optional<SurfacePoint> surface(const Vec3& o, const Vec3& d) const {
    const auto h = case_.geometry(o, d);
    if (!h) return {};
    // The renderer's own point there, for the patch it belongs to.
    const auto point = scene_->intersect({o, d, kInfinity});
    if (!point || point->shape->emitter() != emitter_) return {};
    return point;
  }
  Spectrum radiance(const Vec3& o, const Vec3& d) const {
    if (emitter_->is_infinite()) return emitter_->eval_escaped(d, w_);
    const auto h = case_.geometry(o, d);
    if (!h) return 0.f;
    SurfacePoint p;
    p.p = o + d * float(h->t), p.ng = h->normal, p.uv = h->uv;
    return emitter_->eval(p, -d, w_);
  }
  double density(const Vec3& o, const Vec3& d) const {
    if (emitter_->is_infinite()) return emitter_->pdf_direct_escaped(o, d);
    const auto p = surface(o, d);
    return p ? emitter_->pdf_direct(o, *p) : 0;
  }
  /// Directions over the sphere that follow each other closely: a lattice of Fibonacci.
  static Vec3 lattice(int k, int n) {
    const double z = 1 - (2 * k + 1.0) / n, phi = 2 * M_PI * k * 0.61803398874989485,
                 r = std::sqrt(1 - z * z);
    return {float(r * std::cos(phi)), float(r * std::sin(phi)), float(z)};
  }
  static constexpr int kDirections = 400000;

  TemporaryFolder folder_;
  Case case_;
  std::unique_ptr<Scene> scene_;
  const Emitter* emitter_ = nullptr;
  Wavelengths w_;
};

TEST_P(EmitterHarness, IrradianceAgreesWithUniformDirections) {
  TestRandom random(1);
  for (const Vec3& o : case_.references)
    for (const Vec3& n : {Vec3{0, 0, 1}, normalize(Vec3{1, 0.5f, 0.3f})}) {
      double expected[2] = {};
      int lit = 0;
      if (is_point()) {
        const D3 to = sub({0.4, 0.1, 2}, d3(o));
        const double r = std::sqrt(dot3(to, to)), cosine = std::abs(dot3(to, d3(n))) / r;
        // Intensity as the emitter states it at distance 1.
        const auto unit = emitter_->sample_direct({0.4f, 0.1f, 1}, 0, {}, w_);
        for (int j = 0; j < 2; ++j)
          expected[j] = double(unit->radiance[7 * j * kWavelengths / 8]) * cosine / (r * r);
      } else {
        for (int k = 0; k < kDirections; ++k) {
          const Vec3 d = lattice(k, kDirections);
          const Spectrum l = radiance(o, d);
          lit += !is_black(l);
          for (int j = 0; j < 2; ++j)
            expected[j] += double(l[7 * j * kWavelengths / 8]) * std::abs(dot(d, n)) * 4 * M_PI / kDirections;
        }
      }
      double sum[2] = {}, squares[2] = {};
      const int samples = 20000;
      for (int k = 0; k < samples; ++k) {
        double x[2] = {};
        for (std::size_t part = 0; part < emitter_->part_count(); ++part)
          if (const auto s = emitter_->sample_direct(o, part, random.next2(), w_))
            for (int j = 0; j < 2; ++j)
              x[j] +=
                  double(s->radiance[7 * j * kWavelengths / 8]) * std::abs(dot(s->wo, n)) / double(s->pdf);
        for (int j = 0; j < 2; ++j) sum[j] += x[j], squares[j] += x[j] * x[j];
      }
      // How well the lattice measures a solid angle: its points along the edges count or not.
      const double slack = 2e-3 + (case_.geometry ? 0.5 / std::sqrt(lit + 1.0) : 0);
      // MIS compensation leaves part of the sphere to other techniques: less than all, on purpose.
      for (int j = 0; j < 2; ++j) {
        const double mean = sum[j] / samples;
        const double sigma = std::sqrt(std::max(0.0, squares[j] / samples - mean * mean) / samples);
        if (case_.name == "envmap_compensated")
          EXPECT_LT(mean, expected[j] + 4 * sigma);
        else
          EXPECT_NEAR(mean, expected[j], 4.5 * sigma + slack * expected[j] + 1e-9) << o.x << " " << j;
      }
    }
}

TEST_P(EmitterHarness, SamplesAgreeWithEvalAndDensity) {
  TestRandom random(2);
  int disagree = 0, count = 0;
  for (const Vec3& o : case_.references)
    for (std::size_t part = 0; part < emitter_->part_count(); ++part)
      for (int k = 0; k < 2000; ++k) {
        const Vec2 u = k == 0   ? Vec2{0, 0}
                       : k == 1 ? Vec2{kOneMinusEpsilon, kOneMinusEpsilon}
                                : random.next2();
        const auto s = emitter_->sample_direct(o, part, u, w_);
        if (!s) continue;
        ASSERT_NEAR(length(s->wo), 1, 1e-5);
        ASSERT_TRUE(is_valid_radiance(s->radiance));
        ASSERT_GT(s->pdf, 0);
        ASSERT_EQ(s->infinite, emitter_->is_infinite());
        ASSERT_EQ(s->delta, is_point());
        if (!s->infinite) {
          ASSERT_LT(length(normalize(s->p - o) - s->wo), 1e-4f);
        }
        if (s->delta) {
          ASSERT_EQ(s->pdf, 1);
          continue;
        }
        ++count;
        const double d = density(o, s->wo);
        const Spectrum l = radiance(o, s->wo);
        // Rounding may push a direction off an edge or onto a texture's other field.
        bool same = std::abs(d - double(s->pdf)) <= 2e-3 * double(s->pdf);
        for (int j = 0; j < kWavelengths; ++j)
          same &= std::abs(l[j] - s->radiance[j]) <= 2e-3f * s->radiance[j] + 1e-6f;
        disagree += !same;
        if (!s->infinite) {
          ASSERT_LT(dot(s->ng, s->wo), 0);
          SurfacePoint p;
          p.p = s->p, p.ng = s->ng;
          const EmissionBounds b = emitter_->emission_bounds(part);
          for (int i = 0; i < 3; ++i) {
            ASSERT_GE(s->p[i], b.box.lower[i] - 1e-5f);
            ASSERT_LE(s->p[i], b.box.upper[i] + 1e-5f);
          }
          ASSERT_GE(dot(s->ng, b.axis), b.cos_normals - 1e-5f);
        }
      }
  if (!is_point()) {
    EXPECT_GT(count, 1000);
  }
  EXPECT_LE(disagree, 1 + count / 500);
  RecordProperty("disagree", disagree);
}

TEST_P(EmitterHarness, DensityIntegratesToOnePerVisiblePart) {
  if (is_point()) {
    EXPECT_EQ(emitter_->pdf_direct({0, 0, 0}, {}), 0);
    return;
  }
  for (const Vec3& o : case_.references) {
    std::vector<double> mass(emitter_->part_count());
    std::vector<int> hits(emitter_->part_count());
    for (int k = 0; k < kDirections; ++k) {
      const Vec3 d = lattice(k, kDirections);
      std::size_t part = 0;
      if (!emitter_->is_infinite()) {
        const auto p = surface(o, d);
        if (!p) continue;
        part = emitter_->part_of(*p);
      }
      mass[part] += density(o, d) * 4 * M_PI / kDirections;
      ++hits[part];
    }
    for (std::size_t part = 0; part < mass.size(); ++part) {
      if (hits[part] < 100) continue;  // not seen from here, or too small for this lattice
      // Part of a part may be hidden by the rest of the shape, not for these convex ones.
      EXPECT_NEAR(mass[part], 1, 0.01 + 2 / std::sqrt(double(hits[part])) * 0.5) << o.x << " part " << part;
    }
  }
}

TEST_P(EmitterHarness, DirectionsFollowTheDensity) {
  if (is_point()) return;
  // Bins of 24 x 48 over the sphere; their masses by quadrature with many points each.
  constexpr int rows = 24, columns = 48, fine = 24;
  const Vec3 o = case_.references[0];
  std::size_t tests = 0;
  for (std::size_t part = 0; part < emitter_->part_count(); ++part) {
    std::vector<double> mass(rows * columns);
    const auto bin = [&](const Vec3& d) {
      double phi = std::atan2(double(d.y), double(d.x)) / (2 * M_PI);
      if (phi < 0) phi += 1;
      return std::size_t(std::min(rows - 1, int((1 - double(d.z)) / 2 * rows)) * columns +
                         std::min(columns - 1, int(phi * columns)));
    };
    for (int i = 0; i < rows * fine; ++i)
      for (int j = 0; j < columns * fine; ++j) {
        const double z = 1 - 2 * (i + 0.5) / (rows * fine), phi = 2 * M_PI * (j + 0.5) / (columns * fine);
        const double r = std::sqrt(1 - z * z);
        const Vec3 d{float(r * std::cos(phi)), float(r * std::sin(phi)), float(z)};
        if (!emitter_->is_infinite()) {
          const auto p = surface(o, d);
          if (!p || emitter_->part_of(*p) != part) continue;
        }
        mass[bin(d)] += density(o, d) * 4 * M_PI / (rows * fine * columns * fine);
      }
    TestRandom random(3 + part);
    const int n = 20000;
    std::vector<int> count(mass.size());
    int found = 0;
    for (int k = 0; k < n; ++k)
      if (const auto s = emitter_->sample_direct(o, part, random.next2(), w_)) ++count[bin(s->wo)], ++found;
    if (!found) continue;
    double chi2 = 0, pooled = 0, pooled_count = 0;
    std::size_t bins = 0;
    const auto add = [&](double expected, double c) {
      // The masses are known to a per cent of a bin on edges: a variance of its own.
      chi2 += (c - expected) * (c - expected) / (expected + 1e-4 * expected * expected), ++bins;
    };
    for (std::size_t b = 0; b < mass.size(); ++b) {
      if (mass[b] * found < 10) {
        pooled += mass[b] * found, pooled_count += count[b];
        continue;
      }
      add(mass[b] * found, count[b]);
    }
    if (pooled > 5)
      add(pooled, pooled_count);
    else
      EXPECT_LT(pooled_count, pooled + 5 * std::sqrt(pooled + 1) + 5) << "samples where there is no density";
    if (bins < 2) continue;
    ++tests;
    EXPECT_GT(chi_square_p_value(chi2, bins - 1), 1e-4)
        << "part " << part << ", " << bins << " bins, " << chi2;
  }
  EXPECT_GT(tests, 0u);
}

TEST_P(EmitterHarness, PowerAgreesWithQuadrature) {
  const SampledSpectrum power = emitter_->power_spectrum();
  const Spectrum found = power.eval(w_);
  Spectrum expected = 0.f;
  if (is_point()) {
    expected = emitter_->sample_direct({0.4f, 0.1f, 1}, 0, {}, w_)->radiance * (4 * kPi);
  } else if (emitter_->is_infinite()) {
    // What enters the bounding sphere: its cross-section times the integral of the radiance.
    const int n = 40000;
    for (int k = 0; k < n; ++k) expected += emitter_->eval_escaped(lattice(k, n), w_) * (4 * kPi / n);
    const Bounds3 b = scene_->bounds();
    expected *= Spectrum(kPi * 0.25f * length_squared(b.diagonal()));
  } else {
    // Radiance averaged over the surface's uv.
    const int n = 64;
    for (int k = 0; k < n * n; ++k) {
      SurfacePoint p;
      p.ng = {0, 0, 1}, p.uv = {(float(k % n) + 0.5f) / n, (float(k / n) + 0.5f) / n};
      expected += emitter_->eval(p, {0, 0, 1}, w_) * (float(M_PI * case_.area) / (n * n));
    }
  }
  // An environment's mean colour stands for the mean of its spectra, whose shapes and scales are interpolated
  // apart; its power is only used to choose densities.
  const bool envmap = case_.name.starts_with("envmap");
  for (int j = 0; j < kWavelengths; ++j)
    EXPECT_NEAR(found[j], expected[j], (envmap ? 0.3f : 2e-3f) * expected[j]) << w_.nm[j];
  EXPECT_NEAR(sum(found), sum(expected), (envmap ? 0.06f : 2e-3f) * sum(expected));
  double share = 0;
  for (std::size_t part = 0; part < emitter_->part_count(); ++part)
    share += emitter_->emission_bounds(part).power;
  EXPECT_NEAR(share, 1, 1e-5);
}

TEST_P(EmitterHarness, BacksAreDark) {
  if (!case_.geometry) return;
  SurfacePoint p;
  p.ng = {0, 0, 1};
  EXPECT_TRUE(is_black(emitter_->eval(p, {0, 0, -1}, w_)));
  EXPECT_TRUE(is_black(emitter_->eval(p, {1, 0, 0}, w_)));
  EXPECT_FALSE(is_black(emitter_->eval(p, {0.6f, 0, 0.8f}, w_)));
  if (case_.name.starts_with("area_rectangle")) {
    TestRandom random(4);
    for (int k = 0; k < 100; ++k)
      EXPECT_FALSE(emitter_->sample_direct({0.1f, 0.2f, 3}, 0, random.next2(), w_));
  }
}

INSTANTIATE_TEST_SUITE_P(Emitters, EmitterHarness, ::testing::Range(std::size_t(0), cases().size()),
                         [](const auto& info) { return cases()[info.param].name; });

TEST(EmitterHarnessItself, CoversEveryEmitter) {
  std::set<std::string> covered;
  for (const Case& c : cases()) covered.insert(c.name.substr(0, c.name.find('_')));
  for (const PluginInfo& p : Registry::instance().all())
    if (p.family == "emitter" && !p.name.starts_with("test_")) {
      EXPECT_TRUE(covered.count(p.name)) << p.name;
    }
}

TEST(EnvmapEmitter, BrightPixelLiesWhereItShould) {
  const TemporaryFolder folder;
  write_sky(folder.path / "sky.exr");
  const Scene scene(load_scene_from_string(
      scene_with(R"(<emitter type="envmap"><string name="filename" value="sky.exr"/></emitter>
                    <emitter type="envmap"><string name="filename" value="sky.exr"/>
                      <transform name="to_world"><rotate y="1" angle="90"/></transform></emitter>)"),
      folder.path / "test.xml"));
  const Wavelengths w = Wavelengths::at(scene.loaded().context->grid, 550.f);
  // Pixel (11, 2) of 16 x 9: azimuth (11.5 / 16) turns from -z towards +x, polar angle 2 / 8 of pi from +y.
  const double phi = 2 * M_PI * 11.5 / 16, theta = M_PI / 4;
  const Vec3 d{float(std::sin(phi) * std::sin(theta)), float(std::cos(theta)),
               float(-std::cos(phi) * std::sin(theta))};
  const Emitter& upright = *scene.emitters()[0];
  const float there = upright.eval_escaped(d, w)[0];
  for (int k = 0; k < 1000; ++k) {
    const double z = 1 - (2 * k + 1) / 1000.0, a = k * 2.399963, r = std::sqrt(1 - z * z);
    EXPECT_LE(upright.eval_escaped({float(r * std::cos(a)), float(r * std::sin(a)), float(z)}, w)[0],
              there * 1.001f);
  }
  EXPECT_GT(there, 50 * upright.eval_escaped(-d, w)[0]);
  // Turned by 90 degrees about y, +z goes to +x.
  EXPECT_NEAR(scene.emitters()[1]->eval_escaped({d.z, d.y, -d.x}, w)[0], there, 1e-3f * there);
}

}  // namespace
}  // namespace aureole::testing

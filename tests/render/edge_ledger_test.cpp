// SPDX-License-Identifier: Apache-2.0
// The ledger of light that edges diffract: what is lent of the light on faces is what edges send away.
#include "aureole/transport/edge_ledger.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <numbers>
#include <vector>

#include "aureole/math/warp.h"
#include "aureole/optics/diffraction/edge_kernel.h"
#include "aureole/transport/keyed_random.h"
#include "harness/effort.h"
#include "harness/rendered.h"
#include "loading/load_text.h"

namespace aureole::testing {
namespace {

using std::numbers::pi;

using test::kSanitized;

Wavelengths some_wavelengths(const Scene& scene) {
  return Wavelengths::at(scene.parts().context->grid,
                         make_spectrum([](int i) { return 420 + 35.f * float(i); }));
}

/// A regular polygon of radius 1 in the plane z = 0, as a mesh, in beams of that many wavelengths; `unit` is that of length.
std::shared_ptr<const Scene> polygon(int corners, double radius_sigma, double wavelengths) {
  const auto file =
      std::filesystem::path(::testing::TempDir()) / ("polygon" + std::to_string(corners) + ".obj");
  std::ofstream obj(file);
  obj << "v 0 0 0\n";
  for (int i = 0; i < corners; ++i)
    obj << "v " << std::cos(2 * pi * i / corners) << " " << std::sin(2 * pi * i / corners) << " 0\n";
  for (int i = 0; i < corners; ++i) obj << "f 1 " << i + 2 << " " << (i + 1) % corners + 2 << "\n";
  obj.close();
  // sigma at the longest of the wavelengths below, 665 nm, is 1/radius_sigma.
  const double unit_m = radius_sigma * wavelengths * 665e-9;
  return load_scene_from_string(
             "<scene version=\"3.0.0\"><string name=\"length_unit\" value=\"" + std::to_string(unit_m * 1e6) +
                 "um\"/><integrator type=\"path\"><boolean name=\"diffraction\" value=\"true\"/>"
                 "<string name=\"beam_width\" value=\"" +
                 std::to_string(wavelengths) +
                 "\"/></integrator><sensor type=\"perspective\"><film type=\"hdrfilm\"/></sensor>"
                 "<shape type=\"obj\"><string name=\"filename\" value=\"" +
                 file.string() + "\"/></shape></scene>",
             "polygon.xml")
      .scene;
}

/// A mean with its standard error.
struct Mean {
  double sum = 0, squares = 0;
  int count = 0;
  void add(double x) { sum += x, squares += x * x, ++count; }
  double mean() const { return sum / count; }
  double error() const { return std::sqrt(std::max(0.0, squares / count - mean() * mean()) / count); }
};

struct LedgerCase {
  int corners;
  double radius_sigma, wavelengths, tilt;
};

// What is lent of the light on a face, and what its edges diffract, for light of one unit of irradiance.
TEST(EdgeLedger, LendsWhatIsDiffracted) {
  for (const LedgerCase& c : {LedgerCase{3, 6, 25, 0},
                              {4, 1.5, 0.5, 0},
                              {4, 3, 50, 0.9},
                              {20, 3, 5, 0.4},
                              {200, 4, 50, 0},
                              {200, 0.5, 4, 0}}) {
    const auto scene = polygon(c.corners, c.radius_sigma, c.wavelengths);
    const SceneEdges& edges = *scene->edges();
    ASSERT_EQ(int(edges.index().edges().size()), c.corners);
    const bool many = c.corners > 20;
    const int n = kSanitized ? 100 : test::effort(many ? 4000 : 24000, 600000);
    const auto beams = edges.beams(some_wavelengths(*scene));
    const Vec3 d{float(std::sin(c.tilt)), 0, -float(std::cos(c.tilt))};
    KeyedRandom random(17);
    const auto next = [&] { return random.next(); };
    const auto w = some_wavelengths(*scene);
    Mean lent, diffracted;
    const double area = 0.5 * c.corners * std::sin(2 * pi / c.corners) * std::cos(c.tilt);
    const double outline = 2 * c.corners * std::sin(pi / c.corners);
    for (int i = 0; i < n; ++i) {
      // A point of one of the triangles about the middle.
      const double r = std::sqrt(next()), t = next();
      const int k = std::min(int(next() * float(c.corners)), c.corners - 1);
      const double a = 2 * pi * k / c.corners, b = 2 * pi * (k + 1) / c.corners;
      const Vec3 y{float(r * ((1 - t) * std::cos(a) + t * std::cos(b))),
                   float(r * ((1 - t) * std::sin(a) + t * std::sin(b))), 0};
      lent.add(area * (1 - double(mean(left_by_edges(*scene, y, d, w, std::uint32_t(2 * i))))));
      const auto& all = edges.index().edges();
      const MeshEdge& edge = all[std::min(std::size_t(next() * float(all.size())), all.size() - 1)];
      const EdgeLine line(edge);
      EdgePoint x{&edge, next() * line.length, {}, {}, 1};
      x.x = line.at(x.at);
      diffracted.add(outline * double(mean(diffracted_at(edges, x, d, beams, random))));
    }
    const double error = std::hypot(lent.error(), diffracted.error());
    std::printf(
        "%3d edges, radius %3g sigma, %4g wavelengths, tilt %3g: lent %.5f of the light, diffracted %.5f, difference %+.2f +- %.2f %%\n",
        c.corners, c.radius_sigma, c.wavelengths, c.tilt, lent.mean() / area, diffracted.mean() / area,
        100 * (lent.mean() / diffracted.mean() - 1), 100 * error / diffracted.mean());
    if (kSanitized) continue;
    EXPECT_NEAR(lent.mean(), diffracted.mean(), 4 * error + 0.001 * diffracted.mean());
    EXPECT_LT(error, (many ? 0.2 : 0.06) * diffracted.mean());
  }
}

// S by quadrature over the sphere, with the kernel of single wavelengths by libcerf in ScatteringPlane's coordinates.
TEST(EdgeLedger, DiffractsTheIntegralOfK) {
  const auto scene = polygon(3, 1.5, 0.7);
  const SceneEdges& edges = *scene->edges();
  const auto beams = edges.beams(some_wavelengths(*scene));
  const MeshEdge& edge = edges.index().edges()[0];
  const EdgeLine line(edge);
  KeyedRandom random(5);
  for (const double at : {0.5, 0.1}) {
    EdgePoint x{&edge, at * line.length, {}, {}, 1};
    x.x = line.at(x.at);
    const Vec3 d{0, 0, -1};
    Mean drawn;
    for (int i = 0; i < 40000; ++i) drawn.add(double(diffracted_at(edges, x, d, beams, random)[2]));
    double expected = 0;
    const int rings = 120, steps = 240;
    for (int i = 0; i < rings; ++i)
      for (int j = 0; j < steps; ++j) {
        const double z = -1 + (i + 0.5) * 2 / rings, r = std::sqrt(1 - z * z),
                     phi = (j + 0.5) * 2 * pi / steps;
        const optics::ScatteringPlane plane({0, 0, -1}, {r * std::cos(phi), r * std::sin(phi), z},
                                            beams.k[2]);
        std::vector<optics::ProjectedEdge> projected;
        std::size_t own = 0;
        for (const MeshEdge& e : edges.index().edges()) {
          if (&e == &edge) own = projected.size();
          const auto point = [&](const Vec3& p) {
            const Double3 v = Double3(p) - x.x;
            return plane.project({v.x, v.y, v.z});
          };
          projected.push_back({point(e.a), point(e.b), length(e.b - e.a)});
        }
        expected += optics::mean_edge_kernel(projected, own, at, plane.q(), beams.k[2], beams.sigma[2]) * 4 *
                    pi / (rings * steps);
      }
    std::printf("S at %g: %.5f by samples, %.5f by quadrature\n", at, drawn.mean(), expected);
    EXPECT_NEAR(drawn.mean(), expected, 4 * drawn.error() + 0.005 * expected);
    EXPECT_LT(drawn.error(), 0.02 * expected);
  }
}

// No place lends more than falls on it: with a white surface, what is reflected and diffracted is at most what falls.
TEST(EdgeLedger, NoPlaceLendsMoreThanItHas) {
  const auto largest = [](const char* shape, const Vec3& at, double tilt) {
    const auto scene =
        load_scene_from_string(
            "<scene version=\"3.0.0\"><string name=\"length_unit\" value=\"1um\"/><integrator type=\"path\">"
            "<boolean name=\"diffraction\" value=\"true\"/><string name=\"beam_width\" value=\"5\"/></integrator>"
            "<sensor type=\"perspective\"><film type=\"hdrfilm\"/></sensor>" +
                std::string(shape) + "</scene>",
            "ledger.xml")
            .scene;
    const Vec3 d = normalize(Vec3{float(std::sin(tilt)), 0, -float(std::cos(tilt))});
    const auto w = some_wavelengths(*scene);
    Mean mean_of[kWavelengths];
    for (int i = 0; i < 8000; ++i) {
      const Spectrum left = left_by_edges(*scene, at, d, w, std::uint32_t(i));
      for (int k = 0; k < kWavelengths; ++k) mean_of[k].add(1 - double(left[k]));
    }
    double most = 0;
    for (const Mean& m : mean_of) most = std::max(most, m.mean() - 3 * m.error());
    std::printf("%-18s D = %.3f +- %.3f at the longest, %.3f at the shortest wavelength\n",
                std::string(shape).substr(13, 9).c_str(), mean_of[kWavelengths - 1].mean(),
                mean_of[kWavelengths - 1].error(), mean_of[0].mean());
    return most;
  };
  const char* square =
      R"(<shape type="rectangle"><transform name="to_world"><scale value="200"/></transform></shape>)";
  const char* wire =
      R"(<shape type="rectangle"><transform name="to_world"><scale x="200" y="0.1"/></transform></shape>)";
  const char* cube =
      R"(<shape type="cube"><transform name="to_world"><scale value="100"/></transform></shape>)";
  EXPECT_LT(largest(square, {200, 0, 0}, 0), 1);
  EXPECT_LT(largest(square, {200, 0, 0}, 1.3), 1);
  EXPECT_LT(largest(square, {200, 200, 0}, 0), 1);
  EXPECT_LT(largest(wire, {0, 0, 0}, 0), 1);
  EXPECT_LT(largest(cube, {100, 0, 100}, 0.7), 1);
  EXPECT_LT(largest(cube, {100, 100, 100}, 0.7), 1);
  EXPECT_LT(largest(square, {150, 0, 0}, 0), 1e-3);  // far from all edges
}

// Places that are said to be far from all edges lend nothing.
TEST(EdgeLedger, PlacesFarFromEdgesLendNothing) {
  const auto scene = polygon(5, 8, 5);
  const auto w = some_wavelengths(*scene);
  KeyedRandom random(11);
  int far = 0, near = 0;
  for (int i = 0; i < 4000; ++i) {
    const Vec3 y{4 * random.next() - 2, 4 * random.next() - 2, 2 * random.next() - 1};
    const Vec3 d = square_to_uniform_sphere({random.next(), random.next()});
    const Spectrum left = left_by_edges(*scene, y, d, w, std::uint32_t(i));
    const bool lends = lends_light(*scene, y);
    near += lends && max_component(abs(left - Spectrum(1.f))) > 0;
    if (lends) continue;
    ++far;
    EXPECT_EQ(max_component(abs(left - Spectrum(1.f))), 0) << i;
  }
  EXPECT_GT(far, 200);
  EXPECT_GT(near, 100);
}

/// The mean irradiance that light has from within on a sphere around an obstacle, in even light: 1 without losses.
Picture around(const std::string& obstacle, const char* reflectance, const char* integrator,
               bool diffraction) {
  return render(std::string(R"(<string name="length_unit" value="20um"/><integrator type=")") + integrator +
                R"("><boolean name="diffraction" value=")" + (diffraction ? "true" : "false") +
                R"("/><string name="beam_width" value="20 wavelengths"/></integrator>)" + obstacle +
                R"(<bsdf type="twosided"><bsdf type="diffuse"><spectrum name="reflectance" value=")" +
                reflectance +
                R"("/></bsdf></bsdf></shape>
  <shape type="sphere"><float name="radius" value="2.5"/><boolean name="flip_normals" value="true"/>
    <bsdf type="null"/><sensor type="irradiancemeter"><sampler type="sobol"><integer name="sample_count" value=")" +
                (kSanitized ? "16" : "4096") + R"("/></sampler>
      <film type="specfilm"><integer name="width" value="1"/><integer name="height" value="1"/>
        <float name="wavelength_min" value="500"/><float name="wavelength_max" value="600"/>
        <integer name="bins" value="1"/><boolean name="preview" value="false"/><rfilter type="box"/></film>
    </sensor></shape>
  <emitter type="directional"><vector name="direction" x="0.1" y="0.2" z="-1"/><spectrum name="irradiance" value="4"/></emitter>)");
}

// What falls on a white obstacle leaves it, by its faces or around its edges, and all of it reaches the sphere around.
TEST(EdgeLedger, WhiteObstaclesKeepAllLight) {
  const auto expect_all = [](const char* name, const std::string& obstacle,
                             std::initializer_list<const char*> integrators) {
    for (const char* integrator : integrators) {
      const Picture p = around(obstacle, "1", integrator, true);
      std::printf("%-5s by %-7s: %.5f +- %.5f of the light\n", name, integrator, p.all, p.all_error);
      if (kSanitized) continue;
      EXPECT_NEAR(p.all, 1, 4 * p.all_error) << name << " " << integrator;
      EXPECT_LT(p.all_error, 0.02) << name << " " << integrator;
    }
  };
  const char* plate = R"(<shape type="rectangle">)";
  expect_all("plate", plate, {"path", "ptracer", "bdpt"});
  expect_all(
      "block",
      R"(<shape type="cube"><transform name="to_world"><scale value="0.6"/><rotate x="1" y="0.4" angle="35"/></transform>)",
      {"path"});
  expect_all("disc", R"(<shape type="disk">)", {"path"});
  const Picture black = around(plate, "0", "path", true), dark = around(plate, "0", "path", false),
                white = around(plate, "1", "path", false);
  std::printf("of the light on the plate %.4f is diffracted\n",
              (black.all - dark.all) / (white.all - dark.all));
  if (kSanitized) return;
  EXPECT_GT(black.all - dark.all, 0.2 * (white.all - dark.all));
}

// The part of a Gaussian about places on the edges of a convex polygon, by rows of it, each with error functions.
TEST(EdgeLedger, CoveredPartIsThatOfThePolygon) {
  for (const int corners : {3, 5, 40}) {
    const auto scene = polygon(corners, 1, 5);
    const SceneEdges& edges = *scene->edges();
    KeyedRandom random(3);
    for (const double deviation : {0.1, 0.7, 4.0})
      for (const double at : {0.5, 0.03}) {
        const MeshEdge& edge = edges.index().edges()[1];
        const EdgeLine line(edge);
        EdgePoint x{&edge, at * line.length, line.at(at * line.length), {}, 1};
        double expected = 0;
        const int rows = 4000;
        for (int i = 0; i < rows; ++i) {
          const double y = -1 + (i + 0.5) * 2 / rows;
          double low = -2, high = 2;
          for (int k = 0; k < corners; ++k) {
            const double middle = 2 * pi * (k + 0.5) / corners, inner = std::cos(pi / corners);
            const double c = std::cos(middle), s = std::sin(middle), rest = inner - y * s;
            if (std::abs(c) < 1e-12) {
              if (rest < 0) high = low;
            } else if (c > 0) {
              high = std::min(high, rest / c);
            } else {
              low = std::max(low, rest / c);
            }
          }
          if (!(high > low)) continue;
          const double z = (y - x.x.y) / deviation, scale = 1 / (deviation * std::numbers::sqrt2);
          expected += 2.0 / rows * std::exp(-0.5 * z * z) / (deviation * std::sqrt(2 * pi)) * 0.5 *
                      (std::erf((high - x.x.x) * scale) - std::erf((low - x.x.x) * scale));
        }
        EdgePoint place = edges.place_on(edge, at);
        for (const float side : {1.f, -1.f}) {
          Mean rays;
          for (int i = 0; i < (kSanitized ? 100 : 20000); ++i)
            rays.add(per_lit_face(*scene, place, {0, 0, side}, deviation, random));
          EXPECT_NEAR(rays.mean(), 1 / expected, 5 * rays.error())
              << corners << " " << deviation << " " << at;
        }
      }
  }
}

}  // namespace
}  // namespace aureole::testing

// SPDX-License-Identifier: Apache-2.0
// The power balance of edges: the power removed from light that passes beside them is the power that they diffract.
#include "aureole/transport/edge_ledger.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

#include "aureole/core/keyed_random.h"
#include "aureole/math/warp.h"
#include "aureole/optics/diffraction/edge_kernel.h"
#include "aureole/scene/edge/scene_diffraction.h"
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

std::shared_ptr<const Scene> in_beams_of(double wavelengths, double unit_um, const std::string& shapes) {
  return load_scene_from_string(
             "<scene version=\"3.0.0\"><string name=\"length_unit\" value=\"" + std::to_string(unit_um) +
                 "um\"/><integrator type=\"path\"><boolean name=\"diffraction\" value=\"true\"/>"
                 "<string name=\"diffraction_model\" value=\"beams\"/><string name=\"beam_width\" value=\"" +
                 std::to_string(wavelengths) +
                 "\"/></integrator><sensor type=\"perspective\"><sampler type=\"sobol\"/><film type=\"hdrfilm\"/></sensor>" +
                 shapes + "</scene>",
             "ledger.xml")
      .scene;
}
/// A shape in beams of that many wavelengths, the longest of which above has a sigma of 1/`per_sigma`.
std::shared_ptr<const Scene> in_beams(const std::string& shape, double per_sigma, double wavelengths) {
  return in_beams_of(wavelengths, per_sigma * wavelengths * 0.665, shape);
}

/// A regular polygon of radius 1 in the plane z = 0, or an opening of that shape in a sheet that ends far from it, as a mesh, in beams of
/// that many wavelengths; `radius_sigma` is the radius over sigma at the longest of the wavelengths below.
std::shared_ptr<const Scene> polygon(int corners, double radius_sigma, double wavelengths,
                                     bool opening = false) {
  const auto file =
      std::filesystem::path(::testing::TempDir()) / ("polygon" + std::to_string(corners) + ".obj");
  std::ofstream obj(file);
  obj.precision(9);
  const double outer = 1 + 30 / radius_sigma;
  const auto ring = [&](double radius) {
    for (int i = 0; i < corners; ++i)
      obj << "v " << radius * std::cos(2 * pi * i / corners) << " " << radius * std::sin(2 * pi * i / corners)
          << " 0\n";
  };
  ring(1);
  if (opening) {
    ring(outer / std::cos(pi / corners));
  } else {
    obj << "v 0 0 0\n";
  }
  for (int i = 0; i < corners; ++i) {
    const int a = i + 1, b = (i + 1) % corners + 1;
    if (opening) {
      obj << "f " << a << " " << corners + a << " " << corners + b << "\nf " << a << " " << corners + b << " "
          << b << "\n";
    } else {
      obj << "f " << corners + 1 << " " << a << " " << b << "\n";
    }
  }
  obj.close();
  return in_beams(R"(<shape type="obj"><string name="filename" value=")" + file.string() + R"("/></shape>)",
                  radius_sigma, wavelengths);
}

std::string rectangle(double half_x, double half_y, double at_x, double at_y = 0, double at_z = 0) {
  return R"(<shape type="rectangle"><transform name="to_world"><scale x=")" + std::to_string(half_x) +
         "\" y=\"" + std::to_string(half_y) + R"("/><translate x=")" + std::to_string(at_x) + "\" y=\"" +
         std::to_string(at_y) + "\" z=\"" + std::to_string(at_z) + R"("/></transform></shape>)";
}

/// Whether a place in the plane of the polygon lies in it.
bool is_inside(int corners, double x, double y) {
  for (int k = 0; k < corners; ++k) {
    const double middle = 2 * pi * (k + 0.5) / corners;
    if (x * std::cos(middle) + y * std::sin(middle) > std::cos(pi / corners)) return false;
  }
  return true;
}

/// A way that passes a place, from far away to far away.
LightWay way_past(const Vec3& y, const Vec3& d, float reach) { return {y - reach * d, d, 2 * reach}; }

/// A mean with its standard error.
struct Mean {
  double sum = 0, squares = 0;
  int count = 0;
  void add(double x) { sum += x, squares += x * x, ++count; }
  double mean() const { return sum / count; }
  double error() const { return std::sqrt(std::max(0.0, squares / count - mean() * mean()) / count); }
};

/// A way that light takes, of no area where it is blocked, and a place on an edge.
struct Spent {
  LightWay way;
  double area;  ///< across the light over the density of the way
  EdgePoint place;
  double length;  ///< over the density of the place
};
EdgePoint place_at(const MeshEdge& edge, double t) {
  const EdgeLine line(edge);
  return {&edge, t * line.length, line.at(t * line.length), {}, 1};
}

/// The power removed from light of one unit of irradiance, and the power that edges diffract of it, by integration of K over directions.
/// choose(u, spent) sets a segment and a point by three numbers of a scrambled Sobol point; errors are those of independent scramblings.
template <class Choose>
std::pair<Mean, Mean> ledger_of(const Scene& scene, int points, const Choose& choose) {
  const auto w = some_wavelengths(scene);
  const auto beams = scene.diffraction()->edges().beams(w);
  Mean lent, diffracted;
  for (int scrambling = 0; scrambling < 16; ++scrambling) {
    Mean lent_here, diffracted_here;
    for (int i = 0; i < points; ++i) {
      float u[2 * Sampler::kBlock];
      for (const int block : {0, 1})
        scene.sensor().sampler().block(mix_bits(std::uint64_t(scrambling + 1)), std::uint32_t(i), block,
                                       u + block * Sampler::kBlock);
      Spent spent;
      choose(u, spent);
      const auto key = std::uint32_t(2 * (scrambling * points + i));
      lent_here.add(spent.area > 0 ? spent.area * (1 - double(mean(left_by_edges(scene, spent.way, w, key))))
                                   : 0);
      const std::span<const float, 7> direction(u + 3, 7);
      diffracted_here.add(spent.length * double(mean(diffracted_at(scene.diffraction()->edges(), spent.place,
                                                                   spent.way.d, beams, direction))));
    }
    lent.add(lent_here.mean()), diffracted.add(diffracted_here.mean());
  }
  return {lent, diffracted};
}

struct LedgerCase {
  int corners;
  double radius_sigma, wavelengths, tilt;
  bool opening;
};

TEST(EdgeLedger, LendsWhatIsDiffracted) {
  for (const LedgerCase& c : {LedgerCase{3, 6, 25, 0, false},
                              {4, 1.5, 0.5, 0, false},
                              {4, 3, 50, 0.9, false},
                              {20, 3, 5, 0.4, false},
                              {200, 4, 50, 0, false},
                              {200, 0.5, 4, 0, false},
                              {3, 0.7, 5, 0, false},
                              {3, 6, 25, 0, true},
                              {3, 0.7, 25, 0.9, true},
                              {4, 1.5, 0.5, 0, true},
                              {4, 0.2, 25, 0.9, true},
                              {200, 4, 50, 0, true}}) {
    const auto scene = polygon(c.corners, c.radius_sigma, c.wavelengths, c.opening);
    const SceneEdges& edges = scene->diffraction()->edges();
    std::vector<const MeshEdge*> outline;
    for (const MeshEdge& edge : edges.index().edges())
      if (length(edge.a) < 1.001f) outline.push_back(&edge);
    ASSERT_EQ(int(outline.size()), c.corners);
    const int points = kSanitized ? 8 : 1 << test::effort(10, 17);
    const Vec3 d{float(std::sin(c.tilt)), 0, -float(std::cos(c.tilt))};
    // Nothing is removed beyond 5 deviations of the deficit, of 0.6 sigma; in the plane, which light hits obliquely, that is farther.
    const double window = c.opening ? 1 : 1 + 3.2 / (c.radius_sigma * std::cos(c.tilt));
    const double area = 4 * window * window * std::cos(c.tilt);
    const double falls = 0.5 * c.corners * std::sin(2 * pi / c.corners) * std::cos(c.tilt);
    const double outline_length = 2 * c.corners * std::sin(pi / c.corners);
    const auto [lent, diffracted] = ledger_of(*scene, points, [&](const float* u, Spent& spent) {
      const double x = window * (2 * u[0] - 1), y = window * (2 * u[1] - 1);
      spent.area = is_inside(c.corners, x, y) == c.opening ? area : 0;
      spent.way = way_past({float(x), float(y), 0}, d, float(20 / c.radius_sigma));
      const double at = double(u[2]) * c.corners;
      const std::size_t number = std::min(std::size_t(at), outline.size() - 1);
      spent.place = place_at(*outline[number], at - double(number));
      spent.length = outline_length;
    });
    const double error = std::hypot(lent.error(), diffracted.error());
    std::printf(
        "%3d edges of an %s, radius %3g sigma, %4g wavelengths, tilt %3g: lent %.5f +- %.5f of as much light as falls on it, diffracted "
        "%.5f +- %.5f, difference %+.2f +- %.2f %%\n",
        c.corners, c.opening ? "opening" : "obstacle", c.radius_sigma, c.wavelengths, c.tilt,
        lent.mean() / falls, lent.error() / falls, diffracted.mean() / falls, diffracted.error() / falls,
        100 * (lent.mean() / diffracted.mean() - 1), 100 * error / diffracted.mean());
    if (kSanitized) continue;
    EXPECT_NEAR(lent.mean(), diffracted.mean(), 4 * error + 0.001 * diffracted.mean());
    EXPECT_LT(error, 0.1 * diffracted.mean());
    if (c.opening) {
      EXPECT_LT(lent.mean(), falls);
    }
  }
}

// One edge, or the two of a strip: a length in the middle of a sheet that ends 60 sigma away.
TEST(EdgeLedger, LongEdgesLendWhatIsDiffracted) {
  struct Case {
    double width, wavelengths, tilt;  ///< in sigma; 0: one edge
  };
  for (const Case& c : {Case{0, 0.5, 0},
                        {0, 5, 1.2},
                        {0, 25, 0},
                        {0, 50, 0.9},
                        {0.1, 5, 0},
                        {0.1, 16, 0},
                        {0.02, 50, 0.9},
                        {1, 0.5, 0.4},
                        {1, 25, 0},
                        {3, 50, 0.9}}) {
    const double half = c.width > 0 ? 0.5 * c.width : 30, left = c.width > 0 ? -half : -60;
    const auto scene = in_beams(rectangle(half, 60, left + half), 1, c.wavelengths);
    const double right = left + 2 * half;
    std::vector<const MeshEdge*> sides;
    for (const MeshEdge& edge : scene->diffraction()->edges().index().edges())
      if (std::abs(double(edge.a.x) - double(edge.b.x)) < 1e-6 &&
          (c.width > 0 || std::abs(double(edge.a.x) - right) < 1e-6))
        sides.push_back(&edge);
    ASSERT_EQ(sides.size(), c.width > 0 ? 2u : 1u);
    // Light is oblique along the edges as well as across them.
    const Vec3 d{float(std::sin(c.tilt) * 0.6), float(std::sin(c.tilt) * 0.8), -float(std::cos(c.tilt))};
    const double beside = 3.2 / std::cos(c.tilt), begin = c.width > 0 ? left - beside : right;
    const double extent = right + beside - begin;
    const int points = kSanitized ? 8 : 1 << test::effort(11, 17);
    const auto [lent, diffracted] = ledger_of(*scene, points, [&](const float* u, Spent& spent) {
      const double x = begin + extent * double(u[0]);
      spent.area = x > left && x < right ? 0 : extent * std::cos(c.tilt);
      spent.way = way_past({float(x), u[1], 0}, d, 40);
      const std::size_t side = std::min(std::size_t(double(u[2]) * double(sides.size())), sides.size() - 1);
      spent.place = place_at(*sides[side], 0.5);
      spent.length = double(sides.size());
    });
    const double error = std::hypot(lent.error(), diffracted.error());
    std::printf(
        "%s, %4g wavelengths, tilt %3g: lent %.5f +- %.5f sigma, diffracted %.5f +- %.5f, difference %+.2f +- %.2f %%\n",
        c.width > 0 ? fmt::format("strip of {:g} sigma", c.width).c_str() : "one edge", c.wavelengths, c.tilt,
        lent.mean(), lent.error(), diffracted.mean(), diffracted.error(),
        100 * (lent.mean() / diffracted.mean() - 1), 100 * error / diffracted.mean());
    if (kSanitized) continue;
    // In light so oblique the sheet blocks ways farther from the edge than 3 sigma along the light, which are counted as open.
    EXPECT_NEAR(lent.mean(), diffracted.mean(), 4 * error + (c.tilt > 1 ? 0.02 : 0.001) * diffracted.mean());
    EXPECT_LT(error, 0.15 * diffracted.mean());
  }
}

// S by quadrature over the sphere, with the kernel of single wavelengths by libcerf in ScatteringPlane's coordinates.
TEST(EdgeLedger, DiffractsTheIntegralOfK) {
  const auto scene = polygon(3, 1.5, 0.7);
  const SceneEdges& edges = scene->diffraction()->edges();
  const auto beams = edges.beams(some_wavelengths(*scene));
  const MeshEdge& edge = edges.index().edges()[0];
  const EdgeLine line(edge);
  KeyedRandom random(5);
  for (const double at : {0.5, 0.1}) {
    EdgePoint x{&edge, at * line.length, {}, {}, 1};
    x.x = line.at(x.at);
    const Vec3 d{0, 0, -1};
    Mean drawn;
    for (int i = 0; i < 40000; ++i) {
      float u[7];
      for (float& number : u) number = random.next();
      drawn.add(double(diffracted_at(edges, x, d, beams, u)[2]));
    }
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

/// A scene in micrometres with beams of 5 wavelengths.
std::shared_ptr<const Scene> in_micrometres(const std::string& shapes) { return in_beams_of(5, 1, shapes); }

/// The part of the light that a way leaves to edges, per wavelength.
std::vector<Mean> lent_on(const Scene& scene, const LightWay& way, int samples) {
  const auto w = some_wavelengths(scene);
  std::vector<Mean> mean_of(kWavelengths);
  for (int i = 0; i < samples; ++i) {
    const Spectrum left = left_by_edges(scene, way, w, std::uint32_t(i));
    for (int k = 0; k < kWavelengths; ++k) mean_of[std::size_t(k)].add(1 - double(left[k]));
  }
  return mean_of;
}

// No more power is removed than passes, and as much in one direction as in the other.
TEST(EdgeLedger, NoLightLendsMoreThanItHas) {
  const auto largest = [](const char* name, const std::shared_ptr<const Scene>& scene, const Vec3& at,
                          double tilt) {
    // Not along the sides of the cube: which edges are its outline would be left to rounding.
    const Vec3 d = normalize(Vec3{float(std::sin(tilt)), 0.01f, -float(std::cos(tilt))});
    const float reach = 4 * scene->diffraction()->edges().widest_beam();
    const int samples = kSanitized ? 100 : 8000;
    const auto there = lent_on(*scene, way_past(at, d, reach), samples),
               back = lent_on(*scene, way_past(at, -d, reach), samples);
    double most = 0;
    for (std::size_t k = 0; k < there.size(); ++k) {
      most = std::max({most, there[k].mean() - 3 * there[k].error(), back[k].mean() - 3 * back[k].error()});
      if (kSanitized) continue;
      EXPECT_NEAR(there[k].mean(), back[k].mean(), 5 * std::hypot(there[k].error(), back[k].error()) + 1e-9)
          << name;
    }
    std::printf("%-40s D = %.3f +- %.3f at the longest, %.3f at the shortest wavelength\n", name,
                there.back().mean(), there.back().error(), there.front().mean());
    return most;
  };
  const auto square = in_micrometres(rectangle(200, 200, 0));
  EXPECT_LT(largest("straight edge", square, {200.001f, 0, 0}, 0), 1);
  EXPECT_LT(largest("straight edge, light oblique", square, {200.001f, 0, 0}, 1.3), 1);
  EXPECT_LT(largest("corner of an obstacle", square, {200.001f, 200.001f, 0}, 0), 1);
  EXPECT_LT(largest("wire", in_micrometres(rectangle(200, 0.1, 0)), {0, 0.101f, 0}, 0), 1);
  for (const double width : {0.1, 1.0, 3.0, 6.0})
    EXPECT_LT(
        largest(fmt::format("middle of a slit of {} um", width).c_str(),
                in_micrometres(rectangle(100, 200, -100 - width / 2) + rectangle(100, 200, 100 + width / 2)),
                {0, 0, 0}, 0),
        1);
  const auto cube = in_micrometres(
      R"(<shape type="cube"><transform name="to_world"><scale value="100"/></transform></shape>)");
  EXPECT_LT(largest("edge of a cube", cube, {100.1f, 0, 100.1f}, 0.7), 1);
  EXPECT_LT(largest("corner of a cube", cube, {100.1f, 100.1f, 100.1f}, 0.7), 1);
  EXPECT_LT(largest("far from all edges", square, {220, 0, 0}, 0), 1e-9);
  // Near the corners and in the middle of openings; sigma is 3.3 um at the longest wavelength. In the middle of those smaller than that,
  // most of whose light is diffracted, it is up to .07 more than there is, and less nearer to the edges (docs/diffraction_beams.md).
  for (const int corners : {3, 4, 40})
    for (const double radius : {0.3, 0.6, 1.0, 6.0})
      for (const float at : {0.99f, 0.f})
        EXPECT_LT(largest(fmt::format("{} corners, radius {} sigma, at {}", corners, radius, at).c_str(),
                          polygon(corners, radius, 5, true), {at, 0, 0}, 0),
                  radius < 2 && at == 0 ? 1.08 : 1);
}

// Edges at distances that are many beams apart each take their part of what is left.
TEST(EdgeLedger, DistantEdgesTakeOneAfterTheOther) {
  const std::string first = rectangle(200, 200, -200), second = rectangle(200, 200, -199, 0, -100);
  const LightWay way{{1, 0, 50}, {0, 0, -1}, 300};
  const int samples = kSanitized ? 100 : 20000;
  const auto left = [&](const std::string& shapes) { return lent_on(*in_micrometres(shapes), way, samples); };
  const auto a = left(first), b = left(second), both = left(first + second);
  for (std::size_t k = 0; k < both.size(); ++k) {
    const double expected = 1 - (1 - a[k].mean()) * (1 - b[k].mean());
    if (kSanitized) continue;
    EXPECT_GT(a[k].mean(), 0.2);
    EXPECT_NEAR(both[k].mean(), expected, 5 * (both[k].error() + a[k].error() + b[k].error()));
  }
}

// Nothing is removed from segments that stay farther from all edges than the deficit reaches.
TEST(EdgeLedger, WaysFarFromEdgesLendNothing) {
  const auto scene = polygon(5, 8, 5);
  const auto w = some_wavelengths(*scene);
  KeyedRandom random(11);
  int far = 0, near = 0;
  for (int i = 0; i < 4000; ++i) {
    const Vec3 y{4 * random.next() - 2, 4 * random.next() - 2, 2 * random.next() - 1};
    const Vec3 d = square_to_uniform_sphere({random.next(), random.next()});
    const float reach = 3 * random.next();
    const Spectrum left = left_by_edges(*scene, way_past(y, d, reach), w, std::uint32_t(i));
    double nearest = 1e9;
    for (const MeshEdge& edge : scene->diffraction()->edges().index().edges())
      for (int k = 0; k <= 400; ++k) {
        const Double3 to = Double3(edge.a + (float(k) / 400) * (edge.b - edge.a)) - Double3(y);
        const double along = std::clamp(dot(to, Double3(d)), -double(reach), double(reach));
        nearest = std::min(nearest, length(to - Double3(d) * along));
      }
    const bool lends = max_component(abs(left - Spectrum(1.f))) > 0;
    near += lends;
    if (nearest < 3.05 / 8) continue;
    ++far;
    EXPECT_FALSE(lends) << i;
  }
  EXPECT_GT(far, 200);
  EXPECT_GT(near, 100);
}

/// The mean irradiance that light has from within on a sphere around an obstacle, in even light: 1 without losses. Light that passes 3 sigma
/// beside the obstacle goes on for as much before it hits the sphere.
Picture around(const std::string& obstacle, const char* reflectance, const char* integrator,
               bool diffraction) {
  return render(
      std::string(R"(<string name="length_unit" value="20um"/><integrator type=")") + integrator +
      R"("><boolean name="diffraction" value=")" + (diffraction ? "true" : "false") +
      R"("/><string name="diffraction_model" value="beams"/><string name="beam_width" value="12 wavelengths"/></integrator>)" +
      obstacle + R"(<bsdf type="twosided"><bsdf type="diffuse"><spectrum name="reflectance" value=")" +
      reflectance +
      R"("/></bsdf></bsdf></shape>
  <shape type="sphere"><float name="radius" value="3"/><boolean name="flip_normals" value="true"/>
    <bsdf type="null"/><sensor type="irradiancemeter"><sampler type="sobol"><integer name="sample_count" value=")" +
      (kSanitized ? "16" : test::effort("4096", "65536")) + R"("/></sampler>
      <film type="specfilm"><integer name="width" value="1"/><integer name="height" value="1"/>
        <float name="wavelength_min" value="500"/><float name="wavelength_max" value="600"/>
        <integer name="bins" value="1"/><boolean name="preview" value="false"/><rfilter type="box"/></film>
    </sensor></shape>
  <emitter type="directional"><vector name="direction" x="0.1" y="0.2" z="-1"/><spectrum name="irradiance" value="4"/></emitter>)");
}

// All light reaches the sphere around a white obstacle: the diffracted power is missing beside them. A black obstacle
// absorbs what falls on it, no more and no less.
TEST(EdgeLedger, ObstaclesKeepAllLight) {
  const auto expect = [](const char* name, const std::string& obstacle, const char* reflectance,
                         double expected, double expected_error,
                         std::initializer_list<const char*> integrators) {
    for (const char* integrator : integrators) {
      const Picture p = around(obstacle, reflectance, integrator, true);
      std::printf("%-14s by %-7s: %.5f +- %.5f of the light, expected %.5f +- %.5f\n", name, integrator,
                  p.all, p.all_error, expected, expected_error);
      if (kSanitized) continue;
      EXPECT_NEAR(p.all, expected, 4 * std::hypot(p.all_error, expected_error)) << name << " " << integrator;
      EXPECT_LT(p.all_error, 0.02) << name << " " << integrator;
    }
  };
  const char* plate = R"(<shape type="rectangle">)";
  expect("white plate", plate, "1", 1, 0, {"path", "ptracer", "bdpt"});
  expect(
      "white block",
      R"(<shape type="cube"><transform name="to_world"><scale value="0.6"/><rotate x="1" y="0.4" angle="35"/></transform>)",
      "1", 1, 0, {"path"});
  expect("white disc", R"(<shape type="disk">)", "1", 1, 0, {"path"});
  const Picture dark = around(plate, "0", "path", false);
  expect("black plate", plate, "0", dark.all, dark.all_error, {"path", "ptracer", "bdpt"});
}

// The part of a Gaussian about places on the edges of a convex polygon that it leaves open, by rows of it, each with error functions.
TEST(EdgeLedger, OpenPartIsThatBesideThePolygon) {
  for (const int corners : {3, 5, 40}) {
    const auto scene = polygon(corners, 1, 5);
    const SceneEdges& edges = scene->diffraction()->edges();
    KeyedRandom random(3);
    for (const double deviation : {0.1, 0.7, 4.0})
      for (const double at : {0.5, 0.03}) {
        const MeshEdge& edge = edges.index().edges()[1];
        const EdgeLine line(edge);
        EdgePoint x{&edge, at * line.length, line.at(at * line.length), {}, 1};
        double covered = 0;
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
          covered += 2.0 / rows * std::exp(-0.5 * z * z) / (deviation * std::sqrt(2 * pi)) * 0.5 *
                     (std::erf((high - x.x.x) * scale) - std::erf((low - x.x.x) * scale));
        }
        EdgePoint place = edges.place_on(edge, at);
        for (const float side : {1.f, -1.f}) {
          Mean rays;
          for (int i = 0; i < (kSanitized ? 100 : 20000); ++i)
            rays.add(*per_open_way(scene->surfaces(), place, {0, 0, side}, deviation, 1, random));
          EXPECT_NEAR(rays.mean(), 1 / (1 - covered), 5 * rays.error())
              << corners << " " << deviation << " " << at;
        }
      }
  }
}

}  // namespace
}  // namespace aureole::testing

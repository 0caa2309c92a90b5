// SPDX-License-Identifier: Apache-2.0
// Truths about diffraction factors of the model "segments" that no picture shows by itself: power on planes and spheres,
// Kirchhoff's integral, outlines against visibility, subdivision, reciprocity and scale. The factors are those of
// `segment_diffraction`; the references are quadratures that share no code with it.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <random>
#include <sstream>
#include <string>
#include <tuple>
#include <vector>

#include "aureole/shape/geometry/double3.h"
#include "aureole/transport/segment_diffraction.h"
#include "harness/effort.h"
#include "harness/paths.h"
#include "loading/load_text.h"

namespace aureole::testing {
namespace {

using test::kSanitized;
using Field = std::complex<double>;

const char* const kAbsorbs =
    R"(<bsdf type="twosided"><bsdf type="diffuse"><spectrum name="reflectance" value="0"/></bsdf></bsdf>)";

/// Shapes between points, and the diffraction factors of segments at one wavelength [m].
class Obstacles {
public:
  Obstacles(const std::string& shapes, double wavelength, const std::string& polarisation = "none")
      : loaded_(load_scene_from_string(
            fmt::format(
                R"(<scene version="3.0.0"><string name="length_unit" value="m"/>
  <integrator type="path"><boolean name="diffraction" value="true"/><string name="diffraction_model" value="segments"/>
    <string name="diffraction_polarisation" value="{}"/></integrator>
  <sensor type="orthographic"><film type="specfilm"><integer name="width" value="1"/><integer name="height" value="1"/>
    <float name="wavelength_min" value="{:.9g}"/><float name="wavelength_max" value="{:.9g}"/>
    <integer name="bins" value="1"/><boolean name="preview" value="false"/></film></sensor>{}</scene>)",
                polarisation, wavelength * 1e9 * (1 - 1e-5), wavelength * 1e9 * (1 + 1e-5), shapes),
            "obstacles.xml")),
        w_(Wavelengths::at(scene().parts().context->grid, float(wavelength * 1e9))) {}

  const Scene& scene() const { return *loaded_.scene; }
  bool is_open(const Vec3& a, const Vec3& b) const {
    return !scene().tracer().occluded(Ray{a, b - a, 0.99999f});
  }
  /// Returns |u/u0|^2 at b for a lamp at a.
  double factor(const Vec3& a, const Vec3& b) const {
    const float distance = length(b - a);
    return double(segment_diffraction(scene(), a, (b - a) / distance, distance, is_open(a, b), w_)[0]);
  }
  /// Returns |u/u0|^2 at p for a lamp at infinity in that direction.
  double factor_from_infinity(const Vec3& p, const Vec3& to_lamp) const {
    const bool is_open = !scene().tracer().occluded(Ray{p, to_lamp, kInfinity});
    return double(segment_diffraction(scene(), p, to_lamp, kInfinity, is_open, w_)[0]);
  }

private:
  LoadedScene loaded_;
  Wavelengths w_;
};

/// A black rectangle in the plane z.
std::string plate(double x0, double x1, double y0, double y1, double z = 0) {
  return fmt::format(
      R"(<shape type="rectangle"><transform name="to_world"><scale x="{}" y="{}"/><translate x="{}" y="{}" z="{}"/></transform>{}</shape>)",
      (x1 - x0) / 2, (y1 - y0) / 2, (x0 + x1) / 2, (y0 + y1) / 2, z, kAbsorbs);
}

/// A black mesh of the text of an OBJ file, which is written into that folder.
std::string mesh_of(const test::TemporaryFolder& folder, const std::string& text,
                    const char* material = kAbsorbs) {
  static int count = 0;
  const std::filesystem::path file = folder.write(fmt::format("{}.obj", count++), text);
  return fmt::format(
      R"(<shape type="obj"><string name="filename" value="{}"/><boolean name="face_normals" value="true"/>{}</shape>)",
      file.string(), material);
}

/// Radius of a regular polygon with the area of a circle of radius 1.
double radius_of_equal_area(int sides) { return std::sqrt(2 * M_PI / sides / std::sin(2 * M_PI / sides)); }
/// A sheet in the plane z = 0, out to the radius `outer`, with a hole that is a polygon of the area of a circle. Rings of
/// triangles grow tenfold, since rays miss long triangles by rounding errors.
std::string holed_sheet(const test::TemporaryFolder& folder, double radius, double outer, int sides) {
  std::vector<double> rings;
  for (double r = radius * radius_of_equal_area(sides); r < outer; r *= 10) rings.push_back(r);
  rings.push_back(outer);
  std::string vertices, faces;
  for (int i = 0; i < sides; ++i)
    for (const double r : rings)
      vertices += fmt::format("v {:.9g} {:.9g} 0\n", r * std::cos(2 * M_PI * i / sides),
                              r * std::sin(2 * M_PI * i / sides));
  const int n = int(rings.size());
  for (int i = 0; i < sides; ++i)
    for (int k = 1; k < n; ++k) {
      const int a = n * i + k, b = n * ((i + 1) % sides) + k;
      faces += fmt::format("f {} {} {}\nf {} {} {}\n", a, a + 1, b + 1, a, b + 1, b);
    }
  return mesh_of(folder, vertices + faces);
}
/// A plate in the plane z = 0 that is a polygon of the area of a circle.
std::string round_plate(const test::TemporaryFolder& folder, double radius, int sides) {
  std::string vertices = "v 0 0 0\n", faces;
  const double r = radius * radius_of_equal_area(sides);
  for (int i = 0; i < sides; ++i) {
    vertices += fmt::format("v {:.9g} {:.9g} 0\n", r * std::cos(2 * M_PI * i / sides),
                            r * std::sin(2 * M_PI * i / sides));
    faces += fmt::format("f 1 {} {}\n", 2 + i, 2 + (i + 1) % sides);
  }
  return mesh_of(folder, vertices + faces);
}

constexpr double kGolden = 2.39996322972865332;  // radians

// The power on a plane behind an absorbing plate is that of the unobstructed wave without the part that the plate intercepts,
// and behind an opening it is the power that enters the opening: Parseval's theorem, for waves that turn little. Sums of a
// function over a regular grid are its integral if its local frequency nowhere equals that of the grid. Fringes at v have the
// frequency v/2, and end at v = 27.
TEST(SegmentPower, LightOnAPlaneIsWhatIsNotIntercepted) {
  constexpr double kWavelength = 550e-9, kStep = 0.06, kBeside = 28;
  const double half = 5;  // of plates and openings, in v
  // `scale`: metres per v on the screen at z = -1; `lamp`: height of the lamp, infinite for a plane wave.
  const auto check = [&](const char* name, const std::string& shapes, double scale, double lamp,
                         double beside, double step, int dimensions, double unobstructed, double expected) {
    const Obstacles obstacles(shapes, kWavelength);
    const auto at = [&](double x, double y) {
      const Vec3 p{float(x * scale), float(y * scale), -1};
      return (std::isinf(lamp) ? obstacles.factor_from_infinity(p, {0, 0, 1})
                               : obstacles.factor({0, 0, float(lamp)}, p)) -
             unobstructed;
    };
    const int n = kSanitized ? 4 : int((half + beside) / step);
    double sum = 0;
    if (dimensions == 1) {
      for (int i = 0; i < n; ++i) sum += 2 * at((i + 0.5) * step, 0) * step;
    } else if (dimensions == 0) {  // round
      for (int i = 0; i < n; ++i) {
        const double r = (i + 0.5) * step;
        sum += at(r * std::cos(kGolden * i), r * std::sin(kGolden * i)) * 2 * M_PI * r * step;
      }
    } else {
      for (int i = 0; i < n; ++i)
        for (int j = 0; j <= i; ++j)
          sum += (i == j ? 4 : 8) * at((i + 0.5) * step, (j + 0.5) * step) * step * step;
    }
    std::printf("%-32s power over intercepted power %+.5f\n", name, sum / expected);
    if (!kSanitized) {
      EXPECT_NEAR(sum / expected, 1, 0.002) << name;
    }
  };
  const double infinite = std::numeric_limits<double>::infinity();
  const double plane = std::sqrt(kWavelength / 2), point = std::sqrt(kWavelength / 4);
  const double h = half * plane, g = half * point;
  const test::TemporaryFolder folder;
  check("strip, plane wave", plate(-h, h, -20, 20), plane, infinite, kBeside, kStep, 1, 1, -2 * half);
  check("strip, lamp at 1 m", plate(-g, g, -20, 20), 2 * point, 1, kBeside, kStep, 1, 1, -2 * half);
  check("square, plane wave", plate(-h, h, -h, h), plane, infinite, kBeside, kStep, 2, 1, -4 * half * half);
  check("disc, plane wave", round_plate(folder, h, 96), plane, infinite, kBeside, kStep / 2, 0, 1,
        -M_PI * half * half);
  check("ball, plane wave",
        fmt::format(R"(<shape type="sphere"><float name="radius" value="{}"/>{}</shape>)", h, kAbsorbs),
        plane, infinite, kBeside, kStep / 2, 0, 1, -M_PI * half * half);
  check("slit, plane wave", plate(-1, -h, -20, 20) + plate(h, 1, -20, 20), plane, infinite, 150, kStep, 1, 0,
        2 * half);
  check("slit, lamp at 1 m", plate(-1, -g, -20, 20) + plate(g, 1, -20, 20), 2 * point, 1, 150, kStep, 1, 0,
        2 * half);
  check("square opening, plane wave",
        plate(-1, -h, -1, 1) + plate(h, 1, -1, 1) + plate(-h, h, -1, -h) + plate(-h, h, h, 1), plane,
        infinite, 60, 0.12, 2, 0, 4 * half * half);
  check("round opening, plane wave", holed_sheet(folder, h, 1, 96), plane, infinite, 100, 0.06, 0, 0,
        M_PI * half * half);
}

// The power that the waves of a disc's or an opening's outline carry into all directions of the hemisphere behind it, over the
// power that the disc intercepts. In the far field the amplitude is that of Fraunhofer's diffraction by a circle times
// cos(theta/2). The diameters are in wavelengths.
TEST(SegmentPower, LightOnASphereIsThatOfFraunhofersDiffraction) {
  const struct {
    double diameter, power;
  } kRows[] = {{2, 0.9655}, {4, 0.9801}, {8, 0.9892}, {16, 0.9943}, {50, 0.9981}};
  const test::TemporaryFolder folder;
  for (const auto& [diameter, power] : kRows) {
    const double a = diameter / 2, distance = std::max(2000.0, 32 * a * a);
    // The outer rim has detours beyond the window v = 533.
    const Obstacles opening(holed_sheet(folder, a, 1.5e5, 96), 1);
    const int n = kSanitized ? 2 : 400 + int(120 * a);
    double sum = 0;
    for (int i = 0; i < n; ++i) {
      const double theta = (i + 0.5) * M_PI / 2 / n, area = 2 * M_PI * std::sin(theta) * M_PI / 2 / n;
      const double r = distance * std::sin(theta);
      const Vec3 p{float(r * std::cos(kGolden * i)), float(r * std::sin(kGolden * i)),
                   float(-distance * std::cos(theta))};
      sum += opening.factor_from_infinity(p, {0, 0, 1}) * distance * distance * area;
    }
    double expected = 0;
    constexpr int kSteps = 20000;
    for (int i = 0; i < kSteps; ++i) {
      const double theta = (i + 0.5) * M_PI / 2 / kSteps,
                   area = 2 * M_PI * std::sin(theta) * M_PI / 2 / kSteps;
      const double x = 2 * M_PI * a * std::sin(theta);
      expected += std::pow(std::cos(theta / 2) * 2 * M_PI * a * a * std::cyl_bessel_j(1, x) / x, 2) * area;
    }
    const double intercepted = M_PI * a * a;
    std::printf("%g wavelengths: scattered over intercepted power %.4f (%.4f)\n", diameter, sum / intercepted,
                expected / intercepted);
    if (kSanitized) continue;
    EXPECT_NEAR(expected / intercepted, power, 2e-4) << diameter;
    EXPECT_NEAR(sum / intercepted, power, 0.005) << diameter;
  }
}

/// Kirchhoff's integral over a circle of radius a in the plane z = 0, for a plane wave along -z of wavelength 1, at (x, 0, -z).
Field kirchhoff_of_circle(double a, double x, double z) {
  constexpr int kRings = 240, kSpokes = 240;
  const double k = 2 * M_PI;
  Field sum = 0;
  for (int i = 0; i < kRings; ++i)
    for (int j = 0; j < kSpokes; ++j) {
      const double r = (i + 0.5) * a / kRings, phi = (j + 0.5) * 2 * M_PI / kSpokes;
      const double s = std::hypot(x - r * std::cos(phi), r * std::sin(phi), z), cosine = z / s;
      sum += std::polar(r / s, k * (s - z)) * (1.0 + cosine * Field(1, 1 / (k * s)));
    }
  return Field(0, -0.5) * sum * (a / kRings) * (2 * M_PI / kSpokes);
}

/// The boundary wave of that circle, with the obliquity factor cos(theta/2).
Field wave_of_circle(double a, double x, double z) {
  constexpr int kSteps = 4000;
  Field sum = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double phi = (i + 0.5) * 2 * M_PI / kSteps;
    const double px = a * std::cos(phi) - x, py = a * std::sin(phi), rho2 = px * px + py * py;
    const double s = std::hypot(px, py, z), across = a * (std::cos(phi) * px + std::sin(phi) * py) / rho2;
    sum += std::polar(std::sqrt(0.5 * (1 + z / s)) * across, 2 * M_PI * rho2 / (s + z));
  }
  return sum / double(kSteps);
}

// Kirchhoff's integral has the obliquity factor (1 + cos(theta))/2 = cos^2(theta/2), that of the renderer is cos(theta/2): on
// the axis behind a disc the renderer has 1/cos^2(theta/2) times the power.
TEST(SegmentPower, KirchhoffsIntegralNearSmallDiscs) {
  const test::TemporaryFolder folder;
  double worst_disc = 0, worst_opening = 0, worst_of_wave = 0;
  for (const double diameter : {2.0, 2.5, 3.0}) {
    const double a = diameter / 2;
    const Obstacles disc(round_plate(folder, a, 96), 1), opening(holed_sheet(folder, a, 1.5e5, 96), 1);
    for (const double z : {4.0, 6.0, 10.0})
      for (const double x : {0.0, 0.5, 0.9, 1.3, 2.0, 4.0}) {
        if (kSanitized && x > 0) continue;
        const Field through = kirchhoff_of_circle(a, x, z), wave = wave_of_circle(a, x, z);
        const double inside = x < a ? 1 : 0;
        const Vec3 p{float(x), 0, float(-z)};
        const double past = disc.factor_from_infinity(p, {0, 0, 1}),
                     in = opening.factor_from_infinity(p, {0, 0, 1});
        worst_of_wave = std::max({worst_of_wave, std::abs(std::sqrt(past) - std::abs(1 - inside + wave)),
                                  std::abs(std::sqrt(in) - std::abs(inside - wave))});
        const double off_disc = std::sqrt(past) - std::abs(1.0 - through),
                     off_opening = std::sqrt(in) - std::abs(through);
        if (test::is_thorough())
          std::printf("%g wide, at (%g, %g): disc %.4f, off by %+.4f; opening %.4f, off by %+.4f\n", diameter,
                      x, z, std::sqrt(past), off_disc, std::sqrt(in), off_opening);
        if (x == 0) {
          EXPECT_NEAR(past / std::norm(1.0 - through), std::pow(std::cos(0.5 * std::atan2(a, z)), -2), 0.003);
        }
        worst_disc = std::max(worst_disc, std::abs(off_disc));
        worst_opening = std::max(worst_opening, std::abs(off_opening));
      }
  }
  std::printf(
      "amplitudes off Kirchhoff's integral by %.4f behind discs, %.4f behind openings; off the wave of a circle by %.4f\n",
      worst_disc, worst_opening, worst_of_wave);
  EXPECT_LT(worst_disc, 0.02);
  EXPECT_LT(worst_opening, 0.02);
  EXPECT_LT(worst_of_wave, 0.005);
}

/// Random numbers in [-1, 1] and other choices.
class Dice {
public:
  explicit Dice(unsigned seed) : engine_(seed) {}
  double operator()() { return 2 * fraction() - 1; }
  double fraction() { return double(engine_()) / 4294967296.0; }
  int below(int n) { return int(fraction() * n); }

private:
  std::mt19937 engine_;
};

struct Mesh {
  std::vector<Double3> corners;
  std::vector<std::array<int, 3>> faces;

  /// Returns it as the text of an OBJ file.
  std::string text() const {
    std::string all;
    for (const Double3& p : corners) all += fmt::format("v {:.9g} {:.9g} {:.9g}\n", p.x, p.y, p.z);
    for (const auto& f : faces) all += fmt::format("f {} {} {}\n", f[0] + 1, f[1] + 1, f[2] + 1);
    return all;
  }
};

/// A random closed polyhedron about the origin: an affine image of a tetrahedron, a cube or an octahedron, or an octahedron
/// whose corners have random distances from the origin.
Mesh random_polyhedron(Dice& dice) {
  const int kind = dice.below(4);
  Mesh mesh;
  if (kind == 0) {
    mesh.corners = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
    mesh.faces = {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}};
  } else if (kind == 1) {
    for (int i = 0; i < 8; ++i)
      mesh.corners.push_back({i & 1 ? 0.7 : -0.7, i & 2 ? 0.7 : -0.7, i & 4 ? 0.7 : -0.7});
    mesh.faces = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                  {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  } else {
    mesh.corners = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    mesh.faces = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  }
  Double3 rows[3];
  double volume = 0;
  while (!(volume > 0.15)) {
    for (Double3& row : rows) row = {dice(), dice(), dice()};
    volume = dot(rows[0], cross(rows[1], rows[2]));
  }
  for (Double3& corner : mesh.corners) {
    const double stretch = kind == 3 ? 0.3 + 0.7 * dice.fraction() : 1;
    corner = Double3(dot(rows[0], corner), dot(rows[1], corner), dot(rows[2], corner)) * stretch;
  }
  return mesh;
}
Mesh random_triangles(Dice& dice, int count) {
  Mesh mesh;
  for (int i = 0; i < count; ++i) {
    for (int k = 0; k < 3; ++k) mesh.corners.push_back({dice(), dice(), dice()});
    mesh.faces.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  return mesh;
}

// Between ends so far from a mesh that no detour is a considerable part of the wavelength the wave of an outline is its winding
// number about the segment, and u/u0 = V - W is 1 whether the segment is occluded or not: outlines that enclose a segment
// occlude it. An error of W by 1 makes |u/u0| 0 or 2. Triangles one behind the other also diffract each other's waves over the 20
// wavelengths between them, so that |u/u0| need not be 1.
TEST(SegmentPower, WindingNumbersOfOutlinesAreVisibility) {
  const struct {
    const char* name;
    int count, triangles, most_wrong;
  } kRows[] = {{"closed polyhedra", 600, 0, 0},
               {"single triangles", 200, 1, 0},
               {"two triangles", 100, 2, 6},
               {"four triangles", 100, 4, 6}};
  const test::TemporaryFolder folder;
  Dice dice(1);
  for (const auto& [name, count, triangles, most_wrong] : kRows) {
    constexpr float kFar = 1000;
    constexpr int kSegments = 6;
    int wrong = 0, wrong_meshes = 0, occluded = 0;
    double worst = 0;
    for (int i = 0; i < (kSanitized ? 4 : count); ++i) {
      const Obstacles mesh(
          mesh_of(folder,
                  (triangles > 0 ? random_triangles(dice, triangles) : random_polyhedron(dice)).text()),
          0.1);
      bool is_wrong = false;
      for (int k = 0; k < kSegments; ++k) {
        const double x = 0.8 * dice(), y = 0.8 * dice(), turn_x = 100 * dice(), turn_y = 100 * dice();
        const Vec3 a{float(x + turn_x), float(y + turn_y), kFar},
            b{float(x - turn_x), float(y - turn_y), -kFar};
        const double off = std::abs(std::sqrt(mesh.factor(a, b)) - 1);
        occluded += !mesh.is_open(a, b);
        worst = std::max(worst, off);
        if (off > 0.5) ++wrong, is_wrong = true;
      }
      wrong_meshes += is_wrong;
    }
    std::printf(
        "%s: %d meshes, %d segments of %d occluded, %d disagree in %d meshes, largest difference of |u/u0| and 1: %.3f\n",
        name, count, occluded, count * kSegments, wrong, wrong_meshes, worst);
    EXPECT_LE(wrong, most_wrong) << name;
    if (!kSanitized) {
      EXPECT_GT(occluded, count * kSegments / 20) << name;
    }
  }
}

// On both sides of a point of an edge: where visibility changes there, the point lies on an outline, and u/u0 is continuous
// and about 1/2; elsewhere u/u0 is V. An outline without a change of visibility, or a change without an outline, would be an
// error of 1/2. No other edge of the mesh is within v = 6 of the segment.
TEST(SegmentPower, VisibilityChangesAtOutlines) {
  constexpr double kWavelength = 1e-4;
  const test::TemporaryFolder folder;
  Dice dice(5);
  for (const int triangles : {0, 1, 2, 4, 8}) {
    int meshes = 0, borders = 0, inner = 0, wrong = 0;
    double worst = 0;
    for (int i = 0; i < (kSanitized ? 4 : 200); ++i) {
      const Mesh mesh = triangles > 0 ? random_triangles(dice, triangles) : random_polyhedron(dice);
      const Obstacles obstacles(mesh_of(folder, mesh.text()), kWavelength);
      ++meshes;
      for (int k = 0; k < 12; ++k) {
        const auto& face = mesh.faces[std::size_t(dice.below(int(mesh.faces.size())))];
        const int corner = dice.below(3);
        const int first = face[std::size_t(corner)], second = face[std::size_t((corner + 1) % 3)];
        const Double3 from = mesh.corners[std::size_t(first)], to = mesh.corners[std::size_t(second)];
        const Double3 p = from + (to - from) * (0.2 + 0.6 * dice.fraction());
        const Double3 d = normalize(Double3(dice(), dice(), dice())), across = cross(d, to - from);
        if (!(length(across) > 0.3 * length(to - from))) continue;
        const Double3 beside = normalize(across) * (0.01 * std::sqrt(kWavelength));
        const double r = 3 + 2 * dice.fraction(), s = 3 + 2 * dice.fraction();
        double nearest = 1e9;
        for (const auto& other : mesh.faces)
          for (int c = 0; c < 3; ++c) {
            const int a = other[std::size_t(c)], b = other[std::size_t((c + 1) % 3)];
            if (std::minmax(a, b) == std::minmax(first, second)) continue;
            for (int step = 0; step <= 100; ++step) {
              const Double3 q =
                  mesh.corners[std::size_t(a)] +
                  (mesh.corners[std::size_t(b)] - mesh.corners[std::size_t(a)]) * (0.01 * step) - p;
              const double z = dot(q, d);
              nearest = std::min(
                  nearest, length(q - d * z) * std::sqrt(2 / kWavelength * (1 / (r + z) + 1 / (s - z))));
            }
          }
        if (nearest < 6) continue;
        bool open[2];
        double u[2];
        for (int side = 0; side < 2; ++side) {
          const Double3 off = beside * (side == 0 ? 1 : -1);
          const Vec3 a = (p - d * r + off).to_float(), b = (p + d * s + off).to_float();
          open[side] = obstacles.is_open(a, b);
          u[side] = std::sqrt(obstacles.factor(a, b));
        }
        const bool is_border = open[0] != open[1];
        ++(is_border ? borders : inner);
        for (int side = 0; side < 2; ++side) {
          const double off = std::abs(u[side] - (is_border ? 0.5 : open[side] ? 1.0 : 0.0));
          worst = std::max(worst, off);
          if (off > 0.25) {
            ++wrong;
            break;
          }
        }
      }
    }
    std::printf(
        "%d meshes of %d triangles: %d points of outlines, %d others, %d disagree, largest difference of |u/u0| %.3f\n",
        meshes, triangles, borders, inner, wrong, worst);
    EXPECT_EQ(wrong, 0) << triangles;
    if (!kSanitized) {
      EXPECT_GT(borders, 100) << triangles;
    }
  }
}

// Plates at all angles, with edges of up to 800 wavelengths, against the integral of the boundary wave along their outline.
TEST(SegmentPower, LongObliqueEdges) {
  const test::TemporaryFolder folder;
  constexpr double kWavelength = 0.01;
  for (const double size : {0.2, 1.0, 4.0}) {
    double worst = 0, worst_open = 0, squares = 0;
    int count = 0;
    for (const double slope : {0.1, 0.4, 1.0}) {
      Mesh mesh;
      for (const auto& [x, y] : {std::pair(-1, -1), {1, -1}, {1, 1}, {-1, 1}})
        mesh.corners.push_back(
            Double3(Vec3{float(size * x), float(size * y), float(0.5 * slope * size * (x + y))}));
      mesh.faces = {{0, 1, 2}, {0, 2, 3}};
      const Obstacles plate(mesh_of(folder, mesh.text()), kWavelength);
      const Double3 normal = cross(mesh.corners[1] - mesh.corners[0], mesh.corners[3] - mesh.corners[0]);
      Dice dice(6);
      for (int k = 0; k < (kSanitized ? 2 : 100); ++k) {
        const double x = 1.5 * size * dice(), y = 1.5 * size * dice(), turn_x = 3 * slope * dice(),
                     turn_y = 3 * slope * dice();
        const double up = size * slope + 3;
        const Vec3 a{float(x + turn_x), float(y + turn_y), float(up + 2 * dice.fraction())};
        const Vec3 b{float(x - turn_x), float(y - turn_y), float(-up - 2 * dice.fraction())};
        const bool is_open = plate.is_open(a, b);
        const Double3 from(a), to(b), d = normalize(to - from);
        const double distance = length(to - from);
        Field sum = 0;
        double nearest = distance;
        for (std::size_t e = 0; e < 4; ++e) {
          constexpr int kSteps = 6000;
          const Double3 step = (mesh.corners[(e + 1) % 4] - mesh.corners[e]) * (1.0 / kSteps);
          for (int i = 0; i < kSteps; ++i) {
            const Double3 p = mesh.corners[e] + step * (i + 0.5) - from, q = to - from - p;
            const Double3 off = p - d * dot(p, d);
            const double turn = dot(cross(off, step), d) / dot(off, off);
            nearest = std::min(nearest, length(off));
            const double cosine = dot(p, q) / (length(p) * length(q));
            sum += std::polar(std::sqrt(0.5 * (1 + cosine)) * turn,
                              2 * M_PI / kWavelength * (length(p) + length(q) - distance));
          }
        }
        const double u =
            std::abs((is_open ? 1.0 : 0.0) + (dot(normal, d) > 0 ? 1.0 : -1.0) * sum / (2 * M_PI));
        const double off = std::abs(std::sqrt(plate.factor(a, b)) - u);
        // The quadrature has no nodes nearer to an edge than that. Beside unoccluded segments waves fade out from v = 20.
        if (nearest < 0.01) continue;
        double& largest = is_open ? worst_open : worst;
        largest = std::max(largest, off), squares += off * off, ++count;
      }
    }
    std::printf("plates of %g wavelengths: amplitudes off by %.4f, of unoccluded segments %.4f, rms %.5f\n",
                2 * size / kWavelength, worst, worst_open, std::sqrt(squares / count));
    EXPECT_LT(worst, 0.003) << size;
    EXPECT_LT(worst_open, 0.01) << size;
    EXPECT_LT(std::sqrt(squares / count), 0.002) << size;
  }
}

/// A square of side 2 in n x n squares of two triangles each, as the text of OBJ files: one, or one for each triangle.
std::vector<std::string> square_in_triangles(int n, bool one_each, bool is_flipped,
                                             const std::function<Vec3(double, double)>& place) {
  std::vector<std::string> files;
  std::string vertices, faces;
  for (int i = 0; i <= n; ++i)
    for (int j = 0; j <= n; ++j) {
      const Vec3 p = place(2.0 * i / n - 1, 2.0 * j / n - 1);
      vertices += fmt::format("v {:.9g} {:.9g} {:.9g}\n", p.x, p.y, p.z);
    }
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const int a = i * (n + 1) + j + 1, b = a + 1, c = a + n + 2, d = a + n + 1;
      for (const auto& t : {std::array{a, d, c}, std::array{a, c, b}}) {
        faces += is_flipped ? fmt::format("f {} {} {}\n", t[0], t[2], t[1])
                            : fmt::format("f {} {} {}\n", t[0], t[1], t[2]);
        if (one_each) files.push_back(vertices + faces), faces.clear();
      }
    }
  if (!one_each) files.push_back(vertices + faces);
  return files;
}

TEST(SegmentPower, SubdivisionOrientationAndObjectsChangeNothing) {
  constexpr double kWavelength = 0.01;
  const test::TemporaryFolder folder;
  const auto flat = [](double x, double y) { return Vec3{float(x), float(y), 0}; };
  // A rotation by 40 degrees about (1, 2, 3).
  const auto turned = [](const Vec3& p) {
    const Vec3 axis = normalize(Vec3{1, 2, 3});
    const float c = std::cos(0.698f), s = std::sin(0.698f);
    return p * c + cross(axis, p) * s + axis * (dot(axis, p) * (1 - c));
  };
  const auto shapes = [&](const std::vector<std::string>& files) {
    std::string text;
    for (const std::string& file : files) text += mesh_of(folder, file);
    return text;
  };
  std::vector<std::pair<const char*, std::string>> scenes = {
      {"2 triangles", shapes(square_in_triangles(1, false, false, flat))},
      {"32 triangles", shapes(square_in_triangles(4, false, false, flat))},
      {"512 triangles", shapes(square_in_triangles(16, false, false, flat))},
      {"32 triangles, flipped", shapes(square_in_triangles(4, false, true, flat))},
      {"32 shapes", shapes(square_in_triangles(4, true, false, flat))},
      {"512 shapes", shapes(square_in_triangles(16, true, false, flat))},
      // Halves with 3 and with 5 parts along their common side.
      {"T-junctions", shapes(square_in_triangles(3, false, false,
                                                 [](double x, double y) {
                                                   return Vec3{float(0.5 * x - 0.5), float(y), 0};
                                                 })) +
                          shapes(square_in_triangles(5, false, true,
                                                     [](double x, double y) {
                                                       return Vec3{float(0.5 * x + 0.5), float(y), 0};
                                                     }))},
      {"rotated", shapes(square_in_triangles(4, false, false, [&](double x, double y) {
         return turned({float(x), float(y), 0});
       }))}};
  std::vector<Obstacles> obstacles;
  for (const auto& scene : scenes) obstacles.emplace_back(scene.second, kWavelength);
  std::vector<double> worst(scenes.size());
  Dice dice(2);
  for (int k = 0; k < (kSanitized ? 4 : 2000); ++k) {
    const double x = 1.6 * dice(), y = 1.6 * dice(), turn_x = 1.5 * dice(), turn_y = 1.5 * dice();
    const Vec3 a{float(x + turn_x), float(y + turn_y), float(3 + 2 * dice.fraction())};
    const Vec3 b{float(x - turn_x), float(y - turn_y), float(-3 - 2 * dice.fraction())};
    const double expected = obstacles[0].factor(a, b);
    for (std::size_t i = 1; i < scenes.size(); ++i) {
      const bool is_turned = std::string(scenes[i].first) == "rotated";
      const double u2 = is_turned ? obstacles[i].factor(turned(a), turned(b)) : obstacles[i].factor(a, b);
      worst[i] = std::max(worst[i], std::abs(u2 - expected) / std::max(expected, 1e-3));
    }
  }
  for (std::size_t i = 1; i < scenes.size(); ++i) {
    std::printf("%s: largest relative difference %.2e\n", scenes[i].first, worst[i]);
    EXPECT_LT(worst[i], 1e-3) << scenes[i].first;
  }
}

/// Scenes of metres at a wavelength of 1 cm, about the axis z.
std::vector<std::pair<const char*, std::string>> scenes_of_obstacles(double s) {
  const auto moved = [&](double x, double y, double z, double turn, const char* type, double sx, double sy,
                         double sz, const char* material) {
    return fmt::format(
        R"(<shape type="{}"><transform name="to_world"><scale x="{}" y="{}" z="{}"/><rotate x="0.3" y="1" angle="{}"/>
    <translate x="{}" y="{}" z="{}"/></transform>{}</shape>)",
        type, sx * s, sy * s, sz * s, turn, x * s, y * s, z * s, material);
  };
  const char* const metal = R"(<bsdf type="conductor"><string name="material" value="none"/></bsdf>)";
  const char* const glass = R"(<bsdf type="plastic"/>)";
  return {{"sheet", moved(0.4, 0.1, 0.3, 20, "rectangle", 0.5, 0.8, 1, kAbsorbs)},
          {"sheet of metal", moved(0.4, 0.1, 0.3, 20, "rectangle", 0.5, 0.8, 1, metal)},
          {"block", moved(-0.3, 0.2, -0.5, 15, "cube", 0.4, 0.6, 0.3, kAbsorbs)},
          {"block of metal", moved(-0.3, 0.2, -0.5, 15, "cube", 0.4, 0.6, 0.3, metal)},
          {"block of plastic", moved(-0.3, 0.2, -0.5, 15, "cube", 0.4, 0.6, 0.3, glass)},
          {"two sheets", moved(0.4, 0.1, 0.8, 10, "rectangle", 0.5, 0.8, 1, kAbsorbs) +
                             moved(-0.3, 0.3, -0.6, -25, "rectangle", 0.6, 0.5, 1, kAbsorbs)},
          {"two sheets of metal", moved(0.4, 0.1, 0.8, 10, "rectangle", 0.5, 0.8, 1, metal) +
                                      moved(-0.3, 0.3, -0.6, -25, "rectangle", 0.6, 0.5, 1, metal)}};
}

TEST(SegmentPower, FactorsAreReciprocal) {
  for (const auto& [name, shapes] : scenes_of_obstacles(1))
    for (const char* polarisation : {"none", "soft", "hard"}) {
      const Obstacles obstacles(shapes, 0.01, polarisation);
      Dice dice(3);
      double worst = 0;
      for (int k = 0; k < (kSanitized ? 4 : 300); ++k) {
        // Along the axis, and of lengths without rounding errors: other segments are rounded in another way in reverse.
        const float x = float(1.2 * dice()), y = float(1.2 * dice());
        const Vec3 a{x, y, 3 + float(dice.below(512)) / 256}, b{x, y, -3 - float(dice.below(512)) / 256};
        const double there = obstacles.factor(a, b), back = obstacles.factor(b, a);
        worst = std::max(worst, std::abs(there - back) / std::max(there, 1e-3));
      }
      std::printf("%s, %s: largest relative difference %.2e\n", name, polarisation, worst);
      // Two edges of one face that reflects act by the image of one end of the segment.
      const bool is_by_image =
          polarisation != std::string("none") && std::string(name).starts_with("block of");
      EXPECT_LT(worst, is_by_image ? 0.02 : 1e-6) << name << " " << polarisation;
    }
}

TEST(SegmentPower, SceneAndWavelengthScaleTogether) {
  const auto scenes = scenes_of_obstacles(1);
  for (const double scale : {1e-3, 1e3}) {
    const auto scaled = scenes_of_obstacles(scale);
    for (std::size_t i = 0; i < scenes.size(); ++i)
      for (const char* polarisation : {"none", "both"}) {
        const Obstacles usual(scenes[i].second, 0.01, polarisation),
            other(scaled[i].second, 0.01 * scale, polarisation);
        Dice dice(4);
        double worst = 0;
        for (int k = 0; k < (kSanitized ? 4 : 300); ++k) {
          const double x = 1.2 * dice(), y = 1.2 * dice();
          const Vec3 a{float(x + dice()), float(y), float(3 + 2 * dice.fraction())};
          const Vec3 b{float(x), float(y + dice()), float(-3 - 2 * dice.fraction())};
          const double expected = usual.factor(a, b);
          worst = std::max(worst, std::abs(other.factor(a * float(scale), b * float(scale)) - expected) /
                                      std::max(expected, 1e-3));
        }
        std::printf("%s, %s, times %g: largest relative difference %.2e\n", scenes[i].first, polarisation,
                    scale, worst);
        EXPECT_LT(worst, 1e-3) << scenes[i].first << " " << polarisation << " " << scale;
      }
  }
}

// The walls of a square opening in a sheet of half a wavelength, 40 wavelengths wide: rounding errors of its corners by up to a
// hundredth of the wavelength fold each wall along its diagonal, along which light runs as along the wall itself.
TEST(SegmentPower, RoundedCornersOfThinWallsChangeLittle) {
  const test::TemporaryFolder folder;
  const auto sheet = [&](double rounding) {
    Dice dice(7);
    Mesh mesh;
    for (const double half : {20.0, 3e4})
      for (const double z : {0.25, -0.25})
        for (const auto& [x, y] : {std::pair(-1, -1), {1, -1}, {1, 1}, {-1, 1}})
          mesh.corners.push_back({half * x + rounding * dice(), half * y + rounding * dice(), z});
    // Corners 0 to 3 of the opening at the top, 4 to 7 at the bottom, and those of the rim.
    const auto add = [&](int a, int b, int c, int d) {
      mesh.faces.push_back({a, b, c}), mesh.faces.push_back({a, c, d});
    };
    for (int i = 0; i < 4; ++i) {
      const int k = (i + 1) % 4;
      add(i, 8 + i, 8 + k, k), add(4 + i, 4 + k, 12 + k, 12 + i);
      add(i, k, 4 + k, 4 + i), add(8 + i, 12 + i, 12 + k, 8 + k);
    }
    return Obstacles(mesh_of(folder, mesh.text()), 1);
  };
  const Obstacles exact = sheet(0), rounded = sheet(0.01);
  double worst = 0, brightest = 0;
  for (int i = 0; i < (kSanitized ? 2 : 200); ++i) {
    const double r = 0.4 * i;
    const Vec3 a{1, 2, 1000}, b{float(r * std::cos(kGolden * i)), float(r * std::sin(kGolden * i)), -1000};
    const double u2 = exact.factor(a, b);
    worst = std::max(worst, std::abs(rounded.factor(a, b) - u2)), brightest = std::max(brightest, u2);
  }
  std::printf("rounded corners change intensities by %.4f of the brightest\n", worst / brightest);
  EXPECT_LT(worst, 0.03 * brightest);
}

/// Sides of the opening in a sheet of an OBJ file, in the plane of one of its faces. Each point is (x, y) of the file.
struct Opening {
  std::vector<std::array<std::array<double, 2>, 2>> sides;
  double depth = 0;  ///< z of that face
  std::string thin;  ///< that face as the text of an OBJ file

  explicit Opening(const std::filesystem::path& file) {
    std::vector<std::array<double, 3>> corners;
    std::vector<std::array<int, 3>> faces;
    std::ifstream in(file);
    for (std::string line; std::getline(in, line);) {
      std::istringstream words(line);
      std::string word;
      words >> word;
      if (word == "v") {
        auto& p = corners.emplace_back();
        words >> p[0] >> p[1] >> p[2];
      } else if (word == "f") {
        auto& t = faces.emplace_back();
        for (int& i : t) {
          words >> word;
          i = std::stoi(word) - 1;
        }
      }
    }
    // The plane that has the most triangles is one of the two faces.
    std::map<double, int> flat;
    const auto plane = [&](const std::array<int, 3>& t) {
      const double z = corners[std::size_t(t[0])][2];
      return z == corners[std::size_t(t[1])][2] && z == corners[std::size_t(t[2])][2] ? z : NAN;
    };
    for (const auto& t : faces)
      if (!std::isnan(plane(t))) ++flat[plane(t)];
    const auto most = std::max_element(flat.begin(), flat.end(),
                                       [](const auto& x, const auto& y) { return x.second < y.second; });
    depth = most->first;
    std::map<std::pair<int, int>, int> uses;
    for (const auto& p : corners) thin += fmt::format("v {} {} {}\n", p[0], p[1], p[2]);
    for (const auto& t : faces) {
      if (plane(t) != depth) continue;
      thin += fmt::format("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
      for (std::size_t k = 0; k < 3; ++k) ++uses[std::minmax(t[k], t[(k + 1) % 3])];
    }
    for (const auto& [ends, count] : uses) {
      const auto &a = corners[std::size_t(ends.first)], &b = corners[std::size_t(ends.second)];
      // The other sides are those of the sheet's rim.
      if (count == 1 && std::max({std::abs(a[0]), std::abs(a[1]), std::abs(b[0]), std::abs(b[1])}) < 1)
        sides.push_back({{{a[0], a[1]}, {b[0], b[1]}}});
    }
  }
  /// Calls visit(x, y, area) for the middles of small rectangles that cover the opening.
  void for_each(int rows, double step, const std::function<void(double, double, double)>& visit) const {
    double low = 1e30, high = -1e30;
    for (const auto& [a, b] : sides) low = std::min({low, a[1], b[1]}), high = std::max({high, a[1], b[1]});
    for (int i = 0; i < rows; ++i) {
      const double y = low + (high - low) * (i + 0.5) / rows;
      std::vector<double> at;
      for (const auto& [a, b] : sides)
        if ((a[1] < y) != (b[1] < y)) at.push_back(a[0] + (b[0] - a[0]) * (y - a[1]) / (b[1] - a[1]));
      std::sort(at.begin(), at.end());
      for (std::size_t k = 0; k + 1 < at.size(); k += 2) {
        const int n = 1 + int((at[k + 1] - at[k]) / step);
        const double width = (at[k + 1] - at[k]) / n;
        for (int j = 0; j < n; ++j) visit(at[k] + (j + 0.5) * width, y, width * (high - low) / rows);
      }
    }
  }
};

// The boxes of Steinberg et al. 2024: lines on the wall behind a sheet of half a wavelength with a star, two slits, a circle and a
// diamond, against Kirchhoff's integral over a thin opening. The walls of the openings absorb: where both of their edges are at
// v = 0, the field is 1/4 + asin(rho)/(2 pi) instead of 1/2, as if each side of the opening were about 0.1 wavelengths further in.
// The bands of the star are 6 to 8 wavelengths wide.
TEST(SegmentPower, BoxesOfSteinbergEtAl) {
  const std::filesystem::path data = test::source_dir() / "../shared/data/cornell-box";
  if (!std::filesystem::exists(data / "star.obj")) GTEST_SKIP() << data << " is absent";
  constexpr double kWavelength = 1e-4;
  const test::TemporaryFolder folder;
  for (const auto& [name, half, most_of_sum] :
       {std::tuple("star", 0.06, 0.045), {"doubleslit", 0.12, 0.03}, {"circdiamond", 0.06, 0.03}}) {
    const Opening opening(data / (std::string(name) + ".obj"));
    // As box.xml places the sheet: (x, y, z) of the file are at (-0.33 + 0.01 z, 1 + 0.315 x, 0.23 y).
    const auto sheet_of = [](const std::filesystem::path& file) {
      return fmt::format(
          R"(<shape type="obj"><string name="filename" value="{}"/><boolean name="face_normals" value="true"/>
  <transform name="to_world"><rotate z="1" angle="90"/><rotate y="1" angle="90"/><scale x=".01" y=".315" z=".23"/>
    <translate x="-.33" y="1"/></transform>{}</shape>)",
          file.string(), kAbsorbs);
    };
    const Obstacles sheets[] = {
        Obstacles(sheet_of(folder.write(std::string(name) + ".obj", opening.thin)), kWavelength),
        Obstacles(sheet_of(data / (std::string(name) + ".obj")), kWavelength)};
    const double x_sheet = -0.33 + 0.01 * opening.depth;
    std::vector<std::array<double, 3>> elements;  // y - 1, z and area
    double middle_y = 0, middle_z = 0, area = 0;
    opening.for_each(kSanitized ? 40 : 600, 4e-4, [&](double x, double y, double a) {
      elements.push_back({0.315 * x, 0.23 * y, 0.315 * 0.23 * a});
      middle_y += elements.back()[0] * elements.back()[2],
          middle_z += elements.back()[1] * elements.back()[2];
      area += elements.back()[2];
    });
    ASSERT_GT(area, 0);
    const double enlarged = 1.99 / (x_sheet + 0.99);
    middle_y *= enlarged / area, middle_z *= enlarged / area;
    for (const bool along_z : {false, true}) {
      constexpr int kPoints = 81;
      std::vector<double> expected, measured[2];
      double expected_sum = 0, sum[2] = {};
      for (int i = 0; i < (kSanitized ? 2 : kPoints); ++i) {
        const double at = half * (2.0 * i / (kPoints - 1) - 1);
        const double y = middle_y + (along_z ? 0 : at), z = middle_z + (along_z ? at : 0);
        const double distance = std::hypot(1.99, y, z), r0 = x_sheet + 0.99, s0 = 1 - x_sheet;
        Field u = 0;
        for (const auto& [ey, ez, a] : elements) {
          const double r = std::hypot(r0, ey, ez), s = std::hypot(s0, y - ey, z - ez);
          u += std::polar(a * distance / (r * s) * 0.5 * (r0 / r + s0 / s),
                          2 * M_PI / kWavelength * (r + s - distance));
        }
        expected.push_back(std::norm(u) / (kWavelength * kWavelength));
        expected_sum += expected.back();
        for (int k = 0; k < 2; ++k) {
          measured[k].push_back(sheets[k].factor({-0.99f, 1, 0}, {1, float(1 + y), float(z)}));
          sum[k] += measured[k].back();
        }
      }
      if (kSanitized) continue;
      const double brightest = *std::max_element(expected.begin(), expected.end());
      for (int k = 0; k < 2; ++k) {
        // Fringes: an extremum and the next one.
        double worst_fringe = 0, worst = 0;
        int fringes = 0;
        std::size_t last = 0;
        for (std::size_t i = 1; i + 1 < expected.size(); ++i) {
          worst = std::max(worst, std::abs(measured[k][i] - expected[i]) / brightest);
          if ((expected[i] - expected[i - 1]) * (expected[i + 1] - expected[i]) > 0) continue;
          const auto visibility = [&](const std::vector<double>& line) {
            return std::abs(line[i] - line[last]) / (line[i] + line[last]);
          };
          if (last > 0 && std::max(expected[i], expected[last]) > 0.05 * brightest) {
            worst_fringe = std::max(worst_fringe, std::abs(visibility(measured[k]) - visibility(expected)));
            ++fringes;
          }
          last = i;
        }
        std::printf(
            "%s along %s, %s: sum %+.2f %%, visibility of %d fringes off by %.4f, largest error %.4f of the brightest\n",
            name, along_z ? "z" : "y", k == 0 ? "one face" : "sheet", 100 * (sum[k] / expected_sum - 1),
            fringes, worst_fringe, worst);
        EXPECT_NEAR(sum[k] / expected_sum, 1, k == 0 ? 0.03 : most_of_sum) << name;
        EXPECT_LT(worst_fringe, 0.05) << name;
        EXPECT_GE(fringes, 2) << name;
      }
    }
  }
}

}  // namespace
}  // namespace aureole::testing

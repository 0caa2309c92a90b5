// SPDX-License-Identifier: Apache-2.0
// The diffraction model "segments" in pictures: knife edges, slits, squares, strips and discs against Fresnel's integrals,
// cell by cell, which share no code with the renderer.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <boost/math/special_functions/bessel.hpp>
#include <cmath>
#include <complex>
#include <filesystem>
#include <fstream>
#include <functional>
#include <vector>

#include "aureole/optics/faddeeva.h"
#include "harness/effort.h"
#include "harness/rendered.h"
#include "loading/load_text.h"

namespace aureole::testing {
namespace {

using test::kSanitized;
using Complex = std::complex<double>;

constexpr double kWavelength = 550e-9;

/// A white screen at z = -distance, of which the film shows [-half, half] in columns x rows cells; `further` are parameters of
/// the integrator.
std::string screen(const std::string& integrator, double distance, double half, int columns, int rows,
                   int samples, const std::string& further = "") {
  return fmt::format(
      R"(<integrator type="{0}"><boolean name="diffraction" value="true"/>
    <string name="diffraction_model" value="segments"/>{7}</integrator>
  <sensor type="orthographic"><transform name="to_world"><scale value="{2}"/>
    <lookat origin="0, 0, -{3}" target="0, 0, -{1}" up="0, 1, 0"/></transform>
    <film type="specfilm"><integer name="width" value="{4}"/><integer name="height" value="{5}"/><rfilter type="box"/>
      <float name="wavelength_min" value="549.9"/><float name="wavelength_max" value="550.1"/>
      <integer name="bins" value="1"/><boolean name="preview" value="false"/></film>
    <sampler type="sobol"><integer name="sample_count" value="{6}"/></sampler></sensor>
  <shape type="rectangle"><transform name="to_world"><scale value="20"/><translate z="-{1}"/></transform>
    <bsdf type="diffuse"><spectrum name="reflectance" value="1"/></bsdf></shape>)",
      integrator, distance, half, distance / 2, columns, rows, kSanitized ? 1 : samples, further);
}
/// Light along -z.
const char* const kFromInfinity =
    R"(<emitter type="directional"><vector name="direction" x="0" y="0" z="-1"/><spectrum name="irradiance" value="1"/></emitter>)";

/// Black sheets at z = 0 between a lamp at z = distance and a white screen at z = -distance, of which the film shows
/// [-half, half]^2 in columns x rows cells.
struct Bench {
  double distance, half;
  int columns, rows = 2;
  std::string sheets;
  int samples = 16;       ///< of each of 16 replicates
  bool has_spot = false;  ///< the lamp shines into a cone of 0.3 degrees

  Picture picture(const std::string& integrator = "path") const {
    return render(
        screen(integrator, distance, half, columns, rows, samples) +
        fmt::format(R"(<emitter type="{}"><spectrum name="intensity" value="1"/>)",
                    has_spot ? "spot" : "point") +
        (has_spot
             ? fmt::format(R"(<float name="cutoff_angle" value="0.3"/><float name="beam_width" value="0.29"/>
    <transform name="to_world"><lookat origin="0, 0, {}" target="0, 0, 0" up="0, 1, 0"/></transform>)",
                           distance)
             : fmt::format(R"(<point name="position" x="0" y="0" z="{}"/>)", distance)) +
        "</emitter>" + sheets);
  }
  /// Radiance of the screen without sheets.
  double unobstructed() const { return 1 / (4 * distance * distance * M_PI); }
  /// v in the plane of the sheets at x there, for the axis through a point of the screen.
  double v(double x, double screen) const {
    return (x - screen / 2) * std::sqrt(2 / (kWavelength * distance / 2));
  }
};

std::string sheet(double x0, double x1, double y0, double y1, double z = 0) {
  return fmt::format(
      R"(<shape type="rectangle"><transform name="to_world"><scale x="{}" y="{}"/><translate x="{}" y="{}" z="{}"/></transform>
    <bsdf type="diffuse"><spectrum name="reflectance" value="0"/></bsdf></shape>)",
      (x1 - x0) / 2, (y1 - y0) / 2, (x0 + x1) / 2, (y0 + y1) / 2, z);
}

/// A black mesh of the text of an OBJ file, which is written there.
std::string black_mesh(const std::filesystem::path& file, const std::string& text) {
  std::ofstream(file) << text;
  return R"(<shape type="obj"><string name="filename" value=")" + file.string() +
         R"("/><boolean name="face_normals" value="true"/><bsdf type="twosided"><bsdf type="diffuse">
    <spectrum name="reflectance" value="0"/></bsdf></bsdf></shape>)";
}

Complex slit(double a, double b) {
  return Complex(0.5, -0.5) * (optics::fresnel_integral(b) - optics::fresnel_integral(a));
}

/// Compares the rows and columns of a picture with the mean of `intensity(x, y)` over each cell.
void compare(const char* name, const Bench& bench, const std::function<double(double, double)>& intensity,
             double most_db, double most_of_sum = 0.005) {
  const Picture p = bench.picture();
  if (kSanitized) return;
  double worst = 0, sum = 0, expected_sum = 0, brightest = 0;
  std::vector<double> expected;
  const double width = 2 * bench.half / bench.columns;
  const double top = width * bench.rows / 2;
  constexpr int kSub = 12;
  for (int j = 0; j < bench.rows; ++j)
    for (int i = 0; i < bench.columns; ++i) {
      double mean = 0;
      for (int k = 0; k < kSub * kSub; ++k)
        mean += intensity(-bench.half + width * (i + (k % kSub + 0.5) / kSub),
                          top - width * (j + (k / kSub + 0.5) / kSub));
      expected.push_back(mean / (kSub * kSub));
      brightest = std::max(brightest, expected.back());
    }
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const double measured = p.mean[i] / bench.unobstructed();
    sum += measured, expected_sum += expected[i];
    if (expected[i] > 0.01 * brightest)
      worst = std::max(worst, std::abs(10 * std::log10(measured / expected[i])));
  }
  std::printf("%-24s largest error of a cell %.3f dB, of the sum %+.3f %%\n", name, worst,
              100 * (sum / expected_sum - 1));
  EXPECT_LT(worst, most_db) << name;
  EXPECT_NEAR(sum / expected_sum, 1, most_of_sum) << name;
}

TEST(SegmentDiffraction, SlitsAndStripsHaveFresnelsFringes) {
  for (const double w : {0.1e-3, 0.4e-3, 4e-3}) {
    const Bench bench{1, 4e-3, 64, 2, sheet(-1, -w / 2, -1, 1) + sheet(w / 2, 1, -1, 1)};
    compare(
        fmt::format("slit of {} mm", w * 1e3).c_str(), bench,
        [&](double x, double) { return std::norm(slit(bench.v(-w / 2, x), bench.v(w / 2, x))); }, 0.1);
  }
  for (const double w : {0.2e-3, 1e-3, 4e-3}) {
    const Bench bench{1, 4e-3, 64, 2, sheet(-w / 2, w / 2, -1, 1)};
    compare(
        fmt::format("strip of {} mm", w * 1e3).c_str(), bench,
        [&](double x, double) { return std::norm(1.0 - slit(bench.v(-w / 2, x), bench.v(w / 2, x))); }, 0.1);
  }
  for (const double distance : {1.0, 10.0}) {
    const Bench bench{distance, 3e-3 * distance, 64, 2,
                      sheet(-1, -0.4e-3, -1, 1) + sheet(-0.2e-3, 0.2e-3, -1, 1) + sheet(0.4e-3, 1, -1, 1)};
    compare(
        fmt::format("two slits at {} m", distance).c_str(), bench,
        [&](double x, double) {
          return std::norm(slit(bench.v(-0.4e-3, x), bench.v(-0.2e-3, x)) +
                           slit(bench.v(0.2e-3, x), bench.v(0.4e-3, x)));
        },
        0.2);
  }
}

TEST(SegmentDiffraction, SquaresAreProductsOfSlits) {
  for (const double h : {0.25e-3, 2e-3}) {
    const auto field = [&](const Bench& b, double x, double y) {
      return slit(b.v(-h, x), b.v(h, x)) * slit(b.v(-h, y), b.v(h, y));
    };
    const Bench opening{1,
                        3e-3,
                        24,
                        24,
                        sheet(-1, -h, -1, 1) + sheet(h, 1, -1, 1) + sheet(-h, h, -1, -h) + sheet(-h, h, h, 1),
                        16};
    compare(
        fmt::format("opening of {} mm", 2e3 * h).c_str(), opening,
        [&](double x, double y) { return std::norm(field(opening, x, y)); }, 0.2);
    const Bench plate{1, 3e-3, 24, 24, sheet(-h, h, -h, h), 64};
    compare(
        fmt::format("plate of {} mm", 2e3 * h).c_str(), plate,
        [&](double x, double y) { return std::norm(1.0 - field(plate, x, y)); }, 0.2);
  }
}

TEST(SegmentDiffraction, DiscsAndBallsHavePoissonsSpot) {
  // Over the middle 30 um of a shadow of 4 mm, v = 5.39 at the rim: on the axis as bright as without the disc.
  for (const std::string& shape :
       {R"(<shape type="disk"><transform name="to_world"><scale value="0.001"/></transform>)",
        R"(<shape type="sphere"><float name="radius" value="0.001"/>)"}) {
    const Bench bench{
        1,
        15e-6,
        2,
        2,
        shape + R"(<bsdf type="diffuse"><spectrum name="reflectance" value="0"/></bsdf></shape>)",
        16};
    const Picture p = bench.picture();
    if (kSanitized) continue;
    // J0^2 of the phase across the rim, 2 pi a x/(lambda z), for small x.
    double expected = 0;
    constexpr int kSub = 40;
    for (int k = 0; k < kSub * kSub; ++k) {
      const double x = 15e-6 * (k % kSub + 0.5) / kSub, y = 15e-6 * (k / kSub + 0.5) / kSub;
      const double phase = 2 * M_PI * 0.001 * std::hypot(x, y) / kWavelength;
      expected += std::pow(std::cyl_bessel_j(0, phase), 2) / (kSub * kSub);
    }
    for (const double value : p.mean) EXPECT_NEAR(value / bench.unobstructed(), expected, 0.01) << shape;
  }
}

/// The field behind two half planes x < h1 at z = s and x < h2 at z = -s, from a point on the axis at z = 1.5 to the point x
/// at z = -1.5: the field of the first in the plane of the second, integrated.
Complex two_half_planes(double h1, double h2, double s, double x) {
  const double r1 = 1.5 - s, l = 2 * s, r2 = 1.5 - s;
  const double across = std::sqrt(2 / kWavelength * (1 / (r1 + l) + 1 / r2));
  const double first = std::sqrt(2 / kWavelength * (1 / r1 + 1 / l));
  const double axis = x * (r1 + l) / (r1 + l + r2), begin = (h2 - axis) * across, length = 80;
  constexpr int kSteps = 20000;
  Complex sum = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double q = (i + 0.5) / kSteps, t = begin + q * length, end = std::max(0.0, q - 0.5) / 0.16;
    const double height = (axis + t / across) * r1 / (r1 + l) - h1;
    sum += std::polar(length / kSteps * std::exp(-end * end * end * end), M_PI / 2 * t * t) *
           optics::knife_edge_field(height * first);
  }
  return Complex(0.5, -0.5) * sum;
}

// One behind the other two edges act together, from 1 m apart to 10 um, where they are one. A block has such edges: light
// that runs along its top goes on behind it.
TEST(SegmentDiffraction, TwoEdgesOneBehindTheOther) {
  const auto half_plane = [](double h, double z) {
    return fmt::format(
        R"(<shape type="rectangle"><transform name="to_world"><scale x="{}"/><translate x="{}" z="{}"/></transform>
    <bsdf type="diffuse"><spectrum name="reflectance" value="0"/></bsdf></shape>)",
        (1 + h) / 2, (h - 1) / 2, z);
  };
  const auto block = [](double h, double s) {
    return fmt::format(
        R"(<shape type="cube"><transform name="to_world"><scale x="{}" z="{}"/><translate x="{}"/></transform>
    <bsdf type="diffuse"><spectrum name="reflectance" value="0"/></bsdf></shape>)",
        (1 + h) / 2, s, (h - 1) / 2);
  };
  for (const double s : {0.5, 0.05, 0.005, 5e-6})
    for (const auto& [h1, h2] : {std::pair(0.4e-3, 0.4e-3), {0.3e-3, -0.2e-3}, {0.0, 0.0}}) {
      Bench bench{1.5, 3e-3, 16, 2, half_plane(h1, s) + half_plane(h2, -s)};
      std::vector<std::string> scenes = {bench.sheets};
      if (h1 == h2) scenes.push_back(block(h1, s));
      std::vector<double> expected;
      for (int i = 0; i < bench.columns; ++i) {
        double mean = 0;
        constexpr int kSub = 4;
        for (int k = 0; k < kSub; ++k) {
          const double x = bench.half * (2 * (i + (k + 0.5) / kSub) / bench.columns - 1);
          mean += std::norm(two_half_planes(h1, h2, s, x)) / kSub;
        }
        expected.push_back(mean);
      }
      for (const std::string& scene : scenes) {
        bench.sheets = scene;
        const Picture p = bench.picture();
        if (kSanitized) continue;
        double worst = 0;
        for (std::size_t i = 0; i < expected.size(); ++i)
          worst = std::max(worst, std::abs(10 * std::log10(p.mean[i] / bench.unobstructed() / expected[i])));
        std::printf("edges %.4g m apart, %s: largest error %.3f dB\n", 2 * s,
                    &scene == &scenes[0] ? "sheets" : "block", worst);
        EXPECT_LT(worst, 0.2) << s << " " << h1 << " " << h2;
      }
    }
}

/// The radiance of a screen at z = -1, over that without sheets, under light along -z; cells of 0.25 mm from x = -1.5 mm.
std::vector<double> under_plane_wave(const std::string& sheets) {
  const auto picture = [](const std::string& shapes) {
    return render(screen("path", 1, 1.5e-3, 12, 1, 16) + kFromInfinity + shapes).mean;
  };
  std::vector<double> over = picture(sheets);
  const std::vector<double> free = picture("");
  for (std::size_t i = 0; i < over.size(); ++i) over[i] /= free[i];
  return over;
}

// More than two edges one behind the other: a product of pairs, exact for nearly coincident edges and for distant ones. The
// numbers are those of tests/render/references/rows_of_edges.py.
TEST(SegmentDiffraction, RowsOfEdges) {
  const struct {
    int count;
    double spacing, most_db;
    double intensity[12];
  } kRows[] = {{2,
                0.1,
                0.05,
                {0.0031774, 0.0051459, 0.0091979, 0.018722, 0.044583, 0.12325, 0.3605, 0.90457, 1.3939,
                 0.94746, 1.0389, 0.95535}},
               {3,
                0.001,
                0.2,
                {0.0063494, 0.0096366, 0.015896, 0.029484, 0.063128, 0.1553, 0.40337, 0.91235, 1.3337, 0.9636,
                 1.0121, 0.97325}},
               {3,
                0.1,
                1.5,
                {0.0017146, 0.0028778, 0.0054401, 0.011948, 0.031439, 0.097942, 0.3246, 0.9034, 1.4496,
                 0.92715, 1.0595, 0.95043}},
               {4,
                0.1,
                3.6,
                {0.0010074, 0.0017122, 0.0033352, 0.0077469, 0.022304, 0.078448, 0.29639, 0.91159, 1.4911,
                 0.90803, 1.0599, 0.95251}}};
  for (const auto& [count, spacing, most_db, intensity] : kRows) {
    std::string sheets;
    for (int i = 0; i < count; ++i)
      sheets += fmt::format(
          R"(<shape type="rectangle"><transform name="to_world"><scale x="0.5"/><translate x="-0.5" z="{}"/></transform>
    <bsdf type="diffuse"><spectrum name="reflectance" value="0"/></bsdf></shape>)",
          -spacing * i);
    const std::vector<double> measured = under_plane_wave(sheets);
    if (kSanitized) continue;
    double worst = 0;
    for (std::size_t i = 0; i < 12; ++i)
      worst = std::max(worst, std::abs(10 * std::log10(measured[i] / intensity[i])));
    std::printf("%d edges %g m apart: largest error %.2f dB\n", count, spacing, worst);
    EXPECT_LT(worst, most_db) << count << " " << spacing;
  }
}

// Light passes a bar on both sides, of which each has two edges one behind the other; far from it nothing is lost.
TEST(SegmentDiffraction, BarsHaveTwoEdgesOnEachSide) {
  for (const double s : {1e-3, 0.05}) {
    const double half = 1e-3;
    const Bench bench{1.5, 6e-3, 24, 2,
                      fmt::format(
                          R"(<shape type="cube"><transform name="to_world"><scale x="{}" z="{}"/></transform>
    <bsdf type="diffuse"><spectrum name="reflectance" value="0"/></bsdf></shape>)",
                          half, s)};
    const Picture p = bench.picture();
    if (kSanitized) continue;
    double worst = 0;
    for (int i = 0; i < bench.columns; ++i) {
      double mean = 0;
      constexpr int kSub = 4;
      for (int k = 0; k < kSub; ++k) {
        const double x = bench.half * (2 * (i + (k + 0.5) / kSub) / bench.columns - 1);
        mean += std::norm(two_half_planes(half, half, s, x) + two_half_planes(half, half, s, -x)) / kSub;
      }
      worst =
          std::max(worst, std::abs(10 * std::log10(p.mean[std::size_t(i)] / bench.unobstructed() / mean)));
    }
    std::printf("bar of 2 mm, %g mm thick: largest error %.3f dB\n", 2e3 * s, worst);
    EXPECT_LT(worst, 0.2) << s;
  }
}

// Edges across each other at any distance: light is the product of what both pass.
TEST(SegmentDiffraction, OutlinesThatCross) {
  const double h = 0.25e-3;
  // Fresnel's parameter of the point x of a plane at the height z.
  const auto v = [](double x, double z, double screen) {
    return (x - screen * (1 - z) / 2) * std::sqrt(2 * 2 / (kWavelength * (1 - z) * (1 + z)));
  };
  for (const double z : {3e-6, 0.1}) {
    const auto field = [&](double at, double screen) { return slit(v(-h, at, screen), v(h, at, screen)); };
    const Bench slits{
        1,
        3e-3,
        24,
        24,
        sheet(-1, -h, -1, 1, 0) + sheet(h, 1, -1, 1, 0) + sheet(-1, 1, -1, -h, z) + sheet(-1, 1, h, 1, z),
        8};
    compare(
        fmt::format("slits {} m apart", z).c_str(), slits,
        [&](double x, double y) { return std::norm(field(0, x) * field(z, y)); }, 0.2);
    const Bench corner{1, 3e-3, 24, 24, sheet(-1, 0, -1, 1, 0) + sheet(-1, 1, -1, 0, z), 4};
    compare(
        fmt::format("half planes {} m apart", z).c_str(), corner,
        [&](double x, double y) {
          return optics::knife_edge_intensity(-v(0, 0, x)) * optics::knife_edge_intensity(-v(0, z, y));
        },
        0.2);
  }
}

// Square openings in two sheets one behind the other, so thin against the Fresnel zone that they are one opening, and apart.
TEST(SegmentDiffraction, OpeningsOneBehindTheOther) {
  const double h = 0.25e-3;
  for (const auto& [apart, most_db] : {std::pair(1e-4, 0.25), {1e-3, 0.35}, {1e-2, 0.8}}) {
    std::string sheets;
    for (const double z : {apart / 2, -apart / 2})
      sheets +=
          sheet(-1, -h, -1, 1, z) + sheet(h, 1, -1, 1, z) + sheet(-h, h, -1, -h, z) + sheet(-h, h, h, 1, z);
    // One direction at a time: the field behind the first slit in the plane of the second, integrated over it.
    constexpr int kTable = 400;
    std::vector<Complex> table;
    for (int i = 0; i <= kTable; ++i) {
      const double x = 1.6e-3 * i / kTable, r1 = 1 - apart / 2, r2 = r1;
      const double across = std::sqrt(2 / kWavelength * (1 / (r1 + apart) + 1 / r2));
      const double first = std::sqrt(2 / kWavelength * (1 / r1 + 1 / apart));
      const double axis = x * (r1 + apart) / 2;
      constexpr int kSteps = 1500;
      Complex sum = 0;
      for (int k = 0; k < kSteps; ++k) {
        const double q = h * (2 * (k + 0.5) / kSteps - 1), t = (q - axis) * across;
        const double seen = q * r1 / (r1 + apart);
        sum += std::polar(2 * h / kSteps * across, M_PI / 2 * t * t) *
               slit((-h - seen) * first, (h - seen) * first);
      }
      table.push_back(Complex(0.5, -0.5) * sum);
    }
    const auto field = [&](double x) {
      const double at = std::abs(x) / 1.6e-3 * kTable;
      const auto i = std::size_t(at);
      return table[i] + (table[i + 1] - table[i]) * (at - double(i));
    };
    const Bench bench{1, 1.5e-3, 12, 12, sheets, 8};
    compare(
        fmt::format("openings {} m apart", apart).c_str(), bench,
        [&](double x, double y) { return std::norm(field(x) * field(y)); }, most_db, 0.03);
  }
}

// Two discs with a common axis, and a coin, whose rims are one behind the other. The intensities at 0, 0.05, ... 0.85 mm from
// the axis are those of tests/render/references/two_discs.py.
TEST(SegmentDiffraction, DiscsOneBehindTheOther) {
  const double radius = 0.3e-3;
  const struct {
    double apart, most_db;
    double intensity[18];
  } kRows[] = {{3e-4,
                0.12,
                {0.99014, 0.97554, 0.93275, 0.86487, 0.77735, 0.67817, 0.57798, 0.48967, 0.42738, 0.40463,
                 0.43162, 0.51211, 0.64061, 0.80109, 0.96838, 1.113, 1.2088, 1.2422}},
               {0.01,
                0.35,
                {0.94411, 0.92938, 0.8863, 0.81834, 0.73145, 0.63425, 0.53792, 0.45573, 0.40174, 0.38887,
                 0.42606, 0.51532, 0.64931, 0.8106, 0.9738, 1.1109, 1.199, 1.2284}},
               {0.1,
                1.3,
                {0.83493, 0.81831, 0.77016, 0.69567, 0.60345, 0.50539, 0.41598, 0.351, 0.32527, 0.34962,
                 0.42767, 0.5531, 0.70903, 0.87041, 1.0101, 1.1072, 1.155, 1.164}}};
  const test::TemporaryFolder folder;
  // A prism of 96 sides that has the area of the disc, from z = -thickness to 0.
  const auto coin = [&](double thickness) {
    constexpr int kSides = 96;
    const double r = radius * std::sqrt(2 * M_PI / kSides / std::sin(2 * M_PI / kSides));
    std::string vertices = fmt::format("v 0 0 0\nv 0 0 {}\n", -thickness), faces;
    for (int i = 0; i < kSides; ++i) {
      const double x = r * std::cos(2 * M_PI * i / kSides), y = r * std::sin(2 * M_PI * i / kSides);
      vertices += fmt::format("v {0} {1} 0\nv {0} {1} {2}\n", x, y, -thickness);
      const int a = 3 + 2 * i, b = 3 + 2 * ((i + 1) % kSides);
      faces += fmt::format("f 1 {0} {1}\nf 2 {3} {2}\nf {0} {2} {3}\nf {0} {3} {1}\n", a, b, a + 1, b + 1);
    }
    return black_mesh(folder.path / fmt::format("coin{}.obj", thickness), vertices + faces);
  };
  const auto discs = [&](double apart) {
    std::string shapes;
    for (const double z : {0.0, -apart})
      shapes += fmt::format(
          R"(<shape type="disk"><transform name="to_world"><scale value="{}"/><translate z="{}"/></transform>
    <bsdf type="diffuse"><spectrum name="reflectance" value="0"/></bsdf></shape>)",
          radius, z);
    return shapes;
  };
  const auto closed_cylinder = [&](double thickness) {
    return discs(thickness) +
           fmt::format(
               R"(<shape type="cylinder"><point name="p0" x="0" y="0" z="0"/><point name="p1" x="0" y="0" z="{}"/>
    <float name="radius" value="{}"/><bsdf type="diffuse"><spectrum name="reflectance" value="0"/></bsdf></shape>)",
               -thickness, radius);
  };
  const auto picture = [](const std::string& shapes) {
    return render(screen("path", 1, 0.6e-3, 12, 1, 2) + kFromInfinity + shapes).mean;
  };
  const double free = picture("")[0];
  for (const auto& [apart, most_db, intensity] : kRows)
    for (const auto& [name, shapes] : {std::pair("discs", discs(apart)),
                                       {"coin", coin(apart)},
                                       {"closed cylinder", closed_cylinder(apart)}}) {
      const std::vector<double> measured = picture(shapes);
      if (kSanitized) continue;
      double worst = 0;
      for (int i = 0; i < 12; ++i) {
        double mean = 0;
        constexpr int kSub = 8;
        for (int k = 0; k < kSub * kSub; ++k) {
          const double x = 1e-4 * (i - 6 + (k % kSub + 0.5) / kSub),
                       y = 1e-4 * ((k / kSub + 0.5) / kSub - 0.5);
          const double at = std::hypot(x, y) / 0.05e-3;
          mean += std::lerp(intensity[int(at)], intensity[int(at) + 1], at - int(at)) / (kSub * kSub);
        }
        worst = std::max(worst, std::abs(10 * std::log10(measured[std::size_t(i)] / free / mean)));
      }
      std::printf("%s, rims %g m apart: largest error %.2f dB\n", name, apart, worst);
      EXPECT_LT(worst, most_db) << apart;
    }
}

/// A white screen of 8 x 8 m at z = -1, of which the film shows [-1, 1] x [-0.25, 0.25] m in 8 cells, at 30 GHz.
std::string radio_screen(const std::string& integrator, int samples, double half_height = 0.25) {
  return integrator +
         fmt::format(R"(<sensor type="orthographic"><transform name="to_world"><scale x="1" y="{}"/>
    <lookat origin="0, 0, -0.3" target="0, 0, -1" up="0, 1, 0"/></transform>
    <film type="specfilm"><integer name="width" value="8"/><integer name="height" value="1"/><rfilter type="box"/>
      <string name="wavelength_min" value="30.01GHz"/><string name="wavelength_max" value="29.99GHz"/>
      <integer name="bins" value="1"/><boolean name="preview" value="false"/></film>
    <sampler type="sobol"><integer name="sample_count" value="{}"/></sampler></sensor>
  <shape type="rectangle"><transform name="to_world"><scale value="4"/><translate z="-1"/></transform>
    <bsdf type="diffuse"><spectrum name="reflectance" value="1"/></bsdf></shape>)",
                     half_height, kSanitized ? 1 : samples);
}
std::string with_segments(const std::string& type, const std::string& further = "") {
  return "<integrator type=\"" + type + R"("><boolean name="diffraction" value="true"/>
    <string name="diffraction_model" value="segments"/>)" +
         further + "</integrator>";
}
/// A square light of side 1.2 m at the height z, which emits downwards.
std::string square_light(double x, double z, const std::string& further = "") {
  return fmt::format(
      R"(<shape type="rectangle"><transform name="to_world"><scale value="0.6"/><rotate x="1" angle="180"/>
    <translate x="{}" z="{}"/></transform><emitter type="area"><spectrum name="radiance" value="1"/>{}</emitter></shape>)",
      x, z, further);
}
const char* const kBlack = R"(<bsdf type="diffuse"><spectrum name="reflectance" value="0"/></bsdf></shape>)";

// A light with a shape is found in a shadow by connections, by rays of the BSDF that go on behind the obstacle, and by both: a
// sheet, which such a ray passes once, and a block, which it passes twice.
TEST(SegmentDiffraction, ConnectionsAndRaysBehindObstaclesAgree) {
  const std::string sheet =
      std::string(
          R"(<shape type="rectangle"><transform name="to_world"><scale x="2" y="4"/><translate x="-2"/></transform>)") +
      kBlack;
  const std::string block =
      std::string(
          R"(<shape type="cube"><transform name="to_world"><scale x="1" y="4" z="0.05"/><translate x="-1"/></transform>)") +
      kBlack;
  const std::string two = R"(<integer name="max_depth" value="2"/>)";
  for (const std::string& obstacle : {sheet, block}) {
    const auto picture = [&](const std::string& integrator, const std::string& further, int samples) {
      return render(radio_screen(integrator, samples) + square_light(0.4, 1.5, further) + obstacle);
    };
    const Picture both = picture(with_segments("path", two), "", 64);
    const Picture rays =
        picture(with_segments("path", two), R"(<float name="sampling_weight" value="0"/>)", 1024);
    const Picture two_way = picture(with_segments("bdpt", two), "", 64);
    const Picture connections =
        picture(with_segments(
                    "direct",
                    R"(<integer name="emitter_samples" value="1"/><integer name="bsdf_samples" value="0"/>)"),
                "", 64);
    if (kSanitized) continue;
    for (std::size_t i = 0; i < both.mean.size(); ++i) {
      std::printf("%s cell %zu: both %.5f +- %.5f, rays %.5f +- %.5f, connections %.5f +- %.5f\n",
                  &obstacle == &sheet ? "sheet" : "block", i, both.mean[i], both.error[i], rays.mean[i],
                  rays.error[i], connections.mean[i], connections.error[i]);
      // All of the light is more than 4.5 standard errors: rays that miss it fail. Few rays reach the darkest cell (0.15 %).
      if (connections.mean[i] > 0.01 * connections.mean.back())
        EXPECT_LT(rays.error[i], 0.2 * connections.mean[i]);
      EXPECT_LT(std::abs(rays.mean[i] - connections.mean[i]),
                4.5 * std::hypot(rays.error[i], connections.error[i]) + 0.002 * connections.mean[i]);
      EXPECT_LT(std::abs(both.mean[i] - connections.mean[i]),
                4.5 * std::hypot(both.error[i], connections.error[i]) + 0.002 * connections.mean[i]);
      EXPECT_LT(std::abs(two_way.mean[i] - connections.mean[i]),
                4.5 * std::hypot(two_way.error[i], connections.error[i]) + 0.002 * connections.mean[i]);
    }
  }
}

// Light of a lamp that a ceiling sends towards a sheet, and around the sheet's edge. Connections to the lamp do not find it.
// Of a mirror rays of `path` find it that go on behind the sheet; of a white ceiling connections of `bdpt` do as well.
TEST(SegmentDiffraction, LightOfACeilingGoesAroundObstacles) {
  const std::string three = R"(<integer name="max_depth" value="3"/>)";
  for (const bool is_mirror : {true, false}) {
    const std::string scene =
        R"(<shape type="rectangle"><transform name="to_world"><scale value="0.75"/><translate x="2" z="1"/></transform>
    <emitter type="area"><spectrum name="radiance" value="1"/></emitter></shape>
  <shape type="rectangle"><transform name="to_world"><scale value="4"/><rotate x="1" angle="180"/><translate z="2.5"/></transform>)" +
        std::string(is_mirror
                        ? R"(<bsdf type="conductor"><string name="material" value="none"/></bsdf></shape>)"
                        : R"(<bsdf type="diffuse"><spectrum name="reflectance" value="1"/></bsdf></shape>)") +
        R"(<shape type="rectangle"><transform name="to_world"><scale x="2" y="4"/><translate x="-2"/></transform>)" +
        kBlack;
    // Sums over the four cells behind the sheet and over the four beside it.
    const auto halves = [&](const std::string& type, int samples) {
      const Picture p = render(radio_screen(with_segments(type, three), samples, 2) + scene);
      std::array<std::pair<double, double>, 2> sums{};
      for (std::size_t i = 0; i < p.mean.size(); ++i) {
        auto& [mean, error] = sums[i / 4];
        mean += p.mean[i], error = std::hypot(error, p.error[i]);
      }
      return sums;
    };
    const auto from_sensor = halves("path", is_mirror ? 256 : 64);
    std::vector<std::pair<std::string, int>> others = {{"ptracer", 1024}};
    if (!is_mirror) others.push_back({"bdpt", 32});
    for (const auto& [type, samples] : others) {
      const auto other = halves(type, samples);
      if (kSanitized) continue;
      for (std::size_t i = 0; i < 2; ++i) {
        const auto& [a, a_error] = from_sensor[i];
        const auto& [b, b_error] = other[i];
        std::printf("%s, %s: path %.5f +- %.5f, %s %.5f +- %.5f\n", is_mirror ? "mirror" : "white",
                    i == 0 ? "shadow" : "light", a, a_error, type.c_str(), b, b_error);
        EXPECT_LT(std::abs(a - b), 4.5 * std::hypot(a_error, b_error));
        EXPECT_LT(a_error, 0.15 * a);
        EXPECT_LT(b_error, 0.15 * a);
      }
    }
  }
}

/// The exact field of a plane wave at a wedge of metal, a series of Bessel functions (Bowman, Senior & Uslenghi 1969, chapter 6), at
/// the distance rho in wavelengths.
Complex field_at_wedge(double n, double rho, double phi, double phi_i, bool is_hard) {
  const double x = 2 * M_PI * rho;
  Complex sum = 0;
  for (int m = 0; m <= int(n * (x + 30 + 6 * std::cbrt(x))); ++m) {
    const double nu = m / n;
    const double product =
        is_hard ? std::cos(nu * phi) * std::cos(nu * phi_i) : std::sin(nu * phi) * std::sin(nu * phi_i);
    sum +=
        (m == 0 ? 1.0 : 2.0) * std::polar(1.0, -M_PI / 2 * nu) * boost::math::cyl_bessel_j(nu, x) * product;
  }
  return 2 / n * sum;
}

/// A place about the y axis: its distance [m], and its angle from the upper face of a block whose right upper edge lies in that axis.
struct PlaceAboutEdge {
  double distance, angle;

  double x() const { return -distance * std::cos(angle); }
  double z() const { return distance * std::sin(angle); }
};

/// Returns the power at 3 GHz that a receiver takes from a transmitter, both beside a block with that BSDF; empty: without the block.
double power_beside_block(const PlaceAboutEdge& from, const PlaceAboutEdge& to,
                          const std::string& polarisation, const std::string& bsdf) {
  return render(
             fmt::format(
                 R"(<integrator type="path"><boolean name="diffraction" value="true"/><integer name="max_depth" value="1"/>
    <string name="diffraction_model" value="segments"/><string name="diffraction_polarisation" value="{}"/></integrator>
  <sensor type="powermap"><transform name="to_world"><scale value="0.001"/><translate x="{}" z="{}"/></transform>
    <film type="specfilm"><integer name="width" value="1"/><integer name="height" value="1"/><rfilter type="box"/>
      <string name="wavelength_min" value="3.0001GHz"/><string name="wavelength_max" value="2.9999GHz"/>
      <integer name="bins" value="1"/><boolean name="preview" value="false"/></film>
    <sampler type="sobol"><integer name="sample_count" value="1"/></sampler></sensor>
  <emitter type="point"><point name="position" x="{}" y="0" z="{}"/><spectrum name="intensity" value="1"/></emitter>
  )",
                 polarisation, to.x(), to.z(), from.x(), from.z()) +
             (bsdf.empty()
                  ? ""
                  : R"(<shape type="cube"><transform name="to_world"><scale value="200"/><translate x="-200" z="-200"/></transform>)" +
                        bsdf + "</shape>"))
      .mean[0];
}

// A block of metal whose right upper edge lies in the y axis, at 3 GHz: a transmitter 5 km away, 45 degrees above its top, and
// receivers 10 m below the edge, beside the right face. Soft and hard waves against the exact series.
TEST(SegmentDiffraction, WedgesOfMetalHaveTwoPolarisations) {
  const double wavelength = 299792458 / 3e9, rho = 10, phi_i = M_PI / 4;
  const auto power = [&](double degrees, const std::string& polarisation, bool has_block) {
    return power_beside_block(
        {5000, phi_i}, {rho, phi_i + M_PI + degrees * M_PI / 180}, polarisation,
        has_block ? R"(<bsdf type="conductor"><string name="material" value="none"/></bsdf>)" : "");
  };
  double worst = 0, soft_at_9 = 0, hard_at_9 = 0, soft_at_21 = 0, hard_at_21 = 0;
  for (const double degrees : {1.0, 9.0, 21.0, 35.0}) {
    const double free = power(degrees, "none", false);
    double both = 0;
    for (const bool is_hard : {false, true}) {
      const double measured = power(degrees, is_hard ? "hard" : "soft", true) / free;
      both += 0.5 * measured;
      if (kSanitized) continue;
      const double phi = phi_i + M_PI + degrees * M_PI / 180;
      const double exact = std::norm(field_at_wedge(1.5, rho / wavelength, phi, phi_i, is_hard));
      const double off = 10 * std::log10(measured / exact);
      const double turn = degrees * M_PI / 180, v = 2 * std::sqrt(2 * rho / wavelength) * std::sin(turn / 2);
      const double over = 10 * std::log10(measured / optics::knife_edge_intensity(-v));
      std::printf(
          "wedge of 90 degrees, %g degrees in the shadow, %s: %+.3f dB of the half plane, %+.3f dB off the exact series\n",
          degrees, is_hard ? "hard" : "soft", over, off);
      if (degrees == 9) (is_hard ? hard_at_9 : soft_at_9) = over;
      if (degrees == 21) (is_hard ? hard_at_21 : soft_at_21) = over;
      worst = std::max(worst, std::abs(off));
    }
    EXPECT_NEAR(power(degrees, "both", true) / free, both, 1e-4 * both) << degrees;
    // Without polarisation it is a half plane that absorbs.
    const double v = 2 * std::sqrt(2 * rho / wavelength) * std::sin(degrees * M_PI / 360);
    if (!kSanitized)
      EXPECT_NEAR(power(degrees, "none", true) / free / optics::knife_edge_intensity(-v), 1, 0.01) << degrees;
  }
  if (kSanitized) return;
  EXPECT_LT(worst, 0.1);
  EXPECT_NEAR(soft_at_9, -1.42, 0.1);
  EXPECT_NEAR(hard_at_9, 1.69, 0.1);
  EXPECT_NEAR(soft_at_21, -3.96, 0.1);
  EXPECT_NEAR(hard_at_21, 3.68, 0.1);
}

/// Returns the loss [dB] at a receiver by obstacles in a scene of metres at 3 GHz, or rather 0.1 m, with that polarisation.
double loss_of(const std::string& obstacles, const std::string& polarisation, Vec3 lamp, Vec3 receiver) {
  const auto fluence = [&](const std::string& shapes) {
    return render(
               fmt::format(
                   R"(<integrator type="path"><integer name="max_depth" value="1"/><boolean name="diffraction" value="true"/>
    <string name="diffraction_polarisation" value="{}"/></integrator>
  <sensor type="powermap"><transform name="to_world"><scale x="1e-3" y="1e-3"/><translate x="{}" y="{}" z="{}"/></transform>
    <string name="measure" value="fluence"/>
    <film type="specfilm"><integer name="width" value="1"/><integer name="height" value="1"/>
      <string name="wavelength_min" value="99.999mm"/><string name="wavelength_max" value="100.001mm"/>
      <integer name="bins" value="1"/><boolean name="preview" value="false"/><rfilter type="box"/></film>
    <sampler type="sobol"><integer name="sample_count" value="1"/></sampler></sensor>
  <emitter type="point"><point name="position" x="{}" y="{}" z="{}"/><spectrum name="intensity" value="1"/></emitter>)",
                   polarisation, receiver.x, receiver.y, receiver.z, lamp.x, lamp.y, lamp.z) +
               shapes)
        .mean[0];
  };
  return 10 * std::log10(fluence(obstacles) / fluence(""));
}

/// A block of metal without end below and on both sides, whose roof lies in the plane z = 0, 0 < x < `thickness`.
std::string block_of_metal(double thickness) {
  return fmt::format(
      R"(<shape type="cube"><transform name="to_world"><scale x="{0}" y="4000" z="2000"/><translate x="{0}" z="-2000"/></transform>
    <bsdf type="conductor"><string name="material" value="none"/></bsdf></shape>)",
      thickness / 2);
}

// Receivers move upwards through the plane of a roof, in whose plane or beside whose plane the transmitter lies: the loss
// changes in small steps.
TEST(SegmentDiffraction, LossesAreContinuousInThePlaneOfARoof) {
  std::vector<float> heights = {0};
  for (double h = 1e-6; h < 0.5; h *= kSanitized ? 20 : 4)
    heights.push_back(float(h)), heights.push_back(float(-h));
  std::sort(heights.begin(), heights.end());
  double largest = 0;
  for (const double thickness : {0.03, 0.3, 3.0})
    for (const char* polarisation : {"none", "soft", "hard"})
      for (const float lamp : {0.f, 1e-6f, -1e-6f, -1e-4f, 0.005f, -0.005f, 0.02f, -0.2f, 1.f}) {
        if (kSanitized && std::abs(lamp) > 1e-6f) continue;
        double before = 0;
        float lower = heights.front();
        for (const float z : heights) {
          const double here =
              loss_of(block_of_metal(thickness), polarisation, {-2, 0, lamp}, {float(thickness) + 2, 0, z});
          ASSERT_TRUE(std::isfinite(here)) << thickness << ", " << polarisation << ", " << lamp << ", " << z;
          if (z != heights.front()) {
            // Receivers farther from the plane are farther from each other: up to 10 degrees. Both heights within rounding errors
            // of the coordinates of the block, of 4 km, leave it open whether the segment is occluded.
            constexpr float kRounding = 1e-5f;
            const bool is_rounded = lamp != 0 && std::max(std::abs(lamp), std::abs(z)) < kRounding;
            const float farther = std::max(std::abs(z), std::abs(lower));
            const double step = std::abs(here - before), most = farther > 0.02f ? 9 : is_rounded ? 3 : 1;
            if (farther <= 0.02f && !is_rounded) largest = std::max(largest, step);
            if (!kSanitized)
              EXPECT_LT(step, most) << thickness << ", " << polarisation << ", " << lamp << ", " << z;
          }
          before = here, lower = z;
        }
      }
  std::printf("largest step of receivers up to 0.6 degrees from the plane of a roof: %.2f dB\n", largest);
}

// Another block occludes receivers above a roof, as one side of a slit does: the loss changes little as the transmitter
// moves through the plane of the roof.
TEST(SegmentDiffraction, RoofsBesideSegmentsThatAnotherBodyOccludes) {
  const std::string other =
      R"(<shape type="cube"><transform name="to_world"><scale x="0.0125" y="4000" z="2000"/><translate x="0.0125" z="2000.2"/></transform>
    <bsdf type="conductor"><string name="material" value="none"/></bsdf></shape>)";
  for (const char* polarisation : {"soft", "hard"})
    for (const float z : {0.4f, 0.6f, 1.f}) {
      const auto loss = [&](float lamp) {
        return loss_of(block_of_metal(0.025) + other, polarisation, {-2, 0, lamp}, {2, 0, z});
      };
      const double in_plane = loss(0);
      if (kSanitized) continue;
      for (const float lamp : {1e-3f, -1e-3f, 1e-5f, -1e-5f})
        EXPECT_NEAR(loss(lamp), in_plane, 0.1) << polarisation << ", " << z << ", " << lamp;
    }
}

// Transmitters and receivers near the plane of the roof of a block of metal, above it, in it and below it, against a
// boundary integral equation (tests/render/references/metal_block.py).
TEST(SegmentDiffraction, EndsNearThePlaneOfARoof) {
  constexpr double kMetre = 0.1;  // wavelength
  constexpr double kBeta[] = {10, 2, 0.5, 0, -0.1, -0.5, -2, -5};
  struct Reference {
    double thickness, alpha, db[8];
  };
  const Reference soft[] = {
      {0.3, 2, {-15.71, -10.08, -8.96, -8.59, -8.51, -8.21, -7.04, -4.76}},
      {0.3, 0.5, {-14.68, -8.96, -7.82, -7.42, -7.34, -7.04, -5.91, -3.67}},
      {0.3, 0, {-14.33, -8.59, -7.42, -7.04, -6.96, -6.66, -5.53, -3.31}},
      {0.3, -0.1, {-14.27, -8.51, -7.34, -6.96, -6.88, -6.58, -5.45, -3.24}},
      {0.3, -0.5, {-14.01, -8.21, -7.04, -6.66, -6.58, -6.28, -5.14, -2.96}},
      {0.3, -2, {-13.02, -7.04, -5.91, -5.53, -5.45, -5.14, -4.03, -1.93}},
      {0.3, -5, {-10.85, -4.76, -3.67, -3.31, -3.24, -2.96, -1.93, -0.14}},
      {1, 2, {-17.27, -11.19, -9.98, -9.58, -9.50, -9.17, -7.93, -5.48}},
      {1, 0.5, {-16.16, -9.98, -8.75, -8.34, -8.25, -7.93, -6.70, -4.30}},
      {1, 0, {-15.80, -9.58, -8.34, -7.93, -7.84, -7.52, -6.30, -3.91}},
      {1, -0.1, {-15.73, -9.50, -8.25, -7.84, -7.76, -7.44, -6.21, -3.83}},
      {1, -0.5, {-15.44, -9.17, -7.93, -7.52, -7.44, -7.11, -5.89, -3.52}},
      {1, -2, {-14.33, -7.93, -6.70, -6.30, -6.21, -5.89, -4.69, -2.41}},
      {1, -5, {-12.00, -5.48, -4.30, -3.91, -3.83, -3.52, -2.41, -0.41}},
      {3, 2, {-19.94, -13.12, -11.76, -11.31, -11.22, -10.85, -9.48, -6.76}},
      {3, 0.5, {-18.70, -11.76, -10.39, -9.94, -9.84, -9.48, -8.11, -5.43}},
      {3, 0, {-18.28, -11.30, -9.94, -9.48, -9.39, -9.02, -7.66, -4.99}},
      {3, -0.1, {-18.20, -11.21, -9.84, -9.39, -9.30, -8.93, -7.57, -4.91}},
      {3, -0.5, {-17.86, -10.85, -9.48, -9.02, -8.93, -8.57, -7.21, -4.56}},
      {3, -2, {-16.59, -9.48, -8.12, -7.66, -7.57, -7.21, -5.86, -3.29}},
      {3, -5, {-13.96, -6.76, -5.43, -4.99, -4.90, -4.56, -3.29, -0.97}},
      {8, 2, {-23.84, -16.05, -14.51, -13.99, -13.89, -13.47, -11.93, -8.85}},
      {8, 0.5, {-22.39, -14.51, -12.96, -12.44, -12.34, -11.93, -10.38, -7.33}},
      {8, 0, {-21.91, -13.99, -12.44, -11.93, -11.83, -11.42, -9.86, -6.83}},
      {8, -0.1, {-21.81, -13.89, -12.34, -11.83, -11.73, -11.31, -9.75, -6.73}},
      {8, -0.5, {-21.42, -13.47, -11.93, -11.42, -11.31, -10.90, -9.34, -6.33}},
      {8, -2, {-19.92, -11.93, -10.38, -9.86, -9.75, -9.34, -7.81, -4.85}},
      {8, -5, {-16.92, -8.85, -7.33, -6.83, -6.73, -6.32, -4.85, -2.08}},
  };
  const Reference hard[] = {
      {0.3, 2, {-12.94, -8.33, -7.32, -7.11, -7.07, -6.86, -5.71, -3.85}},
      {0.3, 0.5, {-11.95, -7.32, -6.51, -6.10, -6.02, -5.70, -4.86, -2.91}},
      {0.3, 0, {-11.54, -7.11, -6.10, -5.70, -5.63, -5.37, -4.57, -2.66}},
      {0.3, -0.1, {-11.48, -7.06, -6.02, -5.63, -5.56, -5.31, -4.51, -2.61}},
      {0.3, -0.5, {-11.28, -6.85, -5.70, -5.37, -5.31, -5.10, -4.22, -2.38}},
      {0.3, -2, {-10.87, -5.70, -4.86, -4.57, -4.51, -4.22, -3.18, -1.43}},
      {0.3, -5, {-9.00, -3.85, -2.91, -2.66, -2.61, -2.39, -1.43, -0.01}},
      {1, 2, {-13.31, -8.30, -7.37, -7.14, -7.09, -6.86, -5.72, -3.83}},
      {1, 0.5, {-12.27, -7.40, -6.52, -6.11, -6.03, -5.72, -4.85, -2.89}},
      {1, 0, {-11.84, -7.17, -6.11, -5.72, -5.65, -5.39, -4.54, -2.63}},
      {1, -0.1, {-11.77, -7.12, -6.03, -5.65, -5.59, -5.34, -4.47, -2.58}},
      {1, -0.5, {-11.54, -6.89, -5.73, -5.40, -5.34, -5.12, -4.19, -2.35}},
      {1, -2, {-10.76, -5.76, -4.87, -4.55, -4.48, -4.19, -3.15, -1.39}},
      {1, -5, {-8.90, -3.82, -2.87, -2.61, -2.56, -2.33, -1.38, 0.03}},
      {3, 2, {-13.76, -8.18, -7.32, -7.09, -7.04, -6.79, -5.63, -3.79}},
      {3, 0.5, {-12.23, -7.46, -6.50, -6.08, -6.00, -5.70, -4.82, -2.81}},
      {3, 0, {-11.83, -7.23, -6.07, -5.68, -5.62, -5.37, -4.48, -2.52}},
      {3, -0.1, {-11.78, -7.17, -5.98, -5.61, -5.54, -5.30, -4.41, -2.46}},
      {3, -0.5, {-11.67, -6.88, -5.65, -5.33, -5.27, -5.06, -4.08, -2.22}},
      {3, -2, {-11.34, -5.54, -4.71, -4.41, -4.34, -4.05, -3.00, -1.28}},
      {3, -5, {-9.27, -3.67, -2.75, -2.50, -2.44, -2.21, -1.23, 0.18}},
      {8, 2, {-13.82, -8.44, -7.59, -7.22, -7.14, -6.79, -5.64, -3.65}},
      {8, 0.5, {-12.81, -7.57, -6.36, -5.99, -5.93, -5.69, -4.83, -2.67}},
      {8, 0, {-12.30, -7.22, -6.00, -5.70, -5.64, -5.44, -4.45, -2.36}},
      {8, -0.1, {-12.21, -7.14, -5.93, -5.64, -5.59, -5.39, -4.36, -2.30}},
      {8, -0.5, {-11.89, -6.80, -5.69, -5.43, -5.38, -5.17, -4.02, -2.03}},
      {8, -2, {-11.18, -5.59, -4.77, -4.40, -4.32, -3.99, -2.94, -1.02}},
      {8, -5, {-8.92, -3.68, -2.70, -2.40, -2.34, -2.07, -1.00, 0.61}},
  };
  for (const bool is_hard : {false, true}) {
    double worst = 0, squares = 0;
    int count = 0;
    for (const Reference& r : is_hard ? hard : soft)
      for (std::size_t i = 0; i < std::size(kBeta); ++i) {
        if (kSanitized && (r.thickness != 3 || i % 3 != 0)) continue;
        const double a = r.alpha * M_PI / 180, b = kBeta[i] * M_PI / 180, thickness = r.thickness * kMetre;
        const Vec3 lamp{float(-2 * std::cos(a)), 0, float(-2 * std::sin(a))};
        const Vec3 receiver{float(thickness + 2 * std::cos(b)), 0, float(-2 * std::sin(b))};
        const double off =
            loss_of(block_of_metal(thickness), is_hard ? "hard" : "soft", lamp, receiver) - r.db[i];
        EXPECT_LT(std::abs(off), is_hard ? 0.7 : 0.3) << r.thickness << ", " << r.alpha << ", " << kBeta[i];
        worst = std::max(worst, std::abs(off)), squares += off * off, ++count;
      }
    std::printf("ends near the plane of a roof, %s: off by %.2f dB at most, %.2f dB rms\n",
                is_hard ? "hard" : "soft", worst, std::sqrt(squares / count));
  }
}

// Blocks of metal 0.3 to 8 wavelengths thick, whose two edges diffract light one after the other along the roof between them, against a
// boundary integral equation (tests/render/references/metal_block.py, which also says what the numbers are).
TEST(SegmentDiffraction, BlocksOfMetalHaveTwoPolarisations) {
  constexpr double kMetre = 0.1;  // wavelength
  struct Reference {
    double thickness, alpha, beta, soft, hard;
  };
  const Reference references[] = {
      {0.3, 10, -20, -0.17, -0.07},  {0.3, 10, -4, -11.56, -9.36},  {0.3, 10, -1, -13.71, -11.17},
      {0.3, 10, 1, -15.05, -12.44},  {0.3, 10, 4, -16.93, -13.64},  {0.3, 10, 15, -23.02, -18.38},
      {0.3, 10, 25, -27.43, -20.48}, {0.3, 10, 40, -33.13, -22.67}, {1, 10, -20, -0.49, -0.13},
      {1, 10, -4, -12.78, -9.42},    {1, 10, -1, -15.09, -11.32},   {1, 10, 1, -16.55, -12.49},
      {1, 10, 4, -18.64, -13.75},    {1, 10, 15, -25.45, -18.50},   {1, 10, 25, -30.60, -21.99},
      {1, 10, 40, -37.25, -23.82},   {3, 10, -20, -1.32, -0.45},    {3, 10, -4, -14.85, -9.48},
      {3, 10, -1, -17.45, -11.48},   {3, 10, 1, -19.13, -12.50},    {3, 10, 4, -21.56, -14.14},
      {3, 10, 15, -29.57, -19.23},   {3, 10, 25, -35.68, -22.96},   {3, 10, 40, -43.33, -26.36},
      {8, 2, -20, 2.12, 0.10},       {8, 2, -4, -9.87, -4.43},      {8, 2, -1, -12.95, -6.36},
      {8, 2, 1, -15.03, -7.90},      {8, 2, 4, -18.09, -9.98},      {8, 2, 15, -28.22, -15.64},
      {8, 2, 25, -35.51, -20.62},    {8, 2, 40, -44.16, -23.77},    {8, 15, -20, -7.93, -4.14},
      {8, 15, -4, -22.52, -12.35},   {8, 15, -1, -25.36, -14.27},   {8, 15, 1, -27.29, -15.39},
      {8, 15, 4, -30.03, -17.04},    {8, 15, 15, -39.24, -22.49},   {8, 15, 25, -45.89, -26.45},
      {8, 15, 40, -55.08, -31.38},   {3, -10, 4, -4.18, -1.90},     {3, -10, 8, -7.70, -4.50},
      {3, -10, 15, -13.90, -8.83},   {3, -10, 25, -21.65, -14.16},  {3, -10, 40, -30.59, -18.21},
  };
  double worst[2][2] = {}, worst_without[2] = {};
  for (const Reference& r : references) {
    const double a = r.alpha * M_PI / 180, b = r.beta * M_PI / 180, thickness = r.thickness * kMetre;
    const Vec3 lamp{float(-2 * std::cos(a)), 0, float(-2 * std::sin(a))};
    const Vec3 receiver{float(thickness + 2 * std::cos(b)), 0, float(-2 * std::sin(b))};
    const std::string block = block_of_metal(thickness);
    if (kSanitized && r.thickness != 3) continue;
    const double without = loss_of(block, "none", lamp, receiver);
    for (const bool is_hard : {false, true}) {
      const double expected = is_hard ? r.hard : r.soft;
      const double off = loss_of(block, is_hard ? "hard" : "soft", lamp, receiver) - expected;
      std::printf(
          "%4.1f wavelengths, %3g and %3g degrees, %s: %6.2f dB, off by %+.2f, without polarisation by %+.2f\n",
          r.thickness, r.alpha, r.beta, is_hard ? "hard" : "soft", expected, off, without - expected);
      double& largest = worst[is_hard][std::abs(r.beta) > 20];
      largest = std::max(largest, std::abs(off));
      worst_without[is_hard] = std::max(worst_without[is_hard], std::abs(without - expected));
    }
  }
  EXPECT_LT(worst[0][0], 1.2);
  EXPECT_LT(worst[0][1], 3.5);
  EXPECT_LT(worst[1][0], 1);
  EXPECT_LT(worst[1][1], 2.5);
  if (kSanitized) return;
  EXPECT_GT(worst_without[0], 10);
  EXPECT_GT(worst_without[1], 4);
}

// A square block of metal, 10 wavelengths wide, that light passes on both sides and along all of its faces, with the fringes behind
// it, against a boundary integral equation (tests/render/references/metal_block.py).
TEST(SegmentDiffraction, SquareBlocksOfMetal) {
  constexpr double kMetre = 0.1;  // wavelength
  struct Reference {
    double y, soft, hard;
  };
  const Reference references[] = {
      {-7, -33.46, -16.60},  {-7.25, -34.19, -16.98},  {-7.5, -34.44, -15.42},  {-7.75, -35.10, -17.85},
      {-8, -35.31, -16.68},  {-8.25, -35.20, -17.73},  {-8.5, -35.93, -17.85},  {-8.75, -36.00, -15.42},
      {-9, -36.24, -17.78},  {-9.25, -37.75, -17.99},  {-9.5, -37.58, -14.51},  {-9.75, -37.10, -16.24},
      {-10, -39.15, -24.10}, {-10.25, -39.27, -15.82}, {-10.5, -36.35, -12.78}, {-10.75, -36.73, -15.01},
      {-11, -43.30, -30.83}, {-11.25, -41.95, -16.63}, {-11.5, -34.88, -11.39}, {-11.75, -33.47, -10.79},
      {-12, -36.18, -13.82}, {-12.25, -43.25, -25.07}, {-12.5, -36.03, -19.63}, {-12.75, -31.63, -13.72},
      {-13, -30.65, -12.98}, {-13.25, -32.14, -15.93}, {-13.5, -34.88, -24.93}, {-13.75, -33.33, -18.21},
      {-14, -29.90, -12.80}, {-14.25, -28.12, -11.05}, {-14.5, -27.90, -11.66}, {-14.75, -28.82, -14.88},
      {-15, -29.77, -23.66}, {-15.25, -29.07, -20.83}, {-15.5, -27.26, -13.88}, {-15.75, -25.82, -11.16},
      {-16, -25.15, -10.47},
  };
  const std::string block =
      R"(<shape type="cube"><transform name="to_world"><scale x="0.5" y="4000" z="0.5"/><translate x="0.5" z="-0.5"/></transform>
    <bsdf type="conductor"><string name="material" value="none"/></bsdf></shape>)";
  const Vec3 lamp{float(-11.25 * kMetre), 0, float(6.875 * kMetre)};
  for (const bool is_hard : {false, true}) {
    double difference = 0, all = 0, power = 0;
    for (const Reference& r : references) {
      const double loss =
          loss_of(block, is_hard ? "hard" : "soft", lamp, {float(13 * kMetre), 0, float(r.y * kMetre)});
      const double amplitude = std::pow(10, loss / 20),
                   expected = std::pow(10, (is_hard ? r.hard : r.soft) / 20);
      difference += (amplitude - expected) * (amplitude - expected), all += expected * expected;
      power += amplitude * amplitude;
      if (kSanitized) break;
    }
    if (kSanitized) continue;
    std::printf("square of 10 wavelengths, %s: %.1f %% of the amplitude (rms), %+.2f dB of the power\n",
                is_hard ? "hard" : "soft", 100 * std::sqrt(difference / all), 10 * std::log10(power / all));
    EXPECT_LT(std::sqrt(difference / all), is_hard ? 0.17 : 0.1);
  }
}

// Far in the shadow of a half plane, 40 to 73 dB below free space, by Keller's coefficient for light that turns by the angle theta,
// K = lambda/(16 pi^2 sin^2(theta/2)) of an endless edge.
TEST(SegmentDiffraction, DeepShadows) {
  const std::string wall =
      R"(<shape type="rectangle"><transform name="to_world"><scale x="20000" y="40000"/><rotate y="1" angle="90"/><translate z="-20000"/></transform>
    <bsdf type="diffuse"><spectrum name="reflectance" value="0"/></bsdf></shape>)";
  for (const double v : {-25.0, -60.0, -70.0, -100.0, -200.0, -300.0}) {
    // Lamp and receiver lie at equal distances, as far below the edge: delta = v^2 lambda/4.
    constexpr double kHalf = 1000, kWavelengthHere = 0.1;
    const double detour = v * v * kWavelengthHere / 4,
                 depth = std::sqrt(std::pow(kHalf + detour / 2, 2) - kHalf * kHalf);
    const double sine = depth / std::hypot(kHalf, depth), reach = std::hypot(kHalf, depth);
    const double expected = 10 * std::log10(kWavelengthHere / std::pow(4 * M_PI * sine, 2) * 4 * kHalf *
                                            kHalf / (2 * reach * reach * reach));
    const double measured =
        loss_of(wall, "none", {float(-kHalf), 0, float(-depth)}, {float(kHalf), 0, float(-depth)});
    std::printf("half plane, v = %g: %.2f dB, by Keller's coefficient %.2f\n", v, measured, expected);
    EXPECT_NEAR(measured, expected, 0.1) << v;
  }
}

// Blocks of concrete, of glass and of plastic: the factor of a wedge over a half plane that absorbs, by the cotangents of Keller's coefficient and
// Fresnel's formulae with the permittivity of ITU-R P.2040-3 (Luebbers 1984), where both are far from the boundaries of shadow and reflection.
TEST(SegmentDiffraction, WedgesOfMaterials) {
  const double n = 1.5, phi_i = M_PI / 4;
  struct Material {
    const char* bsdf;
    Complex permittivity;
  };
  const double sigma = 0.0462 * std::pow(3.0, 0.7822);
  const Complex concrete(5.24, 17.98 * sigma / 3);
  for (
      const auto& [bsdf, permittivity] :
      {Material{R"(<bsdf type="conductor"><string name="material" value="itu_concrete"/></bsdf>)", concrete},
       {R"(<bsdf type="slab"><string name="int_ior" value="itu_concrete"/><string name="thickness" value="90m"/></bsdf>)",
        concrete},
       {R"(<bsdf type="dielectric"><float name="int_ior" value="1.6"/><float name="ext_ior" value="1"/></bsdf>)",
        1.6 * 1.6},
       {R"(<bsdf type="twosided"><bsdf type="plastic"><float name="int_ior" value="1.4"/><float name="ext_ior" value="1"/></bsdf></bsdf>)",
        1.4 * 1.4}})
    for (const double degrees : {25.0, 35.0, 42.0}) {
      const double phi = phi_i + M_PI + degrees * M_PI / 180;
      const double none = power_beside_block({5000, phi_i}, {10, phi}, "none", bsdf);
      for (const bool is_hard : {false, true}) {
        const double measured =
            power_beside_block({5000, phi_i}, {10, phi}, is_hard ? "hard" : "soft", bsdf) / none;
        if (kSanitized) continue;
        const auto reflection = [&](double grazing) {
          const double c = std::sin(grazing);
          const Complex root = std::sqrt(permittivity - (1 - c * c));
          return is_hard ? (permittivity * c - root) / (permittivity * c + root) : (c - root) / (c + root);
        };
        const auto cot = [](double x) { return 1 / std::tan(x); };
        const double off = phi - phi_i, sum = phi + phi_i;
        const Complex wedge = cot((M_PI + off) / (2 * n)) + cot((M_PI - off) / (2 * n)) +
                              reflection(n * M_PI - phi) * cot((M_PI + sum) / (2 * n)) +
                              reflection(phi_i) * cot((M_PI - sum) / (2 * n));
        const double absorbing = cot((M_PI + off) / 4) + cot((M_PI - off) / 4);
        const double expected = std::norm(wedge / n / (absorbing / 2));
        std::printf("%.40s..., %g degrees, %s: %+.3f dB of the half plane, %+.3f expected\n", bsdf, degrees,
                    is_hard ? "hard" : "soft", 10 * std::log10(measured), 10 * std::log10(expected));
        EXPECT_NEAR(10 * std::log10(measured), 10 * std::log10(expected), 0.02);
      }
    }
  // Transmitter and receiver may be exchanged: also where both are nearer to one face than Luebbers took them to be.
  const char* mixed = R"(<bsdf type="conductor"><string name="material" value="itu_concrete"/></bsdf>)";
  for (const auto& [a, b] : {std::pair(PlaceAboutEdge{20, 0.3}, PlaceAboutEdge{10, 4.2}),
                             {PlaceAboutEdge{20, 1.4}, PlaceAboutEdge{7, 4.6}}})
    for (const char* polarisation : {"soft", "hard"}) {
      const auto over_free = [&](const PlaceAboutEdge& from, const PlaceAboutEdge& to) {
        return power_beside_block(from, to, polarisation, mixed) /
               power_beside_block(from, to, polarisation, "");
      };
      const double there = over_free(a, b), back = over_free(b, a);
      if (!kSanitized) EXPECT_NEAR(there, back, 5e-3 * back) << polarisation;
    }
}

// Narrow plates with slits: the outer edges of one plate do not act on the slit of the other. Blades on opposite sides: the
// bivariate normal integral with a negative correlation.
TEST(SegmentDiffraction, PlatesAndBladesApart) {
  const double h = 0.25e-3, apart = 1e-4;
  std::string plates;
  for (const double z : {apart / 2, -apart / 2})
    plates += sheet(-2e-3, -h, -1, 1, z) + sheet(h, 2e-3, -1, 1, z);
  const Bench two{1, 1.5e-3, 24, 2, plates};
  const Bench one{1, 1.5e-3, 24, 2, sheet(-2e-3, -h, -1, 1) + sheet(h, 2e-3, -1, 1)};
  const Picture a = two.picture(), b = one.picture();
  for (std::size_t i = 0; i < a.mean.size(); ++i)
    if (!kSanitized) EXPECT_NEAR(10 * std::log10(a.mean[i] / b.mean[i]), 0, 0.5) << i;

  for (const double z : {0.02, 0.2}) {
    const double overlap = 0.1e-3;
    const Bench blades{1, 1.5e-3, 12, 2, sheet(-1, overlap, -1, 1, z) + sheet(-overlap, 1, -1, 1, -z)};
    const double r = 1 - z, l = 2 * z;
    // The field of the first blade in the plane of the second, integrated over what that passes.
    const auto field = [&](double screen) {
      const double across = std::sqrt(2 / kWavelength * (1 / (r + l) + 1 / r));
      const double first = std::sqrt(2 / kWavelength * (1 / r + 1 / l));
      const double axis = screen * (1 + z) / 2;
      constexpr int kSteps = 20000;
      const double length = 60;
      Complex sum = 0;
      for (int i = 0; i < kSteps; ++i) {
        const double q = (i + 0.5) / kSteps, t = (-overlap - axis) * across - q * length;
        const double end = std::max(0.0, q - 0.5) / 0.16, x = axis + t / across;
        sum += std::polar(length / kSteps * std::exp(-end * end * end * end), M_PI / 2 * t * t) *
               optics::knife_edge_field((x * r / (r + l) - overlap) * first);
      }
      return std::norm(Complex(0.5, -0.5) * sum);
    };
    const Picture p = blades.picture();
    double worst = 0, brightest = 0;
    std::vector<double> expected;
    for (int i = 0; i < 12; ++i) {
      double mean = 0;
      for (int k = 0; k < 4; ++k) mean += field(1.5e-3 * (2 * (i + (k + 0.5) / 4) / 12 - 1)) / 4;
      expected.push_back(mean), brightest = std::max(brightest, mean);
    }
    for (std::size_t i = 0; i < 12; ++i)
      if (expected[i] > 0.01 * brightest)
        worst = std::max(worst, std::abs(10 * std::log10(p.mean[i] / blades.unobstructed() / expected[i])));
    std::printf("blades %g m apart that overlap: largest error %.2f dB\n", 2 * z, worst);
    if (!kSanitized) EXPECT_LT(worst, 0.3) << z;
  }
}

// A square opening of 0.2 mm in a tilted sheet, against Kirchhoff's integral over it.
TEST(SegmentDiffraction, OpeningsInTiltedSheets) {
  const double h = 1e-4;
  const test::TemporaryFolder folder;
  const Bench flat{1, 4e-3, 12, 12, "", 16};
  for (const double tilt : {0.0, 60.0, 75.0}) {
    const double c = std::cos(tilt * M_PI / 180), s = std::sin(tilt * M_PI / 180);
    std::string text;
    for (const double y : {-0.6, -h, h, 0.6})
      for (const double x : {-0.6, -h, h, 0.6}) text += fmt::format("v {} {} {}\n", x * c, y, x * s);
    for (int j = 0; j < 3; ++j)
      for (int i = 0; i < 3; ++i)
        if (const int k = 4 * j + i + 1; i != 1 || j != 1)
          text += fmt::format("f {0} {1} {2}\nf {0} {2} {3}\n", k, k + 1, k + 5, k + 4);
    Bench bench = flat;
    bench.sheets = black_mesh(folder.path / fmt::format("tilted{}.obj", tilt), text);
    compare(
        fmt::format("opening tilted by {} degrees", tilt).c_str(), bench,
        [&](double x, double y) {
          // In Fresnel's approximation, but for the depth of the opening, which is exact.
          constexpr int kNodes = 30;
          const double d = std::hypot(x, y, 2.0);
          Complex sum = 0;
          for (int i = 0; i < kNodes; ++i)
            for (int j = 0; j < kNodes; ++j) {
              const double u = h * (2 * (i + 0.5) / kNodes - 1), q = h * (2 * (j + 0.5) / kNodes - 1);
              const double px = u * c, pz = u * s;
              const double detour = std::hypot(px, q, pz - 1) + std::hypot(px - x, q - y, pz + 1) - d;
              sum += std::polar(1.0, 2 * M_PI / kWavelength * detour);
            }
          const double area = 4 * h * h * c / (kNodes * kNodes);
          return std::norm(sum * area * 2.0 / kWavelength);
        },
        0.2, 0.01);
  }
}

// Long edges and large angles at a wavelength of 0.1 m.
TEST(SegmentDiffraction, LargeAngles) {
  const test::TemporaryFolder folder;
  const auto loss = [](const std::string& shape, double lamp_x, double lamp_z, double x, double z) {
    return loss_of(shape, "none", {float(lamp_x), 0, float(lamp_z)}, {float(x), 0, float(z)});
  };
  // A wall x = 0 below z = 0, `half` to both sides, in `pieces` rectangles. Its other edges lie beyond the window.
  const auto wall = [&](double half, int pieces) {
    std::string text;
    for (int i = 0; i <= pieces; ++i) {
      const double y = half * (2.0 * i / pieces - 1);
      text += fmt::format("v 0 {0} -6000\nv 0 {0} 0\n", y);
    }
    for (int i = 0; i < pieces; ++i)
      text += fmt::format("f {0} {1} {2}\nf {0} {2} {3}\n", 2 * i + 1, 2 * i + 3, 2 * i + 4, 2 * i + 2);
    return black_mesh(folder.path / fmt::format("wall{}.obj", pieces), text);
  };
  // 300 m before the edge, 3 m behind it at 60 degrees: K = lambda/(16 pi^2 sin^2(theta/2)) of an endless edge.
  const double wavelength = 0.1, angle = M_PI / 3;
  const double x = 3 * std::cos(angle), z = -3 * std::sin(angle);
  const double expected = 10 * std::log10(wavelength / std::pow(4 * M_PI * std::sin(angle / 2), 2) *
                                          (std::pow(300 + x, 2) + z * z) / (300.0 * 3 * 303));
  for (const int pieces : {1, 4, 64}) {
    const double measured = loss(wall(6000, pieces), -300, 0, x, z);
    std::printf("edge of 12 km in %d pieces, at 60 degrees: %.2f dB (%.2f)\n", pieces, measured, expected);
    if (!kSanitized) EXPECT_NEAR(measured, expected, 0.3) << pieces;
  }
  // Behind a block 20 m thick and 15 m high, 1.5 m above the ground, the lamp lower and higher than its top. No steps, and at
  // small angles the two edges of Fresnel's approximation.
  const std::string block =
      R"(<shape type="cube"><transform name="to_world"><scale x="10" y="2000" z="207.5"/><translate z="-192.5"/></transform>
    <bsdf type="diffuse"><spectrum name="reflectance" value="0"/></bsdf></shape>)";
  for (const double height : {5.0, 20.0, 60.0}) {
    double before = 0;
    for (double at = 12; at < 60; at += 3) {
      const double measured = loss(block, -300, height, at, 1.5);
      if (!kSanitized && at > 12) EXPECT_NEAR(measured, before, 1.8) << height << " " << at;
      if (!kSanitized && at > 12) EXPECT_GT(measured, before) << height << " " << at;
      before = measured;
    }
    std::printf("behind a block, lamp at %g m: %.2f dB at 57 m\n", height, before);
  }
}

TEST(SegmentDiffraction, KnifeEdgeOfP526) {
  // ITU-R P.526: losses at Fresnel's v in the shadow, and gains on the lit side; cells of 0.02 of v about them.
  const struct {
    double v, loss;
  } kRows[] = {{0, 6.02},  {0.5, 10.23}, {1, 13.86},   {1.5, 16.78}, {2, 19.09}, {3, 22.52},
               {5, 26.94}, {8, 31.02},   {-0.5, 1.86}, {-1, -1.00},  {-2, 0.74}};
  for (const auto& [v, loss] : kRows) {
    const double per_v = 2 / std::sqrt(4 / kWavelength);  // on the screen
    Bench bench{1, 0.01 * per_v, 1, 1, "", 64};
    // The sheet moves, the film stays: the point of the screen on the axis is v behind its edge.
    bench.sheets = sheet(-1, v * per_v / 2, -1, 1);
    const Picture p = bench.picture();
    if (kSanitized) continue;
    EXPECT_NEAR(-10 * std::log10(p.mean[0] / bench.unobstructed()), loss, 0.05) << v;
  }
}

// A lamp that is 2 wide in v, behind a half plane: the mean of the knife edge over v.
TEST(SegmentDiffraction, LampsOfSomeWidth) {
  const double half = std::sqrt(kWavelength);  // of the lamp, at the distance of the screen
  const auto radiance = [&](const std::string& sheets) {
    return render(screen("direct", 1, 1e-6, 1, 1, 128, R"(<integer name="emitter_samples" value="16"/>)") +
                  fmt::format(R"(
  <shape type="rectangle"><transform name="to_world"><rotate y="1" angle="180"/><scale x="{}" y="1e-5"/><translate z="1"/></transform>
    <emitter type="area"><spectrum name="radiance" value="1"/></emitter></shape>)",
                              half) +
                  sheets);
  };
  const double free = radiance("").mean[0];
  const struct {
    double v, intensity;
  } kRows[] = {{-2, 0.01558}, {-1, 0.06699}, {0, 0.40192}, {1, 0.89864}, {2, 1.05956}};
  for (const auto& [v, intensity] : kRows) {
    const Picture p = radiance(sheet(-1, -v / std::sqrt(4 / kWavelength), -1, 1));
    if (kSanitized) continue;
    EXPECT_LT(p.error[0], 0.002 * p.mean[0]);
    EXPECT_NEAR(p.mean[0] / free / intensity, 1, 0.005) << v;
  }
}

// Light of a lamp at infinity: the distance to the screen alone counts.
TEST(SegmentDiffraction, LampsAtInfinity) {
  for (const double v : {-3.0, -1.0, 0.5, 1.2172}) {
    const double edge = -v * std::sqrt(kWavelength / 2);
    const auto radiance = [&](const std::string& sheets) {
      return render(screen("path", 1, 1e-6, 1, 1, 4) + kFromInfinity + sheets).mean[0];
    };
    EXPECT_NEAR(radiance(sheet(-1, edge, -1, 1)) / radiance("") / optics::knife_edge_intensity(v), 1, 0.01)
        << v;
  }
}

TEST(SegmentDiffraction, DirectBdptAndPathAgree) {
  const Bench bench{1, 3e-3, 32, 2, sheet(-0.5e-3, 0.5e-3, -1, 1)};
  const Picture a = bench.picture("path");
  for (const char* type : {"direct", "bdpt"}) {
    const Picture b = bench.picture(type);
    for (std::size_t i = 0; i < a.mean.size(); ++i)
      EXPECT_NEAR(b.mean[i], a.mean[i], 0.03 * a.mean[i]) << type << " " << i;
  }
}

// `ptracer` finds light in shadows by rays of the lamp that go on behind the sheet.
TEST(SegmentDiffraction, LightPathsAgreeWithPathsOfTheSensor) {
  Bench bench{1, 3e-3, 12, 2, sheet(-1, 0, -1, 1), 64};
  bench.has_spot = true;  // few of the rays of a point reach the millimetres that the film shows
  const Picture a = bench.picture("path");
  bench.samples = 8192;  // rays go on into the deepest cell, at v = -3.7, with the probability 0.26
  const Picture b = bench.picture("ptracer");
  if (kSanitized) return;
  for (std::size_t i = 0; i < a.mean.size(); ++i) {
    EXPECT_LT(b.error[i], 0.08 * b.mean[i]) << i;
    EXPECT_NEAR(b.mean[i], a.mean[i], 4.5 * b.error[i] + 0.002 * a.mean[i]) << i;
  }
}

// `ptracer` takes light of a lamp at infinity as a plane wave, and not as one from the rim of the scene. 3 GHz.
TEST(SegmentDiffraction, LightPathsFromInfinity) {
  const auto picture = [](const std::string& integrator, int samples) {
    return render(fmt::format(
                      R"(<integrator type="{}"><boolean name="diffraction" value="true"/>
    <string name="diffraction_model" value="segments"/></integrator>
  <sensor type="orthographic"><transform name="to_world"><lookat origin="0, 0, -0.9" target="0, 0, -1" up="0, 1, 0"/></transform>
    <film type="specfilm"><integer name="width" value="8"/><integer name="height" value="8"/><rfilter type="box"/>
      <string name="wavelength_min" value="3.0001GHz"/><string name="wavelength_max" value="2.9999GHz"/>
      <integer name="bins" value="1"/><boolean name="preview" value="false"/></film>
    <sampler type="sobol"><integer name="sample_count" value="{}"/></sampler></sensor>
  <shape type="rectangle"><transform name="to_world"><scale value="1"/><translate z="-1"/></transform>
    <bsdf type="diffuse"><spectrum name="reflectance" value="1"/></bsdf></shape>
  <shape type="rectangle"><transform name="to_world"><scale x="0.5"/><translate x="-0.5"/></transform>
    <bsdf type="diffuse"><spectrum name="reflectance" value="0"/></bsdf></shape>)",
                      integrator, kSanitized ? 1 : samples) +
                  kFromInfinity);
  };
  const Picture a = picture("path", 16), b = picture("ptracer", 250);
  if (kSanitized) return;
  for (std::size_t x = 0; x < 8; ++x) {
    double of_path = 0, of_ptracer = 0, error2 = 0;
    for (std::size_t y = 0; y < 8; ++y)
      of_path += a.mean[8 * y + x], of_ptracer += b.mean[8 * y + x],
          error2 += std::pow(b.error[8 * y + x], 2);
    const double error = std::sqrt(error2);
    EXPECT_LT(error, 0.1 * of_ptracer) << x;
    EXPECT_NEAR(of_ptracer, of_path, 4.5 * error + 0.005 * of_path) << x;
  }
}

TEST(SegmentDiffraction, NestedIntegratorsDiffract) {
  const Bench bench{1, 3e-3, 16, 2, sheet(-1, 0, -1, 1)};
  const auto text = [&](const std::string& begin, const std::string& end) {
    std::string scene = screen("path", 1, 3e-3, 16, 2, 16) +
                        R"(<emitter type="point"><spectrum name="intensity" value="1"/>
      <point name="position" x="0" y="0" z="1"/></emitter>)" +
                        bench.sheets;
    scene.insert(0, begin);
    scene.insert(scene.find("</integrator>") + 13, end);
    return scene;
  };
  const Picture own = bench.picture();
  for (const char* type : {"aov", "moment"}) {
    std::string begin = fmt::format(R"(<integrator type="{}">)", type);
    if (type == std::string("aov")) begin += R"(<string name="aovs" value="d:depth"/>)";
    const Picture nested = render(text(begin, "</integrator>"));
    for (std::size_t i = 0; i < own.mean.size(); ++i)
      EXPECT_FLOAT_EQ(float(nested.mean[i]), float(own.mean[i])) << type;
    try {
      render(text(begin, R"(<integrator type="path"/></integrator>)"));
      ADD_FAILURE() << "light of one scene in two manners";
    } catch (const std::exception& e) {
      EXPECT_NE(std::string(e.what()).find("diffract light in one manner"), std::string::npos) << e.what();
    }
  }
}

TEST(SegmentDiffraction, CutsOfTheEdgeChangeNothing) {
  std::string pieces;
  for (int i = 0; i < 100; ++i) pieces += sheet(-1, 0, -0.01 + 0.0002 * i, -0.01 + 0.0002 * (i + 1));
  const Bench whole{1, 2e-3, 16, 2, sheet(-1, 0, -0.01, 0.01)}, cut{1, 2e-3, 16, 2, pieces};
  const Picture a = whole.picture(), b = cut.picture();
  for (std::size_t i = 0; i < a.mean.size(); ++i) EXPECT_NEAR(b.mean[i], a.mean[i], 1e-3 * a.mean[i]) << i;

  // Nor with two sheets, whose edges cross: they are joined before that.
  const auto crossed = [](int n) {
    std::string sheets;
    for (int k = 0; k < n; ++k) {
      const double from = 0.1 * (2.0 * k / n - 1), to = 0.1 * (2.0 * (k + 1) / n - 1);
      sheets += sheet(from, to, 0.15e-3, 0.1, 0.015) + sheet(from, to, -0.1, -0.15e-3, 0.015) +
                sheet(0.15e-3, 0.1, from, to, -0.015) + sheet(-0.1, -0.15e-3, from, to, -0.015);
    }
    return Bench{1, 2e-3, 8, 8, sheets, 2}.picture().mean;
  };
  const std::vector<double> one = crossed(1), many = crossed(40);
  for (std::size_t i = 0; i < one.size(); ++i) EXPECT_NEAR(many[i], one[i], 1e-3 * one[i]) << i;
}

// Two walls make a corner, the second one shifted by g: the corner is one edge, whether its vertices are equal, nearly equal
// or apart by less than a twentieth of the wavelength. 3.5 GHz, a lamp that both walls hide from the place of the map.
TEST(SegmentDiffraction, ACornerOfTwoWallsIsOneEdge) {
  double first = 0;
  for (const auto& [g, height] :
       {std::pair(0.0, 25.0), {1e-9, 25.0}, {1e-6, 25.0}, {1e-4, 25.0}, {1e-3, 25.0}, {0.0, 24.0}}) {
    const Picture p = render(fmt::format(
        R"(<integrator type="path"><integer name="max_depth" value="1"/><boolean name="diffraction" value="true"/>
    <string name="diffraction_model" value="segments"/></integrator>
  <shape type="rectangle"><transform name="to_world"><translate x="20" y="3"/></transform>
    <sensor type="irradiancemeter"><film type="specfilm"><integer name="width" value="1"/><integer name="height" value="1"/>
      <string name="wavelength_min" value="3.5001GHz"/><string name="wavelength_max" value="3.4999GHz"/>
      <integer name="bins" value="1"/><boolean name="preview" value="false"/><rfilter type="box"/></film>
    <sampler type="sobol"><integer name="sample_count" value="64"/></sampler></sensor></shape>
  <emitter type="point"><point name="position" x="-10" y="-10" z="4"/><spectrum name="intensity" value="1"/></emitter>
  <shape type="rectangle"><transform name="to_world"><rotate x="1" angle="90"/><scale x="25" z="25"/><translate x="25"/></transform>
    <bsdf type="diffuse"/></shape>
  <shape type="rectangle"><transform name="to_world"><rotate y="1" angle="90"/><scale y="25" z="{1}"/>
    <translate y="-25" x="-{0}"/></transform><bsdf type="diffuse"/></shape>)",
        g, height));
    std::printf("g = %g m, height %g m: %.3f dB\n", g, height, 10 * std::log10(p.mean[0]));
    if (first == 0) first = p.mean[0];
    if (!kSanitized) EXPECT_NEAR(10 * std::log10(p.mean[0] / first), 0, 0.1) << g << " " << height;
  }
}

TEST(SegmentDiffraction, BadInput) {
  const auto error_of = [](const std::string& integrator, const std::string& shape = "") -> std::string {
    try {
      render(integrator + R"(<sensor type="perspective"><film type="hdrfilm"><integer name="width" value="1"/>
        <integer name="height" value="1"/></film></sensor><emitter type="constant"/>)" +
             shape);
    } catch (const std::exception& e) {
      return e.what();
    }
    return "";
  };
  // "segments" is the default.
  const std::string on = R"(<boolean name="diffraction" value="true"/>)";
  EXPECT_NE(error_of(R"(<integrator type="bdpt"><boolean name="diffraction" value="true"/>
      <string name="diffraction_model" value="beams"/><string name="diffraction_polarisation" value="soft"/></integrator>)")
                .find("belongs to the diffraction model \"segments\""),
            std::string::npos);
  EXPECT_NE(error_of(R"(<integrator type="path">)" + on +
                     R"(<string name="diffraction_polarisation" value="te"/></integrator>)")
                .find("\"te\" is not one of none, soft, hard, both"),
            std::string::npos);
  EXPECT_NE(
      error_of(R"(<integrator type="path">)" + on + R"(<string name="beam_width" value="1mm"/></integrator>)")
          .find("belongs to the diffraction model \"beams\""),
      std::string::npos);
  EXPECT_NE(error_of(R"(<integrator type="path">)" + on + "</integrator>",
                     R"(<shape type="cube"><medium name="interior" type="homogeneous"/></shape>)")
                .find("needs a scene without media"),
            std::string::npos);
}

}  // namespace
}  // namespace aureole::testing

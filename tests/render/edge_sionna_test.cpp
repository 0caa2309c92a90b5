// SPDX-License-Identifier: Apache-2.0
// Received power beside and behind a wall, a block and two blocks at 3.5 and 28 GHz, by the edges of pictures and after sionna-rt 2.2.0:
// one diffraction, no reflection. optics/diffraction/references/make_sionna_references.py has made the numbers.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <numbers>
#include <string>
#include <vector>

#include "aureole/optics/diffraction/uniform_theory.h"
#include "aureole/render/plan.h"
#include "harness/effort.h"
#include "harness/rendered.h"
#include "loading/load_text.h"

namespace aureole::test {
namespace {

using std::numbers::pi;

/// A path of sionna-rt to one of the two receivers of a cell: direct (n = 0) or with one diffraction; or (n = -1) the mean over the cell
/// of all paths, added with their phases.
struct Row {
  int line;
  double ghz;
  int cell;
  /// Transmitter, receiver; exterior angle of the edge over pi; point of the edge; across it, points of the o- and of the n-face [m].
  double from[3], to[3], n, edge[3], o_face[2], n_face[2];
  /// 10 lg of irradiance over radiant intensity [1/m^2]. The coefficient of the edge is that of soft polarisation.
  double level;
};

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wmissing-braces"
const Row kRows[] = {
#include "render/references/sionna_powers.inc"
};
#pragma GCC diagnostic pop

double db(double x) { return 10 * std::log10(x); }

/// The angle about the edge from the o-face, clockwise as seen from above.
double angle(const Row& r, const double* to) {
  const double o = std::atan2(r.o_face[1] - r.edge[1], r.o_face[0] - r.edge[0]);
  return std::fmod(o - std::atan2(to[1] - r.edge[1], to[0] - r.edge[0]) + 4 * pi, 2 * pi);
}
double distance(const double* a, const double* b) {
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}
/// The angle by which light turns at the edge, across it [degrees]; positive into the shadow.
double turn(const Row& r) { return (std::abs(angle(r, r.to) - angle(r, r.from)) - pi) * 180 / pi; }
/// Whether the transmitter shines on one of the faces only: else the edge throws no shadow.
bool is_outline(const Row& r) {
  const double a = angle(r, r.from);
  return a < (r.n - 1) * pi || a > pi;
}
/// Fresnel's number, negative in the shadow.
double fresnel_number(const Row& r) {
  const double excess = distance(r.from, r.edge) + distance(r.edge, r.to) - distance(r.from, r.to);
  return (turn(r) > 0 ? -2 : 2) * std::sqrt(excess * r.ghz / 0.299792458);
}
/// The power that a wedge of the angle n pi diffracts.
double by_uniform_theory(const Row& r, double n, optics::WedgeFaces faces) {
  const double lambda = 0.299792458 / r.ghz, s_i = distance(r.from, r.edge), s = distance(r.edge, r.to);
  const double sin_beta = std::hypot(r.from[0] - r.edge[0], r.from[1] - r.edge[1]) / s_i;
  const auto d =
      optics::Wedge(n).coefficient(2 * pi / lambda, optics::point_source_distance(s_i, s, sin_beta), sin_beta,
                                   angle(r, r.to), angle(r, r.from), faces);
  return std::norm(d) * std::pow(optics::point_source_spreading(s_i, s) / s_i, 2);
}

/// Powers of a cell, direct light included.
struct Cell {
  double direct = 0;
  double fields = 0;       ///< sionna-rt, paths added with their phases
  double soft = 0;         ///< sionna-rt, powers of paths added
  double hard = 0;         ///< for hard polarisation: by `Wedge`, since that of sionna-rt has wrong signs
  double half_planes = 0;  ///< black half planes in place of wedges, of edges that throw a shadow
  double turn = 0, fresnel_number = 0;  ///< about the edge that sends most
  double strongest = -1;

  double mean() const { return 0.5 * (soft + hard); }
};

std::vector<Cell> references(int line, double ghz, int cells) {
  std::vector<Cell> all(static_cast<std::size_t>(cells));
  for (const Row& r : kRows) {
    if (r.line != line || r.ghz != ghz) continue;
    Cell& c = all[std::size_t(r.cell)];
    const double p = std::pow(10, 0.1 * r.level);
    if (r.n < 0) {
      c.fields = p;
    } else if (r.n == 0) {
      for (double* sum : {&c.direct, &c.soft, &c.hard, &c.half_planes}) *sum += 0.5 * p;
    } else {
      // The code of `Wedge` and that of sionna-rt agree in what both have.
      if (r.level > -90) {
        EXPECT_NEAR(db(by_uniform_theory(r, r.n, optics::kSoftMetal)), r.level, 0.08);
      }
      c.soft += 0.5 * p, c.hard += 0.5 * by_uniform_theory(r, r.n, optics::kHardMetal);
      if (!is_outline(r)) continue;
      const double flat = 0.5 * by_uniform_theory(r, 2, {0, 0});
      c.half_planes += flat;
      if (flat > c.strongest) c.strongest = flat, c.turn = turn(r), c.fresnel_number = fresnel_number(r);
    }
  }
  return all;
}

std::string box(double x0, double y0, double x1, double y1) {
  return fmt::format(
      R"(<shape type="cube"><transform name="to_world"><scale x="{}" y="{}" z="60"/><translate x="{}" y="{}"/></transform>{}</shape>)",
      0.5 * (x1 - x0), 0.5 * (y1 - y0), 0.5 * (x0 + x1), 0.5 * (y0 + y1),
      R"(<bsdf type="diffuse"><spectrum name="reflectance" value="0"/></bsdf>)");
}

struct Line {
  const char* name;
  std::string obstacles;
  std::array<double, 3> lamp;
  double z;
  std::array<double, 2> begin, end;
  int cells;
};
const Line kLines[] = {
    {"behind a wall",
     R"(<shape type="rectangle"><transform name="to_world"><scale x="4" y="60"/><rotate x="1" angle="90"/><translate x="-4"/></transform>
       <bsdf type="diffuse"><spectrum name="reflectance" value="0"/></bsdf></shape>)",
     {-3.1, 7.4, 1},
     -0.5,
     {6, -5},
     {-4, -5},
     20},
    {"beside a block", box(-8, -8, 0, 0), {-9, 5.5, 1}, -0.5, {14, -6}, {0.8, -6}, 20},
    {"between two blocks", box(-8, -8, 0, 0) + box(4, -9, 12, 1), {-9, 5.5, 1}, -0.5, {2, 3}, {2, -7}, 20},
    {"behind two blocks", box(-8, -8, 0, 0) + box(4, -9, 12, 1), {-9, 5.5, 1}, -0.5, {15, 5}, {15, -7}, 20},
};

/// Edges in beams of about the first zone of Fresnel: 4 m is the distance D of docs/diffraction_beams.md, about.
constexpr const char* kBeams =
    R"(<integer name="max_depth" value="2"/><string name="diffraction_model" value="beams"/><string name="beam_width" value="fresnel 4m"/>)";
/// Segments, with direct light and what edges diffract alone.
constexpr const char* kSoftSegments =
    R"(<integer name="max_depth" value="1"/><string name="diffraction_model" value="segments"/>
    <string name="diffraction_polarisation" value="soft"/>)";

testing::Picture received(const Line& line, double ghz, int samples, const std::string& model = kBeams) {
  const double dx = line.end[0] - line.begin[0], dy = line.end[1] - line.begin[1];
  RenderOptions options;
  options.replicates = 16;
  return testing::render(
      load_scene_from_string(
          fmt::format(R"(<scene version="3.0.0">
  <integrator type="path"><boolean name="diffraction" value="true"/>{}</integrator>
  <sensor type="powermap"><transform name="to_world"><scale x="{}" y="0.01"/><rotate z="1" angle="{}"/>
      <translate x="{}" y="{}" z="{}"/></transform>
    <sampler type="sobol"><integer name="sample_count" value="{}"/></sampler>
    <film type="specfilm"><integer name="width" value="{}"/><integer name="height" value="1"/><rfilter type="box"/>
      <string name="wavelength_min" value="{}GHz"/><string name="wavelength_max" value="{}GHz"/>
      <integer name="bins" value="1"/><boolean name="preview" value="false"/></film></sensor>
  <emitter type="point"><point name="position" x="{}" y="{}" z="{}"/><spectrum name="intensity" value="1"/></emitter>
  {}</scene>)",
                      model, 0.5 * std::hypot(dx, dy), std::atan2(dy, dx) * 180 / pi,
                      0.5 * (line.begin[0] + line.end[0]), 0.5 * (line.begin[1] + line.end[1]), line.z,
                      samples, line.cells, ghz * 1.001, ghz * 0.999, line.lamp[0], line.lamp[1], line.lamp[2],
                      line.obstacles),
          "line.xml"),
      options);
}

/// Differences in decibel of cells of one kind.
struct Differences {
  int count = 0;
  double sum = 0, squares = 0, largest = 0;
  void add(double d) {
    ++count, sum += d, squares += d * d;
    if (std::abs(d) > std::abs(largest)) largest = d;
  }
  std::string text() const {
    return fmt::format("mean {:+.2f}, rms {:.2f}, largest {:+.2f}", sum / count, std::sqrt(squares / count),
                       largest);
  }
};

void expect_agreement(int number, double ghz) {
  const Line& line = kLines[number];
  const testing::Picture p = received(line, ghz, kSanitized ? 2 : 768);
  if (kSanitized) return;
  const std::vector<Cell> cells = references(number, ghz, line.cells);
  std::printf(
      "%s, %.1f GHz\n"
      "cell   turn      v | sionna-rt: direct, with phases, soft; hard | rendered         | over: phases   soft   mean  "
      "half planes\n",
      line.name, ghz);
  double beside = 0, beside_by_fields = 0;
  Differences lit;
  std::map<int, std::array<Differences, 3>> shadow;  // by angles of 15 degrees
  for (int i = 0; i < line.cells; ++i) {
    const Cell& c = cells[std::size_t(i)];
    const double ours = p.mean[std::size_t(i)], noise = 10 / std::log(10.0) * p.error[std::size_t(i)] / ours;
    const double to_soft = db(ours / c.soft), to_mean = db(ours / c.mean()),
                 to_half_planes = db(ours / c.half_planes);
    std::printf("%4d %6.1f %6.2f | %7.2f %7.2f %7.2f %7.2f | %7.2f +- %.2f | %6.2f %6.2f %6.2f %6.2f\n", i,
                c.turn, c.fresnel_number, db(c.direct), db(c.fields), db(c.soft), db(c.hard), db(ours), noise,
                db(ours / c.fields), to_soft, to_mean, to_half_planes);
    EXPECT_LT(noise, 0.1);
    if (c.fresnel_number > 2.6) {
      lit.add(to_soft);
      // Where reflections end they are missing in both, and sionna-rt has what an edge adds to them.
      EXPECT_NEAR(to_soft, 0, number < 2 ? 0.05 : 0.75) << i;
      EXPECT_NEAR(ours, c.direct, 0.01 * c.direct) << i;
    } else if (c.fresnel_number > -2.1) {
      // How light is spread there is not the model's; the sum is.
      beside += ours, beside_by_fields += c.fields;
    } else {
      // Between the two polarisations, and farther from their mean as the light turns more and where faces are at grazing incidence.
      EXPECT_GT(ours, c.soft) << i;
      EXPECT_LT(ours, c.hard) << i;
      EXPECT_NEAR(to_mean, 0, 0.2 + (number == 0 ? 0.02 : 0.1) * c.turn) << i;
      EXPECT_NEAR(to_half_planes, 0, 0.1 + 4 * noise) << i;
      auto& kinds = shadow[int(c.turn / 15)];
      kinds[0].add(to_soft), kinds[1].add(to_mean), kinds[2].add(to_half_planes);
    }
  }
  if (lit.count > 0) std::printf("  in the light, over sionna-rt: %s\n", lit.text().c_str());
  std::printf("  all light beside the boundary of the shadow, over sionna-rt with phases: %+.2f dB\n",
              db(beside / beside_by_fields));
  EXPECT_NEAR(db(beside / beside_by_fields), 0, number < 2 ? 0.2 : 0.35);
  for (const auto& [angle, kinds] : shadow)
    std::printf("  %d to %d degrees (%d): over soft: %s; over the mean of both: %s; over half planes: %s\n",
                15 * angle, 15 * angle + 15, kinds[0].count, kinds[0].text().c_str(), kinds[1].text().c_str(),
                kinds[2].text().c_str());
}

// Segments with soft polarisation, around obstacles of metal, against paths of sionna-rt that are added with their phases.
TEST(EdgeSionna, SegmentsOfSoftPolarisation) {
  for (const int number : {0, 1})
    for (const double ghz : {3.5, 28.0}) {
      Line line = kLines[number];
      const std::string black = R"(<bsdf type="diffuse"><spectrum name="reflectance" value="0"/></bsdf>)";
      line.obstacles.replace(line.obstacles.find(black), black.size(),
                             R"(<bsdf type="conductor"><string name="material" value="none"/></bsdf>)");
      const testing::Picture p = received(line, ghz, kSanitized ? 1 : 32, kSoftSegments);
      if (kSanitized) continue;
      const std::vector<Cell> cells = references(number, ghz, line.cells);
      Differences shadow, light;
      for (int i = 0; i < line.cells; ++i) {
        const Cell& c = cells[std::size_t(i)];
        const double off = db(p.mean[std::size_t(i)] / c.fields);
        std::printf("%s, %.1f GHz, cell %d: turn %.1f, v %.2f, %+.2f dB over sionna-rt\n", line.name, ghz, i,
                    c.turn, c.fresnel_number, off);
        (c.fresnel_number < 0 ? shadow : light).add(off);
      }
      std::printf("  segments, soft, %s, %.1f GHz: shadow %s; light %s\n", line.name, ghz,
                  shadow.text().c_str(), light.text().c_str());
      EXPECT_LT(std::abs(shadow.largest), 0.5);
      EXPECT_LT(std::abs(light.largest), 1);
    }
}

TEST(EdgeSionna, BehindAWall) {
  for (const double ghz : {3.5, 28.0}) expect_agreement(0, ghz);
}
TEST(EdgeSionna, BesideABlock) {
  for (const double ghz : {3.5, 28.0}) expect_agreement(1, ghz);
}
TEST(EdgeSionna, BetweenTwoBlocks) {
  for (const double ghz : {3.5, 28.0}) expect_agreement(2, ghz);
}
TEST(EdgeSionna, BehindTwoBlocks) {
  for (const double ghz : {3.5, 28.0}) expect_agreement(3, ghz);
}

}  // namespace
}  // namespace aureole::test

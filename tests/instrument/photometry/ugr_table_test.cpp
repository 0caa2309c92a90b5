// SPDX-License-Identifier: Apache-2.0
// Tables of UGR: the background against traced light, the sum over luminaires against its definition, published tables of
// another program, and errors.
#include "aureole/instrument/photometry/ugr_table.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numeric>

#include "aureole/render/job.h"
#include "harness/paths.h"
#include "loading/load_text.h"
#include "loading/test_plugins.h"

namespace aureole::test {
namespace {

/// A luminaire of type C by a text of LM-63: intensities [cd] in steps of 15 degrees of gamma, for half-planes along it and
/// across it, with symmetric quadrants.
Luminaire quadrants(const std::string& sizes, const std::vector<double>& along,
                    const std::vector<double>& across, const std::string& lamps = "1 -1") {
  std::string s = "IESNA:LM-63-2002\nTILT=NONE\n" + lamps + " 1 " + std::to_string(along.size()) + " 2 1 2 " +
                  sizes + "\n1 1 10\n";
  for (std::size_t i = 0; i < along.size(); ++i) s += std::to_string(15 * i) + " ";
  s += "\n0 90\n";
  for (const auto* half_plane : {&along, &across}) {
    for (const double cd : *half_plane) s += std::to_string(cd) + " ";
    s += "\n";
  }
  return parse_luminaire(s, "quadrants.ies");
}

const std::vector<double> kAlong{900, 860, 740, 560, 330, 120, 20}, kAcross{900, 880, 830, 600, 240, 60, 5};

TEST(UgrTable, ProjectedAreas) {
  LuminousOpening o;
  o.size_m = {1.2, 0.3, 0.1};
  EXPECT_NEAR(projected_area(o, {0, 0, 2}), 0.36, 1e-12);
  EXPECT_NEAR(projected_area(o, {1, 0, 0}), 0.03, 1e-12);
  EXPECT_NEAR(projected_area(o, {0, -1, 1}), (0.36 + 0.12) / std::sqrt(2), 1e-12);
  // A circle of 0.2 m, an upright cylinder of 0.2 m and 0.3 m, one that lies, and a ball.
  o.shape = LuminousOpening::Shape::cylinder, o.size_m = {0.2, 0.2, 0};
  EXPECT_NEAR(projected_area(o, {0, std::sqrt(3.0), 1}), M_PI * 0.01 / 2, 1e-12);
  o.size_m[2] = 0.3;
  EXPECT_NEAR(projected_area(o, {3, 4, 0}), 0.06, 1e-12);
  o.axis = 0, o.size_m = {0.3, 0.2, 0.2};
  EXPECT_NEAR(projected_area(o, {0, 0, 1}), 0.06, 1e-12);
  EXPECT_NEAR(projected_area(o, {-1, 0, 0}), M_PI * 0.01, 1e-12);
  o.shape = LuminousOpening::Shape::ellipsoid, o.size_m = {0.2, 0.2, 0.2};
  EXPECT_NEAR(projected_area(o, {1, 2, -5}), M_PI * 0.01, 1e-12);
  // Cauchy: the mean over all directions is a quarter of the surface. Here by midpoints, of an elliptic cylinder.
  o.shape = LuminousOpening::Shape::cylinder, o.axis = 2, o.size_m = {0.4, 0.1, 0.25};
  double sum = 0, perimeter = 0;
  constexpr int kSteps = 400;
  for (int i = 0; i < kSteps; ++i) {
    const double z = (i + 0.5) / kSteps, a = 2 * M_PI * (i + 0.5) / kSteps;
    perimeter += std::hypot(0.2 * std::sin(a), 0.05 * std::cos(a)) * 2 * M_PI / kSteps;
    for (int j = 0; j < kSteps; ++j) {
      const double phi = 2 * M_PI * (j + 0.5) / kSteps, r = std::sqrt(1 - z * z);
      sum += projected_area(o, {r * std::cos(phi), r * std::sin(phi), z}) / (kSteps * kSteps);
    }
  }
  EXPECT_NEAR(sum, (2 * M_PI * 0.2 * 0.05 + 0.25 * perimeter) / 4, 1e-5);
}

TEST(UgrTable, TheSumOverLuminaires) {
  // A Lambertian square of 0.1 m^2 and 1000 cd/m^2 seen in the room of 2 H by 2 H, with luminaires every H: four, at 1 m from
  // both walls. Those at R = 3 m count (H/R = 2/3, T/R = 1/3); those at R = 1 m lie beyond the field of vision.
  std::vector<double> cosine(7);
  for (std::size_t i = 0; i < 7; ++i) cosine[i] = 100 * std::max(0.0, std::cos(double(i) * M_PI / 12));
  const Luminaire square = quadrants("0.31622777 0.31622777 0", cosine, cosine);
  const UgrTable table = ugr_table(square, {.spacing = 1});
  const double distance2 = 9 + 1 + 4,
               cd = square.distribution.at(30, std::acos(2 / std::sqrt(distance2)) * 180 / M_PI);
  const double luminance = cd / (0.1 * 2 / std::sqrt(distance2)), omega = 0.1 * 2 / std::pow(distance2, 1.5);
  // Guth's table in CIE 117 has 3.70 (H/R 0.65) to 3.85 between T/R = 0.3 and 0.4; the formula is fitted to it.
  const double alpha = std::atan(0.5) * 180 / M_PI, beta = std::atan(std::sqrt(5.0) / 3) * 180 / M_PI;
  const double p = std::exp((35.2 - 0.31889 * alpha - 1.22 * std::exp(-2 * alpha / 9)) * 1e-3 * beta +
                            (21 + 0.26667 * alpha - 0.002963 * alpha * alpha) * 1e-5 * beta * beta);
  EXPECT_NEAR(p, 3.7, 0.15);
  const double sum = 2 * luminance * luminance * omega / (p * p);
  for (const auto& view : table.rating)
    for (std::size_t k = 0; k < 5; ++k) {
      const double background = table.background[std::size_t(&view - table.rating.data())][0][k];
      EXPECT_NEAR(view[0][k], 8 * std::log10(0.25 / background * sum), 1e-4);
    }
  EXPECT_NEAR(luminance, 1000, 10);  // the file's intensities are linear in gamma
}

TEST(UgrTable, ViewsFluxesAndSymmetries) {
  const UgrTable table = ugr_table(quadrants("0.3 1.2 0", kAlong, kAcross));
  // Below 45 degrees from the vertical more light goes across, and at 60 to 75 degrees twice as much goes along: endwise glares more.
  for (std::size_t r = 0; r < 19; ++r) EXPECT_GT(table.rating[1][r][0], table.rating[0][r][0]) << r;
  // The luminaire turned by 90 degrees exchanges the views.
  const UgrTable turned = ugr_table(quadrants("1.2 0.3 0", kAcross, kAlong));
  // Rooms of the same size, other reflectances: less light from the walls, more glare.
  for (std::size_t r = 0; r < 19; ++r)
    for (std::size_t k = 0; k < 5; ++k) {
      EXPECT_NEAR(turned.rating[0][r][k], table.rating[1][r][k], 1e-9);
      EXPECT_NEAR(turned.rating[1][r][k], table.rating[0][r][k], 1e-9);
      EXPECT_GT(table.rating[0][r][4], table.rating[0][r][0]);
      EXPECT_LT(table.background[0][r][4], table.background[0][r][0]);
    }
  EXPECT_FALSE(table.is_of_lamps);
  // Far luminaires of 0.36 m^2 look smaller than 0.0003 sr: a note says so.
  ASSERT_EQ(table.notes.size(), 1u);
  EXPECT_NE(table.notes[0].find("0.0003 sr"), std::string::npos);
  // Twice the flux: 8 lg 2 more, and nothing more for 1000 lm.
  Luminaire bright = quadrants("0.3 1.2 0", kAlong, kAcross);
  bright.distribution.scale(2);
  const UgrTable doubled = ugr_table(bright);
  EXPECT_NEAR(doubled.rating[0][5][2] - table.rating[0][5][2], 2.40824, 1e-4);
  EXPECT_NEAR(doubled.correction() - table.correction(), 2.40824, 1e-4);
  EXPECT_NEAR(table.correction(), 8 * std::log10(bright.distribution.flux() / 2000), 1e-9);
  // Lamps of which a half gets out: 1000 lm of lamps.
  const UgrTable lamps = ugr_table(quadrants("0.3 1.2 0", kAlong, kAcross, "2 2500"));
  EXPECT_TRUE(lamps.is_of_lamps);
  EXPECT_NEAR(lamps.correction(), 8 * std::log10(5.0), 1e-9);
  // Observers move among luminaires that are 0.25 H apart: next to nothing changes, and more where they are farther apart.
  double before = 0.05;
  for (const UgrVariation& v : table.variations) {
    EXPECT_GT(v.difference[0][1] - v.difference[0][0], before) << v.spacing;
    EXPECT_LT(v.difference[0][0], v.difference[0][1]);
    before = v.difference[0][1] - v.difference[0][0];
  }
}

TEST(UgrTable, AsymmetricLuminairesFaceTheObserver) {
  // Light goes to C = 90 of LM-63 alone, which is C = 0 of EULUMDAT: it faces the crosswise observer, and turns its side to the
  // one endwise.
  const Luminaire l = parse_luminaire(
      "IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 3 5 1 2 0.3 1.2 0\n1 1 10\n0 45 90\n0 90 180 270 360\n"
      "100 50 0\n100 900 100\n100 50 0\n100 0 0\n100 50 0\n",
      "wall washer");
  const UgrTable table = ugr_table(l);
  EXPECT_GT(table.rating[0][10][0], table.rating[1][10][0] + 3);
  ASSERT_EQ(table.notes.size(), 2u);
  EXPECT_NE(table.notes[0].find("C = 0 of EULUMDAT"), std::string::npos);
  // Turned by 180 degrees it faces away.
  const Luminaire away = parse_luminaire(
      "IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 3 5 1 2 0.3 1.2 0\n1 1 10\n0 45 90\n0 90 180 270 360\n"
      "100 50 0\n100 0 0\n100 50 0\n100 900 100\n100 50 0\n",
      "wall washer");
  EXPECT_LT(ugr_table(away).rating[0][10][0], table.rating[0][10][0] - 10);
  EXPECT_NEAR(ugr_table(away).background[0][10][0], table.background[0][10][0],
              0.02 * table.background[0][10][0]);
}

TEST(UgrTable, BackgroundsAgainstTracedLight) {
  // The room of 4 H by 4 H with 16 luminaires: the mean indirect illuminance of the walls over pi. Light paths through the
  // same room find it without form factors.
  const std::filesystem::path file = source_dir() / "scenes/light/trough.ldt";
  const Luminaire luminaire = read_luminaire(file);
  std::string lamps;
  for (int i = 0; i < 16; ++i)
    lamps +=
        "<emitter type='photometric'><string name='filename' value='" + file.string() +
        "'/><string name='opening' value='point'/><transform name='to_world'><rotate x='1' angle='180'/><translate x='" +
        std::to_string(-3 + 2 * (i % 4)) + "' y='" + std::to_string(-3 + 2 * (i / 4)) +
        "' z='1.999'/></transform></emitter>";
  const auto face = [](const std::string& place, const std::string& rho, bool is_meter) {
    return "<shape type='rectangle'><transform name='to_world'>" + place +
           "</transform><bsdf type='diffuse'><float name='reflectance' value='" + rho + "'/></bsdf>" +
           (is_meter
                ? "<sensor type='irradiancemeter'><film type='hdrfilm'><integer name='width' value='1'/><integer name='height' value='1'/>"
                  "<rfilter type='box'/><string name='quantity' value='illuminance'/></film></sensor>"
                : "") +
           "</shape>";
  };
  // Walls of 8 x 2 m: two lie along the luminaires and two across them.
  const auto wall = [&](double angle, bool is_meter) {
    return face("<scale x='4'/><rotate x='1' angle='90'/><translate y='4' z='1'/><rotate z='1' angle='" +
                    std::to_string(angle) + "'/>",
                "0.5", is_meter);
  };
  const auto illuminance = [&](double measured, int depth, std::uint64_t seed) {
    std::string walls;
    for (const double angle : {0.0, 90.0, 180.0, 270.0}) walls += wall(angle, angle == measured);
    const LoadedScene loaded = load_scene_from_string(
        "<scene version='3.0.0'><integrator type='path'><integer name='max_depth' value='" +
            std::to_string(depth) + "'/></integrator>" + lamps + face("<scale value='4'/>", "0.2", false) +
            face("<rotate x='1' angle='180'/><scale value='4'/><translate z='2'/>", "0.7", false) + walls +
            "</scene>",
        "room.xml", {});
    RenderOptions options;
    options.end = 8192, options.seed = seed;
    RenderJob job(loaded, options);
    job.run(std::atomic<bool>(false));
    return double(job.state().picture().pixels[0]);
  };
  constexpr int kRuns = 12;
  std::array<double, kRuns> indirect{};
  for (std::size_t run = 0; run < kRuns; ++run)
    for (const double measured : {0.0, 90.0})
      indirect[run] += 0.5 * (illuminance(measured, -1, run) - illuminance(measured, 1, run)) / M_PI;
  const double mean = std::accumulate(indirect.begin(), indirect.end(), 0.0) / kRuns;
  double squares = 0;
  for (const double v : indirect) squares += (v - mean) * (v - mean);
  const double error = std::sqrt(squares / kRuns / (kRuns - 1));
  EXPECT_LT(error, 0.003 * mean);
  // The error falls to less than a half with each halving of the patches: 0.7 %, 0.3 % and 0.1 %. Aitken's extrapolation.
  const auto background = [&](double patch) {
    const auto kind = patch > 0 ? UgrOptions::Background::patches : UgrOptions::Background::uniform;
    return ugr_backgrounds(luminaire, {4, 4}, 0, {.spacing = 1, .background = kind, .patch = patch})[0];
  };
  const double coarse = background(0.5), middle = background(0.25), fine = background(0.125),
               even = background(0);
  EXPECT_GT(coarse - middle, 2 * (middle - fine));
  const double limit = fine - (middle - fine) * (middle - fine) / ((coarse - middle) - (middle - fine));
  EXPECT_NEAR(limit, mean, 3 * error + 3e-4 * mean);
  EXPECT_NEAR(coarse, mean, 3 * error + 0.01 * mean);
  RecordProperty("traced", std::to_string(mean) + " +- " + std::to_string(error));
  RecordProperty("patches", std::to_string(limit));
  RecordProperty("uniform", std::to_string(even));
  // Even light on each surface, as CIE 190 assumes, differs by more than noise.
  EXPECT_GT(std::abs(even - mean), 3 * error);
  EXPECT_NEAR(even, mean, 0.1 * mean);
}

TEST(UgrTable, TablesOfAnotherProgram) {
  // data/ugr_tables.json has tables by eulumdat-ugr (make_ugr_tables.py), which has CIE's transfer factors, geometric multipliers
  // and position index as tables. With the formula of the index in its place there, direct fluxes alone make the difference: exact
  // ones depend on the distance of the luminaires from the walls.
  std::ifstream in(source_dir() / "tests/instrument/photometry/data/ugr_tables.json");
  ASSERT_TRUE(in);
  const nlohmann::json judged = nlohmann::json::parse(in);
  ASSERT_EQ(judged["tables"].size(), 12u);
  for (const auto& theirs : judged["tables"]) {
    const std::string file = theirs["file"].get<std::string>();
    const bool has_formula = theirs["index"].get<std::string>() == "formula";
    const UgrTable ours = ugr_table(parse_luminaire(judged["files"].at(file).get<std::string>(), file),
                                    {.spacing = theirs["spacing"].get<double>()});
    double sum = 0, largest = 0;
    for (std::size_t r = 0; r < 19; ++r)
      for (std::size_t c = 0; c < 10; ++c) {
        const double difference = ours.rating[c / 5][r][c % 5] - theirs["values"][r][c].get<double>();
        largest = std::max(largest, std::abs(difference));
        sum += difference / 190;
      }
    EXPECT_LT(largest, has_formula ? 0.3 : 0.5) << file << theirs["index"] << theirs["spacing"];
    EXPECT_LT(std::abs(sum), has_formula ? 0.25 : 0.3) << file << theirs["index"] << theirs["spacing"];
  }
}

TEST(UgrTable, Errors) {
  const auto message = [](const Luminaire& l, double spacing = 0.25) {
    try {
      ugr_table(l, {.spacing = spacing});
    } catch (const Error& e) {
      return std::string(e.what());
    }
    return std::string("no error");
  };
  EXPECT_NE(message(quadrants("0 0 0", kAlong, kAcross)).find("no luminous area"), std::string::npos);
  EXPECT_NE(message(quadrants("0 1.2 0", kAlong, kAcross)).find("no area towards"), std::string::npos);
  EXPECT_NE(message(quadrants("0.3 1.2 0", std::vector<double>(7), std::vector<double>(7))).find("no light"),
            std::string::npos);
  for (const double spacing : {0.0, -1.0, 0.3, 2.0, 0.01, double(NAN)})
    EXPECT_NE(message(quadrants("0.3 1.2 0", kAlong, kAcross), spacing).find("whole number"),
              std::string::npos)
        << spacing;
  Luminaire b = quadrants("0.3 1.2 0", kAlong, kAcross);
  b.type = optics::PhotometricType::b;
  EXPECT_NE(message(b).find("type C"), std::string::npos);
  // A ring of light of 0.2 degrees, between the steps by which fluxes are summed: its background is that of all its flux.
  const UgrTable ring = ugr_table(
      parse_luminaire("IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 5 1 1 2 0.3 1.2 0\n1 1 10\n0 59.9 60 60.1 90\n0\n"
                      "0 0 90000 0 0\n",
                      "ring.ies"));
  const UgrTable wide = ugr_table(
      parse_luminaire("IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 5 1 1 2 0.3 1.2 0\n1 1 10\n0 59 60 61 90\n0\n"
                      "0 0 9000 0 0\n",
                      "ring.ies"));
  for (std::size_t r = 0; r < 19; ++r)
    EXPECT_NEAR(ring.background[0][r][0], wide.background[0][r][0], 0.03 * wide.background[0][r][0]);
  // A spot that lights only the floor below it: nobody is dazzled, and the walls have a background all the same.
  const UgrTable spot = ugr_table(quadrants("0.1 0.1 0", {1000, 0, 0, 0, 0, 0, 0}, {1000, 0, 0, 0, 0, 0, 0}));
  for (std::size_t r = 0; r < 19; ++r) {
    EXPECT_TRUE(std::isinf(spot.rating[0][r][0]) && spot.rating[0][r][0] < 0);
    EXPECT_GT(spot.background[0][r][0], 0);
  }
}

}  // namespace
}  // namespace aureole::test

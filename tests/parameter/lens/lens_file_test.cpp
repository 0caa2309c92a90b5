// SPDX-License-Identifier: Apache-2.0
// Prescriptions of lenses: both formats, mistakes, and rays through known lenses against another program.
#include "aureole/parameter/lens/lens_file.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <map>
#include <random>
#include <sstream>

#include "aureole/core/error.h"
#include "aureole/instrument/lens/lens_figures.h"
#include "harness/paths.h"

namespace aureole::test {
namespace {

using optics::LensRay;
using optics::LensSystem;

LensPrescription parsed(const std::string& text) { return parse_lens(text, "my.lens"); }
std::string mistake(const std::string& text) {
  try {
    parsed(text);
    return "";
  } catch (const Error& e) {
    return e.what();
  }
}
const std::string kSinglet = "50 5 bk7 20 stop\n-50 45 air 20\n";

TEST(LensFile, TablesWithAllTheirWords) {
  const LensPrescription lens = parsed(
      "# a comment\nname  my lens \r\n 20 3 sk16 10 k=-0.5 a4=1e-5 a8=-2e-9 coat=1.38@500 # front\n"
      "inf, 2, air, 9\nstop 1 - 6\n-30 0.5 1.62/36.4 8 coat=ideal\nplane 40 1 8 coat=none\n");
  EXPECT_EQ(lens.name, "my lens");
  ASSERT_EQ(lens.surfaces.size(), 5u);
  const optics::LensSurface& s = lens.surfaces[0];
  EXPECT_DOUBLE_EQ(s.curvature, 0.05);
  EXPECT_DOUBLE_EQ(s.conic, -0.5);
  EXPECT_EQ(s.even, (std::vector<double>{1e-5, 0, -2e-9}));
  EXPECT_DOUBLE_EQ(s.coating_index, 1.38);
  EXPECT_DOUBLE_EQ(s.coating_nm, 500);
  EXPECT_DOUBLE_EQ(s.semi_diameter, 5);
  EXPECT_EQ(lens.surfaces[1].curvature, 0);
  EXPECT_TRUE(lens.surfaces[2].is_stop);
  EXPECT_EQ(lens.surfaces[3].coating_index, 1);
  // The indices of catalogues: N-SK16 has nd 1.62041, and 1.62/36.4 is exact at the d line with its Abbe number.
  const auto n = [&](std::size_t i, double nm) { return lens.glasses[i].index(nm); };
  EXPECT_NEAR(n(0, 587.5618), 1.62041, 1e-5);
  EXPECT_NEAR(n(3, 587.5618), 1.62, 1e-12);
  EXPECT_NEAR((n(3, 587.5618) - 1) / (n(3, 486.1327) - n(3, 656.2725)), 36.4, 1e-9);
  EXPECT_TRUE(lens.is_dispersive());
}

TEST(LensFile, GlassesOfTheCatalogue) {
  // nd and Vd of the data sheets of Schott.
  const std::map<std::string, std::pair<double, double>> sheets{
      {"sk16", {1.62041, 60.32}}, {"sk2", {1.60738, 56.65}},   {"ssk2", {1.62229, 53.27}},
      {"f5", {1.60342, 38.03}},   {"f2", {1.62004, 36.37}},    {"sf6", {1.80518, 25.43}},
      {"sf10", {1.72825, 28.41}}, {"sf5", {1.67270, 32.21}},   {"lak9", {1.69100, 54.71}},
      {"bak4", {1.56883, 55.98}}, {"baf10", {1.67003, 47.11}}, {"bk7", {1.51680, 64.17}}};
  for (const auto& [name, sheet] : sheets) {
    const LensGlass glass = *LensGlass::named(name);
    const double d = glass.index(587.5618);
    EXPECT_NEAR(d, sheet.first, 1.5e-5) << name;
    EXPECT_NEAR((d - 1) / (glass.index(486.1327) - glass.index(656.2725)), sheet.second, 0.02) << name;
  }
  EXPECT_FALSE(LensGlass::named("au"));
}

TEST(LensFile, TablesOfPbrtHaveTheStopAsAnIndexOfZero) {
  const LensPrescription lens = parsed(
      "# radius sep n aperture\n35.98738 1.21638 1.54 23.716\n11.69718 9.9957 1 17.996\n"
      "0 5.12622 0 12.27\n-19.1423 20 1.772 13.5\n-30 40 1 14\n");
  EXPECT_TRUE(lens.surfaces[2].is_stop);
  EXPECT_EQ(lens.glasses[2].index(500), 1);
  EXPECT_FALSE(lens.is_dispersive());
}

const std::string kZmx =
    "VERS 190513\nMODE SEQ\nNAME a singlet\nUNIT CM X W X CM MR CPMM\nSURF 0\n  TYPE STANDARD\n  CURV 0.0\n  DISZ INFINITY\n  DIAM 0\n"
    "SURF 1\n  STOP\n  TYPE EVENASPH\n  CURV 0.2 0 0 0 0 \"\"\n  PARM 1 0\n  PARM 2 0.01\n  CONI -0.3\n  DISZ 0.5\n"
    "  GLAS N-BK7 0 0 1.5168 64.17 0\n  DIAM 1.0 1 0\nSURF 2\n  TYPE STANDARD\n  CURV -0.2\n  DISZ 4.5\n  DIAM 1.0\n"
    "SURF 3\n  TYPE STANDARD\n  CURV 0\n  DISZ 0\n  DIAM 2\n";

TEST(LensFile, SequentialSurfacesOfZmx) {
  const LensPrescription lens = parsed(kZmx);
  EXPECT_EQ(lens.name, "a singlet");
  ASSERT_EQ(lens.surfaces.size(), 2u);
  EXPECT_DOUBLE_EQ(lens.surfaces[0].curvature, 0.02);
  EXPECT_DOUBLE_EQ(lens.surfaces[0].thickness, 5);
  EXPECT_DOUBLE_EQ(lens.surfaces[0].semi_diameter, 10);
  EXPECT_DOUBLE_EQ(lens.surfaces[0].conic, -0.3);
  // 0.01 / cm^3 is 1e-5 / mm^3.
  ASSERT_EQ(lens.surfaces[0].even.size(), 1u);
  EXPECT_NEAR(lens.surfaces[0].even[0], 1e-5, 1e-15);
  EXPECT_TRUE(lens.surfaces[0].is_stop);
  EXPECT_NEAR(lens.glasses[0].index(587.5618), 1.5168, 1e-5);
  // A glass that is unknown has the index and the Abbe number of the file, and a note says so.
  std::string other = kZmx;
  other.replace(other.find("N-BK7"), 5, "H-QK3");
  const LensPrescription unknown = parsed(other);
  ASSERT_EQ(unknown.notes.size(), 1u);
  EXPECT_NE(unknown.notes[0].find("H-QK3"), std::string::npos);
  EXPECT_NEAR(unknown.glasses[0].index(587.5618), 1.5168, 1e-9);
}

// A biconvex singlet has its focus some 48 mm behind it, in air; a stop may stand behind the focus.
TEST(LensFile, ARealImageBeforeAStopIsNotVirtual) {
  LensSettings settings;
  settings.fields = {0}, settings.rays = 20;
  const auto notes_of = [&](const std::string& text) {
    const LensFigures f = measure_lens(parsed(text), settings);
    return std::pair(f.film, f.notes.empty() ? "" : f.notes[0]);
  };
  const auto near = notes_of("50 3 bk7 20\n-50 20 air 20\ninf 30 air 5 stop\n");
  EXPECT_GT(near.first, 0);
  EXPECT_EQ(near.second, "");
  const auto far = notes_of("50 3 bk7 20\n-50 60 air 20\ninf 30 air 5 stop\n");
  EXPECT_LT(far.first, 0);
  EXPECT_NE(far.second.find("is real, but lies "), std::string::npos) << far.second;
  const auto divergent = notes_of("-50 3 bk7 20\n50 60 air 20\ninf 30 air 5 stop\n");
  EXPECT_LT(divergent.first, -60);
  EXPECT_NE(divergent.second.find("is virtual, "), std::string::npos) << divergent.second;
}

TEST(LensFile, LensesThatPassNoLight) {
  // An asphere that throws all light aside, and a surface before the one that precedes it.
  const LensPrescription aside = parsed("50 3 bk7 20 a4=1e9\n-50 50 air 20 stop\n");
  try {
    measure_lens(aside, {});
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.where().file.str(), "my.lens") << e.what();
    EXPECT_NE(std::string(e.what()).find("no light passes"), std::string::npos) << e.what();
  }
  const LensPrescription back = parsed("50 -3 bk7 20\n-50 50 air 20 stop\n");
  ASSERT_EQ(back.notes.size(), 1u);
  EXPECT_EQ(back.notes[0], "my.lens: the vertex of surface 2 lies 3 mm before that of surface 1");
}

TEST(LensFile, MistakesHaveTheirPlace) {
  const auto has = [](const std::string& text, const std::string& words) {
    const std::string message = mistake(text);
    EXPECT_NE(message.find(words), std::string::npos) << text << "\n" << message;
    EXPECT_EQ(message.rfind("my.lens", 0), 0u) << message;
  };
  EXPECT_EQ(mistake(kSinglet), "");
  has("", "no surface");
  has("# only a comment\n", "no surface");
  has("50 5 bk7\n" + kSinglet, "my.lens:1:1: a surface needs radius");
  has("x 5 bk7 20\n", "my.lens:1:1");
  has("50 y bk7 20\n", "my.lens:1:4");
  has("50 5 bk77 20\n", "did you mean \"bk7\"");
  has("50 5 0.5 20\n", "between 1 and 10");
  has("50 5 1.5/2 20\n", "Abbe number");
  has("50 5 bk7 0\n", "must be positive");
  has("50 5 bk7 -3\n", "must be positive");
  has("5 5 bk7 20 stop\n", "too small");
  has("50 5 bk7 20 stop q=3\n", "unknown \"q=3\"");
  has("50 5 bk7 20 stop a5=3\n", "a4=, a6=");
  has("50 5 bk7 20 stop k=\n", "conic");
  has("50 5 bk7 20 stop coat=0.5@550\n", "between 1 and 5");
  has("50 5 bk7 20 stop coat=1.38@1\n", "wavelength");
  has("50 1e99 bk7 20 stop\n", "1e99");
  has("50 5 bk7 20\n-50 45 air 20\n", "needs a stop");
  has(kSinglet + kSinglet, "several stops");
  has("plane 5 bk7 20 stop\nplane 45 air 20\n", "no focal length");
  std::string many;
  for (int i = 0; i < 300; ++i) many += "50 5 bk7 20\n";
  has(many, "more than 200");
  const auto zmx = [&](const std::string& from, const std::string& to) {
    std::string text = kZmx;
    text.replace(text.find(from), from.size(), to);
    return text;
  };
  has(zmx("TYPE EVENASPH", "TYPE COORDBRK"), "COORDBRK");
  has(zmx("GLAS N-BK7", "GLAS MIRROR"), "mirror");
  has(zmx("PARM 1 0", "PARM 1 3"), "PARM 2 to 10");
  has(zmx("UNIT CM", "UNIT FURLONG"), "FURLONG");
  has(zmx("  DIAM 1.0\n", ""), "no diameter");
  has("SURF 0\nSURF 1\n", "no surface between");
}

TEST(LensFile, DamagedFilesEndInLocatedErrors) {
  std::mt19937 random(11);
  for (const std::string& whole : {kZmx, kSinglet + "name x\nstop 1 - 3\n"})
    for (int i = 0; i < 3000; ++i) {
      std::string text = whole;
      for (int k = std::uniform_int_distribution<int>(1, 4)(random); k > 0 && !text.empty(); --k) {
        const std::size_t at = std::uniform_int_distribution<std::size_t>(0, text.size() - 1)(random);
        switch (random() % 4) {
          case 0:
            text[at] = char(random());
            break;
          case 1:
            text.resize(at);
            break;
          case 2:
            text.insert(at, text.substr(at / 2, random() % 20));
            break;
          default:
            text.erase(at, random() % 10);
        }
      }
      try {
        const LensPrescription lens = parsed(text);
        EXPECT_EQ(lens.surfaces.size(), lens.glasses.size());
      } catch (const Error& e) {
        EXPECT_EQ(std::string(e.what()).rfind("my.lens", 0), 0u) << e.what();
      }
    }
}

/// The figures of data/optiland_rays.csv, which make_lens_rays.py writes.
TEST(LensFile, RaysAndSpotsOfAnotherProgram) {
  std::ifstream in(source_dir() / "tests/parameter/lens/data/optiland_rays.csv");
  ASSERT_TRUE(in);
  int first = 0, rays = 0, spots = 0;
  const std::map<std::string, double> pupils{{"double_gauss", 33.33}, {"triplet", 10}};
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("#")) continue;
    std::istringstream cells(line);
    std::vector<std::string> words;
    for (std::string word; std::getline(cells, word, ',');) words.push_back(word);
    LensPrescription lens = read_lens(source_dir() / "tests/references/scenes/lenses" / (words[1] + ".lens"));
    // Rays of the other program are stopped by nothing.
    for (optics::LensSurface& s : lens.surfaces)
      s.semi_diameter = std::max(s.semi_diameter, 0.95 / std::max(1e-3, std::abs(s.curvature)));
    const LensSystem system(lens.surfaces);
    const double nm = 1000 * std::stod(words[2]), semi = 0.5 * pupils.at(words[1]);
    const std::vector<double> n = lens.indices(nm);
    const optics::ParaxialLens p = system.paraxial(n);
    if (words[0] == "first") {
      EXPECT_NEAR(p.focal_length, std::stod(words[3]), 1e-6) << line;
      EXPECT_NEAR(p.entrance_pupil, std::stod(words[4]), 1e-6) << line;
      EXPECT_NEAR(p.exit_pupil - system.film(), std::stod(words[5]), 1e-6) << line;
      ++first;
      continue;
    }
    const double field = std::stod(words[3]) * M_PI / 180;
    const auto at_film = [&](double px, double py) {
      LensRay ray{{px * semi, py * semi, p.entrance_pupil}, {0, std::sin(field), std::cos(field)}};
      for (std::size_t k = 0; k < 3; ++k) ray.o[k] -= ray.d[k] * 150;
      EXPECT_TRUE(system.trace(ray, n, nm)) << line;
      const double along = (system.film() - ray.o[2]) / ray.d[2];
      return std::array<double, 2>{ray.o[0] + ray.d[0] * along, ray.o[1] + ray.d[1] * along};
    };
    if (words[0] == "ray") {
      const auto hit = at_film(std::stod(words[4]), std::stod(words[5]));
      EXPECT_NEAR(hit[0], std::stod(words[6]), 1e-6) << line;
      EXPECT_NEAR(hit[1], std::stod(words[7]), 1e-6) << line;
      ++rays;
      continue;
    }
    // The spot over the entrance pupil by the other program's rays: 60 rings about the middle, the i-th of 6 i rays.
    double x = 0, y = 0, xx = 0, count = 0;
    constexpr int kRings = 60;
    for (int i = 0; i <= kRings; ++i)
      for (int k = 0; k < std::max(1, 6 * i); ++k) {
        const double r = double(i) / kRings, turn = 2 * M_PI * k / std::max(1, 6 * i);
        const auto q = at_film(r * std::cos(turn), r * std::sin(turn));
        x += q[0], y += q[1], xx += q[0] * q[0] + q[1] * q[1], ++count;
      }
    const double rms = std::sqrt(xx / count - (x * x + y * y) / (count * count));
    EXPECT_NEAR(rms, std::stod(words[4]), 0.01 * std::stod(words[4])) << line;
    ++spots;
  }
  EXPECT_EQ(first, 6);
  EXPECT_EQ(rays, 72);
  EXPECT_EQ(spots, 18);
}

TEST(LensFile, PublishedSpotsOfACookeTriplet) {
  // Root mean square radii [um] about the centroid at 550 nm, of the triplet of 50 mm at f/5, fields of 0, 14 and 20 degrees
  // and 480, 550 and 650 nm, with 6 rings of rays: H. Kramer, optiland (its published test of spot diagrams, 2025). Its SK16 is
  // the one of Hikari's catalogue, whose dispersion differs from Schott's N-SK16.
  const double published[3][3] = {
      {3.791335, 4.293690, 6.195619}, {15.694600, 16.786721, 19.109151}, {13.229165, 12.081349, 13.596802}};
  LensPrescription lens = read_lens(source_dir() / "tests/references/scenes/lenses/triplet.lens");
  for (optics::LensSurface& s : lens.surfaces) s.semi_diameter = 0.95 / std::max(1e-3, std::abs(s.curvature));
  LensSystem system(lens.surfaces);
  const auto indices = [&](double nm) {
    std::vector<double> n = lens.indices(nm);
    const double l2 = nm * nm * 1e-6;
    const double sk16 = std::sqrt(2.592001 - 0.01540969 * l2 + 0.0102268 / l2 + 0.001581559 / (l2 * l2) -
                                  0.0001877149 / (l2 * l2 * l2) + 1.012515e-5 / (l2 * l2 * l2 * l2));
    for (double& x : n)
      if (std::abs(x - sk16) < 1e-4) x = sk16;
    return n;
  };
  const double fields[3] = {0, 14, 20}, wavelengths[3] = {480, 550, 650};
  const double pupil = system.paraxial(indices(550)).entrance_pupil;
  for (int f = 0; f < 3; ++f) {
    std::array<double, 2> centroid{};
    const auto spot = [&](double nm, bool is_centroid) {
      const double field = fields[f] * M_PI / 180;
      const std::vector<double> n = indices(nm);
      double x = 0, y = 0, xx = 0, count = 0;
      for (int i = 0; i <= 6; ++i)
        for (int k = 0; k < std::max(1, 6 * i); ++k) {
          const double r = 5.0 * i / 6, turn = 2 * M_PI * k / std::max(1, 6 * i);
          LensRay ray{{r * std::cos(turn), r * std::sin(turn), pupil}, {0, std::sin(field), std::cos(field)}};
          for (std::size_t c = 0; c < 3; ++c) ray.o[c] -= ray.d[c] * 150;
          EXPECT_TRUE(system.trace(ray, n, nm));
          const double along = (system.film() - ray.o[2]) / ray.d[2];
          const double px = ray.o[0] + ray.d[0] * along - centroid[0],
                       py = ray.o[1] + ray.d[1] * along - centroid[1];
          x += px, y += py, xx += px * px + py * py, ++count;
        }
      if (is_centroid) centroid = {x / count, y / count};
      return 1000 * std::sqrt(xx / count);
    };
    spot(550, true);
    for (int w = 0; w < 3; ++w)
      EXPECT_NEAR(spot(wavelengths[w], false), published[f][w], 1e-4 * published[f][w]) << f << w;
  }
}

}  // namespace
}  // namespace aureole::test

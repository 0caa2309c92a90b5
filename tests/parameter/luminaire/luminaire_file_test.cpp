// SPDX-License-Identifier: Apache-2.0
// Readers and writers of IES LM-63 and EULUMDAT. Expected intensities are written beside the files' text, by the rules of
// the formats.
#include "aureole/parameter/luminaire/luminaire_file.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <random>

#include "aureole/core/error.h"
#include "harness/paths.h"
#include "loading/test_plugins.h"

namespace aureole::test {
namespace {

using optics::PhotometricType;

Luminaire parse(const std::string& text, const LuminaireOptions& options = {}) {
  return parse_luminaire(text, "lamp.ies", options);
}
std::string problem(const std::string& text, const LuminaireOptions& options = {}) {
  try {
    parse(text, options);
    return "";
  } catch (const Error& e) {
    EXPECT_EQ(e.where().file.str(), "lamp.ies");
    EXPECT_GT(e.where().line, 0) << e.what();
    return e.what();
  }
}

/// A file of LM-63: `lamp` is the line of counts and sizes, `factors` the three numbers behind it.
std::string ies(const std::string& lamp, const std::string& factors, const std::string& numbers,
                const std::string& standard = "IESNA:LM-63-2002", const std::string& tilt = "TILT=NONE\n") {
  return standard + "\n[TEST] a test\n[MANUFAC] nobody\n[MORE] at all\n" + tilt + lamp + "\n" + factors +
         "\n" + numbers;
}
const std::string kFourPlanes = "0 45 90\n0 30 60 90\n10 20 30\n11 21 31\n12 22 32\n13 23 33\n";

TEST(LuminaireFiles, SymmetricHalfPlanesAreCompleted) {
  // 0 to 90: each quadrant mirrors its neighbours.
  const Luminaire quarter = parse(ies("1 -1 1 3 4 1 2 0 0 0", "1 1 10", kFourPlanes));
  EXPECT_EQ(quarter.symmetry, "about C 0-180 and C 90-270");
  for (const double c : {30, 150, 210, 330, -30, 390})
    EXPECT_NEAR(quarter.distribution.at(c, 45), 21, 1e-12) << c;
  EXPECT_NEAR(quarter.distribution.at(90, 90), 33, 1e-12);
  EXPECT_NEAR(quarter.distribution.at(270, 0), 13, 1e-12);
  EXPECT_NEAR(quarter.distribution.at(180, 90), 30, 1e-12);
  // 0 to 180: the other half mirrors this one.
  const Luminaire half = parse(ies("1 -1 1 3 4 1 2 0 0 0", "1 1 10",
                                   "0 45 90\n0 60 120 180\n10 20 30\n11 21 31\n12 22 32\n13 23 33\n"));
  EXPECT_NEAR(half.distribution.at(300, 45), 21, 1e-12);
  EXPECT_NEAR(half.distribution.at(240, 45), 22, 1e-12);
  EXPECT_NEAR(half.distribution.at(330, 45), 20.5, 1e-12);
  // 90 to 270.
  const Luminaire side = parse(ies("1 -1 1 3 4 1 2 0 0 0", "1 1 10",
                                   "0 45 90\n90 150 210 270\n10 20 30\n11 21 31\n12 22 32\n13 23 33\n"));
  EXPECT_EQ(side.symmetry, "about C 90-270");
  EXPECT_NEAR(side.distribution.at(30, 45), 21, 1e-12);
  EXPECT_NEAR(side.distribution.at(-30, 45), 22, 1e-12);
  EXPECT_NEAR(side.distribution.at(0, 45), 21.5, 1e-12);  // between 30 and 330 degrees
  EXPECT_NEAR(side.distribution.at(270, 45), 23, 1e-12);
  // One half-plane: all.
  const Luminaire round = parse(ies("1 -1 1 3 1 1 2 0 0 0", "1 1 10", "0 45 90\n0\n10 20 30\n"));
  EXPECT_TRUE(round.distribution.is_rotational());
  EXPECT_NEAR(round.distribution.at(77, 22.5), 15, 1e-12);
  // Whole circle, and one that ends before 360 degrees as in the editions before 2002, with a note.
  const Luminaire whole = parse(ies("1 -1 1 3 4 1 2 0 0 0", "1 1 10",
                                    "0 45 90\n0 90 180 360\n10 20 30\n11 21 31\n12 22 32\n13 23 33\n"));
  EXPECT_NEAR(whole.distribution.at(270, 45), 22.5, 1e-12);
  EXPECT_TRUE(whole.notes.empty());
  const Luminaire open = parse(ies("1 -1 1 3 4 1 2 0 0 0", "1 1 10",
                                   "0 45 90\n0 90 180 270\n10 20 30\n11 21 31\n12 22 32\n13 23 33\n"));
  EXPECT_NEAR(open.distribution.at(315, 45), 21.5, 1e-12);
  ASSERT_EQ(open.notes.size(), 1u);
  EXPECT_NE(open.notes[0].find("270"), std::string::npos);
}

TEST(LuminaireFiles, FactorsOfTheEditions) {
  const std::string numbers = "0 90\n0\n100 100\n";
  const auto cd = [&](const std::string& standard) {
    return parse(ies("2 500 1.5 2 1 1 2 0 0 0", "0.9 1.1 10", numbers, standard)).distribution.at(0, 0);
  };
  // The second factor multiplies until 1995; it is reserved in 2002, and no factor since 2019.
  EXPECT_NEAR(cd("IESNA:LM-63-1995"), 100 * 1.5 * 0.9 * 1.1, 1e-9);
  EXPECT_NEAR(cd("IESNA91"), 100 * 1.5 * 0.9 * 1.1, 1e-9);
  EXPECT_NEAR(cd("a line of 1986"), 100 * 1.5 * 0.9 * 1.1, 1e-9);
  EXPECT_NEAR(cd("IESNA:LM-63-2002"), 100 * 1.5 * 0.9, 1e-9);
  EXPECT_NEAR(cd("IES:LM-63-2019"), 100 * 1.5 * 0.9, 1e-9);
  const Luminaire lamp = parse(ies("2 500 1.5 2 1 1 2 0 0 0", "0.9 1 10", numbers));
  EXPECT_EQ(lamp.lamp_flux(), 1000);
  EXPECT_EQ(lamp.lamps[0].watts, 10);
  EXPECT_EQ(lamp.keywords[1].second, "nobody at all");
  // 135 cd over a hemisphere, of 1000 lm.
  const FluxBalance balance = flux_balance(lamp);
  EXPECT_NEAR(balance.flux, 2 * M_PI * 135, 1e-9);
  EXPECT_NEAR(balance.output_ratio, 2 * M_PI * 135 / 1000, 1e-12);
  EXPECT_TRUE(parse(ies("1 -1 1 2 1 1 2 0 0 0", "1 1 10", numbers)).is_absolute);
  // The flux of the lamps can be another one, in proportion.
  EXPECT_NEAR(
      parse(ies("2 500 1.5 2 1 1 2 0 0 0", "0.9 1 10", numbers), {.lamp_flux = 3000}).distribution.at(0, 0),
      405, 1e-9);
  EXPECT_THROW(parse(ies("1 -1 1 2 1 1 2 0 0 0", "1 1 10", numbers), {.lamp_flux = 3000}), Error);
}

TEST(LuminaireFiles, OpeningsByTheSignsOfTheirSizes) {
  using Shape = LuminousOpening::Shape;
  const auto opening = [](const std::string& sizes, int units = 2, int type = 1) {
    const std::string angles = type == 1 ? "0 90\n0\n1 1\n" : "0 90\n0 90\n1 1 1 1\n";
    return parse(ies("1 -1 1 2 " + std::string(type == 1 ? "1 " : "2 ") + std::to_string(type) + " " +
                         std::to_string(units) + " " + sizes,
                     "1 1 10", angles))
        .opening;
  };
  // Width, length, height; x runs along the length.
  const LuminousOpening box = opening("0.3 1.2 0.1");
  EXPECT_EQ(box.shape, Shape::box);
  EXPECT_EQ(box.size_m, (std::array<double, 3>{1.2, 0.3, 0.1}));
  EXPECT_NEAR(opening("1 2 0", 1).size_m[0], 0.6096, 1e-12);  // feet
  EXPECT_EQ(opening("0.3 1.2 0", 2, 2).size_m,
            (std::array<double, 3>{0.3, 1.2, 0}));  // type B: the width is horizontal
  for (const char* circle : {"-0.2 -0.2 0", "-0.2 0 0", "0 -0.2 0"}) {
    const LuminousOpening o = opening(circle);
    EXPECT_EQ(o.shape, Shape::cylinder) << circle;
    EXPECT_EQ(o.axis, 2) << circle;
    EXPECT_EQ(o.size_m, (std::array<double, 3>{0.2, 0.2, 0})) << circle;
  }
  EXPECT_EQ(opening("-0.2 -0.2 -0.2").shape, Shape::ellipsoid);
  const LuminousOpening tube = opening("-0.1 1.2 -0.1");
  EXPECT_EQ(tube.shape, Shape::cylinder);
  EXPECT_EQ(tube.axis, 0);
  EXPECT_EQ(opening("0 1.2 -0.1").axis, 0);
  EXPECT_EQ(opening("1.2 -0.1 -0.1").axis, 1);
  EXPECT_TRUE(opening("0 0 0").is_point());
  EXPECT_NE(
      problem(ies("1 -1 1 2 1 1 2 -0.1 0.2 0.3", "1 1 10", "0 90\n0\n1 1\n")).find("no luminous opening"),
      std::string::npos);
}

TEST(LuminaireFiles, FactorsOfTilt) {
  const std::string lamp = "1 1000 1 2 1 1 2 0 0 0", numbers = "0 90\n0\n1 1\n";
  const Luminaire l =
      parse(ies(lamp, "1 1 10", numbers, "IESNA:LM-63-2002", "TILT=INCLUDE\n2\n3\n0 45 90\n1, 0.9, 0.7\n"));
  EXPECT_EQ(l.tilt.geometry, 2);
  EXPECT_NEAR(l.tilt.at(22.5), 0.95, 1e-12);
  EXPECT_NEAR(l.tilt.at(180), 0.7, 1e-12);
  EXPECT_NEAR(l.distribution.at(0, 0), 1, 1e-12);
  TemporaryFolder folder;
  std::ofstream(folder.path / "tilt.txt") << "1\n2\n0 90\n1 0.5\n";
  std::vector<std::filesystem::path> files;
  LuminaireOptions options;
  options.on_file = [&](const auto& file) { files.push_back(file); };
  const Luminaire named = parse_luminaire(ies(lamp, "1 1 10", numbers, "IESNA:LM-63-2002", "TILT=tilt.txt\n"),
                                          folder.path / "lamp.ies", options);
  EXPECT_NEAR(named.tilt.at(45), 0.75, 1e-12);
  ASSERT_EQ(files.size(), 1u);
  EXPECT_EQ(files[0].filename(), "tilt.txt");
  EXPECT_NE(
      problem(ies(lamp, "1 1 10", numbers, "IESNA:LM-63-2002", "TILT=missing.txt\n")).find("no such file"),
      std::string::npos);
  EXPECT_NE(
      problem(ies(lamp, "1 1 10", numbers, "IESNA:LM-63-2002", "TILT=/etc/passwd\n")).find("same folder"),
      std::string::npos);
}

TEST(LuminaireFiles, TypesAAndB) {
  // Horizontal 0 to 90: mirrored. A lobe to the right of the beam and up.
  const Luminaire a =
      parse(ies("1 -1 1 3 3 3 2 0 0 0", "1 1 10", "-90 0 90\n-90 0 90\n0 0 0\n0 7 0\n0 8 5\n"));
  EXPECT_EQ(a.type, PhotometricType::a);
  EXPECT_NEAR(a.distribution.intensity({0, 0, 1}), 7, 1e-9);
  EXPECT_NEAR(a.distribution.intensity({-1, 0, 0}), 8, 1e-9);  // to the right
  EXPECT_NEAR(a.distribution.intensity({1, 0, 0}), 0, 1e-9);
  const Luminaire b = parse(ies("1 -1 1 3 2 2 2 0 0 0", "1 1 10", "-90 0 90\n0 90\n1 7 3\n4 4 4\n"));
  EXPECT_EQ(b.type, PhotometricType::b);
  EXPECT_EQ(b.symmetry, "about the vertical plane");
  EXPECT_NEAR(b.distribution.intensity({0, 0, 1}), 7, 1e-9);
  EXPECT_NEAR(b.distribution.intensity({0, 1, 0}), 3, 1e-9);
  EXPECT_NEAR(b.distribution.intensity({0, -1, 0}), 1, 1e-9);
  EXPECT_NEAR(b.distribution.intensity({-1, 0, 0}), 4, 1e-9);
  EXPECT_NEAR(b.distribution.intensity({1, 0, 0}), 4, 1e-9);
  // Light at the end of the angles is noted.
  const Luminaire cut = parse(ies("1 -1 1 2 2 2 2 0 0 0", "1 1 10", "-40 40\n-30 30\n1 1\n1 1\n"));
  EXPECT_EQ(cut.notes.size(), 4u);
}

/// A file of EULUMDAT with the given symmetry, angles C and intensities [cd/klm], for gamma 0, 45 and 90.
std::string ldt(int symmetry, const std::vector<double>& c, const std::vector<double>& intensities,
                const std::string& lamps = "1\n1\nlamp\n2000\n4000\n1B\n20\n",
                const std::string& conversion = "1") {
  std::string s = "maker\n1\n" + std::to_string(symmetry) + "\n" + std::to_string(c.size()) +
                  "\n0\n3\n45\nreport\nname\nnumber\nfile\ndate\n";
  s += "1200\n300\n80\n1100\n200\n10\n0\n0\n0\n100\n62,5\n" + conversion + "\n0\n" + lamps;
  for (int i = 0; i < 10; ++i) s += "0\n";
  for (const double x : c) s += std::to_string(x) + "\n";
  s += "0\n45\n90\n";
  for (const double x : intensities) s += std::to_string(x) + "\n";
  return s;
}

TEST(LuminaireFiles, SymmetriesOfEulumdat) {
  const std::vector<double> quarters{0, 90, 180, 270};
  const Luminaire none = parse(ldt(0, quarters, {10, 20, 30, 10, 21, 31, 10, 22, 32, 10, 23, 33}));
  EXPECT_EQ(none.lamp_flux(), 2000);
  EXPECT_NEAR(none.output_ratio, 0.625, 1e-12);  // written with a comma
  EXPECT_EQ(none.opening.size_m, (std::array<double, 3>{1.1, 0.2, 0.01}));
  EXPECT_NEAR(none.distribution.at(180, 45), 44, 1e-12);  // 22 cd/klm of 2 klm
  EXPECT_NEAR(none.distribution.at(315, 45), 43, 1e-12);
  const Luminaire one = parse(ldt(1, quarters, {10, 20, 30}));
  EXPECT_TRUE(one.distribution.is_rotational());
  const Luminaire two = parse(ldt(2, quarters, {10, 20, 30, 10, 21, 31, 10, 22, 32}));
  EXPECT_NEAR(two.distribution.at(270, 45), 42, 1e-12);
  EXPECT_NEAR(two.distribution.at(225, 45), 43, 1e-12);
  // Stored from C = 270 through 0 to 90.
  const Luminaire three = parse(ldt(3, quarters, {10, 20, 30, 10, 21, 31, 10, 22, 32}));
  EXPECT_NEAR(three.distribution.at(270, 45), 40, 1e-12);
  EXPECT_NEAR(three.distribution.at(0, 45), 42, 1e-12);
  EXPECT_NEAR(three.distribution.at(180, 45), 42, 1e-12);
  EXPECT_NEAR(three.distribution.at(90, 45), 44, 1e-12);
  EXPECT_NEAR(three.distribution.at(135, 45), 43, 1e-12);
  EXPECT_NEAR(three.distribution.at(225, 45), 41, 1e-12);
  const Luminaire four = parse(ldt(4, quarters, {10, 20, 30, 10, 21, 31}));
  for (const double c : {45, 135, 225, 315}) EXPECT_NEAR(four.distribution.at(c, 45), 41, 1e-12) << c;
  // C = 0 runs across the luminaire: along -y, and C = 90 along -x.
  EXPECT_NEAR(none.distribution.intensity({0, -1, 0}), 60, 1e-9);
  EXPECT_NEAR(none.distribution.intensity({-1, 0, 0}), 62, 1e-9);
  EXPECT_NEAR(parse(ldt(0, quarters, {10, 20, 30, 10, 21, 31, 10, 22, 32, 10, 23, 33}),
                    {.zero_plane = LuminaireOptions::ZeroPlane::along})
                  .distribution.intensity({1, 0, 0}),
              60, 1e-9);
}

TEST(LuminaireFiles, TheContentDecidesTheFormat) {
  // A luminaire of EULUMDAT may be called TILT=INCLUDE.
  std::string text = ldt(1, {0}, {10, 20, 30});
  text.replace(text.find("\nname\n"), 6, "\nTILT=INCLUDE\n");
  EXPECT_EQ(parse(text).format, Luminaire::Format::eulumdat);
  EXPECT_EQ(parse(ies("1 -1 1 2 1 1 2 0 0 0", "1 1 10", "0 90\n0\n1 1\n", "1986\n1\n1\nx")).format,
            Luminaire::Format::ies);
}

TEST(LuminaireFiles, HalfPlanesAtUnequalDistancesKeepTheirValues) {
  const Luminaire uneven =
      parse(ldt(0, {0, 20, 50, 180, 300}, {9, 1, 2, 9, 3, 4, 9, 5, 6, 9, 7, 8, 9, 2, 1}));
  const Luminaire as_ies = parse(ies_text(uneven));
  for (const double c : {0.0, 20.0, 50.0, 180.0, 300.0})
    for (const double gamma : {45.0, 90.0}) {
      const auto d = uneven.distribution.direction(c, gamma);
      EXPECT_NEAR(as_ies.distribution.intensity(d), uneven.distribution.at(c, gamma), 1e-4) << c;
      EXPECT_NEAR(parse(eulumdat_text(as_ies)).distribution.intensity(d), uneven.distribution.at(c, gamma),
                  1e-4)
          << c;
    }
  EXPECT_NEAR(as_ies.distribution.flux(), uneven.distribution.flux(), 1e-5 * uneven.distribution.flux());
}

TEST(LuminaireFiles, LampsOfEulumdat) {
  const std::string sets = "2\n1\nfirst\n1000\n4000\n1B\n20\n1\nsecond\n3000\n4000\n1B\n20\n";
  const Luminaire first = parse(ldt(1, {0}, {10, 20, 30}, sets)),
                  second = parse(ldt(1, {0}, {10, 20, 30}, sets), {.lamp_set = 1});
  EXPECT_NEAR(first.distribution.at(0, 0), 10, 1e-12);
  EXPECT_NEAR(second.distribution.at(0, 0), 30, 1e-12);
  EXPECT_EQ(first.notes.size(), 1u);
  EXPECT_NE(problem(ldt(1, {0}, {10, 20, 30}, sets), {.lamp_set = 2}).find("no set of lamps 2"),
            std::string::npos);
  // A negative number of lamps: absolute photometry, in cd/klm of the luminaire's flux.
  const Luminaire absolute = parse(ldt(1, {0}, {10, 20, 30}, "1\n-1\nled\n500\n4000\n80\n20\n", "2"));
  EXPECT_TRUE(absolute.is_absolute);
  EXPECT_EQ(absolute.lamp_flux(), 0);
  EXPECT_NE(problem(ldt(1, {0}, {10, 20, 30}, "1\n-1\nled\n500\n4000\n80\n20\n", "2"), {.lamp_flux = 700})
                .find("do not refer to the flux of lamps"),
            std::string::npos);
  EXPECT_NEAR(absolute.distribution.at(0, 0), 10, 1e-12);
  EXPECT_NE(problem(ldt(1, {0}, {10, 20, 30}, "1\n1\nled\n0\n4000\n80\n20\n")).find("lamp_flux"),
            std::string::npos);
  EXPECT_NEAR(parse(ldt(1, {0}, {10, 20, 30}, "1\n1\nled\n0\n4000\n80\n20\n"), {.lamp_flux = 700})
                  .distribution.at(0, 0),
              7, 1e-12);
}

TEST(LuminaireFiles, UnequalHalfPlanesSurviveConversionsBetweenTheFormats) {
  // Along the luminaire 100 cd, across it 400 and 250 cd, at the other end 50 cd.
  const Luminaire from_ies =
      parse(ies("1 -1 1 3 5 1 2 0.1 1.2 0", "1 1 10",
                "0 90 180\n0 90 180 270 360\n9 100 1\n9 400 1\n9 50 1\n9 250 1\n9 100 1\n"));
  const std::string as_ldt = eulumdat_text(from_ies);
  const Luminaire from_ldt = parse(as_ldt);
  EXPECT_EQ(from_ldt.format, Luminaire::Format::eulumdat);
  // C = 0 of EULUMDAT is the half-plane C = 90 of LM-63, across the luminaire.
  EXPECT_NEAR(from_ies.distribution.at(0, 90), 100, 1e-9);
  EXPECT_NEAR(from_ldt.distribution.at(0, 90), 400, 1e-3);
  EXPECT_NEAR(from_ldt.distribution.at(90, 90), 50, 1e-3);
  EXPECT_NEAR(from_ldt.distribution.at(270, 90), 100, 1e-3);
  const Luminaire back = parse(ies_text(from_ldt));
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 500; ++i) {
    const optics::LuminaireVector d{normal(random), normal(random), normal(random)};
    const double cd = from_ies.distribution.intensity(d);
    EXPECT_NEAR(from_ldt.distribution.intensity(d), cd, 1e-3) << i;
    EXPECT_NEAR(back.distribution.intensity(d), cd, 1e-3) << i;
  }
  for (const Luminaire* l : {&from_ldt, &back}) {
    EXPECT_NEAR(l->opening.size_m[0], 1.2, 1e-9);
    EXPECT_NEAR(l->opening.size_m[1], 0.1, 1e-9);
    EXPECT_TRUE(l->is_absolute);
    EXPECT_NEAR(l->distribution.flux(), from_ies.distribution.flux(), 1e-4 * from_ies.distribution.flux());
  }
}

TEST(LuminaireFiles, ErrorsSayWhereAndWhat) {
  const auto fails = [](const std::string& text, const std::string& where, const std::string& what) {
    const std::string message = problem(text);
    EXPECT_NE(message.find("lamp.ies:" + where), std::string::npos) << message;
    EXPECT_NE(message.find(what), std::string::npos) << message;
  };
  const std::string good = "1 -1 1 3 4 1 2 0 0 0";
  fails(ies("0 -1 1 3 4 1 2 0 0 0", "1 1 10", kFourPlanes), "6:1", "number of lamps");
  fails(ies("1 -5 1 3 4 1 2 0 0 0", "1 1 10", kFourPlanes), "6:3", "-1 for absolute photometry");
  fails(ies("1 -1 0 3 4 1 2 0 0 0", "1 1 10", kFourPlanes), "6:6", "candela multiplier");
  fails(ies("1 -1 1 3.5 4 1 2 0 0 0", "1 1 10", kFourPlanes), "6:8", "whole number");
  fails(ies("1 -1 1 3 4 4 2 0 0 0", "1 1 10", kFourPlanes), "6:12", "photometric type");
  fails(ies("1 -1 1 3 4 1 3 0 0 0", "1 1 10", kFourPlanes), "6:14", "type of units");
  fails(ies(good, "-1 1 10", kFourPlanes), "7:1", "ballast factor");
  fails(ies(good, "1 1 10", "0 45 45\n0 30 60 90\n1 1 1\n1 1 1\n1 1 1\n1 1 1\n"), "8:", "must increase");
  fails(ies(good, "1 1 10", "0 45 200\n0 30 60 90\n1 1 1\n1 1 1\n1 1 1\n1 1 1\n"), "8:", "between 0 and 180");
  fails(ies(good, "1 1 10", "0 45 90\n0 30 60 85\n1 1 1\n1 1 1\n1 1 1\n1 1 1\n"), "9:9",
        "from 0 to 0, 90, 180 or 360");
  fails(ies(good, "1 1 10", "0 45 90\n0 30 60 90\n1 -2 1\n1 1 1\n1 1 1\n1 1 1\n"), "10:3", "0 cd or more");
  fails(ies(good, "1 1 10", "0 45 90\n0 30 60 90\n1 nan 1\n1 1 1\n1 1 1\n1 1 1\n"), "10:3", "\"nan\"");
  fails(ies(good, "1 1 10", "0 45 90\n0 30 60 90\n1 1 1\n1 1 1\n1 1 1\n1 1"),
        "13:", "ends where an intensity");
  // Counts that the file can't hold take no memory.
  fails(ies("1 -1 1 900000000 4 1 2 0 0 0", "1 1 10", kFourPlanes), "7:", "too short");
  fails(ies("1 -1 1 3 900000000 1 2 0 0 0", "1 1 10", kFourPlanes), "8:", "too short");
  fails("no lamp\nat all\n", "2:1", "TILT=");
  fails("", "1:1", "empty");
  fails(ldt(2, {0, 90, 180}, {1, 1, 1}), "", "that 2 divides");
  fails(ldt(0, {0, 90, 180, 270}, {1, 1, 1}), "", "ends where an intensity");
  // Errors of EULUMDAT have the line of their number.
  fails(ldt(1, {0}, {1, -1, 1}), "48:1", "0 cd/klm or more");
  fails(ldt(1, {0}, {1, 1, 1e30}), "49:1", "too large");
  fails(ldt(0, {0, 180, 90, 270}, {1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1}), "45:1", "must increase");
  fails(ldt(0, {0, 90, 180, 400}, {1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1}), "46:1", "between 0 and 360");
  fails(ldt(4, {0, 45, 180, 270}, {1, 1, 1, 1, 1, 1}), "44:1", "C = 90");
  fails(ldt(1, {0}, {1, 1, 1}, "1\n1\nlamp\n0\n4000\n1B\n20\n"), "29:1", "no flux");
  // A wrong conversion factor.
  fails(ldt(1, {0}, {1, 1, 1}, "1\n1\nlamp\n2000\n4000\n1B\n20\n", "-1"), "24:1", "conversion factor");
}

TEST(LuminaireFiles, EveryBeginningOfAFileIsReadOrALocatedError) {
  for (const char* name : {"downlight.ies", "batten.ldt"}) {
    std::ifstream in(example_file(name), std::ios::binary);
    const std::string whole{std::istreambuf_iterator<char>(in), {}};
    ASSERT_GT(whole.size(), 400u);
    int read = 0;
    for (std::size_t n = 0; n < whole.size(); ++n) {
      if (problem(whole.substr(0, n)).empty()) ++read;
    }
    EXPECT_LT(read, 8) << name;  // the ends of the last number
    EXPECT_EQ(problem(whole), "");
    // Any byte may be wrong.
    std::mt19937 random(7);
    for (int i = 0; i < 4000; ++i) {
      std::string damaged = whole;
      for (int k = 0; k < 3; ++k) damaged[random() % damaged.size()] = char(random() % 256);
      try {
        const Luminaire l = parse_luminaire(damaged, "lamp.ies");
        EXPECT_TRUE(std::isfinite(l.distribution.flux()));
      } catch (const Error& e) {
        EXPECT_FALSE(e.where().file.empty());
      }
    }
  }
}

}  // namespace
}  // namespace aureole::test

// SPDX-License-Identifier: Apache-2.0
// aureole pigment as a user meets it: tables in, palettes and recipes out, and wrong input with its place,
// exit code 2 and nothing written.
#include "apps/pigment_cli.h"

#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>
#include <sstream>

namespace aureole::test {
namespace {

TEST_F(PigmentCli, FromMeasurementsToARecipe) {
  ASSERT_EQ(run("fit kimera -o paints.csv --json fit.json --plot fit.svg --plot-k k.svg "
                "--plot-s s.svg --plot-differences differences.svg"),
            0)
      << said;
  EXPECT_NE(said.find("13 paints, 75 measurements"), std::string::npos) << said;
  const auto fit = json("fit.json");
  EXPECT_EQ(fit["pigments"].size(), 13u);
  for (const auto& p : fit["pigments"]) EXPECT_EQ(p["fit"]["negative_s"], 0) << p["name"];
  // A repeat of a tint is predicted by the others; the limit is how far three measurements of one card
  // differ.
  EXPECT_LT(fit["left_out"]["mixtures"]["mean"], 1.0);
  const auto has = [&](const std::string& file, const std::string& text) {
    std::ifstream in(folder.path / file);
    return std::string(std::istreambuf_iterator<char>(in), {}).find(text) != std::string::npos;
  };
  EXPECT_TRUE(has("fit.svg", ">K/S of the paints of kimera<"));
  EXPECT_TRUE(has("k.svg", ">K, in S of white<"));
  EXPECT_TRUE(has("s.svg", ">cold yellow<"));
  EXPECT_TRUE(has("differences.svg", ">mixtures<"));

  ASSERT_EQ(
      run("mix paints.csv 'red: 15% + cold yellow: 5% + white: 80%' --json mix.json --ladder 5 --plot mix.svg"),
      0)
      << said;
  const auto mix = json("mix.json");
  char target[80];
  std::snprintf(target, sizeof target, "'lab(%.9f,%.9f,%.9f)'", mix["lab"][0].get<double>(),
                mix["lab"][1].get<double>(), mix["lab"][2].get<double>());
  ASSERT_EQ(run("match paints.csv " + std::string(target) + " --json match.json"), 0) << said;
  const auto best = json("match.json")["solutions"][0];
  EXPECT_LT(best["difference"], 5e-3);

  // Its reflectance as a measured sample: the recipe comes back, and other recipes are told from it by other
  // lamps.
  std::string nm = "sample,paints", values = "wanted,";
  for (std::size_t i = 0; i < mix["reflectance"].size(); ++i) {
    nm += "," + mix["wavelengths_nm"][i].dump();
    values += "," + mix["reflectance"][i].dump();
  }
  write("wanted.csv", nm + "\n" + values + "\n");
  ASSERT_EQ(run("match paints.csv wanted.csv#wanted --json match.json --plot match.svg"), 0) << said;
  const auto same = json("match.json")["solutions"][0];
  EXPECT_NEAR(same["recipe"]["red"], 0.15, 0.0015);
  EXPECT_NEAR(same["recipe"]["cold yellow"], 0.05, 0.0005);
  EXPECT_LT(same["metamerism"]["A"], 0.01);

  ASSERT_EQ(run("hide paints.csv white --json hide.json --thickness 2 --plot hide.svg"), 0) << said;
  EXPECT_GT(json("hide.json")["hiding_thickness"], 1.0);
  EXPECT_LT(json("hide.json")["at_thickness"]["contrast_ratio"], 1.0);
}

TEST_F(PigmentCli, TablesOfTheirOwn) {
  // R = SX/(1 + SX) over black, no absorption: S = R/(1 - R)/X = 1e5 per metre.
  write(
      "white.csv",
      "paints,backing,thickness_um,400,500,600,700\nchalk,0,20,0.6666666667,0.6666666667,0.6666666667,0.6666666667\n"
      "chalk,1,20,1,1,1,1\n");
  ASSERT_EQ(run("fit white.csv -o white_paint.csv --json fit.json"), 0) << said;
  EXPECT_NEAR(json("fit.json")["pigments"][0]["s"][0], 1e5, 1e-3);
  ASSERT_EQ(run("hide white_paint.csv chalk --white 1 --json hide.json"), 0) << said;
  EXPECT_NEAR(json("hide.json")["hiding_thickness"], 49e-5, 1e-9);
  // A litre with 49 % of solids covers 1 m^2 to 490 um; at 2 m^2/l S X is 24.5: R = SX/(1 + SX) over black.
  ASSERT_EQ(run("hide white_paint.csv chalk --white 1 --solids 0.49 --spreading-rate 2 --json hide.json"), 0)
      << said;
  EXPECT_NEAR(json("hide.json")["spreading_rate"], 1, 1e-9);
  EXPECT_NEAR(json("hide.json")["at_spreading_rate"]["contrast_ratio"], 24.5 / 25.5, 1e-9);
  fails("hide white_paint.csv chalk --spreading-rate 2", "--spreading-rate: needs --solids");
  fails("hide kimera white --solids 0.4", "--solids: a spreading rate needs K and S per metre");
  write("white.json", R"({"unit": "percent", "wavelengths_nm": [400, 700], "samples": [
    {"paints": "chalk", "values": [90, 90]}, {"paints": "red", "values": [30, 50]}, {"paints": {"red": 1, "chalk": 3}, "values": [50, 70]}]})");
  ASSERT_EQ(run("fit white.json --white chalk"), 0) << said;
  EXPECT_NE(said.find("2 paints, 3 measurements"), std::string::npos) << said;
}

TEST_F(PigmentCli, RecipesWithCostOpacityAndLimits) {
  write("prices.csv", "paint,price\nwhite,2\nred,20\nred oxide,3\ncold yellow,12\nblack,2\nsnow,1\n");
  const std::string only = " --only white --only red --only 'red oxide' --only 'cold yellow' --only black";
  ASSERT_EQ(run("match kimera 'lab(60,25,20)'" + only + " --prices prices.csv --json m.json"), 0) << said;
  EXPECT_NE(said.find("note: prices.csv:7: the palette has no paint \"snow\""), std::string::npos) << said;
  const std::map<std::string, double> prices{
      {"white", 2}, {"red", 20}, {"red oxide", 3}, {"cold yellow", 12}, {"black", 2}};
  for (const auto& m : solutions("m.json")) {
    double cost = 0;
    for (const auto& [name, share] : m["recipe"].items()) cost += prices.at(name) * share.get<double>();
    EXPECT_NEAR(m["cost"], cost, 1e-9);
    EXPECT_TRUE(m.contains("dosing_error"));
  }
  ASSERT_EQ(run("match kimera 'lab(60,25,20)'" + only +
                " --trade-offs --within 8 --prices prices.csv --json m.json"),
            0)
      << said;
  EXPECT_NE(said.find("Trade-offs: "), std::string::npos);
  for (const auto& m : solutions("m.json")) EXPECT_LE(m["difference"], 8.0);
  ASSERT_EQ(run("match kimera 'lab(60,25,20)'" + only + " --apart 'red, white' --json m.json"), 0) << said;
  for (const auto& m : solutions("m.json"))
    EXPECT_FALSE(m["recipe"].contains("red") && m["recipe"].contains("white"));
  ASSERT_EQ(run("match kimera 'lab(60,25,20)' --thickness 3 --opacity 0.95 --json m.json"), 0) << said;
  for (const auto& m : solutions("m.json")) EXPECT_GE(m["contrast_ratio"], 0.95);

  fails("match kimera teal --opacity 0.95", "a contrast ratio needs a layer with a thickness");
  fails("match kimera teal --thickness 0.001 --opacity 0.95", "the contrast ratio of every recipe");
  fails("match kimera teal --prices prices.csv", "prices.csv: there is no price of");
  fails("match kimera teal --apart red", "--apart: write two paints");
  fails("match kimera teal --apart red,snow", "--apart: unknown paint \"snow\"");
  fails("match kimera teal --by lamps", "needs the target's reflectance");
  write("wrong.csv", "white,cheap\n");
  fails("match kimera teal --prices wrong.csv", "wrong.csv:1:7: expected a price per mass");
  ASSERT_EQ(run("match kimera teal --within 2"), 0);
  EXPECT_NE(said.find("--within: has no effect without --trade-offs"), std::string::npos);
}

/// A grey of twice the K/S: strength 200 %, no tint tone; equal curves differ in no formula.
TEST_F(PigmentCli, ColourOfMeasuredSamples) {
  // K/S = (1 - R)^2/(2R): 0.25 for R = 0.5, and 0.5 for R = 0.381966.
  write(
      "swatches.csv",
      "sample,400,500,600,700\nmaster,0.5,0.5,0.5,0.5\nbatch,0.381966011,0.381966011,0.381966011,0.381966011\n"
      "batch,0.381966012,0.381966012,0.381966012,0.381966012\nwhite,0.9,0.9,0.9,0.9\n");
  ASSERT_EQ(
      run("colour swatches.csv --standard swatches.csv#master --observer 10 --others A,D65/2 --cmc 1:1 --json c.json"),
      0)
      << said;
  const auto all = json("c.json");
  EXPECT_EQ(all["viewing"], "D65/10");
  ASSERT_EQ(all["samples"].size(), 3u);
  EXPECT_EQ(all["samples"][0]["difference"]["ciede2000"], 0.0);
  const auto batch = all["samples"][1];
  EXPECT_NEAR(batch["lab"][0], 116 * std::cbrt(0.381966) - 16, 1e-4);
  EXPECT_NEAR(batch["difference"]["strength"]["maximum"], 2, 1e-6);
  EXPECT_NEAR(batch["difference"]["strength"]["weighted"], 2, 1e-6);
  EXPECT_NEAR(batch["difference"]["strength"]["tone_ciede2000"], 0, 1e-5);
  EXPECT_NEAR(batch["difference"]["metamerism"]["D65/2"], 0, 1e-9);
  EXPECT_NEAR(batch["difference"]["cie1976"], 116 * (std::cbrt(0.5) - std::cbrt(0.381966)), 1e-4);
  EXPECT_NEAR(all["samples"][2]["whiteness"]["whiteness"], 90, 1e-6);
  EXPECT_NE(said.find("CMC(1:1)"), std::string::npos) << said;

  // A film over black and white: the luminous reflectance over black divided by that over white.
  write("films.csv",
        "sample,specimen,paints,backing,400,700\nblack,,,,0.05,0.05\nwhite,,,,0.8,0.8\n"
        "a,1,ochre,black,0.3,0.3\nb,1,ochre,white,0.4,0.4\n");
  ASSERT_EQ(run("colour films.csv --json c.json"), 0) << said;
  EXPECT_NEAR(json("c.json")["samples"][2]["contrast_ratio"], 0.75, 1e-12);
  EXPECT_FALSE(json("c.json")["samples"][0].contains("contrast_ratio"));
  // Gloss of a surface of index 1.5 seen at 8 degrees: 4.0 %.
  ASSERT_EQ(run("colour films.csv#a --geometry d8 --specular excluded --to-specular included --json c.json"),
            0)
      << said;
  EXPECT_NEAR(json("c.json")["samples"][0]["xyz"][1], 34.0, 0.01);
  write("lamp.txt", "# nm power\n380 1\n780 1\n");
  ASSERT_EQ(run("colour films.csv#a --illuminant lamp.txt --observer 10 --json c.json"), 0) << said;
  EXPECT_EQ(json("c.json")["viewing"], "lamp.txt/10");

  fails("colour films.csv#c", "films.csv: no sample is called \"c\"");
  fails("colour films.csv --standard films.csv", "--standard: expected a file and a sample in it");
  fails("colour films.csv --to-specular included", "need the geometry of the measurements");
  fails("colour films.csv --cmc 2", "--cmc: expected two positive numbers");
  fails("colour films.csv --illuminant D6", "unknown illuminant \"D6\"");
  fails("match kimera teal --observer 10", "under D65 for the 2-degree observer");
  ASSERT_EQ(run("match kimera 'lab(50,20,10)' --others A,D65"), 0) << said;
  EXPECT_NE(said.find("--others D65: is the illuminant of the colours itself"), std::string::npos) << said;
  ASSERT_EQ(run("match kimera 'lab(50,20,10)' --observer 10 --others A,D65/2"), 0) << said;
  ASSERT_EQ(run("mix kimera white --observer 10"), 0) << said;
  EXPECT_NE(said.find("illuminant D65/10"), std::string::npos) << said;
}

TEST_F(PigmentCli, OptionsThatContradictOrDoNothing) {
  write("white.csv",
        "sample,400,420,440,460,480,500,520,540,560,580,600,620,640,660,680,700\n"
        "a,0.9,0.9,0.9,0.9,0.9,0.9,0.9,0.9,0.9,0.9,0.9,0.9,0.9,0.9,0.9,0.9\n");
  ASSERT_EQ(run("colour white.csv --illuminant d65 --json c.json"), 0) << said;
  EXPECT_EQ(json("c.json")["viewing"], "D65");
  EXPECT_NEAR(json("c.json")["samples"][0]["whiteness"]["whiteness"], 90, 1e-6);
  EXPECT_NEAR(json("c.json")["samples"][0]["yellowness"], 0, 0.02);
  fails("colour white.csv --illuminant D65/10 --observer 2", "states another observer than --observer 2");
  ASSERT_EQ(run("match kimera 'lab(50,20,10)' --illuminant D65/10"), 0) << said;
  ASSERT_EQ(run("colour white.csv --others A --cmc 1:1 --cie94 textiles"), 0) << said;
  for (const char* option : {"--others", "--cmc", "--cie94"})
    EXPECT_NE(said.find(std::string(option) + ": has no effect without --standard"), std::string::npos)
        << said;
  EXPECT_NE(run("hide kimera white --spreading-rate 0"), 0);
  EXPECT_NE(run("hide kimera white --solids 0"), 0);
  EXPECT_NE(run("mix kimera white --k1 -0.1 --k2 0.5"), 0);
  EXPECT_NE(said.find("--k1: Value -0.1 not in range"), std::string::npos) << said;
  ASSERT_EQ(run("mix kimera white --index 1.4"), 0) << said;
  EXPECT_NE(said.find("--index: has no effect without an interface"), std::string::npos) << said;
  write("prices.csv", "paint,price\nwhite,2\nwhite,5\n");
  fails("match kimera teal --prices prices.csv", "prices.csv:3:1: \"white\" has a price in line 2 already");
  write("twice.csv", "unit,relative\nnm,a K,a S,a K,a S\n400,0.1,1,0.2,1\n700,0.1,1,0.2,1\n");
  fails("mix twice.csv a", "twice.csv:2:12: the column \"a K\" comes twice");
}

/// Half-spaces of isotropic scatterers under diffuse light: .478 and .795 by transport (shared/physics.md 5).
TEST_F(PigmentCli, ErrorIsAMap) {
  ASSERT_EQ(run("error --index 1 --albedo 0.9,0.99 --thickness 1000 --g 0 --json map.json"), 0) << said;
  const auto rows = json("map.json")["rows"];
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_NEAR(rows[0]["reflectance"].get<double>(), 0.478, 1e-3);
  EXPECT_NEAR(rows[1]["reflectance"].get<double>(), 0.795, 1e-3);
  // K/S = 2 (1 - a)/(.75 a): R = 1 + K/S - sqrt((K/S)^2 + 2 K/S).
  for (const auto& row : rows) {
    const double a = row["albedo"], q = 2 * (1 - a) / (0.75 * a), two = 1 + q - std::sqrt(q * q + 2 * q);
    EXPECT_NEAR(row["error"].get<double>(), two - row["reflectance"].get<double>(), 1e-9);
  }
  fails("error --albedo 0.5,x", "--albedo: ");
  fails("error --g 1", "--g: 1 must be in [-0.99, 0.99]");
  fails("error --thickness 0", "--thickness: 0 must be in");
}

TEST_F(PigmentCli, WrongInputHasItsPlace) {
  fails("fit missing.csv", "missing.csv: no such file");
  write("high.csv", "paints,400,700\nwhite,0.9,0.9\nred,0.2,1.2\n");
  fails("fit high.csv -o out.csv", "high.csv:3:9: sample \"red\" at 700 nm: reflectance 1.2 is above");
  write("low.csv", "paints,400,700\nwhite,0.9,0.01\n");
  fails("fit low.csv --geometry d8 --specular included",
        "low.csv:2:11: sample \"white\" at 700 nm: reflectance 0.01 is below");
  write("few.csv", "paints,400,700\nwhite,0.9,0.9\nred,0.2,0.3\n");
  fails("fit few.csv -o out.csv", "few.csv: paint \"red\": an opaque tint with \"white\" is missing");
  write("thin.csv", "paints,thickness_um,400\nwhite,0,0.9\n");
  fails("fit thin.csv", "thin.csv:2:7: thickness must be positive");
  write("high.json",
        R"({"wavelengths_nm": [400, 700], "samples": [{"paints": "white", "values": [0.9, 1.3]}]})");
  fails("fit high.json", "high.json:1:80: samples[0].values[1]: sample \"white\"");
  write("no.json", R"({"wavelengths_nm": [400, 700], "samples": [{"paints": "white"}]})");
  fails("fit no.json", "no.json:1:44: samples[0]: the key \"values\" is missing");
  fails("fit kimera --k1 0.04", "--k1 and --k2 are given together");
  EXPECT_FALSE(std::filesystem::exists(folder.path / "out.csv"));

  fails("mix kimera 'rot: 1 + white: 2'", "recipe: unknown paint \"rot\"");
  fails("mix kimera 'magneta: 1 + white: 2'", "did you mean \"magenta\"?");
  fails("mix kimera 'red: -1 + white: 2'", "must be positive");
  fails("mix kimera 'red: 30% + white: 60%'", "must sum to 100");
  fails("mix kimera 'red: 1 + white: 1' --volume", "needs the density of \"white\"");
  fails("mix kimera white --thickness 0", "--thickness: must be positive");
  fails("mix kimera white --thickness 20um", "relative");
  fails("mix kimera white --illuminant D66", "unknown illuminant \"D66\"");
  fails("match kimera notacolour", "is no colour");
  fails("match kimera '#ff0000' --illuminant A", "under D65");
  fails("match kimera kimera#nothing", "no sample is called \"nothing\"");
  fails("match kimera teal --most white=2", "--most white=2: a share is in [0, 1]");
  fails("match kimera teal --only whit", "did you mean \"white\"?");
  fails("match kimera teal --most white=0.1 --only white", "no recipe keeps the bounds");
  write("infrared.csv", "sample,paints,900,1000\nx,,0.5,0.5\n");
  fails("match kimera infrared.csv#x", "do not overlap");
  fails("hide kimera white --white 0", "--white: must reflect more than --black");
  fails("", "");
}

TEST_F(PigmentCli, DoubtOfTwoFluxesIsSaidWhereTheyAreUsed) {
  write(
      "ink.csv",
      "sample,paints,backing,thickness_um,400,550,700\na,ink,0,1,0.02,0.02,0.02\nb,ink,0.8,1,0.3,0.1,0.6\n");
  const std::string doubt = "two fluxes may be off by a Delta E of";
  ASSERT_EQ(run("fit ink.csv -o ink_paint.csv"), 0) << said;
  EXPECT_NE(said.find(doubt + " up to"), std::string::npos) << said;
  EXPECT_NE(said.find("for the measured films of ink"), std::string::npos) << said;
  ASSERT_EQ(run("match ink_paint.csv 'lab(60,20,10)' --thickness 1um --substrate 0.8 -n 1"), 0) << said;
  EXPECT_NE(said.find("for the first recipe"), std::string::npos) << said;
  ASSERT_EQ(run("match ink_paint.csv 'lab(60,20,10)' -n 1"), 0) << said;
  EXPECT_EQ(said.find(doubt), std::string::npos) << said;
  ASSERT_EQ(run("hide kimera 'red: 1 + white: 1' --thickness 0.2"), 0) << said;
  EXPECT_NE(said.find("for this layer over 0"), std::string::npos) << said;
  // Films of a white that hide.
  write("white.csv",
        "sample,paints,backing,thickness_um,400,550,700\na,white,0,500,0.95,0.95,0.95\n"
        "b,white,0.9,500,0.9501,0.9501,0.9501\n");
  ASSERT_EQ(run("fit white.csv"), 0) << said;
  EXPECT_EQ(said.find(doubt), std::string::npos) << said;
}

TEST_F(PigmentCli, NotesAreFewAndRight) {
  write("t.csv", "lot,who,paints,400,700\n1,x,white,0.8,0.9\n");
  ASSERT_EQ(run("fit t.csv"), 0) << said;
  EXPECT_NE(said.find("note: t.csv: the columns \"lot\", \"who\" are not used"), std::string::npos) << said;
  write("book.csv", "PK\x03\x04 a workbook");
  fails("fit book.csv",
        "book.csv: is a spreadsheet (.xlsx, .ods, .xls), which aureole.pigment in Python reads");
  ASSERT_EQ(run("mix kimera '10% red + 90 % white' --json m.json"), 0) << said;
  EXPECT_NEAR(json("m.json")["recipe"]["red"], 0.1, 1e-12);
  fails("mix kimera '10% red + 80% white'", "must sum to 100");
  // Films that hide: their contrast ratio exceeds 1 by noise in one of two, and the third is swapped, and a fourth.
  std::string head = "sample,specimen,paints,backing", black = "\nblack,,,", white = "\nwhite,,,";
  const auto row = [](const std::string& start, const char* value) {
    std::string text = start;
    for (int l = 400; l <= 700; l += 20) text += std::string(",") + value;
    return text;
  };
  for (int l = 400; l <= 700; l += 20) head += "," + std::to_string(l);
  const std::string cards = head + row(black, "0.05") + row(white, "0.8");
  const std::string hiding = row("\na,1,ochre,black", "0.402") + row("\nb,1,ochre,white", "0.4");
  write("hiding.csv", cards + hiding + "\n");
  ASSERT_EQ(run("colour hiding.csv"), 0) << said;
  EXPECT_EQ(said.find("contrast ratio of"), std::string::npos) << said;
  write("swapped.csv", cards + hiding + row("\nc,2,red,black", "0.5") + row("\nd,2,red,white", "0.4") +
                           row("\ne,3,blue,black", "0.3") + row("\nf,3,blue,white", "0.28") + "\n");
  ASSERT_EQ(run("colour swapped.csv"), 0) << said;
  const auto at = said.find("\"c\" and 1 more layers: a contrast ratio of up to 1.2500 is above 1");
  EXPECT_NE(at, std::string::npos) << said;
  EXPECT_EQ(said.find("contrast ratio of", at + 40), std::string::npos) << said;
  // Colours as measured are those of the sphere, gloss included: a grey of 0.5 has a Y of 50.
  std::string nm, values;
  for (int l = 400; l <= 700; l += 20) nm += " nm" + std::to_string(l), values += " 0.5";
  write("sci.cgats", "MEASUREMENT_GEOMETRY \"d/8 SCI\"\nBEGIN_DATA_FORMAT\nSAMPLE_NAME" + nm +
                         "\nEND_DATA_FORMAT\nBEGIN_DATA\ngrey" + values + "\nEND_DATA\n");
  ASSERT_EQ(run("colour sci.cgats --json c.json"), 0) << said;
  EXPECT_NEAR(json("c.json")["samples"][0]["xyz"][1], 50, 1e-6);
  EXPECT_EQ(said.find("is taken off"), std::string::npos) << said;
  EXPECT_NE(said.find("colours as measured; interface for K/S: smooth, d8"), std::string::npos) << said;
}

}  // namespace
}  // namespace aureole::test

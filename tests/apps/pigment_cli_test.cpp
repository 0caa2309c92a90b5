// SPDX-License-Identifier: Apache-2.0
// aureole pigment as a user meets it: tables in, palettes and recipes out, and wrong input with its place,
// exit code 2 and nothing written.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "harness/paths.h"
#include "loading/load_text.h"

namespace aureole::test {
namespace {

namespace fs = std::filesystem;

class PigmentCli : public ::testing::Test {
protected:
  /// Runs `aureole pigment ARGUMENTS` by the shell in the test's folder; its output is in `said`.
  int run(const std::string& arguments) {
    const fs::path log = folder.path / "log.txt";
    const int status = std::system(("cd '" + folder.path.string() + "' && '" + aureole_binary().string() +
                                    "' pigment " + arguments + " > '" + log.string() + "' 2>&1")
                                       .c_str());
    std::ifstream in(log);
    said.assign(std::istreambuf_iterator<char>(in), {});
    return WEXITSTATUS(status);
  }
  void write(const std::string& name, const std::string& text) { std::ofstream(folder.path / name) << text; }
  /// The recipes in a report of `match`, by value, so that they outlive the report.
  nlohmann::json solutions(const std::string& name) { return json(name).at("solutions"); }
  nlohmann::json json(const std::string& name) {
    std::ifstream in(folder.path / name);
    return nlohmann::json::parse(in);
  }
  void fails(const std::string& arguments, const std::string& message) {
    EXPECT_EQ(run(arguments), 2) << arguments;
    EXPECT_NE(said.find(message), std::string::npos) << arguments << "\n" << said;
  }

  TemporaryFolder folder;
  std::string said;
};

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

constexpr const char* kCgats = R"(CGATS.17
ORIGINATOR "a laboratory"   # comments go on to the end of the line
KEYWORD "PAINTS"
KEYWORD "THICKNESS_UM"
SPECTRAL_NORM "100"
NUMBER_OF_FIELDS 8
BEGIN_DATA_FORMAT
SAMPLE_ID PAINTS BACKING THICKNESS_UM LAB_L
SPECTRAL_NM400 SPECTRAL_NM550 SPECTRAL_NM700
END_DATA_FORMAT
NUMBER_OF_SETS 3
BEGIN_DATA
card	""	""	""	90	80	82	84
"chalk over black"	chalk	0	20	50	40	45	50
"chalk over card"	chalk	card	20	91	81	82.5	85
END_DATA
)";

constexpr const char* kCxf = R"(<?xml version="1.0" encoding="UTF-8"?>
<cc:CxF xmlns:cc="http://colorexchangeformat.com/CxF3-core">
 <cc:Resources>
  <cc:ObjectCollection>
   <cc:Object ObjectType="Substrate" Name="card" Id="1">
    <cc:ColorValues><cc:ReflectanceSpectrum ColorSpecification="CS">0.80 0.82 0.84</cc:ReflectanceSpectrum></cc:ColorValues>
    <cc:TagCollection Name="drawdown"><cc:Tag Name="Paints" Value=""/></cc:TagCollection>
   </cc:Object>
   <cc:Object ObjectType="Standard" Name="chalk" Id="2">
    <cc:ColorValues>
     <cc:ReflectanceSpectrum ColorSpecification="CS" StartWL="400">0.40 0.45
      0.50</cc:ReflectanceSpectrum>
     <cc:ColorCIELab ColorSpecification="CS"><cc:L>74</cc:L><cc:A>0</cc:A><cc:B>0</cc:B></cc:ColorCIELab>
    </cc:ColorValues>
    <cc:TagCollection Name="drawdown"><cc:Tag Name="Backing" Value="0"/><cc:Tag Name="Thickness_um" Value="20"/></cc:TagCollection>
   </cc:Object>
   <cc:Object ObjectType="Standard" Name="chalk" Id="3">
    <cc:ColorValues><cc:ReflectanceSpectrum ColorSpecification="CS">0.81 0.825 0.85</cc:ReflectanceSpectrum></cc:ColorValues>
    <cc:TagCollection Name="drawdown"><cc:Tag Name="Backing" Value="card"/><cc:Tag Name="Thickness_um" Value="20"/></cc:TagCollection>
   </cc:Object>
  </cc:ObjectCollection>
  <cc:ColorSpecificationCollection>
   <cc:ColorSpecification Id="CS"><cc:MeasurementSpec><cc:WavelengthRange StartWL="400" Increment="150"/></cc:MeasurementSpec></cc:ColorSpecification>
  </cc:ColorSpecificationCollection>
 </cc:Resources>
</cc:CxF>
)";

std::string replaced(std::string text, const std::string& old, const std::string& by) {
  const auto at = text.find(old);
  EXPECT_NE(at, text.npos) << old;
  return at == text.npos ? text : text.replace(at, old.size(), by);
}

TEST_F(PigmentCli, CgatsAndCxfAreTheSameTable) {
  write("films.csv",
        "sample,paints,backing,thickness_um,unit,400,550,700\ncard,,,,percent,80,82,84\n"
        "a,chalk,0,20,percent,40,45,50\nb,chalk,card,20,percent,81,82.5,85\n");
  write("films.txt", kCgats);
  write("films.cxf", kCxf);
  write("comment.cxf", replaced(kCxf, "0.45\n", "<!-- a comment --> 0.45\n"));
  for (const char* file : {"films.csv", "films.txt", "films.cxf", "comment.cxf"}) {
    ASSERT_EQ(run("fit " + std::string(file) + " -o paints.csv --json fit.json"), 0) << said;
    const auto chalk = json("fit.json")["pigments"][0];
    EXPECT_EQ(chalk["name"], "chalk");
    EXPECT_EQ(chalk["fit"]["method"], "two drawdowns") << file;
    // Over black R = sinh/(a sinh + b cosh): found by hand for R = .45 over 0 and .825 over .82, at 20 um.
    const double a = 0.5 * (0.825 + (0.45 - 0.825 + 0.82) / (0.45 * 0.82)), b = std::sqrt(a * a - 1);
    const double s = std::atanh(b * 0.45 / (1 - a * 0.45)) / (b * 20e-6);
    EXPECT_NEAR(chalk["s"][1].get<double>() / s, 1, 1e-9) << file;
    EXPECT_NEAR(chalk["k"][1].get<double>() / (s * (a - 1)), 1, 1e-9) << file;
  }
  // Other headings of the same: the name of the sample is the paint, fractions, a field in per cent by its name.
  write(
      "other.cgats",
      "CGATS.17\nNUMBER_OF_FIELDS 02\nNUMBER_OF_SETS 2\nBEGIN_DATA_FORMAT\nSAMPLE_NAME LAB_L\nEND_DATA_FORMAT\n"
      "BEGIN_DATA\nwhite 95\nred 40\nEND_DATA\n"
      "BEGIN_DATA_FORMAT\nSAMPLE_NAME nm700 nm400\nEND_DATA_FORMAT\nBEGIN_DATA\nwhite .9 .8\nEND_DATA\n");
  ASSERT_EQ(run("fit other.cgats --json fit.json"), 0) << said;
  EXPECT_EQ(json("fit.json")["wavelengths_nm"][0], 400.0);
  EXPECT_NEAR(json("fit.json")["pigments"][0]["k"][0], 0.2 * 0.2 / 1.6, 1e-12);

  const auto wrong = [&](const std::string& file, const std::string& text, const std::string& message) {
    write(file, text);
    fails("fit " + file, message);
  };
  wrong("a.txt", replaced(kCgats, "45\t50\n", "x\t50\n"), "a.txt:14:37: expected a number, got \"x\"");
  wrong("a.txt", replaced(kCgats, "\t84\n", "\n"),
        "a.txt:13: expected 8 values, one for each field (an empty one is \"\"), got 7");
  wrong("a.txt", replaced(kCgats, "NUMBER_OF_SETS 3", "NUMBER_OF_SETS 4"),
        "a.txt:12: NUMBER_OF_SETS is 4, and there are 3 rows");
  wrong("a.txt", replaced(kCgats, "END_DATA\n", ""), "a.txt:12: BEGIN_DATA does not end");
  wrong("a.txt", replaced(kCgats, "NM550", "NM400"),
        "a.txt:9:16: the wavelength of \"SPECTRAL_NM400\" comes twice");
  wrong("a.txt", replaced(kCgats, "\t45\t", "\t145\t"),
        "a.txt:14:37: sample \"chalk over black\" at 550 nm: reflectance 1.45");
  wrong("a.txt", replaced(kCgats, "\tcard\t20", "\tcart\t20"),
        "a.txt:15: sample \"chalk over card\": there is no bare substrate \"cart\"");
  wrong("a.cgats",
        "CGATS.17\nBEGIN_DATA_FORMAT\nSAMPLE_ID LAB_L\nEND_DATA_FORMAT\nBEGIN_DATA\n1 2\nEND_DATA\n",
        "no table has spectra");
  wrong("a.txt", replaced(kCgats, "\"100\"", "\"7\""), "a.txt:5:15: SPECTRAL_NORM must be 1 or 100, got 7");
  wrong("a.cgats", "CGATS.17\nBEGIN_DATA\n", "a.cgats:2: BEGIN_DATA comes before the fields");
  wrong("a.cxf", replaced(kCxf, "0.45\n", "0,45\n"), "a.cxf:11:73: expected a number, got \"0,45\"");
  wrong("a.cxf", replaced(kCxf, "0.45\n", "1.45\n"),
        "a.cxf:11:73: sample \"chalk\" at 550 nm: reflectance 1.45");
  wrong("a.cxf", replaced(kCxf, " Increment=\"150\"", ""), "a.cxf:6:21: the spectrum has no Increment");
  wrong("a.cxf", replaced(kCxf, "0.82 0.84", "0.82"),
        "a.cxf:11:6: the spectrum of \"chalk\" has 3 values from 400 nm in steps of 150");
  wrong("a.cxf", replaced(kCxf, "Value=\"20\"", "Value=\"0\""),
        "a.cxf:15:73: the tag thickness_um must be positive, got 0");
  wrong("a.cxf", replaced(kCxf, "</cc:CxF>", ""), "a.cxf:26:1: not well-formed");
  wrong("a.cxf", "<svg/>", "a.cxf:1:1: expected the element CxF");
}

/// Refusals name the column, what was expected, and the line as it would be right; this line is read.
TEST_F(PigmentCli, RefusalsShowARightLine) {
  const std::string head = "sample,paints,quantity,backing,thickness_um,unit,400,550,700\n";
  const std::string card = "card,,R,,,percent,80,82,84\n", film = "a,chalk,R,0,20,percent,40,45,50\n";
  for (const auto& [line, column, expected] :
       {std::tuple{"b,chalk,R,card,20,percent,81,x,85", "550", "expected a number, got \"x\""},
        {"b,chalk,Q,card,20,percent,81,82.5,85", "quantity", "quantity must be R or T, got \"Q\""},
        {"b,chalk,R,card,-20,percent,81,82.5,85", "thickness_um", "thickness must be positive, got -20"},
        {"b,chalk,R,card,20,furlong,81,82.5,85", "unit", "unit must be fraction or percent, got \"furlong\""},
        {"b,chalk,R,card,20,percent,81,82.5", "", "expected 9 cells, as in the line of headings, got 8"},
        {"b,chalk,R,card,20,percent,81,82.5,85,86,,,87", "", "expected 9 cells"}}) {
    write("t.csv", head + card + film + line + "\n");
    fails("fit t.csv", "t.csv:4");
    EXPECT_NE(said.find(expected), std::string::npos) << said;
    const std::string named = *column ? "in the column \"" + std::string(column) + "\"" : std::string();
    EXPECT_NE(said.find(named), std::string::npos) << said;
    const std::string begin = "a line that would be right:\n    ";
    const auto at = said.find(begin);
    if (said.find("numbers with decimal commas") != said.npos) continue;
    ASSERT_NE(at, said.npos) << said;
    const std::string right =
        said.substr(at + begin.size(), said.find('\n', at + begin.size()) - at - begin.size());
    write("right.csv", head + card + film + right + "\n");
    EXPECT_EQ(run("fit right.csv"), 0) << right << said;
  }
  write(
      "down.csv",
      "nm,card,a,b\npaints,,chalk,chalk\nbacking,,0,card\nthickness_um,,20,20\n400,80,40,81\n550,82,x,82.5\n700,84,50,85\n");
  fails("fit down.csv", "down.csv:6:8: expected a number, got \"x\" in the row \"550\"; right would be");
}

/// An object without a recipe of its own to which others refer as their backing is a bare card, in CxF and in CGATS; the
/// first cell of a table that has wavelengths down may be any name of its row.
TEST_F(PigmentCli, CardsAndHeadingsByOtherNames) {
  write("films.csv",
        "sample,paints,backing,thickness_um,unit,400,550,700\ncard,,,,percent,80,82,84\n"
        "a,chalk,0,20,percent,40,45,50\nb,chalk,card,20,percent,81,82.5,85\n");
  write(
      "films.cxf",
      replaced(kCxf,
               "<cc:TagCollection Name=\"drawdown\"><cc:Tag Name=\"Paints\" Value=\"\"/></cc:TagCollection>",
               ""));
  std::string names = replaced(kCgats, "SAMPLE_ID PAINTS", "SAMPLE_NAME ");
  names = replaced(names, "card\t\"\"\t\"\"", "card\t\"\"");
  names = replaced(names, "\"chalk over black\"\tchalk", "chalk");
  names = replaced(names, "\"chalk over card\"\tchalk", "chalk");
  write("films.cgats", replaced(names, "NUMBER_OF_FIELDS 8", "NUMBER_OF_FIELDS 7"));
  for (const char* first : {"name", "Sample ID", "wavelength"})
    write(
        "down " + std::string(first).substr(0, 4) + ".csv",
        "Customer,somebody\n" + std::string(first) +
            ",card,a,b\nrecipe,,chalk,chalk\nbackground,,0,card\nthickness (um),,20,20\nunit,percent,percent,percent\n"
            "400nm,80,40,81\n550nm,82,45,82.5\n700nm,84,50,85\n");
  ASSERT_EQ(run("fit films.csv --json expected.json"), 0) << said;
  const auto expected = json("expected.json")["pigments"];
  for (const char* file : {"films.cxf", "films.cgats", "down name.csv", "down Samp.csv", "down wave.csv"}) {
    ASSERT_EQ(run("fit '" + std::string(file) + "' --json fit.json"), 0) << file << said;
    const auto pigments = json("fit.json")["pigments"];
    ASSERT_EQ(pigments.size(), 1u) << file;
    for (const std::size_t i : {0, 1, 2})
      EXPECT_NEAR(pigments[0]["s"][i].get<double>() / expected[0]["s"][i].get<double>(), 1, 1e-9) << file;
  }
}

/// The aperture that a file states tells how much light translucent paints lose at its edge.
TEST_F(PigmentCli, ApertureOfAFileIsUsed) {
  const auto with = [](const std::string& aperture) {
    return replaced(
        kCgats, "SPECTRAL_NORM",
        "KEYWORD \"MEASUREMENT_APERTURE\"\nMEASUREMENT_APERTURE \"" + aperture + "\"\nSPECTRAL_NORM");
  };
  double last = 0;
  for (const char* aperture : {"25 mm", "8", "0.2 cm"}) {
    write("films.cgats", with(aperture));
    ASSERT_EQ(run("fit films.cgats --json fit.json"), 0) << said;
    const auto found = json("fit.json")["aperture"];
    EXPECT_NE(said.find("light lost at its edge makes a Delta E of"), std::string::npos) << said;
    EXPECT_GT(found["edge_loss_delta_e"].get<double>(), last) << aperture;
    last = found["edge_loss_delta_e"];
    ASSERT_EQ(run("fit films.cgats --joint --theory two-flux --json joint.json"), 0) << said;
    EXPECT_EQ(json("joint.json")["aperture"]["diameter_mm"], found["diameter_mm"]);
  }
  EXPECT_LT(last, 1);
  write("films.cgats", with("LAV"));
  ASSERT_EQ(run("fit films.cgats"), 0) << said;
  EXPECT_NE(said.find("the aperture \"LAV\" has no known size"), std::string::npos) << said;
  write(
      "opaque.cgats",
      "APERTURE 4mm\nBEGIN_DATA_FORMAT\nSAMPLE_NAME nm400 nm700\nEND_DATA_FORMAT\nBEGIN_DATA\nwhite .9 .8\nEND_DATA\n");
  ASSERT_EQ(run("fit opaque.cgats"), 0) << said;
  EXPECT_NE(said.find("aperture 4mm: K and S have no unit of length"), std::string::npos) << said;
  write("other.cgats", with("12 mm"));
  write("films.cgats", with("4 mm"));
  ASSERT_EQ(run("fit films.cgats other.cgats --joint --theory two-flux"), 0) << said;
  EXPECT_NE(said.find("the aperture is 12 mm, that of films.cgats 4 mm"), std::string::npos) << said;
}

/// The geometry of a CxF file is taken off; version 2 of the format has the range of wavelengths elsewhere.
TEST_F(PigmentCli, GeometryOfAFileIsUsed) {
  const std::string spec = R"(<cc:MeasurementSpec>)";
  const auto with = [&](const std::string& geometry) {
    return replaced(kCxf, spec, spec + "<cc:GeometryChoice>" + geometry + "</cc:GeometryChoice>");
  };
  write("sphere.cxf", with("<cc:SphereGeometry>Specular_Included</cc:SphereGeometry>"));
  write("plain.cxf", kCxf);
  const auto s_of = [&](const std::string& arguments) {
    EXPECT_EQ(run("fit " + arguments + " --json fit.json"), 0) << said;
    return json("fit.json")["pigments"][0]["s"][1].get<double>();
  };
  const double sphere = s_of("sphere.cxf");
  EXPECT_NE(
      said.find("sphere.cxf: was measured at the geometry d8, specular included: the interface of index 1.5"),
      std::string::npos)
      << said;
  EXPECT_DOUBLE_EQ(sphere, s_of("plain.cxf --geometry d8 --specular included"));
  EXPECT_DOUBLE_EQ(s_of("sphere.cxf --geometry none"), s_of("plain.cxf"));
  s_of("sphere.cxf --geometry 45_0");
  EXPECT_NE(said.find("states the geometry d8, specular included; the options, which differ, are taken"),
            std::string::npos)
      << said;
  // Options of a part leave the rest to the file, and say so.
  EXPECT_DOUBLE_EQ(s_of("sphere.cxf --geometry d8"), sphere);
  EXPECT_NE(said.find("states that specular light is included"), std::string::npos) << said;
  EXPECT_DOUBLE_EQ(s_of("sphere.cxf --specular excluded"),
                   s_of("plain.cxf --geometry d8 --specular excluded"));
  s_of("sphere.cxf --specular excluded");
  EXPECT_NE(said.find("--specular excluded, which differs, is taken"), std::string::npos) << said;
  write("single.cxf",
        with("<cc:SingleAngle><cc:SingleAngleConfiguration>Annular</cc:SingleAngleConfiguration>"
             "<cc:IlluminationAngle>45</cc:IlluminationAngle>"
             "<cc:MeasurementAngle>0.0</cc:MeasurementAngle></cc:SingleAngle>"));
  EXPECT_DOUBLE_EQ(s_of("single.cxf"), s_of("plain.cxf --geometry 45_0"));
  // Version 2 has no MeasurementSpec. Values may be per cent.
  std::string two = replaced(replaced(kCxf, "CxF3-core", "v2"), spec, "");
  two = replaced(two, "</cc:MeasurementSpec>", "");
  write("two.cxf", two);
  EXPECT_DOUBLE_EQ(s_of("two.cxf"), s_of("plain.cxf"));
  two = replaced(replaced(two, "0.80 0.82 0.84", "80 82 84"), "0.81 0.825 0.85", "81 82.5 85");
  write("percent.cxf", replaced(two, "0.40 0.45\n      0.50", "40 45\n      50"));
  EXPECT_NEAR(s_of("percent.cxf") / s_of("two.cxf"), 1, 1e-12);
  write("cgats.cgats",
        "MEASUREMENT_GEOMETRY \"45/0\"\nBEGIN_DATA_FORMAT\nSAMPLE_NAME nm400 nm700\nEND_DATA_FORMAT\n"
        "BEGIN_DATA\nwhite .9 .8\nEND_DATA\n");
  EXPECT_EQ(run("fit cgats.cgats"), 0);
  EXPECT_NE(said.find("was measured at the geometry 45_0, specular excluded"), std::string::npos) << said;

  ASSERT_EQ(run("colour plain.cxf --standard 'sphere.cxf#chalk over card'"), 0) << said;
  EXPECT_NE(said.find("state different geometries"), std::string::npos) << said;
  write("a.cxf", with("<cc:MultiAngle/>"));
  fails("fit a.cxf", "measurements at several angles");
  write("a.cxf", with("<cc:SingleAngle><cc:IlluminationAngle>15</cc:IlluminationAngle></cc:SingleAngle>"));
  fails("fit a.cxf", "SingleAngle needs MeasurementAngle");
}

/// A green of a narrow band, every 20 nm: linear interpolation would raise a* by 0.8.
TEST_F(PigmentCli, TargetAndStandardAreInterpolatedAsColoursAre) {
  const auto green = [&](const std::string& name, double step) {
    std::ostringstream head, row;
    for (double l = 400; l <= 700; l += step) {
      head << ',' << l;
      row << ',' << 0.04 + 0.5 * std::exp(-std::pow((l - 525) / 30, 2));
    }
    write(name, "sample" + head.str() + "\ngreen" + row.str() + "\n");
  };
  green("ten.csv", 10), green("twenty.csv", 20);
  ASSERT_EQ(run("colour twenty.csv --json c.json"), 0) << said;
  const auto alone = json("c.json")["samples"][0]["lab"];
  ASSERT_EQ(run("match kimera twenty.csv#green --json m.json"), 0) << said;
  EXPECT_NE(
      said.find("148 of the palette's 170 wavelengths are used, and values between the 16 measured ones are "
                "interpolated"),
      std::string::npos)
      << said;
  ASSERT_EQ(run("colour ten.csv --standard twenty.csv#green --json c.json"), 0) << said;
  EXPECT_NE(said.find("twenty.csv#green: has other wavelengths than ten.csv; 31 of the latter are used"),
            std::string::npos)
      << said;
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(json("m.json")["target"][i], alone[i], 0.02) << i;
    EXPECT_NEAR(json("c.json")["standard"]["lab"][i], alone[i], 0.06) << i;
  }
}

/// Gloss of an index of 1.5 at 8 degrees is ((1.5 - 1)/(1.5 + 1))^2 = 4.0 %.
TEST_F(PigmentCli, EachFileHasItsOwnGeometry) {
  const auto cgats = [&](const std::string& name, const std::string& geometry, const std::string& rows) {
    std::string head;
    for (int l = 400; l <= 700; l += 20) head += " nm" + std::to_string(l);
    write(name, "MEASUREMENT_GEOMETRY \"" + geometry + "\"\nBEGIN_DATA_FORMAT\nSAMPLE_NAME" + head +
                    "\nEND_DATA_FORMAT\nBEGIN_DATA\n" + rows + "END_DATA\n");
  };
  const auto grey = [](const std::string& name, double r) {
    std::string row = name;
    for (int l = 400; l <= 700; l += 20) row += " " + std::to_string(r);
    return row + "\n";
  };
  cgats("out.cgats", "d/8 SCE", grey("batch", 0.46));
  cgats("in.cgats", "d/8 SCI", grey("master", 0.5));
  ASSERT_EQ(run("colour out.cgats --standard in.cgats#master --to-specular included --json c.json"), 0)
      << said;
  EXPECT_NEAR(json("c.json")["standard"]["xyz"][1], 50, 1e-6);
  EXPECT_NEAR(json("c.json")["samples"][0]["xyz"][1], 50, 1e-3);
  EXPECT_EQ(said.find("state different geometries"), std::string::npos) << said;
  // Unconverted they differ in colour, and not in strength.
  ASSERT_EQ(run("colour out.cgats --standard in.cgats#master --json c.json"), 0) << said;
  EXPECT_NEAR(json("c.json")["standard"]["xyz"][1], 50, 1e-6);
  EXPECT_NEAR(json("c.json")["samples"][0]["xyz"][1], 46, 1e-6);
  EXPECT_NEAR(json("c.json")["samples"][0]["difference"]["strength"]["maximum"], 1, 1e-3);
  EXPECT_NEAR(json("c.json")["samples"][0]["difference"]["strength"]["tone_ciede2000"], 0, 1e-2);
  cgats("none.cgats", "", grey("master", 0.46));
  ASSERT_EQ(run("colour out.cgats --standard none.cgats#master"), 0) << said;
  EXPECT_NE(said.find("none.cgats: states no geometry; that of out.cgats is taken for it"), std::string::npos)
      << said;
  cgats("angle.cgats", "45/0", grey("batch", 0.46));
  ASSERT_EQ(run("colour angle.cgats --to-specular included"), 0) << said;
  EXPECT_NE(said.find("--to-specular: has no effect at 45_0"), std::string::npos) << said;

  // A recipe as a sphere instrument sees it, gloss included, comes back.
  ASSERT_EQ(run("mix kimera 'red: 1 + white: 3' --geometry d8 --specular included --json mix.json"), 0)
      << said;
  const auto mix = json("mix.json");
  std::string head, row = "wanted";
  for (std::size_t i = 0; i < mix["reflectance"].size(); ++i)
    head += " nm" + mix["wavelengths_nm"][i].dump(), row += " " + mix["reflectance"][i].dump();
  const std::string text =
      "\nBEGIN_DATA_FORMAT\nSAMPLE_NAME" + head + "\nEND_DATA_FORMAT\nBEGIN_DATA\n" + row + "\nEND_DATA\n";
  for (const auto& [name, component] :
       {std::pair{"d/8:i", "included"}, {"d/8:e", "excluded"}, {"8/d:i", "included"}}) {
    write("short.cgats", std::string("MEASUREMENT_GEOMETRY \"") + name + "\"" + text);
    run("fit short.cgats");
    EXPECT_NE(said.find(std::string("at the geometry d8, specular ") + component), std::string::npos)
        << name << said;
  }
  write("mixed.csv", "sample,paints,400,700\na,white,80,90\nb,red,0.05,0.6\n");
  run("fit mixed.csv");
  EXPECT_NE(said.find("1 row has no value above 1.5 per cent, the first \"b\" of line 3"), std::string::npos)
      << said;
  write("sphere.cgats", "MEASUREMENT_GEOMETRY \"d/8 SCI\"" + text);
  ASSERT_EQ(run("match kimera sphere.cgats#wanted --json m.json"), 0) << said;
  EXPECT_NE(said.find("recipes are predicted with this interface instead of the palette's"),
            std::string::npos)
      << said;
  EXPECT_LT(json("m.json")["solutions"][0]["difference"], 5e-3);
  EXPECT_NEAR(json("m.json")["solutions"][0]["recipe"]["red"], 0.25, 0.0025);
  ASSERT_EQ(run("match kimera sphere.cgats#wanted --geometry 45_0 --json m.json"), 0) << said;
  EXPECT_GT(json("m.json")["solutions"][0]["difference"].get<double>() +
                json("m.json")["solutions"][0]["rms"].get<double>(),
            0.01);
}

TEST_F(PigmentCli, NamesThatSeveralPanelsHave) {
  const std::string nm = "400,420,440,460,480,500,520,540,560,580,600,620,640,660,680,700";
  const auto grey = [](const std::string& value) {
    std::string row;
    for (int i = 0; i < 16; ++i) row += "," + value;
    return row + "\n";
  };
  write("films.csv", "sample,paints,backing,unit," + nm + "\nbc,,,percent" + grey("4") + "wc,,,percent" +
                         grey("82") + "ochre,ochre,bc,percent" + grey("40") + "ochre,ochre,wc,percent" +
                         grey("50") + "ochre,ochre,wc,percent" + grey("52"));
  fails(
      "match kimera films.csv#ochre",
      "films.csv: 2 samples are called \"ochre\"; name one of them, as in films.csv#ochre over bc: there are ochre "
      "over bc, ochre over wc");
  fails("colour films.csv --standard films.csv#ochre", "2 samples are called \"ochre\"");
  ASSERT_EQ(run("colour 'films.csv#ochre over wc' --json c.json"), 0) << said;
  EXPECT_EQ(json("c.json")["samples"].size(), 1u);
  EXPECT_NEAR(json("c.json")["samples"][0]["xyz"][1], 51, 1e-6);
  EXPECT_NE(said.find("2 measurements of \"ochre over wc\" are averaged"), std::string::npos) << said;
  ASSERT_EQ(run("match kimera 'films.csv#ochre over wc'"), 0) << said;
  EXPECT_NE(said.find("2 measurements of \"ochre over wc\" are averaged"), std::string::npos) << said;
  ASSERT_EQ(run("colour films.csv#bc --standard 'films.csv#ochre over wc'"), 0) << said;
  EXPECT_NE(said.find("2 measurements of \"ochre over wc\" are averaged"), std::string::npos) << said;
  // The darker card carries the brighter layer; of a grey neither hue nor sign is printed.
  write("swapped.csv", "sample,paints,backing,unit," + nm + "\nbc,,,percent" + grey("4") + "wc,,,percent" +
                           grey("82") + "ochre,ochre,bc,percent" + grey("50") + "ochre,ochre,wc,percent" +
                           grey("40"));
  ASSERT_EQ(run("colour swapped.csv"), 0) << said;
  EXPECT_NE(said.find("a contrast ratio of 1.2500 is above 1"), std::string::npos) << said;
  EXPECT_EQ(said.find("-0.00"), std::string::npos) << said;
  EXPECT_NE(said.find("    0.00       -  "), std::string::npos) << said;

  write("fifty.csv", "sample,unit," + nm + "\na,fraction" + grey("50"));
  fails("colour fifty.csv",
        "fifty.csv:2:12: sample \"a\" at 400 nm: a reflectance of 50 is above 1.05; if the values "
        "are per cent");
  fails("match kimera fifty.csv#a", "a reflectance of 50 is above 1.05");
  write("more.csv", "sample,unit," + nm + "\na,percent" + grey("120"));
  fails("colour more.csv", "a reflectance of 1.2 is above 1.05; is the unit right");
  write("coarse.csv", "sample,400,500,600,700\na,0.5,0.5,0.5,0.5\n");
  ASSERT_EQ(run("colour coarse.csv"), 0) << said;
  EXPECT_NE(said.find("coarse.csv: wavelengths are up to 100 nm apart; colours of 13 measured paints"),
            std::string::npos)
      << said;
  ASSERT_EQ(run("colour films.csv"), 0) << said;
  EXPECT_EQ(said.find("nm apart"), std::string::npos) << said;
  write("one.csv", "sample,550\na,0.5\n");
  fails("colour one.csv", "one.csv: has one wavelength, 550 nm");
  write("nameless.csv", "unit," + nm + "\npercent" + grey("50"));
  fails("colour nameless.csv", "there is no column \"sample\", the name of each measurement");
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

TEST_F(PigmentCli, TablesAsLaboratoriesKeepThem) {
  // A free film by R and T columns, with leading columns that are not needed.
  // R and T of K = 0: R = SX/(1 + SX) with S X = 1.
  write(
      "film.csv",
      "Lot,Tester,paint,thickness_um,R400,R550,R700,T400,T550,T700\n7,jd,chalk,10,0.5,0.5,0.5,0.4999,0.4999,0.4999\n");
  ASSERT_EQ(run("fit film.csv --json fit.json"), 0) << said;
  EXPECT_EQ(json("fit.json")["pigments"][0]["fit"]["method"], "free film");
  EXPECT_NEAR(json("fit.json")["pigments"][0]["s"][1], 1e5, 100);
  EXPECT_NE(said.find("the columns \"Lot\", \"Tester\" are not used"), std::string::npos) << said;
  write("misspelt.csv", "samplle,paints,400,500\na,white,0.8,0.8\n");
  fails("fit misspelt.csv", "misspelt.csv:1:1: unknown column \"samplle\"");

  // Missing cells: one between neighbours, one at an end.
  const std::string head = "paints,400,440,460,480,600,700\n";
  write(
      "gaps.csv",
      head +
          "white,0.7,0.8,,0.9,0.9,0.9\nred,,0.3,0.35,0.4,0.5,0.6\nred: 1 + white: 1,0.4,0.4,0.45,0.5,0.6,0.7\n");
  ASSERT_EQ(run("fit gaps.csv --json fit.json"), 0) << said;
  EXPECT_NE(said.find("1 missing value is interpolated; the first: line 2, \"white\" at 460 nm"),
            std::string::npos)
      << said;
  EXPECT_NE(said.find("1 wavelengths at the ends, which a sample lacks, are left out: 440 to 700 nm remain"),
            std::string::npos)
      << said;
  // White is opaque: K/S = (1 - R)^2/(2 R), S = 1; at 460 nm R is the mean of 0.8 and 0.9.
  EXPECT_NEAR(json("fit.json")["pigments"][0]["k"][1], 0.15 * 0.15 / 1.7, 1e-12);
  // A gap of one sample that reaches over the end of another.
  write("ends.csv",
        "paints,400,440,480,520,560,600,640,680,720\nwhite,0.8,0.8,0.8,0.8,0.8,0.8,0.8,,0.9\n"
        "red,0.1,0.1,0.1,0.1,0.1,0.3,0.5,0.6,\nred: 1 + white: 1,0.4,0.4,0.4,0.4,0.4,0.5,0.6,0.7,0.7\n");
  fails("fit ends.csv", "ends.csv:2:35: sample \"white\" has no value at 680 nm");
  write("wide.csv", "paints,400,450,500\nwhite,0.8,,0.9\n");
  fails("fit wide.csv", "wide.csv:2:11: sample \"white\" has no value at 450 nm");

  // A file for each drawdown, each with cards of its own; the fit of both is that of one table.
  const auto file = [&](const std::string& name, const std::string& paint, double dark, double bright,
                        double black, double white) {
    std::ostringstream text;
    text << "sample,paints,backing,thickness_um,400,550,700\n";
    const auto line = [&](const std::string& start, double r) {
      text << start << ',' << r << ',' << r << ',' << r << '\n';
    };
    line("black,,,", black), line("white,,,", white);
    line("x," + paint + ",black,20", dark), line("y," + paint + ",white,20", bright);
    write(name, text.str());
  };
  file("a.csv", "ochre", 0.2, 0.4, 0.05, 0.8), file("b.csv", "umber", 0.1, 0.2, 0.04, 0.78);
  ASSERT_EQ(run("fit a.csv b.csv --json fit.json"), 0) << said;
  const auto both = json("fit.json")["pigments"];
  ASSERT_EQ(both.size(), 2u);
  for (const auto& [name, index] : {std::pair{"a.csv", 0}, {"b.csv", 1}}) {
    ASSERT_EQ(run("fit " + std::string(name) + " --json fit.json"), 0) << said;
    EXPECT_DOUBLE_EQ(both[std::size_t(index)]["s"][0], json("fit.json")["pigments"][0]["s"][0]) << name;
  }
  ASSERT_EQ(run("fit a.csv b.csv --joint"), 0) << said;
  EXPECT_NE(said.find("2 paints, 2 specimens"), std::string::npos) << said;
  file("b.csv", "umber", 0.1, 1.2, 0.04, 0.78);
  fails("fit a.csv b.csv", "b.csv:5:18: sample \"y\" at 400 nm: reflectance 1.2");
}

TEST_F(PigmentCli, WhatDataCannotTell) {
  const std::string head = "sample,paints,backing,thickness_um,400,550,700\n";
  write(
      "alike.csv",
      head +
          "p,,,,0.80,0.80,0.80\nq,,,,0.82,0.82,0.82\na,ochre,p,20,0.4,0.4,0.4\nb,ochre,q,20,0.41,0.41,0.41\n");
  fails("fit alike.csv",
        "its substrates \"p\" and \"q\" reflect nearly the same (0.8 and 0.82 at 550 nm): two that differ");
  ASSERT_EQ(run("fit alike.csv --joint"), 0) << said;
  EXPECT_NE(said.find("the cards below"), std::string::npos) << said;
  EXPECT_NE(said.find("neither K nor S nor K/S is known"), std::string::npos) << said;
  write("one.csv", "sample,paints,backing,400,550,700\np,,,0.80,0.80,0.80\na,ochre,p,0.4,0.4,0.4\n");
  ASSERT_EQ(run("fit one.csv --joint --json one.json"), 0) << said;
  for (const char* part : {"\"ochre\" was measured as one film over one card",
                           "neither K nor S nor K/S is known", "unknown: one film over one card"})
    EXPECT_NE(said.find(part), std::string::npos) << part << said;
  EXPECT_TRUE(json("one.json")["pigments"][0]["fit"]["unknown"].get<bool>());
  write("opaque.csv", "sample,paints,backing,400,550,700\na,ochre,opaque,0.4,0.4,0.4\n");
  ASSERT_EQ(run("fit opaque.csv --joint"), 0) << said;
  EXPECT_NE(said.find("\"ochre\" was measured alone and opaque: only K/S is known; missing is a tint"),
            std::string::npos)
      << said;
  write("both.csv",
        "sample,paints,backing,400,550,700\na,ochre,opaque,0.4,0.4,0.4\nb,ochre,0.04,0.3,0.3,0.3\n");
  ASSERT_EQ(run("fit both.csv --joint"), 0) << said;
  EXPECT_EQ(said.find("is known"), said.find("is known at (nm)") - 0) << said;
  // A thin layer by two fluxes: off by several units, and said so; a thick one of a white is not.
  ASSERT_EQ(run("mix kimera 'red: 1 + white: 1' --thickness 0.2"), 0);
  EXPECT_NE(said.find("two fluxes may be off by a Delta E of"), std::string::npos) << said;
  ASSERT_EQ(run("mix kimera white --thickness 1000 --geometry none"), 0);
  EXPECT_EQ(said.find("two fluxes may be off"), std::string::npos) << said;
  // 12 thousand tints of one paint.
  std::ofstream large(folder.path / "large.csv");
  large << "paints,400,700\nwhite,0.9,0.9\n";
  for (int i = 1; i < 12000; ++i) large << "red: " << i << " + white: 20000,0.5,0.5\n";
  large.close();
  fails("fit large.csv --joint", "hours; fit a part of them");
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
  fails("fit high.json", "high.json: samples[0].values[1]: sample \"white\"");
  write("no.json", R"({"wavelengths_nm": [400, 700], "samples": [{"paints": "white"}]})");
  fails("fit no.json", "samples[0]: the key \"values\" is missing");
  fails("fit kimera --k1 0.04", "--k1 and --k2 are given together");
  EXPECT_FALSE(fs::exists(folder.path / "out.csv"));

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

/// The 72 drawdowns of 20 oil paints of shared/data/revigo: all are fitted or named, and mixtures that are kept back
/// are predicted better than by the plain two-constant fit. AUREOLE_THOROUGH=1 keeps back each of the 53 mixtures in
/// turn (some 3 minutes of CPU time).
TEST_F(PigmentCli, RealDrawdowns) {
  const fs::path data = source_dir() / "../shared/data/revigo";
  if (!fs::exists(data / "spectra.txt")) GTEST_SKIP() << "there is no " << data.string();
  ASSERT_EQ(std::system(("python3 '" + (source_dir() / "tools/revigo_table.py").string() + "' '" +
                         data.string() + "' > '" + (folder.path / "revigo.csv").string() + "'")
                            .c_str()),
            0);
  const bool thorough = std::getenv("AUREOLE_THOROUGH");
  ASSERT_EQ(
      run("fit revigo.csv --joint --k1 0.0418 --k2 0.5963 --index 1.48 --white ZincWhite --black BoneBlack --json fit.json "
          "-o paints.csv --plot ks.svg --plot-k k.svg --plot-s s.svg --hold-out " +
          std::string(thorough ? "each" : "06C,13B,14B")),
      0)
      << said;
  const auto fit = json("fit.json");
  ASSERT_EQ(fit["specimens"].size(), 72u);
  int well = 0;
  for (const auto& s : fit["specimens"]) {
    EXPECT_EQ(s["outlier"].get<bool>(), s["rms"].get<double>() > 0.005);
    EXPECT_LT(s["rms"], 0.02) << s["specimen"];
    well += !s["outlier"].get<bool>();
  }
  EXPECT_GE(well, 44);
  EXPECT_EQ(fit["unit"], "film");
  // Films of vermilion hide: only K/S is known.
  for (const auto& p : fit["pigments"])
    if (p["name"] == "Vermillion") {
      int hidden = 0;
      for (const auto& h : p["fit"]["only_k_over_s_known"]) hidden += h.get<bool>();
      EXPECT_GT(hidden, 20);
    }
  EXPECT_TRUE(fs::exists(folder.path / "ks.svg") && fs::exists(folder.path / "s.svg"));
  EXPECT_LT(fit["theories"]["streams"]["cost"], fit["theories"]["two fluxes"]["cost"]);
  const auto all = fit["held_out"]["all"];
  const auto streams = all["streams"];
  if (thorough) {
    std::printf("%s", said.c_str());
    EXPECT_EQ(streams["count"], 53);
    EXPECT_LE(streams["median_ratio"], 0.8);
    EXPECT_GE(streams["better"], 38);  // 28 of 40
    EXPECT_GE(fit["held_out"]["coverage"]["streams"], 0.8);
    EXPECT_NEAR(all["plain"]["median"], 3.46, 0.1);
  } else {
    EXPECT_EQ(streams["count"], 3);
    EXPECT_LT(streams["mean"], 0.9 * all["plain"]["mean"].get<double>()) << said;
  }
  ASSERT_EQ(run("mix paints.csv 'Vermillion: 1 + ZincWhite: 1' --thickness 1"), 0) << said;
}

TEST_F(PigmentCli, TemplateAndJointFitsRefuseWithAReason) {
  ASSERT_EQ(run("fit new.csv --template"), 0) << said;
  std::ifstream in(folder.path / "new.csv");
  EXPECT_NE(std::string(std::istreambuf_iterator<char>(in), {}).find("sample,specimen,series,paints"),
            std::string::npos);
  fails("fit new.csv --template", "new.csv exists");
  fails("fit new.csv", "there are no samples");
  write("two.csv", "sample,specimen,paints,backing,400,700\na,1,white,0.1,0.8,0.8\nb,1,red,0.8,0.9,0.9\n");
  fails("fit two.csv --joint",
        "two.csv:3: sample \"b\": its recipe differs from that of other samples of specimen \"1\"");
  write("one.csv", "sample,paints,backing,400,700\na,white,0.1,0.8,0.8\nb,white,0.8,0.9,0.9\n");
  fails("fit one.csv --joint --hold-out c", "no specimen is called \"c\"; there are a");
  fails("fit one.csv --hold-out a", "--hold-out: needs --joint");
  write("film.csv",
        "sample,paints,backing,quantity,400,700\na,white,none,R,0.4,0.4\nb,white,none,T,0.5,0.5\n");
  fails("fit film.csv --joint --theory streams", "free films are not part of the theory by streams");
  EXPECT_EQ(run("fit film.csv --joint"), 0) << said;
}

TEST_F(PigmentCli, NumberedHeadingsAreRepeats) {
  write("plain.csv", "paints,400,700\nwhite,0.8,0.9\nwhite,0.82,0.92\n");
  ASSERT_EQ(run("fit plain.csv --json plain.json"), 0) << said;
  for (const auto& [first, second] :
       {std::pair{"_1", "_2"}, {"-1", "-2"}, {" #1", " #2"}, {"nm_1", "nm_2"}, {"", ".1"}, {".1", ".2"}}) {
    const std::string a = std::string("400") + first, b = std::string("400") + second,
                      c = std::string("700") + first, d = std::string("700") + second;
    write("a.csv", "paints," + a + "," + b + "," + c + "," + d + "\nwhite,0.8,0.82,0.9,0.92\n");
    ASSERT_EQ(run("fit a.csv --json a.json"), 0) << said;
    EXPECT_NE(said.find("each wavelength has 2 columns: they are repeats"), std::string::npos) << a << said;
    EXPECT_EQ(json("a.json")["pigments"][0]["k"], json("plain.json")["pigments"][0]["k"]) << a;
  }
  // Tenths of nanometres stay wavelengths.
  write("fine.csv", "paints,400,400.1,400.2,401,401.1,401.2,700\nwhite,0.8,0.8,0.8,0.8,0.8,0.8,0.8\n");
  ASSERT_EQ(run("fit fine.csv"), 0) << said;
  EXPECT_NE(said.find("7 wavelengths from 400 to 700 nm"), std::string::npos) << said;
  write("long.csv", "paints," + std::string(1000000, 'x') + ",400,700\nwhite,1,0.8,0.9\n");
  ASSERT_EQ(run("fit long.csv"), 0) << said.substr(said.size() - 200);
  write("far.cgats",
        "BEGIN_DATA_FORMAT\nSAMPLE_NAME nm400 nm7000\nEND_DATA_FORMAT\nBEGIN_DATA\nwhite .8 .9\nEND_DATA\n");
  fails("fit far.cgats", "far.cgats: wavelengths must be from 200 to 2600 nm");
  write("far.csv", "paints,4001,4002\nwhite,0.8,0.9\n");
  fails("fit far.csv", "the heading \"4001\" is a wavelength of 4001 nm");
  write("film.csv", "paints,backing,thickness_um,400,700\nwhite,,20,0.8,0.9\n");
  fails("fit film.csv", "film.csv:2:7: \"white\" has a thickness and no backing; right would be opaque");
}

TEST_F(PigmentCli, WhatAJointFitNotes) {
  const std::string head = "sample,paints,backing,400,700,,\n";
  write(
      "t.csv",
      head +
          "a,white,0.1,0.8,0.8,,\nb,white,0.8,0.9,0.9,,\nc,white: 9 + Whit: 1,0.8,0.7,0.01,,\nred,red,0.8,0.1,0.7,,\n"
          "d,white: 9 + red: 1,0.8,0.5,0.8,,\ne,white: 1 + red: 1,0.8,0.2,0.75,,\n");
  ASSERT_EQ(run("fit t.csv --joint --k1 0.04 --k2 0.6 --specular included --hold-out 'd, e' -o p.csv"), 0)
      << said;
  for (const char* part :
       {"interface: Saunderson, k1 0.04, k2 0.6, specular included",
        "t.csv:4: the paint \"Whit\" is in one mixture only and never alone; did you mean \"white\"?",
        "1 value that no paint has under this interface count", "line 4, sample \"c\" at 700 nm"})
    EXPECT_NE(said.find(part), std::string::npos) << part << "\n" << said;
  EXPECT_EQ(said.find(" g "), std::string::npos) << said;
  ASSERT_EQ(run("fit t.csv --joint --theory streams --g 0.7 --g-error 0.2 --json g.json"), 0) << said;
  EXPECT_NEAR(json("g.json")["pigments"][0]["fit"]["g"].get<double>(), 0.7, 0.1);
  EXPECT_LE(json("g.json")["pigments"][0]["fit"]["g_error"].get<double>(), 0.3 * 0.2 * 1.3);
  ASSERT_EQ(run("fit t.csv --joint --theory two-flux --g-error 0.2"), 0) << said;
  EXPECT_NE(said.find("--g-error: has no effect on two fluxes"), std::string::npos) << said;
  ASSERT_EQ(run("fit t.csv --joint --specular included --white blanc"), 0) << said;
  for (const char* part :
       {"interface: none", "two fluxes:", "(in the palette; --hold-out tells which predicts better)",
        "--specular: has no effect", "--white: no paint of t.csv is called \"blanc\""})
    EXPECT_NE(said.find(part), std::string::npos) << part << "\n" << said;
  ASSERT_EQ(run("mix p.csv white --substrate 0.5"), 0) << said;
  EXPECT_NE(said.find("--substrate: has no effect without --thickness"), std::string::npos) << said;
  write("high.csv", head + "a,white,0.1,0.8,0.8,,\nb,white,0.8,0.9,1.2,,\n");
  fails("fit high.csv --joint", "high.csv:3:17: sample \"b\" at 700 nm: 1.2 is above 1.05");
  write("gap.csv", head + "a,white,0.1,,0.8,,\n");
  fails("fit gap.csv --joint", "sample \"a\" has no value at 400 nm; the measurement or this wavelength");
  write("latin.csv", "sample,paints,400,700\na,wei\xDF,0.8,0.8\nb,wei\xDF,0.9,0.9\n");
  ASSERT_EQ(run("fit latin.csv --white wei\xC3\x9F --noise 0.02"), 0) << said;
  EXPECT_NE(said.find("is taken for Windows-1252"), std::string::npos) << said;
  EXPECT_NE(said.find("--noise: has no effect without --joint"), std::string::npos) << said;
}

constexpr const char* kTints =
    "sample,paints,backing,400,550,700\na,white,0.1,0.8,0.8,0.8\nb,white,0.8,0.9,0.9,0.9\nc,red,0.1,0.1,0.1,0.7\n"
    "d,red,0.8,0.1,0.12,0.8\ne,white: 9 + red: 1,0.8,0.5,0.6,0.8\nf,white: 1 + red: 1,0.8,0.2,0.3,0.75\n";

TEST_F(PigmentCli, AStreamsPaletteSaysSo) {
  write("t.csv", kTints);
  ASSERT_EQ(run("fit t.csv --joint --theory streams -o streams.csv --json s.json"), 0) << said;
  ASSERT_EQ(run("fit t.csv --joint -o two.csv --json t.json"), 0) << said;
  EXPECT_EQ(json("s.json")["theory"], "streams");
  EXPECT_EQ(json("t.json")["theory"], "two fluxes");
  const std::string note =
      "note: streams.csv: K and S were fitted by streams; two fluxes, which are used here";
  // Under Saunderson's numbers or a rough interface K and S are used by two fluxes, with a note.
  for (const char* command : {"mix streams.csv white", "match streams.csv 'lab(60,20,10)'",
                              "hide streams.csv white --thickness 1"}) {
    for (const char* interface : {" --k1 0.04 --k2 0.6", " --geometry diffuse --alpha 0.2"}) {
      ASSERT_EQ(run(command + std::string(interface)), 0) << said;
      EXPECT_NE(said.find(note), std::string::npos) << command << "\n" << said;
    }
    ASSERT_EQ(run(command), 0) << said;
    EXPECT_EQ(said.find("fitted by streams"), std::string::npos) << command << "\n" << said;
    EXPECT_NE(said.find("by streams"), std::string::npos) << command << "\n" << said;
    ASSERT_EQ(run(replaced(command, "streams.csv", "two.csv")), 0) << said;
    EXPECT_EQ(said.find("by streams"), std::string::npos) << command << "\n" << said;
  }
  // All predict by the theory of the palette; that of the fit is within its residuals of the measured tint.
  ASSERT_EQ(run("mix streams.csv 'white: 9 + red: 1' --thickness 1 --substrate 0.8 --json m.json"), 0)
      << said;
  EXPECT_NE(said.find("1 thick over 0.8, by streams"), std::string::npos) << said;
  EXPECT_EQ(said.find("fitted by streams"), std::string::npos) << said;
  EXPECT_EQ(json("m.json")["theory"], "streams");
  for (const auto& [index, measured] : {std::pair{0, 0.5}, {1, 0.6}, {2, 0.8}})
    EXPECT_NEAR(json("m.json")["reflectance"][std::size_t(index)].get<double>(), measured, 0.05);
  // `match` finds the recipe of what `mix` predicts, and the contrast of `hide` is that of `mix` over black and white.
  write(
      "target.csv", "sample,unit,400,550,700\nt,fraction" + [&] {
        std::string values;
        const auto mixed = json("m.json");
        for (const auto& v : mixed["reflectance"]) values += "," + std::to_string(v.get<double>());
        return values;
      }() + "\n");
  ASSERT_EQ(run("match streams.csv target.csv#t --thickness 1 --substrate 0.8 -n 2 --json r.json"), 0)
      << said;
  EXPECT_EQ(json("r.json")["theory"], "streams");
  EXPECT_NEAR(json("r.json")["solutions"][0]["recipe"]["white"].get<double>(), 0.9, 0.005) << said;
  EXPECT_LT(json("r.json")["solutions"][0]["difference"].get<double>(), 0.05);
  ASSERT_EQ(run("hide streams.csv 'white: 9 + red: 1' --thickness 1 --json h.json"), 0) << said;
  double luminous[2];
  for (const int i : {0, 1}) {
    ASSERT_EQ(run("mix streams.csv 'white: 9 + red: 1' --thickness 1 --json m.json --substrate " +
                  std::string(i ? "0.8" : "0")),
              0)
        << said;
    const double l = (json("m.json")["lab"][0].get<double>() + 16) / 116;
    luminous[i] = l * l * l;
  }
  EXPECT_NEAR(json("h.json")["at_thickness"]["contrast_ratio"].get<double>(), luminous[0] / luminous[1],
              1e-6);
  ASSERT_EQ(run("mix streams.csv red --geometry d8 --specular included --json m.json"), 0) << said;
  const double included = json("m.json")["reflectance"][0];
  ASSERT_EQ(run("mix streams.csv red --geometry d8 --specular excluded --json m.json"), 0) << said;
  // Gloss of an index of 1.5 at 8 degrees.
  EXPECT_NEAR(included - json("m.json")["reflectance"][0].get<double>(), 0.04, 1e-3);
  write("wrong.csv", "unit,film\ntheory,three fluxes\nnm,a K,a S\n400,0.1,1\n700,0.1,1\n");
  fails("mix wrong.csv a", "wrong.csv:2:8: theory must be \"two fluxes\" or streams, got \"three fluxes\"");
}

TEST_F(PigmentCli, LayersStateWhatTheyLieOn) {
  write("t.csv",
        "sample,paints,backing,400,700\nBlack,,,0.05,0.05\na,ochre,black,0.2,0.3\nb,ochre,,0.3,0.4\n"
        "c,umber,,0.1,0.1\n");
  ASSERT_EQ(run("fit t.csv --joint"), 0) << said;
  EXPECT_NE(said.find("the backing \"black\" is taken for the card \"Black\", whose name differs in case"),
            std::string::npos)
      << said;
  EXPECT_NE(said.find("\"b\" of line 4 has no backing, which other measurements of this paint or specimen "
                      "state, and is taken for opaque"),
            std::string::npos)
      << said;
  // Other formats, too, state a backing beside a thickness.
  write("t.json", R"({"wavelengths_nm": [400, 700], "samples": [
    {"paints": "ochre", "thickness_um": 20, "values": [0.3, 0.4]}]})");
  fails("fit t.json", "t.json: samples[0]: \"ochre\" has a thickness and no backing; right would be opaque");
  write("t.cgats",
        "BEGIN_DATA_FORMAT\nSAMPLE_NAME THICKNESS_UM nm400 nm700\nEND_DATA_FORMAT\nBEGIN_DATA\n"
        "ochre 20 .3 .4\nEND_DATA\n");
  fails("fit t.cgats", "t.cgats:5: \"ochre\" has a thickness and no backing");
}

TEST_F(PigmentCli, CardsThatSeemSwapped) {
  const std::string head =
      "sample,paints,backing,thickness_um,400,550,700\nblack,,,,0.05,0.05,0.05\nwhite,,,,0.8,0.8,0.8\n";
  write("s.csv", head + "a,ochre,black,20,0.4,0.5,0.6\nb,ochre,white,20,0.3,0.4,0.5\n");
  const std::string question = "are the cards swapped?";
  fails("fit s.csv",
        "the film is darker over the brighter card: are the cards swapped? If not, a fit of all "
        "measurements (--joint)");
  ASSERT_EQ(run("fit s.csv --joint"), 0) << said;
  EXPECT_NE(
      said.find("\"a\" is darker over the brighter card \"white\" than over \"black\", by more than the "
                "noise at 3 of 3 wavelengths: are the cards swapped?"),
      std::string::npos)
      << said;
  // Noise of a film that hides asks nothing.
  write("n.csv", head + "a,ochre,black,20,0.405,0.505,0.6\nb,ochre,white,20,0.4,0.5,0.605\n");
  ASSERT_EQ(run("fit n.csv --joint"), 0) << said;
  EXPECT_EQ(said.find(question), std::string::npos) << said;
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

TEST_F(PigmentCli, GeometriesOfCxf) {
  const auto with = [&](const std::string& more) {
    return replaced(kCxf, "<cc:MeasurementSpec>", "<cc:MeasurementSpec>" + more);
  };
  const auto choice = [&](const std::string& geometry) {
    return with("<cc:GeometryChoice>" + geometry + "</cc:GeometryChoice>");
  };
  for (const auto& [geometry, specular] :
       {std::pair{"<cc:SphereGeometry><cc:SphereGeometryConfiguration>Specular_Included"
                  "</cc:SphereGeometryConfiguration></cc:SphereGeometry>",
                  "included"},
        {"<cc:SphereGeometry>Specular_Excluded</cc:SphereGeometry>", "excluded"},
        {"<cc:SphericalGeometry><cc:SpecularExclusion>false</cc:SpecularExclusion></cc:SphericalGeometry>",
         "included"},
        {"<cc:SphericalGeometry><cc:SpecularExclusion>true</cc:SpecularExclusion></cc:SphericalGeometry>",
         "excluded"}}) {
    write("a.cxf", choice(geometry));
    ASSERT_EQ(run("fit a.cxf"), 0) << said;
    EXPECT_NE(said.find(std::string("at the geometry d8, specular ") + specular), std::string::npos)
        << geometry << said;
    EXPECT_EQ(said.find("GeometryChoice"), std::string::npos) << said;
  }
  write("a.cxf", choice("<cc:OtherGeometry>Target</cc:OtherGeometry>"));
  ASSERT_EQ(run("fit a.cxf"), 0) << said;
  EXPECT_NE(said.find("GeometryChoice has the element OtherGeometry, which is not known"), std::string::npos)
      << said;
  write("a.cxf", with("<cc:Aperture>8mm</cc:Aperture>"));
  write("b.cxf", with("<cc:Aperture>25mm</cc:Aperture>"));
  ASSERT_EQ(run("fit a.cxf b.cxf --joint"), 0) << said;
  EXPECT_NE(said.find("b.cxf: the aperture is 25mm, that of a.cxf 8mm"), std::string::npos) << said;
}

TEST_F(PigmentCli, TablesOfPricesAndLampsAsOfficesWriteThem) {
  const std::string command =
      "match kimera 'lab(60,25,20)' --only white --only red --json m.json --prices prices.csv";
  write("prices.csv", "paint,price\nwhite,2.5\nred,20\n");
  ASSERT_EQ(run(command), 0) << said;
  const auto expected = solutions("m.json");
  for (const char* text : {"paint;price (EUR/kg)\nwhite;2,5\nred;20,0\n",
                           "Paint\tPrice [$/kg]\nwhite\t2,5\nred\t20\n", "white;2.5\nred;20\n"}) {
    write("prices.csv", text);
    ASSERT_EQ(run(command), 0) << text << said;
    EXPECT_EQ(solutions("m.json"), expected) << text;
  }
  write("prices.csv", "paint;price (EUR/kg)\nwhite;2,5\nred;dear\n");
  fails(command, "prices.csv:3:5: expected a price per mass, not negative, got \"dear\"");

  ASSERT_EQ(run("mix kimera red --illuminant E --json m.json"), 0) << said;
  const auto lab = json("m.json")["lab"];
  for (const char* text :
       {"wavelength (nm);power (mW/nm)\n360;2,0\n830;2,0\n", "nm\tpower\n360\t2,0\n830\t2,0\n",
        "wavelength (um),power\n0.36,2\n0.83,2\n", "360 2,0 # a flat lamp\n830 2,0\n"}) {
    write("lamp.txt", text);
    ASSERT_EQ(run("mix kimera red --illuminant lamp.txt --json m.json"), 0) << text << said;
    for (std::size_t i = 0; i < 3; ++i)
      EXPECT_NEAR(json("m.json")["lab"][i].get<double>(), lab[i].get<double>(), 1e-9) << text;
  }
  std::string comments;
  for (int i = 0; i < 200000; ++i) comments += "#\n";
  write("lamp.txt", comments);
  fails("mix kimera red --illuminant lamp.txt", "lamp.txt:100001: the table has more than 100000 lines");
  write("lamp.txt", "nm;power\n360;2\n830;x\n");
  fails("mix kimera red --illuminant lamp.txt", "lamp.txt:3:5: expected a number, got \"x\"");
  write("lamp.txt", "nm;power\n360;2\n500;-2\n830;2\n");
  fails("mix kimera red --illuminant lamp.txt", "lamp.txt:3:5: the power at 500 nm is negative: -2");
  write("lamp.txt", "nm;power\n360;2\n360;3\n830;2\n");
  fails("mix kimera red --illuminant lamp.txt", "lamp.txt: the wavelength 360 nm comes twice");
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

TEST_F(PigmentCli, ResidualsBesideTheStatedNoise) {
  // 20 repeats of opaque greys whose errors alternate by 0.004: the rms about their mean is 0.004.
  std::string table = "sample,paints,400,500,600,700\n";
  for (int i = 0; i < 20; ++i)
    table += i % 2 ? "a,white,0.804,0.804,0.804,0.804\n" : "a,white,0.796,0.796,0.796,0.796\n";
  write("t.csv", table);
  ASSERT_EQ(run("fit t.csv --joint --theory two-flux --noise 0.05 --relative-noise 0 --json j.json"), 0)
      << said;
  // The scatter of repeats is added to the stated noise in squares.
  EXPECT_NEAR(json("j.json")["residuals"]["relative_to_noise"], 0.004 / std::hypot(0.05, 0.0041), 0.003);
  EXPECT_NE(said.find("of the stated noise (0.05 and 0 % of R, in squares)"), std::string::npos) << said;
  EXPECT_NE(said.find("Errors by the stated noise are too wide by about a factor of 12"), std::string::npos)
      << said;
  ASSERT_EQ(run("fit t.csv --joint --theory two-flux --noise 0.0001 --relative-noise 0 --json j.json"), 0)
      << said;
  EXPECT_NEAR(json("j.json")["residuals"]["relative_to_noise"], 1, 0.1);
  EXPECT_EQ(said.find("Errors of K and S are too"), std::string::npos) << said;
  ASSERT_EQ(run("fit t.csv --relative-noise 0.01"), 0) << said;
  EXPECT_NE(said.find("--relative-noise: has no effect without --joint"), std::string::npos) << said;
  write("two.csv", "sample,paints,backing,400,700\na,white,0.1,0.8,0.8\nb,white,0.8,0.9,0.9\n");
  ASSERT_EQ(run("fit two.csv --joint"), 0) << said;
  EXPECT_NE(said.find("residuals do not tell whether the stated noise"), std::string::npos) << said;
}

}  // namespace
}  // namespace aureole::test

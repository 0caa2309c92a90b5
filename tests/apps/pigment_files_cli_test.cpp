// SPDX-License-Identifier: Apache-2.0
// Files of measured samples as `aureole pigment` reads them: tables of text, CGATS and CxF, their cards, instruments and names, and
// refusals that show what would be right.
#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>
#include <sstream>

#include "apps/pigment_cli.h"

namespace aureole::test {
namespace {

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
  fails("fit t.json",
        "t.json:2:5: samples[0]: \"ochre\" has a thickness and no backing; right would be opaque");
  write("t.cgats",
        "BEGIN_DATA_FORMAT\nSAMPLE_NAME THICKNESS_UM nm400 nm700\nEND_DATA_FORMAT\nBEGIN_DATA\n"
        "ochre 20 .3 .4\nEND_DATA\n");
  fails("fit t.cgats", "t.cgats:5: \"ochre\" has a thickness and no backing");
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

/// Refusals of a measurement that has no place among the others show its line as it would be right.
TEST_F(PigmentCli, RefusalsOfMeasurementsShowARightLine) {
  const std::string head = "sample,paints,quantity,backing,thickness_um,unit,400,550,700\n";
  const std::string card = "card,,R,,,percent,80,82,84\n", film = "a,chalk,R,0,20,percent,40,45,50\n";
  const std::string right =
      "a line that would be right, before its values:\n    sample,specimen,paints,quantity,backing,thickness_um\n    ";
  for (const auto& [line, said_so, cells] :
       {std::tuple{"b,chalk,R,cart,20", "there is no bare substrate \"cart\"", "b,,chalk,R,card,20"},
        {"b,chalk,R,card,", "is not opaque and needs its thickness", "b,,chalk,R,card,24"},
        {"b,chalk,R,1.4,20", "the backing's reflectance must be in [0, 1], got 1.4", "b,,chalk,R,0.04,20"},
        {"b,chalk,T,card,20", "transmittance is that of a free film, backing none", "b,,chalk,T,none,20"}}) {
    write("t.csv", head + card + film + line + ",percent,81,82.5,85\n");
    fails("fit t.csv", "t.csv:4: sample \"b\"");
    EXPECT_NE(said.find(said_so), std::string::npos) << said;
    EXPECT_NE(said.find(right + cells + "\n"), std::string::npos) << said;
  }
}

/// A reflectance that no paint has is shown with the line that would be right; with its unit and value the table is read.
TEST_F(PigmentCli, RefusalsOfReflectancesShowARightLine) {
  const std::string head = "sample,paints,unit,400,550,700\n";
  for (const auto& [options, value, unit, said_so] :
       {std::tuple{"", "95", "fraction",
                   "is above that of a perfect white under this interface, 1; expected from "},
        {"", "1.2", "fraction", "is above that of a perfect white under this interface, 1; expected from "},
        {" --joint", "95", "fraction", "95 is above 1.05; are these per cent"},
        {" --joint", "120", "percent", "1.2 is above 1.05; are these per cent"},
        {" --geometry d8 --specular included --index 1.5", "0.01", "fraction",
         "is below what the interface itself reflects"}}) {
    const auto table = [&](const std::string& of_unit, const std::string& of_value) {
      const std::string other = of_unit == "percent" ? "92" : "0.92";
      return head + "a,chalk," + of_unit + "," + other + "," + of_value + "," + other + "\n";
    };
    write("t.csv", table(unit, value));
    // The column of the wrong value, after the four cells before it.
    const std::string wrong = table(unit, value).substr(head.size());
    std::size_t at_550 = 0;
    for (int cell = 0; cell < 4; ++cell) at_550 = wrong.find(',', at_550) + 1;
    ++at_550;
    fails("fit t.csv --white chalk" + std::string(options),
          "t.csv:2:" + std::to_string(at_550) + ": sample \"a\" at 550 nm: ");
    EXPECT_NE(said.find(said_so), std::string::npos) << said;
    const std::string begin =
        "a line that would be right, with one of its values:\n"
        "    sample,specimen,paints,quantity,backing,thickness_um,unit,550\n    a,,chalk,R,opaque,,";
    const auto at = said.find(begin);
    ASSERT_NE(at, said.npos) << said;
    const std::string right =
        said.substr(at + begin.size(), said.find('\n', at + begin.size()) - at - begin.size());
    const auto comma = right.find(',');
    const std::string text = table(right.substr(0, comma), right.substr(comma + 1));
    write("right.csv", text);
    EXPECT_EQ(run("fit right.csv --white chalk" + std::string(options)), 0) << text << said;
  }
  write(
      "t.json",
      "{\"wavelengths_nm\": [400, 550],\n \"samples\": [{\"paints\": \"chalk\", \"values\": [0.9,\n  95]}]}");
  fails("fit t.json",
        "t.json:3:3: samples[0].values[1]: sample \"chalk\" at 550 nm: reflectance 95 is above");
  EXPECT_NE(
      said.find(
          "one of its values:\n    \"unit\": \"percent\", \"samples\": [{\"sample\":\"chalk\",\"paints\":\"chalk\","
          "\"quantity\":\"R\",\"backing\":\"opaque\",\"values\":[95.0]}]\n"),
      said.npos)
      << said;
  // With this line in the place of the wrong one the file is read.
  const std::string line =
      replaced(said.substr(said.find("\"unit\": \"percent\"")), "[95.0]", "[90, 95.0, 90]");
  write("right.json", "{\"wavelengths_nm\": [400, 550, 700],\n" + line + "}");
  EXPECT_EQ(run("fit right.json --white chalk"), 0) << said;
}

/// Refusals of JSON have line and column, say what was expected, and show a line that would be right; with this line in the place
/// of the wrong one the file is read.
TEST_F(PigmentCli, RefusalsOfJsonShowARightLine) {
  // Each member has a line of its own. Three bytes are one character of the line.
  const std::string text =
      "{\"unit\": \"percent\",\n\"wavelengths_nm\": [400, 550, 700],\n\"samples\": [\n{\"sample\": \"\xE2\x82\xAC {[,\\\"\",\n"
      "\"paints\": \"white\",\n\"quantity\": \"R\",\n\"backing\": \"opaque\",\n\"values\": [90, 91, 92]}\n]}\n";
  struct Case {
    const char *old, *by, *said_so;
    bool has_right_line = true;
  };
  for (const Case& c :
       {Case{"\"percent\"", "\"furlong\"", ":1:10: unit: unit must be fraction or percent, got \"furlong\""},
        {"\"percent\"", "7", ":1:10: unit: expected a string, got 7"},
        {"[400, 550, 700]", "[400, \"x\", 700]", ":2:25: wavelengths_nm[1]: expected a number, got \"x\""},
        {"[400, 550, 700]", "400", ":2:19: wavelengths_nm: expected an array, got 400"},
        {"\"white\"", "\"a: x + b: 1\"", ":5:11: samples[0].paints: "},
        {"\"white\"", "{\"a\": [1]}", ":5:17: samples[0].paints.a: expected a number, got an array", false},
        {"\"quantity\": \"R\"", "\"quantity\": \"Q\"",
         ":6:13: samples[0].quantity: must be R or T, got \"Q\""},
        {"\"backing\": \"opaque\"", "\"thickness_um\": 0",
         ":7:17: samples[0].thickness_um: a thickness must be positive, got 0", false},
        {"[90, 91, 92]", "[90, null, 92]", ":8:16: samples[0].values[1]: expected a number, got null"},
        {"\"values\": [90, 91, 92]", "\"value\": [90, 91, 92]",
         ":4:1: samples[0]: the key \"values\" is missing"},
        {"[90, 91, 92]", "[90, 91]",
         ":8:11: samples[0].values: expected 3 values, one for each wavelength, got 2"},
        {"[400, 550, 700]", "[400, 700, 550]",
         ":2:30: wavelengths_nm[2]: wavelengths must increase, got 550 behind 700"},
        {"[400, 550, 700]", "[]", ":2:19: wavelengths_nm: there are no wavelengths"},
        {"[90, 91, 92]", "[90, -1, 92]", ":8:16: samples[0].values[1]: sample \"", false},
        {"\"unit\": \"percent\",", "\"unit\" \"percent\",", ":1:", false},
        {"92]", "92", ":8:", false}}) {
    const std::string wrong = replaced(text, c.old, c.by);
    write("a.json", wrong);
    fails("fit a.json", std::string("a.json") + c.said_so);
    const std::string begin = "a line that would be right:\n    ";
    const auto at = said.find(begin);
    if (at == said.npos || !c.has_right_line) {
      EXPECT_TRUE(!c.has_right_line) << said;
      continue;
    }
    const std::string right =
        said.substr(at + begin.size(), said.find('\n', at + begin.size()) - at - begin.size());
    // The key's line is replaced by the right one, with what encloses it.
    const std::string key = right.substr(0, right.find(':'));
    std::istringstream lines(text);
    std::string line, mended;
    while (std::getline(lines, line)) {
      const auto of_key = line.find(key + ":");
      if (of_key == line.npos) {
        mended += line + "\n";
        continue;
      }
      const bool is_last = line.ends_with("]}");
      mended += line.substr(0, of_key) + right + (is_last ? "}" : ",") + "\n";
    }
    write("right.json", mended);
    EXPECT_EQ(run("fit right.json --joint"), 0) << mended << said;
  }
  write(
      "a.json",
      "[{\"type\": \"wavelengths\", \"values\": [400, 700]},\n{\"type\": \"sample\", \"name\": \"a\", \"reflectance\": [90, 190]}]");
  fails("fit a.json", "a.json:2:53: [1].reflectance[1]: sample \"a\" at 700 nm: reflectance 1.9 is above");
  write("a.json", "{\"wavelengths_nm\": [400, 1e999]}");
  fails("fit a.json", "a.json: is no JSON: ");
  // Of several files, the sample is counted within its own.
  write("one.csv", "paints,400,700\nchalk,0.8,0.9\n");
  write("two.json",
        "{\"wavelengths_nm\": [400, 700], \"samples\": [\n{\"paints\": \"red\", \"values\": [0.3, 1.4]}]}");
  fails("fit one.csv two.json --joint",
        "two.json:2:1: samples[0]: sample \"red\" at 700 nm: 1.4 is above 1.05");
}

/// Refusals of CGATS name the field, and show the line as it would be right; with this line the file is read.
TEST_F(PigmentCli, RefusalsOfCgatsShowARightLine) {
  struct Case {
    const char *old, *by;
    int line;  ///< number of the wrong line, from 1
    const char* field;
  };
  for (const Case& c : {Case{"45\t50\n", "x\t50\n", 14, "SPECTRAL_NM550"},
                        {"chalk\t0\t20", "chalk\t0\t-20", 14, "THICKNESS_UM"},
                        {"chalk\t0\t20", "chalk\t0\tthin", 14, "THICKNESS_UM"},
                        {"\t84\n", "\n", 13, ""},
                        {"\t84\n", "\t84\t85\n", 13, ""},
                        {"SETS 3", "SETS 4", 11, ""},
                        {"FIELDS 8", "FIELDS 9", 6, ""},
                        {"NORM \"100\"", "NORM \"7\"", 5, ""},
                        {"chalk over black\"", "chalk over black", 14, ""}}) {
    const std::string wrong = replaced(kCgats, c.old, c.by);
    write("a.txt", wrong);
    fails("fit a.txt", "a.txt:");
    if (*c.field) {
      EXPECT_NE(said.find("in the field " + std::string(c.field)), std::string::npos) << said;
    }
    const std::string begin = "a line that would be right:\n    ";
    const auto at = said.find(begin);
    ASSERT_NE(at, said.npos) << said;
    const std::string right =
        said.substr(at + begin.size(), said.find('\n', at + begin.size()) - at - begin.size());
    if (!*c.field && std::string(c.old).starts_with("chalk over")) continue;  // the quote may end elsewhere
    std::istringstream lines(wrong);
    std::string line, mended;
    for (int number = 1; std::getline(lines, line); ++number)
      mended += (number == c.line ? right : line) + "\n";
    write("right.txt", mended);
    EXPECT_EQ(run("fit right.txt --joint"), 0) << right << "\n" << said;
  }
  write("a.txt", replaced(kCgats, "\tchalk\tcard", "\t\"chalk: x\"\tcard"));
  fails(
      "fit a.txt",
      "a.txt:15:19: recipe \"chalk: x\": \"x\" is no number in the field PAINTS; a line that would be right:\n"
      "    \"chalk over card\" \"red: 1 + white: 3\" card 20 91 81 82.5 85");
  write("a.txt", replaced(kCgats, "SAMPLE_ID PAINTS", "LAB_A LAB_B"));
  fails("fit a.txt", "SAMPLE_NAME PAINTS BACKING THICKNESS_UM SPECTRAL_NM400");
  write("a.cgats", "CGATS.17\nBEGIN_DATA\n");
  fails("fit a.cgats", "right:\n    BEGIN_DATA_FORMAT\n    SAMPLE_NAME");
}

/// Refusals of CxF show the element as it would be right, with the prefix that the file has.
TEST_F(PigmentCli, RefusalsOfCxfShowARightLine) {
  for (
      const auto& [old, by, right] :
      {std::tuple{"Value=\"20\"", "Value=\"-20\"", "<cc:Tag Name=\"Thickness_um\" Value=\"20\"/>"},
       {"Value=\"20\"", "Value=\"thin\"", "<cc:Tag Name=\"Thickness_um\" Value=\"24\"/>"},
       {"0.45\n", "0,45\n", "right would be 0.45"},
       {"0.45\n", "x\n", "right would be 0.4"},
       {" Increment=\"150\"", "", "<cc:WavelengthRange StartWL=\"400\" Increment=\"10\"/>"},
       {"Increment=\"150\"", "Increment=\"-1\"", "<cc:WavelengthRange StartWL=\"400\" Increment=\"10\"/>"},
       {"0.82 0.84", "0.82", "right would be 2 values from 400 nm in steps of 150"},
       {"0.80 0.82 0.84", "",
        "<cc:ReflectanceSpectrum ColorSpecification=\"CS\">0.40 0.45 0.50</cc:ReflectanceSpectrum>"},
       {"Name=\"Paints\" Value=\"\"", "Name=\"Paints\" Value=\"a: x\"",
        "<cc:Tag Name=\"Paints\" Value=\"red: 1 + white: 3\"/>"},
       {"<cc:MeasurementSpec>",
        "<cc:MeasurementSpec><cc:SingleAngle><cc:IlluminationAngle>30</cc:IlluminationAngle>"
        "<cc:MeasurementAngle>0</cc:MeasurementAngle></cc:SingleAngle>",
        "<cc:SingleAngle><cc:IlluminationAngle>45</cc:IlluminationAngle><cc:MeasurementAngle>0</cc:MeasurementAngle>"
        "</cc:SingleAngle>"}}) {
    write("a.cxf", replaced(kCxf, old, by));
    fails("fit a.cxf", "a.cxf:");
    EXPECT_NE(said.find(right), std::string::npos) << said;
  }
  write("a.cxf", "<svg/>");
  fails("fit a.cxf", "<cc:CxF xmlns:cc=");
}

/// A sample's name with '+', ':' or '%' that is no recipe is the name of one paint, with a note; a recipe that is wrong stays an
/// error. Recipes call such a paint by its name in quotes.
TEST_F(PigmentCli, NamesThatLookLikeRecipes) {
  for (const char* name : {"cyan+magenta", "Lot 7: dry", "50% cyan", "A:B+C: 2", "12:30"}) {
    std::string text = kCxf;
    for (int i = 0; i < 2; ++i) text = replaced(text, "Name=\"chalk\"", "Name=\"" + std::string(name) + "\"");
    write("films.cxf", text);
    ASSERT_EQ(run("fit films.cxf -o p.csv --json fit.json"), 0) << name << said;
    EXPECT_EQ(json("fit.json")["pigments"][0]["name"], name);
    const std::string note = "the name \"" + std::string(name) + "\" is taken for that of one paint";
    EXPECT_EQ(said.find(note) != said.npos, std::string(name).find_first_of("+:") != std::string::npos)
        << said;
    ASSERT_EQ(run("mix p.csv '" + std::string(name) + "' --json alone.json"), 0) << said;
    ASSERT_EQ(run("mix p.csv '\"" + std::string(name) + "\": 1' --json quoted.json"), 0) << said;
    EXPECT_EQ(json("alone.json")["reflectance"], json("quoted.json")["reflectance"]);
  }
  std::string text = kCxf;
  for (int i = 0; i < 2; ++i) text = replaced(text, "Name=\"chalk\"", "Name=\"chalk: 60% + lime: 30%\"");
  write("films.cxf", text);
  fails("fit films.cxf",
        "films.cxf:9:4: recipe \"chalk: 60% + lime: 30%\": per cent must sum to 100, got 90");
  std::string cgats = replaced(replaced(kCgats, "SAMPLE_ID PAINTS", "SAMPLE_NAME "), "FIELDS 8", "FIELDS 7");
  cgats = replaced(cgats, "card\t\"\"\t\"\"", "card\t\"\"");
  cgats = replaced(cgats, "\"chalk over black\"\tchalk", "cyan+magenta");
  cgats = replaced(cgats, "\"chalk over card\"\tchalk", "cyan+magenta");
  write("films.cgats", cgats);
  ASSERT_EQ(run("fit films.cgats --json fit.json"), 0) << said;
  EXPECT_EQ(json("fit.json")["pigments"][0]["name"], "cyan+magenta");
}

}  // namespace
}  // namespace aureole::test

// SPDX-License-Identifier: Apache-2.0
// aureole photometry and aureole goniophotometer as a user meets them: what they print and write, and messages for bad
// input, after which nothing is written.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <chrono>
#include <cmath>
#include <csignal>
#include <fstream>
#include <sstream>
#include <thread>

#include "aureole/core/image.h"
#include "aureole/parameter/luminaire/luminaire_file.h"
#include "harness/paths.h"
#include "harness/program.h"
#include "loading/load_text.h"

namespace aureole::test {
namespace {

namespace fs = std::filesystem;

class PhotometryCommand : public ::testing::Test {
protected:
  int run(const std::vector<std::string>& arguments) {
    const ProgramEnd end = run_program(folder.path, arguments);
    output = end.output;
    return end.exit_code;
  }
  void refused(const std::vector<std::string>& arguments, const std::string& message) {
    EXPECT_EQ(run(arguments), 2) << output;
    EXPECT_NE(output.find(message), std::string::npos) << "expected \"" << message << "\" in: " << output;
    for (const char* name : {"x.png", "x.ies", "x.ldt", "x.csv"})
      EXPECT_FALSE(fs::exists(folder.path / name)) << name;
  }
  TemporaryFolder folder;
  std::string output;
};

const std::string kGrid =
    "<scene version='3.0.0'><integrator type='direct'/><sensor type='powermap'><string name='measure' value='irradiance'/>"
    "<film type='hdrfilm'><integer name='width' value='8'/><integer name='height' value='4'/>"
    "<string name='quantity' value='illuminance'/></film><sampler type='sobol'><integer name='sample_count' value='64'/></sampler>"
    "</sensor><shape type='sphere'><point name='center' x='0' y='0' z='-30'/></shape>"
    "<emitter type='directional'><vector name='direction' x='0' y='0' z='-1'/><string name='amount' value='2 klx'/></emitter></scene>";

TEST_F(PhotometryCommand, DrawsAndPrintsAnIlluminanceGrid) {
  folder.write("grid.xml", kGrid);
  ASSERT_EQ(run({"photometry", "grid.xml", "-o", "x.png", "--csv", "x.csv", "--daylight", "--region",
                 "0,0,4,4", "--region", "4,0,4,4"}),
            0)
      << output;
  EXPECT_NE(output.find("open ground: 2000"), std::string::npos) << output;
  EXPECT_NE(output.find("daylight factor, %"), std::string::npos) << output;
  EXPECT_NE(output.find("contrast of the first region against the second: "), std::string::npos) << output;
  std::ifstream csv(folder.path / "x.csv");
  std::string line;
  int rows = 0;
  for (std::getline(csv, line); std::getline(csv, line); ++rows) EXPECT_NEAR(std::stod(line), 100, 0.1);
  EXPECT_EQ(rows, 4);
  EXPECT_EQ(read_image(folder.path / "x.png").channels.size(), 3u);
  // The picture beside it is in lux, and can be evaluated again.
  ASSERT_EQ(run({"photometry", "x.exr", "-o", "y.png"}), 0) << output;
  EXPECT_NE(output.find("illuminance, lx; 8 x 4 cells"), std::string::npos) << output;
  EXPECT_NE(output.find(" 2000 "), std::string::npos) << output;
}

// In the open the illuminance on a sphere exceeds that of the ground: over that it is no daylight factor.
TEST_F(PhotometryCommand, DaylightFactorsAreOfTheIlluminanceOnASurface) {
  const auto with = [](const std::string& from, const std::string& to) {
    std::string scene = kGrid;
    scene.replace(scene.find(from), from.size(), to);
    return scene;
  };
  folder.write("sphere.xml", with("<string name='measure' value='irradiance'/>", ""));
  refused({"photometry", "sphere.xml", "--daylight", "-o", "x.png"},
          "sphere.xml:1:51: --daylight: needs the illuminance on a surface, not the spherical illuminance");
  EXPECT_FALSE(fs::exists(folder.path / "x.exr"));
  folder.write("cylinder.xml", with("'irradiance'", "'cylindrical'"));
  refused({"photometry", "cylinder.xml", "--daylight", "-o", "x.png"}, "not the cylindrical illuminance");
  folder.write("night.xml", with("'illuminance'", "'scotopic_illuminance'"));
  refused({"photometry", "night.xml", "--daylight", "-o", "x.png"}, "not the scotopic illuminance");
  ASSERT_EQ(run({"photometry", "sphere.xml", "-o", "y.png", "-q"}), 0) << output;
  refused({"photometry", "y.exr", "--scene", "sphere.xml", "--daylight", "-o", "x.png"},
          "y.exr: --daylight: needs the illuminance on a surface");
}

TEST_F(PhotometryCommand, WritesFilesOfAModelledLuminaire) {
  folder.write(
      "lamp.xml",
      "<scene version='3.0.0'><emitter type='spot'><string name='amount' value='500 cd'/><float name='cutoff_angle' value='40'/>"
      "<float name='beam_width' value='40'/><transform name='to_world'><rotate x='1' angle='180'/></transform></emitter></scene>");
  ASSERT_EQ(
      run({"goniophotometer", "lamp.xml",   "-o",           "x.ies", "-o",     "x.ldt", "--spp",       "4",
           "--symmetry",      "rotational", "--gamma-step", "2.5",   "--flux", "700",   "--lamp-flux", "1000",
           "--name",          "a spot",     "--watts",      "12"}),
      0)
      << output;
  EXPECT_NE(output.find("70.00 % of the 1000 lm"), std::string::npos) << output;
  for (const char* name : {"x.ies", "x.ldt"}) {
    const Luminaire l = read_luminaire(folder.path / name);
    EXPECT_NEAR(l.distribution.flux(), 700, 0.1) << name;
    EXPECT_EQ(l.lamp_flux(), 1000) << name;
    EXPECT_EQ(l.lamps[0].watts, 12) << name;
    EXPECT_NEAR(l.distribution.at(0, 0) / l.distribution.at(0, 35), 1, 1e-4) << name;
    EXPECT_EQ(l.distribution.at(0, 45), 0) << name;
  }
  // A file is reported on and converted.
  ASSERT_EQ(run({"goniophotometer", "x.ldt", "-o", "y.ies"}), 0) << output;
  EXPECT_NEAR(read_luminaire(folder.path / "y.ies").distribution.flux(), 700, 0.1);
}

TEST_F(PhotometryCommand, MeansOnAShapeAreOverItsArea) {
  // A ball in parallel light of 2000 lx: a quarter of that in the mean over its surface, since a disc of its radius catches it.
  // Equal cells of the texture coordinates would have 622 lx: 2000 (cos 0 + 2 cos 30 + 2 cos 60)/12 over six rows.
  folder.write(
      "ball.xml",
      "<scene version='3.0.0'><integrator type='direct'/><shape type='sphere'><bsdf type='diffuse'/><sensor type='powermap'>"
      "<string name='measure' value='irradiance'/><film type='hdrfilm'><integer name='width' value='8'/><integer name='height' value='6'/>"
      "<string name='quantity' value='$quantity'/></film><sampler type='sobol'><integer name='sample_count' value='1024'/></sampler></sensor></shape>"
      "<emitter type='directional'><vector name='direction' x='0' y='0' z='-1'/><string name='amount' value='2 klx'/></emitter></scene>");
  const auto mean_of = [&](const std::string& printed) {
    const std::size_t at = printed.find("0,0,8,6");
    EXPECT_NE(at, std::string::npos) << printed;
    return std::stod(printed.substr(at + 7));
  };
  ASSERT_EQ(run({"photometry", "ball.xml", "-D", "quantity=illuminance", "-o", "x.png", "-q"}), 0) << output;
  EXPECT_NEAR(mean_of(output), 500, 1);
  ASSERT_EQ(
      run({"photometry", "x.exr", "--scene", "ball.xml", "-D", "quantity=illuminance", "-o", "y.png", "-q"}),
      0)
      << output;
  EXPECT_NEAR(mean_of(output), 500, 1);
  // A picture alone does not know the shape: its cells count alike.
  ASSERT_EQ(run({"photometry", "x.exr", "-o", "y.png", "-q"}), 0) << output;
  EXPECT_NEAR(mean_of(output), 622, 1);
  // Power through the cells adds up: 2000 lx times pi m^2.
  ASSERT_EQ(run({"photometry", "ball.xml", "-D", "quantity=luminous_flux", "-o", "y.png", "-q"}), 0)
      << output;
  const std::size_t at = output.find("luminous flux through 0,0,8,6: ");
  ASSERT_NE(at, std::string::npos) << output;
  EXPECT_NEAR(std::stod(output.substr(at + 31)), 2000 * M_PI, 10);
}

const std::string kPanel =
    "IESNA:LM-63-2002\nTILT=NONE\n1 4000 1 4 1 1 2 0.6 0.6 0\n1 1 36\n0 30 60 90\n0\n1000 860 450 0\n";

TEST_F(PhotometryCommand, PrintsTheTableOfUgr) {
  folder.write("panel.ies", kPanel);
  ASSERT_EQ(run({"ugr", "panel.ies", "--csv", "x.csv", "--plot", "x.svg"}), 0) << output;
  EXPECT_NE(output.find("for 4000 lm of the lamps (+4.8 against 1000 lm)"), std::string::npos) << output;
  EXPECT_NE(output.find("S = 1.5H"), std::string::npos) << output;
  std::ifstream csv(folder.path / "x.csv");
  std::string line;
  std::getline(csv, line);
  EXPECT_EQ(line.substr(0, 28), "x_H,y_H,crosswise_70_50_20,c");
  std::vector<std::vector<double>> rows;
  while (std::getline(csv, line)) {
    std::istringstream cells(line);
    rows.emplace_back();
    for (std::string cell; std::getline(cells, cell, ',');) rows.back().push_back(std::stod(cell));
  }
  ASSERT_EQ(rows.size(), 19u);
  for (const auto& row : rows) {
    ASSERT_EQ(row.size(), 12u);
    for (std::size_t k = 2; k < 7; ++k)
      EXPECT_EQ(row[k], row[k + 5]);  // a square panel of rotational symmetry
  }
  EXPECT_EQ(rows[10][0], 4);
  EXPECT_EQ(rows[10][1], 8);
  // For 1000 lm: 8 lg 4 less.
  ASSERT_EQ(run({"ugr", "panel.ies", "--uncorrected", "-q", "--csv", "y.csv"}), 0) << output;
  std::ifstream less(folder.path / "y.csv");
  std::getline(less, line), std::getline(less, line);
  EXPECT_NEAR(std::stod(line.substr(4)), rows[0][2] - 4.8165, 1e-3);
  // A modelled luminaire, whose opening is stated: a panel of 0.6 m by 0.6 m and 1000 cd/m^2.
  folder.write(
      "modelled.xml",
      "<scene version='3.0.0'><shape type='rectangle'><transform name='to_world'><scale value='0.3'/><rotate x='1' angle='180'/></transform>"
      "<emitter type='area'><string name='amount' value='1000 cd/m^2'/></emitter></shape></scene>");
  ASSERT_EQ(run({"ugr", "modelled.xml", "--spp", "2048", "--opening", "0.6", "0.6", "0", "--gamma-step",
                 "2.5", "--symmetry", "rotational", "-q", "--csv", "z.csv"}),
            0)
      << output;
  // Its luminance, and so its rating, is that of a file of 360 cos(gamma) cd.
  std::string cosine = "IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 73 1 1 2 0.6 0.6 0\n1 1 36\n", angles;
  for (int i = 0; i <= 72; ++i) {
    angles += std::to_string(1.25 * i) + (i % 8 == 7 ? "\n" : " ");
    if (i == 72) cosine += angles + "\n0\n";
  }
  for (int i = 0; i <= 72; ++i)
    cosine +=
        std::to_string(360 * std::max(0.0, std::cos(1.25 * i * M_PI / 180))) + (i % 8 == 7 ? "\n" : " ");
  folder.write("cosine.ies", cosine);
  ASSERT_EQ(run({"ugr", "cosine.ies", "-q", "--csv", "w.csv"}), 0) << output;
  std::ifstream modelled(folder.path / "z.csv"), by_file(folder.path / "w.csv");
  std::string other;
  std::getline(modelled, line), std::getline(by_file, other);
  for (int i = 0; i < 19; ++i) {
    std::getline(modelled, line), std::getline(by_file, other);
    const auto third = [](const std::string& row) {
      return std::stod(row.substr(row.find(',', row.find(',') + 1) + 1));
    };
    EXPECT_NEAR(third(line), third(other), 0.05) << i;
  }
}

TEST_F(PhotometryCommand, OptionsOfAMeasurementAreNotForFiles) {
  folder.write("panel.ies", kPanel);
  for (const std::vector<std::string>& option : {std::vector<std::string>{"--spp", "4"},
                                                 {"--c-step", "15"},
                                                 {"--symmetry", "none"},
                                                 {"--along", "1", "0", "0"}}) {
    std::vector<std::string> words{"goniophotometer", "panel.ies", "-o", "x.ldt"};
    words.insert(words.end(), option.begin(), option.end());
    refused(words, "a file has its intensities");
  }
  // Options that replace what the file states are applied: flux, flux of the lamps, opening, names.
  ASSERT_EQ(run({"goniophotometer", "panel.ies", "-o", "y.ldt", "--lamp-flux", "8000", "--opening", "1.2",
                 "0.3", "0.05", "--name", "a panel", "--watts", "30"}),
            0)
      << output;
  const Luminaire l = read_luminaire(folder.path / "y.ldt"),
                  given = read_luminaire(folder.path / "panel.ies");
  EXPECT_EQ(l.lamp_flux(), 8000);
  EXPECT_NEAR(l.distribution.flux(), 2 * given.distribution.flux(), 1e-3 * given.distribution.flux());
  EXPECT_NEAR(l.opening.size_m[0], 1.2, 1e-9);
  EXPECT_NEAR(l.opening.size_m[2], 0.05, 1e-9);
  EXPECT_EQ(l.lamps[0].watts, 30);
  ASSERT_EQ(run({"goniophotometer", "panel.ies", "-o", "y.ldt", "--flux", "500"}), 0) << output;
  EXPECT_NEAR(read_luminaire(folder.path / "y.ldt").distribution.flux(), 500, 0.01);
}

TEST_F(PhotometryCommand, ValuesThatEqualADefaultAreStated) {
  folder.write("panel.ies", kPanel);
  folder.write("dark.xml", "<scene version='3.0.0'><shape type='sphere'/></scene>");
  refused({"goniophotometer", "panel.ies", "--flux", "0", "-o", "x.ies"}, "--flux 0: must be positive");
  refused({"goniophotometer", "panel.ies", "--lamp-flux", "0", "-o", "x.ies"},
          "--lamp-flux 0: must be positive");
  refused({"goniophotometer", "panel.ies", "--watts", "0", "-o", "x.ies"}, "--watts 0: must be positive");
  refused({"goniophotometer", "panel.ies", "--lamp-set", "-1", "-o", "x.ies"},
          "--lamp-set -1: expected the number");
  refused({"goniophotometer", "panel.ies", "--lamp-set", "1", "-o", "x.ies"},
          "panel.ies is a file of LM-63, which has one set");
  refused({"goniophotometer", "dark.xml", "--c-step", "0", "-o", "x.ies"},
          "--c-step 0: must divide 360 degrees");
  refused({"goniophotometer", "dark.xml", "--gamma-step", "0", "-o", "x.ies"},
          "--gamma-step 0: must divide 180 degrees");
  refused({"goniophotometer", "dark.xml", "--spp", "-1", "-o", "x.ies"}, "--spp -1: at least one sample");
  refused({"goniophotometer", "dark.xml", "--threads", "-1", "-o", "x.ies"}, "--threads -1");
  for (const char* option : {"--c-step", "--gamma-step", "--spp", "--seed"})
    refused({"goniophotometer", "panel.ies", option, "0", "-o", "x.ldt"}, "a file has its intensities");
  // An opening without extent is a point, also in the place of the file's area.
  ASSERT_EQ(run({"goniophotometer", "panel.ies", "--opening", "0", "0", "0", "-o", "y.ies"}), 0) << output;
  EXPECT_NE(output.find("luminous opening: a point"), std::string::npos) << output;
  EXPECT_TRUE(read_luminaire(folder.path / "y.ies").opening.is_point());
  EXPECT_FALSE(read_luminaire(folder.path / "panel.ies").opening.is_point());
  refused({"ugr", "panel.ies", "--opening", "0", "0", "0", "--csv", "x.csv"}, "no luminous area");
}

TEST_F(PhotometryCommand, OptionsOfAWrittenFileNeedOne) {
  folder.write("panel.ies", kPanel);
  for (const std::string option : {"--watts", "--name", "--maker"})
    for (const std::string command : {"goniophotometer", "ugr"})
      refused({command, "panel.ies", option, "5"}, option + ": is for the file that is written: give -o");
  // A second line would be one of the file's own, and shift those of EULUMDAT.
  for (const std::string option : {"--name", "--maker"})
    refused({"goniophotometer", "panel.ies", option, "a\nTILT=NONE", "-o", "x.ldt"}, "more than one line");
  ASSERT_EQ(run({"ugr", "panel.ies", "-q", "-o", "y.ldt", "--name", "a panel"}), 0) << output;
  EXPECT_NE(file_content(folder.path / "y.ldt").find("a panel"), std::string::npos);
}

TEST_F(PhotometryCommand, OptionsWithoutEffectAreErrors) {
  folder.write("grid.xml", kGrid);
  ASSERT_EQ(run({"photometry", "grid.xml", "-o", "a.png", "-q"}), 0) << output;
  refused({"photometry", "a.exr", "-o", "x.png", "--threads", "2"}, "a picture is done");
  refused({"photometry", "a.exr", "-o", "x.png", "-D", "a=1"}, "a picture is done");
  refused({"photometry", "a.exr", "-o", "x.png", "--up", "0,1,0"}, "--up: is for --glare and --daylight");
  refused({"photometry", "a.exr", "-o", "x.png", "--threshold", "500"}, "--threshold: is for --glare");
  refused({"photometry", "a.exr", "-o", "x.png", "--threshold", "0"},
          "--threshold: Value 0 not in range 0.000001 to 1000000000000");
  refused({"photometry", "a.exr", "-o", "x.png", "--isolines", "100,nan"}, "no value of an isoline");
}

// Measured within moments; the table takes long by patches and a narrow grid of luminaires.
TEST_F(PhotometryCommand, AnInterruptedTableKeepsTheMeasuredLuminaire) {
  folder.write(
      "panel.xml",
      "<scene version='3.0.0'><shape type='rectangle'><transform name='to_world'><rotate x='1' angle='180'/>"
      "<scale x='0.3' y='0.3' z='1'/></transform><emitter type='area'><string name='amount' value='3000 lm'/></emitter>"
      "</shape></scene>");
  const std::vector<std::string> words{
      "ugr",       "panel.xml", "--opening",    "0.6",  "0.6",       "0",    "--spp",        "4",
      "--c-step",  "45",        "--gamma-step", "15",   "--spacing", "0.05", "--background", "patches",
      "--threads", "1",         "--csv",        "x.csv"};
  const auto interrupt = [&](const std::vector<std::string>& arguments,
                             const std::function<bool()>& is_time) {
    const pid_t pid = start_program(folder.path, arguments, folder.path / "log.txt");
    for (int i = 0; i < 6000 && !is_time(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
    kill(pid, SIGINT);
    int status = 0;
    waitpid(pid, &status, 0);
    return program_end(status, folder.path / "log.txt");
  };
  std::vector<std::string> with_output = words;
  with_output.insert(with_output.end(), {"-o", "kept.ies"});
  const ProgramEnd end = interrupt(with_output, [&] { return fs::exists(folder.path / "kept.ies"); });
  EXPECT_EQ(end.exit_code, 1) << end.output;
  EXPECT_NE(end.output.find("interrupted: no table is written; kept.ies is the measured luminaire"),
            std::string::npos)
      << end.output;
  EXPECT_FALSE(fs::exists(folder.path / "x.csv"));
  // Without -o it is kept under the scene's name, or that with a number where a file has the name. A signal that comes during the
  // measurement is repeated later.
  folder.write("panel_measured.ies", kPanel);
  ProgramEnd later;
  for (int wait_ms = 500; wait_ms <= 16000; wait_ms *= 2) {
    later = interrupt(words, [&] {
      std::this_thread::sleep_for(std::chrono::milliseconds(wait_ms));
      return true;
    });
    if (later.output.find("nothing is written") == std::string::npos) break;
  }
  EXPECT_EQ(later.exit_code, 1) << later.output;
  EXPECT_EQ(file_content(folder.path / "panel_measured.ies"), kPanel);
  ASSERT_TRUE(fs::exists(folder.path / "panel_measured_2.ies")) << later.output;
  EXPECT_NE(later.output.find("; panel_measured_2.ies is the measured luminaire"), std::string::npos)
      << later.output;
  EXPECT_EQ(read_luminaire(folder.path / "panel_measured_2.ies").distribution.flux(),
            read_luminaire(folder.path / "kept.ies").distribution.flux());
  EXPECT_NEAR(read_luminaire(folder.path / "kept.ies").opening.size_m[0], 0.6, 1e-9);
}

TEST_F(PhotometryCommand, ACropIsAPartOfTheFilm) {
  const std::string film =
      "<film type='hdrfilm'><integer name='width' value='32'/><integer name='height' value='32'/>"
      "<integer name='crop_width' value='16'/><integer name='crop_offset_x' value='8'/>"
      "<string name='quantity' value='luminance'/><rfilter type='box'/></film>";
  const std::string rest =
      "<sampler type='sobol'><integer name='sample_count' value='4'/></sampler></sensor>"
      "<emitter type='constant'><string name='amount' value='50 cd/m^2'/></emitter></scene>";
  folder.write("part.xml", "<scene version='3.0.0'><sensor type='perspective'>" + film + rest);
  ASSERT_EQ(run({"photometry", "part.xml", "-o", "a.png", "-q"}), 0) << output;
  // The scene of a cropped picture is the one that was rendered.
  EXPECT_EQ(
      run({"photometry", "a.exr", "--scene", "part.xml", "--glare", "--up", "0,1,0", "-o", "b.png", "-q"}), 0)
      << output;
  std::string other = "<scene version='3.0.0'><sensor type='perspective'>" + film + rest;
  other.replace(other.find("'16'"), 4, "'12'");
  folder.write("other.xml", other);
  refused({"photometry", "a.exr", "--scene", "other.xml", "--glare", "-o", "x.png"},
          "--scene other.xml: a picture of 16 x 32 pixels is not that of the film, which has 12 x 32");
  // A part of a light field lacks views.
  folder.write("field.xml",
               "<scene version='3.0.0'><sensor type='lightfield'><integer name='views_x' value='4'/>"
               "<float name='aperture_width' value='0.1'/><float name='plane_distance' value='1'/>"
               "<float name='field_width' value='1'/>" +
                   film + rest);
  refused({"lightfield", "field.xml", "-o", "x.png"}, "the film has a crop; a light field is the whole film");
}

TEST_F(PhotometryCommand, BadInputWritesNothing) {
  folder.write("grid.xml", kGrid);
  folder.write("dark.xml", "<scene version='3.0.0'><shape type='sphere'/></scene>");
  folder.write("sky.xml", "<scene version='3.0.0'><emitter type='constant'/></scene>");
  folder.write("broken.ies", "IESNA:LM-63-2002\nTILT=NONE\n1 1000 1 3\n");
  refused({"photometry", "grid.xml", "-o", "x.jpg"}, ".png");
  refused({"photometry", "grid.xml", "-o", "x.png", "--region", "4,0,8,4"}, "leaves the picture");
  refused({"photometry", "grid.xml", "-o", "x.png", "--region", "0.5,0,8,4"}, "no number of cells");
  refused({"photometry", "grid.xml", "-o", "x.png", "--glare"}, "not of illuminance");
  refused({"photometry", "grid.xml", "-o", "x.png", "--min", "5", "--max", "4"}, "must increase");
  refused({"photometry", "missing.exr", "-o", "x.png"}, "no such file");
  refused({"goniophotometer", "dark.xml", "-o", "x.ies", "--spp", "1"}, "no light");
  refused({"goniophotometer", "sky.xml", "-o", "x.ies"}, "infinity");
  refused({"goniophotometer", "broken.ies", "-o", "x.ldt"}, "broken.ies:4:");
  refused({"goniophotometer", "dark.xml", "-o", "x.txt"}, ".ldt");
  refused({"goniophotometer", "dark.xml", "-o", "x.ies", "--gamma-step", "7"}, "must divide 180");
  refused({"goniophotometer", "dark.xml", "-o", "x.ies", "--lamp-set", "1"}, "lamps of a scene");
  folder.write("point.ies", "IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 2 1 1 2 0 0 0\n1 1 1\n0 90\n0\n100 0\n");
  folder.write("flood.ies",
               "IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 2 2 2 2 1 1 0\n1 1 1\n0 90\n0 90\n100 0 100 0\n");
  refused({"ugr", "point.ies", "--csv", "x.csv"}, "point.ies: the luminaire has no luminous area");
  refused({"ugr", "flood.ies", "--csv", "x.csv"}, "type C");
  refused({"ugr", "broken.ies", "--csv", "x.csv"}, "broken.ies:4:");
  refused({"ugr", "missing.ldt", "--csv", "x.csv"}, "missing.ldt");
  refused({"ugr", "point.ies", "--opening", "1", "1", "-1", "--csv", "x.csv"}, "--opening");
  refused({"ugr", "point.ies", "--opening", "1", "1", "0", "--spacing", "0.3", "--csv", "x.csv"},
          "whole number");
  refused({"ugr", "dark.xml", "--opening", "1", "1", "0", "--csv", "x.csv", "--spp", "1"}, "no light");
  // Options of the table are wrong before a scene is measured: this one would be an error of its emitter.
  refused({"ugr", "sky.xml", "--csv", "x.csv"}, "--opening: is needed for a scene");
  refused({"ugr", "sky.xml", "--opening", "1", "0", "0", "--csv", "x.csv"}, "--opening 1 0 0: has no area");
  refused({"ugr", "sky.xml", "--opening", "1", "1", "0", "--spacing", "0.3", "--csv", "x.csv"},
          "whole number");
}

}  // namespace
}  // namespace aureole::test

// SPDX-License-Identifier: Apache-2.0
// aureole photometry and aureole goniophotometer as a user meets them: what they print and write, and messages for bad
// input, after which nothing is written.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

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
}

}  // namespace
}  // namespace aureole::test

// SPDX-License-Identifier: Apache-2.0
// aureole powermap as a user meets it: its channels, its picture, and messages for bad input, after which nothing is written.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "aureole/core/image.h"
#include "aureole/optics/interface/fresnel_equations.h"
#include "aureole/optics/interface/radio_material.h"
#include "harness/paths.h"
#include "harness/program.h"
#include "loading/load_text.h"

namespace aureole::test {
namespace {

namespace fs = std::filesystem;

class PowerMapCommand : public ::testing::Test {
protected:
  int run(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "powermap");
    const ProgramEnd end = run_program(folder.path, arguments);
    output = end.output;
    return end.exit_code;
  }
  void refused(const std::vector<std::string>& arguments, const std::string& message) {
    EXPECT_EQ(run(arguments), 2) << output;
    EXPECT_NE(output.find(message), std::string::npos) << "expected \"" << message << "\" in: " << output;
    EXPECT_FALSE(fs::exists(folder.path / "map.exr"));
    EXPECT_FALSE(fs::exists(folder.path / "map.png"));
  }
  std::string scene(const std::string& film, const std::string& sensor = "powermap") {
    return folder
        .write("map.xml", "<scene version='3.0.0'><integrator type='ptracer'/><sensor type='" + sensor +
                              "'>" + film +
                              "</sensor><emitter type='point'><point name='position' x='0' y='0' z='2'/>"
                              "<spectrum name='intensity' value='1'/></emitter></scene>")
        .string();
  }
  TemporaryFolder folder;
  std::string output;
};

const std::string kSize = "<integer name='width' value='8'/><integer name='height' value='8'/>";
const std::string kBand = "<film type='hdrfilm'>" + kSize +
                          "<string name='response' value='uniform'/><string name='wavelength_min' "
                          "value='3.6GHz'/><string name='wavelength_max' value='3.5GHz'/></film>";

TEST_F(PowerMapCommand, WritesPowersAndAPicture) {
  ASSERT_EQ(run({scene(kBand), "--spp", "16", "--replicates", "2", "--power", "33dBm"}), 0) << output;
  EXPECT_NE(output.find("3.549 GHz: 1.99526 W, power in 64 of 64 cells"), std::string::npos) << output;
  const Image map = read_image(folder.path / "map.exr");
  for (const char* name : {"density", "free_space", "relative_dB", "received_dBm", "error_dB"})
    ASSERT_GE(map.channel(name), 0) << name;
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 8; ++x) {
      EXPECT_NEAR(map.at(x, y, std::size_t(map.channel("relative_dB"))), 0, 0.05);
      const double density = map.at(x, y, std::size_t(map.channel("density"))), lambda = 0.299792458 / 3.549;
      EXPECT_NEAR(map.at(x, y, std::size_t(map.channel("received_dBm"))),
                  10 * std::log10(density * lambda * lambda / (4 * M_PI) / 1e-3), 0.01);
    }
  const Image picture = read_image(folder.path / "map.png");
  EXPECT_GT(picture.width, 640);
}

TEST_F(PowerMapCommand, HasAMapPerBin) {
  const std::string film =
      "<film type='specfilm'>" + kSize + "<string name='bin_edges' value='3GHz, 4GHz, 5GHz'/></film>";
  ASSERT_EQ(run({scene(film), "--spp", "16", "-o", "two.exr"}), 0) << output;
  const Image map = read_image(folder.path / "two.exr");
  EXPECT_EQ(map.channels.size(), 8u);
  EXPECT_GE(map.channel("S0.67453303,05nm.relative_dB"), 0) << map.channels[0];
}

// All values are above or below the only end that is given.
TEST_F(PowerMapCommand, AnEndOfTheColoursBeyondTheValuesLosesNoMap) {
  for (const char* end : {"--min-db=200", "--max-db=-300"}) {
    ASSERT_EQ(run({scene(kBand), "--spp", "1", end}), 0) << output;
    EXPECT_TRUE(fs::remove(folder.path / "map.exr"));
    EXPECT_TRUE(fs::remove(folder.path / "map.png"));
  }
}

// A scene as sionna-rt has them: a colour for the eye whose id is the material, and neither sensor nor integrator.
TEST_F(PowerMapCommand, MapsAPlaneBehindAWall) {
  folder.write(
      "wall.xml",
      "<scene version='2.1.0'><bsdf type='twosided' id='mat-itu_concrete'><bsdf type='diffuse'/></bsdf>"
      "<shape type='rectangle'><transform name='to_world'><scale value='1000'/></transform>"
      "<ref id='mat-itu_concrete' name='bsdf'/></shape></scene>");
  ASSERT_EQ(run({"wall.xml",
                 "--plane",
                 "20",
                 "0",
                 "-1",
                 "--size",
                 "2",
                 "1",
                 "--cell",
                 "0.5",
                 "--frequency",
                 "3.5GHz",
                 "--transmitter",
                 "0",
                 "0",
                 "9",
                 "-o",
                 "map.exr",
                 "--spp",
                 "16"}),
            0)
      << output;
  EXPECT_NE(
      output.find(
          "1 BSDF named after building materials (itu_concrete) is replaced by slabs of these, 0.1m thick"),
      std::string::npos)
      << output;
  const Image map = read_image(folder.path / "map.exr");
  EXPECT_EQ(map.width, 4);
  EXPECT_EQ(map.height, 2);
  const double f = 3.5e9, wavelength = 299792458 / f;
  for (int x = 0; x < 4; ++x) {
    const double across = std::hypot(19.25 + 0.5 * x, 0.25), cosine = 10 / std::hypot(10, across);
    const optics::SlabPowers wall = optics::slab_powers(
        cosine, 1, std::sqrt(optics::radio_permittivity("concrete", f)), 0.1 / wavelength);
    EXPECT_NEAR(map.at(x, 0, std::size_t(map.channel("relative_dB"))), 10 * std::log10(wall.transmitted), 0.1)
        << x;
  }
}

// A scene in millimetres has the map of that in metres, in W/m^2. One watt is radiated, and notes say what may be missed.
TEST_F(PowerMapCommand, MapsAPlaneInAnyUnit) {
  const std::string scene =
      "<scene version='3.0.0'><string name='length_unit' value='$unit'/>"
      "<bsdf type='diffuse' id='mat-concrete'/></scene>";
  folder.write("empty.xml", scene);
  const auto map_of = [&](const std::string& unit, const std::string& height, const std::string& side) {
    EXPECT_EQ(run({"empty.xml", "-D", "unit=" + unit, "--plane", "0",
                   "0",         "0",  "--size",       side,      side,
                   "--cell",    side, "--frequency",  "3GHz",    "--transmitter",
                   "0",         "0",  height,         "-o",      unit + ".exr",
                   "--spp",     "64"}),
              0)
        << output;
    EXPECT_NE(output.find("1 W, power in 1 of 1 cells"), std::string::npos) << output;
    EXPECT_NE(output.find("1 BSDF is no building material"), std::string::npos) << output;
    const Image map = read_image(folder.path / (unit + ".exr"));
    return double(map.at(0, 0, std::size_t(map.channel("density"))));
  };
  const double expected = 1 / (4 * M_PI * 4);
  EXPECT_NEAR(map_of("m", "2", "0.01"), expected, 1e-3 * expected);
  EXPECT_EQ(output.find("lies in the plane"), std::string::npos) << output;
  EXPECT_NEAR(map_of("mm", "2000", "10"), expected, 1e-3 * expected);
  map_of("cm", "0", "1");
  EXPECT_NE(output.find("--transmitter 0 0 0 lies in the plane of the map"), std::string::npos) << output;
}

TEST_F(PowerMapCommand, RefusesPlanesThatAreNotStated) {
  const std::string file =
      folder.write("no.xml", "<scene version='3.0.0'><shape type='sphere'/></scene>").string();
  refused({file, "--plane", "0", "0", "1"}, "--plane: give its --size too");
  refused({file, "--plane", "0", "0", "1", "--size", "2", "3"}, "--plane: give the --frequency too");
  const std::vector<std::string> good = {
      file,   "--plane",       "0", "0", "1", "--size", "2", "3", "--frequency",
      "3GHz", "--transmitter", "0", "0", "9"};
  const auto with = [&](std::vector<std::string> more) {
    std::vector<std::string> all = good;
    all.insert(all.end(), more.begin(), more.end());
    return all;
  };
  refused(with({"--cell=-1"}), "--cell -1: must be positive");
  refused(with({"--cell", "1e-9"}), "more than 16384 cells");
  refused(with({"--normal", "0", "0", "0"}), "is no direction");
  refused({file, "--plane", "0", "0", "1", "--size", "0", "3", "--frequency", "3GHz"},
          "--size 0: must be positive");
  refused({file, "--plane", "0", "0", "1", "--size", "2", "3", "--frequency", "blue"}, "--frequency: ");
  refused({file, "--plane", "0", "0", "1", "--size", "2", "3", "--frequency", "3.5"}, "with its unit");
  refused({scene(kBand), "--frequency", "3GHz"}, "--frequency: is for maps by --plane");
  folder.write("cheese.xml", "<scene version='3.0.0'><bsdf type='diffuse' id='mat-itu_cheese'/></scene>");
  refused({"cheese.xml", "--plane", "0", "0", "1", "--size", "2", "3", "--frequency", "3GHz"},
          "the id \"mat-itu_cheese\" names no building material");
}

TEST_F(PowerMapCommand, RefusesWhatItCannotMap) {
  refused({scene(kBand, "perspective")}, "measures no power at points");
  refused({scene("<film type='hdrfilm'>" + kSize + "</film>"), "--spp", "1"}, "channels are colours");
  refused({scene(kBand), "--power", "2V"}, "--power: \"2V\"");
  refused({scene(kBand), "--power", "-2"}, "no positive power");
  refused({scene(kBand), "--min-db", "3", "--max-db", "2"}, "less than --max-db");
  refused({scene(kBand), "--max-db", "nan"}, "--max-db nan");
  refused({scene(kBand), "--min-db=-inf"}, "--min-db -inf");
  refused({scene(kBand), "--min-db=-1e300"}, "--min-db -1e+300");
  refused({scene(kBand), "--min-db=-600", "--max-db", "600"}, "more than 1000 dB below");
  refused({scene(kBand), "-o", "map.png"}, ".exr file");
  refused({scene("<film type='hdrfilm'><string name='wavelength_min' value='3GHz'/></film>")}, "map.xml:1:");
}

}  // namespace
}  // namespace aureole::test

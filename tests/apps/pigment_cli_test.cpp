// SPDX-License-Identifier: Apache-2.0
// aureole pigment as a user meets it: tables in, palettes and recipes out, and wrong input with its place,
// exit code 2 and nothing written.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

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
  ASSERT_EQ(run("fit kimera -o paints.csv --json fit.json --plot fit.svg"), 0) << said;
  EXPECT_NE(said.find("13 paints, 75 measurements"), std::string::npos) << said;
  const auto fit = json("fit.json");
  EXPECT_EQ(fit["pigments"].size(), 13u);
  for (const auto& p : fit["pigments"]) EXPECT_EQ(p["fit"]["negative_s"], 0) << p["name"];
  // A repeat of a tint is predicted by the others; the limit is how far three measurements of one card
  // differ.
  EXPECT_LT(fit["left_out"]["mixtures"]["mean"], 1.0);
  EXPECT_TRUE(fs::exists(folder.path / "fit.svg"));

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
  write("white.json", R"({"unit": "percent", "wavelengths_nm": [400, 700], "samples": [
    {"paints": "chalk", "values": [90, 90]}, {"paints": "red", "values": [30, 50]}, {"paints": {"red": 1, "chalk": 3}, "values": [50, 70]}]})");
  ASSERT_EQ(run("fit white.json --white chalk"), 0) << said;
  EXPECT_NE(said.find("2 paints, 3 measurements"), std::string::npos) << said;
}

TEST_F(PigmentCli, WrongInputHasItsPlace) {
  fails("fit missing.csv", "missing.csv: cannot read this file");
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

}  // namespace
}  // namespace aureole::test

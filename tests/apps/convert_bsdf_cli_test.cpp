// SPDX-License-Identifier: Apache-2.0
// aureole convert-bsdf as a user meets it: materials in, files of all formats out, and wrong input with its place, exit
// code 2 and nothing written.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdio>
#include <filesystem>
#include <fstream>

#include "harness/paths.h"
#include "loading/load_text.h"

namespace aureole::test {
namespace {

namespace fs = std::filesystem;

class ConvertBsdfCli : public ::testing::Test {
protected:
  ConvertBsdfCli() {
    write("materials.xml", R"(<scene version="3.0.0">
      <bsdf type="roughconductor" id="metal"><float name="alpha" value="0.3"/></bsdf>
      <bsdf type="thindielectric" id="pane"/>
      <bsdf type="diffuse" id="black"><float name="reflectance" value="0"/></bsdf></scene>)");
  }
  /// Runs `aureole convert-bsdf ARGUMENTS` in the test's folder; its output is in `said`.
  int run(const std::string& arguments) {
    const fs::path log = folder.path / "log.txt";
    const int status = std::system(("cd '" + folder.path.string() + "' && '" + aureole_binary().string() +
                                    "' convert-bsdf " + arguments + " > '" + log.string() + "' 2>&1")
                                       .c_str());
    std::ifstream in(log);
    said.assign(std::istreambuf_iterator<char>(in), {});
    return WEXITSTATUS(status);
  }
  void write(const std::string& name, const std::string& text) { std::ofstream(folder.path / name) << text; }
  void fails(const std::string& arguments, const std::string& message) {
    EXPECT_EQ(run(arguments), 2) << arguments;
    EXPECT_NE(said.find(message), std::string::npos) << arguments << "\n" << said;
  }

  TemporaryFolder folder;
  std::string said;
};

TEST_F(ConvertBsdfCli, EachFormatIsWrittenAndReadAgain) {
  ASSERT_EQ(
      run("materials.xml#metal metal.bsdf --angles 6 --resolution 8 --normals 32 --range 400,700 --step 100"),
      0)
      << said;
  EXPECT_NE(said.find("isotropic"), std::string::npos) << said;
  ASSERT_EQ(run("metal.bsdf metal.csv --angles 4 --step 100"), 0) << said;
  EXPECT_NE(said.find("known from 400 to 700 nm"), std::string::npos) << said;
  ASSERT_EQ(run("metal.csv metal.xml --basis quarter --samples 64"), 0) << said;
  ASSERT_EQ(run("metal.xml metal.zmx --format zemax"), 0) << said;
  std::ifstream in(folder.path / "metal.zmx");
  const std::string zemax{std::istreambuf_iterator<char>(in), {}};
  EXPECT_NE(zemax.find("ScatterType  "), std::string::npos);
  EXPECT_NE(zemax.find("DataEnd"), std::string::npos);
}

TEST_F(ConvertBsdfCli, WhatAFormatCannotHoldIsSaid) {
  ASSERT_EQ(run("materials.xml#pane pane.xml --basis quarter --samples 64"), 0) << said;
  EXPECT_EQ(said.find("left out"), std::string::npos) << said;
  ASSERT_EQ(run("materials.xml#pane pane.csv --angles 3"), 0) << said;
  EXPECT_NE(said.find("delta lobes (mirrors, clear glass) have no finite values"), std::string::npos) << said;
  fails("materials.xml#pane pane.bsdf", "by delta lobes alone");
  EXPECT_FALSE(fs::exists(folder.path / "pane.bsdf"));
}

TEST_F(ConvertBsdfCli, WrongInputWritesNothing) {
  fails("materials.xml#metal out.tiff", "the ending says what is written");
  fails("materials.xml#mettal out.csv", "did you mean \"metal\"");
  fails("materials.xml out.csv", "name a material of a scene as scene.xml#id");
  fails("missing.bsdf out.csv", "no such file");
  write("broken.bsdf", "tensor_file");
  fails("broken.bsdf out.csv", "broken.bsdf");
  write("broken.csv", "theta_i,theta_o,f\n0,0,x\n");
  fails("broken.csv out.xml", "broken.csv:2:5");
  fails("materials.xml#black out.bsdf", "reflects nothing");
  fails("materials.xml#metal out.csv --range 200,500", "the scene has wavelengths from 360 to 830 nm");
  for (const char* name : {"out.tiff", "out.csv", "out.xml", "out.bsdf"})
    EXPECT_FALSE(fs::exists(folder.path / name)) << name;
}

}  // namespace
}  // namespace aureole::test

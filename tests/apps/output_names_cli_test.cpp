// SPDX-License-Identifier: Apache-2.0
// Names of outputs on the command line: two outputs of one file, outputs that would replace what is read, and empty values are
// errors before anything is written.
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "aureole/core/image.h"
#include "harness/paths.h"
#include "harness/program.h"
#include "loading/load_text.h"

namespace aureole::test {
namespace {

namespace fs = std::filesystem;

const std::string kOutputPanel =
    "IESNA:LM-63-2002\nTILT=NONE\n1 1000 1 3 1 1 2 0.6 0.6 0\n1 1 12\n0 45 90\n0\n300 250 0\n";

class OutputNames : public ::testing::Test {
protected:
  OutputNames() {
    folder.write("lamp.ies", kOutputPanel);
    folder.write(
        "m.xml",
        "<scene version='3.0.0'><bsdf type='diffuse' id='grey'/><medium type='homogeneous' id='fog'/></scene>");
    folder.write(
        "grid.xml",
        "<scene version='3.0.0'><integrator type='direct'/><sensor type='powermap'>"
        "<film type='hdrfilm'><integer name='width' value='4'/><integer name='height' value='2'/>"
        "<string name='quantity' value='illuminance'/></film><sampler type='sobol'><integer name='sample_count' value='1'/></sampler>"
        "</sensor><shape type='sphere'><point name='center' x='0' y='0' z='-30'/></shape>"
        "<emitter type='directional'><vector name='direction' x='0' y='0' z='-1'/><string name='amount' value='2 klx'/></emitter></scene>");
  }
  int run(const std::vector<std::string>& arguments) {
    const ProgramEnd end = run_program(folder.path, arguments);
    output = end.output;
    return end.exit_code;
  }
  void refused(const std::vector<std::string>& arguments, const std::string& message) {
    const auto before = files();
    EXPECT_EQ(run(arguments), 2) << arguments[0] << ": " << output;
    EXPECT_NE(output.find(message), std::string::npos) << "expected \"" << message << "\" in: " << output;
    EXPECT_EQ(files(), before) << arguments[0];
  }
  /// The content of each file of the folder but the log of the program.
  std::map<std::string, std::string> files() const {
    std::map<std::string, std::string> all;
    for (const auto& entry : fs::recursive_directory_iterator(folder.path))
      if (entry.path().filename() != "log.txt")
        all[entry.path().lexically_relative(folder.path).string()] =
            entry.is_regular_file() ? file_content(entry.path()) : "";
    return all;
  }
  TemporaryFolder folder;
  std::string output;
};

TEST_F(OutputNames, TwoOutputsOfOneFileAreAnError) {
  const std::vector<std::vector<std::string>> commands{
      {"ugr", "lamp.ies", "--csv", "x", "--plot", "./x"},
      {"medium", "m.xml#fog", "--json", "x", "--plot", "x"},
      {"spectrophotometer", "m.xml#grey", "--json", "x", "--plot", "x"},
      {"goniometer", "m.xml#grey", "--json", "x", "--plot", "x"},
      {"spectroradiometer", "A", "--json", "x", "--plot", "x"},
      {"illumination", "grid.xml", "-o", "x", "--map", "x"},
      {"pigment", "hide", "kimera", "white", "--json", "x", "--plot", "x"}};
  for (const auto& words : commands) refused(words, ", too");
  // Names that commands derive: the .exr beside a .png, and the field of a light field.
  refused({"photometry", "grid.xml", "-o", "x.png", "--csv", "x.exr"},
          "the picture of -o x.exr: is the file of --csv, too");
  refused({"photometry", "grid.xml", "-o", "x.png", "--csv", "x.png"}, "-o x.png: is the file of --csv, too");
  refused({"lightfield", "grid.xml", "-o", "x.exr", "--field", "x.exr"}, "is the file of -o, too");
  refused({"expose", "grid.xml", "-o", "x.tif", "-o", "x.tif"}, "is the file of -o, too");
  refused({"goniophotometer", "lamp.ies", "-o", "x.ies", "-o", "x.ies"},
          "--output x.ies: is the file of --output, too");
  // A link to a file is that file; a device takes any number of outputs.
  fs::create_symlink("linked.csv", folder.path / "link.csv");
  folder.write("linked.csv", "");
  refused({"ugr", "lamp.ies", "--csv", "linked.csv", "--plot", "link.csv"}, ", too");
  EXPECT_EQ(run({"ugr", "lamp.ies", "-q", "--csv", "/dev/null", "--plot", "/dev/null"}), 0) << output;
}

TEST_F(OutputNames, WhatIsReadIsNotReplaced) {
  refused({"ugr", "lamp.ies", "--csv", "lamp.ies"},
          "--csv lamp.ies: would replace the target, which is read; write to another name");
  refused({"goniophotometer", "lamp.ies", "--plot", "./lamp.ies"}, "would replace the target");
  refused({"goniophotometer", "lamp.ies", "-o", "lamp.ies"}, "would replace the target");
  const std::string scene = file_content(folder.path / "m.xml");
  refused({"layer", "m.xml#grey", "--json", "m.xml"}, "would replace the target");
  EXPECT_EQ(file_content(folder.path / "m.xml"), scene);
  ASSERT_EQ(run({"photometry", "grid.xml", "-o", "a.png", "-q"}), 0) << output;
  const std::string picture = file_content(folder.path / "a.exr");
  refused({"photometry", "a.exr", "-o", "b.png", "--csv", "a.exr"}, "would replace the target");
  refused({"photometry", "a.exr", "--scene", "grid.xml", "-o", "b.png", "--csv", "grid.xml"},
          "would replace --scene");
  EXPECT_EQ(file_content(folder.path / "a.exr"), picture);
}

TEST_F(OutputNames, FilesOfASceneStay) {
  // The picture beside the .exr has the name of a texture.
  ASSERT_EQ(run({"photometry", "grid.xml", "-o", "t.png", "-q"}), 0) << output;
  const std::string texture = file_content(folder.path / "t.png");
  std::string scene = file_content(folder.path / "grid.xml");
  scene.replace(
      scene.find("</shape>"), 0,
      "<bsdf type='diffuse'><texture type='bitmap' name='reflectance'><string name='filename' value='t.png'/></texture></bsdf>");
  folder.write("painted.xml", scene);
  refused({"render", "painted.xml", "-o", "t.exr"},
          "the preview of -o t.png: would replace a file of the scene, which is read");
  refused({"photometry", "painted.xml", "-o", "t.png"}, "-o t.png: would replace a file of the scene");
  refused({"powermap", "painted.xml", "-o", "t.exr"}, "would replace a file of the scene");
  refused({"illumination", "painted.xml", "--map", "t.png"},
          "--map t.png: would replace a file of the scene");
  EXPECT_EQ(file_content(folder.path / "t.png"), texture);
  EXPECT_EQ(run({"render", "painted.xml", "-o", "u.exr", "-q"}), 0) << output;
}

TEST_F(OutputNames, PositionalOutputsAreOutputs) {
  refused({"convert-bsdf", "m.xml#grey", "m.xml"}, "output m.xml: would replace the input");
  // An output that cannot be written is an error before the report of the conversion is computed and printed.
  refused({"convert-bsdf", "m.xml#grey", "missing/x.bsdf"}, "missing/x.bsdf");
  EXPECT_EQ(output.find("m.xml#grey ("), std::string::npos) << output;
  ASSERT_EQ(run({"convert-bsdf", "m.xml#grey", "grey.csv", "--angles", "3", "--step", "200"}), 0) << output;
  refused({"convert-bsdf", "grey.csv", "./grey.csv"}, "would replace the input");
}

TEST_F(OutputNames, FilesOfAMeasuredSceneStay) {
  const std::string lamp = "<emitter type='photometric'><string name='filename' value='lamp.ies'/></emitter>";
  folder.write("luminaire.xml", "<scene version='3.0.0'>" + lamp + "</scene>");
  refused({"goniophotometer", "luminaire.xml", "--spp", "1", "-o", "lamp.ies"},
          "--output lamp.ies: would replace a file of the scene");
  refused({"ugr", "luminaire.xml", "--spp", "1", "--opening", "1", "1", "0", "-o", "lamp.ies"},
          "would replace a file of the scene");
  // Files that a scene includes are read as well.
  folder.write("lamp.xml", "<scene version='3.0.0'>" + lamp + "</scene>");
  std::string scene = file_content(folder.path / "grid.xml");
  scene.replace(scene.find("<sensor"), 0, "<include filename='lamp.xml'/>");
  folder.write("main.xml", scene);
  refused({"photometry", "main.xml", "--csv", "lamp.xml"},
          "--csv lamp.xml: would replace a file of the scene");
  folder.write("fog.xml", "<scene version='3.0.0'><include filename='m.xml'/></scene>");
  refused({"medium", "fog.xml#fog", "--json", "m.xml"}, "would replace a file of the scene");
  refused({"layer", "fog.xml#grey", "--json", "m.xml"}, "would replace a file of the scene");
  refused({"goniometer", "fog.xml#grey", "--json", "m.xml"}, "would replace a file of the scene");
  refused({"spectrophotometer", "fog.xml#grey", "--json", "m.xml"}, "would replace a file of the scene");
  folder.write(
      "square.ply",
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  folder.write("mesh.xml",
               "<scene version='3.0.0'><sensor type='perspective'/><emitter type='constant'/>"
               "<shape type='ply'><string name='filename' value='square.ply'/></shape></scene>");
  refused({"bake", "mesh.xml", "--to", "pointcloud", "--count", "4", "-o", "square.ply"},
          "-o square.ply: would replace a file of the scene");
  // The scene of a picture has files, too.
  ASSERT_EQ(run({"photometry", "grid.xml", "-o", "t.png", "-q"}), 0) << output;
  scene.replace(
      scene.find("</shape>"), 0,
      "<bsdf type='diffuse'><texture type='bitmap' name='reflectance'><string name='filename' value='t.png'/></texture></bsdf>");
  folder.write("painted.xml", scene);
  refused({"photometry", "t.exr", "--scene", "painted.xml", "--glare", "-o", "t.png"},
          "-o t.png: would replace a file of the scene");
}

TEST_F(OutputNames, InputsThatOptionsNameStay) {
  ASSERT_EQ(run({"photometry", "grid.xml", "-o", "a.png", "-q"}), 0) << output;
  ASSERT_EQ(run({"photometry", "grid.xml", "-o", "b.png", "-q"}), 0) << output;
  refused({"convert", "a.exr", "--difference", "b.exr", "-o", "b.exr"},
          "--output b.exr: would replace --difference");
  folder.write("light.csv", "400 1\n700 1\n");
  refused({"color", "#102030", "--illuminant", "light.csv", "--json", "light.csv"},
          "--json light.csv: would replace --illuminant");
  folder.write("camera.json", "{\"bits\": 12}");
  folder.write("table.csv", "400 0.5\n700 0.5\n");
  refused({"expose", "grid.xml", "--camera", "camera.json", "--electrons", "camera.json"},
          "would replace --camera");
  refused({"expose", "grid.xml", "--efficiency", "table.csv", "--electrons", "table.csv"},
          "would replace --efficiency");
  refused({"pigment", "colour", "table.csv", "--standard", "camera.json#1", "--json", "camera.json"},
          "would replace --standard");
}

TEST_F(OutputNames, APictureIsConvertedInPlace) {
  ASSERT_EQ(run({"photometry", "grid.xml", "-o", "a.png", "-q"}), 0) << output;
  const float before = read_image(folder.path / "a.exr").pixels[0];
  ASSERT_GT(before, 0);
  ASSERT_EQ(run({"convert", "a.exr", "--exposure", "1", "-o", "./a.exr"}), 0) << output;
  EXPECT_FLOAT_EQ(read_image(folder.path / "a.exr").pixels[0], 2 * before);
}

TEST_F(OutputNames, EmptyValuesAreErrors) {
  refused({"ugr", "lamp.ies", "--csv", ""}, "--csv: needs a value");
  refused({"goniophotometer", "lamp.ies", "--flux", ""}, "--flux: needs a value");
  refused({"goniophotometer", "lamp.ies", "-o", ""}, "needs a value");
  refused({"goniophotometer", ""}, "target: needs a value");
  refused({"render", "grid.xml", "--spp", ""}, "--spp: needs a value");
}

TEST_F(OutputNames, ExtensionsInAnyCase) {
  ASSERT_EQ(run({"photometry", "grid.xml", "-o", "a.PNG", "-q"}), 0) << output;
  ASSERT_EQ(run({"photometry", "a.exr", "-o", "b.Png", "-q"}), 0) << output;
  EXPECT_EQ(file_content(folder.path / "a.PNG"), file_content(folder.path / "b.Png"));
  ASSERT_EQ(run({"goniophotometer", "lamp.ies", "-o", "a.LDT", "-q"}), 0) << output;
  ASSERT_EQ(run({"goniophotometer", "a.LDT", "-o", "b.Ies", "-q"}), 0) << output;
  EXPECT_TRUE(file_content(folder.path / "b.Ies").starts_with("IES:LM-63"));
  ASSERT_EQ(run({"render", "grid.xml", "-o", "c.EXR", "-q"}), 0) << output;
  EXPECT_EQ(read_image(folder.path / "c.EXR").width, 4);
  ASSERT_EQ(run({"render", "grid.xml", "-o", "d.exr", "--samples", "0:1", "-q"}), 0) << output;
  fs::copy(folder.path / "d.state", folder.path / "e.STATE");
  EXPECT_EQ(run({"info", "e.STATE"}), 0) << output;
  refused({"merge", "d.exr.STATE", "-o", "m.exr"}, "the state of d.exr is d.state");
}

// Values that commands used to take for options that are not given.
TEST_F(OutputNames, NumbersBelowTheirRangeAreErrors) {
  for (const char* command : {"photometry", "illumination", "powermap", "lightfield", "expose", "render"}) {
    refused({command, "grid.xml", "--spp", "-1"}, "--spp -1: at least one sample");
    refused({command, "grid.xml", "--spp", "0"}, "--spp 0: at least one sample");
    refused({command, "grid.xml", "--seed", "-1"}, "--seed -1: must not be negative");
    refused({command, "grid.xml", "--threads", "-4"}, "--threads -4: must be between 1 and 4096");
    refused({command, "grid.xml", "--threads", "100000"}, "--threads 100000: must be between 1 and 4096");
  }
  for (const char* command : {"spectrophotometer", "goniometer"}) {
    refused({command, "m.xml#grey", "--threads", "-4"}, "--threads -4: must be between 1 and 4096");
    refused({command, "m.xml#grey", "--seed", "-1"}, "-1 is negative");
  }
}

}  // namespace
}  // namespace aureole::test

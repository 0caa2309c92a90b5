// SPDX-License-Identifier: Apache-2.0
// aureole microstructure and droplet-size as a user meets them: files in, files out, and for every kind of
// bad input a message, exit code 2 and nothing written.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "aureole/core/image.h"
#include "harness/paths.h"
#include "harness/program.h"
#include "instrument/microscopy/disc_pictures.h"
#include "instrument/microscopy/write_tiff.h"
#include "loading/load_text.h"
#include "render/small_scene.h"

namespace aureole::test {
namespace {

namespace fs = std::filesystem;

class InstrumentCli : public ::testing::Test {
protected:
  int run(const std::vector<std::string>& arguments) {
    const ProgramEnd end = run_program(folder.path, arguments);
    output = end.output;
    return end.exit_code;
  }
  /// Exit code 2, the message, and no output folder nor a part of one.
  void refused(std::vector<std::string> arguments, const std::string& message) {
    const bool writes = arguments[0] == "microstructure";
    if (writes) arguments.insert(arguments.end(), {"-o", "out"});
    EXPECT_EQ(run(arguments), 2) << output;
    EXPECT_NE(output.find(message), std::string::npos) << "expected \"" << message << "\" in: " << output;
    for (const auto& entry : fs::directory_iterator(folder.path))
      EXPECT_FALSE(entry.path().filename().string().starts_with("out"))
          << entry.path() << " was written; " << message;
  }
  Micrograph discs(unsigned seed, bool bright = false, int size = 400) {
    double side = 0;
    const auto d = hard_discs(0.4, 9, side, int(0.5 + 1.3 * size * size * 0.4 / (M_PI * 81)), seed, 100);
    PictureOptions p;
    p.width = p.height = size, p.seed = seed, p.bright = bright, p.levels = 65535;
    return picture_of(d, side, p);
  }
  void write_grey_png(const std::string& name, const Micrograph& m) {
    Image image;
    image.width = m.width, image.height = m.height, image.channels = {"Y"}, image.pixels = m.grey;
    write_png(folder.path / name, image);
  }
  std::string file(const std::string& name) { return (folder.path / name).string(); }
  TemporaryFolder folder;
  std::string output;
};

TEST_F(InstrumentCli, CoinsOfAPhotograph) {
  // 24 coins by eye, with reliefs that look like holes and light that fades from top to bottom.
  const fs::path coins = source_dir() / "tests/instrument/data/coins.png";
  ASSERT_EQ(run({"microstructure", coins.string(), "--pixel-size", "1um", "--fill-holes", "-o", "out"}), 0)
      << output;
  const auto j = nlohmann::json::parse(file_content(folder.path / "out/result.json"));
  EXPECT_EQ(int(j["fields"][0]["whole"]), 24);
  EXPECT_EQ(int(j["fields"][0]["cut"]), 0);
  EXPECT_TRUE(bool(j["shape"]["round"]));
  // The smallest coin is some 37, the largest some 65 pixels wide.
  EXPECT_NEAR(double(j["radius"]["mean_um"]["value"]), 23, 2);
  EXPECT_NEAR(double(j["covered_fraction"]["value"]), 0.33, 0.03);
  // Sizes differ: the material packs them together, and covers what the coins cover.
  std::string scene = small_scene_text();
  scene.insert(
      scene.rfind("</scene>"),
      "<include filename=\"out/scene.xml\"/><shape type=\"sphere\"><ref id=\"measured\"/></shape>\n");
  folder.write("scene.xml", scene);
  ASSERT_EQ(run({"layer", "scene.xml#measured", "--step", "200", "--json", "layer.json"}), 0) << output;
  const double fr = j["covered_fraction"]["value"];
  const auto layer = nlohmann::json::parse(file_content(folder.path / "layer.json"));
  EXPECT_NEAR(double(layer["cie"]["direct_transmission"]["Y"]), fr * fr, 0.003);
  EXPECT_NEAR(double(layer["cie"]["total_transmission"]["Y"]), fr, 0.006);
}

TEST_F(InstrumentCli, Layer) {
  std::string scene = small_scene_text();
  scene.insert(scene.rfind("</scene>"), R"(<shape type="sphere" id="ball"><bsdf type="twosided" id="both">
    <bsdf type="diffuse" id="inner"><float name="reflectance" value="0.3"/></bsdf></bsdf></shape>)");
  folder.write("scene.xml", scene);
  for (const char* id : {"ball", "both", "inner"}) {
    ASSERT_EQ(run({"layer", std::string("scene.xml#") + id, "--step", "100", "--json", "layer.json"}), 0)
        << output;
    const auto j = nlohmann::json::parse(file_content(folder.path / "layer.json"));
    EXPECT_NEAR(double(j["cie"]["total_reflection"]["Y"]), 0.3, 1e-3);
    EXPECT_NEAR(double(j["cie"]["total_reflection"]["x"]), 0.3127, 1e-3);
    EXPECT_NEAR(double(j["wavelengths"][1]["lost"]), 0.7, 1e-3);
  }
  refused({"layer", "scene.xml#bal"}, "there are");
  refused({"layer", "scene.xml"}, "name a BSDF or a shape after \"#\"");
  refused({"layer", "missing.xml#ball"}, "missing.xml");
  refused({"layer", "scene.xml#ball", "--illuminant", "D66"}, "unknown illuminant");
  refused({"layer", "scene.xml#ball", "--angle", "200"}, "--angle");
}

TEST_F(InstrumentCli, LayerOfAFileWithoutSensor) {
  // Neither a sensor nor a shape; one BSDF within another, and a second name.
  folder.write("material.xml", R"(<scene version="3.0.0">
    <bsdf type="twosided" id="both"><bsdf type="diffuse" id="inner"><float name="reflectance" value="0.3"/></bsdf></bsdf>
    <alias id="both" as="other"/>
    <medium type="homogeneous" id="fog"><float name="sigma_t" value="2"/></medium></scene>)");
  for (const char* id : {"both", "inner", "other"}) {
    ASSERT_EQ(run({"layer", std::string("material.xml#") + id, "--step", "100", "--json", "layer.json"}), 0)
        << output;
    const auto j = nlohmann::json::parse(file_content(folder.path / "layer.json"));
    EXPECT_NEAR(double(j["cie"]["total_reflection"]["Y"]), 0.3, 1e-3);
  }
  refused({"layer", "material.xml#iner"}, "did you mean \"inner\"?; there are both, inner, other");
  refused({"layer", "material.xml#fog"}, "no BSDF or shape has the id \"fog\"");
  ASSERT_EQ(run({"medium", "material.xml"}), 0) << output;
  EXPECT_NE(output.find("material.xml (homogeneous)"), std::string::npos) << output;
  // No shape uses the medium; albedo 0.75 is the default of Mitsuba.
  ASSERT_EQ(run({"medium", "material.xml#fog", "--length", "1m", "--json", "fog.json"}), 0) << output;
  const nlohmann::json fog = nlohmann::json::parse(file_content(folder.path / "fog.json"));
  for (const auto& row : fog["wavelengths"]) {
    EXPECT_NEAR(double(row["optical_density"]), 2 / std::log(10), 1e-6);
    EXPECT_NEAR(double(row["absorbance"]), 0.5 / std::log(10), 1e-6);
  }
  refused({"medium", "material.xml#foog"}, "did you mean \"fog\"");
  refused({"medium", "material.xml#both"}, "no medium has the id \"both\"");
  // A scene with a sensor and a BSDF that no shape uses.
  std::string scene = small_scene_text();
  scene.insert(scene.rfind("</scene>"), "<include filename=\"material.xml\"/>");
  folder.write("scene.xml", scene);
  EXPECT_EQ(run({"layer", "scene.xml#inner", "--step", "100"}), 0) << output;
  // Rendering still needs a sensor.
  refused({"info", "material.xml"}, "the scene has no <sensor>");
  folder.write("wrong.xml",
               R"(<scene version="3.0.0"><bsdf type="diffuse" id="a"><float name="reflectance" value="3"/>
    </bsdf></scene>)");
  refused({"layer", "wrong.xml#a"}, "wrong.xml:1:");
}

TEST_F(InstrumentCli, OutputsGoToTheWorkingFolder) {
  folder.write("scenes/small.xml", small_scene_text(8, 6));
  const auto files = [&](const fs::path& in) {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(in)) names.push_back(entry.path().filename().string());
    std::sort(names.begin(), names.end());
    return names;
  };
  const std::vector<std::string> only{"small.xml"};
  ASSERT_EQ(run({"render", "scenes/small.xml", "--spp", "1"}), 0) << output;
  EXPECT_NE(output.find("\nsmall.exr\nsmall.png\n"), std::string::npos) << output;
  EXPECT_TRUE(fs::exists(folder.path / "small.exr") && fs::exists(folder.path / "small.png"));
  // The state of a part, too, and a render resumes from there.
  ASSERT_EQ(run({"render", "scenes/small.xml", "--samples", "0:16"}), 0) << output;
  EXPECT_TRUE(fs::exists(folder.path / "small.state"));
  EXPECT_EQ(run({"render", "scenes/small.xml", "--samples", "0:16"}), 2) << output;
  EXPECT_NE(output.find("small.state: holds the samples of an earlier job"), std::string::npos) << output;
  EXPECT_EQ(run({"render", "scenes/small.xml", "--samples", "0:16", "--resume"}), 0) << output;
  EXPECT_EQ(files(folder.path / "scenes"), only);
  folder.write("scenes/map.xml",
               R"(<scene version="3.0.0"><integrator type="ptracer"/><sensor type="powermap">
    <film type="hdrfilm"><integer name="width" value="2"/><integer name="height" value="2"/>
    <string name="response" value="uniform"/></film></sensor><emitter type="point"><point name="position" x="0" y="0" z="2"/></emitter></scene>)");
  ASSERT_EQ(run({"powermap", "scenes/map.xml", "--spp", "16"}), 0) << output;
  EXPECT_TRUE(fs::exists(folder.path / "map.exr") && fs::exists(folder.path / "map.png"));
  EXPECT_EQ(files(folder.path / "scenes").size(), 2u);
  ASSERT_EQ(run({"info", "map.exr"}), 0) << output;
  EXPECT_NE(output.find("power density without any shape, W/m^2"), std::string::npos) << output;
}

/// `aureole info` of the renderer's own pictures: where they come from, noise, state, and what the channels hold.
TEST_F(InstrumentCli, InfoOfRenderedPictures) {
  std::string scene = small_scene_text(8, 6);
  scene.insert(scene.find("<integrator"),
               "<integrator type=\"aov\"><string name=\"aovs\" value=\"dd:depth, nn:sh_normal\"/>");
  scene.insert(scene.find("</integrator>"), "</integrator>");
  folder.write("scene.xml", scene);
  const auto says = [&](const std::string& text) {
    EXPECT_NE(output.find(text), std::string::npos) << "expected \"" << text << "\" in: " << output;
  };
  ASSERT_EQ(run({"render", "scene.xml", "-o", "a.exr", "--samples", "0:16", "--replicates", "2", "-q"}), 0)
      << output;
  ASSERT_EQ(run({"render", "scene.xml", "-o", "b.exr", "--samples", "16:32", "--replicates", "2", "-q"}), 0)
      << output;
  ASSERT_EQ(run({"merge", "a.state", "b.state", "-o", "sum.exr"}), 0) << output;
  ASSERT_EQ(run({"info", "sum.exr"}), 0) << output;
  says("picture      sum.exr (EXR, 32-bit float, ZIP compression)\nsize         8 x 6 pixels, 24 channels\n");
  says("scene        scene.xml (hash ");
  says(
      "integrator aov, sampler sobol, seed 0, 8 wavelengths per path\nestimates    Further channels of the picture");
  says("samples      32 per pixel, of the range 0:32, in ");
  says("noise        variances of the mean of 2 replicates");
  says("state        sum.state is beside it");
  says("colours      linear, primaries stated: sRGB\n");
  says("  distance along the ray from the near clip plane, scene units\n");
  says("  shading normal in the world, unit vector\n");
  says("  variance of the mean over replicates of dd.T\n");
  says("  alpha: 1 where shapes or a visible environment are, 0 where nothing is\n");
  EXPECT_EQ(output.find("not stated"), std::string::npos) << output;
  ASSERT_EQ(run({"info", "a.state"}), 0) << output;
  says("samples      0:16 of each pixel, 100.0 % done");
  fs::remove(folder.path / "sum.state");
  ASSERT_EQ(run({"info", "sum.exr"}), 0) << output;
  says("state        none beside it");
  ASSERT_EQ(run({"info", "a.png"}), 0) << output;
  says("PNG, 8 bits per channel");
  says("red, sRGB-encoded");
}

TEST_F(InstrumentCli, InfoOfOtherFiles) {
  const auto says = [&](const std::string& text) {
    EXPECT_NE(output.find(text), std::string::npos) << "expected \"" << text << "\" in: " << output;
  };
  Image image{2, 1, {"R", "G", "B", "Z", "diffuse.R", "S0.550,00nm", "odd"}, {}, false};
  for (int i = 0; i < 14; ++i) image.pixels.push_back(float(i));
  image.pixels[6] = INFINITY;
  write_exr(folder.path / "other.exr", image, ExrPixel::half,
            {{{"comments", "line\none"}}, {{"frame", 7}}, {}});
  ASSERT_EQ(run({"info", "other.exr"}), 0) << output;
  says("EXR, 16-bit float, ZIP compression");
  says("attribute    comments = line one\n");
  says("attribute    frame = 7\n");
  says("depth, by the conventions of EXR");
  says("red of the layer diffuse, linear");
  says("spectral radiance of the bin around 550,00 nm");
  says("not stated; 1 pixels are not finite");
  EXPECT_EQ(output.find("rendered by"), std::string::npos) << output;
  folder.write("bright.hdr",
               std::string("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\nEXPOSURE=2\n\n-Y 1 +X 1\n\x80\x80\x80\x81"));
  ASSERT_EQ(run({"info", "bright.hdr"}), 0) << output;
  says("bright.hdr: values are divided by EXPOSURE");
  says("Radiance HDR, RGBE");
  says("primaries not stated");
  write_pfm(folder.path / "grey.pfm", {1, 1, {"Y"}, {0.5f}, false});
  ASSERT_EQ(run({"info", "grey.pfm"}), 0) << output;
  says("PFM, 32-bit float");
  says("1 x 1 pixels, 1 channel\n");
  ASSERT_EQ(run({"info", (test::source_dir() / "tests/volume/data/heads/slope.nii").string()}), 0) << output;
  says("(NIfTI-1)");
  says("5 x 4 x 3 voxels, 1 number each\n");
  says("int16, times 0.5 plus 7.25");
  says("0.9 x 1.1 x 2.5 mm\n");
  says("(-31.5, 12.25, 77) mm, centre of the first voxel, in RAS coordinates (the file's are RAS)");
  says("x along (0.906308, 0.422618, 0.000000)");
  says("7.25 to 192.25");
  // Neither, with and without the extension of a picture.
  folder.write("notes.txt", "no picture");
  refused({"info", "notes.txt"}, "notes.txt: is neither a scene file (XML) nor a picture");
  folder.write("empty", "");
  refused({"info", "empty"}, "is neither");
  folder.write("broken.tga", "no picture");
  refused({"info", "broken.tga"}, "broken.tga: unknown or damaged image");
  folder.write("broken.state", "no state");
  refused({"info", "broken.state"}, "broken.state: is not a complete state file");
  refused({"info", "grey.pfm", "-D", "a=1"}, "not a scene file");
  refused({"info", "missing.exr"}, "missing.exr: no such file");
  // A scene of any name.
  folder.write("scene.txt", "  \n" + small_scene_text(8, 6));
  ASSERT_EQ(run({"info", "scene.txt"}), 0) << output;
  says("integrator   path");
}

TEST_F(InstrumentCli, OptionsLeavePositionalArguments) {
  std::string scene = small_scene_text();
  scene.insert(scene.rfind("</scene>"),
               R"(<default name="grey" value="0.2"/><medium type="homogeneous" id="fog"/>
    <bsdf type="diffuse" id="grey"><float name="reflectance" value="$grey"/></bsdf>)");
  folder.write("scene.xml", scene);
  EXPECT_EQ(run({"layer", "--step", "200", "--at", "0.5", "0.5", "scene.xml#grey"}), 0) << output;
  EXPECT_EQ(run({"layer", "--step", "200", "--at", "0.5,0.5", "scene.xml#grey"}), 0) << output;
  EXPECT_EQ(run({"layer", "--step", "200", "-D", "grey=0.5", "scene.xml#grey"}), 0) << output;
  EXPECT_EQ(run({"medium", "--at", "0", "0", "0", "--along", "0", "0", "1", "scene.xml#fog"}), 0) << output;
  EXPECT_EQ(run({"medium", "--at", "0,0,0", "--along", "0,0,-1", "scene.xml#fog"}), 0) << output;
  refused({"layer", "--at", "0.5", "--step", "200", "scene.xml#grey"}, "--at");
  refused({"rings", "--at", "80", "60", "missing.exr"}, "missing.exr");
  refused({"rings", "--azimuths", "300", "60", "missing.exr"}, "missing.exr");
  refused({"powermap", "--min-db", "-30", "--max-db", "10", "missing.xml"}, "missing.xml");
  refused({"gallery", "--only", "fig08,fig09", "missing"}, "missing");
  refused({"pigment", "match", "--others", "A,F11", "missing.csv", "#808080"}, "missing.csv");
}

/// A micrograph of dark beads in bright field: the material blocks light where they are.
TEST_F(InstrumentCli, DarkBeadsAreOpaqueDiscs) {
  struct Kind {
    bool bright;
    const char *name, *note;
  };
  for (const Kind& k : {Kind{false, "discs", "the material has opaque discs"},
                        Kind{true, "apertures", "the material is an opaque sheet with openings"}}) {
    write_grey_png("a.png", discs(6, k.bright, 900));
    ASSERT_EQ(run({"microstructure", "a.png", "--pixel-size", "200nm", "-o", "out"}), 0) << output;
    EXPECT_NE(output.find(k.note), std::string::npos) << output;
    EXPECT_NE(
        output.find(std::string("note: particles are taken to be the ") + (k.bright ? "bright" : "dark")),
        std::string::npos)
        << output;
    const auto result = nlohmann::json::parse(file_content(folder.path / "out/result.json"));
    EXPECT_EQ(result["scatterer"], k.name);
    EXPECT_NE(result["choices"].dump().find(k.note), std::string::npos);
    const std::string scene = file_content(folder.path / "out/scene.xml");
    EXPECT_NE(scene.find(k.note), std::string::npos) << scene;
    EXPECT_EQ(scene.find("--", 4), scene.find("-->")) << "a comment of XML has no two hyphens";
    EXPECT_NE(scene.find(std::string("<string name=\"scatterer\" value=\"") + k.name), std::string::npos)
        << scene;
    // The haze is that of the discs as they were drawn: 9 pixels of 0.2 um.
    folder.write("truth.xml",
                 std::string(R"(<scene version="3.0.0"><bsdf type="correlated_scatterers" id="truth">
      <string name="radius" value="1.8um"/><float name="area_fraction" value="0.4"/>
      <string name="scatterer" value=")") +
                     k.name + R"("/></bsdf></scene>)");
    const auto layer = [&](const std::string& target) {
      EXPECT_EQ(run({"layer", target, "--step", "40", "--json", "layer.json"}), 0) << output;
      return nlohmann::json::parse(file_content(folder.path / "layer.json"))["cie"];
    };
    const auto measured = layer("out/scene.xml#measured"), truth = layer("truth.xml#truth");
    std::printf("%s: haze %.4f, drawn discs %.4f; direct %.4f, %.4f\n", k.name, double(measured["haze"]),
                double(truth["haze"]), double(measured["direct_transmission"]["Y"]),
                double(truth["direct_transmission"]["Y"]));
    std::fflush(stdout);  // or each child process would print it again
    EXPECT_NEAR(double(measured["haze"]), double(truth["haze"]), 0.01);
    EXPECT_NEAR(double(measured["direct_transmission"]["Y"]), k.bright ? 0.16 : 0.36, 0.02);
    EXPECT_NEAR(double(measured["total_transmission"]["Y"]), k.bright ? 0.4 : 0.6, 0.02);
  }
}

TEST_F(InstrumentCli, ScatterersAsAsked) {
  write_grey_png("a.png", discs(6));
  const std::vector<std::string> start{"microstructure", "a.png", "--pixel-size", "200nm", "-o", "out"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), start.begin(), start.end());
    return more;
  };
  ASSERT_EQ(run(with({"--polarity", "dark", "--scatterer", "apertures"})), 0) << output;
  EXPECT_EQ(output.find("the material"), std::string::npos) << output;
  EXPECT_EQ(output.find("taken to be"), std::string::npos) << output;
  EXPECT_NE(file_content(folder.path / "out/scene.xml").find("value=\"apertures\""), std::string::npos);

  for (const char* index : {"1.46", "water"}) {
    ASSERT_EQ(run(with({"--scatterer", "spheres", "--int-ior", index})), 0) << output;
    const std::string scene = file_content(folder.path / "out/scene.xml");
    EXPECT_NE(scene.find("<bsdf type=\"correlated_spheres\" id=\"measured\">"), std::string::npos) << scene;
    EXPECT_NE(scene.find(std::string("name=\"int_ior\" value=\"") + index), std::string::npos) << scene;
    const auto number_after = [&](const std::string& text) {
      return std::atof(scene.c_str() + scene.find(text) + text.size());
    };
    EXPECT_NEAR(number_after("name=\"radius\" value=\""), 1.8, 0.03);
    EXPECT_NEAR(number_after("name=\"area_fraction\" value=\""), 0.4, 0.03);
    EXPECT_EQ(run({"layer", "out/scene.xml#measured", "--step", "200"}), 0) << output;
  }
  fs::remove_all(folder.path / "out");
  refused({"microstructure", "a.png", "--pixel-size", "1um", "--scatterer", "spheres"},
          "--scatterer spheres needs --int-ior");
  refused({"microstructure", "a.png", "--pixel-size", "1um", "--scatterer", "spheres", "--int-ior", "watre"},
          "did you mean \"water\"?");
  refused({"microstructure", "a.png", "--pixel-size", "1um", "--scatterer", "spheres", "--int-ior", "-1"},
          "--int-ior");
  refused({"microstructure", "a.png", "--pixel-size", "1um", "--int-ior", "1.5"},
          "is for --scatterer spheres");
  refused({"microstructure", "a.png", "--pixel-size", "1um", "--scatterer", "disks"},
          "use auto, apertures, discs, spheres");
  // Two fields of which one has bright and one dark particles have no common kind.
  write_grey_png("b.png", discs(7, true));
  refused({"microstructure", "a.png", "b.png", "--pixel-size", "200nm"},
          "b.png: particles are bright, in a.png they are dark: give --polarity dark or bright");
  ASSERT_EQ(
      run({"microstructure", "a.png", "b.png", "--pixel-size", "200nm", "--scatterer", "discs", "-o", "out"}),
      0)
      << output;
  EXPECT_NE(output.find("--polarity decides for all"), std::string::npos) << output;
}

TEST_F(InstrumentCli, MicrostructureOfTiffs) {
  // 16 bits with ImageJ's tags and 8 bits with pixels per centimetre: both 0.2 um.
  write_grey_tiff(file("a.tif"), discs(1), 16, {"ImageJ=1.53t\nunit=micron\n", 5, RESUNIT_NONE});
  write_grey_tiff(file("b.tif"), discs(2), 8, {"", 50000, RESUNIT_CENTIMETER});
  ASSERT_EQ(run({"microstructure", "a.tif", "b.tif", "-o", "out"}), 0) << output;
  for (const char* name :
       {"result.json", "particles.csv", "sizes.txt", "structure_factor.txt", "pair_correlation.txt",
        "scene.xml", "radii.svg", "pair_correlation.svg", "structure_factor.svg"})
    EXPECT_GT(fs::file_size(folder.path / "out" / name), 50u) << name;
  const auto j = nlohmann::json::parse(file_content(folder.path / "out/result.json"));
  EXPECT_NEAR(double(j["area_fraction"]["value"]), 0.4, 0.02);
  EXPECT_LT(double(j["area_fraction"]["low"]), double(j["area_fraction"]["high"]));
  EXPECT_NEAR(double(j["radius"]["mean_um"]["value"]), 1.8, 0.03);
  EXPECT_NEAR(double(j["fields"][1]["pixel_um"]), 0.2, 1e-6);
  EXPECT_TRUE(bool(j["shape"]["round"]));
  EXPECT_GT(j["structure_factor"]["x"].size(), 30u);
  // One line for each particle and the head.
  const std::string table = file_content(folder.path / "out/particles.csv");
  const long lines = std::count(table.begin(), table.end(), '\n');
  EXPECT_EQ(lines, 1 + long(j["fields"][0]["whole"]) + long(j["fields"][0]["cut"]) +
                       long(j["fields"][1]["whole"]) + long(j["fields"][1]["cut"]));
  const Image overlay = read_image(folder.path / "out/overlay-1.png");
  EXPECT_EQ(overlay.width % 400, 0);

  // The material can be used as it is.
  std::string scene = small_scene_text();
  scene.insert(
      scene.rfind("</scene>"),
      "<include filename=\"out/scene.xml\"/><shape type=\"sphere\"><ref id=\"measured\"/></shape>\n");
  folder.write("scene.xml", scene);
  EXPECT_EQ(run({"info", "scene.xml"}), 0) << output;

  // A second run replaces the first; one that fails leaves it.
  ASSERT_EQ(run({"microstructure", "a.tif", "-o", "out"}), 0) << output;
  EXPECT_FALSE(fs::exists(folder.path / "out/overlay-1.png"));
  const std::string before = file_content(folder.path / "out/result.json");
  EXPECT_EQ(run({"microstructure", "a.tif", "missing.tif", "-o", "out"}), 2);
  EXPECT_EQ(file_content(folder.path / "out/result.json"), before);
  // A second run gives the same result to the last digit.
  ASSERT_EQ(run({"microstructure", "a.tif", "-o", "again"}), 0) << output;
  EXPECT_EQ(file_content(folder.path / "again/result.json"), before);
}

TEST_F(InstrumentCli, MicrostructureOptions) {
  write_grey_png("a.png", discs(3, true));
  Micrograph mask = discs(3);
  for (int y = 0; y < 400; ++y)
    for (int x = 0; x < 400; ++x) mask.grey[size_t(y) * 400 + size_t(x)] = x < 60 ? 0.f : 1.f;
  write_grey_png("mask.png", mask);
  ASSERT_EQ(
      run({"microstructure", "a.png", "--pixel-size", "200nm", "--polarity", "bright", "--mask", "mask.png",
           "--exclude", "300,0,100,80", "--exclude", "350,300,900,900", "-o", "out", "--no-overlays"}),
      0)
      << output;
  EXPECT_NE(output.find("bright on dark"), std::string::npos) << output;
  const auto j = nlohmann::json::parse(file_content(folder.path / "out/result.json"));
  EXPECT_NEAR(double(j["fields"][0]["seen_mm2"]), (340. * 400 - 100 * 80 - 50 * 100) * 0.04e-6, 1e-9);
  EXPECT_NEAR(double(j["radius"]["mean_um"]["value"]), 1.8, 0.03);
  EXPECT_FALSE(fs::exists(folder.path / "out/overlay-0.png"));
}

TEST_F(InstrumentCli, MicrostructureRefuses) {
  const Micrograph m = discs(4, false, 200);
  write_grey_png("a.png", m);
  write_grey_tiff(file("printer.tif"), m, 8, {"", 300, RESUNIT_INCH});
  write_grey_tiff(file("ome.tif"), m, 8,
                  {"<?xml version=\"1.0\"?><OME><Image><Pixels PhysicalSizeX=\"0.2\" "
                   "PhysicalSizeY=\"0.3\"/></Image></OME>"});
  Micrograph small = m;
  small.width = small.height = 20, small.grey.resize(400);
  write_grey_png("small.png", small);
  Micrograph black = m;
  for (float& v : black.grey) v = 0;
  write_grey_png("black.png", black);
  PictureOptions p;
  p.width = p.height = 200;
  write_grey_png("empty.png", picture_of({}, 1e4, p));
  write_grey_png("two.png", picture_of({{60, 70, 20, 0}, {140, 120, 20, 0}}, 1e4, p));
  folder.write("text.png", "this is no picture");
  folder.write("cut.tif", file_content(file("printer.tif")).substr(0, 3000));

  refused({"microstructure", "a.png"}, "a.png: does not say how large its pixels are");
  refused({"microstructure", "printer.tif"}, "printer.tif: does not say how large its pixels are");
  refused({"microstructure", "ome.tif"}, "ome.tif: the pixels are not square");
  refused({"microstructure", "missing.png", "--pixel-size", "1um"}, "missing.png: no such file");
  refused({"microstructure", "text.png", "--pixel-size", "1um"}, "text.png: ");
  refused({"microstructure", "cut.tif", "--pixel-size", "1um"}, "cut.tif: ");
  refused({"microstructure", "small.png", "--pixel-size", "1um"}, "20 x 20 pixels are too few");
  refused({"microstructure", "a.png", "--pixel-size", "0.2"}, "--pixel-size: \"0.2\" has no unit");
  refused({"microstructure", "a.png", "--pixel-size", "0.2furlong"}, "unknown unit");
  refused({"microstructure", "a.png", "--pixel-size", "0um"}, "\"0um\" is not positive");
  refused({"microstructure", "a.png", "--pixel-size=-1um"}, "is not positive");
  refused({"microstructure", "a.png", "--pixel-size", "1um", "--correlation-radius", "0um"},
          "is not positive");
  refused({"microstructure", "a.png", "--pixel-size", "1um", "--polarity", "drak"}, "did you mean \"dark\"?");
  refused({"microstructure", "a.png", "--pixel-size", "1um", "--mask", "black.png"},
          "the mask leaves nothing");
  refused({"microstructure", "a.png", "--pixel-size", "1um", "--mask", "small.png"},
          "the mask has 20 x 20 pixels");
  refused({"microstructure", "a.png", "--pixel-size", "1um", "--mask", "missing.png"}, "no such file");
  refused({"microstructure", "a.png", "--pixel-size", "1um", "--exclude", "1,2,3"}, "write x,y,width,height");
  refused({"microstructure", "a.png", "--pixel-size", "1um", "--exclude", "1,2,3,x"}, "is not a number");
  refused({"microstructure", "a.png", "--pixel-size", "1um", "--exclude", "900,0,5,5"}, "lies outside");
  refused({"microstructure", "a.png", "--pixel-size", "1um", "--exclude", "0,0,200,200"}, "leaves nothing");
  refused({"microstructure", "a.png", "--pixel-size", "1um", "--background", "morphology"},
          "--background-scale");
  refused({"microstructure", "black.png", "--pixel-size", "1um"}, "black.png: has one grey value only");
  refused({"microstructure", "empty.png", "--pixel-size", "1um"}, "no particles found");
  refused({"microstructure", "two.png", "--pixel-size", "1um"}, "two.png: 2 particles are seen whole");
  // A folder of something else is not touched.
  folder.write("mine/letter.txt", "dear");
  EXPECT_EQ(run({"microstructure", "a.png", "--pixel-size", "1um", "-o", "mine"}), 2);
  EXPECT_NE(output.find("folder of something else"), std::string::npos) << output;
  EXPECT_EQ(file_content(file("mine/letter.txt")), "dear");
  EXPECT_EQ(run({"microstructure", "a.png", "--pixel-size", "1um", "-o", "a.png"}), 2);
  EXPECT_EQ(run({"microstructure", "a.png", "--pixel-size", "1um", "-o", "no/such"}), 2);
}

TEST_F(InstrumentCli, DropletSize) {
  ASSERT_EQ(
      run({"droplet-size", "--angles", "2.79:max:R,4.23deg:min:R", "--lamp", "LED-B3", "-o", "fit.json"}), 0)
      << output;
  const auto j = nlohmann::json::parse(file_content(file("fit.json")));
  EXPECT_GT(double(j["radius_um"]["value"]), 4.5);
  EXPECT_LT(double(j["radius_um"]["value"]), 5.7);
  EXPECT_GT(double(j["radius_um"]["error"]), 0.0);
  ASSERT_EQ(run({"droplet-size", "--angles", "2.8deg", "--lamp", "589nm"}), 0) << output;
  EXPECT_NE(output.find("does not tell the area fraction"), std::string::npos) << output;

  Image flat;
  flat.width = flat.height = 100, flat.channels = {"R", "G", "B"};
  std::mt19937 random(1);
  for (int i = 0; i < 30000; ++i) flat.pixels.push_back(0.3f + 0.02f * float(random() % 1000) / 1000);
  write_png(folder.path / "flat.png", flat);
  write_grey_png("grey.png", discs(5, false, 64));
  refused({"droplet-size", "flat.png", "--pixel-angle", "0.05deg"}, "flat.png: no ring is visible");
  refused({"droplet-size", "grey.png", "--pixel-angle", "0.05deg"}, "needs the channels R, G and B");
  refused({"droplet-size", "missing.png", "--pixel-angle", "0.05deg"}, "no such file");
  refused({"droplet-size", "flat.png"}, "give either --pixel-angle or --fov");
  refused({"droplet-size", "flat.png", "--pixel-angle", "0.05"}, "has no unit");
  refused({"droplet-size", "flat.png", "--pixel-angle", "0deg"}, "not between 0 and 90");
  refused({"droplet-size", "flat.png", "--pixel-angle", "0.05deg", "--lamp", "LED-B33"},
          "did you mean \"LED-B3\"?");
  refused({"droplet-size", "flat.png", "--pixel-angle", "0.05deg", "--lamp", "12nm"}, "not visible");
  refused({"droplet-size", "flat.png", "--pixel-angle", "0.05deg", "--center", "500,20"},
          "outside of the picture");
  refused({"droplet-size", "flat.png", "--pixel-angle", "0.05deg", "--substrate", "glas"}, "--substrate");
  // An option takes its numbers and leaves the photo behind it.
  const std::string no_ring = "flat.png: no ring is visible";
  refused({"droplet-size", "--pixel-angle", "0.05deg", "--center", "80", "60", "flat.png"}, no_ring);
  refused({"droplet-size", "--pixel-angle", "0.05deg", "--center", "80,60", "flat.png"}, no_ring);
  refused({"droplet-size", "--pixel-angle", "0.05deg", "--azimuths", "300", "60", "flat.png"}, no_ring);
  refused({"droplet-size", "--pixel-angle", "0.05deg", "--mask", "10", "10", "5", "flat.png"}, no_ring);
  refused({"droplet-size", "flat.png", "--pixel-angle", "0.05deg", "--mask", "10", "10", "-5"},
          "--mask: the radius -5 is not positive");
  refused({"droplet-size", "flat.png", "--pixel-angle", "0.05deg", "--azimuths", "60", "60"},
          "the range from 60 to 60 degrees is empty");
  refused({"droplet-size", "flat.png", "--pixel-angle", "0.05deg", "--spread", "--second-size"}, "not both");
  refused({"droplet-size", "flat.png", "--pixel-angle", "0.05deg", "--correlation", "simulate"},
          "did you mean \"simulated\"?");
  refused({"droplet-size", "--angles", "2.8,3.9", "--spread"}, "need a photo");
  refused({"droplet-size"}, "either a photo or --angles");
  refused({"droplet-size", "--angles", "2.8um"}, "is not a number");
  refused({"droplet-size", "--angles", "2:max:G,2.1:max:G,2.15:max:G"},
          "no radius has extrema at these angles");
}

}  // namespace
}  // namespace aureole::test

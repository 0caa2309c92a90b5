// SPDX-License-Identifier: Apache-2.0
// Scenes with names of Mitsuba 0.6, and of Mitsuba 3's differentiable integrators: translated or dropped with
// a note.
#include <cmath>

#include "aureole/core/image.h"
#include "aureole/loading/load.h"
#include "shape/shape_test_support.h"

namespace aureole {
namespace {

class OldPlugins : public test::FileTest {
protected:
  static constexpr const char* kSensor =
      "<sensor type='perspective'><sampler type='independent'/><film type='hdrfilm'/></sensor>";
  LoadedScene load(const std::string& content, const std::string& head = kSensor,
                   const std::string& version = "0.6.0") const {
    return load_scene_from_string("<scene version='" + version + "'>\n" + head + "\n" + content + "</scene>",
                                  folder_ / "old.xml");
  }
  static std::string notes(const LoadedScene& s) {
    std::string all;
    for (const auto& n : s.notes) all += n + "\n";
    return all;
  }
  static void expect(const LoadedScene& s, std::initializer_list<const char*> parts) {
    for (const char* part : parts)
      EXPECT_NE(notes(s).find(part), std::string::npos) << part << "\n" << notes(s);
  }
  std::string errors(const std::string& content) const {
    try {
      load(content);
    } catch (const ErrorList& list) {
      return list.what();
    }
    return "";
  }
  static const Bsdf& bsdf(const LoadedScene& s) { return *s.scene->parts().surfaces.at(0).bsdf; }
};

TEST_F(OldPlugins, SamplersFilmsAndIntegrators) {
  for (const char* sampler : {"halton", "hammersley", "sobol"}) {
    const LoadedScene s =
        load("<shape type='sphere'/>",
             "<integrator type='volpath_simple'/><sensor type='perspective'><sampler type='" +
                 std::string(sampler) +
                 "'><integer name='scramble' value='-1'/></sampler><film type='tiledhdrfilm'/></sensor>");
    expect(s,
           {"tiledhdrfilm\" is replaced by \"hdrfilm", "volpath_simple\" is replaced by \"path", "scramble"});
  }
  for (const char* type :
       {"prb", "prb_basic", "direct_projective", "prb_projective", "prb_reparam", "prbvolpath"}) {
    const LoadedScene s = load("<shape type='sphere'/>",
                               "<integrator type='" + std::string(type) +
                                   "'><integer name='sppi' value='0'/></integrator>" + kSensor,
                               "3.0.0");
    expect(s, {"its picture is the same", "\"sppi\" is ignored"});
  }
}

TEST_F(OldPlugins, SurfacesAndTextures) {
  write(
      "leaf.ply",
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty float "
      "r\nproperty float g\nproperty float b\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
      "0 0 0 .1 .5 .1\n1 0 0 .1 .5 .1\n0 1 0 .1 .5 .1\n3 0 1 2\n");
  const LoadedScene s = load(
      "<shape type='ply'><string name='filename' value='leaf.ply'/><float name='maxSmoothAngle' value='30'/>"
      "<boolean name='collapse' value='true'/><bsdf type='difftrans'><texture type='vertexcolors' "
      "name='transmittance'/></bsdf></shape>");
  expect(s, {"vertexcolors\" is replaced by \"mesh_attribute", "\"collapse\" has no effect"});
  EXPECT_EQ(bsdf(s).properties().type(), "difftrans");
  const LoadedScene colour = load(
      "<shape type='sphere'><bsdf type='diffuse'><spectrum name='reflectance' value='0.6, 0.2, 0.1'/></bsdf></shape>");
  expect(colour, {"three numbers of a <spectrum> are read as <rgb>"});
}

TEST_F(OldPlugins, Media) {
  const LoadedScene s = load(
      "<shape type='cube'><medium name='interior' type='heterogeneous'><string name='method' value='woodcock'/><volume "
      "name='density' type='volcache'><integer name='blockSize' value='8'/><volume type='constvolume'><float name='value' "
      "value='2'/></volume></volume><volume name='albedo' type='constvolume'><float name='value' value='0.5'/></volume><float "
      "name='stepSize' value='0.1'/></medium></shape>");
  expect(s, {"\"method\" has no effect", "\"step_size\" has no effect",
             "volcache\" is replaced by the volume in it"});
}

TEST_F(OldPlugins, Hair) {
  write("a.hair", "0 0 0\n0 0 1\n\n1 0 0\n1 0 1\n1 0 2\n");
  const LoadedScene s = load(
      "<shape type='hair'><string name='filename' value='a.hair'/><float name='radius' value='0.1'/><float "
      "name='angleThreshold' value='1'/></shape>");
  EXPECT_EQ(s.scene->parts().surfaces.at(0).shape->primitive_count(), 3u);
  EXPECT_NEAR(s.scene->bounds().upper.x, 1.1f, 1e-6f);
  write("b.hair", "BINARY_HAIR\1\2\3");
  EXPECT_NE(errors("<shape type='hair'><string name='filename' value='b.hair'/></shape>")
                .find("binary file of hair"),
            std::string::npos);
}

TEST_F(OldPlugins, Emitters) {
  write_exr(folder_ / "sky.exr", Image{4, 3, {"Y"}, std::vector<float>(12, 1.f), false}, ExrPixel::float32,
            {});
  write_png(folder_ / "sky.png", Image{4, 3, {"Y"}, std::vector<float>(12, 1.f), false});
  const auto envmap = [](const char* file, const char* gamma) {
    return "<emitter type='envmap'><string name='filename' value='" + std::string(file) +
           "'/><float name='gamma' value='" + gamma + "'/><boolean name='cache' value='true'/></emitter>";
  };
  expect(load(envmap("sky.exr", "1")), {"\"gamma\" has no effect", "\"cache\" has no effect"});
  expect(load(envmap("sky.png", "2.2")), {"\"gamma\" has no effect"});
  EXPECT_NE(errors(envmap("sky.png", "1")).find("a gamma of 1 is not supported"), std::string::npos);
  const LoadedScene beam = load(
      "<emitter type='collimated'><float name='power' value='3'/><transform name='toWorld'><translate z='2'/>"
      "</transform></emitter>");
  expect(beam, {"collimated\" is replaced by a disk"});
  EXPECT_NEAR(beam.scene->bounds().upper.x, 1e-3f, 1e-7f);
  EXPECT_NEAR(beam.scene->bounds().upper.z, 2, 1e-6f);
}

TEST_F(OldPlugins, PathsOfWindows) {
  std::filesystem::create_directories(folder_ / "maps");
  write_exr(folder_ / "maps/a.exr", Image{1, 1, {"Y"}, {0.5f}, false}, ExrPixel::float32, {});
  const auto with = [](const char* file) {
    return "<shape type='sphere'><bsdf type='diffuse'><texture name='reflectance' type='bitmap'><string name='filename' "
           "value='" +
           std::string(file) + "'/></texture></bsdf></shape>";
  };
  EXPECT_EQ(errors(with("maps\\a.exr")), "");
  EXPECT_NE(errors(with("maps\\b.exr")).find("no such file: \"maps\\b.exr\""), std::string::npos);
}

}  // namespace
}  // namespace aureole

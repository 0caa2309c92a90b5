// SPDX-License-Identifier: Apache-2.0
// aureole bake and aureole info of its files, as a user meets them.
#include <gtest/gtest.h>

#include <fstream>

#include "aureole/parameter/radiance/radiance_voxels.h"
#include "aureole/parameter/splat/splat_cloud.h"
#include "harness/paths.h"
#include "harness/program.h"
#include "loading/load_text.h"

namespace aureole::test {
namespace {

namespace fs = std::filesystem;

class BakeCommand : public ::testing::Test {
protected:
  BakeCommand() {
    scene = folder
                .write("room.xml", R"(<scene version="3.0.0"><integrator type="path"/>
      <sensor type="perspective"><film type="hdrfilm"><integer name="width" value="8"/><integer name="height" value="8"/></film></sensor>
      <emitter type="constant"><float name="radiance" value="0.5"/></emitter>
      <shape type="rectangle"><bsdf type="diffuse"/></shape></scene>)")
                .string();
  }
  int run(const std::vector<std::string>& arguments) {
    const ProgramEnd end = run_program(folder.path, arguments);
    output = end.output;
    return end.exit_code;
  }
  void refused(std::vector<std::string> arguments, const std::string& message) {
    arguments.insert(arguments.begin(), {"bake", scene});
    EXPECT_EQ(run(arguments), 2) << output;
    EXPECT_NE(output.find(message), std::string::npos) << "expected \"" << message << "\" in: " << output;
    for (const char* file : {"out.ply", "out.npz", "out.png"}) EXPECT_FALSE(fs::exists(folder.path / file));
  }
  void says(const std::string& text) {
    EXPECT_NE(output.find(text), std::string::npos) << "expected \"" << text << "\" in: " << output;
  }
  TemporaryFolder folder;
  std::string scene, output;
};

TEST_F(BakeCommand, WritesEveryKind) {
  for (const char* name : {"out.ply", "out.spz", "out.glb", "out.usda"}) {
    ASSERT_EQ(run({"bake", scene, "-o", name, "--count", "50", "--paths", "4", "--degree", "1"}), 0)
        << output;
    says("50 splats on an area of 4, 4 paths each");
    const SplatCloud cloud = read_splat_file(folder.path / name);
    EXPECT_EQ(cloud.size(), 50u);
    EXPECT_EQ(cloud.degree, 1);
    ASSERT_EQ(run({"info", name}), 0) << output;
    says("50 Gaussian splats"), says("harmonics    degree 1");
  }
  ASSERT_EQ(run({"info", "out.usda"}), 0) << output;
  says("OpenUSD, ParticleField3DGaussianSplat");
  ASSERT_EQ(run({"bake", scene, "-o", "points.ply", "--to", "pointcloud", "--count", "20"}), 0) << output;
  ASSERT_EQ(run({"info", "points.ply"}), 0) << output;
  says("20 points"), says("with normals");
  ASSERT_EQ(run({"bake", scene, "-o", "out.npz", "--to", "grid", "--resolution", "10", "--degree", "2"}), 0)
      << output;
  says("of 15 x 15 x 5 voxels with a surface");
  EXPECT_EQ(read_radiance_voxels(folder.path / "out.npz").degree, 2);
  ASSERT_EQ(run({"info", "out.npz"}), 0) << output;
  says("15 x 15 x 5 voxels"), says("harmonics    degree 2");
}

TEST_F(BakeCommand, BadInputIsAnError) {
  refused({"-o", "out.png"}, "splats are written as .ply, .spz, .glb, .usda");
  refused({"-o", "out.ply", "--to", "gird"}, "did you mean \"grid\"");
  refused({"-o", "out.ply", "--to", "grid"}, "a radiance grid is written as .npz");
  refused({"-o", "out.npz"}, "splats are written as");
  refused({"-o", "out.npz", "--to", "pointcloud"}, "points with normals and radii are written as .ply");
  refused({"-o", "out.npz", "--to", "grid", "--count", "5"}, "state --resolution");
  refused({"-o", "out.ply", "--resolution", "64"}, "is for --to grid");
  refused({"-o", "out.npz", "--to", "grid", "--resolution", "5000"}, "must be between 2 and 1024");
  refused({"-o", "out.ply", "--degree", "4"}, "must be between 0 and 3");
  refused({"-o", "out.ply", "--to", "pointcloud", "--degree", "1"}, "points have one colour");
  refused({"-o", "out.ply", "--density", "kamera"}, "did you mean \"camera\"");
  refused({"-o", "out.npz", "--to", "grid", "--density", "camera"}, "have one size");
  refused({"-o", "nowhere/out.ply"}, "nowhere");
  std::ofstream(folder.path / "broken.npz") << "PK no archive";
  EXPECT_EQ(run({"info", "broken.npz"}), 2);
  says("broken.npz");
  std::ofstream(folder.path / "broken.usda") << "#usda 1.0\ndef Xform \"World\" {\n";
  EXPECT_EQ(run({"info", "broken.usda"}), 2);
  says("broken.usda:3"), says("ends within the prim \"World\"");
}

}  // namespace
}  // namespace aureole::test

// SPDX-License-Identifier: Apache-2.0
// aureole illumination against the closed form of a cube with diffuse walls.
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "aureole/core/image.h"
#include "harness/program.h"
#include "loading/load_text.h"

namespace aureole::test {
namespace {

/// A lamp of 10 klm in the middle of a cube of 4 m, whose walls have the reflectance 0.5: each has 10000/96 lx directly in
/// the mean, and 104.1667 rho/(1 - rho) lx by interreflection in the mean over all walls. By symmetry one wall is enough.
const std::string kCube =
    "<scene version='3.0.0'><integrator type='path'><integer name='max_depth' value='-1'/></integrator>"
    "<sensor type='powermap'><string name='measure' value='irradiance'/><transform name='to_world'><scale value='2'/><translate z='-1.99999'/></transform>"
    "<film type='hdrfilm'><integer name='width' value='16'/><integer name='height' value='16'/>"
    "<string name='quantity' value='illuminance'/></film><sampler type='sobol'><integer name='sample_count' value='256'/></sampler>"
    "</sensor><shape type='cube'><boolean name='flip_normals' value='true'/><transform name='to_world'><scale value='2'/></transform>"
    "<bsdf type='diffuse'><float name='reflectance' value='0.5'/></bsdf></shape>"
    "<emitter type='point'><string name='amount' value='10 klm'/></emitter></scene>";

TEST(IlluminationCommand, InterreflectionInACube) {
  TemporaryFolder folder;
  folder.write("cube.xml", kCube);
  const ProgramEnd end =
      run_program(folder.path, {"illumination", "cube.xml", "-o", "both.png", "--map", "share.png"});
  ASSERT_EQ(end.exit_code, 0) << end.output;
  EXPECT_NE(end.output.find("illuminance, lx"), std::string::npos) << end.output;
  std::istringstream row(end.output.substr(end.output.find("0,0,16,16") + 10));
  double local, global, further, errors[3];
  std::string sign;
  row >> local >> sign >> errors[0] >> global >> sign >> errors[1] >> further >> sign >> errors[2];
  ASSERT_TRUE(row) << end.output;
  EXPECT_LT(errors[0], 0.003 * local);
  EXPECT_LT(errors[1], 0.003 * global);
  EXPECT_LT(errors[2], 0.003 * further);
  EXPECT_NEAR(local, 10000 / 96.0, 3 * errors[0] + 0.02);
  EXPECT_NEAR(further, 104.1667, 3 * errors[2] + 0.02);
  EXPECT_NE(end.output.find(" 50.0"), std::string::npos) << end.output;  // the share in %
  const Image both = read_image(folder.path / "both.png");
  EXPECT_EQ(both.width, 32);
  EXPECT_GT(read_image(folder.path / "share.png").width, 100);
}

TEST(IlluminationCommand, MistakesAreNamed) {
  TemporaryFolder folder;
  folder.write("cube.xml", kCube);
  const auto refused = [&](std::vector<std::string> more, const std::string& words) {
    std::vector<std::string> all{"illumination", "cube.xml"};
    all.insert(all.end(), more.begin(), more.end());
    const ProgramEnd end = run_program(folder.path, all);
    EXPECT_EQ(end.exit_code, 2) << end.output;
    EXPECT_NE(end.output.find(words), std::string::npos) << end.output;
  };
  refused({"--region", "0,0,17,1"}, "leaves the picture of 16 x 16");
  refused({"--spp", "0"}, "at least one sample");
  refused({"-o", "x.exr"}, ".png");
  refused({"--region", "0,0,1.5,1"}, "no number of pixels");
}

}  // namespace
}  // namespace aureole::test

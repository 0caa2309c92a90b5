// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <limits>

#include "aureole/emitter/emitter.h"
#include "harness/paths.h"
#include "harness/properties_builder.h"

namespace aureole {
namespace {

std::shared_ptr<Emitter> sky(const std::string& to_world) {
  const auto file = test::source_dir() / "tests/references/scenes/textures/sky_grey.exr";
  return testing::build<Emitter>("<emitter type=\"envmap\"><string name=\"filename\" value=\"" +
                                 file.string() + "\"/><transform name=\"to_world\">" + to_world +
                                 "</transform></emitter>");
}

TEST(Envmap, RefusesTransformsThatTurnNothing) {
  for (const char* bad : {R"(<scale x="1e-45"/>)", R"(<scale x="1e300" y="1e300" z="1e300"/>)",
                          R"(<rotate z="1" angle="30"/><scale x="2"/>)"})
    EXPECT_THROW(sky(bad), Error) << bad;
  EXPECT_TRUE(sky(R"(<rotate z="1" angle="30"/>)"));
}

TEST(Envmap, LooksNowhereElse) {
  const auto emitter = sky("");
  const float nan = std::numeric_limits<float>::quiet_NaN(),
              infinity = std::numeric_limits<float>::infinity();
  const Wavelengths w = Wavelengths::at({}, Spectrum(500.f));
  for (const Vec3& d : {Vec3{nan, nan, nan}, Vec3{0, nan, 1}, Vec3{infinity, 0, 0}, Vec3{0, 0, 0}}) {
    (void)emitter->eval_escaped(d, w);  // must not read outside of the picture
    (void)emitter->pdf_direct_escaped({}, {}, d);
    (void)emitter->pdf_direct_escaped({}, {0, 0, 1}, d);
  }
}

}  // namespace
}  // namespace aureole

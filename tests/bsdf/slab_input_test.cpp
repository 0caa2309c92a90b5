// SPDX-License-Identifier: Apache-2.0
// Values of a slab that single precision or the formulas cannot hold are errors at the parameter.
#include <gtest/gtest.h>

#include <string>

#include "aureole/bsdf/bsdf.h"
#include "aureole/plugin/registry.h"
#include "harness/properties_builder.h"

namespace aureole::test {
namespace {

std::string error_of(const std::string& thickness, const std::string& int_ior) {
  const PluginInfo* plugin = Registry::instance().find("bsdf", "slab");
  try {
    plugin->create(testing::read_properties("<bsdf type='slab'><string name='thickness' value='" + thickness +
                                            "'/><float name='int_ior' value='" + int_ior + "'/></bsdf>"));
  } catch (const Error& e) {
    return e.what();
  }
  return "";
}

TEST(SlabInput, ValuesOutOfRange) {
  EXPECT_EQ(error_of("2um", "1.5"), "");
  for (const char* thickness : {"1e300m", "1e9m", "0m", "-1um"})
    EXPECT_NE(error_of(thickness, "1.5").find("parameter \"thickness\""), std::string::npos) << thickness;
  EXPECT_NE(error_of("2um", "1e300").find("parameter \"int_ior\""), std::string::npos);
}

}  // namespace
}  // namespace aureole::test

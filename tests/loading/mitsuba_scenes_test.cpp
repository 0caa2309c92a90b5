// SPDX-License-Identifier: Apache-2.0
// Scenes written for Mitsuba, read by the real plug-ins. They lie outside of the repository, in the folder
// that the environment variable AUREOLE_SHARED names.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include "aureole/loading/stages.h"
#include "harness/paths.h"

namespace aureole {
namespace {

class MitsubaScenes : public ::testing::Test {
protected:
  void SetUp() override {
    const char* given = std::getenv("AUREOLE_SHARED");
    folder_ = given ? std::filesystem::path(given) : test::source_dir() / ".." / "shared";
    if (!std::filesystem::is_directory(folder_ / "data"))
      GTEST_SKIP() << "no folder " << (folder_ / "data")
                   << ": set AUREOLE_SHARED to where the example scenes are";
  }

  LoadedParts load(const std::string& name) const {
    try {
      return load_parts(folder_ / "data" / name, {}, {});
    } catch (const ErrorList& list) {
      ADD_FAILURE() << list.what();
      return {};
    }
  }

  std::filesystem::path folder_;
};

TEST_F(MitsubaScenes, CornellBoxes) {
  for (const char* name : {"cbox", "cbox-rgb", "cbox-spectral"}) {
    SCOPED_TRACE(name);
    const LoadedParts s = load("mitsuba/scenes/cbox/" + std::string(name) + ".xml");
    EXPECT_EQ(s.parts.surfaces.size(), 8u);
    EXPECT_EQ(s.parts.emitters.size(), 0u);  // the area emitter belongs to the luminaire
    EXPECT_TRUE(s.parts.sensor);
    EXPECT_TRUE(s.integrator);
  }
}

TEST_F(MitsubaScenes, Matpreview) {
  const LoadedParts s = load("mitsuba/scenes/matpreview/matpreview.xml");
  EXPECT_EQ(s.parts.surfaces.size(), 3u);
  EXPECT_EQ(s.parts.emitters.size(), 1u);
  EXPECT_TRUE(s.parts.sensor);
}

TEST_F(MitsubaScenes, AnOldSceneWithUnknownPluginsFailsWithAllItsProblemsAtOnce) {
  std::vector<std::string> errors;
  try {
    load_scene(folder_ / "data" / "cornell-box" / "box.xml");
    FAIL() << "loaded";
  } catch (const ErrorList& list) {
    errors = list.errors();
  }
  const char* expected[] = {"box.xml:20:39: undefined $spp", "box.xml:23:33: undefined $res",
                            "box.xml:24:34: undefined $res",
                            "box.xml:58:14: unknown bsdf \"freespacediffraction\""};
  std::size_t next = 0;
  for (const char* text : expected) {
    const auto found = std::find_if(errors.begin() + std::ptrdiff_t(next), errors.end(),
                                    [&](const std::string& e) { return e.find(text) != std::string::npos; });
    EXPECT_NE(found, errors.end()) << text << " is missing, or out of order, in\n"
                                   << ::testing::PrintToString(errors);
    if (found != errors.end()) next = std::size_t(found - errors.begin()) + 1;
  }
}

}  // namespace
}  // namespace aureole

// SPDX-License-Identifier: Apache-2.0
// Scenes written for Mitsuba, read by the real plug-ins. They lie outside of the repository, in the folder
// that the environment variable AUREOLE_SHARED names.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include "aureole/integrator/integrator.h"
#include "aureole/loading/load.h"
#include "aureole/loading/stages.h"
#include "aureole/scene/edge/scene_diffraction.h"
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

TEST_F(MitsubaScenes, AnOldSceneFailsWithAllItsProblemsAtOnce) {
  std::vector<std::string> errors;
  try {
    load_scene(folder_ / "data" / "cornell-box" / "box.xml");
    FAIL() << "loaded";
  } catch (const ErrorList& list) {
    errors = list.errors();
  }
  const char* expected[] = {"box.xml:20:39: undefined $spp", "box.xml:23:33: undefined $res",
                            "box.xml:24:34: undefined $res"};
  ASSERT_EQ(errors.size(), std::size(expected)) << ::testing::PrintToString(errors);
  for (std::size_t i = 0; i < std::size(expected); ++i)
    EXPECT_NE(errors[i].find(expected[i]), std::string::npos) << errors[i];
}

// The scene of "A Free-Space Diffraction BSDF", as its authors give it, by `bdpt`: the wavelength, 1e-4 units, becomes that of the film, so narrow a band that all of it has one phase.
TEST_F(MitsubaScenes, OfFreeSpaceDiffractionLoadUnchanged) {
  for (const bool on : {true, false}) {
    LoadOptions options;
    options.defines = {{"spp", "1"}, {"res", "8"}, {"fsd", on ? "true" : "false"}};
    const LoadedScene s = load_scene(folder_ / "data" / "cornell-box" / "box.xml", options);
    ASSERT_TRUE(s.scene->diffraction());
    const SpectralGrid& grid = s.scene->parts().context->grid;
    EXPECT_NEAR(grid.min_nm, 1e5 - 0.5, 0.01);
    EXPECT_NEAR(grid.max_nm, 1e5 + 0.5, 0.01);
    const auto& edges = s.scene->diffraction()->edges().index().edges();
    EXPECT_EQ(edges.empty(), !on);
    // All edges are those of the screen, at x = -0.33.
    for (const MeshEdge& e : edges) EXPECT_NEAR(e.a.x, -0.33, 0.001);
    std::string notes;
    for (const std::string& note : s.notes) notes += note + "\n";
    EXPECT_NE(notes.find("\"wavelengths\" becomes the film's band about 1"), std::string::npos) << notes;
    EXPECT_EQ(s.integrator->properties().type(), "bdpt");
    EXPECT_TRUE(s.integrator->needs().diffraction);
    EXPECT_EQ(notes.find("picture will be black"), std::string::npos) << notes;
  }
}

}  // namespace
}  // namespace aureole

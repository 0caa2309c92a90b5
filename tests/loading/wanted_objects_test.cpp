// SPDX-License-Identifier: Apache-2.0
// Notes of a file's objects, for a program that measures one of them.
#include "aureole/loading/wanted_objects.h"

#include <gtest/gtest.h>

#include "harness/paths.h"
#include "loading/load_text.h"

namespace aureole::test {
namespace {

class WantedObjects : public ::testing::Test {
protected:
  /// The names of plug-ins in the notes about the object of this id: names with a capital letter are noted.
  std::string noted(const std::string& id) {
    const LoadedObjects loaded =
        load_wanted_objects(folder.path / "scene.xml", {},
                            [&](const std::string& its_id, const ObjectPtr&) { return its_id == id; });
    std::string names;
    for (const std::string& note : loaded.notes) {
      const std::size_t begin = note.find(" \"") + 2;
      names += (names.empty() ? "" : " ") + note.substr(begin, note.find('"', begin) - begin);
    }
    return names;
  }
  TemporaryFolder folder;
};

TEST_F(WantedObjects, HaveTheirOwnNotesAndThoseOfTheirReferences) {
  folder.write("scene.xml", R"(<scene version="3.0.0">
    <texture type="Checkerboard" id="squares"/>
    <bsdf type="Diffuse" id="plain"/>
    <bsdf type="TwoSided" id="both"><bsdf type="Plastic" id="inner"><ref name="diffuse_reflectance" id="squares"/></bsdf></bsdf>
    <include filename="more.xml"/>
    <alias id="plain" as="also_plain"/>
    <shape type="Rectangle" id="floor"><ref id="both"/></shape>
    </scene>)");
  folder.write("more.xml", R"(<scene version="3.0.0"><bsdf type="Conductor" id="metal"/></scene>)");
  EXPECT_EQ(noted("plain"), "Diffuse");
  EXPECT_EQ(noted("also_plain"), "Diffuse");
  EXPECT_EQ(noted("squares"), "Checkerboard");
  EXPECT_EQ(noted("inner"), "Checkerboard Plastic");
  EXPECT_EQ(noted("both"), "Checkerboard TwoSided Plastic");
  EXPECT_EQ(noted("floor"), "Checkerboard TwoSided Plastic Rectangle");
  EXPECT_EQ(noted("metal"), "Conductor");
  EXPECT_EQ(noted("missing"), "");
  EXPECT_EQ(load_objects(folder.path / "scene.xml").notes.size(), 6u);
}

}  // namespace
}  // namespace aureole::test

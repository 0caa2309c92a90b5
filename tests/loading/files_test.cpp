// SPDX-License-Identifier: Apache-2.0
// Which parameters are files the registry knows, by their type alone: they are found, reported where they are
// missing, and belong to the scene's hash, whatever their names.
#include <gtest/gtest.h>

#include <atomic>
#include <fstream>

#include "aureole/loading/document.h"
#include "aureole/loading/references.h"
#include "aureole/render/job.h"
#include "aureole/texture/constant_texture.h"
#include "loading/test_plugins.h"

namespace aureole {
namespace {

using test::TemporaryFolder;

double number_in(const std::filesystem::path& file) {
  double number = 0;
  std::ifstream(file) >> number;
  return number;
}

/// A constant read from a file, and a string parameter named `filename`.
class TableTexture final : public ConstantTexture {
public:
  explicit TableTexture(const Properties& p)
      : ConstantTexture(
            p, SampledSpectrum::constant(p.context().grid, float(number_in(p.get_file("measured_table"))))),
        file(p.get_file("measured_table")),
        text(p.get_string("filename", "")) {}
  std::filesystem::path file;
  std::string text;
};
/// Reads a file parameter that its table does not document as `file`.
struct Undocumented : Object {
  explicit Undocumented(const Properties& p) : Object(p) { p.get_file("filename"); }
};

const PluginRegistration kPlugins[] = {
    PluginRegistration(
        test::test_plugin<TableTexture>("texture", "test_table", {"filename"}, {"measured_table"})),
    PluginRegistration(test::test_plugin<Undocumented>("texture", "test_undocumented", {"filename"}))};

std::string table(const std::string& file, const std::string& more = "") {
  return "<texture type='test_table' name='reflectance'><string name='measured_table' value='" + file +
         "'/>" + more + "</texture>";
}
/// A scene that can be rendered; the texture is on line 3.
std::string scene_with(const std::string& texture, const std::string& head = "") {
  return test::kHead + head + "<integrator type='path'/><sensor type='perspective'><film type='hdrfilm'>" +
         "<integer name='width' value='4'/><integer name='height' value='4'/></film></sensor>\n" +
         "<shape type='sphere'><bsdf type='diffuse' id='wall'>" + texture +
         "</bsdf></shape><emitter type='constant'/></scene>";
}
std::uint64_t hash_of(const std::filesystem::path& scene) { return load_scene(scene).hash; }

TEST(FileParameters, AreFoundBesideTheSceneWhateverTheirNames) {
  const TemporaryFolder folder;
  folder.write("a.txt", "0.25");
  folder.write("lib/b.txt", "0.5");
  folder.write("parts/c.txt", "0.75");
  folder.write("parts/part.xml",
               "<texture version='3.0.0' type='test_table' id='included'><string "
               "name='measured_table' value='c.txt'/></texture>");
  const auto file = folder.write(
      "scene.xml", scene_with(table("a.txt", "<string name='filename' value='just a text'/>"),
                              "<path value='lib'/><include filename='parts/part.xml'/>"
                              "<texture type='test_table' id='searched'><string name='measured_table' "
                              "value='b.txt'/></texture>"));
  const SceneDocument scene(file);
  const auto texture = [&](const std::string& path) {
    return std::dynamic_pointer_cast<TableTexture>(scene.object(path));
  };
  EXPECT_EQ(texture("wall.reflectance")->file, folder.path / "a.txt");
  EXPECT_EQ(texture("wall.reflectance")->text, "just a text");
  EXPECT_EQ(texture("searched")->file, folder.path / "lib/b.txt");
  EXPECT_EQ(texture("included")->file, folder.path / "parts/c.txt");
}

TEST(FileParameters, ThatAreMissingAreLocatedErrors) {
  const auto errors = test::errors_of_file(scene_with(table("gone.txt")));
  ASSERT_EQ(errors.size(), 1u);
  EXPECT_TRUE(errors[0].starts_with("test.xml:3:")) << errors[0];
  EXPECT_NE(errors[0].find("no such file: \"gone.txt\" (looked in "), std::string::npos) << errors[0];
}

TEST(FileParameters, CountByTheirContent) {
  const TemporaryFolder folder;
  folder.write("a.txt", "0.25");
  const auto scene = folder.write("scene.xml", scene_with(table("a.txt")));
  const std::uint64_t before = hash_of(scene);
  folder.write("a.txt", "0.75");
  EXPECT_NE(hash_of(scene), before);
  // The folder of a file does not matter.
  folder.write("elsewhere/a.txt", "0.25");
  folder.write("scene.xml", scene_with(table("elsewhere/a.txt")));
  EXPECT_EQ(hash_of(scene), before);
  // A string is hashed as a string, even if it is named `filename`.
  folder.write("scene.xml", scene_with(table("elsewhere/a.txt", "<string name='filename' value='a'/>")));
  const std::uint64_t with_text = hash_of(scene);
  folder.write("scene.xml", scene_with(table("elsewhere/a.txt", "<string name='filename' value='b'/>")));
  EXPECT_NE(hash_of(scene), with_text);
}

TEST(FileParameters, OfSpectraCountToo) {
  const TemporaryFolder folder;
  const auto scene =
      folder.write("scene.xml", scene_with("<spectrum name='reflectance' filename='paint.spd'/>"));
  folder.write("paint.spd", "360 0.2\n830 0.3\n");
  const std::uint64_t before = hash_of(scene);
  folder.write("paint.spd", "360 0.2\n830 0.4\n");
  EXPECT_NE(hash_of(scene), before);
  std::filesystem::remove(folder.path / "paint.spd");
  EXPECT_THROW(load_scene(scene), ErrorList);
}

TEST(FileParameters, AChangedFileIsAnotherPicture) {
  const TemporaryFolder folder;
  folder.write("a.txt", "0.25");
  const auto scene = folder.write("scene.xml", scene_with(table("a.txt")));
  RenderOptions options;
  options.end = 16;
  RenderJob job(load_scene(scene), options);
  job.run(std::atomic<bool>(false));
  RenderJob same(load_scene(scene), options);
  EXPECT_NO_THROW(same.resume(job.state()));
  folder.write("a.txt", "0.75");
  RenderJob other(load_scene(scene), options);
  EXPECT_THROW(other.resume(job.state()), Error);
}

TEST(FileParameters, AChangedFileIsReadAgain) {
  const TemporaryFolder folder;
  folder.write("a.txt", "0.25");
  SceneDocument scene(folder.write("scene.xml", scene_with(table("a.txt"))));
  const ObjectPtr before = scene.object("wall.reflectance");
  scene.edit({{"sensor.film.width", "<integer value='5'/>"}});
  EXPECT_EQ(scene.object("wall.reflectance"), before);
  folder.write("a.txt", "0.125");
  scene.edit({{"sensor.film.width", "<integer value='6'/>"}});
  EXPECT_NE(scene.object("wall.reflectance"), before);
}

TEST(FileParameters, OfAllPluginsAreKnown) {
  int count = 0;
  for (const PluginInfo& plugin : Registry::instance().all())
    for (const ParameterDoc& row : plugin.doc.parameters) {
      if (!plugin.names_file(row.name)) continue;
      Diagnostics diagnostics;
      ParsedScene parsed =
          parse_scene("test.xml",
                      test::kHead + "<" + plugin.family + " type='" + plugin.name + "'><string name='" +
                          row.name + "' value='none'/></" + plugin.family + "></scene>",
                      {}, diagnostics);
      const References references(parsed, diagnostics);
      ASSERT_EQ(diagnostics.errors().size(), 1u) << plugin.name << " " << row.name;
      EXPECT_NE(diagnostics.errors()[0].find("test.xml:2:"), std::string::npos);
      EXPECT_NE(diagnostics.errors()[0].find("no such file: \"none\""), std::string::npos);
      ++count;
    }
  EXPECT_GT(count, 10);
}

TEST(FileParameters, MustBeFilesInTheTable) {
  const PluginInfo* plugin = Registry::instance().find("texture", "test_undocumented");
  Properties p(plugin->name, "", {}, nullptr, plugin);
  p.add("filename", std::string("a.txt"), {});
  EXPECT_THROW(plugin->create(p), std::logic_error);
}

}  // namespace
}  // namespace aureole

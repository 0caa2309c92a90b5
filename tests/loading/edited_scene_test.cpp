// SPDX-License-Identifier: Apache-2.0
// A scene that is edited must be the one that its text says: scenes are edited at random places and compared,
// bit for bit, with a scene that is read anew from the edited text. Meanwhile another thread renders the
// scene of before, which must stay what it was.
#include <gtest/gtest.h>

#include <fstream>
#include <random>
#include <thread>

#include "aureole/loading/document.h"
#include "harness/paths.h"
#include "loading/pixels.h"

namespace aureole {
namespace {

using test::pixels_of;

/// Another value for a parameter, as an element; empty where this test changes no such one.
std::string changed(const Node& node, std::mt19937& random) {
  const auto number = [&](const std::string& text) -> std::string {
    char* end = nullptr;
    const double v = std::strtod(text.c_str(), &end);
    if (end == text.c_str() || *end) return "";
    const double factors[] = {0.9, 0.5, 1.1, 0.0};
    return std::to_string(v * factors[random() % 4]);
  };
  const std::string value = node.get("value");
  if (node.tag == "boolean")
    return "<boolean value=\"" + std::string(value == "true" ? "false" : "true") + "\"/>";
  if (node.tag == "float" || node.tag == "spectrum") {
    const std::string v = number(value);
    return v.empty() ? "" : "<float value=\"" + v + "\"/>";
  }
  if (node.tag == "rgb")
    return "<rgb value=\"" + std::to_string(double(random() % 100) / 100) + ", 0.3, 0.2\"/>";
  if (node.tag == "transform")
    return "<transform><rotate x=\"0.3\" y=\"1\" angle=\"" + std::to_string(random() % 90) +
           "\"/></transform>";
  const std::string family = object_family(node);
  if (family == "emitter") {
    const bool on_shape = node.get("type").ends_with("area");
    return on_shape ? "<emitter type=\"area\"><rgb name=\"radiance\" value=\"" +
                          std::to_string(random() % 4) + ", 1, 2\"/></emitter>"
                    : "<emitter type=\"constant\"/>";
  }
  if (family == "shape") {
    const char* const shapes[] = {
        "<shape type=\"cube\"/>", "<shape type=\"sphere\"><emitter type=\"area\"/></shape>",
        "<shape type=\"rectangle\"><bsdf type=\"twosided\"><bsdf type=\"conductor\"/></bsdf></shape>"};
    return shapes[random() % 3];
  }
  if (family == "sensor")
    return R"(<sensor type="perspective"><float name="fov" value="40"/><transform name="to_world">
      <lookat origin="1, 4, 6" target="0, 0, 0" up="0, 1, 0"/></transform><film type="hdrfilm">
      <integer name="width" value="12"/><integer name="height" value="8"/></film></sensor>)";
  if (family == "bsdf")
    return random() % 2 ? "<bsdf type=\"diffuse\"/>"
                        : "<bsdf type=\"roughconductor\"><float name=\"alpha\" value=\"0.3\"/></bsdf>";
  return "";
}

/// A random child of a shape: an emitter or nothing.
std::string hung(std::mt19937& random) {
  const char* const elements[] = {
      "", "<emitter type=\"area\"><float name=\"radiance\" value=\"0.7\"/></emitter>"};
  return elements[random() % 2];
}

/// Edits a document at random places and compares.
class Editing {
public:
  Editing(SceneDocument& document, const std::filesystem::path& file, unsigned seed)
      : document_(document), file_(file), random_(seed), pixels_(pixels_of(document.loaded())) {}

  /// One edit, if the place that was chosen can be edited.
  void step() {
    const std::vector<std::string> paths = document_.paths();
    std::string path = paths[random_() % paths.size()];
    const Node* node = document_.find(path);
    ASSERT_NE(node, nullptr) << path;
    std::string element;
    const bool hangs = object_family(*node) == "shape" && node->get("type") != "shapegroup" &&
                       node->get("type") != "instance" && random_() % 2;
    if (hangs) {
      path += ".emitter";
      element = hung(random_);
    } else {
      element = changed(*node, random_);
      if (element.empty()) return;
    }
    edit(path, element);
  }
  void edit(const std::string& path, const std::string& element) {
    SCOPED_TRACE(path + " = " + element);
    const std::string before = document_.xml();
    const LoadedScene old = document_.loaded();
    std::vector<float> meanwhile;
    std::thread renders([&] { meanwhile = pixels_of(old); });
    try {
      document_.edit({{path, element}});
    } catch (const Error& e) {
      // Not all values are allowed. Then nothing has changed.
      renders.join();
      ++refused;
      refusals += path + ": " + e.what() + "\n";
      ASSERT_EQ(document_.xml(), before);
      ASSERT_EQ(document_.scene(), old.scene);
      ASSERT_EQ(meanwhile, pixels_);
      return;
    }
    std::vector<float> edited = pixels_of(document_.loaded());
    renders.join();
    ++done;
    ASSERT_EQ(meanwhile, pixels_) << "the scene of before has changed";
    const SceneDocument fresh(document_.xml(), file_);
    ASSERT_EQ(fresh.xml(), document_.xml());
    ASSERT_EQ(edited, pixels_of(fresh.loaded()));
    pixels_ = std::move(edited);
  }

  int done = 0, refused = 0;
  std::string refusals;

private:
  SceneDocument& document_;
  std::filesystem::path file_;
  std::mt19937 random_;
  std::vector<float> pixels_;
};

class EditedScene : public ::testing::TestWithParam<std::string> {};

TEST_P(EditedScene, IsTheSceneOfItsText) {
  const std::filesystem::path file = test::source_dir() / "tests/references/scenes" / GetParam();
  SceneDocument document(file);
  Editing editing(document, file, 1);
  for (int round = 0; round < 16 && !HasFatalFailure(); ++round) editing.step();
  RecordProperty("changes", editing.done);
  RecordProperty("refused", editing.refused);
}

std::vector<std::string> reference_scenes() {
  std::vector<std::string> names;
  for (const auto& entry :
       std::filesystem::directory_iterator(test::source_dir() / "tests/references/scenes"))
    if (entry.path().extension() == ".xml") names.push_back(entry.path().filename());
  std::sort(names.begin(), names.end());
  return names;
}

INSTANTIATE_TEST_SUITE_P(References, EditedScene, ::testing::ValuesIn(reference_scenes()),
                         [](const auto& info) {
                           std::string name = std::filesystem::path(info.param).stem();
                           for (char& c : name)
                             if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
                           return name;
                         });

/// Two materials, two triangles.
const char* const kObj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nusemtl wood\nf 1 2 3\nusemtl iron\nf 2 4 3\n";

/// A scene with all that edits may touch: shapes that emit, that share a material or an emitter, that are
/// instanced, of several parts, with attributes.
const char* const kScene =
    R"(<scene version="3.0.0"><integrator type="path"><integer name="max_depth" value="4"/></integrator>
  <sensor type="perspective" id="camera"><float name="fov" value="50"/>
    <transform name="to_world"><lookat origin="1, 5, 7" target="0, 0, 0" up="0, 1, 0"/></transform>
    <film type="hdrfilm"><integer name="width" value="12"/><integer name="height" value="9"/></film></sensor>
  <bsdf type="diffuse" id="wood"><rgb name="reflectance" value="0.6, 0.3, 0.1"/></bsdf>
  <bsdf type="roughconductor" id="iron"><float name="alpha" value="0.2"/></bsdf>
  <emitter type="area" id="glow"><float name="radiance" value="0.5"/></emitter>
  <emitter type="constant" id="sky"><float name="radiance" value="0.2"/></emitter>
  <emitter type="point" id="bulb"><point name="position" x="1" y="4" z="1"/></emitter>
  <shape type="rectangle" id="floor"><ref id="wood"/><transform name="to_world">
    <scale value="6"/><rotate x="1" angle="-90"/><translate y="-1"/></transform></shape>
  <shape type="sphere" id="ball"><float name="radius" value="0.8"/><ref id="iron"/></shape>
  <shape type="rectangle" id="lamp"><ref id="glow"/><transform name="to_world">
    <rotate x="1" angle="90"/><translate x="-2" y="3"/></transform></shape>
  <shape type="disk" id="second_lamp"><ref id="glow"/><transform name="to_world">
    <rotate x="1" angle="90"/><translate x="2" y="3"/></transform></shape>
  <shape type="shapegroup" id="tree">
    <shape type="cylinder" id="trunk"><float name="radius" value="0.1"/><ref id="wood"/></shape>
    <shape type="cube" id="crown"><bsdf type="mask" id="leaves"><float name="opacity" value="0.7"/>
      <bsdf type="twosided"><bsdf type="diffuse"/></bsdf></bsdf><transform name="to_world">
      <scale value="0.3"/><translate z="1"/></transform></shape>
  </shape>
  <shape type="instance" id="left"><ref id="tree"/><transform name="to_world"><translate x="-2"/></transform></shape>
  <shape type="instance" id="right"><ref id="tree"/><transform name="to_world"><translate x="2"/></transform></shape>
  <shape type="obj" id="two"><string name="filename" value="two.obj"/><transform name="to_world">
    <translate z="1"/></transform></shape>
  <shape type="ply" id="painted"><string name="filename" value="painted.ply"/><bsdf type="twosided"><bsdf type="diffuse">
    <texture name="reflectance" type="mesh_attribute" id="paint"><string name="name" value="vertex_color"/></texture></bsdf></bsdf></shape>
</scene>)";
const char* const kPly =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
    "property float r\nproperty float g\nproperty float b\nproperty float heat_x\nelement face 1\n"
    "property list uchar int vertex_indices\nend_header\n"
    "-1 0 2 .8 .1 .1 .2\n0 0 2 .1 .7 .2 .4\n-1 1 2 .2 .2 .9 .6\n3 0 1 2\n";

/// The folder of that scene and its files.
class SceneFolder {
public:
  SceneFolder()
      : path_(std::filesystem::temp_directory_path() / ("aureole-edited-" + std::to_string(::getpid()))) {
    std::filesystem::create_directories(path_);
    std::ofstream(path_ / "two.obj") << kObj;
    std::ofstream(path_ / "painted.ply") << kPly;
  }
  ~SceneFolder() { std::filesystem::remove_all(path_); }
  std::filesystem::path file() const { return path_ / "scene.xml"; }

private:
  std::filesystem::path path_;
};

class EditedSceneOfEverything : public ::testing::TestWithParam<unsigned> {};

TEST_P(EditedSceneOfEverything, IsTheSceneOfItsText) {
  const SceneFolder folder;
  SceneDocument document(std::string(kScene), folder.file());
  Editing editing(document, folder.file(), 100 + GetParam());
  for (int round = 0; round < 40 && !HasFatalFailure(); ++round) editing.step();
  EXPECT_GT(editing.done, 10);
}

TEST(EditedSceneByHand, IsTheSceneOfItsText) {
  const SceneFolder folder;
  SceneDocument document(std::string(kScene), folder.file());
  Editing editing(document, folder.file(), 1);
  const std::pair<const char*, const char*> edits[] = {
      {"glow.radiance", "<float value='2'/>"},
      {"lamp", ""},
      {"left.to_world", "<transform><translate x='-1' z='1'/></transform>"},
      {"leaves.opacity", "<float value='1'/>"},
      {"trunk.radius", "<float value='0.3'/>"},
      {"trunk.bsdf", "<ref id='iron'/>"},
      {"iron", "<bsdf type='diffuse'><float name='reflectance' value='0.9'/></bsdf>"},
      {"two.bsdf", "<ref id='wood'/>"},
      {"two.bsdf", ""},
      {"two.emitter", "<emitter type='area'/>"},
      {"two.emitter", ""},
      {"wood", "<bsdf type='conductor'/>"},
      {"paint.name", "<string value='vertex_heat'/>"},
      {"paint.name", "<string value='vertex_nothing'/>"},
      {"paint", "<float value='0.5'/>"},
      {"painted.bsdf", "<bsdf type='diffuse'/>"},
      {"ball.emitter", "<ref id='glow'/>"},
      {"second_lamp.emitter", ""},
      {"camera.film.width", "<integer value='15'/>"},
      {"camera",
       "<sensor type='orthographic'><transform name='to_world'><scale value='4'/>"
       "<lookat origin='1, 5, 7' target='0, 0, 0' up='0, 1, 0'/></transform><film type='hdrfilm'>"
       "<integer name='width' value='9'/><integer name='height' value='9'/></film></sensor>"},
      {"sky", ""},
      {"floor.sensor", "<sensor type='irradiancemeter'/>"},
      {"camera",
       "<sensor type='batch'><film type='hdrfilm'><integer name='width' value='2'/><integer name='height' "
       "value='1'/>"
       "</film><ref id='floor'/><shape type='sphere'><sensor type='irradiancemeter'/></shape></sensor>"},
      {"floor.to_world", "<transform><scale value='2'/><rotate x='1' angle='-80'/></transform>"},
  };
  for (const auto& [path, element] : edits) {
    editing.edit(path, element);
    if (HasFatalFailure()) return;
  }
  // An attribute that the mesh lacks, and a number where an object was that others know by its id.
  EXPECT_EQ(editing.refused, 2) << editing.refusals;
}

INSTANTIATE_TEST_SUITE_P(Sequences, EditedSceneOfEverything, ::testing::Range(0u, 8u));

}  // namespace
}  // namespace aureole

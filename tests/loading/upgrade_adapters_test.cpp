// SPDX-License-Identifier: Apache-2.0
#include "aureole/loading/upgrade_adapters.h"

#include <gtest/gtest.h>

#include <sstream>

#include "aureole/loading/load.h"
#include "aureole/loading/parse.h"
#include "aureole/loading/upgrade.h"

namespace aureole {
namespace {

struct Upgraded : Diagnostics {
  explicit Upgraded(const std::string& element)
      : scene(parse_scene("old.xml", "<scene version='0.6.0'>\n" + element + "</scene>", {}, *this)) {
    upgrade(scene.root, *this);
  }
  ParsedScene scene;
  Node& node() { return scene.root.children.at(0); }
};

/// "blendbsdf(0.25: a, b)"; a `ref` is its id.
std::string outline(const Node& node) {
  if (node.tag == "ref") return node.get("id");
  if (node.get("type") != "blendbsdf") return node.get("type");
  std::ostringstream text;
  text << "blend(" << std::stod(node.children.at(0).get("value")) << ": " << outline(node.children.at(1))
       << ", " << outline(node.children.at(2)) << ")";
  return text.str();
}
std::string mixture(const std::string& weights, const std::string& nested) {
  return "<bsdf type='mixturebsdf' id='m'><string name='weights' value='" + weights + "'/>" + nested +
         "</bsdf>";
}
const std::string kA = "<bsdf type='conductor'/>", kB = "<bsdf type='plastic'/>", kC = "<ref id='c'/>";

TEST(UpgradeAdapters, MixturesBecomeChainsOfBlends) {
  // b has 1/4 of all, of which c has 2/5.
  EXPECT_EQ(outline(Upgraded(mixture("0.75, 0.25", kA + kB)).node()), "blend(0.25: conductor, plastic)");
  EXPECT_EQ(outline(Upgraded(mixture("0.5 0.3,0.2", kA + kB + kC)).node()),
            "blend(0.5: conductor, blend(0.4: plastic, c))");
  // Weights below one absorb.
  EXPECT_EQ(outline(Upgraded(mixture("0.5, 0.25", kA + kB)).node()),
            "blend(0.5: conductor, blend(0.5: plastic, diffuse))");
  EXPECT_EQ(outline(Upgraded(mixture("0.7", kA)).node()), "blend(0.3: conductor, diffuse)");
  EXPECT_EQ(outline(Upgraded(mixture("1", kA)).node()), "blend(0: conductor, diffuse)");
  EXPECT_EQ(outline(Upgraded(mixture("0, 0", kA + kB)).node()),
            "blend(1: conductor, blend(1: plastic, diffuse))");
  Upgraded more(mixture("3, 1", kA + kB));
  EXPECT_EQ(outline(more.node()), "blend(0.25: conductor, plastic)");
  EXPECT_EQ(more.notes().size(), 2u);
  EXPECT_EQ(more.node().get("id"), "m");
}

TEST(UpgradeAdapters, WrongMixturesAreOneError) {
  const auto error = [](const std::string& xml) {
    try {
      load_scene_from_string("<scene version='0.6.0'>\n<sensor type='perspective'/>\n<shape type='sphere'>" +
                                 xml + "</shape></scene>",
                             "old.xml");
    } catch (const ErrorList& list) {
      EXPECT_EQ(list.errors().size(), 1u);
      return list.errors().front();
    }
    return std::string();
  };
  EXPECT_EQ(error(mixture("0.5, 0.5", kA + kB)), "");
  EXPECT_NE(error(mixture("0.5", kA + kB)).find("old.xml:3:"), std::string::npos);
  EXPECT_NE(error(mixture("0.5", kA + kB)).find("there are 1 weights for 2 nested BSDFs"), std::string::npos);
  EXPECT_NE(error(mixture("0.5, -1", kA + kB)).find("negative"), std::string::npos);
  EXPECT_NE(error(mixture("0.5, x", kA + kB)).find("weights"), std::string::npos);
  EXPECT_NE(error("<bsdf type='mixturebsdf'>" + kA + "</bsdf>").find("needs the parameter \"weights\""),
            std::string::npos);
}

TEST(UpgradeAdapters, BumpAndNormalMaps) {
  Upgraded bump(
      "<bsdf type='bumpmap'><texture type='scale'><float name='scale' value='40'/><texture "
      "type='bitmap'/></texture>" +
      kA + "</bsdf>");
  EXPECT_EQ(bump.node().children.at(0).get("type"), "bitmap");
  EXPECT_EQ(bump.node().named_child("scale")->get("value"), "40");
  Upgraded plain("<bsdf type='bumpmap'><texture type='bitmap'/>" + kA + "</bsdf>");
  EXPECT_EQ(plain.node().children.size(), 2u);
  Upgraded normal("<bsdf type='normalmap'><texture type='bitmap'/>" + kA + "</bsdf>");
  EXPECT_EQ(normal.node().children.at(0).get("name"), "normalmap");
}

}  // namespace
}  // namespace aureole

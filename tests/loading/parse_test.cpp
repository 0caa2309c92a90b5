// SPDX-License-Identifier: Apache-2.0
#include "aureole/loading/parse.h"

#include <gtest/gtest.h>

#include "loading/load_text.h"

namespace aureole {
namespace {

using Defines = std::vector<std::pair<std::string, std::string>>;

struct Parsed : Diagnostics {
  explicit Parsed(const std::string& text, const Defines& defines = {},
                  const std::filesystem::path& file = "test.xml")
      : scene(parse_scene(file, text, defines, *this)) {}
  ParsedScene scene;
  const Node& child(std::size_t i) const { return scene.root.children.at(i); }
};

std::string in_scene(const std::string& content) { return test::kHead + content + "\n</scene>"; }

TEST(Parse, KeepsPlacesOfElementsAndValues) {
  const Parsed p(
      in_scene("<!-- ä --> <shape type='a\nb'>\n\t<float name=\"r\"  value=\"1 &lt; 2\"/></shape>"));
  ASSERT_FALSE(p.has_errors());
  const Node& shape = p.child(0);
  EXPECT_EQ(shape.where.str(), "test.xml:2:12");  // columns count characters, not bytes
  EXPECT_EQ(shape.find("type")->where.str(), "test.xml:2:25");
  EXPECT_EQ(shape.children[0].where.str(), "test.xml:4:2");
  EXPECT_EQ(shape.children[0].find("value")->where.str(), "test.xml:4:26");
  EXPECT_EQ(shape.children[0].get("value"), "1 < 2");
}

// Places are found in a time that does not grow with the length of the line: with one that does this takes a minute.
TEST(Parse, KeepsPlacesInALongLine) {
  constexpr int kCount = 20000;
  const std::string comment =
      "<!-- \xc3\xa4\xe2\x82\xac\xf0\x9d\x84\x9e -->";  // characters of 2, 3 and 4 bytes
  const std::string element = "<float name='r' value='1'/>";
  std::string line;
  for (int i = 0; i < kCount; ++i) line += comment + element;
  const Parsed p(in_scene(line));
  ASSERT_EQ(p.scene.root.children.size(), std::size_t(kCount));
  for (int i = 0; i < kCount; ++i) {
    const int column = 1 + i * int(12 + element.size()) + 12;
    ASSERT_EQ(p.child(std::size_t(i)).where.column, column) << i;
    ASSERT_EQ(p.child(std::size_t(i)).find("value")->where.column, column + 23) << i;
    ASSERT_EQ(p.child(std::size_t(i)).where.line, 2);
  }
}

TEST(Parse, LocatesSyntaxErrors) {
  const Parsed p("<scene version=\"3.0.0\">\n  <shape type=\"a\">\n</scene>");
  ASSERT_EQ(p.errors().size(), 1u);
  EXPECT_TRUE(p.errors()[0].starts_with("test.xml:3:")) << p.errors()[0];
  EXPECT_NE(p.errors()[0].find("not valid XML"), std::string::npos);
  EXPECT_FALSE(Parsed("").scene.complete);
}

TEST(Parse, NeedsAVersionOfThreeNumbers) {
  EXPECT_EQ(Parsed("<scene></scene>").errors().at(0),
            "test.xml:1:1: <scene> needs a version: write version=\"3.0.0\"");
  for (const char* bad : {"3", "3.0", "3.0.x", "3.0.0.1", ""})
    EXPECT_EQ(Parsed("<scene version='" + std::string(bad) + "'/>").errors().size(), 1u) << bad;
  EXPECT_EQ(Parsed("<scene version='0.6.12'/>").scene.files[0]->version, (SceneVersion{0, 6, 12}));
  EXPECT_EQ(Parsed("<shape version='3.0.0'/>").errors().at(0),
            "test.xml:1:1: the root element must be <scene>, not <shape>");
}

TEST(Parse, RefusesTextBetweenElements) {
  EXPECT_EQ(Parsed(in_scene("<float>5</float>")).errors().at(0),
            "test.xml:2:8: text outside of attributes in <float>");
}

TEST(Parameters, SubstituteWholeNames) {
  const std::string text = in_scene(
      "<default name='res' value='7'/><default name='resx' value='8'/>"
      "<a v='$res,$resx;$res'/><b v='\\$res'/><c v='$res.xml'/>");
  const Parsed p(text);
  ASSERT_FALSE(p.has_errors());
  EXPECT_EQ(p.child(0).get("v"), "7,8;7");
  EXPECT_EQ(p.child(1).get("v"), "$res");
  EXPECT_EQ(p.child(2).get("v"), "7.xml");
}

TEST(Parameters, LongerUndefinedNameIsAnError) {
  const Parsed p(in_scene("<default name='res' value='7'/>\n<integer value='$resx'/>"));
  ASSERT_EQ(p.errors().size(), 1u);
  EXPECT_EQ(p.errors()[0], "test.xml:3:17: undefined $resx; did you mean $res?");
  EXPECT_TRUE(p.child(0).attributes[0].failed);
}

TEST(Parameters, UndefinedNameWithoutNeighbours) {
  const Parsed p(in_scene("<integer value='$spp'/><integer value='$ 5'/>"));
  ASSERT_EQ(p.errors().size(), 2u);
  EXPECT_NE(p.errors()[0].find("undefined $spp; define it with -D spp=..."), std::string::npos)
      << p.errors()[0];
  EXPECT_NE(p.errors()[1].find("write \\$"), std::string::npos);
}

TEST(Parameters, DefaultComesFirstAndCommandLineWins) {
  EXPECT_EQ(Parsed(in_scene("<a v='$x'/><default name='x' value='1'/>")).errors().size(), 1u);
  const Parsed p(in_scene("<default name='x' value='1'/><a v='$x'/>"), {{"x", "2"}});
  EXPECT_FALSE(p.has_errors());
  EXPECT_EQ(p.child(0).get("v"), "2");
}

TEST(Parameters, UnusedDefineIsAnError) {
  const Parsed p(in_scene("<default name='spp' value='1'/><a v='$spp'/>"), {{"sp", "2"}});
  ASSERT_EQ(p.errors().size(), 1u);
  EXPECT_EQ(p.errors()[0], "test.xml: -D sp=2 is not used: the scene has no $sp; did you mean \"spp\"?");
}

TEST(Include, SplicesScenesRelativeToTheIncludingFile) {
  const test::TemporaryFolder folder;
  const auto main = folder.write("main.xml", in_scene("<include filename='parts/a.xml'/><last/>"));
  folder.write("parts/a.xml",
               "<scene version='0.6.0'><default name='x' value='9'/><include filename='b.xml'/></scene>");
  folder.write("parts/b.xml", "<shape version='3.0.0' type='$x'/>");
  Diagnostics d;
  const ParsedScene s = parse_scene(main, {}, {}, d);
  ASSERT_FALSE(d.has_errors()) << d.errors()[0];
  ASSERT_EQ(s.root.children.size(), 2u);
  EXPECT_EQ(s.root.children[0].get("type"), "9");
  EXPECT_EQ(s.root.children[0].where.file, (folder.path / "parts/b.xml").string());
  EXPECT_EQ(s.root.children[0].file->included_by->version, (SceneVersion{0, 6, 0}));
  EXPECT_EQ(s.root.children[1].tag, "last");
}

TEST(Include, SearchesThePathFolders) {
  const test::TemporaryFolder folder;
  const auto main = folder.write("main.xml", in_scene("<path value='lib'/><include filename='a.xml'/>"));
  folder.write("lib/a.xml", in_scene("<shape type='found'/>"));
  Diagnostics d;
  EXPECT_EQ(parse_scene(main, {}, {}, d).root.children.at(0).get("type"), "found");
  EXPECT_EQ(Parsed(in_scene("<path value='no-such-folder'/>")).errors().at(0),
            "test.xml:2:14: no such folder: no-such-folder");
}

TEST(Include, MissingFileAndRecursionAreErrors) {
  const Parsed missing(in_scene("<include filename='gone.xml'/>"));
  EXPECT_EQ(missing.errors().at(0),
            "test.xml:2:20: cannot read the included file \"gone.xml\": no such file");
  EXPECT_FALSE(missing.scene.complete);

  const test::TemporaryFolder folder;
  const auto main = folder.write("main.xml", in_scene("<include filename='a.xml'/>"));
  folder.write("a.xml", in_scene("<include filename='main.xml'/>"));
  Diagnostics d;
  parse_scene(main, {}, {}, d);
  ASSERT_EQ(d.errors().size(), 1u);
  EXPECT_EQ(d.errors()[0],
            (folder.path / "a.xml").string() + ":2:20: recursive include: \"main.xml\" includes itself");
}

TEST(Include, ErrorsNameTheIncludingFile) {
  const test::TemporaryFolder folder;
  const auto main = folder.write("main.xml", in_scene("\n<include filename='a.xml'/>"));
  folder.write("a.xml", "<scene version='3.0.0'>\n<oops");
  try {
    load_scene(main);
    FAIL();
  } catch (const ErrorList& list) {
    ASSERT_FALSE(list.errors().empty());
    const std::string& e = list.errors()[0];
    EXPECT_TRUE(e.starts_with((folder.path / "a.xml").string() + ":2:")) << e;
    EXPECT_NE(e.find("included from " + main.string() + ":3:1"), std::string::npos) << e;
  }
}

}  // namespace
}  // namespace aureole

// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "aureole/loading/aliases.h"
#include "aureole/loading/load.h"
#include "loading/test_plugins.h"

namespace aureole {
namespace {

using test::error_of;
using test::errors_of;
using test::errors_of_file;
using test::load_text;
using test::problem;
using test::TestBsdf;

TEST(Build, PluginsReportTypesRangesAndUnits) {
  EXPECT_EQ(problem("<string name='amount' value='1'/>"),
            "parameter \"amount\" of \"test_bsdf\": expected a float, got a string");
  EXPECT_EQ(problem("<float name='amount' value='-1'/>"),
            "parameter \"amount\" of \"test_bsdf\": must be in [0, 1], got -1");
  EXPECT_NE(problem("<float name='thickness' value='5'/>").find("needs a unit"), std::string::npos);
  EXPECT_NE(problem("<string name='thickness' value='5'/>").find("has no unit"), std::string::npos);
  EXPECT_NE(problem("<string name='thickness' value='5 ells'/>").find("unknown unit \"ells\""),
            std::string::npos);
  EXPECT_EQ(problem("<float name='amuont' value='1'/>"),
            "unknown parameter \"amuont\" of \"test_bsdf\"; did you mean \"amount\"?");
  EXPECT_EQ(problem("<texture type='test_texture'/>"), "\"test_bsdf\" has no use for this child object");
  EXPECT_EQ(error_of("<texture type='test_texture'><string name='message' value='throw'/></texture>"),
            "test.xml:3:1: \"test_texture\": thrown by the plug-in");
}

TEST(Build, UnknownPlugins) {
  EXPECT_EQ(error_of("<bsdf type='test_bdsf'/>"),
            "test.xml:3:13: unknown bsdf \"test_bdsf\"; did you mean \"test_bsdf\"?");
  const std::string far = error_of("<bsdf type='zzzzzzzzzzzzzzzz'/>");
  EXPECT_NE(far.find("; there are: "), std::string::npos) << far;
  EXPECT_NE(far.find("test_bsdf"), std::string::npos) << far;
  EXPECT_EQ(error_of("<bsdf/>"), "test.xml:3:1: <bsdf> needs the attribute \"type\"");
}

TEST(Build, UnknownElements) {
  EXPECT_EQ(error_of("<bdsf type='a'/>"), "test.xml:3:1: unknown element <bdsf>; did you mean \"bsdf\"?");
  EXPECT_EQ(problem("<flaot name='amount' value='1'/>"), "unknown element <flaot>; did you mean \"float\"?");
  EXPECT_EQ(problem("<scale value='1'/>"), "<scale> belongs inside <transform>");
  EXPECT_EQ(error_of("<phase type='hgg'/>"), "test.xml:3:14: unknown phase \"hgg\"; did you mean \"hg\"?");
  EXPECT_EQ(error_of("<string name='lenght_unit' value='mm'/>"),
            "test.xml:3:1: unknown parameter \"lenght_unit\" of the scene; did you mean \"length_unit\"?");
}

TEST(Build, StandInsForPluginsOfMitsuba) {
  ASSERT_TRUE(find_alias("sampler", "ldsampler"));
  EXPECT_EQ(find_alias("sampler", "ldsampler")->replacement, "sobol");
  EXPECT_EQ(find_alias("integrator", "volpathmis")->replacement, "path");
  EXPECT_FALSE(find_alias("sampler", "independent"));
  EXPECT_FALSE(find_alias("integrator", "ldsampler"));
}

TEST(Build, NeedsASensor) {
  EXPECT_EQ(errors_of_file("<scene version='3.0.0'>\n<integrator type='test_integrator'/></scene>"),
            std::vector<std::string>{"test.xml:1:1: the scene has no <sensor>"});
}

TEST(Build, SecondSensorIsANoteSecondIntegratorAnError) {
  const LoadedParts s = load_text("<sensor type='whatever'/>");
  ASSERT_EQ(s.notes.size(), 1u);
  EXPECT_EQ(s.notes[0], "test.xml:3:1: only the first sensor is used; this one is ignored");
  EXPECT_EQ(error_of("<integrator type='test_integrator'/>"),
            "test.xml:3:1: a scene has one integrator: the first is at test.xml:2:1");
}

TEST(References, ShareOneObjectAndMayComeFirst) {
  TestBsdf::instances = 0;
  const LoadedParts s = load_parts(
      "test.xml",
      test::kHead +
          "<integrator type='test_integrator'/><sensor type='test_sensor'><ref id='b'/><ref name='n' id='c'/>"
          "<ref id='a'/></sensor>"
          "<bsdf type='test_bsdf' id='a'><ref id='b'/></bsdf><bsdf type='test_bsdf' id='b'/><alias id='b' "
          "as='c'/></scene>",
      {});
  const std::vector<ObjectPtr> found = test::children_of_sensor(s);
  ASSERT_EQ(found.size(), 3u);
  EXPECT_EQ(found[0], found[1]);
  EXPECT_EQ(std::dynamic_pointer_cast<TestBsdf>(found[2])->children.at(0), found[0]);
  EXPECT_EQ(TestBsdf::instances, 2);
}

TEST(References, UnknownDuplicateAndCircular) {
  EXPECT_EQ(error_of("<bsdf type='test_bsdf' id='wall'/>\n<bsdf type='test_bsdf'><ref id='wal'/></bsdf>"),
            "test.xml:4:33: no object has the id \"wal\"; did you mean \"wall\"?");
  EXPECT_EQ(error_of("<bsdf type='test_bsdf' id='a'/>\n<bsdf type='test_bsdf' id='a'/>"),
            "test.xml:4:28: the id \"a\" is taken: first given at test.xml:3:1");
  EXPECT_EQ(error_of("<bsdf type='test_bsdf' id='a'><ref id='b'/></bsdf>\n<bsdf type='test_bsdf' id='b'><ref "
                     "id='a'/></bsdf>"),
            "test.xml:4:31: circular reference: \"a\" -> \"b\" -> \"a\"");
  EXPECT_EQ(error_of("<bsdf type='test_bsdf' id='a'><ref id='a'/></bsdf>"),
            "test.xml:3:31: circular reference: \"a\" -> \"a\"");
  EXPECT_EQ(error_of("<alias id='x' as='y'/>"), "test.xml:3:12: no object has the id \"x\"");
}

TEST(References, FailedObjectsAreReportedOnce) {
  EXPECT_EQ(error_of("<bsdf type='nonsense' id='a'/><bsdf type='test_bsdf'><ref id='a'/></bsdf>"
                     "<bsdf type='test_bsdf'><ref id='a'/></bsdf>")
                .substr(0, 13),
            "test.xml:3:13");
}

TEST(Errors, AllAtOnceInTheOrderOfLines) {
  const auto errors = errors_of(
      "<bsdf type='test_bsdf'><ref id='late'/></bsdf>\n"                            // 3: fails silently
      "<bsdf type='test_bsdf'><float name='amount' value='2'/></bsdf>\n"            // 4: range
      "<bsdf type='test_bsdf'><integer name='count' value='$n'/>\n"                 // 5: undefined
      "<float name='amonut' value='1'/></bsdf>\n"                                   // 6: unknown parameter
      "<bsdf type='test_bsdf' id='late'><float name='amount' value='x'/></bsdf>\n"  // 7: not a number
      "<emitter type='tset_emitter'/>",                                             // 8: unknown plug-in
      {{{"unused", "1"}}, "", "", {}, {}});
  ASSERT_EQ(errors.size(), 6u) << ::testing::PrintToString(errors);
  EXPECT_TRUE(errors[0].starts_with("test.xml: -D unused=1"));
  for (int i = 1; i < 6; ++i)
    EXPECT_TRUE(errors[std::size_t(i)].starts_with("test.xml:" + std::to_string(i + 3) + ":"))
        << errors[std::size_t(i)];
}

TEST(Errors, MissingFiles) {
  const std::string e = problem("<string name='filename' value='gone.obj'/>");
  EXPECT_TRUE(e.starts_with("no such file: \"gone.obj\" (looked in ")) << e;
  // Unknown ids are not reported if a missing file may define them.
  EXPECT_EQ(errors_of("<include filename='gone.xml'/><bsdf type='test_bsdf'><ref id='there'/></bsdf>").size(),
            1u);
}

TEST(Files, AreFoundBesideTheFileItsIncludersAndInPathFolders) {
  const test::TemporaryFolder folder;
  folder.write("a.txt", "a");
  folder.write("lib/b.txt", "b");
  folder.write("parts/c.txt", "c");
  const std::string head = test::kHead + "<integrator type='test_integrator'/><sensor type='test_sensor'>";
  folder.write("parts/part.xml",
               "<bsdf version='3.0.0' type='test_bsdf'><string name='filename' value='c.txt'/></bsdf>");
  folder.write("parts/part2.xml",
               "<bsdf version='3.0.0' type='test_bsdf'><string name='filename' value='a.txt'/></bsdf>");
  const auto main =
      folder.write("m.xml", test::kHead + "<path value='lib'/>" + head.substr(test::kHead.size()) +
                                "<bsdf type='test_bsdf'><string name='filename' value='b.txt'/></bsdf>"
                                "<include filename='parts/part.xml'/><include filename='parts/part2.xml'/>"
                                "</sensor></scene>");
  const std::vector<ObjectPtr> found = test::children_of_sensor(load_parts(main, {}, {}));
  const auto file = [&](std::size_t i) { return std::dynamic_pointer_cast<TestBsdf>(found.at(i))->file; };
  EXPECT_EQ(file(0), folder.path / "lib/b.txt");
  EXPECT_EQ(file(1), folder.path / "parts/c.txt");
  EXPECT_EQ(file(2), folder.path / "a.txt");
}

}  // namespace
}  // namespace aureole

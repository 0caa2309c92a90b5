// SPDX-License-Identifier: Apache-2.0
// Every registered parameter is read by an example and every parameter that is read is documented (Properties
// throws otherwise); docs/plugins.md is what the registrations say.
#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>
#include <set>
#include <sstream>

#include "aureole/asset/asset.h"
#include "aureole/plugin/registry.h"
#include "harness/paths.h"
#include "harness/properties_builder.h"

namespace aureole::test {
namespace {

bool is_real(const PluginInfo& p) { return !p.name.starts_with("test_"); }

/// Needs arrays, which only a program can give: no scene file can hold an example
/// (tests/python/test_scene.py reads every parameter).
bool is_for_programs(const PluginInfo& p) {
  for (const ParameterDoc& row : p.doc.parameters)
    if (row.type == "array" && row.fallback == "required") return true;
  return false;
}

TEST(Documentation, EveryPluginSaysWhatItIs) {
  int count = 0;
  for (const PluginInfo& p : Registry::instance().all()) {
    if (!is_real(p)) continue;
    ++count;
    EXPECT_FALSE(p.doc.summary.empty()) << p.family << " " << p.name;
    EXPECT_EQ(p.doc.examples.empty(), is_for_programs(p)) << p.family << " " << p.name;
    std::set<std::string> names;
    for (const auto& row : p.doc.parameters) {
      EXPECT_TRUE(names.insert(row.name).second) << p.name << " documents " << row.name << " twice";
      EXPECT_FALSE(row.type.empty() || row.fallback.empty() || row.meaning.empty())
          << p.name << " " << row.name;
    }
  }
  EXPECT_GT(count, 30);
}

TEST(Documentation, EveryParameterIsReadByAnExample) {
  for (const PluginInfo& p : Registry::instance().all()) {
    if (!is_real(p) || is_for_programs(p)) continue;
    std::set<std::string> read;
    for (const std::string& example : p.doc.examples) {
      Diagnostics diagnostics;
      SCOPED_TRACE(p.family + " " + p.name + ": " + example);
      try {
        const auto context = testing::make_context(360, 830, &diagnostics);
        const Properties written = testing::read_properties(example, context, example_file);
        EXPECT_EQ(written.type(), p.name);
        Properties properties(p.name, "", {}, context, &p);
        for (const auto& e : written.entries()) properties.add(e.name, e.value, e.where);
        make_element(p, properties);
        properties.report_unused(diagnostics);
        for (const std::string& name : properties.queried()) read.insert(name);
      } catch (const std::exception& e) {
        ADD_FAILURE() << e.what();
      }
      EXPECT_TRUE(diagnostics.errors().empty()) << diagnostics.errors().front();
    }
    for (const auto& row : p.doc.parameters)
      EXPECT_TRUE(read.count(row.name))
          << p.family << " " << p.name << ": no example makes it read \"" << row.name << "\"";
    for (const auto& name : read)
      EXPECT_TRUE(p.documents(name)) << p.name << " reads the undocumented " << name;
  }
}

TEST(Documentation, PluginReferenceIsUpToDate) {
  const std::string command = aureole_binary().string() + " docs";
  std::FILE* pipe = popen(command.c_str(), "r");
  ASSERT_TRUE(pipe);
  std::string printed;
  char buffer[4096];
  for (size_t n; (n = fread(buffer, 1, sizeof buffer, pipe)) > 0;) printed.append(buffer, n);
  ASSERT_EQ(pclose(pipe), 0);
  std::ifstream in(source_dir() / "docs/plugins.md");
  std::stringstream stored;
  stored << in.rdbuf();
  EXPECT_EQ(printed, stored.str()) << "run `make docs`";
}

}  // namespace
}  // namespace aureole::test

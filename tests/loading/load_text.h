// SPDX-License-Identifier: Apache-2.0
// Shared by the tests of the scene reader: loading text and inspecting its errors.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "aureole/loading/load.h"
#include "aureole/loading/stages.h"

namespace aureole::test {

inline const std::string kHead = "<scene version=\"3.0.0\">\n";
/// An integrator and a sensor of the plug-ins in test_plugins.h.
inline const std::string kRequired = "<integrator type=\"test_integrator\"/><sensor type=\"test_sensor\"/>\n";

/// A scene with everything it needs; `content` starts on line 3.
inline std::string scene_text(const std::string& content) {
  return kHead + kRequired + content + "\n</scene>\n";
}

/// The objects of a scene; the plug-ins in test_plugins.h make objects, not a whole scene.
inline LoadedParts load_text(const std::string& content, const LoadOptions& options = {}) {
  return load_parts("test.xml", scene_text(content), options);
}

/// Errors of a whole scene file given as text.
inline std::vector<std::string> errors_of_file(const std::string& text, const LoadOptions& options = {},
                                               const std::filesystem::path& file = "test.xml") {
  try {
    load_parts(file, text, options);
  } catch (const ErrorList& list) {
    return list.errors();
  }
  return {};
}

inline std::vector<std::string> errors_of(const std::string& content, const LoadOptions& options = {}) {
  return errors_of_file(scene_text(content), options);
}

/// The only error of a scene with `content`.
inline std::string error_of(const std::string& content, const LoadOptions& options = {}) {
  const auto errors = errors_of(content, options);
  EXPECT_EQ(errors.size(), 1u) << content << "\n" << ::testing::PrintToString(errors);
  return errors.empty() ? "" : errors.front();
}

/// A folder that is removed at the end of the test.
class TemporaryFolder {
public:
  TemporaryFolder() {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    path = std::filesystem::temp_directory_path() /
           ("aureole-" + std::string(test->test_suite_name()) + "-" + test->name());
    std::filesystem::remove_all(path);
    std::filesystem::create_directories(path);
  }
  ~TemporaryFolder() { std::filesystem::remove_all(path); }

  std::filesystem::path write(const std::string& name, const std::string& text) const {
    std::filesystem::create_directories((path / name).parent_path());
    std::ofstream(path / name) << text;
    return path / name;
  }

  std::filesystem::path path;
};

}  // namespace aureole::test

// SPDX-License-Identifier: Apache-2.0
// Where the tests find the repository and the program. The two paths are compiled into paths.cpp alone, so
// that a compiler cache serves every checkout.
#pragma once

#include <filesystem>
#include <string>

namespace aureole::test {

const std::filesystem::path& source_dir();
const std::filesystem::path& aureole_binary();

/// The file that a file name in an example of the documentation stands for: the one of the reference scenes
/// that has this name, or else any with the same extension; where there is none, one of the volumes in
/// tests/volume/data/heads.
std::filesystem::path example_file(const std::string& name);

}  // namespace aureole::test

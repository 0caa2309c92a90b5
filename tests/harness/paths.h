// SPDX-License-Identifier: Apache-2.0
// Where the tests find the repository and the program. The two paths are compiled into paths.cpp alone, so that a
// compiler cache serves every checkout.
#pragma once

#include <filesystem>

namespace aureole::test {

const std::filesystem::path& source_dir();
const std::filesystem::path& aureole_binary();

}  // namespace aureole::test

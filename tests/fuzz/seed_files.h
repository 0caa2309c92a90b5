// SPDX-License-Identifier: Apache-2.0
// Small files of the formats that no scene of the repository has.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace aureole::fuzz {

/// Name and content.
std::vector<std::pair<std::string, std::string>> seed_files();

}  // namespace aureole::fuzz

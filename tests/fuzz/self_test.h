// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace aureole::fuzz {

/// Plants every kind of failure among good cases; 0 where each is found, and nothing else.
int self_test(const std::filesystem::path& folder);

}  // namespace aureole::fuzz

// SPDX-License-Identifier: Apache-2.0
// One case: a scene of the corpus with some mutations. The same seed, number and repository give the same
// case.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "aureole/loading/load.h"
#include "fuzz/corpus.h"

namespace aureole::fuzz {

struct Case {
  std::string base;                    ///< name of the scene it was made from
  std::vector<std::string> mutations;  ///< in their order
  Files files;
  LoadOptions options;
};

Case make_case(const Corpus& corpus, std::uint64_t seed, std::uint64_t index);

/// Writes the files into `folder`, which is emptied first.
void write_case(const Case& c, const std::filesystem::path& folder);

}  // namespace aureole::fuzz

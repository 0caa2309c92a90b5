// SPDX-License-Identifier: Apache-2.0
// Loads and renders one case, and judges how it ends.
#pragma once

#include <filesystem>
#include <string>

#include "fuzz/fuzz_case.h"

namespace aureole::fuzz {

struct Verdict {
  enum Kind {
    picture,    ///< rendered; every pixel is finite
    refused,    ///< errors, each with file and line
    too_large,  ///< loads; the film is too large to be rendered here, some samples were
    too_slow,   ///< loads; some samples were rendered
    failed,     ///< what must not happen; `message` says what
    kinds
  } kind = failed;
  std::string message;  ///< the errors, or what failed
  std::uint64_t invalid_samples = 0;
};

/// The files of the case lie in `folder`. Crashes, hangs and memory are for the caller to see.
Verdict run_case(const Case& c, const std::filesystem::path& folder);

}  // namespace aureole::fuzz

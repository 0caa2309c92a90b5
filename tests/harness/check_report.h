// SPDX-License-Identifier: Apache-2.0
// The outcome of a check of a scattering function, told by a test.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "aureole/instrument/check/check_result.h"

namespace aureole::testing {

/// The problems of a check, in sentences that begin with `name` (letters, digits and underscores). The
/// histograms of failed chi-square tests are written into files of `folder`: direction, size, expected and
/// found counts of each bin.
std::vector<std::string> report(const std::string& name, const CheckResult& check,
                                const std::filesystem::path& folder);

}  // namespace aureole::testing

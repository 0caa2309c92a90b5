// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/check/check_result.h"

#include <algorithm>

namespace aureole {

const char* name_of(CheckRule rule) {
  constexpr const char* kNames[] = {"sample", "chi_square",    "delta_lobes", "density_integral",
                                    "energy", "sample_energy", "black",       "wavelengths",
                                    "modes",  "reciprocity",   "finite"};
  return kNames[int(rule)];
}

bool CheckResult::passed() const {
  return std::all_of(findings.begin(), findings.end(), [](const CheckFinding& f) { return f.passed; });
}

std::vector<std::string> CheckResult::problems() const {
  std::vector<std::string> sentences;
  for (const CheckFinding& f : findings)
    if (!f.passed) sentences.push_back(f.message);
  return sentences;
}

}  // namespace aureole

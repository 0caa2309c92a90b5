// SPDX-License-Identifier: Apache-2.0
#include "harness/check_report.h"

#include <cmath>
#include <fstream>

namespace aureole::testing {

namespace {

void dump(const CheckResult::Histogram& h, const std::filesystem::path& file) {
  std::ofstream out(file);
  out << "x,y,z,size,expected,found\n";
  for (const auto& b : h.bins)
    out << b.center.x << ',' << b.center.y << ',' << b.center.z << ',' << b.size << ',' << b.expected << ','
        << b.found << '\n';
}

}  // namespace

std::vector<std::string> report(const std::string& name, const CheckResult& check,
                                const std::filesystem::path& folder) {
  std::vector<std::string> failures;
  for (const std::string& problem : check.problems()) failures.push_back(name + ": " + problem);
  for (const auto& h : check.histograms)
    if (h.p_value < check.level) {
      const auto file = folder / (name + "_" + std::to_string(int(std::lround(1000 * h.wi.z))) + "_" +
                                  std::to_string(h.hero) + ".csv");
      dump(h, file);
      failures.push_back(name + ": histogram in " + file.string());
    }
  return failures;
}

}  // namespace aureole::testing

// SPDX-License-Identifier: Apache-2.0
// Runs ranges of cases in child processes, several at a time, and finds the case that crashed, hung, leaked
// or took too much memory. Portable to what has fork and /proc.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "fuzz/run_case.h"

namespace aureole::fuzz {

#if defined(__SANITIZE_ADDRESS__)
inline constexpr bool kFindsLeaks = true, kSanitized = true;
#elif defined(__SANITIZE_THREAD__)
inline constexpr bool kFindsLeaks = false, kSanitized = true;
#else
inline constexpr bool kFindsLeaks = false, kSanitized = false;
#endif

struct Limits {
  double seconds = kSanitized ? 120 : 20;  ///< processor time of a case
  double wall_seconds = 300;               ///< for those that wait for something that never comes
  double bytes = kSanitized ? 4e9 : 2e9;   ///< resident memory
};

struct Failure {
  std::uint64_t index;
  std::string what;  ///< one line
  std::string log;   ///< what the child printed: a sanitizer's report, a stack
};

struct Summary {
  std::array<std::uint64_t, Verdict::kinds> count{};
  std::uint64_t with_invalid_samples = 0;
  std::vector<std::uint64_t> invalid;  ///< some of those cases
  double slowest_seconds = 0;          ///< processor time
  std::uint64_t slowest = 0;
  std::vector<Failure> failures;
};

class Supervisor {
public:
  /// `run` is called in a child, with a folder of its own.
  using Run = std::function<Verdict(std::uint64_t index, const std::filesystem::path& folder)>;

  Supervisor(Run run, const Limits& limits, int jobs, std::filesystem::path folder)
      : run_(std::move(run)), limits_(limits), jobs_(jobs), folder_(std::move(folder)) {}

  /// Cases begin ... end - 1. `report` hears of every failure as it is found. Stops after `most_failures`.
  Summary run(std::uint64_t begin, std::uint64_t end, std::size_t most_failures,
              const std::function<void(const Failure&)>& report);

private:
  Run run_;
  Limits limits_;
  int jobs_;
  std::filesystem::path folder_;
};

}  // namespace aureole::fuzz

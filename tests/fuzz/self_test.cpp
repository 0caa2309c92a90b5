// SPDX-License-Identifier: Apache-2.0
#include "self_test.h"

#include <fmt/format.h>

#include <cstdlib>
#include <cstring>
#include <functional>
#include <map>
#include <stdexcept>
#include <thread>
#include <vector>

#include "aureole/core/error.h"
#include "supervisor.h"

namespace aureole::fuzz {

namespace {

volatile bool always = true;
volatile int zero = 0;
void* volatile forgotten = nullptr;

int overflow_the_stack(int n) {
  volatile char frame[4096];
  frame[0] = char(n);
  return always ? overflow_the_stack(n + 1) + frame[0] : 0;
}

Verdict take_memory() {
  std::vector<std::vector<char>> all;
  while (always) all.emplace_back(std::size_t(64) << 20, 'x');
  return {};
}

Verdict hang() {
  while (always) zero = 0;
  return {};
}

Verdict leak() {
  forgotten = std::malloc(1000);
  forgotten = nullptr;
  return {Verdict::picture, "", 0};
}

Verdict good() { return {Verdict::picture, "", 0}; }

}  // namespace

int self_test(const std::filesystem::path& folder) {
  const std::map<std::uint64_t, std::function<Verdict()>> planted = {
      {3, [] { return *static_cast<volatile char*>(nullptr) ? good() : good(); }},
      {4, []() -> Verdict { std::abort(); }},
      {20, [] { return overflow_the_stack(0) ? good() : good(); }},
      {49, hang},
      {50, take_memory},
      {77, []() -> Verdict { std::_Exit(3); }},
      {99,
       [] {
         return Verdict{Verdict::failed, "said so", 0};
       }},
      {101, []() -> Verdict { throw std::runtime_error("escapes"); }},
  };
  std::vector<std::uint64_t> expected;
  for (const auto& [index, plant] : planted) expected.push_back(index);
  constexpr std::uint64_t kLeak = 130;
  if (kSanitized) expected.push_back(kLeak);

  Limits limits;
  limits.seconds = 1;
  limits.bytes = kSanitized ? 2e9 : 5e8;
  Supervisor supervisor(
      [&](std::uint64_t index, const std::filesystem::path&) {
        const auto plant = planted.find(index);
        return plant != planted.end() ? plant->second() : index == kLeak && kSanitized ? leak() : good();
      },
      limits, 2, std::filesystem::absolute(folder));
  std::vector<std::uint64_t> found;
  supervisor.run(0, 160, 1000, [&](const Failure& f) {
    found.push_back(f.index);
    fmt::print("case {}: {}\n", f.index, f.what);
  });
  std::sort(found.begin(), found.end());
  if (found == expected) return 0;
  fmt::print("expected the cases {}, found {}\n", fmt::join(expected, " "), fmt::join(found, " "));
  return 1;
}

}  // namespace aureole::fuzz

// SPDX-License-Identifier: Apache-2.0
#include "fuzz/self_test.h"

#include <fmt/format.h>

#include <cstdlib>
#include <cstring>
#include <functional>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "aureole/core/error.h"
#include "fuzz/supervisor.h"

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
  struct Plant {
    std::function<Verdict()> run;
    std::string found_as;  ///< part of what must be said about it
  };
  std::map<std::uint64_t, Plant> planted = {
      {3, {[] { return *static_cast<volatile char*>(nullptr) ? good() : good(); }, ""}},
      {4, {[]() -> Verdict { std::abort(); }, ""}},
      {20, {[] { return overflow_the_stack(0) ? good() : good(); }, ""}},
      {49, {hang, "no end after"}},
      {50, {take_memory, "GiB of memory"}},
      {77, {[]() -> Verdict { std::_Exit(3); }, "exit code 3"}},
      {99,
       {[] {
          return Verdict{Verdict::failed, "said so", 0};
        },
        "said so"}},
      {101, {[]() -> Verdict { throw std::runtime_error("escapes"); }, ""}},
  };
  if (kFindsLeaks) planted[130] = {leak, "leak"};

  Limits limits;
  limits.seconds = kSanitized ? 5 : 1;
  limits.bytes = kSanitized ? 1e9 : 5e8;
  Supervisor supervisor(
      [&](std::uint64_t index, const std::filesystem::path&) {
        const auto plant = planted.find(index);
        return plant != planted.end() ? plant->second.run() : good();
      },
      limits, 2, std::filesystem::absolute(folder));
  int wrong = 0;
  supervisor.run(0, 160, 1000, [&](const Failure& f) {
    fmt::print("case {}: {}\n", f.index, f.what);
    const auto plant = planted.find(f.index);
    const bool expected = plant != planted.end() && f.what.find(plant->second.found_as) != std::string::npos;
    if (!expected) fmt::print("  unexpected\n"), ++wrong;
    planted.erase(f.index);
  });
  for (const auto& [index, plant] : planted) fmt::print("case {} was not found\n", index), ++wrong;
  return wrong;
}

}  // namespace aureole::fuzz

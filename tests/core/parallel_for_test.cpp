// SPDX-License-Identifier: Apache-2.0
#include "aureole/core/parallel_for.h"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>

#include "aureole/core/parallel.h"

namespace aureole {
namespace {

const std::pair<const char*, ParallelFor> kAll[] = {{"serial", serial_for},
                                                    {"one per core", std_thread_for()},
                                                    {"seven threads", std_thread_for(7)},
                                                    {"renderer", for_ranges}};

TEST(ParallelFor, VisitsEveryIndexOnce) {
  for (const auto& [name, parallel_for] : kAll)
    for (const std::size_t n : {0, 1, 5, 1000}) {
      std::vector<std::atomic<int>> visits(n);
      parallel_for(
          n,
          [&](std::size_t begin, std::size_t end) {
            EXPECT_LT(begin, end);
            for (std::size_t i = begin; i < end; ++i) ++visits[i];
          },
          3);
      for (const auto& v : visits) EXPECT_EQ(v, 1) << name << " " << n;
    }
}

TEST(ParallelFor, RethrowsAnException) {
  for (const auto& [name, parallel_for] : kAll) {
    const auto fails_at_17 = [](std::size_t begin, std::size_t end) {
      if (begin <= 17 && 17 < end) throw std::domain_error("17");
    };
    EXPECT_THROW(parallel_for(100, fails_at_17, 1), std::domain_error) << name;
  }
}

TEST(RunTogether, CallsBothAndRethrows) {
  const auto here = std::this_thread::get_id();
  int first = 0, second = 0;
  run_together([&] { first = std::this_thread::get_id() == here; }, [&] { second = 2; });
  EXPECT_EQ(first, 1);
  EXPECT_EQ(second, 2);
  EXPECT_THROW(run_together([] { throw std::domain_error("here"); }, [] {}), std::domain_error);
  EXPECT_THROW(run_together([] {}, [] { throw std::range_error("elsewhere"); }), std::range_error);
  EXPECT_THROW(
      run_together([] { throw std::domain_error("here"); }, [] { throw std::range_error("elsewhere"); }),
      std::domain_error);
}

}  // namespace
}  // namespace aureole

// SPDX-License-Identifier: Apache-2.0
// Memory of the records of a batch, and lists of its paths.
#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <span>
#include <thread>
#include <vector>

#include "aureole/transport/batch.h"

namespace aureole::testing {
namespace {

struct alignas(64) Record {
  float numbers[32] = {7};
};

std::uintptr_t address(const void* p) { return reinterpret_cast<std::uintptr_t>(p); }

TEST(Arena, RecordsAreAlignedAndDoNotOverlap) {
  const Arena::Frame frame;
  Arena& arena = frame.arena();
  std::uintptr_t end = 0;
  for (int count : {1, 0, 3, 16, 17}) {
    const std::span<Record> records = arena.make<Record>(std::size_t(count));
    ASSERT_EQ(records.size(), std::size_t(count));
    EXPECT_EQ(address(records.data()) % alignof(Record), 0u);
    if (count > 0) EXPECT_EQ(records.back().numbers[0], 7);
    EXPECT_GE(address(records.data()), end) << "within one block, addresses grow";
    end = address(records.data() + count);
  }
}

TEST(Arena, InnerFramesGiveBackWhatTheyTookAndNoMore) {
  const Arena::Frame outer;
  int* const kept = outer.arena().allocate<int>(100);
  for (int i = 0; i < 100; ++i) kept[i] = i;
  const void* first = nullptr;
  for (int round = 0; round < 3; ++round) {
    const Arena::Frame inner;
    ASSERT_EQ(&inner.arena(), &outer.arena()) << "one arena for each thread";
    // More than a block of the arena, so that a block is added in the first round.
    std::byte* const bytes = inner.arena().allocate<std::byte>(std::size_t(1) << 20);
    std::memset(bytes, 0xff, std::size_t(1) << 20);
    if (round == 0)
      first = bytes;
    else
      EXPECT_EQ(bytes, first) << "the memory is used again";
  }
  for (int i = 0; i < 100; ++i) ASSERT_EQ(kept[i], i);
  const std::uintptr_t after = address(outer.arena().allocate<int>(1));
  EXPECT_GE(after, address(kept + 100));
  EXPECT_LE(after, address(kept) + 512) << "in the next 64 bytes, or behind a gap for AddressSanitizer";
}

TEST(Arena, ErrorsEndFrames) {
  const Arena::Frame outer;
  const void* const next = [&] {
    const Arena::Frame inner;
    return inner.arena().allocate<int>(1);
  }();
  try {
    const Arena::Frame inner;
    inner.arena().allocate<int>(1000);
    throw 1;
  } catch (int) {
  }
  EXPECT_EQ(outer.arena().allocate<int>(1), next);
}

TEST(Arena, ThreadsHaveTheirOwn) {
  const Arena::Frame frame;
  const Arena* other = nullptr;
  std::thread([&] { other = &Arena::Frame().arena(); }).join();
  EXPECT_NE(other, &frame.arena());
}

TEST(PathLists, KeepTheirOrder) {
  const Arena::Frame frame;
  PathList list(frame.arena(), 40);
  EXPECT_TRUE(list.empty());
  for (int i = 0; i < 40; ++i) list.add(39 - i);
  list.keep([](int path) { return path % 13 == 0; });
  EXPECT_EQ(std::vector<int>(list.begin(), list.end()), (std::vector<int>{39, 26, 13, 0}));
  list.clear();
  EXPECT_TRUE(list.empty());
}

}  // namespace
}  // namespace aureole::testing

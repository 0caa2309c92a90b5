// SPDX-License-Identifier: Apache-2.0
#include "aureole/core/letter_case.h"

#include <gtest/gtest.h>

namespace aureole::test {
namespace {

TEST(LetterCase, LettersAloneChange) {
  EXPECT_EQ(lower_case("N-BK7 \xc3\x84_z"), "n-bk7 \xc3\x84_z");
  EXPECT_EQ(upper_case("begin_Data 1"), "BEGIN_DATA 1");
  EXPECT_TRUE(equal_without_case("Au", "aU"));
  EXPECT_FALSE(equal_without_case("Au", "Aug"));
}

TEST(LetterCase, ExtensionsAreThoseOfTheLastDot) {
  EXPECT_EQ(lower_extension("folder.EXR/picture.old.Png"), ".png");
  EXPECT_EQ(lower_extension("picture"), "");
  EXPECT_EQ(lower_extension(".EXR"), "");  // a hidden file without extension
}

}  // namespace
}  // namespace aureole::test

// SPDX-License-Identifier: Apache-2.0
// Places of values in JSON texts, against the offsets at which the text has them.
#include "aureole/instrument/paint/json_place.h"

#include <gtest/gtest.h>

namespace aureole::test {
namespace {

/// Line and column of a marker of which a text has one, counted byte by byte; the text before it in its line is ASCII.
std::pair<int, int> place_of_marker(const std::string& text, const std::string& marker) {
  int line = 1, column = 1;
  for (std::size_t i = 0; i < text.find(marker); ++i)
    if (text[i] == '\n')
      ++line, column = 1;
    else
      ++column;
  return {line, column};
}

std::pair<int, int> found(const std::string& text, const JsonPath& path) {
  const SourceLocation at = json_place("a.json", text, path);
  return {at.line, at.column};
}

TEST(JsonPlace, ValuesOfNestedTexts) {
  const std::string text =
      " {\"a\\\"]\": \"}, {\", \"b\" :[ 1.5e3,[],\n {\"c\":{\"d\":[true , 71, null]},\r\n\t\"e\": \"72\"},-73],\n\"f\":74}";
  EXPECT_EQ(found(text, {}), place_of_marker(text, "{"));
  EXPECT_EQ(found(text, {"a\"]"}), place_of_marker(text, "\"}, {"));
  EXPECT_EQ(found(text, {"b"}), place_of_marker(text, "[ 1.5"));
  EXPECT_EQ(found(text, {"b", std::size_t(0)}), place_of_marker(text, "1.5e3"));
  EXPECT_EQ(found(text, {"b", std::size_t(1)}), place_of_marker(text, "[],"));
  EXPECT_EQ(found(text, {"b", std::size_t(2), "c", "d", std::size_t(1)}), place_of_marker(text, "71"));
  EXPECT_EQ(found(text, {"b", std::size_t(2), "c", "d", std::size_t(2)}), place_of_marker(text, "null"));
  EXPECT_EQ(found(text, {"b", std::size_t(2), "e"}), place_of_marker(text, "\"72"));
  EXPECT_EQ(found(text, {"b", std::size_t(3)}), place_of_marker(text, "-73"));
  EXPECT_EQ(found(text, {"f"}), place_of_marker(text, "74"));
  EXPECT_EQ(json_path_text({"b", std::size_t(2), "c", "d", std::size_t(1)}), "b[2].c.d[1]");
}

TEST(JsonPlace, CharactersKeysTwiceAndPathsThatEnd) {
  // The second of two members with one key counts. Characters of several bytes are one column, and a mark of byte
  // order is none.
  EXPECT_EQ(found("{\"\xC3\xA4\": 1, \"a\": 2,\n \"a\": [3]}", {"a", std::size_t(0)}), std::pair(2, 8));
  EXPECT_EQ(found("{\"\xC3\xA4\xE2\x82\xAC\": 1, \"a\": 2}", {"a"}), std::pair(1, 16));
  EXPECT_EQ(found("\xEF\xBB\xBF{\"a\": 2}", {"a"}), std::pair(1, 7));
  // A key may be written by its code.
  EXPECT_EQ(found("{\"\\u0061\": 2}", {"a"}), std::pair(1, 12));
  // A path that the text does not have leads to its last part that exists.
  EXPECT_EQ(found("{\"a\": [1, 2]}", {"a", std::size_t(5)}), std::pair(1, 7));
  EXPECT_EQ(found("{\"a\": [1, 2]}", {"a", "b"}), std::pair(1, 7));
  EXPECT_EQ(found("", {"a"}), std::pair(1, 1));
  const std::string deep = "[" + std::string(100000, '[') + std::string(100000, ']') + ",\n7]";
  EXPECT_EQ(found(deep, {std::size_t(1)}), std::pair(2, 1));
}

}  // namespace
}  // namespace aureole::test

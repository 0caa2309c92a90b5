// SPDX-License-Identifier: Apache-2.0
// Scene files that nobody writes, and that must not end the program, run forever or fill the memory.
#include <gtest/gtest.h>

#include <chrono>

#include "aureole/loading/encoding.h"
#include "loading/test_plugins.h"

namespace aureole {
namespace {

using test::error_of;
using test::errors_of;
using test::errors_of_file;

std::string repeated(const std::string& text, int times) {
  std::string all;
  for (int i = 0; i < times; ++i) all += text;
  return all;
}

TEST(Limits, DeepNestingIsOneError) {
  for (const int depth : {300, 200000}) {
    const std::string text = repeated("<bsdf type=\"test_bsdf\">\n", depth) + repeated("</bsdf>", depth);
    EXPECT_EQ(error_of(text), "test.xml:258:1: elements are nested more than 256 deep");
  }
  const std::string good = repeated("<bsdf type=\"test_bsdf\">", 200) + repeated("</bsdf>", 200);
  EXPECT_TRUE(errors_of(good).empty());
}

TEST(Limits, LongChainsOfReferencesAreAnError) {
  const auto chain = [](int length) {
    std::string text;
    for (int i = 0; i < length; ++i)
      text += "<bsdf type=\"test_bsdf\" id=\"b" + std::to_string(i) + "\"><ref id=\"b" +
              std::to_string(i + 1) + "\"/></bsdf>\n";
    return text + "<bsdf type=\"test_bsdf\" id=\"b" + std::to_string(length) + "\"/>";
  };
  EXPECT_TRUE(errors_of(chain(400)).empty());
  for (const int length : {1000, 20000}) {
    const std::string error = error_of(chain(length));
    EXPECT_NE(error.find("objects are nested more than 512 deep, references included"), std::string::npos)
        << error;
  }
  // The other way around: every object is known already when the next one refers to it.
  std::string text = "<bsdf type=\"test_bsdf\" id=\"b0\"/>\n";
  for (int i = 0; i < 1000; ++i)
    text += "<bsdf type=\"test_bsdf\" id=\"b" + std::to_string(i + 1) + "\"><ref id=\"b" + std::to_string(i) +
            "\"/></bsdf>\n";
  EXPECT_NE(error_of(text).find("nested more than 512 deep"), std::string::npos);
}

TEST(Limits, ReferencesThatDoubleAtEveryLevelAreAnError) {
  const auto tree = [](int levels) {
    std::string text;
    for (int i = 0; i < levels; ++i) {
      const std::string next = "<ref id=\"b" + std::to_string(i + 1) + "\"/>";
      text += "<bsdf type=\"test_bsdf\" id=\"b" + std::to_string(i) + "\">" + next + next + "</bsdf>\n";
    }
    return text + "<bsdf type=\"test_bsdf\" id=\"b" + std::to_string(levels) + "\"/>";
  };
  EXPECT_TRUE(errors_of(tree(12)).empty());
  const std::string error = error_of(tree(100));
  EXPECT_NE(error.find("the references below this bsdf lead to more than 10000 objects"), std::string::npos)
      << error;
}

TEST(Limits, ACycleMayCloseByNesting) {
  // The reference leads to the inner object, whose own one leads to the outer one, which holds the inner one.
  const std::string error = error_of(
      "<ref id=\"inner\"/>\n<bsdf type=\"test_bsdf\" id=\"outer\"><bsdf type=\"test_bsdf\" id=\"inner\">"
      "<ref id=\"outer\"/></bsdf></bsdf>");
  EXPECT_NE(error.find("circular reference"), std::string::npos) << error;
}

TEST(Limits, ParametersThatDoubleEachOther) {
  std::string text = "<default name=\"p0\" value=\"12345678\"/>";
  for (int i = 1; i < 60; ++i) {
    const std::string before = "$p" + std::to_string(i - 1);
    text += "\n<default name=\"p" + std::to_string(i) + "\" value=\"" + before + before + "\"/>";
  }
  const auto errors = errors_of(text);
  ASSERT_FALSE(errors.empty());
  EXPECT_NE(errors[0].find("make the scene longer than 64 MiB"), std::string::npos) << errors[0];
}

TEST(Limits, IncludesThatDoubleAtEveryLevel) {
  const test::TemporaryFolder folder;
  for (int i = 0; i < 30; ++i) {
    const std::string next = "<include filename=\"" + std::to_string(i + 1) + ".xml\"/>";
    folder.write(std::to_string(i) + ".xml", test::kHead + next + next + "</scene>");
  }
  folder.write("30.xml", test::kHead + "<bsdf type=\"test_bsdf\"/></scene>");
  const auto errors =
      errors_of_file(test::scene_text("<include filename=\"0.xml\"/>"), {}, folder.path / "main.xml");
  ASSERT_EQ(errors.size(), 1u);
  EXPECT_NE(errors[0].find("more than 1000 files are included"), std::string::npos) << errors[0];
}

TEST(Limits, IncludesReadFilesOnly) {
  for (const auto& [name, kind] :
       {std::pair("/dev/zero", "device"), {"/dev/null", "device"}, {"/", "folder"}})
    EXPECT_EQ(error_of("<include filename=\"" + std::string(name) + "\"/>"),
              "test.xml:3:20: cannot read the included file \"" + std::string(name) +
                  "\": not a regular file but a " + kind);
}

TEST(Limits, ManyErrorsTakeNoTime) {
  std::string text;
  for (int i = 0; i < 50000; ++i) text += "<bdsf type=\"a\"/>\n";
  const auto start = std::chrono::steady_clock::now();
  EXPECT_EQ(errors_of(text).size(), 50000u);
  // A search through all of them for each would take a minute.
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(20));
}

TEST(Limits, LengthsAndWavelengthsAreFinite) {
  EXPECT_EQ(test::problem("<string name=\"thickness\" value=\"1e306km\"/>"),
            "parameter \"thickness\" of \"test_bsdf\": \"1e306km\" is out of range");
  const std::string film =
      "<integrator type=\"test_integrator\"/><sensor type=\"test_sensor\"><film type=\"test_film\">"
      "<string name=\"wavelength_max\" value=\"1e308um\"/></film></sensor>";
  EXPECT_EQ(errors_of_file(test::kHead + film + "</scene>").at(0),
            "test.xml:2:124: parameter \"wavelength_max\": \"1e308um\" is out of range");
}

TEST(Limits, WavelengthsThatSinglePrecisionHolds) {
  const auto error = [](const std::string& min, const std::string& max) {
    const auto errors = errors_of_file(
        test::kHead +
        "<integrator type=\"test_integrator\"/><sensor type=\"test_sensor\"><film type=\"test_film\">\n"
        "<string name=\"wavelength_min\" value=\"" +
        min + "\"/><string name=\"wavelength_max\" value=\"" + max + "\"/></film></sensor></scene>");
    return errors.empty() ? "" : errors.front();
  };
  EXPECT_EQ(error("1nm", "1km"), "");
  EXPECT_EQ(error("500", "3e38"),
            "test.xml:3:1: wavelengths from 500 to 3e+38 nm: only 1e-06 to 1e+15 nm can be computed with");
  EXPECT_NE(error("1e-300nm", "1"), "");
}

std::string encoded(const std::u32string& text, int bytes, bool big_endian, bool mark) {
  std::string out;
  for (const char32_t c : (mark ? U"\ufeff" : U"") + text) {
    std::vector<char32_t> units{c};
    if (bytes == 2 && c >= 0x10000)
      units = {0xd800 + ((c - 0x10000) >> 10), 0xdc00 + ((c - 0x10000) & 0x3ff)};
    for (const char32_t unit : units)
      for (int i = 0; i < bytes; ++i) out += char(unit >> 8 * (big_endian ? bytes - 1 - i : i));
  }
  return out;
}

TEST(Encoding, EveryUnicodeFormIsRead) {
  const std::u32string text = U"<scene version='3.0.0'>\n ü€😀</scene>";
  const std::string utf8 = "<scene version='3.0.0'>\n ü€😀</scene>";
  for (const int bytes : {2, 4})
    for (const bool big_endian : {false, true})
      for (const bool mark : {false, true})
        EXPECT_EQ(to_utf8(encoded(text, bytes, big_endian, mark)), utf8) << bytes << big_endian << mark;
  EXPECT_EQ(to_utf8("\xef\xbb\xbf" + utf8), utf8);
  EXPECT_EQ(to_utf8(utf8), utf8);
  EXPECT_EQ(to_utf8("<?xml version=\"1.0\" encoding=\"ISO-8859-1\"?>\xfc"),
            "<?xml version=\"1.0\" encoding=\"ISO-8859-1\"?>ü");
  // Halves of pairs alone, and a unit cut off.
  EXPECT_EQ(to_utf8(std::string("<\0\x00\xd8<\0\x00\xdc<", 9)), "<\ufffd<\ufffd");
}

TEST(Encoding, PlacesAreKnown) {
  const std::u32string text = U"<scene version='3.0.0'>\n<!-- 😀 --> <nonsense/></scene>";
  for (const int bytes : {2, 4})
    EXPECT_EQ(errors_of_file(encoded(text, bytes, false, true)).at(1),
              "test.xml:2:12: unknown element <nonsense>");
}

}  // namespace
}  // namespace aureole

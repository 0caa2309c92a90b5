// SPDX-License-Identifier: Apache-2.0
#include "fuzz/scene_values.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

namespace aureole::fuzz {

namespace {

const std::vector<std::string> kExtremes = {"0",
                                            "-0",
                                            "-1",
                                            "1",
                                            "2",
                                            "0.5",
                                            "1e-30",
                                            "1e-7",
                                            "1e-4",
                                            "1e4",
                                            "1e7",
                                            "1e15",
                                            "1e18",
                                            "1e20",
                                            "1e30",
                                            "-1e30",
                                            "3e38",
                                            "3.5e38",
                                            "-3.5e38",
                                            "1e-38",
                                            "1e-45",
                                            "1e-46",
                                            "1e300",
                                            "1e308",
                                            "-1e308",
                                            "5e-324",
                                            "0.99999994",
                                            "1.0000001",
                                            "0.999999999999",
                                            "-1e-9",
                                            "1e-12",
                                            "90",
                                            "180",
                                            "359.9999999",
                                            "360",
                                            "-360",
                                            "0.001",
                                            "-0.5"};
const std::vector<std::string> kIntegers = {"0",
                                            "-1",
                                            "1",
                                            "2",
                                            "3",
                                            "5",
                                            "16",
                                            "127",
                                            "128",
                                            "255",
                                            "256",
                                            "1000",
                                            "32767",
                                            "65535",
                                            "65536",
                                            "1000000",
                                            "16777216",
                                            "16777217",
                                            "2147483647",
                                            "2147483648",
                                            "-2147483648",
                                            "4294967295",
                                            "4294967296",
                                            "9007199254740993",
                                            "9223372036854775807",
                                            "-9223372036854775808"};
/// No numbers, or none that a double or an integer of 64 bits can hold.
const std::vector<std::string> kMalformed = {"nan",
                                             "-nan",
                                             "inf",
                                             "-inf",
                                             "1e309",
                                             "9223372036854775808",
                                             "18446744073709551616",
                                             "0x10",
                                             "1e",
                                             "1,5",
                                             "1 2",
                                             "--1",
                                             "+1",
                                             ".5",
                                             "5.",
                                             "1e5.5",
                                             "1_000",
                                             "½",
                                             "1f",
                                             "1e+2",
                                             "true",
                                             "",
                                             "1 ",
                                             " 1"};

const std::vector<std::string> kWords = {"true",
                                         "false",
                                         "TRUE",
                                         "path",
                                         "bk7",
                                         "air",
                                         "Au",
                                         "none",
                                         "auto",
                                         "ggx",
                                         "beckmann",
                                         "all",
                                         "5um",
                                         "500nm",
                                         "0.3um",
                                         "10GHz",
                                         "-5um",
                                         "0m",
                                         "1e300km",
                                         "1e-300nm",
                                         "50mm",
                                         "0mm",
                                         "#ff8000",
                                         "#12345g",
                                         "#",
                                         "rgb",
                                         "xyza",
                                         "400:1, 700:2",
                                         "400:1",
                                         "700:1, 400:2",
                                         "400:1 400:2",
                                         "0:1 1:1",
                                         "-5:1 700:1",
                                         "1um:1 2um:3",
                                         "400:nan 700:1",
                                         "400:1e308 700:-1e308",
                                         "1:1e38 1e30:1e38",
                                         "550:1e30 550.001:1e30",
                                         "x",
                                         "repeat",
                                         "nearest",
                                         "float16",
                                         "diffuse",
                                         "dielectric",
                                         "sphere"};

const std::vector<std::string> kOdd = {"",
                                       " ",
                                       "\t\n",
                                       "$",
                                       "$undefined",
                                       "\\$",
                                       "$a$b",
                                       "$a",
                                       "$a$a$a$a",
                                       "é",
                                       "日本語",
                                       "\xf0\x9f\x8c\x88",
                                       "\x7f",
                                       "&",
                                       "<",
                                       "\"",
                                       "'",
                                       "%s%n%d",
                                       "../scene.xml",
                                       "/dev/zero",
                                       "/dev/null",
                                       "/dev/stdin",
                                       "/",
                                       ".",
                                       "..",
                                       "scene.xml",
                                       "missing.xml",
                                       "missing.ply",
                                       "/proc/self/mem",
                                       "~",
                                       "C:\\scene.xml",
                                       "//",
                                       "a/../scene.xml",
                                       "{}",
                                       "\xff\xfe",
                                       "\xc3",
                                       "\xef\xbb\xbf"};

bool is_number(const std::string& text) {
  char* end = nullptr;
  if (text.empty() || std::isspace(static_cast<unsigned char>(text[0]))) return false;
  std::strtod(text.c_str(), &end);
  return *end == 0;
}

std::string changed_number(const std::string& old, Random& random) {
  const double v = std::strtod(old.c_str(), nullptr);
  switch (random.below(10)) {
    case 0:
      return fmt::format("{}", -v);
    case 1:
    case 2:
      return fmt::format("{}", v * std::pow(10, double(random.below(13)) - 6));
    case 3:
    case 4:
      return fmt::format("{:.6g}", v * (0.5 + random.unit()));
    case 5:
      return fmt::format("{}", v + double(random.below(5)) - 2);
    case 6:
      return plausible_number(random);
    default:
      return random.is_gentle() && random.chance(0.7) ? plausible_number(random) : extreme_number(random);
  }
}

/// The words of a text that lists choices: "x, y, diagonal, smaller or larger".
std::string word_of(const std::string& text, Random& random) {
  std::vector<std::string> words(1);
  for (const char c : text)
    if (std::isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '.')
      words.back() += c;
    else if (!words.back().empty())
      words.emplace_back();
  return random.pick(words);
}

std::string property(const char* tag, const std::string& name, const std::string& value) {
  return fmt::format("<{} name=\"{}\" value=\"{}\"/>", tag, escaped(name), escaped(value));
}

}  // namespace

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '"')
      out += "&quot;";
    else
      out += c;
  }
  return out;
}

std::string extreme_number(Random& random) {
  if (!random.is_gentle() && random.chance(0.1)) return random.pick(kMalformed);
  return random.pick(random.chance(0.3) ? kIntegers : kExtremes);
}

std::string any_integer(Random& random) {
  if (!random.is_gentle() && random.chance(0.1)) return extreme_number(random);
  return random.is_gentle() || random.chance(0.6) ? std::to_string(random.below(10)) : random.pick(kIntegers);
}

std::string plausible_number(Random& random) {
  switch (random.below(4)) {
    case 0:
      return std::to_string(random.below(10));
    case 1:
      return fmt::format("{:.3f}", random.unit());
    case 2:
      return fmt::format("{:.3f}", 20 * random.unit() - 10);
    default:
      return fmt::format("{:.4g}", std::pow(10, 8 * random.unit() - 4));
  }
}

std::string any_number(Random& random) {
  return random.chance(random.is_gentle() ? 0.95 : 0.7) ? plausible_number(random) : extreme_number(random);
}

std::string odd_text(Random& random) {
  if (random.chance(0.3)) return random.pick(kWords);
  if (random.chance(0.1)) {
    const std::string unit = random.chance(0.5) ? random.pick(kOdd) : any_number(random) + ", ";
    const std::size_t times = std::size_t(1) << random.below(15);
    std::string text;
    for (std::size_t i = 0; i < times; ++i) text += unit;
    return text;
  }
  return random.pick(kOdd);
}

std::string changed_value(const std::string& old, Random& random) {
  if (!random.is_gentle() && random.chance(0.05)) return odd_text(random);
  if (old == "true" || old == "false") return old == "true" ? "false" : "true";
  if (is_number(old)) return changed_number(old, random);
  // Lists keep their separators: commas, blanks, colons between wavelength and value.
  std::string out, word;
  std::size_t numbers = 0;
  for (const char c : old) numbers += c == ',' || c == ' ' || c == ':';
  const double each = numbers ? 1.5 / double(numbers) : 1;
  bool any = false;
  for (std::size_t i = 0; i <= old.size(); ++i) {
    if (i < old.size() && !std::strchr(", :\n", old[i])) {
      word += old[i];
      continue;
    }
    if (is_number(word) && random.chance(each)) word = changed_number(word, random), any = true;
    out += word;
    word.clear();
    if (i < old.size()) out += old[i];
  }
  return any ? out : random.is_gentle() ? old : random.pick(kWords);
}

std::string transform_xml(const std::string& name, Random& random) {
  std::string steps;
  const auto number = [&] { return any_number(random); };
  for (std::size_t i = random.few(4); i > 0; --i) {
    switch (random.below(6)) {
      case 0:
        steps += fmt::format("<translate x=\"{}\" y=\"{}\" z=\"{}\"/>", number(), number(), number());
        break;
      case 1:
        steps += fmt::format("<scale x=\"{}\" y=\"{}\" z=\"{}\"/>", number(), number(), number());
        break;
      case 2:
        steps += fmt::format("<scale value=\"{}\"/>", number());
        break;
      case 3:
        steps += fmt::format("<rotate x=\"{}\" y=\"{}\" z=\"{}\" angle=\"{}\"/>", number(), number(),
                             number(), number());
        break;
      case 4:
        steps += fmt::format("<lookat origin=\"{}, {}, {}\" target=\"{}, 0, 0\" up=\"0, {}, 1\"/>", number(),
                             number(), number(), number(), number());
        break;
      default: {
        std::string m;
        for (int k = 0; k < 16; ++k)
          m += k < 12 && random.chance(0.3) ? number() + " " : k % 5 == 0 ? "1 " : "0 ";
        steps += "<matrix value=\"" + m + "\"/>";
      }
    }
  }
  return "<transform name=\"" + escaped(name) + "\">" + steps + "</transform>";
}

const PluginInfo& any_plugin(const std::string& family, Random& random) {
  const Registry& registry = Registry::instance();
  // By way of the sorted names: the order of registration is the linker's.
  const std::vector<std::string> families = registry.families();
  const bool known = std::find(families.begin(), families.end(), family) != families.end();
  const std::string& chosen = known ? family : random.pick(families);
  const std::vector<std::string> names = registry.names(chosen);
  return *registry.find(chosen, random.pick(names));
}

std::string parameter_xml(const ParameterDoc& p, const Corpus& corpus, Random& random) {
  const std::string number = any_number(random);
  if (!random.is_gentle() && random.chance(0.05)) return property("string", p.name, odd_text(random));
  if (p.type == "integer") return property("integer", p.name, any_integer(random));
  if (p.type == "boolean") return property("boolean", p.name, random.chance(0.5) ? "true" : "false");
  if (p.type == "float") return property("float", p.name, number);
  if (p.type == "length" || p.type == "wavelength")
    return property("string", p.name, number + (random.chance(0.7) ? "um" : "nm"));
  if (p.type == "file") return property("string", p.name, random.pick(corpus.data_files()).first);
  if (p.type == "vector" || p.type == "point")
    return fmt::format("<{} name=\"{}\" x=\"{}\" y=\"{}\" z=\"{}\"/>", p.type, p.name, number,
                       any_number(random), any_number(random));
  if (p.type == "transform") return transform_xml(p.name, random);
  if (p.type == "texture" || p.type == "spectrum") {
    switch (random.below(4)) {
      case 0:
        return property("float", p.name, number);
      case 1:
        return property("rgb", p.name, number + ", " + any_number(random) + ", " + any_number(random));
      case 2:
        return property("spectrum", p.name, "400:" + number + ", 650:" + any_number(random));
      default:
        break;
    }
  }
  const auto examples = corpus.examples().find(p.type == "spectrum" ? "texture" : p.type);
  if (examples != corpus.examples().end()) {
    const std::string& xml = random.pick(examples->second);
    const std::size_t at = xml.find_first_of(" />", 1);
    return xml.substr(0, at) + " name=\"" + p.name + "\"" + xml.substr(at);
  }
  return property("string", p.name,
                  random.is_gentle() || random.chance(0.7)
                      ? word_of(random.chance(0.5) ? p.meaning : p.fallback, random)
                      : odd_text(random));
}

}  // namespace aureole::fuzz

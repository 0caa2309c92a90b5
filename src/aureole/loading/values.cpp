// SPDX-License-Identifier: Apache-2.0
#include "aureole/loading/values.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>

#include "aureole/core/input_file.h"
#include "aureole/core/letter_case.h"
#include "aureole/core/units.h"

namespace aureole {

namespace {

constexpr std::string_view kSpaces = " \t\r\n";

std::string_view trimmed(std::string_view s) {
  const auto first = s.find_first_not_of(kSpaces);
  return first == std::string_view::npos ? "" : s.substr(first, s.find_last_not_of(kSpaces) - first + 1);
}

std::string in_quotes(std::string_view s) { return "\"" + std::string(s) + "\""; }

bool parse_boolean(std::string_view text) {
  const std::string s = lower_case(trimmed(text));
  if (s == "true" || s == "false") return s == "true";
  throw Error(in_quotes(text) + " is not a boolean: write \"true\" or \"false\"");
}

std::int64_t parse_integer(std::string_view text) {
  std::string_view s = trimmed(text);
  if (!s.empty() && s.front() == '+') s.remove_prefix(1);
  std::int64_t value = 0;
  const auto [end, problem] = std::from_chars(s.data(), s.data() + s.size(), value);
  if (problem == std::errc::result_out_of_range)
    throw Error(in_quotes(text) + " is too large for an integer");
  if (problem != std::errc() || end != s.data() + s.size())
    throw Error(in_quotes(text) + " is not an integer");
  return value;
}

double parse_float(const Node& node, std::string_view text) {
  try {
    return parse_number(text);
  } catch (const Error& problem) {
    bool is_length = true;
    try {
      parse_wavelength_nm(text);
    } catch (const Error&) {
      is_length = false;
    }
    throw Error(problem.message() +
                (is_length ? "; a value with a unit is written <string name=" + in_quotes(node.get("name")) +
                                 " value=" + in_quotes(text) + "/>"
                           : ""));
  }
}

Vec3 parse_vector(const Node& node, Diagnostics& diagnostics) {
  std::vector<double> v;
  if (const Attribute* value = node.find("value")) {
    check_attributes(node, {"name", "value"}, {}, diagnostics);
    v = parse_numbers(value->value);
    if (v.size() == 1) v.assign(3, v[0]);
    if (v.size() != 3) throw Error(value->where, in_quotes(value->value) + " must have 1 or 3 numbers");
  } else {
    if (!check_attributes(node, {"name", "x", "y", "z"}, {}, diagnostics)) return {};
    for (const char* axis : {"x", "y", "z"}) v.push_back(parse_number(node.get(axis)));
  }
  return {float(v[0]), float(v[1]), float(v[2])};
}

/// Adds a point of a spectrum. The wavelengths must be monotonic; they decrease if frequencies are listed in
/// increasing order.
void add_point(SpectrumLiteral& s, double nm, double value) {
  if (!(nm > 0)) throw Error("the wavelength " + number_text(nm) + " nm is not positive");
  const bool falls = s.nm.size() > 1 && s.nm[1] < s.nm[0];
  if (!s.nm.empty() && (nm == s.nm.back() || (s.nm.size() > 1 && (nm < s.nm.back()) != falls)))
    throw Error("wavelengths must increase or decrease all the way, but " + number_text(nm) + " nm follows " +
                number_text(s.nm.back()) + " nm");
  s.nm.push_back(nm);
  s.values.push_back(value);
}

/// Sorts the points of a spectrum by increasing wavelength.
void put_in_order(SpectrumLiteral& s) {
  if (s.nm.front() < s.nm.back()) return;
  std::reverse(s.nm.begin(), s.nm.end());
  std::reverse(s.values.begin(), s.values.end());
}

/// Reads the wavelengths of one spectrum, in nm. `unit` applies to numbers without a unit; empty: nm is
/// assumed.
class WavelengthReader {
public:
  explicit WavelengthReader(std::string unit) : unit_(std::move(unit)) { stated_ = !unit_.empty(); }
  double operator()(std::string_view word) {
    if (word.find_first_not_of("0123456789+-.eE") != word.npos) {
      stated_ = true;
      return parse_wavelength_nm(word);
    }
    return unit_.empty() ? parse_wavelength_nm(word) : parse_wavelength_nm(std::string(word) + unit_);
  }
  void set_unit(std::string unit) { unit_ = std::move(unit), stated_ = true; }
  /// Whether every wavelength has a stated unit, so that none was assumed to be in nm.
  bool is_stated() const { return stated_; }

private:
  std::string unit_;
  bool stated_ = false;
};

SpectrumLiteral spectrum_of(const Node& node, Diagnostics& diagnostics) {
  const Attribute *value = node.find("value"), *file = node.find("filename"), *unit = node.find("unit");
  check_attributes(node, {"name"}, {"value", "filename", "unit"}, diagnostics);
  if (!value == !file) throw Error(node.where, "<spectrum> needs either \"value\", \"filename\" or \"type\"");
  try {
    if (unit) parse_wavelength_nm("1" + unit->value);
  } catch (const Error& e) {
    throw Error(unit->where, e.message());
  }
  const std::string& text = unit ? unit->value : "";
  return value ? parse_spectrum(value->value, text) : read_spectrum_file(file->value, text);
}

/// Whether a word begins like a number; other words begin header lines.
bool is_number_at_start(std::string_view word) {
  const auto digit = word.find_first_not_of("+-.");
  return digit != word.npos && word[digit] >= '0' && word[digit] <= '9';
}

/// Returns the unit of wavelengths that a header line names, such as "Wavelength (um)"; empty: none. Throws
/// Error for quantities that are not wavelengths.
std::string unit_named_in(std::string_view line) {
  static const std::map<std::string, std::string, std::less<>> kUnits = {{"nm", "nm"},
                                                                         {"nanometer", "nm"},
                                                                         {"nanometers", "nm"},
                                                                         {"nanometre", "nm"},
                                                                         {"nanometres", "nm"},
                                                                         {"um", "um"},
                                                                         {"µm", "um"},
                                                                         {"μm", "um"},
                                                                         {"micron", "um"},
                                                                         {"microns", "um"},
                                                                         {"micrometer", "um"},
                                                                         {"micrometers", "um"},
                                                                         {"micrometre", "um"},
                                                                         {"micrometres", "um"},
                                                                         {"angstrom", "angstrom"},
                                                                         {"angstroms", "angstrom"},
                                                                         {"å", "angstrom"},
                                                                         {"Å", "angstrom"},
                                                                         {"ev", "!"},
                                                                         {"cm-1", "!"},
                                                                         {"cm^-1", "!"},
                                                                         {"wavenumber", "!"},
                                                                         {"wavenumbers", "!"}};
  for (std::size_t begin = 0; begin < line.size();) {
    constexpr std::string_view kBetween = " \t,()[]{}/:_=";
    const std::size_t end = std::min(line.find_first_of(kBetween, begin), line.size());
    std::string word(line.substr(begin, end - begin));
    for (char& c : word)
      if (c >= 'A' && c <= 'Z') c = char(c - 'A' + 'a');
    if (const auto found = kUnits.find(word); found != kUnits.end()) {
      if (found->second == "!")
        throw Error("the header line names " + word + ", but a spectrum is given by wavelengths");
      return found->second;
    }
    begin = end + 1;
  }
  return "";
}

bool has_failed_attribute(const Node& node) {
  return std::any_of(node.attributes.begin(), node.attributes.end(),
                     [](const Attribute& a) { return a.failed; }) ||
         std::any_of(node.children.begin(), node.children.end(), has_failed_attribute);
}

Properties::Value convert(const Node& node, Diagnostics& diagnostics) {
  if (node.tag == "animation") return parse_animation(node, diagnostics);
  if (node.tag != "transform" && !node.children.empty())
    throw Error(node.children.front().where,
                "<" + node.tag + "> can't contain <" + node.children.front().tag + ">");
  if (node.tag == "point" || node.tag == "vector") return parse_vector(node, diagnostics);
  if (node.tag == "spectrum") return spectrum_of(node, diagnostics);
  if (node.tag == "transform") {
    check_attributes(node, {"name"}, {}, diagnostics);
    return parse_transform(node, diagnostics);
  }
  if (!check_attributes(node, {"name", "value"}, {}, diagnostics)) return false;
  const std::string text = node.get("value");
  if (node.tag == "boolean") return parse_boolean(text);
  if (node.tag == "integer") return parse_integer(text);
  if (node.tag == "float") return parse_float(node, text);
  if (node.tag == "rgb") return parse_rgb(text);
  return text;
}

}  // namespace

std::optional<Properties::Value> property_value(const Node& node, Diagnostics& diagnostics) {
  if (has_failed_attribute(node)) return {};
  Diagnostics own;
  std::optional<Properties::Value> value;
  try {
    value = convert(node, own);
  } catch (const Error& e) {
    // Errors without a location get the location of the value. An error in a spectrum file has its own line;
    // the location in the scene is put before it.
    const bool in_scene = !e.where().file.empty() && node.file && e.where().file == node.file->shown;
    const Attribute* text = node.find("value");
    const Attribute* file = node.find("filename");
    const SourceLocation here = text ? text->where : file ? file->where : node.where;
    const std::string name = node.get("name");
    if (in_scene)
      own.error(e);
    else
      own.error(here, (name.empty() ? "" : "parameter " + in_quotes(name) + ": ") + e.what());
  }
  for (const std::string& message : own.errors()) diagnostics.error({}, message);
  if (own.has_errors()) value.reset();
  return value;
}

std::vector<std::string_view> split_list(std::string_view text) {
  constexpr std::string_view separators = ", \t\r\n";
  std::vector<std::string_view> words;
  for (std::size_t begin = 0;
       (begin = text.find_first_not_of(separators, begin)) != std::string_view::npos;) {
    const std::size_t end = std::min(text.find_first_of(separators, begin), text.size());
    words.push_back(text.substr(begin, end - begin));
    begin = end;
  }
  return words;
}

std::vector<double> parse_numbers(std::string_view text) {
  std::vector<double> numbers;
  for (std::string_view word : split_list(text)) numbers.push_back(parse_number(word));
  return numbers;
}

SpectrumLiteral parse_rgb(std::string_view text) {
  SpectrumLiteral s;
  s.kind = SpectrumLiteral::Kind::rgb;
  const std::string_view t = trimmed(text);
  if (!t.empty() && t.front() == '#') {
    for (int i = 0; i < 3; ++i) {
      int byte = 0;
      const char* digits = t.data() + 1 + 2 * i;
      if (t.size() != 7 || std::from_chars(digits, digits + 2, byte, 16).ptr != digits + 2)
        throw Error(in_quotes(text) + " is not a colour of the form #rrggbb");
      s.rgb[i] = srgb_to_linear(byte / 255.0);
    }
    return s;
  }
  const std::vector<double> v = parse_numbers(t);
  if (v.size() != 1 && v.size() != 3) throw Error(in_quotes(text) + " must have 1 or 3 numbers");
  for (std::size_t i = 0; i < 3; ++i) s.rgb[i] = v[v.size() == 1 ? 0 : i];
  return s;
}

SpectrumLiteral parse_spectrum(std::string_view text, const std::string& unit) {
  SpectrumLiteral s;
  const auto words = split_list(text);
  if (words.size() == 1 && words[0].find(':') == std::string_view::npos) {
    s.value = parse_number(words[0]);
    return s;
  }
  s.kind = SpectrumLiteral::Kind::points;
  WavelengthReader wavelength(unit);
  for (std::string_view word : words) {
    const auto colon = word.find(':');
    if (colon == std::string_view::npos) throw Error(in_quotes(word) + " is not a \"wavelength:value\" pair");
    add_point(s, wavelength(word.substr(0, colon)), parse_number(word.substr(colon + 1)));
  }
  s.unit_is_stated = wavelength.is_stated();
  if (s.nm.size() < 2)
    throw Error(in_quotes(text) + " must be one number or at least two \"wavelength:value\" pairs");
  put_in_order(s);
  return s;
}

SpectrumLiteral read_spectrum_file(const std::filesystem::path& file, const std::string& unit) {
  std::istringstream stream = read_table_file(file);
  SpectrumLiteral s;
  s.kind = SpectrumLiteral::Kind::points;
  WavelengthReader wavelength(unit);
  std::string line;
  for (int number = 1; std::getline(stream, line); ++number) {
    if (number == 1 && line.starts_with("\xEF\xBB\xBF")) line.erase(0, 3);  // removes the byte order mark
    line.resize(std::min(line.find('#'), line.size()));
    std::replace_if(
        line.begin(), line.end(), [](char c) { return c == '"' || c == '\'' || c == ';'; }, ' ');
    const auto words = split_list(line);
    if (words.empty()) continue;
    try {
      if (s.nm.empty() && !is_number_at_start(words[0])) {
        const std::string named = unit_named_in(line);
        if (unit.empty() && !named.empty()) wavelength.set_unit(named);
        continue;
      }
      if (words.size() != 2) throw Error("expected two columns, wavelength and value");
      add_point(s, wavelength(words[0]), parse_number(words[1]));
    } catch (const Error& e) {
      throw Error({file.string(), number, 0}, e.message());
    }
  }
  if (s.nm.size() < 2)
    throw Error({file.string(), 0, 0}, "a spectrum needs at least two lines of wavelength and value");
  s.unit_is_stated = wavelength.is_stated();
  put_in_order(s);
  return s;
}

double srgb_to_linear(double v) {
  const double a = std::abs(v);
  return std::copysign(a <= 0.04045 ? a / 12.92 : std::pow((a + 0.055) / 1.055, 2.4), v);
}

std::string number_text(double value) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

}  // namespace aureole

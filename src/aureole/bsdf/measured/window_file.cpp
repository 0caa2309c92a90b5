// SPDX-License-Identifier: Apache-2.0
#include "aureole/bsdf/measured/window_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <pugixml.hpp>
#include <utility>

#include "aureole/core/input_file.h"
#include "aureole/core/letter_case.h"

namespace aureole {
namespace {

/// Upper bound of the file's size: text of 64 MB holds a tensor tree of 2^22 numbers, and the parser needs a
/// copy.
constexpr std::uint64_t kMaxWindowBytes = std::uint64_t(1) << 27;
constexpr std::size_t kMaxPatches = 4096, kMaxRings = 90;

std::string trimmed(std::string_view text) {
  const auto is_blank = [](unsigned char c) { return std::isspace(c) != 0; };
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return std::string(text);
}

/// The text of a file and the elements in it.
class WindowReader {
public:
  WindowReader(const std::filesystem::path& path, WindowFile& result)
      : path_(path.string()), result_(result) {
    result_.text = read_text_file(path, kMaxWindowBytes);
    for (std::size_t i = 0; i < result_.text.size(); ++i)
      if (result_.text[i] == '\n') line_ends_.push_back(i);
    const pugi::xml_parse_result parsed =
        document_.load_buffer(result_.text.data(), result_.text.size(),
                              pugi::parse_minimal | pugi::parse_trim_pcdata, pugi::encoding_utf8);
    if (!parsed)
      throw Error(at(std::size_t(parsed.offset)), fmt::format("not XML: {}", parsed.description()));
  }

  void read() {
    const pugi::xml_node root = document_.child("WindowElement");
    if (!root)
      throw Error(
          at(0),
          "there is no element <WindowElement>: not a file of scattering data (schema BSDF-v1.4 of LBNL)");
    const pugi::xml_node layer = child(child(root, "Optical"), "Layer");
    const pugi::xml_node definition = child(layer, "DataDefinition"),
                         structure = child(definition, "IncidentDataStructure");
    static const std::vector<std::pair<std::string, WindowFile::Structure>> kStructures = {
        {"Columns", WindowFile::Structure::columns},
        {"Rows", WindowFile::Structure::rows},
        {"TensorTree3", WindowFile::Structure::tree3},
        {"TensorTree4", WindowFile::Structure::tree4}};
    const std::string wanted = trimmed(structure.text().get());
    const auto found = std::find_if(kStructures.begin(), kStructures.end(),
                                    [&](const auto& s) { return equal_without_case(s.first, wanted); });
    if (found == kStructures.end())
      throw Error(at(structure),
                  fmt::format("<IncidentDataStructure> is \"{}\"; Columns, Rows, TensorTree3 and TensorTree4 "
                              "are known",
                              wanted.substr(0, 80)));
    result_.structure = found->second;
    result_.structure_where = at(structure);
    for (const pugi::xml_node basis : definition.children("AngleBasis")) read_basis(basis);
    result_.bases.insert(result_.bases.end(), known_angle_bases().begin(), known_angle_bases().end());
    for (const pugi::xml_node data : layer.children("WavelengthData")) read_wavelengths(data);
    if (result_.blocks.empty())
      throw Error(at(layer), "there is no <WavelengthDataBlock> of the visible range with a known direction");
  }

private:
  SourceLocation at(std::size_t offset) const {
    const auto line = std::lower_bound(line_ends_.begin(), line_ends_.end(), offset);
    const std::size_t begin = line == line_ends_.begin() ? 0 : *std::prev(line) + 1;
    return {path_, int(line - line_ends_.begin()) + 1, int(offset - begin) + 1};
  }
  SourceLocation at(pugi::xml_node node) const {
    return at(std::size_t(std::max<std::ptrdiff_t>(node.offset_debug(), 0)));
  }

  pugi::xml_node child(pugi::xml_node parent, const char* name) const {
    const pugi::xml_node found = parent.child(name);
    if (!found) throw Error(at(parent), fmt::format("<{}> has no element <{}>", parent.name(), name));
    return found;
  }

  double number(pugi::xml_node node) const {
    NumberReader reader(node.text().get(), at(node));
    return reader.number();
  }

  void read_basis(pugi::xml_node node) {
    AngleBasis basis;
    basis.name = trimmed(child(node, "AngleBasisName").text().get());
    for (const pugi::xml_node block : node.children("AngleBasisBlock")) {
      const pugi::xml_node bounds = child(block, "ThetaBounds");
      const double lower = number(child(bounds, "LowerTheta")), upper = number(child(bounds, "UpperTheta")),
                   azimuths = number(child(block, "nPhis"));
      const double expected = basis.rings.empty() ? 0 : basis.rings.back().upper;
      if (std::abs(lower - expected) > 1e-4 * std::max(expected, 1.0) || !(upper > lower) || upper > 90.0001)
        throw Error(
            at(bounds),
            fmt::format("a ring from {:g} to {:g} degrees; it must begin at {:g} and end at 90 or before",
                        lower, upper, expected));
      if (!(azimuths >= 1 && azimuths <= double(kMaxPatches)) || azimuths != std::floor(azimuths))
        throw Error(at(block),
                    fmt::format("<nPhis> is {:g}; 1 to {} azimuths are expected", azimuths, kMaxPatches));
      if (basis.rings.size() >= kMaxRings)
        throw Error(at(block), fmt::format("more than {} rings of angles", kMaxRings));
      basis.rings.push_back({expected, std::min(upper, 90.0), int(azimuths)});
    }
    if (basis.rings.empty()) throw Error(at(node), "<AngleBasis> has no <AngleBasisBlock>");
    if (basis.size() > kMaxPatches)
      throw Error(at(node), fmt::format("<AngleBasis> has {} patches; at most {} are allowed", basis.size(),
                                        kMaxPatches));
    result_.bases.push_back(std::move(basis));
  }

  void skip(const std::string& what) {
    const std::string text = what.substr(0, 80);
    if (std::find(result_.skipped.begin(), result_.skipped.end(), text) == result_.skipped.end() &&
        result_.skipped.size() < 20)
      result_.skipped.push_back(text);
  }

  void read_wavelengths(pugi::xml_node data) {
    const std::string range = trimmed(child(data, "Wavelength").text().get());
    const bool is_x = equal_without_case(range, "CIE-X"), is_z = equal_without_case(range, "CIE-Z");
    if (!is_x && !is_z && !equal_without_case(range, "Visible")) return skip("the range \"" + range + "\"");
    for (const pugi::xml_node node : data.children("WavelengthDataBlock")) {
      WindowBlock block;
      block.channel = is_x ? 0 : is_z ? 2 : 1;
      const std::string direction = trimmed(child(node, "WavelengthDataDirection").text().get());
      block.is_transmission = equal_without_case(direction.substr(0, 12), "Transmission");
      block.is_front =
          direction.size() > 5 && equal_without_case(direction.substr(direction.size() - 5), "Front");
      const std::string known = fmt::format("{} {}", block.is_transmission ? "Transmission" : "Reflection",
                                            block.is_front ? "Front" : "Back");
      if (!equal_without_case(direction, known)) {
        skip("the direction \"" + direction + "\"");
        continue;
      }
      if (result_.is_tree()) {
        block.column_basis = block.row_basis = trimmed(child(node, "AngleBasis").text().get());
        if (!equal_without_case(block.column_basis, "LBNL/Shirley-Chiu"))
          throw Error(at(node), fmt::format("<AngleBasis> is \"{}\"; a tensor tree has \"LBNL/Shirley-Chiu\"",
                                            block.column_basis.substr(0, 80)));
      } else {
        block.column_basis = trimmed(child(node, "ColumnAngleBasis").text().get());
        block.row_basis = trimmed(child(node, "RowAngleBasis").text().get());
      }
      const pugi::xml_node numbers = child(node, "ScatteringData");
      block.where = at(numbers);
      // The reader's text lives as long as the file; the parser has a copy of its own that ends with the
      // document.
      block.data = element_text(numbers);
      for (const WindowBlock& other : result_.blocks)
        if (other.is_transmission == block.is_transmission && other.is_front == block.is_front &&
            other.channel == block.channel)
          throw Error(at(node), fmt::format("there are two blocks of \"{}\"", known));
      result_.blocks.push_back(std::move(block));
    }
  }

  /// Returns the file's text between the start tag and the end tag of an element without child elements.
  std::string_view element_text(pugi::xml_node node) const {
    const std::string_view all = result_.text;
    const std::size_t begin = all.find('>', std::size_t(node.offset_debug()));
    const std::size_t end = begin == all.npos ? all.npos : all.find('<', begin);
    return begin == all.npos || end == all.npos ? std::string_view() : all.substr(begin + 1, end - begin - 1);
  }

  std::string path_;
  WindowFile& result_;
  std::vector<std::size_t> line_ends_;
  pugi::xml_document document_;
};

}  // namespace

std::size_t AngleBasis::size() const {
  std::size_t n = 0;
  for (const Ring& r : rings) n += std::size_t(r.azimuths);
  return n;
}

const std::vector<AngleBasis>& known_angle_bases() {
  static const std::vector<AngleBasis> kBases = {
      {"LBNL/Klems Full",
       {{0, 5, 1},
        {5, 15, 8},
        {15, 25, 16},
        {25, 35, 20},
        {35, 45, 24},
        {45, 55, 24},
        {55, 65, 24},
        {65, 75, 16},
        {75, 90, 12}}},
      {"LBNL/Klems Half",
       {{0, 6.5, 1},
        {6.5, 19.5, 8},
        {19.5, 32.5, 12},
        {32.5, 45.5, 16},
        {45.5, 58.5, 20},
        {58.5, 71.5, 12},
        {71.5, 90, 8}}},
      {"LBNL/Klems Quarter", {{0, 9, 1}, {9, 27, 8}, {27, 45, 12}, {45, 63, 12}, {63, 90, 8}}}};
  return kBases;
}

const AngleBasis& WindowFile::basis(const std::string& name, const SourceLocation& where) const {
  std::vector<std::string> names;
  for (const AngleBasis& b : bases) {
    if (equal_without_case(b.name, name)) return b;
    names.push_back(b.name.substr(0, 80));
  }
  throw Error(where, fmt::format("unknown angle basis \"{}\"; there are {}", name.substr(0, 80),
                                 fmt::join(names, ", ")));
}

std::unique_ptr<const WindowFile> read_window_file(const std::filesystem::path& file) {
  auto result = std::make_unique<WindowFile>();
  WindowReader(file, *result).read();
  return result;
}

char NumberReader::peek() {
  std::size_t i = 0;
  for (; i < rest_.size(); ++i) {
    const char c = rest_[i];
    if (c == '\n')
      ++where_.line, where_.column = 0;
    else if (!std::isspace(static_cast<unsigned char>(c)) && c != ',')
      break;
  }
  rest_.remove_prefix(i);
  return rest_.empty() ? '\0' : rest_.front();
}

void NumberReader::expect(char c, const char* what) {
  const char found = peek();
  if (found != c)
    throw error(found ? fmt::format("\"{}\" in place of {}", std::string(rest_.substr(0, 12)), what)
                      : fmt::format("the numbers end in place of {}: they are truncated", what));
  rest_.remove_prefix(1);
}

double NumberReader::number() {
  if (!peek()) throw error("the numbers end too early: they are truncated");
  double value = 0;
  const char* begin = rest_.data() + (rest_.front() == '+' ? 1 : 0);
  const auto [end, code] = std::from_chars(begin, rest_.data() + rest_.size(), value);
  // strtod tells numbers that are too large, which become infinite, from those that are too small.
  if (code == std::errc::result_out_of_range && end > begin)
    value = std::strtod(std::string(begin, end).c_str(), nullptr);
  else if (code != std::errc())
    value = std::numeric_limits<double>::infinity();
  if (!std::isfinite(value))
    throw error(fmt::format("\"{}\" is not a number", std::string(rest_.substr(0, 20))));
  rest_.remove_prefix(std::size_t(end - rest_.data()));
  return value;
}

}  // namespace aureole

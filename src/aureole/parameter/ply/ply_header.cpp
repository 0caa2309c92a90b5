// SPDX-License-Identifier: Apache-2.0
#include "aureole/parameter/ply/ply_header.h"

#include <cstring>
#include <map>

namespace aureole::ply {

namespace {

Type type_named(const FileText& file, std::string_view name) {
  static const std::map<std::string_view, Type> kTypes = {
      {"char", Type::int8},      {"int8", Type::int8},      {"uchar", Type::uint8},
      {"uint8", Type::uint8},    {"short", Type::int16},    {"int16", Type::int16},
      {"ushort", Type::uint16},  {"uint16", Type::uint16},  {"int", Type::int32},
      {"int32", Type::int32},    {"uint", Type::uint32},    {"uint32", Type::uint32},
      {"long", Type::int64},     {"int64", Type::int64},    {"ulong", Type::uint64},
      {"uint64", Type::uint64},  {"float", Type::float32},  {"float32", Type::float32},
      {"double", Type::float64}, {"float64", Type::float64}};
  const auto found = kTypes.find(name);
  if (found == kTypes.end())
    throw file.error_at(name.data(), "unknown type \"" + std::string(name.substr(0, 32)) + "\"");
  return found->second;
}

Property read_property(const FileText& file, Scanner& s) {
  Property p;
  std::string_view type = s.word();
  if (type == "list") {
    p.is_list = true;
    p.count_type = type_named(file, s.word());
    if (p.count_type >= Type::float32) throw file.error_at(s.at, "the length of a list must be an integer");
    type = s.word();
  }
  p.type = type_named(file, type);
  p.name = s.word();
  if (p.name.empty()) throw file.error_at(s.at, "a property without a name");
  return p;
}

Element read_element(const FileText& file, Scanner& s) {
  Element e;
  e.name = s.word();
  long long count;
  if (!s.integer(count) || count < 0) throw file.error_at(s.at, "an element needs a name and a count");
  e.count = std::size_t(count);
  return e;
}

}  // namespace

int Element::find(std::string_view property) const {
  for (std::size_t i = 0; i < properties.size(); ++i)
    if (properties[i].name == property) return int(i);
  return -1;
}

bool Element::has_lists() const {
  for (const Property& p : properties)
    if (p.is_list) return true;
  return false;
}

std::size_t Element::least_bytes() const {
  std::size_t n = 0;
  for (const Property& p : properties) n += size_of(p.is_list ? p.count_type : p.type);
  return n;
}

Header read_header(const FileText& file) {
  Header header;
  bool has_format = false;
  const char* at = file.begin();
  for (int line = 1;; ++line) {
    const char* end = static_cast<const char*>(std::memchr(at, '\n', std::size_t(file.end() - at)));
    Scanner s{at, end ? end : file.end()};
    const std::string_view keyword = s.word();
    if (line == 1 && keyword != "ply") throw file.error("not a PLY file");
    if (!end) throw file.error("the file is truncated: its header does not end");
    if (keyword == "format") {
      const std::string_view name = s.word();
      if (name == "ascii")
        header.format = Format::ascii;
      else if (name == "binary_little_endian")
        header.format = Format::little_endian;
      else if (name == "binary_big_endian")
        header.format = Format::big_endian;
      else
        throw file.error_at(at, "unknown format \"" + std::string(name.substr(0, 32)) + "\"");
      has_format = true;
    } else if (keyword == "element") {
      header.elements.push_back(read_element(file, s));
    } else if (keyword == "property") {
      if (header.elements.empty()) throw file.error_at(at, "a property before any element");
      header.elements.back().properties.push_back(read_property(file, s));
    } else if (keyword == "end_header") {
      if (!has_format) throw file.error_at(at, "the header names no format");
      header.body = end + 1;
      return header;
    } else if (line > 1 && !keyword.empty() && keyword != "comment" && keyword != "obj_info") {
      throw file.error_at(at, "unknown header line \"" + std::string(keyword.substr(0, 32)) + "\"");
    }
    at = end + 1;
  }
}

}  // namespace aureole::ply

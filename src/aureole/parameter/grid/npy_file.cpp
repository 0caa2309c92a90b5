// SPDX-License-Identifier: Apache-2.0
// Arrays of numpy (.npy; numpy.org/doc/stable/reference/generated/numpy.lib.format.html): depth x height x width
// [x channels], in the order of C or of Fortran.
#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "aureole/parameter/grid/grid_reader.h"

namespace aureole::grid_reader {

namespace {

/// Returns the value of a key of the dictionary as text, up to the comma that ends it.
std::string value_of(std::string_view header, std::string_view key) {
  for (const char quote : {'\'', '"'}) {
    const std::string quoted = quote + std::string(key) + quote;
    std::size_t at = header.find(quoted);
    if (at == header.npos) continue;
    at = header.find(':', at + quoted.size());
    if (at == header.npos) break;
    int depth = 0;
    std::size_t end = ++at;
    for (; end < header.size(); ++end) {
      const char c = header[end];
      depth += c == '(' || c == '[' ? 1 : c == ')' || c == ']' ? -1 : 0;
      if (depth <= 0 && (c == ',' || c == '}')) break;
    }
    return std::string(trimmed(header.substr(at, end - at)));
  }
  throw Error(fmt::format("has no \"{}\" in its header", key));
}

}  // namespace

NpyHeader read_npy_header(const SharedBytes& bytes) {
  const auto byte = [&](std::size_t i) { return std::size_t(bytes.bytes[i]); };
  if (bytes.size() < 12) throw Error("is too short for an array of numpy");
  const std::size_t version = byte(6);
  if (version < 1 || version > 3)
    throw Error(fmt::format("has version {} of numpy's format; 1 to 3 are known", version));
  const std::size_t start = version == 1 ? 10 : 12;
  std::size_t length = byte(8) | byte(9) << 8;
  if (version > 1) length |= byte(10) << 16 | byte(11) << 24;
  if (length > (1 << 16) || start + length > bytes.size()) throw Error("is truncated in its header");
  const std::string_view header(reinterpret_cast<const char*>(bytes.bytes.data()) + start, length);

  std::string type = value_of(header, "descr");
  if (type.size() >= 2 && (type.front() == '\'' || type.front() == '"'))
    type = type.substr(1, type.size() - 2);
  static const std::map<std::string, ScalarType, std::less<>> kTypes = {
      {"i1", ScalarType::int8},    {"u1", ScalarType::uint8},   {"b1", ScalarType::uint8},
      {"i2", ScalarType::int16},   {"u2", ScalarType::uint16},  {"i4", ScalarType::int32},
      {"u4", ScalarType::uint32},  {"i8", ScalarType::int64},   {"u8", ScalarType::uint64},
      {"f2", ScalarType::float16}, {"f4", ScalarType::float32}, {"f8", ScalarType::float64}};
  const bool has_order =
      !type.empty() && (type[0] == '<' || type[0] == '>' || type[0] == '|' || type[0] == '=');
  const auto found = kTypes.find(type.substr(has_order ? 1 : 0));
  if (found == kTypes.end())
    throw Error(
        fmt::format("has numbers of the type \"{}\"; int8 to uint64, float16, float32 and float64 are "
                    "known, such as \"<u2\"",
                    type.substr(0, 40)));
  NpyHeader array;
  array.type = found->second;
  array.is_swapped = type[0] == '>';
  array.start = start + length;
  const std::string order = value_of(header, "fortran_order");
  if (order != "True" && order != "False")
    throw Error("has the fortran_order " + order.substr(0, 40) + "; True and False are known");
  array.is_fortran = order == "True";
  std::string shape = value_of(header, "shape");
  if (!shape.starts_with('(') || !shape.ends_with(')'))
    throw Error("has the shape " + shape.substr(0, 80) + "; such as (64, 128, 128) is expected");
  shape = shape.substr(1, shape.size() - 2);
  std::replace(shape.begin(), shape.end(), ',', ' ');
  array.sizes = integers_of(shape);
  return array;
}

ScalarGrid read_npy(const Path&, const SharedBytes& bytes, const ScalarGridOptions& options) {
  const NpyHeader array = read_npy_header(bytes);
  const auto& sizes = array.sizes;
  ScalarGrid grid;
  grid.format = ".npy";
  grid.type = array.type, grid.is_swapped = array.is_swapped;
  if (sizes.size() != 3 && sizes.size() != 4)
    throw Error(
        fmt::format("has an array of {} axes; depth x height x width numbers are expected, or several for "
                    "each voxel",
                    sizes.size()));
  const std::uint64_t count = count_of(sizes, grid.type);
  grid.numbers = decode(bytes, Encoding::raw, std::int64_t(array.start), count, grid.type);
  // Axes in the array's order are z, y, x and channels, the last fastest unless the order is Fortran's.
  std::vector<GridAxis> axes;
  for (std::size_t i = 0; i < sizes.size(); ++i) axes.push_back({sizes[i], "zyxc"[i]});
  if (!array.is_fortran) std::reverse(axes.begin(), axes.end());
  arrange(grid, axes, options);
  place_by_options(grid, options);
  return grid;
}

}  // namespace aureole::grid_reader

// SPDX-License-Identifier: Apache-2.0
#include "aureole/shape/mesh/ply_attributes.h"

#include <algorithm>
#include <array>
#include <limits>

#include "aureole/core/image.h"

namespace aureole::ply {

namespace {

/// Suffixes (after the underscore) of the components of an attribute, in order.
constexpr std::string_view kSequences[] = {"xyzw", "rgba", "0123", "1234"};
constexpr std::size_t kColors = 1;

/// Splits "NAME_c" into NAME and c; the name is empty if the property is not of this form.
std::pair<std::string, char> split(const Property& p) {
  const std::size_t n = p.name.size();
  if (p.is_list || n < 3 || p.name[n - 2] != '_') return {};
  return {p.name.substr(0, n - 2), p.name[n - 1]};
}

double largest(Type type) {
  switch (type) {
    case Type::int8:
      return std::numeric_limits<std::int8_t>::max();
    case Type::uint8:
      return std::numeric_limits<std::uint8_t>::max();
    case Type::int16:
      return std::numeric_limits<std::int16_t>::max();
    case Type::uint16:
      return std::numeric_limits<std::uint16_t>::max();
    case Type::int32:
      return std::numeric_limits<std::int32_t>::max();
    case Type::uint32:
      return std::numeric_limits<std::uint32_t>::max();
    case Type::int64:
      return double(std::numeric_limits<std::int64_t>::max());
    case Type::uint64:
      return double(std::numeric_limits<std::uint64_t>::max());
    default:
      return 1;
  }
}

}  // namespace

std::vector<AttributeColumns> find_attributes(const Element& element, const std::string& prefix) {
  std::vector<AttributeColumns> found;
  const auto scalar = [&](const char* name) {
    const int k = element.find(name);
    return k >= 0 && !element.properties[std::size_t(k)].is_list ? k : -1;
  };
  for (const auto& names : {std::array{"r", "g", "b"}, std::array{"red", "green", "blue"}}) {
    const int r = scalar(names[0]), g = scalar(names[1]), b = scalar(names[2]);
    if (r < 0 || g < 0 || b < 0) continue;
    found.push_back({prefix + "color", {std::size_t(r), std::size_t(g), std::size_t(b)}});
    break;
  }
  const auto& all = element.properties;
  for (std::size_t i = 0; i < all.size();) {
    const auto [name, first] = split(all[i]);
    const auto* sequence = std::find_if(std::begin(kSequences), std::end(kSequences),
                                        [c = first](std::string_view s) { return s[0] == c; });
    std::size_t n = 0;
    if (!name.empty() && sequence != std::end(kSequences))
      while (n < sequence->size() && i + n < all.size() &&
             split(all[i + n]) == std::pair(name, (*sequence)[n]))
        ++n;
    if (n == 1 || n == 3) {
      AttributeColumns columns{prefix + name + (sequence == kSequences + kColors ? "_color" : ""), {}};
      for (std::size_t k = 0; k < n; ++k) columns.properties.push_back(i + k);
      if (std::none_of(found.begin(), found.end(), [&](const auto& f) { return f.name == columns.name; }))
        found.push_back(std::move(columns));
    }
    i += std::max<std::size_t>(n, 1);
  }
  return found;
}

double attribute_value(Type type, double value) {
  if (type >= Type::float32) return value;
  return srgb_decode(float(value / largest(type)));
}

AttributeReader::AttributeReader(const Element& element, const std::string& prefix,
                                 const std::function<bool(std::string_view)>& wants, MeshData& data)
    : data_(data), first_(data.attributes.size()) {
  for (AttributeColumns& columns : find_attributes(element, prefix)) {
    data_.attribute_names.push_back(columns.name);
    if (!wants(columns.name)) continue;
    data_.attributes.emplace_back(columns.name, columns.is_color());
    data_.attributes.back().reserve(element.count);
    columns_.push_back(std::move(columns));
  }
  if (columns_.empty()) return;
  values_.resize(element.properties.size());
  for (const Property& p : element.properties) types_.push_back(p.type);
}

bool AttributeReader::keeps(std::size_t property) const {
  for (const AttributeColumns& c : columns_)
    if (std::find(c.properties.begin(), c.properties.end(), property) != c.properties.end()) return true;
  return false;
}

bool AttributeReader::add() {
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    const AttributeColumns& columns = columns_[i];
    double v[3];
    for (std::size_t c = 0; c < columns.properties.size(); ++c) {
      const std::size_t k = columns.properties[c];
      v[c] = attribute_value(types_[k], values_[k]);
      if (columns.is_color()) v[c] = clamp_(v[c]);
      if (!std::isfinite(v[c]) || (columns.is_color() && v[c] < 0)) return false;
    }
    data_.attributes[first_ + i].add(v);
  }
  return true;
}

}  // namespace aureole::ply

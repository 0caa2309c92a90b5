// SPDX-License-Identifier: Apache-2.0
// Selects the properties of a PLY element that are attributes for `mesh_attribute`, by Mitsuba 3's rules.
#pragma once

#include <functional>
#include <limits>

#include "aureole/parameter/ply/ply_header.h"
#include "aureole/shape/mesh/mesh.h"
#include "aureole/spectrum/value_limit.h"

namespace aureole::ply {

struct AttributeColumns {
  std::string name;                     ///< name of the attribute, such as vertex_color
  std::vector<std::size_t> properties;  ///< indices of the properties: one, or the three of a colour

  bool is_color() const { return properties.size() == 3; }
};

/// Returns the attributes of an element. Colours r, g, b or red, green, blue are PREFIXcolor. NAME_x, NAME_0
/// or NAME_1 alone is the number PREFIXNAME. NAME_x, _y, _z or NAME_0, _1, _2 (or _1, _2, _3) in sequence are
/// PREFIXNAME of three components, and NAME_r, _g, _b are PREFIXNAME_color.
std::vector<AttributeColumns> find_attributes(const Element& element, const std::string& prefix);

/// Returns the value of a property. Integers represent [0, 1], encoded as in sRGB pictures.
double attribute_value(Type type, double value);

/// Collects the attributes of an element while its records are read.
class AttributeReader {
public:
  /// Adds the names of all attributes to `data`. The values of the wanted ones are added by `add`.
  AttributeReader(const Element& element, const std::string& prefix,
                  const std::function<bool(std::string_view)>& wants, MeshData& data);

  /// Whether the property belongs to a wanted attribute.
  bool keeps(std::size_t property) const;
  void set(std::size_t property, double value) {
    if (!values_.empty()) values_[property] = value;
  }
  /// Adds the record's values as one more vertex or triangle. Returns false if an attribute is not finite or
  /// a colour is negative.
  bool add();
  /// Counts components of colours that are below 0 by rounding, which become 0.
  const NoiseClamp& noise() const { return clamp_; }

private:
  MeshData& data_;
  std::size_t first_ = 0;  ///< index of the first attribute of this element in `data_.attributes`
  std::vector<AttributeColumns> columns_;
  std::vector<double> values_;  ///< values of the record; empty if no attribute is wanted
  std::vector<Type> types_;
  NoiseClamp clamp_{0, std::numeric_limits<double>::infinity()};
};

}  // namespace aureole::ply

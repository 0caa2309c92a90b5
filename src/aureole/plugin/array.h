// SPDX-License-Identifier: Apache-2.0
// `Array`: numbers that the program which builds a scene passes in memory instead of a file, such as the
// pixels of a texture or the vertices of a mesh.
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "aureole/plugin/properties.h"

namespace aureole {

class Array : public Object {
public:
  static constexpr const char* kFamily = "an array";
  /// Row-major values; their number is the product of the entries of `shape`.
  Array(std::vector<std::size_t> shape, std::vector<double> values)
      : Object(Properties("array", "", {}, nullptr)), shape_(std::move(shape)), values_(std::move(values)) {}

  const std::vector<std::size_t>& shape() const { return shape_; }
  const std::vector<double>& values() const { return values_; }

private:
  std::vector<std::size_t> shape_;
  std::vector<double> values_;
};

}  // namespace aureole

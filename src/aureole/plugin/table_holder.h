// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace aureole {

/// An interface of plug-ins that compute large tables when they are loaded, so that the size can be printed.
class TableHolder {
public:
  virtual ~TableHolder() = default;
  struct Tables {
    /// identity of the tables: equal for objects that share tables; null if tables were not made
    const void* identity = nullptr;
    std::size_t bytes = 0;
  };
  virtual Tables tables() const = 0;
};

}  // namespace aureole

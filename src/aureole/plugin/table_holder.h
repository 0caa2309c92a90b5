// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace aureole {

/// Implemented by plug-ins that compute large tables when they are loaded, so that the size can be printed.
class TableHolder {
public:
  virtual ~TableHolder() = default;
  struct Tables {
    const void* identity = nullptr;  ///< equal for objects that share tables; null if tables were not made
    std::size_t bytes = 0;
  };
  virtual Tables tables() const = 0;
};

}  // namespace aureole

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace aureole {

/// Implemented by plug-ins that compute large tables when they are loaded, so that their size can be printed.
class TableHolder {
public:
  virtual ~TableHolder() = default;
  /// Memory of the tables, in bytes, also where equal objects share them; 0 where they were not made.
  virtual std::size_t table_bytes() const = 0;
};

}  // namespace aureole

// SPDX-License-Identifier: Apache-2.0
// How those who wait for a scene learn that tables of one of its objects take long (phase functions of large
// spheres take a minute), and how they give up waiting.
#pragma once

#include <functional>
#include <string>

#include "aureole/plugin/properties.h"

namespace aureole {

/// `object` says whose tables they are; `part` of them, 0 to 1, is done, by estimate. Called from the threads that
/// compute them, several at once. What it throws ends the computation and the loading, as it is if it is derived from
/// no std::exception (those become errors of the object).
using TableProgress = std::function<void(const std::string& object, double part)>;

/// Implemented by the scene of objects that are being built (`BuildContext::scene`), where somebody listens.
class TableListener {
public:
  virtual ~TableListener() = default;
  virtual const TableProgress& table_progress() const = 0;
};

/// For a computation of tables of the object with these properties; null where nobody listens.
std::function<void(double part)> progress_of(const Properties& properties);

}  // namespace aureole

// SPDX-License-Identifier: Apache-2.0
// Progress reports while a scene computes slow tables (phase functions of large spheres take a minute), and
// cancellation of that computation.
#pragma once

#include <functional>
#include <string>

#include "aureole/plugin/properties.h"

namespace aureole {

/// Callback for progress: `part`, from 0 to 1, is the estimated fraction of the tables of `object` that is
/// computed. It is called concurrently from the threads that compute them. An exception that it throws ends
/// the computation and the loading. To pass through unchanged it must not derive from std::exception, which
/// would become an error of the object.
using TableProgress = std::function<void(const std::string& object, double part)>;

/// An interface of the scene under construction (`BuildContext::scene`) if progress reports were requested.
class TableListener {
public:
  virtual ~TableListener() = default;
  virtual const TableProgress& table_progress() const = 0;
};

/// Returns the progress callback for tables of the object with these properties; null if there is no
/// listener.
std::function<void(double part)> progress_of(const Properties& properties);

}  // namespace aureole

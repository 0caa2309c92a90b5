// SPDX-License-Identifier: Apache-2.0
#include "aureole/plugin/table_progress.h"

#include "aureole/plugin/registry.h"

namespace aureole {

std::function<void(double)> progress_of(const Properties& p) {
  const auto* listener = dynamic_cast<const TableListener*>(p.context().scene);
  if (!listener || !listener->table_progress()) return {};
  const std::string object =
      (p.plugin() ? p.plugin()->family + " \"" : "\"") + p.type() + "\" (" + p.where().str() + ")";
  return [object, tell = listener->table_progress()](double part) { tell(object, part); };
}

}  // namespace aureole

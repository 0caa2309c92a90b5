// SPDX-License-Identifier: Apache-2.0
// aureole cluster: rendering on several machines by Dask.
#include "package_command.h"

namespace aureole {
namespace {

std::function<int()> declare(CommandOptions& options) {
  return declare_package_command(options, "_cluster_command");
}

AUREOLE_COMMAND("cluster", "Render on the workers of a Dask cluster (by the Python package)", declare);

}  // namespace
}  // namespace aureole

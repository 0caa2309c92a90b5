// SPDX-License-Identifier: Apache-2.0
// aureole denoise: pictures without noise by Intel Open Image Denoise, which is loaded from a package of Python.
#include "package_command.h"

namespace aureole {
namespace {

std::function<int()> declare(CommandOptions& options) {
  return declare_package_command(options, "_denoise_command");
}

AUREOLE_COMMAND("denoise",
                "Remove noise from a picture, or render one without (by the Python package and OIDN)",
                declare);

}  // namespace
}  // namespace aureole

// SPDX-License-Identifier: Apache-2.0
// aureole pigment: the group of the commands in this folder.
#include "command.h"

namespace aureole {
namespace {

AUREOLE_COMMAND("pigment", "Paints by Kubelka and Munk: fit, mix, match, hide, colour, error", nullptr);

}  // namespace
}  // namespace aureole

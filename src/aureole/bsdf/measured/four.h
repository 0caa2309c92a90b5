// SPDX-License-Identifier: Apache-2.0
// Four numbers in a vector register, on which arithmetic works element by element.
#pragma once

namespace aureole {

using Four = float __attribute__((vector_size(16)));

}  // namespace aureole

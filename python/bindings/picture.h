// SPDX-License-Identifier: Apache-2.0
// A picture as Python holds it: pixels and, if it was rendered here, the state to continue from.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "aureole/core/image.h"
#include "aureole/render/state.h"

namespace aureole::python {

struct Picture {
  Image image;
  std::shared_ptr<const RenderState> state;          ///< null for a picture from a file or an array
  std::vector<std::array<std::int64_t, 4>> invalid;  ///< x, y, sample, replicate
};

}  // namespace aureole::python

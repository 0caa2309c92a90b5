// SPDX-License-Identifier: Apache-2.0
// A picture as Python holds it: pixels and, if it was rendered here, the state to continue from.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "aureole/core/image.h"
#include "aureole/render/output.h"
#include "aureole/render/state.h"

namespace aureole::python {

struct Picture {
  Image image;
  std::shared_ptr<const RenderState> state;          ///< null for a picture from a file or an array
  std::vector<std::array<std::int64_t, 4>> invalid;  ///< x, y, sample, replicate
  ExrAttributes attributes;                          ///< header of the EXR that it was read from

  /// Returns the attribute of text of that name of the file; empty if there is none.
  std::string file_attribute(const char* name) const {
    const auto found = attributes.strings.find(name);
    return found == attributes.strings.end() ? std::string() : found->second;
  }
  /// The quantity of each channel, as `channels_attribute` writes it; empty if it is not known.
  std::string channel_meanings() const {
    return state ? channels_attribute(state->development.names, state->development.meanings)
                 : file_attribute(kChannelsAttribute);
  }
};

}  // namespace aureole::python

// SPDX-License-Identifier: Apache-2.0
// Names what the channels of a picture hold, with their units, in the header of an EXR.
#pragma once

#include <string>
#include <vector>

namespace aureole {

/// The string attribute of an EXR header that says what its channels hold: a line "name: meaning" for each.
inline constexpr const char* kChannelsAttribute = "aureole:channels";
std::string channels_attribute(const std::vector<std::string>& names,
                               const std::vector<std::string>& meanings);
/// Returns the meaning of a channel from that attribute; empty if it has none.
std::string channel_meaning(const std::string& attribute, const std::string& channel);

}  // namespace aureole

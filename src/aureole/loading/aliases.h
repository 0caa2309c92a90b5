// SPDX-License-Identifier: Apache-2.0
// Plug-ins of Mitsuba that are replaced by other plug-ins, and other facts about Mitsuba's plug-in names.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace aureole {

struct PluginInfo;

struct PluginAlias {
  std::string_view family, name;
  std::string_view replacement;
  std::string_view reason;                ///< reason, for the note to the user
  std::vector<std::string_view> ignored;  ///< parameters that the replacement does not have
  /// A boolean parameter of the replacement that is false where the scene does not state it; empty: none.
  std::string_view false_by_default = {};
};

/// Returns the replacement of a plug-in that is not registered itself, or null.
const PluginAlias* find_alias(std::string_view family, std::string_view name);

/// Returns the plug-in for `<family type="name">` in a scene file, possibly a replacement, or null.
const PluginInfo* find_plugin(std::string_view family, std::string_view name);

}  // namespace aureole

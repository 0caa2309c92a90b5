// SPDX-License-Identifier: Apache-2.0
// Plug-ins of Mitsuba that another plug-in stands in for, and other facts about Mitsuba's plug-in names.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace aureole {

struct PluginInfo;

struct PluginAlias {
  std::string_view family, name;
  std::string_view replacement;
  std::string_view reason;                ///< for the note to the user
  std::vector<std::string_view> ignored;  ///< parameters the replacement has no use for
};

/// The stand-in for a plug-in that is not registered itself, or null.
const PluginAlias* find_alias(std::string_view family, std::string_view name);

/// The plug-in that a scene file means by `<family type="name">`, which may be a stand-in, or null.
const PluginInfo* find_plugin(std::string_view family, std::string_view name);

}  // namespace aureole

// SPDX-License-Identifier: Apache-2.0
#include "aureole/core/channel_meanings.h"

#include <algorithm>
#include <sstream>

namespace aureole {

std::string channels_attribute(const std::vector<std::string>& names,
                               const std::vector<std::string>& meanings) {
  std::string text;
  for (std::size_t i = 0; i < std::min(names.size(), meanings.size()); ++i)
    text += names[i] + ": " + meanings[i] + "\n";
  return text;
}

std::string channel_meaning(const std::string& attribute, const std::string& channel) {
  std::istringstream lines(attribute);
  for (std::string line; std::getline(lines, line);)
    if (line.starts_with(channel + ": ")) return line.substr(channel.size() + 2);
  return {};
}

}  // namespace aureole

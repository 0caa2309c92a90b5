// SPDX-License-Identifier: Apache-2.0
#include "aureole/plugin/registry.h"

#include <algorithm>
#include <set>
#include <stdexcept>

namespace aureole {

bool PluginInfo::documents(std::string_view parameter) const {
  return std::any_of(doc.parameters.begin(), doc.parameters.end(),
                     [&](const ParameterDoc& p) { return p.name == parameter; });
}

std::vector<std::string> PluginInfo::parameter_names() const {
  std::vector<std::string> names;
  for (const auto& p : doc.parameters) names.push_back(p.name);
  return names;
}

Registry& Registry::instance() {
  static Registry registry;
  return registry;
}

void Registry::add(PluginInfo info) {
  if (find(info.family, info.name))
    throw std::logic_error("plug-in registered twice: " + info.family + " " + info.name);
  plugins_.push_back(std::move(info));
}

const PluginInfo* Registry::find(std::string_view family, std::string_view name) const {
  for (const auto& p : plugins_)
    if (p.family == family && p.name == name) return &p;
  return nullptr;
}

std::vector<std::string> Registry::families() const {
  std::set<std::string> s;
  for (const auto& p : plugins_) s.insert(p.family);
  return {s.begin(), s.end()};
}

std::vector<std::string> Registry::names(std::string_view family) const {
  std::set<std::string> s;
  for (const auto& p : plugins_)
    if (p.family == family) s.insert(p.name);
  return {s.begin(), s.end()};
}

}  // namespace aureole

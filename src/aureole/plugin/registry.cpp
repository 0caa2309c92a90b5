// SPDX-License-Identifier: Apache-2.0
#include "aureole/plugin/registry.h"

#include <algorithm>
#include <set>
#include <stdexcept>

namespace aureole {

namespace {

void add_shared_parameters(PluginInfo& plugin, const FamilyInfo& family) {
  if (!plugin.doc.takes_shared_parameters) return;
  for (const ParameterDoc& row : family.parameters)
    if (!plugin.documents(row.name)) plugin.doc.parameters.push_back(row);
}

}  // namespace

const ParameterDoc* PluginInfo::parameter(std::string_view wanted) const {
  for (const ParameterDoc& row : doc.parameters)
    if (row.name == wanted) return &row;
  return nullptr;
}

bool PluginInfo::names_file(std::string_view wanted) const {
  const ParameterDoc* row = parameter(wanted);
  return row && row->type == "file";
}

bool FamilyInfo::shares(std::string_view parameter) const {
  return std::any_of(parameters.begin(), parameters.end(),
                     [&](const ParameterDoc& row) { return row.name == parameter; });
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

// Adds a family. It may register before or after its plug-ins, since the linker decides the order.
void Registry::add(FamilyInfo info) {
  if (family(info.name)) throw std::logic_error("family registered twice: " + info.name);
  for (PluginInfo& plugin : plugins_)
    if (plugin.family == info.name) add_shared_parameters(plugin, info);
  family_index_.emplace(info.name, families_.size());
  if (!info.second_element.empty()) second_element_index_.emplace(info.second_element, families_.size());
  families_.push_back(std::move(info));
}

void Registry::add(PluginInfo info) {
  if (find(info.family, info.name))
    throw std::logic_error("plug-in registered twice: " + info.family + " " + info.name);
  if (const FamilyInfo* known = family(info.family)) add_shared_parameters(info, *known);
  info.create = [create = std::move(info.create)](const Properties& p) { return p.make(create); };
  plugin_index_[info.family].emplace(info.name, plugins_.size());
  plugins_.push_back(std::move(info));
}

const FamilyInfo* Registry::family(std::string_view name) const {
  const auto found = family_index_.find(name);
  return found == family_index_.end() ? nullptr : &families_[found->second];
}

const FamilyInfo* Registry::family_of_element(std::string_view tag, bool has_type) const {
  if (const FamilyInfo* named = family(tag); named || !has_type) return named;
  const auto found = second_element_index_.find(tag);
  return found == second_element_index_.end() ? nullptr : &families_[found->second];
}

const PluginInfo* Registry::find(std::string_view family, std::string_view name) const {
  const auto of_family = plugin_index_.find(family);
  if (of_family == plugin_index_.end()) return nullptr;
  const auto found = of_family->second.find(name);
  return found == of_family->second.end() ? nullptr : &plugins_[found->second];
}

std::vector<std::string> Registry::families() const {
  std::set<std::string> s;
  for (const auto& f : families_) s.insert(f.name);
  return {s.begin(), s.end()};
}

std::vector<std::string> Registry::names(std::string_view family) const {
  std::set<std::string> s;
  for (const auto& p : plugins_)
    if (p.family == family) s.insert(p.name);
  return {s.begin(), s.end()};
}

ObjectPtr make_object(const Properties& owner, std::string_view family, std::string_view plugin,
                      const NamedValues& parameters) {
  const PluginInfo* info = Registry::instance().find(family, plugin);
  if (!info) return nullptr;
  Properties p(info->name, "", owner.where(), owner.shared_context(), info);
  for (const auto& [name, value] : parameters) p.add(name, value, owner.where());
  return info->create(p);
}

ObjectPtr make_default_object(const Properties& owner, std::string_view family,
                              const NamedValues& parameters) {
  const FamilyInfo* info = Registry::instance().family(family);
  ObjectPtr object = info ? make_object(owner, family, info->fallback, parameters) : nullptr;
  if (!object) throw std::logic_error("there is no default plug-in of the family " + std::string(family));
  return object;
}

}  // namespace aureole

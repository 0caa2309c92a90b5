// SPDX-License-Identifier: Apache-2.0
#include "aureole/scene/overrides.h"

#include <algorithm>

#include "aureole/plugin/registry.h"
#include "aureole/sampler/sampler_docs.h"
#include "aureole/scene/aliases.h"
#include "aureole/scene/sensor_grid.h"

namespace aureole {

namespace {

Node* find_id(Node& node, const std::string& id) {
  if (node.tag != "ref" && node.tag != "alias" && node.get("id") == id) return &node;
  for (Node& child : node.children)
    if (Node* found = find_id(child, id)) return found;
  return nullptr;
}

Node synthetic(const Node& parent, const std::string& tag, const std::string& type) {
  Node node{tag, {}, {}, parent.where, parent.file};
  node.set("type", type);
  return node;
}

/// The registered plug-in for a name from the command line, through aliases; null (reported) if there is
/// none.
const PluginInfo* chosen_plugin(const std::string& family, const std::string& name,
                                Diagnostics& diagnostics) {
  const Registry& registry = Registry::instance();
  const PluginAlias* alias = find_alias(family, name);
  const PluginInfo* info = registry.find(family, alias ? alias->replacement : name);
  if (!info)
    diagnostics.error(
        {}, "--" + family + " " + name + ": unknown " + family + did_you_mean(name, registry.names(family)));
  return info;
}

void override_sampler(Node& sampler, const std::string& type, Diagnostics& diagnostics) {
  if (!chosen_plugin("sampler", type, diagnostics)) return;
  sampler.set("type", type);
  std::erase_if(sampler.children, [](const Node& child) { return !is_sampler_parameter(child.get("name")); });
}

void set_sample_count(Node& sampler, std::int64_t count) {
  std::erase_if(sampler.children, [](const Node& child) { return child.get("name") == "sample_count"; });
  Node number{"integer", {}, {}, sampler.where, sampler.file};
  number.set("name", "sample_count");
  number.set("value", std::to_string(count));
  sampler.children.push_back(std::move(number));
}

void override_integrator(Node& integrator, const std::string& type, Diagnostics& diagnostics) {
  const PluginInfo* info = chosen_plugin("integrator", type, diagnostics);
  if (!info) return;
  if (integrator.get("type") == type) return;
  integrator.set("type", type);
  std::erase_if(integrator.children, [&](const Node& child) {
    const std::string name = child.get("name");
    if (!name.empty() && info->documents(name)) return false;
    const std::string what = name.empty() ? "<" + child.tag + ">" : "\"" + name + "\"";
    diagnostics.note(child.where,
                     what + " is ignored: the integrator \"" + type + "\" has no such parameter");
    return true;
  });
}

}  // namespace

Node* target_of(Node& root, Node& node) {
  if (node.tag != "ref") return &node;
  std::string id = node.get("id");
  for (Node& alias : root.children)
    if (alias.tag == "alias" && alias.get("as") == id) id = alias.get("id");
  return find_id(root, id);
}

Node* child_of_family(Node& root, Node& parent, std::string_view family) {
  for (Node& child : parent.children)
    if (Node* target = target_of(root, child); target && object_family(*target) == family) return target;
  return nullptr;
}

Node* first_of_family(Node& root, std::string_view family) { return child_of_family(root, root, family); }

void apply_overrides(Node& root, const LoadOptions& options, Diagnostics& diagnostics) {
  if (!first_of_family(root, "integrator"))
    root.children.push_back(
        synthetic(root, "integrator", options.integrator.empty() ? "path" : options.integrator));
  if (!options.integrator.empty())
    override_integrator(*first_of_family(root, "integrator"), options.integrator, diagnostics);

  Node* sensor = first_sensor(root);
  if (!sensor) return;
  if ((!options.sampler.empty() || options.sample_count) && !child_of_family(root, *sensor, "sampler"))
    sensor->children.push_back(
        synthetic(*sensor, "sampler", options.sampler.empty() ? "sobol" : options.sampler));
  Node* sampler = child_of_family(root, *sensor, "sampler");
  if (!sampler) return;
  if (!options.sampler.empty()) override_sampler(*sampler, options.sampler, diagnostics);
  if (options.sample_count) set_sample_count(*sampler, *options.sample_count);
  if (options.sampler.empty() && sampler->get("type") == "independent")
    diagnostics.note(sampler->where,
                     "the scene asks for independent samples; --sampler sobol usually converges faster");
}

}  // namespace aureole

// SPDX-License-Identifier: Apache-2.0
#include "aureole/loading/overrides.h"

#include <algorithm>

#include "aureole/loading/aliases.h"
#include "aureole/loading/radio_materials.h"
#include "aureole/plugin/registry.h"

namespace aureole {

namespace {

/// Makes a node for an object that is not in the scene file: with the given plug-in, or the family's default
/// plug-in.
Node synthetic(const Node& parent, const std::string& family, const std::string& type) {
  Node node{family, {}, {}, parent.where, parent.file};
  node.set("type", type.empty() ? Registry::instance().family(family)->fallback : type);
  return node;
}

/// Returns the registered plug-in for a name from the command line, following aliases; null (reported) if
/// there is none.
const PluginInfo* chosen_plugin(const std::string& family, const std::string& name,
                                Diagnostics& diagnostics) {
  const PluginInfo* info = find_plugin(family, name);
  if (!info)
    diagnostics.error({}, "--" + family + " " + name + ": unknown " + family +
                              did_you_mean_or_all(name, Registry::instance().names(family)));
  return info;
}

void override_sampler(Node& sampler, const std::string& type, Diagnostics& diagnostics) {
  if (!chosen_plugin("sampler", type, diagnostics)) return;
  sampler.set("type", type);
  const FamilyInfo& family = *Registry::instance().family("sampler");
  std::erase_if(sampler.children, [&](const Node& child) { return !family.shares(child.get("name")); });
}

void set_parameter(Node& object, const std::string& tag, const std::string& name, const std::string& value) {
  std::erase_if(object.children, [&](const Node& child) { return child.get("name") == name; });
  object.children.push_back(parameter_node(object, tag, name, value));
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

/// Replaces the reconstruction filter of the first sensor's film by a box.
void set_box_filter(Node& root, Diagnostics& diagnostics) {
  Node* sensor = first_sensor(Ids(root));
  if (!child_of_family(Ids(root), *sensor, "film")) {
    sensor->children.push_back(synthetic(*sensor, "film", ""));
    sensor = first_sensor(Ids(root));
  }
  const Ids ids(root);
  Node& film = *child_of_family(ids, *sensor, "film");
  const Node* before = child_of_family(ids, film, "rfilter");
  if (before && before->get("type") == "box") return;
  diagnostics.note(
      before ? before->where : film.where,
      "the reconstruction filter is \"box\" for denoising: wider filters give neighbours the same "
      "noise, which looks like structure");
  std::erase_if(film.children, [&](Node& child) {
    const Node* target = ids.follow(child);
    return target && object_family(*target) == "rfilter";
  });
  film.children.push_back(synthetic(film, "rfilter", "box"));
}

/// Puts the integrator into one that adds the channels which guide a denoiser.
void add_features(Node& root) {
  Node& integrator = *child_of_family(Ids(root), root, "integrator");
  constexpr const char* kFollowed = "8";
  Node features = synthetic(root, "integrator", "aov");
  features.where = integrator.where, features.file = integrator.file;
  for (const char* kept : {"id", "name"})
    if (const Attribute* attribute = integrator.find(kept)) features.set(kept, attribute->value);
  std::erase_if(integrator.attributes, [](const Attribute& a) { return a.name == "id" || a.name == "name"; });
  features.children.push_back(parameter_node(features, "string", "aovs", kDenoisingFeatures));
  features.children.push_back(parameter_node(features, "integer", "specular_depth", kFollowed));
  features.children.push_back(parameter_node(features, "boolean", "colors", "false"));
  features.children.push_back(std::move(integrator));
  integrator = std::move(features);
}

}  // namespace

Node* child_of_family(const Ids& ids, Node& parent, std::string_view family) {
  for (Node& child : parent.children)
    if (Node* target = ids.follow(child); target && object_family(*target) == family) return target;
  return nullptr;
}

Node* first_sensor(const Ids& ids) {
  for (Node& child : ids.root().children) {
    Node* node = ids.follow(child);
    if (!node) continue;
    if (object_family(*node) == "sensor") return node;
    if (object_family(*node) != "shape") continue;
    if (Node* sensor = child_of_family(ids, *node, "sensor")) return sensor;
  }
  return nullptr;
}

void apply_overrides(Node& root, const LoadOptions& options, Diagnostics& diagnostics) {
  // Ids are looked up again after each insertion, since it may move sibling nodes in memory.
  if (!child_of_family(Ids(root), root, "integrator"))
    root.children.push_back(synthetic(
        root, "integrator", options.integrator.empty() ? options.fallback_integrator : options.integrator));
  if (!options.integrator.empty())
    override_integrator(*child_of_family(Ids(root), root, "integrator"), options.integrator, diagnostics);
  for (const LoadOptions::Parameter& p : options.integrator_parameters)
    set_parameter(*child_of_family(Ids(root), root, "integrator"), p.tag, p.name, p.value);
  if (options.radio_materials) replace_radio_materials(root, diagnostics);

  if (options.for_denoising) add_features(root);

  Node* sensor = first_sensor(Ids(root));
  if (!sensor) return;
  if (options.for_denoising) {
    set_box_filter(root, diagnostics);
    sensor = first_sensor(Ids(root));
  }
  if ((!options.sampler.empty() || options.sample_count) && !child_of_family(Ids(root), *sensor, "sampler"))
    sensor->children.push_back(synthetic(*sensor, "sampler", options.sampler));
  Node* sampler = child_of_family(Ids(root), *sensor, "sampler");
  if (!sampler) return;
  if (!options.sampler.empty()) override_sampler(*sampler, options.sampler, diagnostics);
  if (options.sample_count)
    set_parameter(*sampler, "integer", "sample_count", std::to_string(*options.sample_count));
  const PluginInfo* chosen = find_plugin("sampler", sampler->get("type"));
  if (options.sampler.empty() && chosen && !chosen->doc.advice.empty())
    diagnostics.note(sampler->where, chosen->doc.advice);
}

}  // namespace aureole

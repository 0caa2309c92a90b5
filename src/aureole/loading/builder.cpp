// SPDX-License-Identifier: Apache-2.0
#include "aureole/loading/builder.h"

#include <algorithm>

#include "aureole/loading/aliases.h"
#include "aureole/loading/values.h"
#include "aureole/plugin/registry.h"

namespace aureole {

namespace {

/// Reports the error at the element. A location inside a referenced file becomes part of the message.
void report(const Node& node, const Error& e, Diagnostics& diagnostics) {
  if (const auto* list = dynamic_cast<const ErrorList*>(&e)) {
    for (const std::string& message : list->errors()) diagnostics.error(node.where, message);
    return;
  }
  const SourceLocation& where = e.where();
  bool in_scene = false;
  // A location without a line denotes a whole file named by a parameter, such as a scene given as an image.
  for (const SourceFile* f = node.file.get(); f && where.line > 0; f = f->included_by.get())
    in_scene |= f->shown == where.file;
  for (const Node& child : node.children)  // an edited element may have another source (document.h)
    in_scene |= where.line > 0 && child.file->shown == where.file;
  if (in_scene)
    diagnostics.error(e);
  else
    diagnostics.error(node.where, e.what());
}

}  // namespace

Error unknown_element(const Node& node) {
  const std::vector<std::string> steps = {"translate", "rotate", "scale", "lookat", "matrix"};
  for (const std::string& step : steps)
    if (node.tag == step) return Error(node.where, "<" + node.tag + "> belongs inside <transform>");
  if (node.tag == "scene") return Error(node.where, "<scene> can't be nested");
  return Error(node.where, "unknown element <" + node.tag + ">" + did_you_mean(node.tag, all_tags()));
}

ObjectPtr Builder::object(const Node& node) {
  const Node* t = target(node);
  if (!t) return nullptr;
  ObjectPtr& slot = built_[*t];
  if (std::exchange(is_built_[*t], true)) return slot;
  if (t->tag == "given") return slot = given(*t);
  const bool may_keep = pool_ && ObjectPool::keeps(object_family(*t));
  ObjectPtr object = may_keep ? pool_->find(keys_.of(*t)) : nullptr;
  if (object) {
    for (const Node& child : t->children)  // builds the children as well, so that built() contains all
                                           // objects
      if (!object_family(child).empty() || child.tag == "ref") this->object(child);
  } else {
    object = construct(*t);
    // Objects of a scene with errors may lack their tables (`Properties::shared_model`).
    if (object && may_keep && !diagnostics_.has_errors()) pool_->add(keys_.of(*t), object);
  }
  return slot = object;
}

ObjectPtr Builder::find(std::string_view family, const std::string& id) {
  const Node* found = references_.ids.find(id).node;
  return found && object_family(*found) == family ? object(*found) : nullptr;
}

const PluginInfo* Builder::plugin_of(const Node& node, const PluginAlias** alias) {
  const Registry& registry = Registry::instance();
  const std::string family = object_family(node);
  if (!check_attributes(node, {"type"}, {"id", "name"}, diagnostics_) || node.find("type")->failed)
    return nullptr;
  const Attribute& type = *node.find("type");
  *alias = find_alias(family, type.value);
  if (*alias) {
    const std::string replacement((*alias)->replacement);
    diagnostics_.note(type.where, family + " \"" + type.value + "\" is replaced by \"" + replacement +
                                      "\": " + std::string((*alias)->reason));
    if (const PluginInfo* plugin = registry.find(family, replacement)) return plugin;
  }
  if (const PluginInfo* plugin = registry.find(family, type.value)) return plugin;

  diagnostics_.error(type.where, "unknown " + family + " \"" + type.value + "\"" +
                                     did_you_mean_or_all(type.value, registry.names(family)));
  return nullptr;
}

ObjectPtr Builder::construct(const Node& node) {
  const PluginAlias* alias = nullptr;
  const PluginInfo* plugin = plugin_of(node, &alias);
  const auto shared = std::make_shared<Properties>(plugin ? plugin->name : node.get("type"), node.get("id"),
                                                   node.where, context_, plugin);
  Properties& properties = *shared;
  properties.set_content(keys_.content_of(node, *context_));
  properties.reserve(node.children.size());

  bool good = plugin != nullptr;
  for (const Node& child : node.children) {
    bool ignored = false;
    if (alias)
      for (std::string_view name : alias->ignored) ignored |= child.get("name") == name;
    if (ignored)
      diagnostics_.note(child.where, "\"" + child.get("name") + "\" is ignored: \"" + plugin->name +
                                         "\" has no use for it");
    else
      good &= add_child(child, properties);
  }
  if (alias && !alias->false_by_default.empty() && !properties.has(alias->false_by_default))
    properties.add(std::string(alias->false_by_default), Properties::Value(std::in_place_type<bool>, false),
                   node.where);
  // If a child is missing, the constructor would report errors that are mere consequences.
  ObjectPtr object = good ? create(node, *plugin, properties) : nullptr;
  if (!object && plugin) report_unknown_parameters(node, *plugin);
  return object;
}

ObjectPtr Builder::given(const Node& node) {
  if (!check_attributes(node, {"key"}, {"name", "id"}, diagnostics_)) return nullptr;
  const auto found = given_.find(node.get("key"));
  if (found != given_.end()) return found->second;
  diagnostics_.error(node.where,
                     "<given> stands for an object of the program that loads the scene, which knows no \"" +
                         node.get("key") + "\"");
  return nullptr;
}

bool Builder::add_child(const Node& child, Properties& properties) {
  std::optional<Properties::Value> value;
  if (!object_family(child).empty() || child.tag == "ref") {
    if (ObjectPtr object = this->object(child)) value = std::move(object);
  } else if (child.tag == "given") {
    if (ObjectPtr object = this->object(child)) value = std::move(object);
  } else if (child.tag == "alias") {
    return true;  // the ids of aliases are handled by References
  } else if (is_property(child)) {
    value = property_value(child, diagnostics_);
  } else {
    diagnostics_.error(unknown_element(child));
  }
  if (!value) return false;
  try {
    properties.add(child.get("name"), std::move(*value), child.where);
  } catch (const Error& e) {
    diagnostics_.error(e);
    return false;
  }
  return true;
}

ObjectPtr Builder::create(const Node& node, const PluginInfo& plugin, const Properties& properties) {
  // A constructor may ask for other objects, which are then constructed.
  struct Making {
    Making(const Node*& slot, const Node* node) : slot_(slot), before_(std::exchange(slot, node)) {}
    ~Making() { slot_ = before_; }
    const Node*& slot_;
    const Node* before_;
  } const making(making_, &node);
  try {
    ObjectPtr object;
    if (pool_ && plugin.family == "shape")
      object = make_asset(plugin, properties, *pool_->geometry_source(keys_.geometry_of(node)));
    else
      object = make_element(plugin, properties);
    if (!object) throw Error("the plug-in made no object");
    properties.report_unused(diagnostics_);
    return object;
  } catch (const Error& e) {
    report(node, e, diagnostics_);
    for (const Error& further : properties.further_problems()) report(node, further, diagnostics_);
  } catch (const std::exception& e) {
    diagnostics_.error(node.where, "\"" + plugin.name + "\": " + e.what());
  }
  return nullptr;
}

void Builder::report_unknown_parameters(const Node& node, const PluginInfo& plugin) {
  // The constructor threw before reading all parameters, so only undocumented names are known to be wrong.
  Properties unknown(plugin.name, node.get("id"), node.where, context_, &plugin);
  for (const Node& child : node.children) {
    const std::string name = child.get("name");
    if (!is_property(child) || name.empty() || plugin.documents(name) || unknown.has(name)) continue;
    if (child.tag == "spectrum" && plugin.documents("(any name)")) continue;
    unknown.add(name, false, child.where);
  }
  unknown.report_unused(diagnostics_);
}

}  // namespace aureole

// SPDX-License-Identifier: Apache-2.0
#include "aureole/scene/builder.h"

#include <algorithm>

#include "aureole/plugin/registry.h"
#include "aureole/scene/aliases.h"
#include "aureole/scene/values.h"
#include "aureole/texture/texture.h"

namespace aureole {

namespace {

/// Reported where the element is, with the place inside a referenced file, if there is one, in the text.
void report(const Node& node, const Error& e, Diagnostics& diagnostics) {
  if (const auto* list = dynamic_cast<const ErrorList*>(&e)) {
    for (const std::string& message : list->errors()) diagnostics.error(node.where, message);
    return;
  }
  const SourceLocation& where = e.where();
  bool in_scene = false;
  // A place without a line is a whole file, which a parameter names: the scene itself, taken for an image.
  for (const SourceFile* f = node.file.get(); f && where.line > 0; f = f->included_by.get())
    in_scene |= f->shown == where.file;
  for (const Node& child : node.children)  // written by another hand (document.h)
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

const Node* Builder::target(const Node& node) const {
  if (node.tag != "ref") return &node;
  const auto found = references_.targets.find(&node);
  return found == references_.targets.end() ? nullptr : found->second;
}

ObjectPtr Builder::object(const Node& node) {
  const Node* t = target(node);
  if (!t) return nullptr;
  const auto [slot, is_new] = built_.try_emplace(t, nullptr);
  if (!is_new) {
    if (lookers_.contains(t)) ++looks_around_;
    return slot->second;
  }
  if (t->tag == "given") return built_[t] = given(*t);
  const std::string family = object_family(*t);
  const bool nested = depth_ > 0;
  const std::size_t looks_before = looks_around_;
  ++depth_;
  ObjectPtr kept = pool_ ? pool_->whole(family, keys_.of(*t), nested) : nullptr;
  if (kept)
    for (const Node& child : t->children)  // so that all that is built is known
      if (!object_family(child).empty() || child.tag == "ref") object(child);
  ObjectPtr built = kept ? kept : construct(*t);
  --depth_;
  built_[t] = built;  // `slot` may be invalid by now: construct() adds children
  // A mesh tells such a texture what it shows: another one would add to that.
  if (dynamic_cast<const AttributeTexture*>(built.get())) ++looks_around_;
  if (looks_around_ != looks_before) lookers_.insert(t);
  // What looks around depends on more than the key says.
  const bool is_new_object =
      built && !kept &&
      std::none_of(adoptions_.begin(), adoptions_.end(), [&](const Adoption& a) { return a.shape == built; });
  if (pool_ && is_new_object && looks_around_ == looks_before)
    pool_->add(family, keys_.of(*t), built, nested);
  return built;
}

ObjectPtr Builder::kept_shape(const Node& node, const Properties& properties) {
  // Nested ones are part of what their parents were built from.
  if (!pool_ || depth_ > 1 || object_family(node) != "shape") return nullptr;
  const ObjectPool::Key key = keys_.of(node);
  const std::shared_ptr<Shape> shape = pool_->geometry(key);
  if (!shape) return nullptr;
  // A copy, since children are read once.
  const auto own = std::make_shared<const Properties>(properties);
  Shape::Children children = Shape::read_children(*own);
  if (!shape->can_adopt(*own, children)) return nullptr;
  adoptions_.push_back({shape, own, std::move(children), key});
  return shape;
}

ObjectPtr Builder::find(std::string_view family, const std::string& id) {
  ++looks_around_;
  const auto found = references_.ids.find(id);
  return found != references_.ids.end() && object_family(*found->second) == family ? object(*found->second)
                                                                                   : nullptr;
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

  const std::vector<std::string> names = registry.names(family);
  std::string hint = did_you_mean(type.value, names);
  if (hint.empty() && !names.empty()) {
    hint = "; there are: ";
    for (const std::string& name : names) hint += (name == names.front() ? "" : ", ") + name;
  }
  diagnostics_.error(type.where, "unknown " + family + " \"" + type.value + "\"" + hint);
  return nullptr;
}

ObjectPtr Builder::construct(const Node& node) {
  if (is_unsupported_object(node)) {
    diagnostics_.error(node.where, "<" + node.tag + "> is not supported yet");
    return nullptr;
  }
  const PluginAlias* alias = nullptr;
  const PluginInfo* plugin = plugin_of(node, &alias);
  Properties properties(plugin ? plugin->name : node.get("type"), node.get("id"), node.where, context_,
                        plugin);

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
  // With a part missing, the constructor would complain about the consequences.
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
  if (!object_family(child).empty() || child.tag == "ref" || is_unsupported_object(child)) {
    if (ObjectPtr object = this->object(child)) value = std::move(object);
  } else if (child.tag == "given") {
    if (ObjectPtr object = this->object(child)) value = std::move(object);
  } else if (child.tag == "alias") {
    return true;  // done by resolve()
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
  try {
    if (ObjectPtr kept = kept_shape(node, properties)) return kept;
    ObjectPtr object = plugin.create(properties);
    if (!object) throw Error("the plug-in made no object");
    properties.report_unused(diagnostics_);
    return object;
  } catch (const Error& e) {
    report(node, e, diagnostics_);
  } catch (const std::exception& e) {
    diagnostics_.error(node.where, "\"" + plugin.name + "\": " + e.what());
  }
  return nullptr;
}

void Builder::report_unknown_parameters(const Node& node, const PluginInfo& plugin) {
  // The constructor did not run to its end, so that only names that no table mentions are known to be wrong.
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

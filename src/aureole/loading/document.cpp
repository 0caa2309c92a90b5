// SPDX-License-Identifier: Apache-2.0
#include "aureole/loading/document.h"

#include <algorithm>
#include <optional>
#include <pugixml.hpp>
#include <set>
#include <sstream>
#include <unordered_map>
#include <unordered_set>

#include "aureole/loading/aliases.h"
#include "aureole/loading/overrides.h"
#include "aureole/loading/references.h"
#include "aureole/loading/stages.h"
#include "aureole/plugin/registry.h"

namespace aureole {

namespace {

/// Names of a node's children in paths: their own names, or their families, numbered from the second one.
/// Empty for children that paths cannot name.
std::vector<std::string> child_names(const Ids& ids, Node& node) {
  std::vector<std::string> names;
  std::unordered_set<std::string> taken;
  std::unordered_map<std::string, int> last;  // number of uses of a name so far
  for (Node& child : node.children) {
    std::string name = child.get("name");
    Node* target = ids.follow(child);
    if (&node == &ids.root() && target && child.tag != "ref" && !child.get("id").empty())
      name = child.get("id");
    if (name.empty() && target) name = child.tag == "given" ? "given" : object_family(*target);
    std::string unique = name;
    while (!name.empty() && !taken.insert(unique).second)
      unique = name + "_" + std::to_string(++last.try_emplace(name, 1).first->second);
    names.push_back(unique);
  }
  return names;
}

const PluginInfo* plugin_of(const Node& node) { return find_plugin(object_family(node), node.get("type")); }

void collect_paths(const Ids& ids, Node& node, const std::string& prefix, std::vector<std::string>& paths) {
  const std::vector<std::string> names = child_names(ids, node);
  for (std::size_t i = 0; i < names.size(); ++i) {
    Node& child = node.children[i];
    if (names[i].empty() || (child.tag == "ref" && &node == &ids.root())) continue;
    const std::string path = prefix + names[i];
    paths.push_back(path);
    if (!object_family(child).empty()) collect_paths(ids, child, path + ".", paths);
  }
}

/// Collects the keys of the program's objects that <given> elements name.
void collect_keys(const Node& node, std::set<std::string>& keys) {
  if (node.tag == "given") keys.insert(node.get("key"));
  for (const Node& child : node.children) collect_keys(child, keys);
}

void set_file(Node& node, const SourceFilePtr& file) {
  node.file = file;
  for (Node& child : node.children) set_file(child, file);
}

void write_node(const Node& node, pugi::xml_node parent) {
  if (node.tag == "given")
    throw Error(node.where, "\"" + node.get("name") +
                                "\" was given by a program: it cannot be written into a scene file");
  pugi::xml_node element = parent.append_child(node.tag.c_str());
  for (const Attribute& a : node.attributes) {
    std::string text;
    for (const char c : a.value) text += c == '$' ? std::string("\\$") : std::string(1, c);
    element.append_attribute(a.name.c_str()) = text.c_str();
  }
  for (const Node& child : node.children) write_node(child, element);
}

/// Parses the new element of a change from XML.
Node parse_element(const std::string& path, const std::string& text, ParsedScene& into,
                   Diagnostics& diagnostics) {
  const std::string shown = "[\"" + path + "\"]";
  ParsedScene parsed = parse_scene(shown, "<scene version=\"3.0.0\">" + text + "</scene>", {}, diagnostics);
  if (parsed.root.children.size() != 1 && !diagnostics.has_errors())
    diagnostics.error({shown, 0, 0}, "expected one element");
  if (parsed.root.children.empty()) return {};
  // Relative file names in the element refer to the scene's folder.
  const auto file = std::make_shared<SourceFile>();
  file->path = into.files.front()->path, file->shown = shown;
  set_file(parsed.root.children.front(), file);
  return std::move(parsed.root.children.front());
}

}  // namespace

struct SceneDocument::Place {
  Node* owner = nullptr;
  std::size_t child = 0;   ///< index of the child, or the number of children if the parameter is not written
  std::string name;        ///< name of the parameter
  Node* target = nullptr;  ///< the child, references followed; null if not written
};

SceneDocument::SceneDocument(const std::filesystem::path& file, const LoadOptions& options)
    : options_(options) {
  parsed_ = open_scene(file, {}, options_, notes_);
  build();
}

SceneDocument::SceneDocument(const std::string& text, const std::filesystem::path& pretended_file,
                             const LoadOptions& options)
    : options_(options) {
  parsed_ = open_scene(pretended_file, text, options_, notes_);
  build();
}

SceneDocument::~SceneDocument() = default;

void SceneDocument::build() {
  OpenedParts opened = build_opened(*parsed_, options_, pool_);
  std::vector<std::string> notes = notes_;
  for (const std::string& note : opened.notes)
    if (std::find(notes.begin(), notes.end(), note) == notes.end()) notes.push_back(note);
  opened.notes = notes;
  loaded_ = make_scene(std::move(static_cast<LoadedParts&>(opened)), scene().get());
  notes_ = std::move(notes);
  objects_ = std::move(opened.objects);
  pool_.trim();
}

ObjectPtr SceneDocument::object(const std::string& path) const {
  const Place at = place(path);
  if (at.target && at.target->tag == "given") {
    const auto given = options_.given.find(at.target->get("key"));
    return given == options_.given.end() ? nullptr : given->second;
  }
  return at.target ? objects_[*at.target] : nullptr;
}

std::vector<std::string> SceneDocument::paths() const {
  std::vector<std::string> paths;
  collect_paths(Ids(parsed_->root), parsed_->root, "", paths);
  return paths;
}

SceneDocument::Place SceneDocument::place(const std::string& path) const {
  Node& root = parsed_->root;
  const Ids ids(root);
  Place at{&root, root.children.size(), "", &root};
  std::string_view rest = path;
  std::string walked;
  const auto starts = [&](const std::string& name) {
    return !name.empty() && (rest == name || (rest.starts_with(name) && rest[name.size()] == '.'));
  };
  while (!rest.empty()) {
    Node& node = *at.target;
    const std::vector<std::string> names = child_names(ids, node);
    // Names may contain dots themselves: the longest match wins.
    std::size_t best = names.size();
    for (std::size_t i = 0; i < names.size(); ++i)
      if (starts(names[i]) && (best == names.size() || names[i].size() > names[best].size())) best = i;
    std::string name;
    Node *target = nullptr, *owner = &node;
    if (best < names.size()) {
      name = names[best];
      target = ids.follow(node.children[best]);
    } else if (&node == &root) {
      for (std::size_t end = rest.size(); !target && end != std::string_view::npos && end > 0;
           end = rest.rfind('.', end - 1)) {
        name = std::string(rest.substr(0, end));
        const Ids::Held held = ids.find(name);
        target = held.node, owner = held.parent, best = held.child;
      }
    } else if (const PluginInfo* plugin = plugin_of(node);
               plugin && (plugin->documents(rest) || plugin->documents("(any name)"))) {
      return {&node, node.children.size(), std::string(rest), nullptr};
    }
    if (!target) {
      std::vector<std::string> candidates;
      for (const std::string& n : names)
        if (!n.empty()) candidates.push_back(n);
      if (const PluginInfo* plugin = plugin_of(node))
        for (const std::string& n : plugin->parameter_names())
          if (std::find(candidates.begin(), candidates.end(), n) == candidates.end()) candidates.push_back(n);
      std::string hint = did_you_mean(rest, candidates);
      if (hint.empty()) hint = did_you_mean(rest.substr(0, rest.find('.')), candidates);
      if (hint.empty() && !candidates.empty()) {
        hint = "; there are: ";
        for (std::size_t i = 0; i < candidates.size() && i < 24; ++i) hint += (i ? ", " : "") + candidates[i];
        if (candidates.size() > 24) hint += ", ...";
      }
      throw Error("no parameter \"" + path + "\": " + (walked.empty() ? "the scene" : "\"" + walked + "\"") +
                  " has no \"" + std::string(rest) + "\"" + hint);
    }
    at = {owner, best, name, target};
    walked += (walked.empty() ? "" : ".") + name;
    if (rest.size() == name.size() + 1)
      throw Error("no parameter \"" + path + "\": a name is missing at its end");
    rest.remove_prefix(std::min(rest.size(), name.size() + 1));
  }
  if (path.empty()) throw Error("the path of a parameter must not be empty");
  return at;
}

const Node* SceneDocument::find(const std::string& path) const { return place(path).target; }

const Node& SceneDocument::owner(const std::string& path) const {
  const Place at = place(path);
  return at.target && !object_family(*at.target).empty() ? *at.target : *at.owner;
}

std::string SceneDocument::xml() const {
  pugi::xml_document document;
  write_node(parsed_->root, document);
  document.document_element().remove_attribute("version");
  document.document_element().prepend_attribute("version") = "3.0.0";
  std::ostringstream text;
  document.save(text, "  ", pugi::format_indent | pugi::format_no_declaration, pugi::encoding_utf8);
  return std::move(text).str();
}

LoadedScene SceneDocument::for_denoising() {
  // Kept nodes must not move in memory, since objects are found by their address.
  Node before = std::move(parsed_->root);
  parsed_->root = before;
  struct Restore {
    Node &root, &before;
    ~Restore() { root = std::move(before); }
  } const restore{parsed_->root, before};
  Diagnostics diagnostics;
  LoadOptions changes;
  changes.for_denoising = true;
  apply_overrides(parsed_->root, changes, diagnostics);
  diagnostics.throw_if_errors();
  OpenedParts opened = build_opened(*parsed_, options_, pool_);
  std::vector<std::string> notes = diagnostics.notes();
  notes.insert(notes.end(), opened.notes.begin(), opened.notes.end());
  opened.notes = std::move(notes);
  LoadedScene made = make_scene(std::move(static_cast<LoadedParts&>(opened)), scene().get());
  pool_.trim();
  return made;
}

const LoadedScene& SceneDocument::edit(const std::vector<std::pair<std::string, std::string>>& changes,
                                       const std::map<std::string, ObjectPtr>& given) {
  // Kept nodes must not move in memory, since objects are found by their address.
  Node before = std::move(parsed_->root);
  parsed_->root = before;
  const auto given_before = options_.given;
  for (const auto& [key, object] : given) options_.given[key] = object;
  try {
    Diagnostics diagnostics;
    for (const auto& [path, text] : changes) {
      Place at = place(path);
      std::vector<Node>& siblings = at.owner->children;
      if (text.empty()) {
        if (at.child == siblings.size()) continue;
        siblings.erase(siblings.begin() + std::ptrdiff_t(at.child));
        continue;
      }
      Node element = parse_element(path, text, *parsed_, diagnostics);
      if (diagnostics.has_errors()) break;
      if (at.child == siblings.size()) {
        element.set("name", at.name);
        siblings.push_back(std::move(element));
        continue;
      }
      // The parameter takes the new value but keeps its name, and its id, which references may use.
      Node& old = siblings[at.child];
      if (const Attribute* name = old.find("name")) element.set("name", name->value);
      if (const Attribute* id = old.find("id"); id && old.tag != "ref") element.set("id", id->value);
      old = std::move(element);
    }
    diagnostics.throw_if_errors();
    complete(*parsed_);
    build();
    std::set<std::string> keys;
    collect_keys(parsed_->root, keys);
    std::erase_if(options_.given, [&](const auto& entry) { return !keys.contains(entry.first); });
  } catch (...) {
    parsed_->root = std::move(before);
    options_.given = given_before;
    throw;
  }
  return loaded_;
}

}  // namespace aureole

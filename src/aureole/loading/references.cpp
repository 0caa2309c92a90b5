// SPDX-License-Identifier: Apache-2.0
#include "aureole/loading/references.h"

#include <algorithm>

#include "aureole/core/input_file.h"
#include "aureole/loading/aliases.h"
#include "aureole/plugin/registry.h"

namespace aureole {

namespace {

/// Limit of nested elements and references on one path from the scene down: building them is recursive.
constexpr std::size_t kDeepest = 512;
/// Limit of the references below an object, each followed and counted. Evaluating a texture or BSDF that uses
/// another one twice, which uses another one twice, ... takes exponential time. Shapes are exempt, because
/// they may contain many references.
constexpr std::uint64_t kMaxReferences = 10000;

/// Returns the attribute that names a file for a parameter of `object`, or null.
Attribute* file_name(const PluginInfo* object, Node& parameter) {
  if (parameter.tag == "spectrum" && is_property(parameter)) return parameter.find("filename");
  const bool is_file = parameter.tag == "string" && object && object->names_file(parameter.get("name"));
  return is_file ? parameter.find("value") : nullptr;
}

std::string searched(const SourceFile& from, const std::vector<std::filesystem::path>& folders) {
  std::string text = " (looked in " + from.folder().string();
  for (const SourceFile* f = from.included_by.get(); f; f = f->included_by.get())
    if (f->folder() != from.folder()) text += ", " + f->folder().string();
  for (const auto& folder : folders) text += ", " + folder.string();
  return text + ")";
}

}  // namespace

Ids::Ids(Node& root, bool complete, Diagnostics& diagnostics) : root_(&root) {
  collect_all(complete, diagnostics);
}

void Ids::collect_all(bool complete, Diagnostics& diagnostics) const {
  is_collected_ = true;  // set first, since aliases are found by looking up ids
  collect(*root_, diagnostics);
  collect_aliases(*root_, complete, diagnostics);
}

Ids::Held Ids::find(const std::string& id) const {
  if (!is_collected_) {
    Diagnostics unheard;
    collect_all(true, unheard);
  }
  const auto found = entries_.find(id);
  return found == entries_.end() ? Held{} : found->second.held;
}

Error Ids::unknown(const Attribute& id) const {
  std::vector<std::string> names;
  for (const auto& [name, entry] : entries_) names.push_back(name);
  return Error(id.where, "no object has the id \"" + id.value + "\"" + did_you_mean(id.value, names));
}

void Ids::add(const Attribute& id, const Held& held, const SourceLocation& place,
              Diagnostics& diagnostics) const {
  const auto [entry, is_new] = entries_.try_emplace(id.value, Entry{held, place});
  if (!is_new)
    diagnostics.error(id.where,
                      "the id \"" + id.value + "\" is taken: first given at " + entry->second.place.str());
}

void Ids::collect(Node& parent, Diagnostics& diagnostics) const {
  for (std::size_t i = 0; i < parent.children.size(); ++i) {
    Node& node = parent.children[i];
    const Attribute* id = node.find("id");
    const bool is_object = !object_family(node).empty() || node.tag == "given";
    if (id && is_object && !id->failed) add(*id, {&node, &parent, i}, node.where, diagnostics);
    collect(node, diagnostics);
  }
}

void Ids::collect_aliases(const Node& parent, bool complete, Diagnostics& diagnostics) const {
  for (const Node& node : parent.children) {
    if (node.tag == "alias" && check_attributes(node, {"id", "as"}, {}, diagnostics)) {
      const Attribute& id = *node.find("id");
      if (const Held held = find(id.value); held.node && !id.failed)
        add(*node.find("as"), held, node.where, diagnostics);
      else if (!id.failed && complete)
        diagnostics.error(unknown(id));
    }
    collect_aliases(node, complete, diagnostics);
  }
}

class Resolver {
public:
  Resolver(References& references, ParsedScene& scene, Diagnostics& diagnostics)
      : references_(references),
        scene_(scene),
        diagnostics_(diagnostics),
        extents_(references.node_count()) {}

  void run() {
    locate_files(scene_.root);
    link(scene_.root);
    std::vector<const Node*> path;
    find_cycles(scene_.root, path);
    if (cut_all_)
      references_.targets_ = NodeTable<const Node*>(
          references_.node_count());  // cuts all references, so that no cycle is followed
  }

private:
  void locate_files(Node& object) {
    const PluginInfo* plugin = find_plugin(object_family(object), object.get("type"));
    for (Node& child : object.children) {
      if (Attribute* name = file_name(plugin, child); name && !name->failed) locate(*name, *child.file);
      locate_files(child);
    }
  }

  void locate(Attribute& name, const SourceFile& from) {
    const std::filesystem::path found = find_file(name.value, from, scene_.search_folders);
    const std::string kind = irregular_kind(found);
    if (found.empty() || !kind.empty()) {
      diagnostics_.error(name.where,
                         found.empty()
                             ? "no such file: \"" + name.value + "\"" + searched(from, scene_.search_folders)
                             : "not a regular file but " + kind + ": \"" + name.value + "\"");
      name.failed = true;
      return;
    }
    name.value = found.string();
    references_.files.push_back(found);
    references_.file_attributes_.insert(&name);
  }

  /// Finds the targets of references. Unknown ids are errors, unless a file that could not be read may define
  /// them.
  void link(Node& node) {
    for (Node& child : node.children) {
      if (child.tag != "ref") {
        link(child);
        continue;
      }
      // Elements inside a <ref> are errors and are not linked, because cycles are searched behind references
      // only.
      if (!check_attributes(child, {"id"}, {"name"}, diagnostics_)) continue;
      if (!child.children.empty())
        diagnostics_.error(child.children.front().where, "<ref> can't contain other elements");
      const Attribute& id = *child.find("id");
      if (id.failed) continue;
      const Node* target = references_.ids.follow(child);
      if (target) {
        references_.targets_[child] = target;
        if (&node != &scene_.root) references_.nested_[*target] = true;
      } else if (scene_.complete) {
        diagnostics_.error(references_.ids.unknown(id));
      }
    }
  }

  /// Size of the object graph below a node, with all references followed.
  struct Extent {
    bool known = false;
    std::size_t height = 0;
    std::uint64_t references = 0;
  };

  /// Traverses objects and references depth-first and cuts references that lead back into the current path.
  Extent find_cycles(const Node& node, std::vector<const Node*>& path) {
    if (node.children.empty()) return {};  // a node without children cannot lead back into the path
    if (extents_[node].known) return extents_[node];
    path.push_back(&node);
    Extent extent{true};
    for (const Node& child : node.children) {
      const Node* const target = references_.targets_[child];
      const bool refers = target != nullptr;
      const Node& next = refers ? *target : child;
      const auto start = std::find(path.begin(), path.end(), &next);
      if (start != path.end()) {
        report_cycle(child, next, {start, path.end()});
        // A cycle may also be closed by nesting, where a reference leads to an object inside another one.
        if (refers)
          references_.targets_[child] = nullptr;
        else
          cut_all_ = true;
        continue;
      }
      if (path.size() >= kDeepest) {
        too_deep(child);
        continue;
      }
      const Extent below = find_cycles(next, path);
      extent.height = std::max(extent.height, below.height + 1);
      extent.references = std::min(extent.references + below.references + refers, 2 * kMaxReferences);
      if (path.size() + below.height > kDeepest) too_deep(child);
    }
    path.pop_back();
    const std::string& family = object_family(node);
    if (extent.references > kMaxReferences && !family.empty() && family != "shape") {
      // Objects that refer to this one exceed the limit as well; one error is sufficient.
      if (!cut_all_)
        diagnostics_.error(node.where, "the references below this " + family + " lead to more than " +
                                           std::to_string(kMaxReferences) + " objects");
      cut_all_ = true;
    }
    extents_[node] = extent;
    return extent;
  }

  void report_cycle(const Node& child, const Node& next, const std::vector<const Node*>& path) {
    std::string chain;
    for (const Node* node : path)
      if (node->find("id")) chain += "\"" + node->get("id") + "\" -> ";
    diagnostics_.error(child.where, "circular reference: " + chain + "\"" + next.get("id") + "\"");
  }

  void too_deep(const Node& node) {
    if (!cut_all_)
      diagnostics_.error(node.where, "objects are nested more than " + std::to_string(kDeepest) +
                                         " deep, references included");
    cut_all_ = true;
  }

  References& references_;
  ParsedScene& scene_;
  Diagnostics& diagnostics_;
  NodeTable<Extent> extents_;
  bool cut_all_ = false;
};

References::References(ParsedScene& scene, Diagnostics& diagnostics)
    : ids(scene.root, scene.complete, diagnostics),
      targets_(number_nodes(scene.root)),
      nested_(targets_.size()) {
  Resolver(*this, scene, diagnostics).run();
}

const Node* References::follow(const Node& node) const {
  if (node.tag != "ref") return &node;
  return targets_[node];
}

}  // namespace aureole

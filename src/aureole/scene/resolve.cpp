// SPDX-License-Identifier: Apache-2.0
#include "aureole/scene/resolve.h"

#include <algorithm>

namespace aureole {

namespace {

/// Nested elements and references in one path from the scene down: building them is recursive.
constexpr std::size_t kDeepest = 512;
/// References that are met when all those below an object are followed. A texture or BSDF that uses another
/// one twice, which uses another one twice, ... would take forever to evaluate. Shapes may hold many.
constexpr std::uint64_t kMostReferences = 10000;

class Resolver {
public:
  Resolver(ParsedScene& scene, Diagnostics& diagnostics) : scene_(scene), diagnostics_(diagnostics) {}

  References run() {
    locate_files(scene_.root);
    collect_ids(scene_.root, true);
    collect_aliases(scene_.root);
    link(scene_.root);
    std::vector<const Node*> path;
    find_cycles(scene_.root, path);
    if (cut_all_) references_.targets.clear();  // so that nobody follows them
    return std::move(references_);
  }

private:
  void locate_files(Node& node) {
    Attribute* name = nullptr;
    if (node.tag == "string" && (node.get("name") == "filename" || node.get("name") == "size_histogram"))
      name = node.find("value");
    if (node.tag == "spectrum") name = node.find("filename");
    if (name && !name->failed) {
      const std::filesystem::path found = find_file(name->value, *node.file, scene_.search_folders);
      std::error_code ignored;
      if (found.empty() || !std::filesystem::is_regular_file(found, ignored)) {
        diagnostics_.error(name->where, "no such file: \"" + name->value + "\"" + searched(*node.file));
        name->failed = true;
      } else {
        name->value = found.string();
        references_.files.push_back(found);
      }
    }
    for (Node& child : node.children) locate_files(child);
  }

  std::string searched(const SourceFile& from) const {
    std::string text = " (looked in " + from.folder().string();
    for (const SourceFile* f = from.included_by.get(); f; f = f->included_by.get())
      if (f->folder() != from.folder()) text += ", " + f->folder().string();
    for (const auto& folder : scene_.search_folders) text += ", " + folder.string();
    return text + ")";
  }

  void add_id(const std::string& id, const Node* target, const SourceLocation& where, const Node& place) {
    if (!references_.ids.emplace(id, target).second)
      diagnostics_.error(where, "the id \"" + id + "\" is taken: first given at " + places_[id].str());
    else
      places_[id] = place.where;
  }

  void collect_ids(const Node& node, bool is_root) {
    const Attribute* id = node.find("id");
    const bool is_object = !object_family(node).empty() || is_unsupported_object(node) || node.tag == "given";
    if (id && is_object && !is_root && !id->failed) add_id(id->value, &node, id->where, node);
    for (const Node& child : node.children) collect_ids(child, false);
  }

  void collect_aliases(const Node& node) {
    if (node.tag == "alias" && check_attributes(node, {"id", "as"}, {}, diagnostics_)) {
      if (const Node* target = lookup(*node.find("id")))
        add_id(node.get("as"), target, node.find("as")->where, node);
    }
    for (const Node& child : node.children) collect_aliases(child);
  }

  /// The object of an id; null where there is none, which is reported unless a missing file may be the
  /// reason.
  const Node* lookup(const Attribute& id) {
    if (id.failed) return nullptr;
    const auto found = references_.ids.find(id.value);
    if (found != references_.ids.end()) return found->second;
    std::vector<std::string> names;
    for (const auto& [name, target] : references_.ids) names.push_back(name);
    if (scene_.complete)
      diagnostics_.error(id.where,
                         "no object has the id \"" + id.value + "\"" + did_you_mean(id.value, names));
    return nullptr;
  }

  void link(const Node& node) {
    for (const Node& child : node.children) {
      link(child);
      if (child.tag != "ref" || !check_attributes(child, {"id"}, {"name"}, diagnostics_)) continue;
      if (!child.children.empty())
        diagnostics_.error(child.children.front().where, "<ref> can't contain other elements");
      const Node* target = lookup(*child.find("id"));
      if (!target) continue;
      references_.targets[&child] = target;
      if (&node != &scene_.root) references_.nested.insert(target);
    }
  }

  /// What hangs on a node once all references are followed.
  struct Extent {
    std::size_t height = 0;
    std::uint64_t references = 0;
  };

  /// Depth-first over objects and references; a reference back into the current path is cut.
  Extent find_cycles(const Node& node, std::vector<const Node*>& path) {
    if (const auto known = extents_.find(&node); known != extents_.end()) return known->second;
    path.push_back(&node);
    Extent extent;
    for (const Node& child : node.children) {
      const auto reference = references_.targets.find(&child);
      const bool refers = reference != references_.targets.end();
      const Node& next = refers ? *reference->second : child;
      const auto start = std::find(path.begin(), path.end(), &next);
      if (start != path.end()) {
        report_cycle(child, next, {start, path.end()});
        // A cycle may close by nesting, too, where a reference led to the inside of an object.
        if (refers)
          references_.targets.erase(reference);
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
      extent.references = std::min(extent.references + below.references + refers, 2 * kMostReferences);
      if (path.size() + below.height > kDeepest) too_deep(child);
    }
    path.pop_back();
    const std::string family = object_family(node);
    if (extent.references > kMostReferences && !family.empty() && family != "shape") {
      // What uses it has too many, too, and need not say so again.
      if (!cut_all_)
        diagnostics_.error(node.where, "the references below this " + family + " lead to more than " +
                                           std::to_string(kMostReferences) + " objects");
      cut_all_ = true;
    }
    extents_[&node] = extent;
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

  ParsedScene& scene_;
  Diagnostics& diagnostics_;
  References references_;
  std::map<std::string, SourceLocation> places_;
  std::unordered_map<const Node*, Extent> extents_;
  bool cut_all_ = false;
};

}  // namespace

References resolve(ParsedScene& scene, Diagnostics& diagnostics) {
  return Resolver(scene, diagnostics).run();
}

}  // namespace aureole

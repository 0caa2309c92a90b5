// SPDX-License-Identifier: Apache-2.0
// Hashes of a scene's content, by which a checkpoint identifies its scene, and of single elements, by which
// unchanged objects are found again after an edit.
#include <algorithm>
#include <bit>
#include <filesystem>

#include "aureole/core/input_file.h"
#include "aureole/core/word_hash.h"
#include "aureole/loading/object_pool.h"
#include "aureole/loading/references.h"
#include "aureole/loading/values.h"
#include "aureole/plugin/registry.h"

namespace aureole {

namespace {

using Hash = WordHash<>;

void add_node(const Node& node, const References& references, Hash& hash) {
  hash.text(node.tag);
  std::vector<const Attribute*> sorted;
  for (const Attribute& a : node.attributes) sorted.push_back(&a);
  std::sort(sorted.begin(), sorted.end(),
            [](const Attribute* a, const Attribute* b) { return a->name < b->name; });
  for (const Attribute* a : sorted) {
    if (a->name == "version" || references.names_file(*a))
      continue;  // a path is left out, since a file is hashed by its content
    hash.text(a->name);
    if (node.tag == "string")
      hash.text(a->value);
    else
      for (std::string_view word : split_list(a->value)) hash.text(word);
  }
  const FamilyInfo* family = Registry::instance().family(object_family(node));
  const bool holds_parameters_of_render = family && family->parameters_are_of_render;
  for (const Node& child : node.children)
    if (!(holds_parameters_of_render && family->shares(child.get("name")))) add_node(child, references, hash);
  hash.text("/");
}

/// Calls `use` with the blocks of a file. Throws Error.
template <class Use>
void for_blocks(const std::filesystem::path& file, const Use& use) {
  InputFile input(file);
  std::vector<char> block(1 << 20);
  while (input.left() > 0) {
    const std::size_t count = std::size_t(std::min<std::uint64_t>(block.size(), input.left()));
    input.read(block.data(), count);
    use(block.data(), count);
  }
}

/// Computes the key of an element with everything it refers to.
class KeyMaker {
public:
  KeyMaker(const References& references, const std::map<std::string, ObjectPtr>& given)
      : references_(references),
        given_(given),
        known_(references.node_count()),
        contents_(references.node_count()) {}

  /// Hash of an element's content, without its name and without ids.
  std::uint64_t content(const Node& node) {
    if (const Node* target = references_.follow(node); target && target != &node) return content(*target);
    const bool is_leaf = node.children.empty();  // a leaf is cheaper to hash than to look up
    if (!is_leaf && contents_[node]) return *contents_[node];
    Hash hash;
    hash.text(node.tag);
    for (const Attribute& a : node.attributes) {
      if (a.name == "id" || a.name == "name") continue;
      hash.text(a.name);
      hash.text(a.value);
      if (references_.names_file(a)) add_file(a.value, hash);
    }
    for (const Node& child : node.children) {
      hash.text(child.get("name"));
      hash.number(content(child));
    }
    if (!is_leaf) contents_[node] = hash.value();
    return hash.value();
  }

  std::uint64_t key(const Node& node, bool without_children_of_shape = false) {
    if (const Node* target = references_.follow(node); target && target != &node) return key(*target);
    const bool is_kept = !without_children_of_shape && !node.children.empty();
    if (is_kept && known_[node]) return *known_[node];
    Hash hash;
    hash.text(node.tag);
    for (const Attribute& a : node.attributes) {
      hash.text(a.name);
      hash.text(a.value);
      if (references_.names_file(a)) add_file(a.value, hash);
    }
    for (const Node& child : node.children) {
      if (without_children_of_shape) {
        const Node* target = references_.follow(child);
        if (target && belongs_to_shape(*target)) continue;
      }
      hash.text(child.get("name"));  // the name of a reference is not part of its target's hash
      hash.number(key(child));
    }
    if (is_kept) known_[node] = hash.value();
    return hash.value();
  }

  /// Hash of an element's inputs by which tables are kept on disc: files count by their content, whatever their
  /// names. Nothing where the element holds an object that the program has made. Throws Error for a file that cannot
  /// be read.
  std::optional<WideHashValue> inputs(const Node& node) {
    if (const Node* target = references_.follow(node); target && target != &node) return inputs(*target);
    if (node.tag == "given") return {};
    WideHash hash;
    hash.text(node.tag);
    for (const Attribute& a : node.attributes) {
      if (a.name == "id" || a.name == "name") continue;
      hash.text(a.name);
      if (references_.names_file(a)) {
        // The extension may tell the format.
        hash.text(std::filesystem::path(a.value).extension().string());
        hash.wide(file_content(a.value));
      } else {
        hash.text(a.value);
      }
    }
    for (const Node& child : node.children) {
      const std::optional<WideHashValue> below = inputs(child);
      if (!below) return {};
      hash.text(child.get("name"));
      hash.wide(*below);
    }
    return hash.value();
  }

private:
  const WideHashValue& file_content(const std::string& path) {
    const auto [known, is_new] = file_contents_.try_emplace(path);
    if (is_new) {
      WideHash hash;
      for_blocks(path, [&](const char* data, std::size_t size) { hash.bytes(data, size); });
      known->second = hash.value();
    }
    return known->second;
  }
  bool belongs_to_shape(const Node& node) const {
    if (const FamilyInfo* family = Registry::instance().family(object_family(node)))
      return family->belongs_to_shapes;
    const auto given = node.tag == "given" ? given_.find(node.get("key")) : given_.end();
    if (given == given_.end() || !given->second) return false;
    const Object* object = given->second.get();
    return dynamic_cast<const Bsdf*>(object) || dynamic_cast<const Emitter*>(object) ||
           dynamic_cast<const Sensor*>(object);
  }
  static void add_file(const std::string& path, Hash& hash) {
    std::error_code ignored;
    hash.number(std::uint64_t(std::filesystem::file_size(path, ignored)));
    hash.number(std::uint64_t(std::filesystem::last_write_time(path, ignored).time_since_epoch().count()));
  }

  const References& references_;
  const std::map<std::string, ObjectPtr>& given_;
  NodeTable<std::optional<std::uint64_t>> known_, contents_;
  std::map<std::string, WideHashValue> file_contents_;
};

/// Adds the settings of the scene that objects are built with.
template <class AnyHash>
void add_settings(const BuildContext& context, AnyHash& hash) {
  for (const double x :
       {context.grid.min_nm, context.grid.max_nm, double(context.grid.cells), context.length_unit_m,
        context.energy_preserving ? double(*context.energy_preserving) : -1.0})
    hash.number(std::bit_cast<std::uint64_t>(x));
}

}  // namespace

struct PoolKeys::Maker : KeyMaker {
  using KeyMaker::KeyMaker;
};
PoolKeys::PoolKeys(const References& references, const std::map<std::string, ObjectPtr>& given)
    : maker_(std::make_unique<Maker>(references, given)) {}
PoolKeys::~PoolKeys() = default;
std::uint64_t PoolKeys::of(const Node& node) { return maker_->key(node); }
std::uint64_t PoolKeys::geometry_of(const Node& node) { return maker_->key(node, true); }
std::uint64_t PoolKeys::content_of(const Node& node, const BuildContext& context) {
  Hash hash;
  hash.number(maker_->content(node));
  add_settings(context, hash);
  return hash.value();
}
std::optional<WideHashValue> PoolKeys::inputs_of(const Node& node, const BuildContext& context) {
  const std::optional<WideHashValue> inputs = maker_->inputs(node);
  if (!inputs) return {};
  WideHash hash;
  hash.wide(*inputs);
  add_settings(context, hash);
  return hash.value();
}

std::uint64_t elements_hash(const Node& root, const References& references) {
  Hash hash;
  add_node(root, references, hash);
  return hash.value();
}

std::uint64_t content_hash(std::uint64_t elements, const References& references) {
  Hash hash;
  hash.number(elements);
  for (const auto& file : references.files)
    for_blocks(file, [&](const char* data, std::size_t size) { hash.bytes(data, size); });
  return hash.value();
}

}  // namespace aureole

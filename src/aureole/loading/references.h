// SPDX-License-Identifier: Apache-2.0
// Fourth stage of loading: ids, references and file names.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <unordered_set>
#include <vector>

#include "aureole/loading/parse.h"

namespace aureole {

/// The elements by id, used wherever a <ref> is followed. Holds pointers into the tree, whose nodes must not
/// move.
class Ids {
public:
  /// An object and its parent; null pointers for an unknown id.
  struct Held {
    Node* node = nullptr;
    Node* parent = nullptr;
    std::size_t child = 0;  ///< index among the parent's children
  };

  /// If an id is given twice, the first object is used. The tree is read on the first look-up of an id.
  explicit Ids(Node& root) : root_(&root) {}
  /// Reads the tree, and reports duplicate ids and, if the whole tree could be read (`complete`), aliases of
  /// unknown ids.
  Ids(Node& root, bool complete, Diagnostics& diagnostics);

  Node& root() const { return *root_; }
  Held find(const std::string& id) const;
  /// Returns the node itself; for a <ref>, the node it refers to, or null.
  Node* follow(Node& node) const { return node.tag == "ref" ? find(node.get("id")).node : &node; }
  /// An error such as: no object has the id "wal"; did you mean "wall"?
  Error unknown(const Attribute& id) const;

private:
  void collect_all(bool complete, Diagnostics& diagnostics) const;
  void collect(Node& parent, Diagnostics& diagnostics) const;
  void collect_aliases(const Node& parent, bool complete, Diagnostics& diagnostics) const;
  void add(const Attribute& id, const Held& held, const SourceLocation& place,
           Diagnostics& diagnostics) const;

  struct Entry {
    Held held;
    SourceLocation place;  ///< location of the object or the alias
  };
  Node* root_;
  mutable bool is_collected_ = false;
  mutable std::map<std::string, Entry> entries_;
};

/// The targets of a scene's references, and its files. Holds pointers into the node tree, which must not
/// change any more.
class References {
public:
  /// Numbers the nodes (`NodeTable`), makes file names absolute and finds the target of every reference. Reports
  /// duplicate ids, unknown ids, circular references and missing files.
  References(ParsedScene& scene, Diagnostics& diagnostics);

  /// Returns the node itself; for a valid <ref>, its target; else null. References form no cycles.
  const Node* follow(const Node& node) const;
  /// Whether a <ref> inside another object refers to this node.
  bool is_nested(const Node& node) const { return nested_[node]; }
  /// Whether the value of an attribute is the name of a file.
  bool names_file(const Attribute& attribute) const { return file_attributes_.contains(&attribute); }

  /// Returns the number of nodes in the tree.
  std::size_t node_count() const { return targets_.size(); }

  Ids ids;
  std::vector<std::filesystem::path> files;  ///< files that the scene names, in order

private:
  friend class Resolver;
  NodeTable<const Node*> targets_;  ///< target of each valid <ref>; null for other nodes
  NodeTable<char> nested_;          ///< whether a <ref> inside another object refers to the node
  std::unordered_set<const Attribute*> file_attributes_;
};

/// A hash that changes with the elements of the scene, but not with comments, white space, names of files, or the
/// sampler's sample_count and seed.
std::uint64_t elements_hash(const Node& root, const References& references);
/// A hash that changes with the content of the scene and of the referenced files: `elements` is its `elements_hash`.
std::uint64_t content_hash(std::uint64_t elements, const References& references);

}  // namespace aureole

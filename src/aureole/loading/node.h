// SPDX-License-Identifier: Apache-2.0
// A scene file as a tree of plain nodes with source locations. The stages of loading are functions on this
// tree: parse -> upgrade -> override -> resolve -> build.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "aureole/core/error.h"

namespace aureole {

using SceneVersion = std::array<int, 3>;

/// A source file: the main scene file or an included one.
struct SourceFile {
  std::filesystem::path path;  ///< absolute path
  std::string shown;           ///< file name in messages: relative if the user gave a relative path
  SceneVersion version{3, 0, 0};
  std::shared_ptr<const SourceFile> included_by;  ///< file that includes this one; null for the main file
  SourceLocation included_at;

  std::filesystem::path folder() const { return path.parent_path(); }
};
using SourceFilePtr = std::shared_ptr<const SourceFile>;

struct Attribute {
  std::string name, value;
  SourceLocation where;  ///< location of the value
  bool failed = false;   ///< whether an error about the value has been reported
};

struct Node {
  std::string tag;
  std::vector<Attribute> attributes;
  std::vector<Node> children;
  SourceLocation where;
  SourceFilePtr file;
  std::uint32_t number = 0;  ///< index in the tree that `number_nodes` counted last

  const Attribute* find(std::string_view name) const;
  Attribute* find(std::string_view name);
  /// Returns the attribute's value, or an empty string.
  const std::string& get(std::string_view name) const;
  /// Changes an attribute, or adds it with the node's location.
  void set(std::string_view name, std::string value);
  /// Returns the child whose attribute "name" equals `name`, or null.
  Node* named_child(std::string_view name);
};

/// Numbers a node and all its descendants from 0 in document order. Returns the number of nodes.
std::size_t number_nodes(Node& root);

/// One value for each node of a numbered tree.
template <class T>
class NodeTable {
public:
  NodeTable() = default;
  explicit NodeTable(std::size_t nodes) : values_(nodes) {}
  T& operator[](const Node& node) { return values_[node.number]; }
  const T& operator[](const Node& node) const { return values_[node.number]; }
  std::size_t size() const { return values_.size(); }

private:
  std::vector<T> values_;
};

/// Returns an element <tag name="..." value="..."/>, located at `near`.
Node parameter_node(const Node& near, std::string_view tag, std::string_view name, const std::string& value);

/// Returns the plug-in family of an object element ("texture" for <spectrum type="...">), or an empty string
/// for any other element.
const std::string& object_family(const Node& node);

/// Whether the node is a <float>, <rgb>, <transform> or another element that gives a parameter a value.
bool is_property(const Node& node);

/// All element names, for suggestions.
std::vector<std::string> all_tags();

/// Reports missing and unexpected attributes; returns false if a required one is missing.
bool check_attributes(const Node& node, std::initializer_list<std::string_view> required,
                      std::initializer_list<std::string_view> optional, Diagnostics& diagnostics);

}  // namespace aureole

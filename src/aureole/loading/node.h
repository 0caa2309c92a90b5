// SPDX-License-Identifier: Apache-2.0
// A scene file as a tree of plain nodes that remember where they were written. The stages of loading are
// functions on this tree: parse -> upgrade -> override -> resolve -> build.
#pragma once

#include <array>
#include <filesystem>
#include <initializer_list>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "aureole/core/error.h"

namespace aureole {

using SceneVersion = std::array<int, 3>;

/// The main scene file or an included one.
struct SourceFile {
  std::filesystem::path path;  ///< absolute
  std::string shown;           ///< how messages call it: relative where the user's own path was
  SceneVersion version{3, 0, 0};
  std::shared_ptr<const SourceFile> included_by;  ///< null for the main file
  SourceLocation included_at;

  std::filesystem::path folder() const { return path.parent_path(); }
};
using SourceFilePtr = std::shared_ptr<const SourceFile>;

struct Attribute {
  std::string name, value;
  SourceLocation where;  ///< of the value
  bool failed = false;   ///< an error about the value has been reported already
};

struct Node {
  std::string tag;
  std::vector<Attribute> attributes;
  std::vector<Node> children;
  SourceLocation where;
  SourceFilePtr file;

  const Attribute* find(std::string_view name) const;
  Attribute* find(std::string_view name);
  /// The attribute's value, or an empty string.
  std::string get(std::string_view name) const;
  /// Changes an attribute or adds it at the node's location.
  void set(std::string_view name, std::string value);
  /// The child whose attribute `name` is `name`, or null.
  Node* named_child(std::string_view name);
};

/// The plug-in family of an object element ("texture" for <spectrum type="...">), or an empty string for all
/// others.
std::string object_family(const Node& node);

/// True for <float>, <rgb>, <transform> and the other elements that give a parameter a value.
bool is_property(const Node& node);

/// All element names, for suggestions.
std::vector<std::string> all_tags();

/// Reports missing and unexpected attributes; false if a required one is missing.
bool check_attributes(const Node& node, std::initializer_list<std::string_view> required,
                      std::initializer_list<std::string_view> optional, Diagnostics& diagnostics);

}  // namespace aureole

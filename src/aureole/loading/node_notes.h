// SPDX-License-Identifier: Apache-2.0
// The elements of a scene file that its notes are about.
#pragma once

#include <string>
#include <unordered_map>
#include <vector>

#include "aureole/loading/references.h"

namespace aureole {

/// Notes by the element at which they are located.
class NodeNotes {
public:
  /// Keeps references to all arguments. Notes begin with a location, such as "scene.xml:3:5: ".
  NodeNotes(const Node& root, const References& references, const std::vector<std::string>& notes);

  /// Selects the notes about an element, about those within it, and about targets of their references.
  void select(const Node& node);
  /// The selected notes, and all that belong to no object, in the order in which they were given.
  std::vector<std::string> selected() const;

private:
  void add_locations(const Node& node, bool is_in_object);

  const References& references_;
  const std::vector<std::string>& notes_;
  std::unordered_map<std::string, const Node*> nodes_;  ///< by location; null for elements in no object
  std::unordered_map<const Node*, std::vector<std::size_t>> by_node_;
  std::vector<bool> is_selected_, is_visited_;
};

}  // namespace aureole

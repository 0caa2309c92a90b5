// SPDX-License-Identifier: Apache-2.0
#include "aureole/loading/node_notes.h"

namespace aureole {

NodeNotes::NodeNotes(const Node& root, const References& references, const std::vector<std::string>& notes)
    : references_(references),
      notes_(notes),
      is_selected_(notes.size()),
      is_visited_(references.node_count()) {
  if (notes.empty()) return;
  add_locations(root, false);
  for (std::size_t i = 0; i < notes.size(); ++i) {
    const Node* node = nullptr;
    // A file's name may contain a colon.
    for (std::size_t end = notes[i].find(": "); end != std::string::npos;
         end = notes[i].find(": ", end + 1)) {
      const auto found = nodes_.find(notes[i].substr(0, end));
      if (found == nodes_.end()) continue;
      node = found->second;
      break;
    }
    if (node)
      by_node_[node].push_back(i);
    else
      is_selected_[i] = true;
  }
}

void NodeNotes::add_locations(const Node& node, bool is_in_object) {
  const bool is_inside = is_in_object || !object_family(node).empty();
  // Elements that an upgrade has made have the location of the outermost one.
  nodes_.try_emplace(node.where.str(), is_inside ? &node : nullptr);
  for (const Attribute& attribute : node.attributes)
    nodes_.try_emplace(attribute.where.str(), is_inside ? &node : nullptr);
  for (const Node& child : node.children) add_locations(child, is_inside);
}

void NodeNotes::select(const Node& node) {
  if (notes_.empty() || is_visited_[node.number]) return;
  is_visited_[node.number] = true;
  if (const auto found = by_node_.find(&node); found != by_node_.end())
    for (const std::size_t i : found->second) is_selected_[i] = true;
  if (const Node* target = references_.follow(node); target && target != &node) select(*target);
  for (const Node& child : node.children) select(child);
}

std::vector<std::string> NodeNotes::selected() const {
  std::vector<std::string> chosen;
  for (std::size_t i = 0; i < notes_.size(); ++i)
    if (is_selected_[i]) chosen.push_back(notes_[i]);
  return chosen;
}

}  // namespace aureole

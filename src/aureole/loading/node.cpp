// SPDX-License-Identifier: Apache-2.0
#include "aureole/loading/node.h"

#include <algorithm>

#include "aureole/loading/aliases.h"
#include "aureole/plugin/registry.h"

namespace aureole {

namespace {

const std::string kNone;
const std::vector<std::string> kProperties = {"boolean", "integer", "float",    "string",    "point",
                                              "vector",  "rgb",     "spectrum", "transform", "animation"};
const std::vector<std::string> kOthers = {"scene", "default",   "include", "path",  "ref",    "alias",
                                          "given", "translate", "rotate",  "scale", "lookat", "matrix"};

bool contains(const std::vector<std::string>& list, std::string_view name) {
  return std::find(list.begin(), list.end(), name) != list.end();
}

void number_from(Node& node, std::size_t& next) {
  node.number = std::uint32_t(next++);
  for (Node& child : node.children) number_from(child, next);
}

}  // namespace

std::size_t number_nodes(Node& root) {
  std::size_t count = 0;
  number_from(root, count);
  return count;
}

const Attribute* Node::find(std::string_view name) const {
  for (const Attribute& a : attributes)
    if (a.name == name) return &a;
  return nullptr;
}

Attribute* Node::find(std::string_view name) {
  return const_cast<Attribute*>(static_cast<const Node*>(this)->find(name));
}

const std::string& Node::get(std::string_view name) const {
  const Attribute* a = find(name);
  return a ? a->value : kNone;
}

void Node::set(std::string_view name, std::string value) {
  if (Attribute* a = find(name))
    a->value = std::move(value), a->failed = false;
  else
    attributes.push_back({std::string(name), std::move(value), where});
}

Node* Node::named_child(std::string_view name) {
  for (Node& c : children)
    if (c.get("name") == name) return &c;
  return nullptr;
}

Node parameter_node(const Node& near, std::string_view tag, std::string_view name, const std::string& value) {
  Node node{std::string(tag), {}, {}, near.where, near.file};
  node.set("name", std::string(name));
  node.set("value", value);
  return node;
}

const std::string& object_family(const Node& node) {
  const FamilyInfo* family = Registry::instance().family_of_element(node.tag, node.find("type") != nullptr);
  return family ? family->name : kNone;
}

bool is_property(const Node& node) { return contains(kProperties, node.tag) && object_family(node).empty(); }

std::vector<std::string> all_tags() {
  std::vector<std::string> all = Registry::instance().families();
  for (const auto& list : {kProperties, kOthers}) all.insert(all.end(), list.begin(), list.end());
  return all;
}

bool check_attributes(const Node& node, std::initializer_list<std::string_view> required,
                      std::initializer_list<std::string_view> optional, Diagnostics& diagnostics) {
  const auto is_in = [](std::initializer_list<std::string_view> list, std::string_view name) {
    return std::find(list.begin(), list.end(), name) != list.end();
  };
  for (const Attribute& a : node.attributes) {
    if (is_in(required, a.name) || is_in(optional, a.name)) continue;
    std::vector<std::string> allowed(required.begin(), required.end());
    allowed.insert(allowed.end(), optional.begin(), optional.end());
    diagnostics.error(a.where, "unexpected attribute \"" + a.name + "\" of <" + node.tag + ">" +
                                   did_you_mean(a.name, allowed));
  }
  bool complete = true;
  for (std::string_view name : required) {
    if (node.find(name)) continue;
    diagnostics.error(node.where, "<" + node.tag + "> needs the attribute \"" + std::string(name) + "\"");
    complete = false;
  }
  return complete;
}

}  // namespace aureole

// SPDX-License-Identifier: Apache-2.0
#include "aureole/loading/radio_materials.h"

#include <fmt/format.h>

#include <algorithm>

#include "aureole/parameter/radio_index.h"

namespace aureole {

namespace {

constexpr const char* kThickness = "0.1m";  // default thickness in sionna-rt

void make_slab(Node& bsdf, const std::string& material, const std::string& thickness) {
  bsdf.set("type", "slab");
  bsdf.children.clear();
  bsdf.children.push_back(parameter_node(bsdf, "string", "int_ior", material));
  bsdf.children.push_back(parameter_node(bsdf, "string", "thickness", thickness));
}

bool is_made_of_radio_material(const Node& node) {
  return node.get("value").starts_with("itu_") ||
         std::any_of(node.children.begin(), node.children.end(), is_made_of_radio_material);
}

/// The BSDFs that were replaced by materials, and the location of the first.
struct Replaced {
  std::vector<std::string> materials;
  std::size_t count = 0;
  SourceLocation first;
  std::size_t others = 0;  ///< number of BSDFs that are no building materials
  SourceLocation first_other;
};

void replace_below(Node& parent, const std::vector<std::string>& known, Replaced& replaced,
                   Diagnostics& diagnostics) {
  for (Node& node : parent.children) {
    const std::string& id = node.get("id");
    const std::string material = id.starts_with("mat-") ? id.substr(4) : id;
    if (node.tag == "bsdf" && is_made_of_radio_material(node)) continue;
    if (node.tag != "bsdf" || !material.starts_with("itu_")) {
      // A BSDF that contains a BSDF with the name of a material becomes that material.
      const std::size_t others = replaced.others, count = replaced.count;
      const SourceLocation first_other = replaced.first_other;
      replace_below(node, known, replaced, diagnostics);
      if (node.tag != "bsdf") continue;
      replaced.others = others, replaced.first_other = first_other;
      if (replaced.count == count && replaced.others++ == 0) replaced.first_other = node.where;
      continue;
    }
    if (std::find(known.begin(), known.end(), material) == known.end()) {
      diagnostics.error(node.where, "the id \"" + id + "\" names no building material" +
                                        did_you_mean_or_all(material, known));
      continue;
    }
    if (replaced.count++ == 0) replaced.first = node.where;
    if (std::find(replaced.materials.begin(), replaced.materials.end(), material) == replaced.materials.end())
      replaced.materials.push_back(material);
    make_slab(node, material, kThickness);
  }
}

}  // namespace

void upgrade_radio_material(Node& bsdf, Diagnostics& diagnostics) {
  const Node* type = bsdf.named_child("type");
  if (!type) {
    diagnostics.error(bsdf.where, "an \"itu-radio-material\" needs a \"type\", such as concrete");
    return;
  }
  const Node* thickness = bsdf.named_child("thickness");
  for (const Node& child : bsdf.children) {
    const std::string& name = child.get("name");
    if (name == "type" || name == "thickness" || name == "color") continue;
    const std::string& value = child.get("value");
    const bool is_zero =
        child.tag == "float" && !value.empty() && value.find_first_not_of("0.") == value.npos;
    if (!is_zero)
      diagnostics.note(child.where,
                       "\"" + name + "\" is ignored: walls reflect as mirrors and scatter nothing");
  }
  const std::string material = "itu_" + type->get("value");
  std::string metres = thickness ? thickness->get("value") : kThickness;
  if (!metres.empty() && metres.back() == '.') metres.pop_back();  // a number written as "1."
  if (thickness) metres += "m";
  diagnostics.note(bsdf.where, "bsdf \"itu-radio-material\" is replaced by \"slab\" of " + material + ", " +
                                   metres + " thick");
  make_slab(bsdf, material, metres);
}

void replace_radio_materials(Node& root, Diagnostics& diagnostics) {
  Replaced replaced;
  replace_below(root, radio_material_names(), replaced, diagnostics);
  if (replaced.others > 0)
    diagnostics.note(
        replaced.first_other,
        fmt::format(
            "{} {} no building material, neither by {} id (\"mat-itu_concrete\") nor by a parameter: {} "
            "as for light",
            replaced.others, replaced.others == 1 ? "BSDF is" : "BSDFs are",
            replaced.others == 1 ? "its" : "their", replaced.others == 1 ? "it scatters" : "they scatter"));
  if (replaced.count == 0) return;
  diagnostics.note(
      replaced.first,
      fmt::format("{} {} named after building materials ({}) {} replaced by slabs of these, {} thick",
                  replaced.count, replaced.count == 1 ? "BSDF" : "BSDFs", fmt::join(replaced.materials, ", "),
                  replaced.count == 1 ? "is" : "are", kThickness));
}

}  // namespace aureole

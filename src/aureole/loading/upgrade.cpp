// SPDX-License-Identifier: Apache-2.0
#include "aureole/loading/upgrade.h"

#include <algorithm>
#include <cctype>
#include <unordered_map>

#include "aureole/core/letter_case.h"
#include "aureole/core/units.h"
#include "aureole/loading/aliases.h"
#include "aureole/loading/radio_materials.h"
#include "aureole/loading/upgrade_adapters.h"
#include "aureole/loading/upgrade_diffraction.h"
#include "aureole/loading/upgrade_old_plugins.h"
#include "aureole/loading/values.h"

namespace aureole {

namespace {

/// A parameter of Mitsuba 0.6 that has no effect here. An empty family matches every family.
struct Dropped {
  std::string_view family, name;
  bool quietly = false;
};
constexpr Dropped kDropped[] = {
    {"film", "banner", true},
    {"film", "gamma"},
    {"film", "attach_log"},
    {"film", "high_quality_edges"},
    {"film", "exposure"},
    {"film", "tonemap_method"},
    {"film", "key"},
    {"film", "burn"},
    {"texture", "gamma"},
    {"texture", "max_anisotropy"},
    {"texture", "cache"},
    {"", "strict_normals"},
    {"", "intensity_distribution"},
    {"", "attach_log"},
    {"medium", "method"},
    {"", "step_size"},
    {"", "step_size_factor"},
    {"shape", "collapse"},
    {"sampler", "scramble"},
    {"volume", "send_data"},
};

bool is_object(const Node& node) { return !object_family(node).empty(); }

/// Parameters such as `label[10, 10]` and `metadata['author']` write text into the picture or its header.
bool is_film_text(std::string_view name) { return name.starts_with("label") || name.starts_with("metadata"); }

void rename(Node& node, std::string_view from, std::string_view to) {
  if (Attribute* a = node.find("name"); a && a->value == from) a->value = to;
}

void note_dropped(const Node& node, const std::string& name, Diagnostics& diagnostics) {
  diagnostics.note(node.where, "\"" + name + "\" has no effect and is ignored");
}

void drop_parameters(Node& object, Diagnostics& diagnostics) {
  const std::string family = object_family(object);
  std::erase_if(object.children, [&](const Node& child) {
    const std::string name = child.get("name");
    if (is_object(child) || child.tag == "ref" || name.empty()) return false;
    for (const Dropped& d : kDropped) {
      if (d.name != name || (!d.family.empty() && d.family != family)) continue;
      if (!d.quietly) note_dropped(child, name, diagnostics);
      return true;
    }
    if (family != "film" || !is_film_text(name)) return false;
    note_dropped(child, name, diagnostics);
    return true;
  });
}

/// Drops a bitmap's `gamma` of 1, its only supported value: the file contains linear values.
void upgrade_bitmap(Node& bitmap, Diagnostics& diagnostics) {
  if (Node* gamma = bitmap.named_child("gamma"); gamma && !bitmap.named_child("raw")) {
    const std::string value = gamma->get("value");
    if (value == "1" || value == "1.0") {
      diagnostics.note(gamma->where, "gamma = 1 is read as raw = true: the file holds linear values");
      gamma->tag = "boolean";
      gamma->set("name", "raw");
      gamma->set("value", "true");
    }
  }
  if (Node* filter = bitmap.named_child("filter_type")) {
    const std::string value = filter->get("value");
    if (value == "trilinear" || value == "ewa") {
      diagnostics.note(filter->where, "filter_type \"" + value + "\" is replaced by \"bilinear\"");
      filter->set("value", "bilinear");
    }
  }
}

void upgrade_ldrfilm(Node& film, Diagnostics& diagnostics) {
  diagnostics.note(film.where,
                   "film \"ldrfilm\" is replaced by \"hdrfilm\": tone mapping is done after rendering");
  film.set("type", "hdrfilm");
  std::erase_if(film.children, [&](const Node& child) {
    if (child.get("name") != "file_format") return false;
    note_dropped(child, "file_format", diagnostics);
    return true;
  });
}

/// Converts uscale, vscale, uoffset, voffset to to_uv = Scale * Translate, as Mitsuba 2 and later do.
void upgrade_uv(Node& object) {
  Node translate, scale;
  translate.tag = "translate", scale.tag = "scale";
  const struct {
    std::string_view name, axis;
    Node& step;
  } parts[] = {{"uoffset", "x", translate},
               {"voffset", "y", translate},
               {"uscale", "x", scale},
               {"vscale", "y", scale}};

  Node transform{"transform", {}, {}, {}, object.file};
  for (const auto& part : parts) {
    const auto found = std::find_if(object.children.begin(), object.children.end(), [&](const Node& c) {
      return c.get("name") == part.name && c.find("value");
    });
    if (found == object.children.end()) continue;
    if (transform.where.line == 0) transform.where = found->where;
    part.step.where = found->where;
    part.step.file = object.file;
    Attribute value = *found->find("value");
    value.name = part.axis;
    part.step.attributes.push_back(std::move(value));
    object.children.erase(found);
  }
  for (Node* step : {&translate, &scale})
    if (!step->attributes.empty()) transform.children.push_back(std::move(*step));
  if (transform.children.empty()) return;
  transform.set("name", "to_uv");
  object.children.push_back(std::move(transform));
}

/// Converts <srgb> to <rgb> with linear values. Unreadable colours are left to the reader of <rgb> to report.
void upgrade_srgb(Node& node) {
  node.tag = "rgb";
  Attribute* value = node.find("value");
  if (!value || value->failed || value->value.find('#') != std::string::npos)
    return;  // nothing to convert, since <rgb> decodes #rrggbb
  try {
    const std::vector<double> encoded = parse_numbers(value->value);
    std::string linear;
    for (double v : encoded) linear += (linear.empty() ? "" : ", ") + number_text(srgb_to_linear(v));
    value->value = linear;
  } catch (const Error&) {
  }
}

/// Converts <blackbody temperature="5000K" scale="2"/> to the spectrum plug-in of that name.
void upgrade_blackbody(Node& node) {
  node.tag = "spectrum";
  Node parameters;
  for (const char* name : {"temperature", "scale"}) {
    const Attribute* a = node.find(name);
    if (!a || (a->name == "scale" && a->value == "1")) continue;
    Node child{"float",
               {{"name", name, a->where, false}, {"value", a->value, a->where, a->failed}},
               {},
               node.where,
               node.file};
    std::string& text = child.find("value")->value;
    if (!text.empty() && (text.back() == 'K' || text.back() == 'k')) text.pop_back();
    node.children.push_back(std::move(child));
  }
  std::erase_if(node.attributes,
                [](const Attribute& a) { return a.name == "temperature" || a.name == "scale"; });
  node.set("type", "blackbody");
}

/// Drops the exterior index of conductors: conductors are always in vacuum here, which `extEta` almost always
/// states.
void drop_vacuum_around_conductor(Node& bsdf, Diagnostics& diagnostics) {
  std::erase_if(bsdf.children, [&](const Node& child) {
    const std::string value = child.get("value");
    const bool is_vacuum = value == "1" || value == "1.0" || value == "air" || value == "vacuum";
    if (child.get("name") != "ext_ior" || !is_vacuum) return false;
    note_dropped(child, "ext_eta", diagnostics);
    return true;
  });
}

Node property(const Node& owner, std::string_view tag, std::string name, std::string value) {
  return {std::string(tag),
          {{"name", std::move(name), owner.where, false}, {"value", std::move(value), owner.where, false}},
          {},
          owner.where,
          owner.file};
}

/// Converts `sky`, `sun` and `sunsky` of 0.6, where y is up, north is -z, and one `scale` applies to both.
void upgrade_sky(Node& emitter, const std::string& type, Diagnostics& diagnostics) {
  if (type != "sunsky") {
    diagnostics.note(emitter.where, "emitter \"" + type + "\" is replaced by \"sunsky\" without its " +
                                        (type == "sky" ? "sun" : "sky"));
    emitter.set("type", "sunsky");
  }
  for (const char* name : {"resolution", "stretch", "extend"})
    if (const Node* child = emitter.named_child(name)) {
      note_dropped(*child, name, diagnostics);
      std::erase_if(emitter.children, [&](const Node& c) { return c.get("name") == name; });
    }
  if (Node* radius = emitter.named_child("sun_radius_scale")) {
    rename(*radius, "sun_radius_scale", "sun_aperture");
    Attribute* value = radius->find("value");
    try {
      if (value && !value->failed) value->value = number_text(0.5358 * parse_number(value->value));
    } catch (const Error&) {  // the reader of the parameter reports the error
    }
  }
  std::string scale = "1";
  std::erase_if(emitter.children, [&](const Node& child) {
    if (child.get("name") != "scale" || !child.find("value")) return false;
    scale = child.get("value");
    return true;
  });
  const auto add_missing = [&](std::string_view tag, const char* name, const std::string& value) {
    if (!emitter.named_child(name)) emitter.children.push_back(property(emitter, tag, name, value));
  };
  add_missing("float", "sun_scale", type == "sky" ? "0" : scale);
  add_missing("float", "sky_scale", type == "sun" ? "0" : scale);
  add_missing("float", "albedo", "0.15");
  if (!emitter.named_child("to_world")) {
    Node transform{"transform", {}, {}, emitter.where, emitter.file};
    transform.set("name", "to_world");
    emitter.children.push_back(std::move(transform));
  }
  Node& to_world = *emitter.named_child("to_world");
  Node axes{"matrix", {}, {}, to_world.where, to_world.file};
  axes.set("value", "0 -1 0 0  0 0 1 0  1 0 0 0  0 0 0 1");
  to_world.children.insert(to_world.children.begin(), std::move(axes));
}

/// Converts the plug-in name "Rectangle", which older exporters write, to "rectangle".
void lower_type(Node& object, Diagnostics& diagnostics) {
  Attribute* type = object.find("type");
  const std::string family = object_family(object);
  if (!type || type->failed || family.empty() || find_plugin(family, type->value)) return;
  const std::string lower = lower_case(type->value);
  if (lower == type->value || !find_plugin(family, lower)) return;
  diagnostics.note(type->where, family + " \"" + type->value + "\" is read as \"" + lower +
                                    "\": names of plug-ins have no capital letters");
  type->value = lower;
}

void upgrade_node(Node& node, Diagnostics& diagnostics) {
  if (node.tag == "lookAt") node.tag = "lookat";
  if (node.tag == "srgb") upgrade_srgb(node);
  if (node.tag == "blackbody") upgrade_blackbody(node);
  for (Node& child : node.children) {
    Attribute* name = child.find("name");
    if (name && !is_film_text(name->value)) name->value = snake_case(name->value);
  }
  if (node.tag == "spectrum" || is_object(node)) upgrade_old_plugin(node, diagnostics);
  if (!is_object(node)) return;

  const std::string type = node.get("type");
  if (node.tag == "bsdf") {
    for (Node& child : node.children) {
      if (type == "diffuse" || type == "roughdiffuse") rename(child, "diffuse_reflectance", "reflectance");
      rename(child, "ext_eta", "ext_ior");
    }
    if (type.ends_with("conductor")) drop_vacuum_around_conductor(node, diagnostics);
    upgrade_adapter(node, diagnostics);
  }
  if (node.tag == "texture" && type == "bitmap") upgrade_bitmap(node, diagnostics);
  if (node.tag == "film" && type == "ldrfilm") upgrade_ldrfilm(node, diagnostics);
  if (node.tag == "emitter" && (type == "sky" || type == "sun" || type == "sunsky"))
    upgrade_sky(node, type, diagnostics);
  drop_parameters(node, diagnostics);
  upgrade_uv(node);
}

using Families = std::unordered_map<std::string, std::string>;

/// Adds the family of each object that has an id.
void add_families(const Node& node, Families& of_id) {
  if (is_object(node) && node.find("id")) of_id.try_emplace(node.get("id"), object_family(node));
  for (const Node& child : node.children) add_families(child, of_id);
}

/// Gives shapes with a medium inside or outside, without a BSDF and without anything else that makes a surface of them, the BSDF
/// `null`, as Mitsuba 0.6 has it: an interface between media that light passes straight. Later versions give them `diffuse`.
void upgrade_interfaces(const Families& of_id, Node& node, Diagnostics& diagnostics) {
  for (Node& child : node.children) upgrade_interfaces(of_id, child, diagnostics);
  if (node.tag != "shape" || !node.file || !(node.file->version < SceneVersion{2, 0, 0})) return;
  const Node* medium = node.named_child("interior");
  if (!medium) medium = node.named_child("exterior");
  if (!medium) return;
  for (const Node& child : node.children) {
    const auto referenced = child.tag == "ref" ? of_id.find(child.get("id")) : of_id.end();
    const std::string& family = referenced != of_id.end() ? referenced->second : object_family(child);
    if (family == "bsdf" || family == "emitter" || family == "sensor" || family == "bssrdf") return;
  }
  diagnostics.note(medium->where,
                   "the shape has a medium and no BSDF: as in Mitsuba 0.6 its surface is \"null\", an "
                   "interface that light passes straight");
  Node bsdf{"bsdf", {}, {}, node.where, node.file};
  bsdf.set("type", "null");
  node.children.push_back(std::move(bsdf));
}

}  // namespace

std::string snake_case(std::string_view name) {
  const auto upper = [&](std::size_t i) {
    return i < name.size() && std::isupper(static_cast<unsigned char>(name[i]));
  };
  const auto lower = [&](std::size_t i) { return std::islower(static_cast<unsigned char>(name[i])) != 0; };
  std::string result;
  for (std::size_t i = 0; i < name.size(); ++i) {
    if (i == 0 || !upper(i) || !lower(i - 1)) {
      result += name[i];
      continue;
    }
    result += '_';
    for (; upper(i); ++i) result += char(std::tolower(static_cast<unsigned char>(name[i])));
    --i;
  }
  return result;
}

void upgrade(Node& node, Diagnostics& diagnostics) {
  for (Node& child : node.children) upgrade(child, diagnostics);
  lower_type(node, diagnostics);
  if (node.tag == "bsdf" && node.get("type") == "itu-radio-material")
    upgrade_radio_material(node, diagnostics);
  // Ids with a leading underscore, which Mitsuba 2 renamed, need no conversion here.
  if (node.file && node.file->version < SceneVersion{2, 0, 0}) {
    upgrade_node(node, diagnostics);
    if (node.tag == "scene") {
      upgrade_diffraction(node, diagnostics);
      Families of_id;
      add_families(node, of_id);
      upgrade_interfaces(of_id, node, diagnostics);
    }
  }
}

}  // namespace aureole

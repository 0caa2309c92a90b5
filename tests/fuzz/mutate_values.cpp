// SPDX-License-Identifier: Apache-2.0
// Changes to attributes and parameters.
#include <algorithm>
#include <cctype>
#include <cstring>

#include "aureole/loading/node.h"
#include "aureole/plugin/registry.h"
#include "fuzz/mutate_scene.h"
#include "fuzz/scene_values.h"
#include "fuzz/wrap.h"

namespace aureole::fuzz {

namespace {

std::string family_of(pugi::xml_node node) {
  const FamilyInfo* family = Registry::instance().family_of_element(node.name(), true);
  return family ? family->name : node.name();
}

bool change_value(SceneEdit& e) {
  for (int tries = 0; tries < 20; ++tries) {
    pugi::xml_attribute a = e.any_attribute();
    const std::string_view name = a.name();
    if (!a || name == "name" || name == "type" || name == "id" || name == "filename") continue;
    const bool is_integer = std::all_of(a.value(), a.value() + std::strlen(a.value()),
                                        [](unsigned char c) { return std::isdigit(c) || c == '-'; });
    return a.set_value((is_integer && (e.random.is_gentle() || e.random.chance(0.7))
                            ? any_integer(e.random)
                            : changed_value(a.value(), e.random))
                           .c_str());
  }
  return false;
}

bool odd_value(SceneEdit& e) { return e.any_attribute().set_value(odd_text(e.random).c_str()); }

bool rename_attribute(SceneEdit& e) {
  static const char* const kNames[] = {"name",   "value",   "id",   "type",    "filename", "x",
                                       "y",      "z",       "up",   "angle",   "as",       "origin",
                                       "target", "version", "unit", "nonsense"};
  return e.any_attribute().set_name(e.random.pick(kNames));
}

bool remove_attribute(SceneEdit& e) {
  pugi::xml_node node = e.any_element();
  const auto attributes = node.attributes();
  const auto count = std::distance(attributes.begin(), attributes.end());
  if (count == 0) return false;
  return node.remove_attribute(
      *std::next(attributes.begin(), std::ptrdiff_t(e.random.below(std::size_t(count)))));
}

bool duplicate_attribute(SceneEdit& e) {
  pugi::xml_node node = e.any_element();
  const pugi::xml_attribute first = node.first_attribute();
  return first && node.append_copy(first);
}

bool other_type(SceneEdit& e) {
  pugi::xml_node node = e.any_object();
  if (!node) return false;
  static const char* const kElsewhere[] = {"volpath",   "ldsampler", "merge",   "ies", "heightfield",
                                           "sunsky",    "pplastic",  "twoside", "",    "Diffuse",
                                           "microfacet"};
  const std::string family = e.random.is_gentle() || e.random.chance(0.8) ? family_of(node) : "";
  const PluginInfo& plugin = any_plugin(family, e.random);
  node.attribute("type") =
      !e.random.is_gentle() && e.random.chance(0.1) ? e.random.pick(kElsewhere) : plugin.name.c_str();
  if (!e.random.is_gentle() && e.random.chance(0.3)) return true;
  // Most parameters of the old one would be errors.
  for (pugi::xml_node child = node.first_child(); child;) {
    const pugi::xml_node next = child.next_sibling();
    const char* name = child.attribute("name").value();
    if (*name && !plugin.documents(name)) node.remove_child(child);
    child = next;
  }
  return true;
}

bool other_tag(SceneEdit& e) {
  const std::vector<std::string>& tags = all_tags();
  return e.any_element().set_name(e.random.chance(0.05) ? "nonsense" : e.random.pick(tags).c_str());
}

/// The type of a parameter's element: <float> to <integer>, <rgb>, ...
bool other_property_tag(SceneEdit& e) {
  static const char* const kTags[] = {"boolean", "integer", "float",    "string",   "point",
                                      "vector",  "rgb",     "spectrum", "transform"};
  for (int tries = 0; tries < 20; ++tries) {
    pugi::xml_node node = e.any_element();
    if (node.attribute("value")) return node.set_name(e.random.pick(kTags));
  }
  return false;
}

const ParameterDoc* any_parameter(const PluginInfo& plugin, Random& random) {
  return plugin.doc.parameters.empty() ? nullptr : &random.pick(plugin.doc.parameters);
}

/// The parameter's name becomes another one of the same plug-in or of any.
bool rename_parameter(SceneEdit& e) {
  pugi::xml_node object = e.any_object();
  const PluginInfo* plugin = plugin_of(object);
  if (!plugin || e.random.chance(0.2)) plugin = &any_plugin("", e.random);
  const ParameterDoc* p = any_parameter(*plugin, e.random);
  pugi::xml_node child = object.first_child();
  for (std::size_t skip = e.random.below(6); skip > 0 && child.next_sibling(); --skip)
    child = child.next_sibling();
  if (!p || !child) return false;
  child.remove_attribute("name");
  child.append_attribute("name") = p->name.c_str();
  return true;
}

/// A documented parameter gets a value, instead of the one it has or beside it.
bool set_parameter(SceneEdit& e) {
  pugi::xml_node object = e.any_object();
  const PluginInfo* plugin = plugin_of(object);
  if (!plugin) return false;
  const ParameterDoc* p = any_parameter(*plugin, e.random);
  if (!p) return false;
  if (e.random.is_gentle() || e.random.chance(0.9))
    object.remove_child(object.find_child_by_attribute("name", p->name.c_str()));
  e.insert(object, parameter_xml(*p, e.corpus, e.random));
  return true;
}

bool foreign_parameter(SceneEdit& e) {
  pugi::xml_node object = e.any_object();
  const ParameterDoc* p = any_parameter(any_plugin("", e.random), e.random);
  if (!object || !p) return false;
  e.insert(object, parameter_xml(*p, e.corpus, e.random));
  return true;
}

bool other_file(SceneEdit& e) {
  std::vector<pugi::xml_attribute> names;
  for (pugi::xml_node node : e.elements())
    for (pugi::xml_attribute a : node.attributes())
      if (e.files.contains(a.value())) names.push_back(a);
  if (names.empty()) return false;
  pugi::xml_attribute name = e.random.pick(names);
  const auto& [file, bytes] = e.random.is_gentle() || e.random.chance(0.7)
                                  ? e.corpus.data_file_like(name.value(), e.random)
                                  : e.random.pick(e.corpus.data_files());
  e.files[file] = bytes;
  return name.set_value(file.c_str());
}

bool random_transform(SceneEdit& e) {
  std::vector<pugi::xml_node> transforms;
  for (pugi::xml_node node : e.elements())
    if (std::string_view(node.name()) == "transform") transforms.push_back(node);
  if (transforms.empty()) return false;
  pugi::xml_node chosen = e.random.pick(transforms);
  if (e.random.chance(0.5)) {
    e.insert(chosen.parent(), transform_xml(chosen.attribute("name").value(), e.random));
    return chosen.parent().remove_child(chosen);
  }
  pugi::xml_document steps;
  steps.load_string(transform_xml("", e.random).c_str());
  return chosen.append_copy(steps.document_element().first_child());
}

/// The whole scene in another unit of length, also where single precision has no normal numbers left.
bool scale_of_all(SceneEdit& e) {
  static constexpr std::pair<const char*, const char*> kScales[] = {
      {"1e-46", "1e46"}, {"1e-44", "1e44"}, {"1e-40", "1e40"}, {"1e-38", "1e38"},
      {"1e-30", "1e30"}, {"1e-19", "1e19"}, {"1e-10", "1e10"}, {"1e-4", "1e4"},
      {"1e5", "1e-5"},   {"1e10", "1e-10"}, {"1e17", "1e-17"}, {"1e30", "1e-30"}};
  const auto& [scale, inverse] = e.random.pick(kScales);
  for (pugi::xml_node object : e.document.document_element().children()) {
    const PluginInfo* plugin = plugin_of(object);
    if (!plugin || !plugin->documents("to_world")) continue;
    pugi::xml_node transform = object.find_child_by_attribute("transform", "name", "to_world");
    if (!transform) {
      transform = object.append_child("transform");
      transform.append_attribute("name") = "to_world";
    }
    // A camera moves, but must not be scaled.
    if (plugin->family != "shape") transform.prepend_child("scale").append_attribute("value") = inverse;
    transform.append_child("scale").append_attribute("value") = scale;
  }
  return true;
}

bool wavelength_range(SceneEdit& e) {
  static const char* const kEnds[] = {"360",   "830",    "1nm", "10nm", "500", "500.0001", "2um", "100um",
                                      "10GHz", "400THz", "1e6", "1e-3", "0",   "1e30",     "1m"};
  for (pugi::xml_node node : e.elements()) {
    // Tables of spheres take minutes at the wavelengths of X-rays, within the sizes that are allowed.
    const std::string_view type = node.attribute("type").value();
    if (type == "suspension" || type == "mie" || std::string_view(node.name()) == "ingredient") return false;
  }
  for (pugi::xml_node node : e.elements()) {
    if (std::string_view(node.name()) != "film") continue;
    for (const char* name : {"wavelength_min", "wavelength_max", "response"}) {
      if (e.random.chance(0.3)) continue;
      node.remove_child(node.find_child_by_attribute("name", name));
      pugi::xml_node p = node.append_child("string");
      p.append_attribute("name") = name;
      p.append_attribute("value") = std::string_view(name) == "response" ? "uniform" : e.random.pick(kEnds);
    }
    return true;
  }
  return false;
}

bool other_version(SceneEdit& e) {
  static const char* const kVersions[] = {"0.4.0", "0.6.0",   "2.0.0",           "2.2.1",  "3.0.0",
                                          "3.9.9", "0.0.0",   "99.0.0",          "-1.0.0", "3",
                                          "3.0",   "3.0.0.0", "99999999999.0.0", ""};
  pugi::xml_node root = e.document.document_element();
  root.remove_attribute("version");
  if (e.random.chance(0.95)) root.append_attribute("version") = e.random.pick(kVersions);
  return true;
}

/// A scene of Mitsuba 0.6: an old version, and names in camel case.
bool old_scene(SceneEdit& e) {
  e.document.document_element().attribute("version") = "0.6.0";
  for (pugi::xml_node node : e.elements()) {
    std::string camel;
    const std::string_view snake = node.attribute("name").value();
    for (std::size_t i = 0; i < snake.size(); ++i)
      if (snake[i] == '_' && i + 1 < snake.size())
        camel += char(std::toupper(static_cast<unsigned char>(snake[++i])));
      else
        camel += snake[i];
    if (e.random.chance(0.8) && !camel.empty()) node.attribute("name") = camel.c_str();
    if (std::string_view(node.name()) == "lookat" && e.random.chance(0.7)) node.set_name("lookAt");
    if (std::string_view(node.name()) == "rgb" && e.random.chance(0.3)) node.set_name("srgb");
  }
  static const char* const kOld[] = {"<blackbody name=\"radiance\" temperature=\"5000K\" scale=\"2\"/>",
                                     "<float name=\"uscale\" value=\"3\"/>",
                                     "<float name=\"voffset\" value=\"x\"/>",
                                     "<boolean name=\"strictNormals\" value=\"true\"/>",
                                     "<string name=\"filterType\" value=\"ewa\"/>",
                                     "<string name=\"label[10, 10]\" value=\"$\"/>",
                                     "<float name=\"gamma\" value=\"1\"/>",
                                     "<srgb name=\"reflectance\" value=\"#808080\"/>",
                                     "<string name=\"extEta\" value=\"air\"/>"};
  for (std::size_t i = e.random.few(4); i > 0; --i)
    if (pugi::xml_node object = e.any_object()) e.insert(object, e.random.pick(kOld));
  return true;
}

}  // namespace

const std::vector<SceneMutation>& value_mutations() {
  static const std::vector<SceneMutation> all = {{"change a value", 30, change_value, true},
                                                 {"odd value", 4, odd_value},
                                                 {"rename an attribute", 1, rename_attribute},
                                                 {"remove an attribute", 1, remove_attribute},
                                                 {"duplicate an attribute", 1, duplicate_attribute},
                                                 {"other type", 6, other_type, true},
                                                 {"other tag", 1, other_tag},
                                                 {"other tag of a parameter", 2, other_property_tag},
                                                 {"rename a parameter", 2, rename_parameter},
                                                 {"set a parameter", 20, set_parameter, true},
                                                 {"foreign parameter", 2, foreign_parameter},
                                                 {"other file", 5, other_file, true},
                                                 {"transform", 8, random_transform, true},
                                                 {"scale of all", 3, scale_of_all, true},
                                                 {"wavelength range", 3, wavelength_range, true},
                                                 {"version", 1, other_version},
                                                 {"scene of version 0.6", 1, old_scene}};
  return all;
}

}  // namespace aureole::fuzz

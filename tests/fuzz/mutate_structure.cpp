// SPDX-License-Identifier: Apache-2.0
// Changes to the tree: elements, references, includes, parameters, and sizes that grow exponentially.
#include <fmt/format.h>

#include "fuzz/mutate_scene.h"
#include "fuzz/scene_values.h"

namespace aureole::fuzz {

namespace {

void put(Files& files, const std::string& name, const std::string& text) {
  files[name] = std::make_shared<std::string>(text);
}

bool remove_element(SceneEdit& e) {
  pugi::xml_node node = e.any_element();
  return node && node.parent().remove_child(node);
}

bool duplicate_element(SceneEdit& e) {
  pugi::xml_node node = e.any_element();
  if (!node) return false;
  const std::size_t times = e.random.chance(0.05) ? 100 : 1;
  for (std::size_t i = 0; i < times; ++i) node.parent().insert_copy_after(node, node);
  return true;
}

/// The element to a random place, which may be wrong for it.
bool move_element(SceneEdit& e) {
  pugi::xml_node node = e.any_element(), to = e.any_element();
  if (!node || !to) return false;
  if (e.random.chance(0.3)) return node.parent().insert_move_before(node, node.parent().first_child());
  return to.append_move(node);
}

bool swap_elements(SceneEdit& e) {
  pugi::xml_node a = e.any_element(), b = e.any_element();
  if (!a || !b || a == b) return false;
  const pugi::xml_node copy = a.parent().insert_copy_after(b, a);
  return copy && b.parent().insert_copy_after(a, b);
}

bool wrap_element(SceneEdit& e) {
  pugi::xml_node node = e.any_element();
  if (!node) return false;
  pugi::xml_node around = node.parent().insert_copy_after(e.any_element(), node);
  if (!around) return false;
  return bool(around.append_move(node));
}

bool unwrap_element(SceneEdit& e) {
  pugi::xml_node node = e.any_element();
  if (!node) return false;
  while (pugi::xml_node child = node.first_child()) node.parent().insert_move_before(child, node);
  return node.parent().remove_child(node);
}

/// An element of another scene of the corpus.
bool splice(SceneEdit& e) {
  const BaseScene& other = e.corpus.pick_scene(e.random);
  pugi::xml_document document;
  if (!document.load_string(other.files.at(kMainFile)->c_str())) return false;
  SceneEdit source{e.corpus, e.random, document, e.files};
  const pugi::xml_node node = e.random.is_gentle() ? source.any_object() : source.any_element();
  pugi::xml_node parent =
      e.random.is_gentle() || e.random.chance(0.6) ? e.document.document_element() : e.any_element();
  if (!node || !parent) return false;
  for (const auto& [name, bytes] : other.files)
    if (name != kMainFile) e.files.emplace(name, bytes);
  return bool(parent.append_copy(node));
}

bool insert_example(SceneEdit& e) {
  pugi::xml_node parent =
      e.random.is_gentle() || e.random.chance(0.4) ? e.document.document_element() : e.any_element();
  if (!parent) return false;
  e.insert(parent, e.corpus.any_example(e.random));
  return true;
}

/// A reference to an object around it, or to itself through others.
bool cyclic_reference(SceneEdit& e) {
  pugi::xml_node object = e.any_object();
  if (!object) return false;
  std::vector<pugi::xml_node> inside{object};
  for (pugi::xml_node child : object.children())
    if (child.attribute("type")) inside.push_back(child);
  if (!object.attribute("id")) object.append_attribute("id") = "loop";
  pugi::xml_node ref = e.random.pick(inside).append_child("ref");
  ref.append_attribute("id") = object.attribute("id").value();
  if (e.random.chance(0.3)) ref.append_attribute("name") = "nested";
  return true;
}

bool reference(SceneEdit& e) {
  pugi::xml_node target = e.any_object(), parent = e.any_element();
  if (!target || !parent) return false;
  if (!target.attribute("id")) target.append_attribute("id") = "shared";
  pugi::xml_node node = parent.append_child(e.random.chance(0.85) ? "ref" : "alias");
  node.append_attribute("id") = e.random.chance(0.9) ? target.attribute("id").value() : "nobody";
  if (e.random.chance(0.3)) node.append_attribute("as") = e.random.chance(0.5) ? "other" : "shared";
  if (e.random.chance(0.3)) node.append_attribute("name") = "reflectance";
  return true;
}

/// Objects that refer to one another in a long row.
bool reference_chain(SceneEdit& e) {
  const std::size_t length = std::size_t(2) << e.random.below(13);
  std::string xml;
  for (std::size_t i = 0; i < length; ++i)
    xml += fmt::format("<bsdf type=\"twosided\" id=\"c{}\"><ref id=\"c{}\"/></bsdf>", i, i + 1);
  xml += fmt::format("<bsdf type=\"diffuse\" id=\"c{}\"/>", length);
  e.insert(e.document.document_element(), xml);
  return true;
}

/// An object that uses another one twice, which uses another one twice, ...
bool reference_tree(SceneEdit& e) {
  const std::size_t levels = 2 + e.random.below(40);
  std::string xml;
  for (std::size_t i = 0; i < levels; ++i)
    xml += fmt::format(
        "<texture type=\"checkerboard\" id=\"t{0}\"><ref id=\"t{1}\" name=\"color0\"/><ref id=\"t{1}\" "
        "name=\"color1\"/></texture><bsdf type=\"{2}\" id=\"b{0}\"><ref id=\"b{1}\"/><ref id=\"b{1}\"/>"
        "<float name=\"weight\" value=\"0.5\"/></bsdf>",
        i, i + 1, any_plugin("bsdf", e.random).name);
  xml +=
      fmt::format("<texture type=\"checkerboard\" id=\"t{0}\"/><bsdf type=\"diffuse\" id=\"b{0}\"/>", levels);
  xml += R"(<shape type="sphere"><bsdf type="diffuse"><ref id="t0" name="reflectance"/></bsdf></shape>)";
  e.insert(e.document.document_element(), xml);
  return true;
}

bool nest_deeply(SceneEdit& e) {
  pugi::xml_node node = e.any_element();
  if (!node) return false;
  const std::size_t depth = std::size_t(2) << e.random.below(16);
  const pugi::xml_node pattern = e.random.chance(0.5) ? node : e.any_element();
  const std::string tag = pattern.name(), type = pattern.attribute("type").value();
  for (std::size_t i = 0; i < depth; ++i) {
    node = node.append_child(tag.c_str());
    if (!type.empty()) node.append_attribute("type") = type.c_str();
  }
  return true;
}

bool include(SceneEdit& e) {
  const BaseScene& other = e.corpus.pick_scene(e.random);
  pugi::xml_node node = e.document.document_element().append_child("include");
  pugi::xml_attribute name = node.append_attribute("filename");
  switch (e.random.below(6)) {
    case 0:
      name = kMainFile;
      break;
    case 1:  // two that include each other
      put(e.files, "a.xml", R"(<scene version="3.0.0"><include filename="b.xml"/></scene>)");
      put(e.files, "b.xml", R"(<scene version="3.0.0"><include filename="a.xml"/></scene>)");
      name = "a.xml";
      break;
    case 2:  // twice as many at every level
      for (std::size_t i = 0, levels = 2 + e.random.below(30); i <= levels; ++i)
        put(e.files, fmt::format("level{}.xml", i),
            i == levels ? std::string(R"(<scene version="3.0.0"><bsdf type="diffuse"/></scene>)")
                        : fmt::format(R"(<scene version="3.0.0"><include filename="level{0}.xml"/>)"
                                      R"(<include filename="level{0}.xml"/></scene>)",
                                      i + 1));
      name = "level0.xml";
      break;
    case 3:  // a single object
      put(e.files, "object.xml", e.corpus.any_example(e.random));
      name = "object.xml";
      break;
    case 4:
      name = e.random.pick(e.corpus.data_files()).first.c_str();
      e.files.emplace(name.value(), e.random.pick(e.corpus.data_files()).second);
      break;
    default:
      e.files.emplace("other.xml", other.files.at(kMainFile));
      for (const auto& [file, bytes] : other.files)
        if (file != kMainFile) e.files.emplace(file, bytes);
      name = "other.xml";
  }
  return true;
}

bool parameters(SceneEdit& e) {
  pugi::xml_node root = e.document.document_element();
  const auto define = [&](const std::string& name, const std::string& value) {
    pugi::xml_node node = root.prepend_child("default");
    node.append_attribute("name") = name.c_str();
    node.append_attribute("value") = value.c_str();
  };
  if (e.random.chance(0.2)) {  // doubled at every step
    const std::size_t steps = 2 + e.random.below(60);
    for (std::size_t i = steps; i > 0; --i) define(fmt::format("p{}", i), fmt::format("$p{0}$p{0}", i - 1));
    define("p0", e.random.chance(0.5) ? "1" : "12345678");
    return e.any_attribute().set_value(fmt::format("$p{}", steps).c_str());
  }
  const std::string name = e.random.chance(0.8) ? "a" : odd_text(e.random);
  pugi::xml_attribute a = e.any_attribute();
  define(name, e.random.chance(0.5) ? a.value() : e.random.chance(0.2) ? "$a" : any_number(e.random));
  return a.set_value(("$" + name).c_str());
}

bool text_between(SceneEdit& e) {
  pugi::xml_node node = e.any_element();
  static constexpr pugi::xml_node_type kTypes[] = {pugi::node_pcdata, pugi::node_cdata, pugi::node_comment,
                                                   pugi::node_pi};
  pugi::xml_node added = node.append_child(e.random.pick(kTypes));
  if (added.type() == pugi::node_pi) added.set_name("pi");
  return added && added.set_value(odd_text(e.random).c_str());
}

}  // namespace

const std::vector<SceneMutation>& structure_mutations() {
  static const std::vector<SceneMutation> all = {{"remove an element", 6, remove_element, true},
                                                 {"duplicate an element", 4, duplicate_element, true},
                                                 {"move an element", 4, move_element},
                                                 {"swap elements", 2, swap_elements},
                                                 {"wrap an element", 1, wrap_element},
                                                 {"unwrap an element", 1, unwrap_element},
                                                 {"element of another scene", 8, splice, true},
                                                 {"insert an example", 8, insert_example, true},
                                                 {"cyclic reference", 2, cyclic_reference},
                                                 {"reference", 3, reference, true},
                                                 {"chain of references", 1, reference_chain},
                                                 {"tree of references", 1, reference_tree},
                                                 {"nest deeply", 1, nest_deeply},
                                                 {"include", 3, include},
                                                 {"parameters", 3, parameters},
                                                 {"text between elements", 1, text_between}};
  return all;
}

}  // namespace aureole::fuzz

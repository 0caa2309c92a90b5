// SPDX-License-Identifier: Apache-2.0
#include "fuzz/fuzz_case.h"

#include <fmt/format.h>

#include <fstream>
#include <sstream>

#include "fuzz/mutate_bytes.h"
#include "fuzz/mutate_scene.h"
#include "fuzz/scene_values.h"

namespace aureole::fuzz {

std::vector<pugi::xml_node> SceneEdit::elements() const {
  std::vector<pugi::xml_node> all;
  const pugi::xml_node root = document.document_element();
  // Preorder without recursion: mutations nest elements deeply.
  for (pugi::xml_node node = root.first_child(); node;) {
    if (node.type() == pugi::node_element) all.push_back(node);
    if (node.first_child()) {
      node = node.first_child();
      continue;
    }
    while (node && node != root && !node.next_sibling()) node = node.parent();
    node = node == root ? pugi::xml_node() : node.next_sibling();
  }
  return all;
}

pugi::xml_node SceneEdit::any_element() const {
  auto all = elements();
  return all.empty() ? pugi::xml_node() : random.pick(all);
}

pugi::xml_node SceneEdit::any_object() const {
  std::vector<pugi::xml_node> objects;
  for (pugi::xml_node node : elements())
    if (node.attribute("type")) objects.push_back(node);
  return objects.empty() ? pugi::xml_node() : random.pick(objects);
}

pugi::xml_attribute SceneEdit::any_attribute() const {
  std::vector<pugi::xml_attribute> all;
  for (pugi::xml_node node : elements())
    for (pugi::xml_attribute a : node.attributes()) all.push_back(a);
  return all.empty() ? pugi::xml_attribute() : random.pick(all);
}

void SceneEdit::insert(pugi::xml_node parent, const std::string& xml) const {
  pugi::xml_document added;
  if (!added.load_string(("<all>" + xml + "</all>").c_str())) return;
  std::vector<pugi::xml_node> siblings(parent.begin(), parent.end());
  const pugi::xml_node before =
      siblings.empty() || random.chance(0.5) ? pugi::xml_node() : random.pick(siblings);
  for (pugi::xml_node node : added.document_element())
    before ? parent.insert_copy_before(node, before) : parent.append_copy(node);
  // Examples name data files.
  for (const pugi::xpath_node found : added.select_nodes("//@value | //@filename"))
    for (const auto& [name, bytes] : corpus.data_files())
      if (name == found.attribute().value()) files.emplace(name, bytes);
}

namespace {

const SceneMutation& choose(const std::vector<SceneMutation>& list, Random& random) {
  const auto weight = [&](const SceneMutation& m) { return m.gentle || !random.is_gentle() ? m.weight : 0; };
  int total = 0;
  for (const SceneMutation& m : list) total += weight(m);
  int at = int(random.below(std::size_t(total)));
  for (const SceneMutation& m : list)
    if ((at -= weight(m)) < 0) return m;
  return list.back();
}

/// Tables of spheres take minutes at the wavelengths of X-rays, within the sizes that are allowed: scenes of both have
/// the sensor's own range.
void avoid_small_wavelengths(pugi::xml_document& document) {
  if (!document.select_node(
          "//ingredient | //*[@type='suspension'] | //*[@type='mie'] | //*[@type='correlated_spheres']"))
    return;
  for (const pugi::xpath_node& found : document.select_nodes("//*[@name='wavelength_min']"))
    found.node().parent().remove_child(found.node());
}

/// Simulations of the default size take 3 s for each area fraction, of which a textured one needs a dozen: here they are small, or so large
/// that they are refused.
void avoid_large_simulations(pugi::xml_document& document) {
  constexpr double kMaxWork = 1e5, kRefused = 1e8;  // discs times snapshots
  for (const pugi::xpath_node& found : document.select_nodes("//correlation[@type='simulated']")) {
    pugi::xml_node node = found.node();
    const auto number = [&](const char* name, double fallback) {
      const pugi::xml_node given = node.find_child_by_attribute("name", name);
      return given ? given.attribute("value").as_double(fallback) : fallback;
    };
    const double work = number("discs", 1500) * number("snapshots", 1200);
    if (!(work > kMaxWork && work <= kRefused)) continue;
    for (const char* name : {"discs", "snapshots"}) {
      while (pugi::xml_node given = node.find_child_by_attribute("name", name)) node.remove_child(given);
      pugi::xml_node small = node.append_child("integer");
      small.append_attribute("name") = name;
      small.append_attribute("value") = 64;
    }
  }
}

/// Changes the tree of the main file or, rarely, of one that it includes.
void mutate_tree(const Corpus& corpus, Random& random, Case& c) {
  std::string file = kMainFile;
  for (const auto& [name, bytes] : c.files)
    if (name.ends_with(".xml") && random.chance(0.3)) file = name;
  pugi::xml_document document;
  if (!document.load_string(c.files[file]->c_str(), pugi::parse_full)) return;
  SceneEdit edit{corpus, random, document, c.files};
  for (std::size_t i = random.few(6); i > 0; --i) {
    const SceneMutation& m = choose(random.chance(0.8) ? value_mutations() : structure_mutations(), random);
    if (edit.elements().empty() || !m.apply(edit)) continue;
    c.mutations.push_back(file + ": " + m.name);
  }
  avoid_small_wavelengths(document);
  avoid_large_simulations(document);
  std::ostringstream out;
  document.save(out, "", pugi::format_default | pugi::format_no_declaration);
  c.files[file] = std::make_shared<std::string>(out.str());
}

void mutate_file(Random& random, Case& c) {
  std::vector<std::string> names;
  for (const auto& [name, bytes] : c.files)
    if (!name.ends_with(".xml")) names.push_back(name);
  if (names.empty()) return;
  const std::string& name = random.pick(names);
  c.files[name] = std::make_shared<std::string>(mutate_data(*c.files[name], random));
  c.mutations.push_back(name + ": damaged");
}

void choose_options(Random& random, Case& c) {
  if (random.chance(0.1)) c.options.sampler = any_plugin("sampler", random).name;
  if (random.chance(0.1)) c.options.integrator = any_plugin("integrator", random).name;
  if (random.chance(0.1)) c.options.sample_count = 3;
  const bool has_spp = c.files[kMainFile]->find("\"spp\"") != std::string::npos;
  if (has_spp && random.chance(0.1)) c.options.defines.emplace_back("spp", std::to_string(random.below(4)));
}

}  // namespace

Case make_case(const Corpus& corpus, std::uint64_t seed, std::uint64_t index) {
  Random random(seed, index);
  Case c;
  const BaseScene& base = corpus.pick_scene(random);
  c.base = base.name;
  c.files = base.files;
  const bool has_data = c.files.size() > 1;
  const bool damages = random.chance(has_data ? 0.4 : 0.1);
  const bool edits = !damages || random.chance(0.3);
  if (edits) mutate_tree(corpus, random, c);
  if (damages) mutate_file(random, c);
  if (!random.is_gentle() && random.chance(0.15)) {
    c.files[kMainFile] = std::make_shared<std::string>(mutate_text(*c.files[kMainFile], random));
    c.mutations.push_back(fmt::format("{}: changed as text", kMainFile));
  }
  choose_options(random, c);
  return c;
}

void write_case(const Case& c, const std::filesystem::path& folder) {
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  for (const auto& [name, bytes] : c.files)
    std::ofstream(folder / name, std::ios::binary).write(bytes->data(), std::streamsize(bytes->size()));
}

}  // namespace aureole::fuzz

// SPDX-License-Identifier: Apache-2.0
#include "fuzz/corpus.h"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <pugixml.hpp>
#include <sstream>

#include "aureole/plugin/registry.h"
#include "fuzz/seed_files.h"
#include "fuzz/wrap.h"

namespace aureole::fuzz {

namespace fs = std::filesystem;

namespace {

bool is_data_file(const fs::path& file) {
  for (const char* other : {".xml", ".md", ".py", ".cpp"})
    if (file.extension() == other) return false;
  return true;
}

/// Regular files below `folder`, in an order that does not depend on the file system.
std::vector<fs::path> files_below(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

void at_most(pugi::xml_node parameter, int most) {
  pugi::xml_attribute value = parameter.attribute("value");
  if (!value) return;
  const bool small = std::isdigit(static_cast<unsigned char>(value.value()[0])) && value.as_int() <= most;
  if (!small) value.set_value(most);  // also what is a $name or negative
}

void append_size(pugi::xml_node film, const char* name, int pixels) {
  if (film.find_child_by_attribute("name", name)) return;
  pugi::xml_node node = film.append_child("integer");
  node.append_attribute("name") = name;
  node.append_attribute("value") = pixels;
}

/// Small films, few samples, short paths. Mutations come later and may make them large again.
void shrink(pugi::xml_node node) {
  const std::string_view tag = node.name(), name = node.attribute("name").value();
  if (tag == "sensor" && !node.child("film") && !node.child("ref"))
    node.append_child("film").append_attribute("type") = "hdrfilm";
  if (tag == "film") append_size(node, "width", 6), append_size(node, "height", 5);
  if (std::string_view(node.parent().name()) == "film") {
    if (name == "width" || name == "height") at_most(node, name == "width" ? 6 : 5);
    if (name.starts_with("crop_")) at_most(node, name.starts_with("crop_offset") ? 1 : 3);
  }
  if (name == "sample_count" || name == "sampleCount") at_most(node, 2);
  if (name == "max_depth" || name == "maxDepth") at_most(node, 6);
  for (pugi::xml_node child : node.children()) shrink(child);
}

}  // namespace

std::string read_whole(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

bool is_image_name(const std::string& name) {
  for (const char* ending : {".png", ".jpg", ".exr", ".hdr", ".tga", ".bmp", ".tif"})
    if (name.ends_with(ending)) return true;
  return false;
}

Corpus::Corpus(const fs::path& source) {
  for (const auto& [name, bytes] : seed_files())
    data_.emplace_back(name, std::make_shared<std::string>(bytes));
  const fs::path folders[] = {source / "tests/references/scenes", source / "scenes"};
  for (const fs::path& folder : folders) add_data_files(folder);
  const fs::path heads = source / "tests/volume/data/heads";
  add_data_files(heads);
  // Measured materials, among them files in XML that are no scenes.
  for (const fs::path& file : files_below(source / "tests/bsdf/data/measured"))
    if (file.extension() != ".py" && file.extension() != ".txt" && fs::file_size(file) <= kLargestFile)
      data_.emplace_back(file.filename().string(), std::make_shared<std::string>(read_whole(file)));

  group_begin_.push_back(0);
  for (const fs::path& folder : folders)
    for (const fs::path& file : files_below(folder))
      if (file.extension() == ".xml") add_scene(file, folder);
  group_begin_.push_back(scenes_.size());
  add_examples();
  group_begin_.push_back(scenes_.size());
  add_image_scenes();
  group_begin_.push_back(scenes_.size());
  add_volume_scenes(heads);
  group_begin_.push_back(scenes_.size());
  add_splat_scenes(source / "tests/medium/data/splats");
  add_splat_scenes(source / "tests/medium/data/radiance");
  group_begin_.push_back(scenes_.size());
  find_tables();
}

void Corpus::find_tables() {
  for (BaseScene& scene : scenes_)
    for (const auto& [name, bytes] : scene.files) {
      if (!name.ends_with(".xml")) continue;
      for (const char* word : {"<aperture", "<correlation", "<ingredient", "\"correlated_", "\"mie\"",
                               "\"suspension\"", "\"paint\"", "\"layered\"", "\"energy_preserving\"",
                               "\"diffraction\"", "\"freespacediffraction\""})
        scene.has_tables |= bytes->find(word) != std::string::npos;
    }
}

void Corpus::add_data_files(const fs::path& folder) {
  for (const fs::path& file : files_below(folder)) {
    if (!is_data_file(file) || fs::file_size(file) > kLargestFile) continue;
    data_.emplace_back(file.filename().string(), std::make_shared<std::string>(read_whole(file)));
  }
}

std::string Corpus::prepare(const std::string& text, const fs::path& folder, Files& files) const {
  pugi::xml_document document;
  if (!document.load_string(text.c_str())) return text;
  shrink(document);
  struct Relocate : pugi::xml_tree_walker {
    const Corpus& corpus;
    const fs::path& folder;
    Files& files;
    Relocate(const Corpus& c, const fs::path& from, Files& to) : corpus(c), folder(from), files(to) {}

    bool for_each(pugi::xml_node& node) override {
      for (pugi::xml_attribute a : node.attributes()) relocate(a);
      return true;
    }
    void relocate(pugi::xml_attribute a) {
      std::error_code ignored;
      const fs::path file = folder / a.value();
      if (std::string_view(a.value()).find('.') == std::string_view::npos) return;
      if (!fs::is_regular_file(file, ignored)) return;
      const std::string name = file.filename().string();
      a.set_value(name.c_str());
      if (files.contains(name)) return;
      files[name] = nullptr;  // includes may be mutual
      Bytes content;
      if (file.extension() == ".xml")
        content = std::make_shared<std::string>(corpus.prepare(read_whole(file), file.parent_path(), files));
      else if (fs::file_size(file) <= kLargestFile)
        content = std::make_shared<std::string>(read_whole(file));
      else
        for (const auto& [other, bytes] : corpus.data_)
          if (fs::path(other).extension() == file.extension()) content = bytes;
      if (content)
        files[name] = content;
      else
        files.erase(name);
    }
  } relocate(*this, folder, files);
  document.traverse(relocate);
  std::ostringstream out;
  document.save(out, " ");
  return out.str();
}

void Corpus::add_scene(const fs::path& file, const fs::path& root) {
  BaseScene scene{fs::relative(file, root).string(), {}};
  scene.files[kMainFile] =
      std::make_shared<std::string>(prepare(read_whole(file), file.parent_path(), scene.files));
  scenes_.push_back(std::move(scene));
}

void Corpus::add_examples() {
  std::vector<const PluginInfo*> plugins;
  for (const PluginInfo& p : Registry::instance().all()) plugins.push_back(&p);
  // The order of registration is the linker's.
  std::sort(plugins.begin(), plugins.end(), [](const PluginInfo* a, const PluginInfo* b) {
    return std::pair(a->family, a->name) < std::pair(b->family, b->name);
  });
  for (const PluginInfo* p : plugins)
    for (std::size_t i = 0; i < p->doc.examples.size(); ++i) {
      Files used;
      const std::string example = with_data_files(p->doc.examples[i], data_, used);
      examples_[p->family].push_back(example);
      for (const std::string& text : wrap_example(*p, example)) {
        BaseScene scene{"example " + std::to_string(i) + " of " + p->family + " " + p->name, used};
        scene.files[kMainFile] = std::make_shared<std::string>(prepare(text, "", scene.files));
        scenes_.push_back(std::move(scene));
      }
    }
}

void Corpus::add_image_scenes() {
  for (const auto& [name, bytes] : data_) {
    if (!is_image_name(name)) continue;
    BaseScene scene{"image " + name, {}};
    scene.files[name] = bytes;
    scene.files[kMainFile] = std::make_shared<std::string>(wrap_image(name));
    scenes_.push_back(std::move(scene));
  }
}

void Corpus::add_volume_scenes(const fs::path& folder) {
  for (const fs::path& file : files_below(folder)) {
    const std::string name = file.filename().string();
    const auto begins = [&](const char* start) { return name.starts_with(start); };
    // Numbers of other files, and volumes below 0, which are no media.
    if (name.ends_with("raw") || name.ends_with(".img") || begins("int") || begins("float")) continue;
    BaseScene scene{"volume " + name, {}};
    scene.files[name] = std::make_shared<std::string>(read_whole(file));
    for (const fs::path& other : files_below(folder)) {
      const std::string also = other.filename().string();
      const bool is_slice = also.starts_with("slice") || also.starts_with("series") || also == "skip.raw";
      const bool is_beside =
          also != name && other.stem() == file.stem() && (also.ends_with("raw") || also.ends_with(".img"));
      if (is_beside || (is_slice && scene.files.at(name)->find(also.substr(0, 5)) != std::string::npos) ||
          (is_slice && begins("series") && also.starts_with("series")))
        scene.files[also] = std::make_shared<std::string>(read_whole(other));
    }
    scene.files[kMainFile] = std::make_shared<std::string>(wrap_volume(name));
    scenes_.push_back(std::move(scene));
  }
}

void Corpus::add_splat_scenes(const fs::path& folder) {
  for (const fs::path& file : files_below(folder)) {
    const std::string name = file.filename().string();
    const Bytes bytes = std::make_shared<std::string>(read_whole(file));
    data_.emplace_back(name, bytes);
    for (const std::string& text : wrap_splats(name)) {
      BaseScene scene{"splats " + name, {}};
      scene.files[name] = bytes;
      scene.files[kMainFile] = std::make_shared<std::string>(text);
      scenes_.push_back(std::move(scene));
    }
  }
}

const BaseScene& Corpus::pick_scene(Random& random) const {
  const std::size_t group = random.below(group_begin_.size() - 1);
  const std::size_t first = group_begin_[group], count = group_begin_[group + 1] - first;
  if (count == 0) return random.pick(scenes_);
  std::size_t chosen;
  do chosen = first + random.below(count);
  while (scenes_[chosen].has_tables && !random.chance(0.1));
  return scenes_[chosen];
}

const std::pair<std::string, Bytes>& Corpus::data_file_like(const std::string& name, Random& random) const {
  std::vector<const std::pair<std::string, Bytes>*> alike;
  for (const auto& file : data_)
    if (fs::path(file.first).extension() == fs::path(name).extension() ||
        (is_image_name(file.first) && is_image_name(name)))
      alike.push_back(&file);
  return alike.empty() ? random.pick(data_) : *random.pick(alike);
}

const std::string& Corpus::any_example(Random& random) const {
  const auto family = std::next(examples_.begin(), std::ptrdiff_t(random.below(examples_.size())));
  return random.pick(family->second);
}

}  // namespace aureole::fuzz

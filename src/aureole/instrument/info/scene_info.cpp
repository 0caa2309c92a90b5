// SPDX-License-Identifier: Apache-2.0
// Description of a scene, for `aureole info`.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <map>
#include <set>
#include <string>
#include <vector>

#include "aureole/instrument/info/file_info.h"
#include "aureole/instrument/info/nested_objects.h"
#include "aureole/instrument/info/printed_text.h"
#include "aureole/loading/load.h"
#include "aureole/plugin/table_holder.h"
#include "aureole/render/state.h"

namespace aureole {

namespace {

/// Prints the BSDFs of the scene's surfaces that made tables, in the scene's order, and the total memory;
/// shared tables are counted once.
void print_tables(std::string& out, const Scene& scene) {
  std::set<const void*> seen, counted;
  std::vector<std::pair<const Object*, TableHolder::Tables>> found;
  std::size_t all = 0;
  for (const Primitive& part : scene.parts().surfaces)
    visit_nested(*part.element, [&](const ObjectPtr& o) {
      const auto* holder = dynamic_cast<const TableHolder*>(o.get());
      if (!holder || !seen.insert(o.get()).second) return;
      found.emplace_back(o.get(), holder->tables());
      if (counted.insert(found.back().second.identity).second) all += found.back().second.bytes;
    });
  if (found.empty()) return;
  add_text(out, "tables       {:.2f} MB of BSDFs\n", 1e-6 * double(all));
  for (const auto& [o, tables] : found)
    add_text(out, "  {:<20} {:<24} {:8.2f} MB\n", o->properties().type(), o->id().empty() ? "-" : o->id(),
             1e-6 * double(tables.bytes));
}

}  // namespace

FileInfo scene_info(const std::filesystem::path& file,
                    const std::vector<std::pair<std::string, std::string>>& defines,
                    const std::shared_ptr<TableCache>& tables) {
  FileInfo info{"scene", "", {}};
  std::string& out = info.text;
  LoadOptions load;
  load.tables = tables;
  load.defines = defines;
  const LoadedScene loaded = load_scene(file, load);
  const Scene& scene = *loaded.scene;
  info.notes = loaded.notes;
  const Film& film = scene.film();
  add_text(out, "scene        {} (hash {:016x})\n", loaded.file.string(), loaded.hash);
  add_text(out, "film         {} {} x {}, rendered part {} x {} at ({}, {}), channels {}\n",
           film.properties().type(), film.width(), film.height(), film.crop_width(), film.crop_height(),
           film.crop_x(), film.crop_y(), fmt::join(film.channel_names(), ", "));
  add_text(out, "memory       {:.1f} MiB for the film\n",
           state_bytes(film.crop_width(), film.crop_height(), film.measured_channels(), 1) / (1 << 20));
  const auto& grid = scene.wavelengths().grid();
  add_text(out, "wavelengths  {:g} to {:g} nm, {} per path\n", grid.min_nm, grid.max_nm, kWavelengths);
  add_text(out, "sensor       {}, sampler {} with {} samples\n", scene.sensor().properties().type(),
           scene.sensor().sampler().properties().type(), scene.sensor().sampler().sample_count());
  add_text(out, "integrator   {}\n", loaded.integrator->properties().type());
  const Bounds3 b = scene.bounds();
  if (!b.empty())
    add_text(out, "bounds       ({:g}, {:g}, {:g}) to ({:g}, {:g}, {:g})\n", b.lower.x, b.lower.y, b.lower.z,
             b.upper.x, b.upper.y, b.upper.z);
  const std::vector<Primitive>& parts = scene.parts().surfaces;
  std::size_t primitives = 0;
  for (const Primitive& part : parts) primitives += part.triangle_count();
  add_text(out, "shapes       {} with {} primitives\n", parts.size(), primitives);
  std::size_t instances = 0;
  for (const Primitive& part : parts) {
    if (part.instance) {
      ++instances;
      continue;
    }
    add_text(out, "  {:<12} {:<24} {:>9} primitives  bsdf {}{}\n", part.element->type(),
             part.element->id().empty() ? "-" : part.element->id(), part.triangle_count(),
             part.bsdf->properties().type(), part.emitter ? "  emits" : "");
    for (const auto& r : part.remarks) add_text(out, "    {}\n", r);
  }
  if (instances) add_text(out, "  {} instances of groups\n", instances);
  print_tables(out, scene);
  std::map<std::string, int> emitters;
  for (const Light& e : scene.emitters()) ++emitters[e.properties().type()];
  add_text(out, "emitters     {}\n", scene.emitters().size());
  for (const auto& [type, count] : emitters) add_text(out, "  {} x {}\n", count, type);
  return info;
}

}  // namespace aureole

// SPDX-License-Identifier: Apache-2.0
// aureole info: lists the content of a scene, a picture, a volume or a state file.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "aureole/core/error.h"
#include "aureole/core/image.h"
#include "aureole/core/input_file.h"
#include "aureole/loading/load.h"
#include "aureole/parameter/grid/scalar_grid.h"
#include "aureole/parameter/radiance/radiance_voxels.h"
#include "aureole/plugin/table_holder.h"
#include "aureole/render/state.h"
#include "command.h"
#include "messages.h"
#include "nested_objects.h"
#include "picture_info.h"

namespace aureole {
namespace {

/// Prints the BSDFs of the scene's surfaces that made tables, in the scene's order, and the total memory;
/// shared tables are counted once.
void print_tables(const Scene& scene) {
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
  fmt::print("tables       {:.2f} MB of BSDFs\n", 1e-6 * double(all));
  for (const auto& [o, tables] : found)
    fmt::print("  {:<20} {:<24} {:8.2f} MB\n", o->properties().type(), o->id().empty() ? "-" : o->id(),
               1e-6 * double(tables.bytes));
}

/// Whether a file begins as XML does.
bool is_xml(const std::filesystem::path& file) {
  if (file.extension() == ".xml") return true;
  InputFile input(file);
  std::string start(std::min<std::uint64_t>(input.size(), 4096), '\0');
  input.read(start.data(), start.size());
  // Before the first character there may be blanks, a byte order mark and the zeros of UTF-16.
  const auto first =
      std::find_if(start.begin(), start.end(), [](unsigned char c) { return c > ' ' && c < 128; });
  return first != start.end() && *first == '<';
}

int info_of_scene(const std::string& file, const std::vector<std::string>& defines) {
  LoadOptions load;
  load.defines = split_defines(defines);
  const LoadedScene loaded = load_scene(file, load);
  const Scene& scene = *loaded.scene;
  for (const auto& note : loaded.notes) tell("note: {}\n", note);
  const Film& film = scene.film();
  fmt::print("scene        {} (hash {:016x})\n", loaded.file.string(), loaded.hash);
  fmt::print("film         {} {} x {}, rendered part {} x {} at ({}, {}), channels {}\n",
             film.properties().type(), film.width(), film.height(), film.crop_width(), film.crop_height(),
             film.crop_x(), film.crop_y(), fmt::join(film.channel_names(), ", "));
  fmt::print("memory       {:.1f} MiB for the film\n",
             state_bytes(film.crop_width(), film.crop_height(), film.measured_channels(), 1) / (1 << 20));
  const auto& grid = scene.wavelengths().grid();
  fmt::print("wavelengths  {:g} to {:g} nm, {} per path\n", grid.min_nm, grid.max_nm, kWavelengths);
  fmt::print("sensor       {}, sampler {} with {} samples\n", scene.sensor().properties().type(),
             scene.sensor().sampler().properties().type(), scene.sensor().sampler().sample_count());
  fmt::print("integrator   {}\n", loaded.integrator->properties().type());
  const Bounds3 b = scene.bounds();
  if (!b.empty())
    fmt::print("bounds       ({:g}, {:g}, {:g}) to ({:g}, {:g}, {:g})\n", b.lower.x, b.lower.y, b.lower.z,
               b.upper.x, b.upper.y, b.upper.z);
  const std::vector<Primitive>& parts = scene.parts().surfaces;
  std::size_t primitives = 0;
  for (const Primitive& part : parts) primitives += part.triangle_count();
  fmt::print("shapes       {} with {} primitives\n", parts.size(), primitives);
  std::size_t instances = 0;
  for (const Primitive& part : parts) {
    if (part.instance) {
      ++instances;
      continue;
    }
    fmt::print("  {:<12} {:<24} {:>9} primitives  bsdf {}{}\n", part.element->type(),
               part.element->id().empty() ? "-" : part.element->id(), part.triangle_count(),
               part.bsdf->properties().type(), part.emitter ? "  emits" : "");
    for (const auto& r : part.remarks) fmt::print("    {}\n", r);
  }
  if (instances) fmt::print("  {} instances of groups\n", instances);
  print_tables(scene);
  std::map<std::string, int> emitters;
  for (const Light& e : scene.emitters()) ++emitters[e.properties().type()];
  fmt::print("emitters     {}\n", scene.emitters().size());
  for (const auto& [type, count] : emitters) fmt::print("  {} x {}\n", count, type);
  return 0;
}

int info(const std::string& file, const std::vector<std::string>& defines) {
  if (is_radiance_voxels_file(file)) {
    if (!defines.empty()) throw Error("-D sets names of scenes: " + file + " is not a scene file");
    print_radiance_voxels(file);
    return 0;
  }
  const bool holds_splats = is_splats(file);                          // .spz is gzip, as NIfTI may be
  const bool is_volume = !holds_splats && is_scalar_grid_file(file);  // .vti is XML, too
  if (!holds_splats && !is_volume && is_xml(file)) return info_of_scene(file, defines);
  if (!defines.empty()) throw Error("-D sets names of scenes: " + file + " is not a scene file");
  if (is_volume)
    print_volume(file);
  else if (holds_splats)
    print_splats(file);
  else if (std::filesystem::path(file).extension() == ".state")
    print_state(file);
  else if (is_image_file(file))
    print_picture(file);
  else
    throw Error(
        {file, 0, 0},
        "is neither a scene file (XML) nor a picture (EXR, PNG, JPEG, TIFF, PFM, HDR, TGA, BMP) nor a volume "
        "(NRRD, MetaImage, NIfTI, .vti, .npy, .vol), splats (PLY, .spz, .splat, glTF, .usda), a radiance grid (.npz) nor a .state file");
  return 0;
}

std::function<int()> declare(CommandOptions& options) {
  auto file = std::make_shared<std::string>();
  auto defines = std::make_shared<std::vector<std::string>>();
  options.add("file", *file, "scene, picture, volume, splats, radiance grid or .state file").required();
  options.add("-D,--define", *defines, "set a $name of the scene").takes_each_time(1);
  return [=] { return info(*file, *defines); };
}

AUREOLE_COMMAND("info",
                "List the content of a scene, a picture, a volume, splats, a radiance grid or a state file",
                declare);

}  // namespace
}  // namespace aureole

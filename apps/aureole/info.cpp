// SPDX-License-Identifier: Apache-2.0
// aureole info: what a scene holds.
#include <fmt/format.h>

#include <map>

#include "aureole/render/state.h"
#include "aureole/scene/scene.h"
#include "command.h"

namespace aureole {
namespace {

int info(const std::string& file, const std::vector<std::string>& defines) {
  LoadOptions load;
  load.defines = split_defines(defines);
  const Scene scene(load_scene(file, load));
  for (const auto& note : scene.loaded().notes) fmt::print(stderr, "note: {}\n", note);
  const Film& film = scene.film();
  fmt::print("scene        {} (hash {:016x})\n", scene.loaded().file.string(), scene.hash());
  fmt::print("film         {} {} x {}, rendered part {} x {} at ({}, {}), channels {}\n",
             film.properties().type(), film.width(), film.height(), film.crop_width(), film.crop_height(),
             film.crop_x(), film.crop_y(), fmt::join(film.channel_names(), ", "));
  fmt::print("memory       {:.1f} MiB for the film\n",
             state_bytes(film.crop_width(), film.crop_height(), film.measured_channels(), 1) / (1 << 20));
  const auto& grid = scene.wavelengths().grid();
  fmt::print("wavelengths  {:g} to {:g} nm, {} per path\n", grid.min_nm, grid.max_nm, kWavelengths);
  fmt::print("sensor       {}, sampler {} with {} samples\n", scene.sensor().properties().type(),
             scene.sensor().sampler().properties().type(), scene.sensor().sampler().sample_count());
  fmt::print("integrator   {}\n", scene.integrator_object()->properties().type());
  const Bounds3 b = scene.bounds();
  if (!b.empty())
    fmt::print("bounds       ({:g}, {:g}, {:g}) to ({:g}, {:g}, {:g})\n", b.lower.x, b.lower.y, b.lower.z,
               b.upper.x, b.upper.y, b.upper.z);
  std::size_t primitives = 0;
  for (const auto& s : scene.shapes()) primitives += s->primitive_count();
  fmt::print("shapes       {} with {} primitives\n", scene.shapes().size(), primitives);
  std::size_t instances = 0;
  for (const auto& s : scene.shapes()) {
    if (!s->bsdf()) {
      ++instances;
      continue;
    }
    fmt::print("  {:<12} {:<24} {:>9} primitives  bsdf {}{}\n", s->properties().type(),
               s->id().empty() ? "-" : s->id(), s->primitive_count(), s->bsdf()->properties().type(),
               s->emitter() ? "  emits" : "");
    for (const auto& r : s->remarks()) fmt::print("    {}\n", r);
  }
  if (instances) fmt::print("  {} instances of groups\n", instances);
  std::map<std::string, int> emitters;
  for (const auto* e : scene.emitters()) ++emitters[e->properties().type()];
  fmt::print("emitters     {}\n", scene.emitters().size());
  for (const auto& [type, count] : emitters) fmt::print("  {} x {}\n", count, type);
  return 0;
}

std::function<int()> declare(CommandOptions& options) {
  auto file = std::make_shared<std::string>();
  auto defines = std::make_shared<std::vector<std::string>>();
  options.add("scene", *file, "scene file").required();
  options.add("-D,--define", *defines, "set a $name of the scene").takes_each_time(1);
  return [=] { return info(*file, *defines); };
}

AUREOLE_COMMAND("info", "Say what a scene holds", declare);

}  // namespace
}  // namespace aureole

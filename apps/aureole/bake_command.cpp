// SPDX-License-Identifier: Apache-2.0
// aureole bake: the light of a scene's surfaces as Gaussian splats, as points or as a radiance grid.
#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "aureole/core/error.h"
#include "aureole/core/letter_case.h"
#include "aureole/core/output_file.h"
#include "aureole/instrument/bake/radiance_bake.h"
#include "aureole/instrument/bake/splat_bake.h"
#include "aureole/parameter/splat/splat_writer.h"
#include "command.h"
#include "messages.h"
#include "scene_loading.h"

namespace aureole {
namespace {

/// The value of a whole number that the command line does not have.
constexpr int kNotGiven = std::numeric_limits<int>::min();

struct BakeArguments {
  std::string scene, output, to = "splats", density = "area", integrator;
  std::vector<std::string> defines;
  int count = kNotGiven, resolution = kNotGiven, degree = 0, paths = 64;
  double exposure = 1;
  std::int64_t seed = 0;
};

void require_extension(const std::filesystem::path& output, const std::vector<std::string>& known,
                       const char* what) {
  const std::string extension = lower_extension(output);
  if (std::find(known.begin(), known.end(), extension) == known.end())
    throw Error({output.string(), 0, 0},
                fmt::format("has the extension \"{}\"; {} as {}", extension, what, fmt::join(known, ", ")));
}

int bake(const BakeArguments& a) {
  const auto require = [](const char* option, double value, double low, double high) {
    if (!(value >= low && value <= high))
      throw Error(fmt::format("{} {:g}: must be between {:g} and {:g}", option, value, low, high));
  };
  const std::vector<std::string> kinds = {"splats", "pointcloud", "grid"};
  if (std::find(kinds.begin(), kinds.end(), a.to) == kinds.end())
    throw Error("--to " + a.to + ": expected \"splats\", \"pointcloud\" or \"grid\"" +
                did_you_mean(a.to, kinds));
  const bool is_grid = a.to == "grid", is_points = a.to == "pointcloud";
  require("--degree", a.degree, 0, 3), require("--paths", a.paths, 1, 1e6);
  require("--exposure", a.exposure, 1e-9, 1e9), require("--seed", double(a.seed), 0, 1e18);
  if (a.count != kNotGiven) require("--count", a.count, 1, 1e8);
  if (a.resolution != kNotGiven) require("--resolution", a.resolution, 2, 1024);
  if (is_grid && a.count != kNotGiven)
    throw Error("--count: a grid has as many voxels as the surfaces fill; state --resolution");
  if (!is_grid && a.resolution != kNotGiven) throw Error("--resolution is for --to grid; state --count");
  if (a.density != "area" && a.density != "camera")
    throw Error("--density " + a.density + ": expected \"area\" or \"camera\"" +
                did_you_mean(a.density, {"area", "camera"}));
  if (is_grid && a.density != "area") throw Error("--density: the voxels of a grid have one size");
  if (is_points && a.degree > 0) throw Error("--degree: points have one colour in all directions");
  const std::filesystem::path output = a.output;
  if (is_grid)
    require_extension(output, {".npz"}, "a radiance grid is written");
  else if (is_points)
    require_extension(output, {".ply"}, "points with normals and radii are written");
  else
    require_extension(output, splat_extensions(), "splats are written");
  require_writable(output);
  add_outputs({{"-o", output}});
  LoadOptions load = load_options(a.defines);
  load.integrator = a.integrator;
  load.fallback_integrator = "path";
  const LoadedScene scene = load_scene(a.scene, load);
  for (const std::string& note : scene.notes) tell("note: {}\n", note);
  if (is_grid) {
    RadianceBakeOptions options;
    if (a.resolution != kNotGiven) options.resolution = a.resolution;
    options.degree = a.degree, options.paths = a.paths;
    options.exposure = float(a.exposure), options.seed = std::uint64_t(a.seed);
    const RadianceBake baked = bake_radiance_grid(scene, options);
    for (const std::string& note : baked.notes) tell("note: {}\n", note);
    write_radiance_voxels(output, baked.voxels);
    const auto& size = baked.voxels.size;
    fmt::print("{} of {} x {} x {} voxels with a surface, on an area of {:.6g}, {} paths each: {}\n",
               baked.occupied, size[0], size[1], size[2], baked.area, a.paths, output.string());
    return 0;
  }
  SplatBakeOptions options;
  options.as_points = is_points;
  options.density = a.density == "camera" ? SurfaceLight::Density::camera : SurfaceLight::Density::area;
  if (a.count != kNotGiven) options.count = std::size_t(a.count);
  options.degree = a.degree, options.paths = a.paths;
  options.exposure = float(a.exposure), options.seed = std::uint64_t(a.seed);
  const SplatBake baked = bake_splats(scene, options);
  for (const std::string& note : baked.notes) tell("note: {}\n", note);
  for (const std::string& note : write_splat_file(output, baked.cloud))
    tell("note: {}: {}\n", output.string(), note);
  fmt::print("{} {} on an area of {:.6g}, {} paths each: {}\n", baked.cloud.size(),
             is_points ? "points" : "splats", baked.area, a.paths, output.string());
  return 0;
}

std::function<int()> declare_bake(CommandOptions& options) {
  auto a = std::make_shared<BakeArguments>();
  options.add("scene", a->scene, "scene file").required();
  options.add("-o,--output", a->output, "file: .ply, .spz, .glb or .usda; of points .ply; of a grid .npz")
      .required();
  options.add("--to", a->to, "splats (default), pointcloud or grid");
  options.add("--count", a->count, "number of splats or points (default 20000)");
  options.add(
      "--density", a->density,
      "splats or points per area: area (default), the same everywhere; camera, by the distance from the sensor");
  options.add("--resolution", a->resolution, "voxels along the longest side of a grid (default 128)");
  options.add("--degree", a->degree, "degree of the spherical harmonics, 0 (default) to 3");
  options.add("--paths", a->paths, "paths of each splat, point or voxel (default 64)");
  options.add("--exposure", a->exposure, "factor of the light before it is encoded (default 1)");
  options.add("--integrator", a->integrator, "plug-in instead of the scene's integrator");
  options.add("--seed", a->seed, "of the random numbers (default 0)");
  options.add("-D,--define", a->defines, "set a $name of the scene").takes_each_time(1);
  add_cache_option(options);
  return [=] { return bake(*a); };
}

AUREOLE_COMMAND("bake", "Write the light of a scene's surfaces as Gaussian splats, points or a radiance grid",
                declare_bake);

}  // namespace
}  // namespace aureole

// SPDX-License-Identifier: Apache-2.0
// aureole bake: the light of a scene's surfaces as Gaussian splats or points.
#include <fmt/format.h>

#include <algorithm>

#include "aureole/core/error.h"
#include "aureole/core/output_file.h"
#include "aureole/instrument/splat_bake.h"
#include "aureole/parameter/splat/splat_writer.h"
#include "command.h"
#include "messages.h"

namespace aureole {
namespace {

struct BakeArguments {
  std::string scene, output, to = "splats", integrator;
  std::vector<std::string> defines;
  int count = 20000, degree = 0, paths = 64;
  double exposure = 1;
  std::int64_t seed = 0;
};

int bake(const BakeArguments& a) {
  const auto require = [](const char* option, double value, double low, double high) {
    if (!(value >= low && value <= high))
      throw Error(fmt::format("{} {:g}: must be between {:g} and {:g}", option, value, low, high));
  };
  if (a.to != "splats" && a.to != "pointcloud")
    throw Error("--to " + a.to + ": expected \"splats\" or \"pointcloud\"" +
                did_you_mean(a.to, {"splats", "pointcloud"}));
  require("--count", a.count, 1, 1e8), require("--degree", a.degree, 0, 3),
      require("--paths", a.paths, 1, 1e6);
  require("--exposure", a.exposure, 1e-9, 1e9), require("--seed", double(a.seed), 0, 1e18);
  const std::filesystem::path output = a.output;
  const auto& known = splat_extensions();
  if (std::find(known.begin(), known.end(), output.extension().string()) == known.end())
    throw Error({output.string(), 0, 0}, "has the extension \"" + output.extension().string() +
                                             "\"; splats are written as .ply, .spz or .glb");
  if (a.to == "pointcloud" && output.extension() != ".ply")
    throw Error({output.string(), 0, 0}, "points with normals and radii are written as .ply");
  require_writable(output);
  LoadOptions load;
  load.defines = split_defines(a.defines);
  load.integrator = a.integrator;
  load.fallback_integrator = "path";
  const LoadedScene scene = load_scene(a.scene, load);
  for (const std::string& note : scene.notes) tell("note: {}\n", note);
  SplatBakeOptions options;
  options.as_points = a.to == "pointcloud";
  options.count = std::size_t(a.count), options.degree = a.degree, options.paths = a.paths;
  options.exposure = float(a.exposure), options.seed = std::uint64_t(a.seed);
  if (options.as_points && a.degree > 0) throw Error("--degree: points have one colour in all directions");
  const SplatBake baked = bake_splats(scene, options);
  for (const std::string& note : baked.notes) tell("note: {}\n", note);
  for (const std::string& note : write_splat_file(output, baked.cloud))
    tell("note: {}: {}\n", output.string(), note);
  fmt::print("{} {} on an area of {:.6g}, {} paths each: {}\n", baked.cloud.size(),
             options.as_points ? "points" : "splats", baked.area, a.paths, output.string());
  return 0;
}

std::function<int()> declare_bake(CommandOptions& options) {
  auto a = std::make_shared<BakeArguments>();
  options.add("scene", a->scene, "scene file").required();
  options.add("-o,--output", a->output, "file: .ply, .spz or .glb").required();
  options.add("--to", a->to, "splats (default) or pointcloud");
  options.add("--count", a->count, "number of splats or points (default 20000)");
  options.add("--degree", a->degree, "degree of the spherical harmonics, 0 (default) to 3");
  options.add("--paths", a->paths, "paths of each of them (default 64)");
  options.add("--exposure", a->exposure, "factor of the light before it is encoded (default 1)");
  options.add("--integrator", a->integrator, "plug-in instead of the scene's integrator");
  options.add("--seed", a->seed, "of the random numbers (default 0)");
  options.add("-D,--define", a->defines, "set a $name of the scene").takes_each_time(1);
  return [=] { return bake(*a); };
}

AUREOLE_COMMAND("bake", "Write the light of a scene's surfaces as Gaussian splats or points", declare_bake);

}  // namespace
}  // namespace aureole

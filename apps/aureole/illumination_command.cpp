// SPDX-License-Identifier: Apache-2.0
// aureole illumination: a scene by local illumination, light that was scattered once, beside all of its light.
#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <optional>

#include "aureole/core/error.h"
#include "aureole/core/letter_case.h"
#include "aureole/core/output_file.h"
#include "aureole/instrument/photometry/illumination.h"
#include "aureole/loading/load.h"
#include "aureole/render/job.h"
#include "aureole/render/output.h"
#include "aureole/render/tone.h"
#include "command.h"
#include "interruption.h"
#include "measured_scene.h"
#include "messages.h"
#include "scene_loading.h"

namespace aureole {
namespace {

struct IlluminationArguments {
  std::string scene, output, map;
  std::vector<std::string> defines;
  std::optional<std::int64_t> spp, seed;
  int threads = 0, runs = 8;
  std::vector<double> regions;
  bool quiet = false;
};

/// The scene with the integrator of local illumination, or of all light.
LoadedScene load_for(const IlluminationArguments& a, bool is_local) {
  LoadOptions load = load_options(a.defines);
  LoadedScene loaded = load_scene(a.scene, illumination_options(load, is_local));
  if (!is_local || !measures_on_receivers(*loaded.scene)) return loaded;
  return load_scene(a.scene, receiver_options(load));
}

IlluminationRuns illuminate(const IlluminationArguments& a, bool is_local,
                            const std::vector<MapRegion>& regions) {
  const LoadedScene loaded = load_for(a, is_local);
  if (!a.quiet && !is_local)
    for (const auto& note : loaded.notes) tell("note: {}\n", note);
  const Film& film = loaded.scene->film();
  IlluminationRuns result(a.scene, channels_attribute(film.channel_names(), film.channel_meanings()),
                          film.crop_width(), film.crop_height(), regions);
  for (int run = 0; run < a.runs; ++run) {
    RenderOptions options = render_options(a.spp, a.seed.value_or(0) + run, a.threads);
    options.adaptive = AdaptiveTarget::none;
    RenderJob job(loaded, options);
    run_to_end(job);
    result.add(job.state().picture(), job.state().rgb_picture());
  }
  return result;
}

/// Two pictures of one size, the first at the left.
Image side_by_side(const Image& left, const Image& right) {
  Image both{2 * left.width, left.height, left.channels, {}, false};
  const std::size_t row = std::size_t(left.width) * left.channel_count();
  for (int y = 0; y < left.height; ++y)
    for (const Image* p : {&left, &right}) {
      const auto begin = p->pixels.begin() + std::ptrdiff_t(std::size_t(y) * row);
      both.pixels.insert(both.pixels.end(), begin, begin + std::ptrdiff_t(row));
    }
  return both;
}

int illumination(const IlluminationArguments& a) {
  check_sampling(a.spp, a.seed, a.threads);
  if (a.seed && *a.seed > std::numeric_limits<std::int64_t>::max() - a.runs)
    throw Error(fmt::format("--seed {}: leaves no seeds for {} runs", *a.seed, a.runs));
  std::vector<MapRegion> regions;
  for (const double cell : a.regions)
    if (!(cell >= 0 && cell < 1e6 && cell == std::floor(cell)))
      throw Error(fmt::format("--region: {:g} is no number of pixels", cell));
  if (a.regions.size() % 4 != 0) throw Error("--region: expected X,Y,WIDTH,HEIGHT in pixels");
  for (std::size_t i = 0; i + 3 < a.regions.size(); i += 4)
    regions.push_back(
        {int(a.regions[i]), int(a.regions[i + 1]), int(a.regions[i + 2]), int(a.regions[i + 3])});
  for (const std::string& file : {a.output, a.map}) {
    if (file.empty()) continue;
    if (lower_extension(file) != ".png") throw Error(file + ": the picture is a .png file");
  }
  stop_on_interrupt();  // also while scenes are loaded
  const IlluminationRuns local = illuminate(a, true, regions), global = illuminate(a, false, regions);
  if (!a.output.empty()) write_png(a.output, display_picture(side_by_side(local.colors(), global.colors())));
  const PhotometricMap map = global.map();
  if (!a.map.empty()) {
    const PhotometricMap share = repeated_share(local.map(), map);
    write_png(a.map, false_color_picture(share.values, share.width, share.height,
                                         map_scale(share, 0, 100, false, {})));
  }
  fmt::print("{}, {}; means with their standard errors over {} runs\n", map.quantity, map.unit, a.runs);
  fmt::print("{:>20} {:>24} {:>24} {:>24} {:>8}\n", "region", "local", "global", "more than once", "share");
  for (std::size_t i = 0; i < local.regions().size(); ++i) {
    const MapRegion& r = local.regions()[i];
    const RunStatistics &l = local.statistics()[i], &g = global.statistics()[i];
    const auto with_error = [](double mean, double error) {
      return fmt::format("{:.6g} +- {:.2g}", mean, error);
    };
    fmt::print("{:>20} {:>24} {:>24} {:>24} {:7.2f}%\n",
               fmt::format("{},{},{},{}", r.x, r.y, r.width, r.height), with_error(l.mean(), l.error()),
               with_error(g.mean(), g.error()),
               with_error(g.mean() - l.mean(), std::hypot(g.error(), l.error())),
               g.mean() > 0 ? 100 * (1 - l.mean() / g.mean()) : 0.0);
  }
  return 0;
}

std::function<int()> declare_illumination(CommandOptions& options) {
  auto a = std::make_shared<IlluminationArguments>();
  options
      .add(
          "scene", a->scene,
          "scene (.xml); its integrator is replaced by \"direct\" (on receivers, by \"path\" of one segment) and by \"path\"")
      .required();
  options.add("-o,--output", a->output, "also write both pictures side by side, local at the left (.png)")
      .names_output();
  options
      .add("--map", a->map,
           "also write the share of light that was scattered more than once, in false colours (.png)")
      .names_output();
  options.add("-D,--define", a->defines, "set a $name of the scene: -D name=value").takes_each_time(1);
  add_cache_option(options);
  options.add("--spp", a->spp, "samples per pixel of each run (default: the scene's sample_count)");
  options.add("--runs", a->runs, "runs with seeds of their own, for the errors")
      .between(2, 1000)
      .shows_default();
  options.add("--seed", a->seed, "first seed (default: 0)");
  options.add("--threads", a->threads, "threads (default: all cores)");
  options
      .add("--region", a->regions,
           "X,Y,WIDTH,HEIGHT: pixels of which the means are printed; may be repeated (default: all)")
      .separated_by(',')
      .takes_each_time(4);
  options.add("-q,--quiet", a->quiet, "print results and errors only");
  return [a] { return illumination(*a); };
}

AUREOLE_COMMAND("illumination", "Local illumination (direct) beside global illumination (path), in numbers",
                declare_illumination);

}  // namespace
}  // namespace aureole

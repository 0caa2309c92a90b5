// SPDX-License-Identifier: Apache-2.0
// aureole illumination: a scene by local illumination, light that was scattered once, beside all of its light.
#include <fmt/format.h>

#include <cmath>
#include <filesystem>

#include "aureole/core/error.h"
#include "aureole/core/output_file.h"
#include "aureole/instrument/photometry/photometric_picture.h"
#include "aureole/loading/load.h"
#include "aureole/render/job.h"
#include "aureole/render/output.h"
#include "aureole/render/tone.h"
#include "command.h"
#include "interruption.h"
#include "messages.h"

namespace aureole {
namespace {

struct IlluminationArguments {
  std::string scene, output, map;
  std::vector<std::string> defines;
  std::int64_t spp = -1, seed = -1;
  int threads = 0, runs = 8;
  std::vector<double> regions;
  bool quiet = false;
};

/// Means over runs with independent seeds, and their standard errors.
struct RunStatistics {
  double sum = 0, squares = 0;
  int runs = 0;
  void add(double x) { sum += x, squares += x * x, ++runs; }
  double mean() const { return sum / runs; }
  double error() const {
    return runs > 1 ? std::sqrt(std::max(0.0, squares / runs - mean() * mean()) / (runs - 1)) : 0;
  }
};

struct Illumination {
  PhotometricMap map;  ///< mean over the runs
  Image colors;        ///< linear sRGB, mean over the runs
  std::vector<RunStatistics> regions;
};

double mean_of_region(const PhotometricMap& map, const MapRegion& r) {
  double sum = 0;
  for (int y = r.y; y < r.y + r.height; ++y)
    for (int x = r.x; x < r.x + r.width; ++x) sum += map.at(x, y);
  return sum / (double(r.width) * r.height);
}

/// The channel of a film in its unit, or its relative luminance.
PhotometricMap map_of(const Image& picture, const std::string& meanings, const Image& colors,
                      bool is_absolute, const std::string& name) {
  if (is_absolute) return photometric_map(picture, meanings, name);
  PhotometricMap map{colors.width, colors.height, {}, "relative luminance", "1"};
  for (int y = 0; y < colors.height; ++y)
    for (int x = 0; x < colors.width; ++x)
      map.values.push_back(colors.channel_count() == 3
                               ? 0.2126 * double(colors.at(x, y, 0)) + 0.7152 * double(colors.at(x, y, 1)) +
                                     0.0722 * double(colors.at(x, y, 2))
                               : double(colors.at(x, y, 0)));
  return map;
}

/// The scene with the integrator of local illumination, or of all light.
LoadedScene load_for(const IlluminationArguments& a, bool is_local) {
  LoadOptions load;
  load.defines = split_defines(a.defines);
  load.integrator = is_local ? "direct" : "path";
  LoadedScene loaded = load_scene(a.scene, load);
  const PlacedSensor& sensor = loaded.scene->sensor();
  if (!is_local || !sensor.receiver(0.5f * (sensor.part.lower + sensor.part.upper))) return loaded;
  // A receiver is irradiated itself: paths of one segment lead from it to the lights.
  load.integrator = "path";
  load.integrator_parameters = {{"integer", "max_depth", "1"}};
  return load_scene(a.scene, load);
}

Illumination illuminate(const IlluminationArguments& a, bool is_local, std::vector<MapRegion>& regions) {
  const LoadedScene loaded = load_for(a, is_local);
  if (!a.quiet && !is_local)
    for (const auto& note : loaded.notes) tell("note: {}\n", note);
  const Film& film = loaded.scene->film();
  const std::string meanings = channels_attribute(film.channel_names(), film.channel_meanings());
  const bool is_absolute =
      meanings.find("cd/m^2") != meanings.npos || meanings.find(", lx") != meanings.npos ||
      meanings.find("W/(m^2 sr)") != meanings.npos || meanings.find("W/m^2") != meanings.npos;
  if (regions.empty()) regions.push_back({0, 0, film.crop_width(), film.crop_height()});
  for (const MapRegion& r : regions)
    if (r.width < 1 || r.height < 1 || r.x + r.width > film.crop_width() ||
        r.y + r.height > film.crop_height())
      throw Error(fmt::format("--region {},{},{},{}: leaves the picture of {} x {} pixels", r.x, r.y, r.width,
                              r.height, film.crop_width(), film.crop_height()));
  Illumination result;
  result.regions.resize(regions.size());
  for (int run = 0; run < a.runs; ++run) {
    RenderOptions options;
    if (a.spp > 0) options.end = a.spp;
    options.seed = std::uint64_t(a.seed >= 0 ? a.seed : 0) + std::uint64_t(run);
    options.threads = a.threads;
    options.adaptive = AdaptiveTarget::none;
    RenderJob job(loaded, options);
    if (job.run(stop_on_interrupt()) == RenderJob::Outcome::interrupted)
      throw Error("interrupted: nothing is written");
    const Image picture = job.state().picture(), colors = job.state().rgb_picture();
    const PhotometricMap map = map_of(picture, meanings, colors, is_absolute, a.scene);
    for (std::size_t i = 0; i < regions.size(); ++i) result.regions[i].add(mean_of_region(map, regions[i]));
    if (run == 0) {
      result.map = map, result.colors = colors;
    } else {
      for (std::size_t i = 0; i < map.values.size(); ++i) result.map.values[i] += map.values[i];
      for (std::size_t i = 0; i < colors.pixels.size(); ++i) result.colors.pixels[i] += colors.pixels[i];
    }
  }
  for (double& v : result.map.values) v /= a.runs;
  for (float& v : result.colors.pixels) v /= float(a.runs);
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
  if (a.spp == 0 || a.spp < -1)
    throw Error(fmt::format("--spp {}: at least one sample per pixel is needed", a.spp));
  if (a.seed < -1) throw Error(fmt::format("--seed {}: must not be negative", a.seed));
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
    if (std::filesystem::path(file).extension() != ".png") throw Error(file + ": the picture is a .png file");
    require_writable(file);
  }
  stop_on_interrupt();  // also while scenes are loaded
  const Illumination local = illuminate(a, true, regions), global = illuminate(a, false, regions);
  if (!a.output.empty()) write_png(a.output, display_picture(side_by_side(local.colors, global.colors)));
  if (!a.map.empty()) {
    PhotometricMap share = global.map;
    share.quantity = "light scattered more than once", share.unit = "%";
    for (std::size_t i = 0; i < share.values.size(); ++i)
      share.values[i] = share.values[i] > 0 ? 100 * (1 - local.map.values[i] / share.values[i]) : 0;
    write_png(a.map, false_color_picture(share.values, share.width, share.height,
                                         map_scale(share, 0, 100, false, {})));
  }
  fmt::print("{}, {}; means with their standard errors over {} runs\n", global.map.quantity, global.map.unit,
             a.runs);
  fmt::print("{:>20} {:>24} {:>24} {:>24} {:>8}\n", "region", "local", "global", "more than once", "share");
  for (std::size_t i = 0; i < regions.size(); ++i) {
    const MapRegion& r = regions[i];
    const RunStatistics &l = local.regions[i], &g = global.regions[i];
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

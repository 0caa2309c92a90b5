// SPDX-License-Identifier: Apache-2.0
// aureole photometry: false colours, tables, uniformity, glare and daylight factors of a scene or of its picture.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>

#include "aureole/core/error.h"
#include "aureole/core/letter_case.h"
#include "aureole/core/output_file.h"
#include "aureole/instrument/photometry/photometric_picture.h"
#include "aureole/loading/load.h"
#include "aureole/render/job.h"
#include "aureole/render/output.h"
#include "command.h"
#include "measured_scene.h"
#include "messages.h"
#include "picture_file.h"
#include "scene_loading.h"

namespace aureole {
namespace {

struct PhotometryArguments {
  std::string target, output, scene, csv;
  std::vector<std::string> defines;
  std::optional<std::int64_t> spp, seed;
  int threads = 0;
  bool glare = false, daylight = false, logarithmic = false, quiet = false;
  std::optional<double> threshold, min, max;
  std::vector<double> up, isolines, regions;
};

/// A map, and the scene that it shows, if that is known.
struct MapOfScene {
  PhotometricMap map;
  std::shared_ptr<const Scene> scene;
};

/// Throws Error located at `where` unless daylight factors can be made of the map.
void require_daylight_map(const PhotometricMap& map, const SourceLocation& where) {
  try {
    aureole::require_daylight_map(map.quantity, map.unit);
  } catch (const Error& e) {
    throw Error(where, e.message());
  }
}

MapOfScene map_of_scene(const PhotometryArguments& a, const std::filesystem::path& picture_file) {
  const LoadedScene loaded = load_measured_scene(a.target, a.defines, a.quiet);
  const std::vector<std::string> names = loaded.scene->film().channel_names();
  const std::string meanings = channels_attribute(names, loaded.scene->film().channel_meanings());
  // The unit is checked before the picture is rendered.
  const PhotometricMap empty = photometric_map(
      {.width = 1, .height = 1, .channels = names, .pixels = std::vector<float>(names.size())}, meanings,
      a.target);
  if (a.daylight) require_daylight_map(empty, loaded.scene->sensor().properties().where());
  RenderJob job(loaded, render_options(a.spp, a.seed, a.threads));
  run_to_end(job);
  const Image picture = job.state().picture();
  write_picture(job.state(), picture, picture_file);
  return {photometric_map(picture, meanings, a.target), loaded.scene};
}

MapOfScene map_of_picture(const PhotometryArguments& a) {
  ExrAttributes attributes;
  const Image picture = read_picture(a.target, &attributes);
  const auto found = attributes.strings.find(kChannelsAttribute);
  MapOfScene result{
      photometric_map(picture, found == attributes.strings.end() ? "" : found->second, a.target), nullptr};
  if (a.daylight) require_daylight_map(result.map, {a.target, 0, 0});
  if (a.scene.empty()) return result;
  LoadOptions load = load_options(a.defines);
  result.scene = load_scene(a.scene, load).scene;
  try {
    place_on_film(result.scene->film(), picture.width, picture.height);
  } catch (const Error& e) {
    throw Error("--scene " + a.scene + ": " + e.message());
  }
  return result;
}

void print_glare(const PictureGlare& g) {
  fmt::print("glare: UGR {:.2f}; background {:.5g} cd/m^2 over {:.3g} sr, sources from {:.5g} cd/m^2 on\n",
             g.rating, g.background, g.solid_angle, g.threshold);
  fmt::print("{:>8} {:>8} {:>8} {:>12} {:>12} {:>8}\n", "x", "y", "pixels", "cd/m^2", "sr", "p");
  constexpr std::size_t kMostListed = 20;
  for (std::size_t i = 0; i < std::min(kMostListed, g.sources.size()); ++i) {
    const PictureGlareSource& s = g.sources[i];
    fmt::print("{:8.1f} {:8.1f} {:8} {:12.5g} {:12.5g} {:8.3f}\n", s.x, s.y, s.pixels, s.source.luminance,
               s.source.solid_angle, s.source.position);
  }
  if (g.sources.size() > kMostListed) fmt::print("and {} more\n", g.sources.size() - kMostListed);
  if (g.outside > 0)
    tell(
        "note: {} of {} sources are smaller than 0.0003 sr or larger than 0.1 sr, for which UGR is not meant\n",
        g.outside, g.sources.size());
  if (g.solid_angle < 2)
    tell("note: the background is that of the picture, {:.2g} sr of the {:.3g} sr before the observer\n",
         g.solid_angle, 2 * M_PI);
}

std::string csv_text(const PhotometricMap& map) {
  std::string s = fmt::format("# {}, {}; {} x {} cells, rows from the top\n", map.quantity, map.unit,
                              map.width, map.height);
  for (int y = 0; y < map.height; ++y)
    for (int x = 0; x < map.width; ++x)
      s += fmt::format("{:.6g}{}", map.at(x, y), x + 1 < map.width ? "," : "\n");
  return s;
}

int photometry(const PhotometryArguments& a) {
  check_sampling(a.spp, a.seed, a.threads);
  if (a.regions.size() % 4 != 0) throw Error("--region: expected X,Y,WIDTH,HEIGHT in cells");
  for (const double cell : a.regions)
    if (!(cell >= 0 && cell < 1e6 && cell == std::floor(cell)))
      throw Error(fmt::format("--region: {:g} is no number of cells", cell));
  for (const double value : a.isolines)
    if (!std::isfinite(value)) throw Error(fmt::format("--isolines: {:g} is no value of an isoline", value));
  const bool is_scene = lower_extension(a.target) == ".xml";
  if (!is_scene)
    refuse_options({{"--spp", a.spp.has_value()},
                    {"--seed", a.seed.has_value()},
                    {"--threads", a.threads != 0},
                    {"--define", !a.defines.empty() && a.scene.empty()}},
                   "is for a scene, which is rendered; a picture is done");
  refuse_options({{"--threshold", a.threshold && !a.glare}}, "is for --glare");
  refuse_options({{"--up", !a.up.empty() && !a.glare && !a.daylight}}, "is for --glare and --daylight");
  if (is_scene && !a.scene.empty())
    throw Error("--scene: is the scene of a picture; the target is a scene itself");
  if (!is_scene && a.scene.empty())
    for (const auto& [option, given] : {std::pair("--glare", a.glare), std::pair("--daylight", a.daylight)})
      if (given)
        throw Error(std::string(option) + ": needs the camera and the sky of the picture: give its --scene");
  std::filesystem::path png = a.output;
  if (png.empty()) png = std::filesystem::path(a.target).stem().string() + "_photometry.png";
  if (lower_extension(png) != ".png")
    throw Error("-o " + png.string() + ": the output is a .png file (an .exr is written beside it)");
  const std::filesystem::path exr = std::filesystem::path(png).replace_extension(".exr");
  require_writable(png);
  if (is_scene) require_writable(exr);
  add_outputs({{"-o", png}});
  if (is_scene) add_outputs({{"the picture of -o", exr}});
  Vec3 up{0, 0, 1};
  if (!a.up.empty()) up = {float(a.up[0]), float(a.up[1]), float(a.up[2])};
  if (!(length_squared(up) > 0)) throw Error("--up: is no direction");
  up = normalize(up);

  MapOfScene found = is_scene ? map_of_scene(a, exr) : map_of_picture(a);
  PhotometricMap& map = found.map;
  if (found.scene) map.areas = cell_areas(found.scene->sensor(), map.width, map.height);
  if (a.daylight) {
    const double open = open_illuminance(*found.scene, up);
    if (!(open > 0)) throw Error("--daylight: the scene has no sky or sun above --up");
    fmt::print("open ground: {:.6g} lx by the emitters at infinity\n", open);
    for (double& v : map.values) v *= 100 / open;
    map.quantity = "daylight factor", map.unit = "%";
  }

  const ColorScale scale = map_scale(map, a.min, a.max, a.logarithmic, a.isolines);
  std::vector<MapRegion> regions;
  for (std::size_t i = 0; i + 3 < a.regions.size(); i += 4)
    regions.push_back(
        {int(a.regions[i]), int(a.regions[i + 1]), int(a.regions[i + 2]), int(a.regions[i + 3])});
  if (regions.empty()) regions.push_back({0, 0, map.width, map.height});
  std::vector<MapStatistics> statistics;
  for (const MapRegion& r : regions) statistics.push_back(map_statistics(map, r));
  std::optional<PictureGlare> glare;
  if (a.glare) glare = picture_glare(map, found.scene->sensor(), up, a.threshold.value_or(0));
  write_png(png, false_color_picture(map.values, map.width, map.height, scale));
  if (!a.csv.empty()) write_file_atomically(a.csv, csv_text(map));

  fmt::print("{}, {}; {} x {} cells\n", map.quantity, map.unit, map.width, map.height);
  fmt::print("{:>20} {:>10} {:>10} {:>10} {:>10} {:>9} {:>9}\n", "region", "mean", "min", "median", "max",
             "min/mean", "min/max");
  for (std::size_t i = 0; i < regions.size(); ++i) {
    const MapRegion& r = regions[i];
    const MapStatistics& st = statistics[i];
    fmt::print("{:>20} {:10.5g} {:10.5g} {:10.5g} {:10.5g} {:9.4f} {:9.4f}\n",
               fmt::format("{},{},{},{}", r.x, r.y, r.width, r.height), st.mean, st.min, st.median, st.max,
               st.uniformity(), st.diversity());
  }
  if (is_unit_of_flux(map.unit))
    for (std::size_t i = 0; i < regions.size(); ++i)
      fmt::print("{} through {},{},{},{}: {:.6g} {}\n", map.quantity, regions[i].x, regions[i].y,
                 regions[i].width, regions[i].height, statistics[i].sum, map.unit);
  if (statistics.size() == 2 && statistics[1].mean > 0) {
    const double first = statistics[0].mean, second = statistics[1].mean;
    fmt::print("contrast of the first region against the second: {:.4f} (Weber), {:.4f} (Michelson)\n",
               first / second - 1, (first - second) / (first + second));
  }
  if (glare) print_glare(*glare);
  if (!a.quiet) {
    fmt::print("{}\n", png.string());
    if (is_scene) fmt::print("{}\n", exr.string());
  }
  return 0;
}

std::function<int()> declare_photometry(CommandOptions& options) {
  auto a = std::make_shared<PhotometryArguments>();
  options
      .add(
          "target", a->target,
          "scene (.xml), which is rendered, or a picture (.exr); its film states a quantity such as luminance")
      .required();
  options.add(
      "-o,--output", a->output,
      "false-colour .png (default: the target's name with _photometry.png); a scene's .exr lies beside it");
  options.add("-D,--define", a->defines, "set a $name of the scene: -D name=value").takes_each_time(1);
  add_cache_option(options);
  options.add("--scene", a->scene, "scene of a picture, for --glare and --daylight").names_input();
  options.add("--spp", a->spp, "samples per cell (default: the scene's sample_count)");
  options.add("--seed", a->seed, "seed of the samples (default: the scene's)");
  options.add("--threads", a->threads, "threads (default: all cores)");
  options.add("--min", a->min, "lower limit of the colours (default: 0, or by the values with --log)");
  options.add("--max", a->max, "upper limit of the colours (default: by the values)");
  options.add("--log", a->logarithmic, "logarithmic scale of the colours");
  options
      .add("--isolines", a->isolines, "values of isolines, separated by commas (default: those of the scale)")
      .separated_by(',');
  options
      .add(
          "--region", a->regions,
          "X,Y,WIDTH,HEIGHT: cells of which statistics are printed; may be repeated; two of them are compared")
      .separated_by(',')
      .takes_each_time(4);
  options.add("--csv", a->csv, "write the values to this file, a row a line").names_output();
  options.add("--glare", a->glare, "print sources of glare and UGR (CIE 117) of a picture of the luminance");
  options
      .add("--threshold", a->threshold,
           "luminance of glare sources in cd/m^2 (default: five times the picture's mean)")
      .between(1e-6, 1e12);
  options.add("--daylight", a->daylight,
              "print and draw the daylight factor in %: the illuminance over that of the open ground");
  options.add("--up", a->up, "X,Y,Z: upwards in the scene, for --glare and --daylight (default: 0,0,1)")
      .separated_by(',')
      .takes(3);
  options.add("-q,--quiet", a->quiet, "print results and errors only");
  return [a] { return photometry(*a); };
}

AUREOLE_COMMAND("photometry",
                "Illuminance and luminance: false colours, tables, uniformity, UGR, daylight factor",
                declare_photometry);

}  // namespace
}  // namespace aureole

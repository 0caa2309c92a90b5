// SPDX-License-Identifier: Apache-2.0
// aureole powermap: the power received on a plane or a shape, in the units of radio engineering.
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <optional>

#include "aureole/core/error.h"
#include "aureole/core/letter_case.h"
#include "aureole/core/output_file.h"
#include "aureole/core/version.h"
#include "aureole/instrument/radio/power_map.h"
#include "aureole/instrument/radio/power_map_scene.h"
#include "aureole/render/job.h"
#include "aureole/render/output.h"
#include "command.h"
#include "measured_scene.h"
#include "messages.h"
#include "picture_file.h"
#include "scene_loading.h"

namespace aureole {
namespace {

std::atomic<bool> stop_requested{false};
extern "C" void stop_map(int) { stop_requested = true; }

struct Arguments {
  PowerMapSettings settings;
  std::string output, power, show;
  std::vector<std::string> defines;
  std::optional<std::int64_t> spp, seed;
  int threads = 0, replicates = 1;
  double time_s = 0;
  std::optional<double> min_db, max_db;
  bool quiet = false;
};

/// Prints one line about a map: medians over the cells that receive power, and their noise.
void print_map(const PowerMap& map) {
  std::vector<std::size_t> lit;
  const std::vector<double> relative = map.relative_db();
  std::vector<std::size_t> compared;  // cells with finite relative power
  for (std::size_t i = 0; i < map.density.size(); ++i) {
    if (!(map.density[i] > 0)) continue;
    lit.push_back(i);
    if (std::isfinite(relative[i])) compared.push_back(i);
  }
  fmt::print("{}: {:.6g} W, power in {} of {} cells", band_text(map), map.power_w, lit.size(),
             map.density.size());
  if (compared.size() < lit.size())
    fmt::print(" ({} of these would be dark in free space)", lit.size() - compared.size());
  const auto quantile = [](const std::vector<double>& values, const std::vector<std::size_t>& cells,
                           double q) {
    std::vector<double> those;
    for (const std::size_t i : cells) those.push_back(values[i]);
    const auto at = those.begin() + std::ptrdiff_t(q * double(those.size() - 1));
    std::nth_element(those.begin(), at, those.end());
    return *at;
  };
  if (!lit.empty()) {
    fmt::print(", medians ");
    if (!compared.empty()) fmt::print("{:.2f} dB re free space, ", quantile(relative, compared, 0.5));
    fmt::print("{:.2f} dBm", quantile(map.received_dbm(), lit, 0.5));
    if (!map.error.empty())
      fmt::print(", standard error {:.2f} dB, {:.2f} dB in the worst tenth",
                 quantile(map.error_db(), lit, 0.5), quantile(map.error_db(), lit, 0.9));
  }
  fmt::print("\n");
}

/// Throws Error for a limit of the colours that no scale has.
void require_limit(const char* option, const std::optional<double>& given) {
  if (given && !(std::abs(*given) <= DecibelScale::kWidest))
    throw Error(fmt::format("{} {}: must be between -{} and {} dB", option, *given, DecibelScale::kWidest,
                            DecibelScale::kWidest));
}

int powermap(const Arguments& a) {
  check_sampling(a.spp, a.seed, a.threads);
  if (a.replicates < 1) throw Error(fmt::format("--replicates {}: must be at least 1", a.replicates));
  if (!(a.time_s >= 0)) throw Error(fmt::format("--time {}: must not be negative", a.time_s));
  const std::optional<double>&min_db = a.min_db, &max_db = a.max_db;
  require_limit("--min-db", min_db), require_limit("--max-db", max_db);
  if (min_db && max_db && *min_db >= *max_db)
    throw Error(fmt::format("--min-db {}: must be less than --max-db, {}", *min_db, *max_db));
  if (min_db && max_db && *max_db - *min_db > DecibelScale::kWidest)
    throw Error(fmt::format("--min-db {}: more than {} dB below --max-db, {}", *min_db, DecibelScale::kWidest,
                            *max_db));
  std::optional<double> power;
  try {
    if (!a.power.empty()) power = parse_power_w(a.power);
  } catch (const Error& e) {
    throw Error("--power: " + e.message());
  }
  std::filesystem::path output = a.output;
  if (output.empty()) output = default_output(a.settings.scene, ".exr");
  if (lower_extension(output) != ".exr")
    throw Error("-o " + output.string() + ": the output is an .exr file (a .png is written beside it)");
  const std::filesystem::path png = std::filesystem::path(output).replace_extension(".png");
  const OutputLock lock(output);
  require_writable(output);
  require_writable(png);
  add_outputs({{"-o", output}, {"the picture of -o", png}});

  PowerMapSettings settings = a.settings;
  settings.defines = split_defines(a.defines);
  settings.tables = table_cache(), settings.check_files = keep_files_of_scene;
  const LoadedScene loaded = load_power_map(settings);
  if (!a.quiet)
    for (const auto& note : loaded.notes) tell("note: {}\n", note);
  if (!a.quiet)
    for (const auto& note : power_map_notes(settings, loaded)) tell("note: {}\n", note);
  require_power_map(*loaded.scene);
  RenderOptions options = render_options(a.spp, a.seed, a.threads);
  options.replicates = a.replicates, options.time_limit_s = a.time_s;
  RenderJob job(loaded, options);
  std::signal(SIGINT, stop_map);
  if (job.run(stop_requested) == RenderJob::Outcome::interrupted) {
    tell("interrupted: no map is written\n");
    return 1;
  }
  if (job.state().invalid_samples > 0)
    tell("note: {} samples were invalid and left out\n", job.state().invalid_samples);

  const std::vector<PowerMap> maps = power_maps(*loaded.scene, job.state().picture(), power);
  // The map is written before its picture, so that it is kept if the picture fails.
  ExrAttributes attributes;
  attributes.strings = {{"aureole.scene", loaded.file.filename().string()},
                        {"aureole.integrator", loaded.integrator->properties().type()},
                        {"units", "density, free_space: W/m^2; received_dBm: isotropic antenna"}};
  const Image picture = power_map_image(maps);
  attributes.strings[kChannelsAttribute] =
      channels_attribute(picture.channels, power_map_meanings(picture.channels));
  for (const PowerMap& map : maps) {
    const std::string prefix = maps.size() > 1 ? map.channel + "." : "";
    attributes.floats[prefix + "power_W"] = float(map.power_w);
    attributes.floats[prefix + "wavelength_m"] = float(map.wavelength_m);
  }
  const WrittenFile written = write_somewhere(output, [&](const std::filesystem::path& file) {
    write_exr(file, picture, ExrPixel::float32, attributes);
  });
  if (!written.problem.empty()) {
    tell("error: {}\nerror: the map is in {} instead\n", written.problem, written.file.string());
    return 1;
  }

  const std::string show = !a.show.empty() ? a.show : power ? "dBm" : "relative";
  const PowerMap& first = maps[0];
  const std::vector<double> values = show == "dBm" ? first.received_dbm() : first.relative_db();
  DecibelScale scale = DecibelScale::of(
      values, show == "dBm" ? fmt::format("{}, {:.4g} W: received power in dBm, isotropic antenna",
                                          band_text(first), first.power_w)
                            : band_text(first) + ": power density in dB re free space");
  scale.set_ends(min_db, max_db);
  write_png(png, decibel_picture(values, first.width, first.height, scale));
  if (a.quiet) return 0;
  for (const PowerMap& map : maps) print_map(map);
  fmt::print("{} samples per cell in {:.2f} s\n{}\n{}\n", job.state().samples_everywhere(),
             job.state().seconds, output.string(), png.string());
  return 0;
}

std::function<int()> declare(CommandOptions& options) {
  auto a = std::make_shared<Arguments>();
  options.add("scene", a->settings.scene, "scene file whose sensor is a powermap, or any with --plane")
      .required();
  options.add("-o,--output", a->output,
              "output .exr (default: the scene's name, in the working folder), with a .png of the same name");
  options.add("-D,--define", a->defines, "set a $name of the scene: -D name=value").takes_each_time(1);
  add_cache_option(options);
  options.add("--spp", a->spp, "samples per cell (default: the scene's sample_count)");
  options.add("--seed", a->seed, "seed of the samples (default: the scene's)");
  options.add("--threads", a->threads, "threads (default: all cores); the map does not depend on it");
  options.add("--time", a->time_s, "stop after this many seconds, on whole sample blocks");
  options.add("--replicates", a->replicates,
              "number of independent maps; stores their mean and its standard error in dB");
  options.add("--integrator", a->settings.integrator, "replace the scene's integrator: ptracer, path, bdpt");
  options.add("--max-depth", a->settings.max_depth, "replace the integrator's max_depth");
  options.add("--diffraction", a->settings.diffraction, "edges of shapes diffract");
  options
      .add(
          "--diffraction-model", a->settings.diffraction_model,
          "how edges diffract, segments (default) or beams; segments selects the integrator path unless --integrator is given")
      .one_of({"beams", "segments"});
  options
      .add(
          "--polarisation", a->settings.polarisation,
          "of light that edges diffract, with the model segments: soft (electric field along each edge), hard, both "
          "(their mean power) or none")
      .one_of({"none", "soft", "hard", "both"});
  options
      .add(
          "--plane", a->settings.plane,
          "X Y Z: map on a plane with this centre, instead of the scene's sensor; needs --size and --frequency. "
          "BSDFs with ids such as mat-itu_concrete become slabs of that material, 0.1 m thick")
      .takes(3);
  options.add("--size", a->settings.size, "W H: width and height of the plane, in the scene's units")
      .takes(2);
  options
      .add("--normal", a->settings.normal,
           "X Y Z: normal of the plane (default: 0 0 1); z is up in the picture of any other plane")
      .takes(3);
  options.add("--cell", a->settings.cell,
              "side of a cell of the plane (default: 200 cells along the longer side)");
  options.add("--frequency", a->settings.frequency,
              "frequency or wavelength of the map on a plane, such as 3.5GHz");
  options
      .add("--transmitter", a->settings.transmitters,
           "X Y Z: adds an isotropic transmitter of 1 W; may be repeated")
      .takes_each_time(3);
  options.add(
      "--power", a->power,
      "total power of all emitters in the band, \"2W\", \"500mW\" or \"33dBm\" (default: the scene's)");
  options.add("--show", a->show, "quantity of the PNG (default: dBm with --power, else relative)")
      .one_of({"relative", "dBm"});
  options.add("--min-db", a->min_db, "lower limit of the PNG's colours [dB] (default: by the values)");
  options.add("--max-db", a->max_db,
              "upper limit of the PNG's colours [dB], at most 1000 above the lower one");
  options.add("-q,--quiet", a->quiet, "print errors only");
  return [a] { return powermap(*a); };
}

AUREOLE_COMMAND("powermap", "Power on a plane or a shape: W/m^2, dB relative to free space, dBm", declare);

}  // namespace
}  // namespace aureole

// SPDX-License-Identifier: Apache-2.0
// aureole powermap: the power received on a plane or a shape, in the units of radio engineering.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <limits>

#include "aureole/core/error.h"
#include "aureole/core/output_file.h"
#include "aureole/core/version.h"
#include "aureole/instrument/radio/power_map.h"
#include "aureole/render/job.h"
#include "aureole/render/output.h"
#include "command.h"
#include "messages.h"
#include "picture_file.h"

namespace aureole {
namespace {

std::atomic<bool> stop_requested{false};
extern "C" void stop_map(int) { stop_requested = true; }

constexpr int kNotGiven = std::numeric_limits<int>::min();

struct Arguments {
  std::string scene, output, integrator, power, show;
  std::vector<std::string> defines;
  std::int64_t spp = -1, seed = -1;
  int threads = 0, replicates = 1;
  double time_s = 0;
  std::vector<double> min_db, max_db;  // colour limits; one number each, or none
  // Parameters of a map on a plane, for scenes without a sensor: three numbers each, or none; `size` has two.
  std::vector<double> plane, normal, size, transmitters;
  std::string frequency;
  double cell = 0;
  int max_depth = kNotGiven;
  bool diffraction = false;
  std::string diffraction_model;
  bool quiet = false;
};

/// Returns text such as "28 GHz" for wavelengths above 0.1 mm, else in nanometres.
std::string band_text(const PowerMap& map) {
  const double ghz = 299792458.0 / map.wavelength_m * 1e-9;
  return ghz < 3000 ? fmt::format("{:.4g} GHz", ghz) : fmt::format("{:.5g} nm", map.wavelength_m * 1e9);
}

void add_channel(Image& image, std::size_t channel, const std::vector<double>& values) {
  for (std::size_t i = 0; i < values.size(); ++i)
    image.pixels[i * image.channels.size() + channel] = float(values[i]);
}

Image as_image(const std::vector<PowerMap>& maps) {
  Image image;
  image.width = maps[0].width, image.height = maps[0].height;
  const bool has_errors = !maps[0].error.empty();
  for (const PowerMap& map : maps) {
    const std::string prefix = maps.size() > 1 ? map.channel + "." : "";
    for (const char* name : {"density", "free_space", "relative_dB", "received_dBm"})
      image.channels.push_back(prefix + name);
    if (has_errors) image.channels.push_back(prefix + "error_dB");
  }
  image.pixels.resize(maps[0].density.size() * image.channels.size());
  std::size_t channel = 0;
  for (const PowerMap& map : maps) {
    add_channel(image, channel++, map.density);
    add_channel(image, channel++, map.free);
    add_channel(image, channel++, map.relative_db());
    add_channel(image, channel++, map.received_dbm());
    if (has_errors) add_channel(image, channel++, map.error_db());
  }
  return image;
}

/// Returns the quantity of each channel of `as_image`, with its unit, for the header of the picture.
std::vector<std::string> meanings_of(const std::vector<std::string>& channels) {
  std::vector<std::string> meanings;
  for (const std::string& name : channels)
    meanings.emplace_back(name.ends_with("density")        ? "power density, W/m^2"
                          : name.ends_with("free_space")   ? "power density without any shape, W/m^2"
                          : name.ends_with("relative_dB")  ? "density over free_space, dB"
                          : name.ends_with("received_dBm") ? "power that an isotropic antenna receives, dBm"
                                                           : "standard error of relative_dB, dB");
  return meanings;
}

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

/// Returns the colour limit that an option gives.
std::optional<double> end_of_colours(const char* option, const std::vector<double>& given) {
  if (given.empty()) return {};
  if (!(std::abs(given[0]) <= DecibelScale::kWidest))
    throw Error(fmt::format("{} {}: must be between -{} and {} dB", option, given[0], DecibelScale::kWidest,
                            DecibelScale::kWidest));
  return given[0];
}

std::string vector_text(const char* name, double x, double y, double z) {
  return fmt::format("{}=\"{:.9g}, {:.9g}, {:.9g}\"", name, x, y, z);
}

/// Returns the unit normal of the plane.
std::array<double, 3> normal_of(const Arguments& a) {
  if (a.normal.empty()) return {0, 0, 1};
  const double length = std::hypot(a.normal[0], a.normal[1], a.normal[2]);
  if (!(length > 1e-6 && std::isfinite(length)))
    throw Error(
        fmt::format("--normal {:g} {:g} {:g}: is no direction", a.normal[0], a.normal[1], a.normal[2]));
  return {a.normal[0] / length, a.normal[1] / length, a.normal[2] / length};
}

/// The name under which the scene with the plane includes the user's scene, whose own name may contain any
/// characters.
constexpr const char* kSceneFile = "scene_of_the_plane";

/// Returns a scene that adds a map on a plane and transmitters to the user's scene.
std::string scene_with_plane(const Arguments& a) {
  for (const auto& [option, numbers] : {std::pair("--plane", a.plane), std::pair("--normal", a.normal),
                                        std::pair("--transmitter", a.transmitters)})
    for (const double x : numbers)
      if (!std::isfinite(x)) throw Error(fmt::format("{}: {:g} is not finite", option, x));
  const auto positive = [](const char* option, double value) {
    if (!(value > 0 && std::isfinite(value)))
      throw Error(fmt::format("{} {:g}: must be positive and finite", option, value));
  };
  if (a.size.empty()) throw Error("--plane: give its --size too, width and height in the scene's units");
  if (a.frequency.empty()) throw Error("--plane: give the --frequency too, such as 3.5GHz");
  positive("--size", a.size[0]), positive("--size", a.size[1]);
  constexpr double kCells = 200, kMostCells = 16384;
  const double longest = std::max(a.size[0], a.size[1]), cell = a.cell != 0 ? a.cell : longest / kCells;
  positive("--cell", cell);
  if (longest / cell > kMostCells)
    throw Error(
        fmt::format("--cell {:g}: the map would have more than {} cells along a side", cell, kMostCells));
  double nm = 0;
  try {
    nm = parse_wavelength_nm(a.frequency);
  } catch (const Error& e) {
    throw Error("--frequency: " + e.message());
  }
  const bool has_unit =
      std::any_of(a.frequency.begin(), a.frequency.end(), [](unsigned char c) { return std::isalpha(c); });
  if (!has_unit || !(nm > 0))
    throw Error("--frequency " + a.frequency +
                ": write a frequency with its unit, such as 3.5GHz, or a wavelength");
  // Axes of the map: for a horizontal map, whose up is y, the picture's right is the world's x.
  const auto [nx, ny, nz] = normal_of(a);
  const bool is_horizontal = nx == 0 && ny == 0;
  constexpr double kBand = 5e-4;  // half of the relative width of the band
  std::string text = "<scene version=\"3.0.0\"><sensor type=\"powermap\"><transform name=\"to_world\">";
  text += fmt::format("<scale x=\"{:.9g}\" y=\"{:.9g}\"/>", 0.5 * a.size[0], 0.5 * a.size[1]);
  text += "<lookat " + vector_text("origin", a.plane[0], a.plane[1], a.plane[2]) + " " +
          vector_text("target", a.plane[0] + nx, a.plane[1] + ny, a.plane[2] + nz) +
          (is_horizontal ? " up=\"0, 1, 0\"" : " up=\"0, 0, 1\"") + "/></transform>";
  text += fmt::format(
      "<film type=\"hdrfilm\"><integer name=\"width\" value=\"{}\"/><integer name=\"height\" value=\"{}\"/>"
      "<string name=\"wavelength_min\" value=\"{:.9g}\"/><string name=\"wavelength_max\" value=\"{:.9g}\"/>"
      "<string name=\"response\" value=\"uniform\"/><string name=\"component_format\" value=\"float32\"/>"
      "<rfilter type=\"box\"/></film><sampler type=\"sobol\"><integer name=\"sample_count\" value=\"64\"/></sampler>"
      "</sensor>",
      std::max(1L, std::lround(a.size[0] / cell)), std::max(1L, std::lround(a.size[1] / cell)),
      nm * (1 - kBand), nm * (1 + kBand));
  // Intensity by which each transmitter radiates 1 W over the band, uniformly in all directions.
  const double intensity = 1 / (4 * M_PI * 2 * kBand * nm);
  for (std::size_t i = 0; i + 2 < a.transmitters.size(); i += 3)
    text += fmt::format(
        "<emitter type=\"point\"><point name=\"position\" x=\"{:.9g}\" y=\"{:.9g}\" z=\"{:.9g}\"/>"
        "<spectrum name=\"intensity\" value=\"{:.9g}\"/></emitter>",
        a.transmitters[i], a.transmitters[i + 1], a.transmitters[i + 2], intensity);
  return text + "<include filename=\"$" + kSceneFile + "\"/></scene>";
}

/// Prints notes about light that a map on a plane does not measure.
void note_missing_light(const Arguments& a, const LoadedScene& loaded) {
  const std::string integrator = loaded.integrator->properties().type();
  if (integrator != "ptracer")
    tell(
        "note: {} finds no light of a transmitter by way of walls that are mirrors, as slabs are: ptracer does\n",
        integrator);
  const std::array<double, 3> n = normal_of(a);
  const double size = std::max(a.size[0], a.size[1]);
  if (a.cell > 0) {
    const Film& film = loaded.scene->sensor().film();
    const double width = a.size[0] / film.width(), height = a.size[1] / film.height();
    if (std::max(std::abs(width - a.cell), std::abs(height - a.cell)) > 1e-6 * a.cell)
      tell("note: --size is no multiple of --cell: cells are {:.6g} wide and {:.6g} high\n", width, height);
  }
  for (std::size_t i = 0; i + 2 < a.transmitters.size(); i += 3) {
    double height = 0;
    for (std::size_t k = 0; k < 3; ++k) height += (a.transmitters[i + k] - a.plane[k]) * n[k];
    if (std::abs(height) < 1e-3 * size)
      tell(
          "note: --transmitter {:g} {:g} {:g} lies in the plane of the map, or nearly: light that mirrors keep in the "
          "plane is not found there. Move the plane by a hundredth of its size or more\n",
          a.transmitters[i], a.transmitters[i + 1], a.transmitters[i + 2]);
  }
}

LoadedScene load_map(const Arguments& a) {
  LoadOptions load;
  load.defines = split_defines(a.defines);
  const bool has_segments = a.diffraction_model == "segments";  // `path` finds more of a lamp's light
  load.integrator = has_segments && a.integrator.empty() ? "path" : a.integrator;
  if (a.max_depth != kNotGiven && a.max_depth < -1)
    throw Error(fmt::format("--max-depth {}: must be at least -1, which is no limit", a.max_depth));
  if (a.max_depth != kNotGiven)
    load.integrator_parameters.push_back({"integer", "max_depth", std::to_string(a.max_depth)});
  if (a.diffraction || !a.diffraction_model.empty())
    load.integrator_parameters.push_back({"boolean", "diffraction", "true"});
  if (!a.diffraction_model.empty())
    load.integrator_parameters.push_back({"string", "diffraction_model", a.diffraction_model});
  if (a.plane.empty()) {
    for (const auto& [option, given] :
         {std::pair("--size", !a.size.empty()), std::pair("--normal", !a.normal.empty()),
          std::pair("--cell", a.cell != 0), std::pair("--frequency", !a.frequency.empty()),
          std::pair("--transmitter", !a.transmitters.empty())})
      if (given) throw Error(std::string(option) + ": is for maps by --plane");
    return load_scene(a.scene, load);
  }
  // light tracing finds light of a point that arrives by way of mirrors
  load.fallback_integrator = "ptracer";
  load.radio_materials = true;
  load.defines.emplace_back(kSceneFile, std::filesystem::path(a.scene).filename().string());
  return load_scene_from_string(scene_with_plane(a), std::filesystem::path(a.scene).parent_path() / "--plane",
                                load);
}

int powermap(const Arguments& a) {
  if (a.spp == 0 || a.spp < -1)
    throw Error(fmt::format("--spp {}: at least one sample per cell is needed", a.spp));
  if (a.seed < -1) throw Error(fmt::format("--seed {}: must not be negative", a.seed));
  if (a.replicates < 1) throw Error(fmt::format("--replicates {}: must be at least 1", a.replicates));
  if (a.threads < 0 || a.threads > 4096)
    throw Error(fmt::format("--threads {}: must be between 1 and 4096 (0: all cores)", a.threads));
  if (!(a.time_s >= 0)) throw Error(fmt::format("--time {}: must not be negative", a.time_s));
  const std::optional<double> min_db = end_of_colours("--min-db", a.min_db),
                              max_db = end_of_colours("--max-db", a.max_db);
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
  if (output.empty()) output = default_output(a.scene, ".exr");
  if (output.extension() != ".exr")
    throw Error("-o " + output.string() + ": the output is an .exr file (a .png is written beside it)");
  const std::filesystem::path png = std::filesystem::path(output).replace_extension(".png");
  const OutputLock lock(output);
  require_writable(output);
  require_writable(png);

  const LoadedScene loaded = load_map(a);
  if (!a.quiet)
    for (const auto& note : loaded.notes) tell("note: {}\n", note);
  if (!a.quiet && !a.plane.empty()) note_missing_light(a, loaded);
  require_power_map(*loaded.scene);
  RenderOptions options;
  if (a.spp > 0) options.end = a.spp;
  if (a.seed >= 0) options.seed = std::uint64_t(a.seed);
  options.threads = a.threads, options.replicates = a.replicates, options.time_limit_s = a.time_s;
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
  const Image picture = as_image(maps);
  attributes.strings[kChannelsAttribute] =
      channels_attribute(picture.channels, meanings_of(picture.channels));
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
  options.add("scene", a->scene, "scene file whose sensor is a powermap, or any with --plane").required();
  options.add("-o,--output", a->output,
              "output .exr (default: the scene's name, in the working folder), with a .png of the same name");
  options.add("-D,--define", a->defines, "set a $name of the scene: -D name=value").takes_each_time(1);
  options.add("--spp", a->spp, "samples per cell (default: the scene's sample_count)");
  options.add("--seed", a->seed, "seed of the samples (default: the scene's)");
  options.add("--threads", a->threads, "threads (default: all cores); the map does not depend on it");
  options.add("--time", a->time_s, "stop after this many seconds, on whole sample blocks");
  options.add("--replicates", a->replicates,
              "number of independent maps; stores their mean and its standard error in dB");
  options.add("--integrator", a->integrator, "replace the scene's integrator: ptracer, path, bdpt");
  options.add("--max-depth", a->max_depth, "replace the integrator's max_depth");
  options.add("--diffraction", a->diffraction, "edges of shapes diffract");
  options
      .add(
          "--diffraction-model", a->diffraction_model,
          "how edges diffract, beams or segments; segments selects the integrator path unless --integrator is given")
      .one_of({"beams", "segments"});
  options
      .add(
          "--plane", a->plane,
          "X Y Z: map on a plane with this centre, instead of the scene's sensor; needs --size and --frequency. "
          "BSDFs with ids such as mat-itu_concrete become slabs of that material, 0.1 m thick")
      .takes(3);
  options.add("--size", a->size, "W H: width and height of the plane, in the scene's units").takes(2);
  options
      .add("--normal", a->normal,
           "X Y Z: normal of the plane (default: 0 0 1); z is up in the picture of any other plane")
      .takes(3);
  options.add("--cell", a->cell, "side of a cell of the plane (default: 200 cells along the longer side)");
  options.add("--frequency", a->frequency, "frequency or wavelength of the map on a plane, such as 3.5GHz");
  options
      .add("--transmitter", a->transmitters, "X Y Z: adds an isotropic transmitter of 1 W; may be repeated")
      .takes_each_time(3);
  options.add(
      "--power", a->power,
      "total power of all emitters in the band, \"2W\", \"500mW\" or \"33dBm\" (default: the scene's)");
  options.add("--show", a->show, "quantity of the PNG (default: dBm with --power, else relative)")
      .one_of({"relative", "dBm"});
  options.add("--min-db", a->min_db, "lower limit of the PNG's colours [dB] (default: by the values)")
      .takes(1);
  options
      .add("--max-db", a->max_db, "upper limit of the PNG's colours [dB], at most 1000 above the lower one")
      .takes(1);
  options.add("-q,--quiet", a->quiet, "print errors only");
  return [a] { return powermap(*a); };
}

AUREOLE_COMMAND("powermap", "Power on a plane or a shape: W/m^2, dB relative to free space, dBm", declare);

}  // namespace
}  // namespace aureole

// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/radio/power_map_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "aureole/core/error.h"
#include "aureole/core/units.h"
#include "aureole/film/film.h"

namespace aureole {

namespace {

void add_map_channel(Image& image, std::size_t channel, const std::vector<double>& values) {
  for (std::size_t i = 0; i < values.size(); ++i)
    image.pixels[i * image.channels.size() + channel] = float(values[i]);
}

std::string vector_text(const char* name, double x, double y, double z) {
  return fmt::format("{}=\"{:.9g}, {:.9g}, {:.9g}\"", name, x, y, z);
}

/// The unit normal of the plane.
std::array<double, 3> normal_of_plane(const PowerMapSettings& a) {
  if (a.normal.empty()) return {0, 0, 1};
  const double length = std::hypot(a.normal[0], a.normal[1], a.normal[2]);
  if (!(length > 1e-6 && std::isfinite(length)))
    throw Error(
        fmt::format("--normal {:g} {:g} {:g}: is no direction", a.normal[0], a.normal[1], a.normal[2]));
  return {a.normal[0] / length, a.normal[1] / length, a.normal[2] / length};
}

/// The name by which the scene with the plane includes the scene of the user, whose name may have any characters.
constexpr const char* kSceneFile = "scene_of_the_plane";

/// Returns a scene that adds a map on a plane and transmitters to that of the user.
std::string scene_with_plane(const PowerMapSettings& a) {
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
  // The picture's right is the world's x for a horizontal map, whose up is y.
  const auto [nx, ny, nz] = normal_of_plane(a);
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
  // Each transmitter radiates 1 W over the band, in all directions alike.
  const double intensity = 1 / (4 * M_PI * 2 * kBand * nm);
  for (std::size_t i = 0; i + 2 < a.transmitters.size(); i += 3)
    text += fmt::format(
        "<emitter type=\"point\"><point name=\"position\" x=\"{:.9g}\" y=\"{:.9g}\" z=\"{:.9g}\"/>"
        "<spectrum name=\"intensity\" value=\"{:.9g}\"/></emitter>",
        a.transmitters[i], a.transmitters[i + 1], a.transmitters[i + 2], intensity);
  return text + "<include filename=\"$" + kSceneFile + "\"/></scene>";
}

}  // namespace

PowerMapSource power_map_source(const PowerMapSettings& a) {
  PowerMapSource source;
  LoadOptions& load = source.load;
  load.defines = a.defines;
  load.tables = a.tables, load.check_files = a.check_files;
  const bool has_segments = a.diffraction_model == "segments";  // finds more of a lamp's light by `path`
  load.integrator = has_segments && a.integrator.empty() ? "path" : a.integrator;
  if (a.max_depth && *a.max_depth < -1)
    throw Error(fmt::format("--max-depth {}: must be at least -1, which is no limit", *a.max_depth));
  if (a.max_depth)
    load.integrator_parameters.push_back({"integer", "max_depth", std::to_string(*a.max_depth)});
  if (a.diffraction || !a.diffraction_model.empty())
    load.integrator_parameters.push_back({"boolean", "diffraction", "true"});
  if (!a.diffraction_model.empty())
    load.integrator_parameters.push_back({"string", "diffraction_model", a.diffraction_model});
  if (!a.polarisation.empty())
    load.integrator_parameters.push_back({"string", "diffraction_polarisation", a.polarisation});
  if (a.plane.empty()) {
    for (const auto& [option, given] :
         {std::pair("--size", !a.size.empty()), std::pair("--normal", !a.normal.empty()),
          std::pair("--cell", a.cell != 0), std::pair("--frequency", !a.frequency.empty()),
          std::pair("--transmitter", !a.transmitters.empty())})
      if (given) throw Error(std::string(option) + ": is for maps by --plane");
    source.file = a.scene;
    return source;
  }
  // `ptracer` finds light of a point by way of walls that are mirrors; edges diffract by the model "segments".
  load.fallback_integrator = a.diffraction && a.diffraction_model.empty() ? "path" : "ptracer";
  load.radio_materials = true;
  load.defines.emplace_back(kSceneFile, std::filesystem::path(a.scene).filename().string());
  source.text = scene_with_plane(a);
  source.file = std::filesystem::path(a.scene).parent_path() / "--plane";
  return source;
}

LoadedScene load_power_map(const PowerMapSettings& settings) {
  const PowerMapSource source = power_map_source(settings);
  LoadedScene loaded = source.text ? load_scene_from_string(*source.text, source.file, source.load)
                                   : load_scene(source.file, source.load);
  return loaded;
}

std::vector<std::string> power_map_notes(const PowerMapSettings& a, const LoadedScene& loaded) {
  std::vector<std::string> notes;
  if (a.plane.empty()) return notes;
  const std::string integrator = loaded.integrator->properties().type();
  if (integrator != "ptracer")
    notes.push_back(
        integrator +
        " finds no light of a transmitter by way of walls that are mirrors, as slabs are: --integrator ptracer "
        "does, also with --diffraction");
  const std::array<double, 3> n = normal_of_plane(a);
  const double size = std::max(a.size[0], a.size[1]);
  if (a.cell > 0) {
    const Film& film = loaded.scene->sensor().film();
    const double width = a.size[0] / film.width(), height = a.size[1] / film.height();
    if (std::max(std::abs(width - a.cell), std::abs(height - a.cell)) > 1e-6 * a.cell)
      notes.push_back(fmt::format("--size is no multiple of --cell: cells are {:.6g} wide and {:.6g} high",
                                  width, height));
  }
  for (std::size_t i = 0; i + 2 < a.transmitters.size(); i += 3) {
    double height = 0;
    for (std::size_t k = 0; k < 3; ++k) height += (a.transmitters[i + k] - a.plane[k]) * n[k];
    if (std::abs(height) < 1e-3 * size)
      notes.push_back(fmt::format(
          "--transmitter {:g} {:g} {:g} lies in the plane of the map, or nearly: light that mirrors keep in the "
          "plane is not found there. Move the plane by a hundredth of its size or more",
          a.transmitters[i], a.transmitters[i + 1], a.transmitters[i + 2]));
  }
  return notes;
}

/// Text such as "28 GHz" for wavelengths above 0.1 mm, else in nanometres.
std::string band_text(const PowerMap& map) {
  const double ghz = 299792458.0 / map.wavelength_m * 1e-9;
  return ghz < 3000 ? fmt::format("{:.4g} GHz", ghz) : fmt::format("{:.5g} nm", map.wavelength_m * 1e9);
}

Image power_map_image(const std::vector<PowerMap>& maps) {
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
    add_map_channel(image, channel++, map.density);
    add_map_channel(image, channel++, map.free);
    add_map_channel(image, channel++, map.relative_db());
    add_map_channel(image, channel++, map.received_dbm());
    if (has_errors) add_map_channel(image, channel++, map.error_db());
  }
  return image;
}

std::vector<std::string> power_map_meanings(const std::vector<std::string>& channels) {
  std::vector<std::string> meanings;
  for (const std::string& name : channels)
    meanings.emplace_back(name.ends_with("density")        ? "power density, W/m^2"
                          : name.ends_with("free_space")   ? "power density without any shape, W/m^2"
                          : name.ends_with("relative_dB")  ? "density over free_space, dB"
                          : name.ends_with("received_dBm") ? "power that an isotropic antenna receives, dBm"
                                                           : "standard error of relative_dB, dB");
  return meanings;
}

}  // namespace aureole

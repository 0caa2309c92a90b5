// SPDX-License-Identifier: Apache-2.0
// aureole lightfield: pictures from a light field, refocused and from other places.
#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <optional>

#include "aureole/core/error.h"
#include "aureole/core/letter_case.h"
#include "aureole/core/output_file.h"
#include "aureole/instrument/lightfield/light_field.h"
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

struct LightFieldArguments {
  std::string target, output, field;
  std::vector<std::string> defines;
  std::optional<std::int64_t> spp, seed;
  std::optional<double> focus;
  int threads = 0;
  double diameter = 0;
  std::vector<double> at;
  bool quiet = false;
};

/// Renders the light field of a scene, and says what its channels hold.
LightField field_of_scene(const LightFieldArguments& a, std::string& meanings) {
  const LoadedScene loaded = load_measured_scene(a.target, a.defines, a.quiet);
  const Film& film = loaded.scene->film();
  LightField f;
  f.axes = light_field_axes(loaded.scene->sensor().properties(), film);
  RenderJob job(loaded, render_options(a.spp, a.seed, a.threads));
  run_to_end(job);
  f.mosaic = job.state().picture();
  meanings = channels_attribute(film.channel_names(), film.channel_meanings());
  return f;
}

/// R, G, B, or else the first channel, for display: a file has its channels in the order of their names.
Image colors_of_view(const Image& picture) {
  const bool is_colored = picture.channel("R") >= 0 && picture.channel("G") >= 0 && picture.channel("B") >= 0;
  Image colors{picture.width, picture.height, {"Y"}, {}, false};
  if (is_colored) colors.channels = {"R", "G", "B"};
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x)
      for (const std::string& name : colors.channels)
        colors.pixels.push_back(picture.at(x, y, is_colored ? std::size_t(picture.channel(name)) : 0));
  return colors;
}

void write_view(const std::filesystem::path& file, const Image& picture, const std::string& meanings) {
  ExrAttributes attributes;
  if (!meanings.empty()) attributes.strings[kChannelsAttribute] = meanings;
  write_exr(file, picture, ExrPixel::float32, attributes);
}

int lightfield(const LightFieldArguments& a) {
  check_sampling(a.spp, a.seed, a.threads);
  for (const double place : a.at)
    if (!std::isfinite(place)) throw Error(fmt::format("--at: {:g} is no place", place));
  if (a.focus && !(*a.focus > 0 && std::isfinite(*a.focus)))
    throw Error(fmt::format("--focus {:g}: the distance of focus must be positive", *a.focus));
  const bool is_scene = lower_extension(a.target) == ".xml";
  if (!is_scene)
    refuse_options({{"--spp", a.spp.has_value()},
                    {"--seed", a.seed.has_value()},
                    {"--threads", a.threads != 0},
                    {"--define", !a.defines.empty()},
                    {"--field", !a.field.empty()}},
                   "is for a scene, which is rendered; a light field is done");
  std::filesystem::path output = a.output;
  if (output.empty()) output = std::filesystem::path(a.target).stem().string() + "_view.png";
  if (lower_extension(output) != ".png" && lower_extension(output) != ".exr")
    throw Error("-o " + output.string() + ": the output is a .png or an .exr file");
  std::filesystem::path field_file = a.field;
  if (is_scene && field_file.empty())
    field_file = std::filesystem::path(a.target).stem().string() + "_field.exr";
  if (is_scene && lower_extension(field_file) != ".exr")
    throw Error("--field " + field_file.string() + ": the light field is an .exr file");
  require_writable(output);
  if (is_scene) require_writable(field_file);
  add_outputs({{"-o", output}});
  if (is_scene) add_outputs({{"--field", field_file}});

  LightField field;
  std::string meanings;
  if (is_scene) {
    field = field_of_scene(a, meanings);
    ExrAttributes attributes;
    attributes.strings[kChannelsAttribute] = meanings;
    attributes.strings[kLightFieldAttribute] = field.axes.text();
    write_exr(field_file, field.mosaic, ExrPixel::float32, attributes);
  } else {
    ExrAttributes attributes;
    Image picture = read_picture(a.target, &attributes);
    const auto found = attributes.strings.find(kLightFieldAttribute);
    meanings = attributes.strings[kChannelsAttribute];
    field =
        light_field_of(std::move(picture), found == attributes.strings.end() ? "" : found->second, a.target);
  }
  const double focus = a.focus.value_or(field.axes.plane_distance);
  const double x = a.at.empty() ? 0 : a.at[0], y = a.at.empty() ? 0 : a.at[1];
  if (2 * std::abs(x) > field.axes.aperture_width || 2 * std::abs(y) > field.axes.aperture_height)
    throw Error(fmt::format("--at {:g},{:g}: lies outside of the light field, which reaches to {:g},{:g}", x,
                            y, 0.5 * field.axes.aperture_width, 0.5 * field.axes.aperture_height));
  const Image picture = light_field_picture(field, x, y, a.diameter, focus);
  if (lower_extension(output) == ".exr")
    write_view(output, picture, meanings);
  else
    write_png(output, display_picture(colors_of_view(picture)));
  if (!a.quiet) {
    fmt::print("{}\n", field.axes.text());
    if (is_scene) fmt::print("{}\n", field_file.string());
    fmt::print("{}\n", output.string());
  }
  return 0;
}

std::function<int()> declare_lightfield(CommandOptions& options) {
  auto a = std::make_shared<LightFieldArguments>();
  options
      .add("target", a->target,
           "scene (.xml) with the sensor \"lightfield\", which is rendered, or its light field (.exr)")
      .required();
  options.add("-o,--output", a->output, "picture, .png or .exr (default: the target's name with _view.png)");
  options.add("--field", a->field, "light field of a scene (default: the target's name with _field.exr)");
  options
      .add(
          "--at", a->at,
          "X,Y: place of the camera in the plane (s, t), from its middle, to the right and down (default: 0,0)")
      .separated_by(',')
      .takes(2);
  options
      .add("--diameter", a->diameter,
           "diameter of the synthetic aperture; 0: a new view between the four nearest")
      .between(0, 1e9)
      .shows_default();
  options.add("--focus", a->focus, "distance of the plane in focus (default: that of the plane (u, v))");
  options.add("-D,--define", a->defines, "set a $name of the scene: -D name=value").takes_each_time(1);
  add_cache_option(options);
  options.add("--spp", a->spp, "samples per pixel (default: the scene's sample_count)");
  options.add("--seed", a->seed, "seed of the samples (default: the scene's)");
  options.add("--threads", a->threads, "threads (default: all cores)");
  options.add("-q,--quiet", a->quiet, "print results and errors only");
  return [a] { return lightfield(*a); };
}

AUREOLE_COMMAND("lightfield",
                "Pictures from a light field: refocused, with another aperture, from other places",
                declare_lightfield);

}  // namespace
}  // namespace aureole

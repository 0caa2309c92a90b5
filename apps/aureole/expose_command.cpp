// SPDX-License-Identifier: Apache-2.0
// aureole expose: the raw picture that the sensor of a digital camera reads.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>

#include "aureole/core/error.h"
#include "aureole/core/letter_case.h"
#include "aureole/core/output_file.h"
#include "aureole/instrument/detector/camera_exposure.h"
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

struct ExposeArguments {
  std::string target, camera, mosaic, aperture, efficiency, electrons;
  std::vector<std::string> outputs, defines;
  std::optional<std::int64_t> spp, seed;
  std::int64_t frame = 1, sensor = 1;
  int threads = 0, frames = 1;
  std::optional<double> exposure, f_number, pitch, transmission, full_well, read_noise, dark_current, dsnu,
      prnu, gain, black, bits;
  bool quiet = false;
};

void replace(double& value, const std::optional<double>& given) { value = given.value_or(value); }

CameraModel camera_of(const ExposeArguments& a) {
  CameraModel c = a.camera.empty() ? CameraModel() : read_camera(a.camera);
  optics::DetectorModel& d = c.detector;
  replace(c.f_number, a.f_number), replace(c.pixel_pitch_um, a.pitch),
      replace(c.transmission, a.transmission);
  replace(d.full_well, a.full_well), replace(d.read_noise, a.read_noise),
      replace(d.dark_current, a.dark_current);
  replace(d.dark_nonuniformity, a.dsnu), replace(d.photo_nonuniformity, a.prnu), replace(d.gain, a.gain);
  replace(d.black_level, a.black);
  if (a.bits) {
    if (!(*a.bits == std::floor(*a.bits) && std::abs(*a.bits) < 1e6))
      throw Error(fmt::format("--bits {:g}: must be a whole number", *a.bits));
    d.bits = int(*a.bits);
  }
  if (!a.aperture.empty())
    c.aperture = a.aperture == "sine" ? optics::ApertureLaw::sine : optics::ApertureLaw::thin;
  if (!a.mosaic.empty()) c.mosaic = optics::ColorMosaic::named(a.mosaic);
  if (!a.efficiency.empty()) {
    char* end = nullptr;
    const double value = std::strtod(a.efficiency.c_str(), &end);
    if (*end == 0 && !(value >= 0 && value <= 1))
      throw Error(fmt::format("--efficiency {}: a quantum efficiency lies between 0 and 1", a.efficiency));
    c.efficiency = *end == 0 ? std::vector{EfficiencyCurve::constant(value)} : read_efficiency(a.efficiency);
  }
  check_camera(c);
  return c;
}

/// A picture with the exposure of the scene, if that is known.
struct ExposedPicture {
  SpectralPicture picture;
  double exposure = 0;
};

/// The exposure in seconds: that of the option, or else that of the scene. Throws Error where neither is positive.
double exposure_of(const ExposeArguments& a, double of_scene) {
  const double exposure = a.exposure.value_or(of_scene);
  if (!(exposure > 0))
    throw Error(a.exposure ? fmt::format("--exposure {:g}: must be positive, in seconds", exposure)
                           : "--exposure: is needed, in seconds: the target states no shutter times");
  return exposure;
}

ExposedPicture picture_of_scene(const ExposeArguments& a) {
  const LoadedScene loaded = load_measured_scene(a.target, a.defines, a.quiet);
  const Film& film = loaded.scene->film();
  const std::vector<std::string> names = film.channel_names();
  const std::string meanings = channels_attribute(names, film.channel_meanings());
  // The exposure and the channels of the film are asked for before the picture is rendered.
  const double duration = loaded.scene->sensor().sensor->exposure().duration();
  exposure_of(a, duration);
  spectral_picture({.width = 1, .height = 1, .channels = names, .pixels = std::vector<float>(names.size())},
                   meanings, a.target);
  RenderJob job(loaded, render_options(a.spp, a.seed, a.threads));
  run_to_end(job);
  return {spectral_picture(job.state().picture(), meanings, a.target), duration};
}

ExposedPicture picture_of_file(const ExposeArguments& a) {
  refuse_options({{"--spp", a.spp.has_value()},
                  {"--seed", a.seed.has_value()},
                  {"--threads", a.threads != 0},
                  {"--define", !a.defines.empty()}},
                 "is for a scene, which is rendered; a picture is done");
  ExrAttributes attributes;
  const Image picture = read_picture(a.target, &attributes);
  const auto found = attributes.strings.find(kChannelsAttribute);
  return {spectral_picture(picture, found == attributes.strings.end() ? "" : found->second, a.target), 0};
}

/// The name of a frame's file: "picture.dng" for one frame, "picture_0003.dng" for several.
std::filesystem::path frame_name(const std::filesystem::path& file, std::int64_t frame, int frames) {
  if (frames == 1) return file;
  std::filesystem::path name = file;
  name.replace_filename(fmt::format("{}_{:04}{}", file.stem().string(), frame, file.extension().string()));
  return name;
}

int expose(const ExposeArguments& a) {
  check_sampling(a.spp, a.seed, a.threads);
  if (a.frame < 0 || a.sensor < 0) throw Error("--frame and --sensor: must not be negative");
  if (a.frame > 1'000'000'000'000) throw Error(fmt::format("--frame {}: must be at most 10^12", a.frame));
  if (a.frames < 1) throw Error(fmt::format("--frames {}: at least one is needed", a.frames));
  if (a.frames > 1'000'000) throw Error(fmt::format("--frames {}: at most 1000000 are written", a.frames));
  if (a.exposure) exposure_of(a, 0);
  const bool is_scene = lower_extension(a.target) == ".xml";
  std::vector<std::filesystem::path> files(a.outputs.begin(), a.outputs.end());
  if (files.empty()) files.emplace_back(std::filesystem::path(a.target).stem().string() + ".dng");
  for (const std::filesystem::path& file : files) {
    if (const std::string kind = lower_extension(file); kind != ".dng" && kind != ".tif" && kind != ".tiff")
      throw Error("-o " + file.string() + ": the output is a .dng, .tif or .tiff file");
    for (int i = 0; i < a.frames; ++i) {
      const std::filesystem::path name = frame_name(file, a.frame + i, a.frames);
      require_writable(name);
      add_outputs({{"-o", name}});
    }
  }
  CameraModel camera;
  try {
    camera = camera_of(a);
  } catch (const std::domain_error& e) {
    throw Error(std::string("--mosaic: ") + e.what());
  }
  std::optional<ColorCalibration> colors;
  if (!camera.mosaic.is_mono()) colors = calibrate_colors(camera);

  const ExposedPicture found = is_scene ? picture_of_scene(a) : picture_of_file(a);
  const SpectralPicture& picture = found.picture;
  const double exposure = exposure_of(a, found.exposure);
  if (picture.is_irradiance)
    for (const auto& [option, given] :
         {std::pair("--f-number", a.f_number.has_value()), std::pair("--aperture", !a.aperture.empty())})
      if (given) tell("note: {} has no effect: the picture is the irradiance on the film\n", option);
  const std::vector<double> electrons = mean_electrons(picture, camera, exposure);
  if (!a.electrons.empty()) {
    Image means{picture.width, picture.height, {"Y"}, {electrons.begin(), electrons.end()}, false};
    ExrAttributes attributes;
    attributes.strings[kChannelsAttribute] =
        channels_attribute({"Y"}, {"mean number of electrons that light frees"});
    write_exr(a.electrons, means, ExrPixel::float32, attributes);
  }
  double sum = 0, signal = 0;
  std::size_t saturated = 0;
  for (int i = 0; i < a.frames; ++i) {
    const std::int64_t frame = a.frame + i;
    RawImage raw = read_sensor(electrons, picture.width, picture.height, camera, exposure,
                               {std::uint64_t(a.sensor), std::uint64_t(frame)});
    if (colors) raw.color_matrix = colors->from_xyz, raw.neutral = colors->white;
    for (const std::uint16_t v : raw.values) signal += v, saturated += v >= raw.white_level;
    for (const std::filesystem::path& file : files) {
      const std::filesystem::path name = frame_name(file, frame, a.frames);
      lower_extension(file) == ".dng" ? write_dng(name, raw) : write_raw_tiff(name, raw);
      if (!a.quiet) fmt::print("{}\n", name.string());
    }
  }
  for (const double e : electrons) sum += e;
  const double count = double(electrons.size()), mean = sum / count;
  const optics::DetectorModel& d = camera.detector;
  fmt::print("exposure {:g} s: {:.5g} electrons in the mean, {:.5g} at most; a pixel is full at {:.5g}\n",
             exposure, mean, *std::max_element(electrons.begin(), electrons.end()), d.saturation());
  fmt::print("digital numbers: {:.5g} in the mean, {:.3g} % of the pixels are saturated\n",
             signal / (count * a.frames), 100 * double(saturated) / (count * a.frames));
  const double dark = d.dark_current * exposure;
  fmt::print("signal to noise at the mean: {:.4g}; noise in the dark: {:.4g} electrons\n",
             mean * d.gain / std::sqrt(d.temporal_variance(mean + dark)),
             std::sqrt(d.temporal_variance(dark)) / d.gain);
  if (colors)
    fmt::print("matrix of colours on 24 patches under D65: CIEDE2000 {:.2f} in the mean, {:.2f} at most\n",
               colors->mean_delta_e, colors->largest_delta_e);
  return 0;
}

std::function<int()> declare_expose(CommandOptions& options) {
  auto a = std::make_shared<ExposeArguments>();
  options
      .add(
          "target", a->target,
          "scene (.xml), which is rendered, or a picture (.exr), with a \"specfilm\" of spectral bins: the radiance, or the "
          "irradiance on the film of a \"lens\"")
      .required();
  options
      .add("-o,--output", a->outputs,
           "raw picture, .dng or 16-bit .tif; may be repeated (default: the target's name with .dng)")
      .takes_each_time(1);
  options
      .add("--camera", a->camera,
           "camera (.json): keys such as those options, with \"efficiency\" the name of a table")
      .names_input();
  options.add("--exposure", a->exposure,
              "exposure in seconds (default: from shutter_open to shutter_close of the scene)");
  options.add("-D,--define", a->defines, "set a $name of the scene: -D name=value").takes_each_time(1);
  add_cache_option(options);
  options.add("--spp", a->spp, "samples per pixel (default: the scene's sample_count)");
  options.add("--seed", a->seed, "seed of the samples (default: the scene's)");
  options.add("--threads", a->threads, "threads (default: all cores)");
  options.add("--f-number", a->f_number, "f-number, for pictures of the radiance (default: 2.8)");
  options
      .add(
          "--aperture", a->aperture,
          "what the f-number means: sine, pi/(4 N^2) sr (the default); thin, pi sin^2(atan(1/(2 N))) sr of a thin lens")
      .one_of({"sine", "thin"});
  options.add("--pixel-pitch", a->pitch, "distance of neighbouring pixels in um (default: 4)");
  options.add("--transmission", a->transmission, "of lens and filters (default: 1)");
  options
      .add(
          "--efficiency", a->efficiency,
          "quantum efficiency: a number (default: 0.5), or a table of wavelengths in nm and one column, or three of red, "
          "green and blue")
      .names_input();
  options.add("--mosaic", a->mosaic, "filters: mono (the default), rggb, bggr, grbg, gbrg or xtrans");
  options.add("--full-well", a->full_well, "electrons that a pixel holds (default: 20000)");
  options.add("--read-noise", a->read_noise, "standard deviation of reading in electrons (default: 3)");
  options.add("--dark-current", a->dark_current, "electrons per second without light (default: 0)");
  options.add("--dsnu", a->dsnu, "standard deviation of the pixels' offsets in electrons (default: 0)");
  options.add("--prnu", a->prnu, "standard deviation of the pixels' responses over their mean (default: 0)");
  options.add("--gain", a->gain, "digital numbers per electron (default: 0.2)");
  options.add("--black", a->black, "digital number of the dark (default: 64)");
  options.add("--bits", a->bits, "bits of the converter (default: 12)");
  options.add("--sensor", a->sensor, "number of the sensor, which has its own fixed pattern").shows_default();
  options.add("--frame", a->frame, "number of the frame, which has its own noise").shows_default();
  options.add("--frames", a->frames, "how many frames are written, with their numbers in their names")
      .shows_default();
  options.add("--electrons", a->electrons, "also write the mean numbers of electrons (.exr)").names_output();
  options.add("-q,--quiet", a->quiet, "print results and errors only");
  return [a] { return expose(*a); };
}

AUREOLE_COMMAND("expose", "The raw picture of a digital camera: electrons, noise, mosaic; DNG and TIFF",
                declare_expose);

}  // namespace
}  // namespace aureole

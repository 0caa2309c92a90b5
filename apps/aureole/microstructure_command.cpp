// SPDX-License-Identifier: Apache-2.0
// aureole microstructure: finds scatterers in microscope pictures, and writes their statistics and a material
// made of them.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "aureole/core/error.h"
#include "aureole/core/units.h"
#include "aureole/instrument/microscopy/microstructure.h"
#include "aureole/instrument/report/microstructure_report.h"
#include "command.h"
#include "messages.h"

namespace aureole {
namespace {

struct Options {
  std::vector<std::string> images, masks, excludes;
  std::string pixel_size, output, polarity = "auto", background = "auto", denoise = "auto",
                                  encoding = "linear";
  std::string correlation_radius, scatterer = "auto", int_ior;
  double background_scale = 0, smooth = 0, min_radius = 2;
  bool fill_holes = false, no_overlays = false;
  int resamples = 300;
  std::uint64_t seed = 1;
};

template <class T>
T choose(const std::string& option, const std::string& value,
         const std::vector<std::pair<std::string, T>>& choices) {
  std::vector<std::string> names;
  for (const auto& [name, v] : choices) {
    if (name == value) return v;
    names.push_back(name);
  }
  throw Error(option + ": unknown value \"" + value + "\"" + did_you_mean(value, names) + "; use " +
              fmt::format("{}", fmt::join(names, ", ")));
}

double positive_length(const std::string& option, const std::string& text) {
  try {
    const double v = parse_length_m(text);
    if (!(v > 0)) throw Error("\"" + text + "\" is not positive");
    return v;
  } catch (const Error& e) {
    throw Error(option + ": " + e.message());
  }
}

std::array<int, 4> rectangle(const std::string& text) {
  std::array<int, 4> out{};
  size_t from = 0;
  for (int i = 0; i < 4; ++i) {
    const size_t comma = text.find(',', from);
    if ((comma == std::string::npos) != (i == 3))
      throw Error("--exclude " + text + ": write x,y,width,height");
    try {
      const double v = parse_number(std::string_view(text).substr(from, comma - from));
      if (v != std::floor(v) || std::abs(v) > 1e6)
        throw Error("\"" + text + "\" needs whole numbers of pixels");
      out[size_t(i)] = int(v);
    } catch (const Error& e) {
      throw Error("--exclude " + text + ": " + e.message());
    }
    from = comma + 1;
  }
  return out;
}

std::string interval(const Estimate& e, double unit, const char* name) {
  return fmt::format("{:.4g} [{:.4g}, {:.4g}]{}", e.value / unit, e.low / unit, e.high / unit, name);
}

int microstructure(const Options& o) {
  MicrostructureOptions options;
  SegmentationOptions& s = options.segmentation;
  s.polarity = choose<Polarity>(
      "--polarity", o.polarity,
      {{"auto", Polarity::automatic}, {"dark", Polarity::dark}, {"bright", Polarity::bright}});
  s.background = choose<Background>(
      "--background", o.background,
      {{"auto", Background::automatic}, {"morphology", Background::morphology}, {"none", Background::none}});
  s.denoise = choose<Denoise>("--denoise", o.denoise,
                              {{"auto", Denoise::automatic},
                               {"none", Denoise::none},
                               {"gaussian", Denoise::gaussian},
                               {"median", Denoise::median}});
  options.scatterer = choose<ScattererKind>("--scatterer", o.scatterer,
                                            {{"auto", ScattererKind::automatic},
                                             {"apertures", ScattererKind::apertures},
                                             {"discs", ScattererKind::discs},
                                             {"spheres", ScattererKind::spheres}});
  options.int_ior = o.int_ior;
  MicrographOptions reading;
  reading.srgb = choose<bool>("--encoding", o.encoding, {{"linear", false}, {"srgb", true}});
  if (!o.pixel_size.empty()) reading.pixel_m = positive_length("--pixel-size", o.pixel_size);
  if (!o.correlation_radius.empty())
    options.correlation_radius_m = positive_length("--correlation-radius", o.correlation_radius);
  if (!(o.background_scale >= 0 && o.background_scale < 1e5))
    throw Error("--background-scale must be positive");
  if (!(o.smooth >= 0 && o.smooth <= 20)) throw Error("--smooth must be in [0, 20] pixels");
  if (!(o.min_radius >= 0.5 && o.min_radius < 1e4)) throw Error("--min-radius must be at least 0.5 pixels");
  if (o.resamples < 20 || o.resamples > 100000) throw Error("--resamples must be in [20, 100000]");
  if (s.background == Background::morphology && o.background_scale == 0)
    throw Error(
        "--background morphology needs --background-scale, a length in pixels larger than the particles");
  s.background_scale = o.background_scale, s.smooth = o.smooth, s.min_radius = o.min_radius;
  s.fill_holes = o.fill_holes;
  options.resamples = o.resamples, options.seed = o.seed;
  for (const std::string& e : o.excludes) reading.exclude.push_back(rectangle(e));
  if (o.masks.size() > 1 && o.masks.size() != o.images.size())
    throw Error("--mask: give one for all images or one for each");

  OutputFolder folder(o.output, "result.json");
  const auto read = [&](size_t i) {
    MicrographOptions mine = reading;
    if (!o.masks.empty()) mine.mask = o.masks.size() == 1 ? o.masks[0] : o.masks[i];
    return read_micrograph(o.images[i], mine);
  };
  int number = 0;
  const auto visit = [&](const Micrograph& field, const Segmentation& found,
                         const std::vector<Particle>& particles) {
    if (!o.no_overlays)
      write_png(folder.path(fmt::format("overlay-{}.png", number)), overlay(field, found, particles));
    ++number;
  };
  const Microstructure m = analyse_microstructure(o.images.size(), read, options, visit);
  write_microstructure(m, folder);
  folder.commit();

  for (const FieldReport& f : m.fields)
    fmt::print("{}: {} particles whole, {} cut, {} too small; {} on {}, pixel {:.4g} um\n", f.name, f.whole,
               f.cut, f.too_small, f.bright ? "bright" : "dark", f.bright ? "dark" : "bright",
               f.pixel_m * 1e6);
  fmt::print("covered part        {}\n", interval(m.shape_fraction, 1, ""));
  fmt::print("area fraction       {}\n", interval(m.area_fraction, 1, ""));
  fmt::print("correlation radius  {}{}\n", interval(m.correlation_radius, 1e-6, " um"),
             m.correlation_radius_given ? " (given)" : "");
  fmt::print("number density      {}\n", interval(m.density, 1e6, " per mm^2"));
  fmt::print("mean radius         {}\n", interval(m.mean_radius, 1e-6, " um"));
  fmt::print("deviation           {}\n", interval(m.deviation, 1e-6, " um"));
  fmt::print("log-normal sigma    {}\n", interval(m.log_deviation, 1, ""));
  fmt::print("shape               {} (circularity {:.3f}, aspect {:.3f})\n", m.round ? "round" : "not round",
             m.circularity, m.aspect);
  for (const auto& notes : {m.choices, m.notes, measured_material(m).notes})
    for (const std::string& note : notes) tell("note: {}\n", note);
  fmt::print("written to {}\n", o.output);
  return 0;
}

std::function<int()> declare(CommandOptions& options) {
  auto o = std::make_shared<Options>();
  options.add("images", o->images, "fields of view of one sample: PNG, TIFF, ...").required();
  options.add("-o,--output", o->output, "folder to write; replaced if it holds an earlier result").required();
  options.add("--pixel-size", o->pixel_size, "side of a pixel, such as 0.2um (default: the TIFF's metadata)");
  options.add("--polarity", o->polarity, "auto, dark or bright particles").shows_default();
  options
      .add(
          "--scatterer", o->scatterer,
          "scatterers of the written material: apertures (openings in an opaque sheet), discs (opaque), spheres "
          "(transparent; need --int-ior), or auto: discs for dark particles, apertures for bright ones")
      .shows_default();
  options.add("--int-ior", o->int_ior,
              "index of refraction of spheres: a number or a material, such as water");
  options
      .add("--background", o->background,
           "uneven illumination: auto (smooth levels of particles and ground), morphology, none")
      .shows_default();
  options.add("--background-scale", o->background_scale,
              "in pixels, larger than particles (default: by their size)");
  options.add("--denoise", o->denoise, "auto, none, gaussian or median").shows_default();
  options.add("--smooth", o->smooth, "standard deviation of the Gaussian, pixels (default: by the noise)");
  options.add("--fill-holes", o->fill_holes, "fill particles whose centre looks like the ground");
  options.add("--min-radius", o->min_radius, "in pixels; smaller regions are dirt").shows_default();
  options.add("--mask", o->masks, "image whose black pixels are excluded; one, or one per image")
      .takes_each_time(1);
  options.add("--exclude", o->excludes, "excluded rectangle x,y,width,height in pixels; may be repeated")
      .takes_each_time(1);
  options.add("--correlation-radius", o->correlation_radius,
              "half the smallest distance of two centres (default: from the pair correlation)");
  options.add("--encoding", o->encoding, "linear (grey values are proportional to light) or srgb")
      .shows_default();
  options.add("--no-overlays", o->no_overlays, "do not write pictures of the particles found");
  options.add("--resamples", o->resamples, "number of bootstrap resamples").shows_default();
  options.add("--seed", o->seed, "seed of the bootstrap").shows_default();
  return [=] { return microstructure(*o); };
}

AUREOLE_COMMAND("microstructure",
                "Find the scatterers in microscope pictures and write their statistics as a material",
                declare);

}  // namespace
}  // namespace aureole

// SPDX-License-Identifier: Apache-2.0
// aureole goniophotometer: the luminous intensities of a modelled luminaire, or of a file, as IES and EULUMDAT files.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "aureole/core/error.h"
#include "aureole/core/output_file.h"
#include "aureole/instrument/photometry/goniophotometer_scene.h"
#include "aureole/instrument/report/svg_plot.h"
#include "aureole/render/job.h"
#include "command.h"
#include "measured_scene.h"
#include "messages.h"
#include "scene_loading.h"

namespace aureole {
namespace {

struct GonioArguments {
  std::string target, integrator, symmetry = "none", name, maker, plot;
  std::vector<std::string> defines, outputs;
  std::int64_t spp = 256, seed = -1;
  int threads = 0;
  double c_step = 15, gamma_step = 5, flux = 0, lamp_flux = 0, watts = 0;
  std::vector<double> down, along, opening;  // vectors of three numbers each, or empty
  bool quiet = false;
};

bool is_luminaire_file(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return char(std::tolower(c)); });
  return extension == ".ies" || extension == ".ldt";
}

Luminaire measure(const GonioArguments& a) {
  if (a.seed < -1) throw Error(fmt::format("--seed {}: must not be negative", a.seed));
  GoniophotometerSettings settings{a.target,    split_defines(a.defines), a.integrator, a.spp, a.c_step,
                                   a.gamma_step};
  if (!a.down.empty()) settings.down = a.down;
  settings.along = a.along, settings.tables = table_cache();
  const LoadedScene loaded = load_goniophotometer(settings);
  if (!a.quiet)
    for (const auto& note : loaded.notes) tell("note: {}\n", note);
  require_luminaire(*loaded.scene);
  RenderJob job(loaded, render_options(-1, a.seed, a.threads));
  run_to_end(job);

  GoniometryOptions how;
  how.symmetry = symmetry_of(a.symmetry);
  how.flux = a.flux, how.lamp_flux = a.lamp_flux, how.watts = a.watts;
  if (!a.opening.empty()) how.opening.size_m = {a.opening[0], a.opening[1], a.opening[2]};
  how.keywords = measurement_keywords(settings, a.name, a.maker);
  return measured_luminaire(job.state().picture(), how);
}

void print_luminaire(const GonioArguments& a, const Luminaire& l) {
  const LuminaireFigures f = luminaire_figures(l);
  const optics::IntensityDistribution& d = l.distribution;
  fmt::print("{}: {}, type {}, {} x {} angles", a.target, l.standard,
             l.type == optics::PhotometricType::a   ? "A"
             : l.type == optics::PhotometricType::b ? "B"
                                                    : "C",
             l.horizontal_count, l.vertical_count);
  fmt::print("{}\n", l.symmetry.empty() ? "" : ", symmetry " + l.symmetry);
  fmt::print("  {}\n", flux_balance(l).text());
  if (l.type == optics::PhotometricType::c)
    fmt::print("  {:.1f} % of the flux goes down (gamma below 90 degrees)\n",
               f.flux > 0 ? 100 * f.downward_flux / f.flux : 0);
  fmt::print(
      "  largest intensity {:.6g} cd at azimuth {:g}, polar angle {:g} degrees; {:.6g} cd at both angles zero\n",
      f.peak, f.peak_c, f.peak_gamma, d.intensity({0, 0, 1}));
  if (l.type == optics::PhotometricType::c && f.beam[0] > 0 && f.beam[1] > 0)
    fmt::print("  full width at half of that: {:.1f} degrees in C 0-180, {:.1f} in C 90-270\n", f.beam[0],
               f.beam[1]);
  const auto& s = l.opening.size_m;
  if (l.opening.is_point())
    fmt::print("  luminous opening: a point\n");
  else
    fmt::print("  luminous opening: {:.4g} m along, {:.4g} m across, {:.4g} m high\n", s[0], s[1], s[2]);
}

std::string intensity_plot(const GonioArguments& a, const Luminaire& l) {
  Plot plot{a.target, "gamma, degrees", "cd", {}, false};
  const std::pair<double, const char*> planes[] = {
      {0, "#2050c0"}, {90, "#208030"}, {180, "#c03020"}, {270, "#806020"}};
  for (const auto& [c, colour] : planes) {
    PlotSeries series;
    for (int i = 0; i <= 360; ++i)
      series.x.push_back(0.5 * i), series.y.push_back(l.distribution.at(c, 0.5 * i));
    series.label = fmt::format("C {:g}", c), series.color = colour;
    plot.series.push_back(series);
    if (l.distribution.is_rotational()) break;
  }
  return svg_plot(plot);
}

int goniophotometer(const GonioArguments& a) {
  for (const std::string& output : a.outputs) {
    if (!is_luminaire_file(output)) throw Error("-o " + output + ": the output is an .ies or an .ldt file");
    require_writable(output);
  }
  for (const auto& [option, value] :
       {std::pair("--flux", a.flux), std::pair("--lamp-flux", a.lamp_flux), std::pair("--watts", a.watts)})
    if (!(value >= 0 && std::isfinite(value)))
      throw Error(fmt::format("{} {:g}: must be positive", option, value));
  for (const double size : a.opening)
    if (!(size >= 0 && size < 1e4)) throw Error(fmt::format("--opening: {:g} m is no size", size));
  const bool is_file = is_luminaire_file(a.target);
  Luminaire l = is_file ? read_luminaire(a.target) : measure(a);
  if (is_file && !a.quiet)
    for (const std::string& note : l.notes) tell("note: {}: {}\n", a.target, note);
  for (const std::string& output : a.outputs) {
    const bool is_ldt =
        std::tolower(static_cast<unsigned char>(std::filesystem::path(output).extension().string()[1])) ==
        'l';
    write_file_atomically(output, is_ldt ? eulumdat_text(l) : ies_text(l));
  }
  if (!a.plot.empty()) write_file_atomically(a.plot, intensity_plot(a, l));
  if (!a.quiet) print_luminaire(a, l);
  return 0;
}

std::function<int()> declare_goniophotometer(CommandOptions& options) {
  auto a = std::make_shared<GonioArguments>();
  options
      .add(
          "target", a->target,
          "scene with a luminaire alone, with or without a sensor; or an .ies or .ldt file, to report on or convert")
      .required();
  options.add("-o,--output", a->outputs, "write this .ies or .ldt file; may be repeated").takes_each_time(1);
  options.add("-D,--define", a->defines, "set a $name of the scene: -D name=value").takes_each_time(1);
  add_cache_option(options);
  options.add("--c-step", a->c_step, "step of the half-planes C, in degrees").shows_default();
  options.add("--gamma-step", a->gamma_step, "step of gamma, in degrees").shows_default();
  options.add("--symmetry", a->symmetry, "half-planes to average: none, rotational, c0, c90 or quadrants")
      .one_of({"none", "rotational", "c0", "c90", "quadrants"})
      .shows_default();
  options.add("--down", a->down, "X Y Z: direction gamma = 0 in the scene (default: 0 0 -1)").takes(3);
  options.add("--along", a->along, "X Y Z: direction along the luminaire, C = 0 of LM-63 (default: 1 0 0)")
      .takes(3);
  options.add("--spp", a->spp, "samples per direction").shows_default();
  options.add("--seed", a->seed, "seed of the samples (default: the scene's)");
  options.add("--threads", a->threads, "threads (default: all cores)");
  options.add("--integrator", a->integrator, "integrator (default: ptracer, which finds all light)");
  options.add("--flux", a->flux, "luminous flux of the luminaire in lm, to which the intensities are scaled");
  options.add("--lamp-flux", a->lamp_flux,
              "luminous flux of the lamps in lm: the file is then relative to it; else it is absolute");
  options.add("--watts", a->watts, "electrical power in W, for the file");
  options.add("--opening", a->opening, "ALONG ACROSS HEIGHT: size of the luminous opening in m, for the file")
      .takes(3);
  options.add("--name", a->name, "name of the luminaire, for the file");
  options.add("--maker", a->maker, "name of the maker, for the file");
  options.add("--plot", a->plot, "write the intensities over gamma to this SVG file").names_output();
  options.add("-q,--quiet", a->quiet, "print errors only");
  return [a] { return goniophotometer(*a); };
}

AUREOLE_COMMAND("goniophotometer",
                "Luminous intensities of a luminaire: measure a scene, read and write IES and EULUMDAT",
                declare_goniophotometer);

}  // namespace
}  // namespace aureole

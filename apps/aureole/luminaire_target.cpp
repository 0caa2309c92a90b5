// SPDX-License-Identifier: Apache-2.0
#include "luminaire_target.h"

#include <fmt/format.h>

#include <cmath>

#include "aureole/core/error.h"
#include "aureole/core/letter_case.h"
#include "aureole/core/output_file.h"
#include "aureole/render/job.h"
#include "measured_scene.h"
#include "messages.h"
#include "scene_loading.h"

namespace aureole {

namespace {

Luminaire measure_luminaire(const LuminaireTarget& a, GoniometryOptions how) {
  check_sampling(a.spp, a.seed, a.threads);
  GoniophotometerSettings settings;
  settings.scene = a.target, settings.defines = split_defines(a.defines), settings.integrator = a.integrator;
  settings.spp = a.spp.value_or(settings.spp);
  settings.c_step = a.c_step.value_or(settings.c_step);
  settings.gamma_step = a.gamma_step.value_or(settings.gamma_step);
  if (!a.down.empty()) settings.down = a.down;
  settings.along = a.along, settings.tables = table_cache();
  settings.check_files = keep_files_of_scene;
  const LoadedScene loaded = load_goniophotometer(settings);
  if (!a.quiet)
    for (const auto& note : loaded.notes) tell("note: {}\n", note);
  require_luminaire(*loaded.scene);
  RenderJob job(loaded, render_options({}, a.seed, a.threads));
  run_to_end(job);
  if (!a.symmetry.empty()) how.symmetry = symmetry_of(a.symmetry);
  how.keywords = measurement_keywords(settings, a.name, a.maker);
  return measured_luminaire(job.state().picture(), how);
}

Luminaire read_target(const LuminaireTarget& a, GoniometryOptions how) {
  refuse_options({{"--spp", a.spp.has_value()},
                  {"--seed", a.seed.has_value()},
                  {"--threads", a.threads != 0},
                  {"--c-step", a.c_step.has_value()},
                  {"--gamma-step", a.gamma_step.has_value()},
                  {"--symmetry", !a.symmetry.empty()},
                  {"--integrator", !a.integrator.empty()},
                  {"--down", !a.down.empty()},
                  {"--along", !a.along.empty()},
                  {"--define", !a.defines.empty()}},
                 "is for a scene, which is measured; a file has its intensities");
  const std::int64_t lamp_set = a.lamp_set.value_or(0);
  if (lamp_set < 0 || lamp_set > 1000)
    throw Error(fmt::format("--lamp-set {}: expected the number of a set, from 0", lamp_set));
  if (!a.name.empty())
    how.keywords.emplace_back("LUMINAIRE", a.name), how.keywords.emplace_back("LUMCAT", a.name);
  if (!a.maker.empty()) how.keywords.emplace_back("MANUFAC", a.maker);
  Luminaire l = read_changed_luminaire(a.target, std::size_t(lamp_set), how);
  if (!a.quiet)
    for (const std::string& note : l.notes) tell("note: {}: {}\n", a.target, note);
  return l;
}

void require_luminaire_outputs(const LuminaireTarget& a) {
  for (const std::string& output : a.outputs)
    if (!is_luminaire_file(output)) throw Error("-o " + output + ": the output is an .ies or an .ldt file");
  if (a.outputs.empty())
    refuse_options(
        {{"--watts", a.watts.has_value()}, {"--name", !a.name.empty()}, {"--maker", !a.maker.empty()}},
        "is for the file that is written: give -o");
  for (const auto& [option, text] : {std::pair("--name", a.name), std::pair("--maker", a.maker)})
    if (text.find_first_of("\r\n") != text.npos)
      throw Error(std::string(option) + ": has more than one line, of which the files hold one");
}

}  // namespace

bool is_luminaire_file(const std::filesystem::path& file) {
  const std::string extension = lower_extension(file);
  return extension == ".ies" || extension == ".ldt";
}

void write_luminaire(const std::filesystem::path& file, const Luminaire& luminaire) {
  write_file_atomically(file,
                        lower_extension(file) == ".ldt" ? eulumdat_text(luminaire) : ies_text(luminaire));
}

bool LuminaireTarget::is_file() const { return is_luminaire_file(target); }

void add_luminaire_target(CommandOptions& options, LuminaireTarget& t) {
  options
      .add("target", t.target,
           "scene with a luminaire alone, with or without a sensor; or an .ies or .ldt file")
      .required();
  options.add("-D,--define", t.defines, "set a $name of the scene: -D name=value").takes_each_time(1);
  add_cache_option(options);
  options.add("--c-step", t.c_step, "step of the half-planes C of a measurement, in degrees (default: 15)");
  options.add("--gamma-step", t.gamma_step, "step of gamma of a measurement, in degrees (default: 5)");
  options
      .add("--symmetry", t.symmetry,
           "half-planes of a measurement to average: none (default), rotational, c0, c90 or quadrants")
      .one_of({"none", "rotational", "c0", "c90", "quadrants"});
  options.add("--down", t.down, "X Y Z: direction gamma = 0 in the scene (default: 0 0 -1)").takes(3);
  options.add("--along", t.along, "X Y Z: direction along the luminaire, C = 0 of LM-63 (default: 1 0 0)")
      .takes(3);
  options.add("--spp", t.spp, "samples per direction (default: 256)");
  options.add("--seed", t.seed, "seed of the samples (default: the scene's)");
  options.add("--threads", t.threads, "threads (default: all cores)");
  options.add("--integrator", t.integrator, "integrator (default: ptracer, which finds all light)");
  options.add("--flux", t.flux, "luminous flux of the luminaire in lm, to which the intensities are scaled");
  options.add(
      "--lamp-flux", t.lamp_flux,
      "luminous flux of the lamps in lm: a measurement is then relative to it, else absolute; the intensities of a "
      "file are scaled to it");
  options.add("--lamp-set", t.lamp_set, "which of the alternative sets of lamps of an EULUMDAT file, from 0");
  options.add("--watts", t.watts, "electrical power in W, for the file that is written");
  options
      .add(
          "--opening", t.opening,
          "ALONG ACROSS HEIGHT: size of the luminous opening in m, of a measurement or in the place of the file's")
      .takes(3);
  options.add("--name", t.name, "name of the luminaire, for the file that is written");
  options.add("--maker", t.maker, "name of the maker, for the file that is written");
  options.add("-o,--output", t.outputs, "write the luminaire to this .ies or .ldt file; may be repeated")
      .takes_each_time(1)
      .names_output();
}

Luminaire luminaire_of(const LuminaireTarget& a) {
  require_luminaire_outputs(a);
  for (const auto& [option, value] :
       {std::pair("--flux", a.flux), std::pair("--lamp-flux", a.lamp_flux), std::pair("--watts", a.watts)})
    if (value && !(*value > 0 && std::isfinite(*value)))
      throw Error(fmt::format("{} {:g}: must be positive", option, *value));
  for (const double size : a.opening)
    if (!(size >= 0 && size < 1e4)) throw Error(fmt::format("--opening: {:g} m is no size", size));
  GoniometryOptions how;
  how.flux = a.flux.value_or(0), how.lamp_flux = a.lamp_flux.value_or(0), how.watts = a.watts.value_or(0);
  if (!a.opening.empty()) how.opening = LuminousOpening{.size_m = {a.opening[0], a.opening[1], a.opening[2]}};
  if (!a.is_file() && a.lamp_set)
    throw Error("--lamp-set: is for an EULUMDAT file; the lamps of a scene are in the scene");
  Luminaire luminaire = a.is_file() ? read_target(a, how) : measure_luminaire(a, how);
  for (const std::string& output : a.outputs) write_luminaire(output, luminaire);
  return luminaire;
}

}  // namespace aureole

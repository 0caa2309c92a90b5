// SPDX-License-Identifier: Apache-2.0
// aureole spectrophotometer: the reflectance factor or transmittance of a material as a traced instrument measures it.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "aureole/core/error.h"
#include "aureole/core/output_file.h"
#include "aureole/instrument/laboratory/spectrophotometer.h"
#include "aureole/instrument/laboratory/spectrum_files.h"
#include "aureole/instrument/paint/colour_figures.h"
#include "aureole/instrument/report/svg_plot.h"
#include "command.h"
#include "interruption.h"
#include "laboratory_options.h"
#include "measured_scene.h"
#include "messages.h"
#include "scene_loading.h"

namespace aureole {
namespace {

struct SpectrophotometerOptions {
  std::string target, geometry = "45a:0", method, thickness, aperture, lit, sample, sphere, port, json, plot,
                      name, monochromator;
  std::vector<std::string> defines, outputs;
  std::vector<double> range{400, 700}, gloss;
  double step = 10, bandwidth = 0, haze = 0;
  std::optional<double> lamp_angle;
  bool transmission = false, theory = false, correct = false, is_quiet = false;
  SpectrophotometerSettings settings;
  TraceSettings trace;
};

void print_spectrum(const SpectrophotometerOptions& o, const MeasuredSpectrum& m) {
  fmt::print("{}: {} at {}{}\n", o.target, o.transmission ? "transmittance" : "reflectance factor",
             o.geometry, o.settings.by_theory ? ", sphere by theory" : "");
  fmt::print("    nm      value   standard uncertainty");
  for (const auto& cause : m.causes) fmt::print("  {:>10}", cause.name);
  fmt::print("\n");
  for (std::size_t i = 0; i < m.nm.size(); ++i) {
    fmt::print("{:>6g} {:>10.6f} {:>22.6f}", m.nm[i], m.values[i], m.error(i));
    for (const auto& cause : m.causes) fmt::print("  {:>10.6f}", cause.errors[i]);
    fmt::print("\n");
  }
  try {
    const ColourFigures c = colour_figures(m.nm, m.values, "D65/10");
    fmt::print("D65, 10 degrees: Y {:.3f}  x {:.4f}  y {:.4f}  L* {:.2f}  a* {:.2f}  b* {:.2f}\n", c.xyz[1],
               c.chromaticity.x, c.chromaticity.y, c.lab.l, c.lab.a, c.lab.b);
  } catch (const std::exception&) {
    tell("note: the wavelengths do not cover the visible range; no colour is printed\n");
  }
}

nlohmann::json spectrum_json(const SpectrophotometerOptions& o, const MeasuredSpectrum& m) {
  nlohmann::json out = {{"target", o.target},     {"quantity", o.transmission ? "T" : "R"},
                        {"geometry", o.geometry}, {"wavelengths_nm", m.nm},
                        {"values", m.values},     {"uncertainty", nlohmann::json::object()}};
  for (const auto& cause : m.causes) out["uncertainty"][cause.name] = cause.errors;
  for (std::size_t i = 0; i < m.nm.size(); ++i) out["standard_uncertainty"].push_back(m.error(i));
  if (!m.edge_loss.empty()) out["predicted_edge_loss"] = m.edge_loss;
  return out;
}

std::string spectrum_plot(const SpectrophotometerOptions& o, const MeasuredSpectrum& m) {
  Plot plot{o.target + " at " + o.geometry,
            "wavelength, nm",
            o.transmission ? "transmittance" : "reflectance factor",
            {},
            false};
  const auto add = [&](double sigmas, const char* label, const char* colour) {
    PlotSeries series;
    series.x = m.nm, series.label = label, series.color = colour;
    for (std::size_t i = 0; i < m.nm.size(); ++i) series.y.push_back(m.values[i] + sigmas * m.error(i));
    plot.series.push_back(series);
  };
  add(0, "measured", "#2050c0"), add(2, "2 standard uncertainties", "#a0b0d0"), add(-2, "", "#a0b0d0");
  return svg_plot(plot);
}

/// Notes options that have no effect: parts that an instrument lacks.
void note_unused(const SpectrophotometerOptions& o) {
  const SpectrophotometerSettings &s = o.settings, usual = {};
  const auto note = [](bool is_given, const char* option, const std::string& why) {
    if (is_given) tell("note: {}: has no effect {}\n", option, why);
  };
  if (o.haze > 0 || !o.gloss.empty()) {
    const std::string beside = "beside --haze and --gloss, whose geometries are those of their standards";
    note(o.geometry != "45a:0", "--geometry", beside), note(o.transmission, "--transmission", beside);
    note(s.specular_angle > 0, "--specular-port", beside), note(s.azimuth != 0, "--azimuth", beside);
    if (o.haze > 0) return;
    note(o.correct, "--correct-bandwidth", "beside --gloss");
  }
  if (s.geometry.has_sphere() && o.gloss.empty()) return;
  const std::string without =
      o.gloss.empty() ? "at " + o.geometry + ", which has no sphere" : "beside --gloss";
  note(!o.sphere.empty(), "--sphere", without), note(!o.port.empty(), "--port", without);
  note(s.wall != usual.wall, "--wall", without), note(o.theory, "--theory", without);
  if (o.gloss.empty()) {
    note(s.specular_angle > 0, "--specular-port", without);
    return;
  }
  note(o.lamp_angle.has_value(), "--lamp-angle", without);
  note(s.detector_angle != usual.detector_angle, "--detector-angle", without);
  note(s.standard != usual.standard, "--standard", "beside --gloss, whose standard is black glass");
}

/// The beam that the options state.
StatedBeam beam_of(const SpectrophotometerOptions& o) {
  const auto length = [](const char* option, const std::string& text) {
    std::optional<double> metres;
    if (!text.empty()) set_length(option, text, metres.emplace());
    return metres;
  };
  return {o.lamp_angle, length("--aperture", o.aperture), length("--lit", o.lit)};
}

int spectrophotometer(SpectrophotometerOptions o) {
  for (const std::string& output : o.outputs) require_spectrum_file(output);
  check_sampling({}, {}, o.trace.threads);
  SpectrophotometerSettings& s = o.settings;
  s.geometry = measuring_geometry(o.geometry, o.transmission);
  s.by_theory = o.theory, s.correct_bandwidth = o.correct;
  if (!o.method.empty())
    s.method = o.method == "substitution" ? SpectrophotometerSettings::Method::substitution
               : o.method == "absolute"   ? SpectrophotometerSettings::Method::absolute
                                          : SpectrophotometerSettings::Method::comparison;
  const StatedBeam beam = beam_of(o);
  set_beam(s, beam);
  set_length("--sample-size", o.sample, s.sample_m);
  set_length("--sphere", o.sphere, s.sphere_m), set_length("--port", o.port, s.port_m);
  double thickness = 0;
  set_length("--thickness", o.thickness, thickness);
  if (!o.thickness.empty() && !(thickness > 0)) throw Error("--thickness: must be positive");
  LoadOptions load = load_options(o.defines);
  const LoadedSpecimen loaded = load_specimen_called(o.target, load, thickness);
  if (!o.is_quiet) {
    for (const std::string& note : loaded.notes) tell("note: {}\n", note);
    note_unused(o);
  }
  if (o.transmission && !loaded.specimen.is_translucent())
    tell("note: --transmission: \"{}\" lets no light pass\n", loaded.specimen.name);
  if (!o.monochromator.empty())
    tell(
        "note: --monochromator: no material here fluoresces; before and after the sample it measures alike\n");
  const Bands bands = bands_over(o.range, loaded.grid, o.step, 10, o.bandwidth);
  o.trace.stop = &stop_on_interrupt();
  const Bench bench(loaded.grid, loaded.length_unit_m, bands, o.trace);
  nlohmann::json out;
  if (o.haze > 0 || !o.gloss.empty()) {
    const std::vector<double> weights = luminance_weights(bands.nm);
    for (const double angle : o.gloss) {
      const Ratio g = measure_gloss(bench, loaded.specimen, angle, s, weights);
      fmt::print("gloss at {:g} degrees: {:.2f} units, standard error {:.2f}\n", angle, g.value, g.error);
      out["gloss"][fmt::format("{:g}", angle)] = {{"units", g.value}, {"error", g.error}};
    }
    if (o.haze > 0) {
      SpectrophotometerSettings of_haze = s;
      use_beam_of_haze(of_haze), set_beam(of_haze, beam);
      const Haze h = measure_haze(bench, loaded.specimen, of_haze, o.haze, weights);
      fmt::print(
          "total transmittance {:.5f} +- {:.5f}, haze beyond {:g} degrees {:.5f} +- {:.5f}, sphere {}\n",
          h.total, h.total_error, o.haze, h.haze, h.haze_error, s.by_theory ? "by theory" : "traced");
      out["haze"] = {
          {"angle", o.haze}, {"total_transmittance", h.total}, {"haze", h.haze}, {"error", h.haze_error}};
    }
    if (!o.outputs.empty() || !o.plot.empty())
      tell("note: gloss and haze are numbers; -o and --plot have no effect beside them\n");
    if (!o.json.empty()) write_file_atomically(o.json, out.dump(1) + "\n");
    return 0;
  }
  const MeasuredSpectrum m = measure_spectrum(bench, loaded.specimen, s);
  for (const std::string& note : m.notes) tell("note: {}\n", note);
  if (!o.is_quiet) print_spectrum(o, m);
  pigment::SampleTable table{m.nm, {}};
  pigment::Sample& sample = table.samples.emplace_back();
  sample.name = o.name.empty() ? loaded.specimen.name : o.name;
  sample.paints = {{sample.name, 1}};
  if (o.transmission) sample.quantity = pigment::Sample::Quantity::transmittance;
  sample.values = m.values;
  for (const std::string& output : o.outputs)
    write_file_atomically(output, spectrum_file_content(output, table, o.geometry));
  if (!o.json.empty()) write_file_atomically(o.json, spectrum_json(o, m).dump(1) + "\n");
  if (!o.plot.empty()) write_file_atomically(o.plot, spectrum_plot(o, m));
  return 0;
}

std::function<int()> declare_spectrophotometer(CommandOptions& options) {
  auto o = std::make_shared<SpectrophotometerOptions>();
  SpectrophotometerSettings& s = o->settings;
  options
      .add("target", o->target, "scene.xml#id: the id of a BSDF, or of a shape, whose medium becomes a slab")
      .required();
  options
      .add(
          "--geometry", o->geometry,
          "geometry of CIE 15: 45a:0 45x:0 0:45a 0:45x di:8 de:8 8:di 8:de d:0 d:d; with --transmission 0:0 di:0 "
          "de:0 0:di 0:de d:d")
      .shows_default();
  options.add("--transmission", o->transmission, "measure what is transmitted");
  options
      .add("--method", o->method,
           "substitution, comparison (default; both in the sphere at once) or absolute")
      .one_of({"substitution", "comparison", "absolute"});
  options.add("--pooled", s.is_pooled,
              "a traced sphere's departure from theory is fitted over the wavelengths: less noise");
  options.add("--theory", o->theory, "the sphere in closed form: faster, without its uneven light");
  options.add("--range", o->range, "first and last wavelength in nm (default 400,700)")
      .separated_by(',')
      .takes(2);
  options.add("--step", o->step, "largest step between wavelengths in nm").between(0.01, 1e9).shows_default();
  options
      .add("--bandwidth", o->bandwidth,
           "full width of the slit function at half maximum in nm (default: the step)")
      .between(0.01, 1e9);
  options.add("--correct-bandwidth", o->correct,
              "subtract the effect of the bandwidth (Stearns and Stearns 1988)");
  options.add("--aperture", o->aperture, "diameter of the viewed area (default 8mm; of --haze 2mm)");
  options.add("--lit", o->lit, "diameter of the area that a beam lights (default: 4mm more; of --haze 2mm)");
  options.add("--sample-size", o->sample, "extent of the sample (default 60mm)");
  options.add("--thickness", o->thickness, "thickness of the slab (default: the shape's smallest extent)");
  options.add("--sphere", o->sphere, "diameter of the sphere (default 150mm)");
  options.add("--port", o->port, "diameter of the sample's port (default 25mm)");
  options.add("--wall", s.wall, "reflectance of the sphere's wall").shows_default();
  options
      .add("--specular-port", s.specular_angle,
           "half-angle of the specular port in degrees (default: as the mirrored beam needs)")
      .between(0.1, 20);
  options.add(
      "--lamp-angle", o->lamp_angle,
      "half of the angle under which the sample sees the lamp, in degrees (default 3.5; of --haze 0.1)");
  options
      .add("--detector-angle", s.detector_angle,
           "half of the angle under which it sees the detector, in degrees")
      .shows_default();
  options.add("--azimuth", s.azimuth, "azimuth of the lamp or detector of 45x, in degrees").shows_default();
  options.add("--standard", s.standard, "reflectance of the Lambertian standard").shows_default();
  options.add("--standard-error", s.standard_error, "relative standard uncertainty of the standard")
      .shows_default();
  options.add("--noise", s.noise, "noise of the detector at the standard's signal, relative to it")
      .shows_default();
  options.add("--dark-noise", s.dark_noise, "noise without light, relative to the standard's signal")
      .shows_default();
  options.add("--wavelength-error", s.wavelength_error_nm, "standard uncertainty of the wavelengths in nm")
      .shows_default();
  options.add("--monochromator", o->monochromator, "before or after the sample").one_of({"before", "after"});
  options
      .add("--haze", o->haze,
           "instead: total transmittance and haze beyond this angle in degrees (ASTM D1003: 2.5)")
      .between(0.01, 10);
  options.add("--gloss", o->gloss, "instead: gloss units at these angles, 20,60,85 (ISO 2813)")
      .separated_by(',');
  options.add("--paths", o->trace.paths, "paths for each detector").shows_default();
  options.add("--seed", o->trace.seed, "seed of the paths and of the noise").shows_default();
  options.add("--threads", o->trace.threads, "threads (default: all cores)");
  options.add("-D,--define", o->defines, "set a $name of the scene: -D name=value").takes_each_time(1);
  add_cache_option(options);
  options.add("-o,--output", o->outputs, "write this .csv, .cxf (CxF 3) or .cgats file; may be repeated")
      .takes_each_time(1)
      .names_output();
  options.add("--name", o->name, "name of the sample in files (default: the id)");
  options.add("--json", o->json, "write values and uncertainties by cause to this file").names_output();
  options.add("--plot", o->plot, "write the spectrum to this SVG file").names_output();
  options.add("-q,--quiet", o->is_quiet, "print errors only");
  return [o] { return spectrophotometer(*o); };
}

AUREOLE_COMMAND("spectrophotometer",
                "Reflectance factor, transmittance, haze and gloss as a traced instrument measures them",
                declare_spectrophotometer);

}  // namespace
}  // namespace aureole

// SPDX-License-Identifier: Apache-2.0
// aureole goniometer: a material measured by direction as a traced goniometer does, its table, models fitted to it, and its
// reflectances.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "aureole/core/error.h"
#include "aureole/core/letter_case.h"
#include "aureole/core/output_file.h"
#include "aureole/instrument/laboratory/brdf_fit.h"
#include "aureole/instrument/laboratory/goniometer.h"
#include "aureole/instrument/laboratory/lateral_spread.h"
#include "aureole/instrument/report/svg_plot.h"
#include "command.h"
#include "interruption.h"
#include "laboratory_options.h"
#include "measured_scene.h"
#include "messages.h"
#include "scene_loading.h"

namespace aureole {
namespace {

struct GoniometerOptions {
  std::string target, plan = "hemispherical", thickness, aperture, lit, sample, output, material, json, plot;
  std::vector<std::string> defines, models;
  std::string spread, incident_light;
  std::vector<double> range{400, 700}, cones, distances;
  double step = 20, bandwidth = 0;
  bool fit = false, report = false, is_quiet = false;
  GonioPlan directions;
  /// Half-angles of the cones of lamp and detector [degrees]; NaN: not stated.
  double lamp_angle = std::numeric_limits<double>::quiet_NaN(), detector_angle = lamp_angle;
  GoniometerSettings settings;
  TraceSettings trace;
};

std::string lobe_plot(const std::string& title, const GonioTable& table) {
  Plot plot{title, "angle in the plane of incidence, degrees", "f, 1/sr, mean of the wavelengths", {}, false};
  const char* colours[] = {"#2050c0", "#208030", "#c03020", "#806020", "#802080", "#208080", "#404040"};
  std::vector<double> seen;
  for (const GonioReading& r : table.readings) {
    const double relative = std::fmod(r.phi_o - r.phi_i + 720, 360);
    const bool is_near = relative < 0.5 || relative > 359.5, is_far = std::abs(relative - 180) < 0.5;
    if (!(is_near || is_far || r.theta_o == 0) || r.theta_o > 90 || r.phi_i != table.readings[0].phi_i)
      continue;
    const auto at = std::find(seen.begin(), seen.end(), r.theta_i);
    const std::size_t k = std::size_t(at - seen.begin());
    if (at == seen.end()) {
      seen.push_back(r.theta_i);
      PlotSeries series;
      series.label = fmt::format("incidence {:g}", r.theta_i), series.color = colours[k % 7];
      plot.series.push_back(series);
    }
    double mean = 0;
    for (const double f : r.f) mean += f / double(r.f.size());
    plot.series[k].x.push_back(is_near ? -r.theta_o : r.theta_o), plot.series[k].y.push_back(mean);
  }
  for (PlotSeries& s : plot.series) {
    std::vector<std::pair<double, double>> points;
    for (std::size_t i = 0; i < s.x.size(); ++i) points.emplace_back(s.x[i], s.y[i]);
    std::sort(points.begin(), points.end());
    for (std::size_t i = 0; i < points.size(); ++i) s.x[i] = points[i].first, s.y[i] = points[i].second;
  }
  return svg_plot(plot);
}

nlohmann::json ratio_json(const Ratio& r) { return {{"value", r.value}, {"error", r.error}}; }

nlohmann::json report_json(const ReflectanceReport& r) {
  nlohmann::json out = {
      {"rho_hh", ratio_json(r.hh)}, {"anisotropy", r.anisotropy}, {"is_isotropic", r.is_isotropic}};
  for (const auto& a : r.angles)
    out["angles"].push_back({{"angle", a.angle}, {"rho_dh", ratio_json(a.dh)}, {"rho_hd", ratio_json(a.hd)}});
  if (r.of_light) out["of_incident_light"] = ratio_json(*r.of_light);
  for (const auto& c : r.cones)
    out["cones"].push_back({{"theta_i", c.theta_i},
                            {"half_i", c.half_i},
                            {"theta_o", c.theta_o},
                            {"half_o", c.half_o},
                            {"reflectance", ratio_json(c.reflectance)},
                            {"factor", c.factor}});
  for (const auto& p : r.pairs)
    out["pairs"].push_back(
        {{"i", p.i}, {"o", p.o}, {"forward", ratio_json(p.forward)}, {"backward", ratio_json(p.backward)}});
  return out;
}

nlohmann::json fits_json(const std::vector<BrdfFit>& fits) {
  nlohmann::json out = nlohmann::json::array();
  for (const BrdfFit& f : fits) {
    nlohmann::json one = {{"model", f.model},
                          {"aic", f.aic},
                          {"chi_squared", f.chi_squared},
                          {"readings", f.readings},
                          {"rms", f.rms},
                          {"largest_residual", f.largest},
                          {"bsdf", f.bsdf},
                          {"parameters", nlohmann::json::object()}};
    for (const auto& p : f.parameters)
      one["parameters"][p.name] = {{"value", p.value}, {"low", p.low}, {"high", p.high}};
    out.push_back(std::move(one));
  }
  return out;
}

nlohmann::json spread_json(const SpreadTable& t) {
  nlohmann::json out = {{"kind", t.is_line ? "line" : "point"}, {"wavelengths_nm", t.nm}};
  for (const SpreadReading& r : t.readings) {
    nlohmann::json one = {{"distance_mm", 1e3 * r.at_m}};
    for (const Ratio& v : r.values) one["values"].push_back(v.value), one["errors"].push_back(v.error);
    if (!r.predicted.empty()) one["diffusion"] = r.predicted;
    out["readings"].push_back(std::move(one));
  }
  return out;
}

std::string spread_plot(const std::string& title, const SpreadTable& t) {
  Plot plot{title, "distance, mm", t.is_line ? "1/m" : "1/m^2", {}, true};
  const std::size_t b = t.nm.size() / 2;
  PlotSeries traced{.kind = PlotSeries::Kind::points, .x = {}, .y = {}, .low = {}, .high = {}}, diffusion;
  traced.label = fmt::format("traced, two standard errors, {:g} nm", t.nm[b]), traced.color = "#2050c0";
  diffusion.label = "diffusion", diffusion.color = "#c03020";
  for (const SpreadReading& r : t.readings) {
    if (!(r.values[b].value > 0)) continue;
    traced.x.push_back(1e3 * r.at_m), traced.y.push_back(r.values[b].value);
    traced.low.push_back(std::max(r.values[b].value - 2 * r.values[b].error, 0.01 * r.values[b].value));
    traced.high.push_back(r.values[b].value + 2 * r.values[b].error);
    if (!r.predicted.empty()) diffusion.x.push_back(1e3 * r.at_m), diffusion.y.push_back(r.predicted[b]);
  }
  plot.series = {traced};
  if (!diffusion.x.empty()) plot.series.push_back(diffusion);
  return svg_plot(plot);
}

/// --spread: writes and prints the table of a slab instead of readings by direction.
int measure_and_write_spread(const GoniometerOptions& o, const Bench& bench, const Specimen& specimen) {
  SpreadSettings s;
  s.is_line = o.spread == "line", s.lamp_angle = std::max(o.settings.lamp_angle, 0.5);
  s.sample_m = o.settings.sample_m;
  if (!o.aperture.empty()) s.receiver_m = o.settings.viewed_m;
  s.lit_m = o.lit.empty() ? s.receiver_m : o.settings.lit_m;
  for (const double mm : o.distances) s.at_m.push_back(1e-3 * mm);
  if (s.at_m.empty())
    for (const double mm : {0.0, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0, 16.0, 24.0})
      if (1e-3 * mm + 0.5 * s.receiver_m <= 0.5 * s.sample_m) s.at_m.push_back(1e-3 * mm);
  const SpreadTable table = measure_spread(bench, specimen, s);
  for (const std::string& note : table.notes) tell("note: {}\n", note);
  const std::string text = spread_table_content(table);
  if (!o.is_quiet) fmt::print("{}", text);
  if (!o.output.empty()) write_file_atomically(o.output, text);
  if (!o.plot.empty()) write_file_atomically(o.plot, spread_plot(o.target, table));
  if (!o.json.empty()) write_file_atomically(o.json, spread_json(table).dump(1) + "\n");
  if (o.fit || o.report)
    tell("note: --fit, --models, --material and --report have no effect beside --spread\n");
  return 0;
}

int goniometer(GoniometerOptions o) {
  GoniometerSettings& s = o.settings;
  check_sampling({}, {}, o.trace.threads);
  if (!o.output.empty() && lower_extension(o.output) != ".csv")
    throw Error({o.output, 0, 0}, "the table is a .csv file");
  if (!o.material.empty() || !o.models.empty()) o.fit = true;
  if (!std::isnan(o.lamp_angle)) s.lamp_angle = o.lamp_angle;
  if (!std::isnan(o.detector_angle)) s.detector_angle = o.detector_angle;
  set_length("--aperture", o.aperture, s.viewed_m);
  if (!o.aperture.empty()) s.lit_m = 2 * s.viewed_m;
  set_length("--lit", o.lit, s.lit_m), set_length("--sample-size", o.sample, s.sample_m);
  double thickness = 0;
  set_length("--thickness", o.thickness, thickness);
  o.directions.kind = o.plan == "in_plane"   ? GonioPlan::Kind::in_plane
                      : o.plan == "adaptive" ? GonioPlan::Kind::adaptive
                                             : GonioPlan::Kind::hemispherical;
  ReportSettings asked;
  asked.light = o.incident_light;
  if (o.cones.size() % 4 != 0)
    throw Error(
        "--cones: four numbers for each pair of cones are expected: theta_i,half_i,theta_o,half_o in degrees");
  for (std::size_t k = 0; k < o.cones.size(); k += 4)
    asked.cones.push_back({o.cones[k], o.cones[k + 1], o.cones[k + 2], o.cones[k + 3]});
  if (!asked.light.empty() || !asked.cones.empty()) o.report = true;
  GonioTable table;
  nlohmann::json out;
  const std::size_t mark = o.target.rfind('#');
  const bool is_file = mark == o.target.npos && lower_extension(o.target) == ".csv";
  if (is_file) {
    table = read_gonio_table(o.target);
    for (const std::string& note : table.notes) tell("note: {}\n", note);
    if (!o.output.empty() || o.report)
      tell("note: a table has been measured already; -o and --report have no effect\n");
    o.fit = true;
  } else {
    if (mark == o.target.npos)
      throw Error(
          {o.target, 0, 0},
          "name a material of the scene as scene.xml#id, the id of a BSDF or a shape, or a table (.csv) to fit");
    LoadOptions load = load_options(o.defines);
    const LoadedSpecimen loaded = load_specimen_called(o.target, load, thickness);
    if (!o.is_quiet)
      for (const std::string& note : loaded.notes) tell("note: {}\n", note);
    const Bands bands = bands_over(o.range, loaded.grid, o.step, 20, o.bandwidth);
    o.trace.stop = &stop_on_interrupt();
    const Bench bench(loaded.grid, loaded.length_unit_m, bands, o.trace);
    if (o.directions.transmits && !loaded.specimen.is_translucent())
      tell("note: --transmission: \"{}\" lets no light pass\n", loaded.specimen.name);
    if (const double index = loaded.specimen.index_behind(loaded.grid); o.directions.transmits && index != 1)
      tell(
          "note: --transmission: \"{}\" is the surface of a body of index {:.4g}, in which directions below are measured\n",
          loaded.specimen.name, index);
    if (s.standard != GoniometerSettings().standard && !s.by_reference)
      tell("note: --standard: has no effect without --reference\n");
    if (!o.spread.empty()) {
      TraceSettings more = o.trace;
      // Bidirectional paths through a smooth interface take a hundred times as long, and have less noise.
      more.paths = std::max<std::int64_t>(more.paths, loaded.specimen.is_refracting() ? 1 << 13 : 1 << 16);
      return measure_and_write_spread(o, Bench(loaded.grid, loaded.length_unit_m, bands, more),
                                      loaded.specimen);
    }
    if (!o.distances.empty()) tell("note: --distances has no effect without --spread\n");
    if (o.report) {
      TraceSettings more = o.trace;
      more.paths = std::max<std::int64_t>(more.paths, 1 << 15);
      const ReflectanceReport r = report_reflectances(Bench(loaded.grid, loaded.length_unit_m, bands, more),
                                                      loaded.specimen, s, asked);
      if (!o.is_quiet) fmt::print("{}", report_text(r));
      out["report"] = report_json(r);
    }
    if (!o.report || o.fit || !o.output.empty() || !o.plot.empty()) {
      table = measure_scattering(bench, loaded.specimen, s, o.directions);
      for (const std::string& note : table.notes) tell("note: {}\n", note);
      double relative = 0, weight = 0;
      for (const GonioReading& r : table.readings)
        for (std::size_t b = 0; b < r.f.size(); ++b) relative += r.error[b], weight += std::abs(r.f[b]);
      if (!o.is_quiet)
        fmt::print(
            "{}: {} pairs of directions x {} wavelengths, mean uncertainty {:.2g} % of the mean reading\n",
            o.target, table.readings.size(), table.nm.size(), weight > 0 ? 100 * relative / weight : 0);
      if (!o.output.empty()) {
        write_file_atomically(o.output, gonio_table_content(table));
        if (!o.is_quiet) fmt::print("wrote {}, for the BSDF \"tabulated\"\n", o.output);
      }
    }
  }
  if (o.fit) {
    FitSettings fit;
    fit.models = o.models;
    // The apertures that measured a file are those that the user states.
    if (!is_file || !std::isnan(o.lamp_angle)) fit.lamp_angle = s.lamp_angle;
    if (!is_file || !std::isnan(o.detector_angle)) fit.detector_angle = s.detector_angle;
    if (!is_file || !o.aperture.empty()) fit.viewed_m = s.viewed_m, fit.distance_m = s.distance_m;
    const std::vector<BrdfFit> fits = fit_brdfs(table, fit);
    if (!o.is_quiet) fmt::print("{}", fit_text(fits));
    out["fits"] = fits_json(fits);
    if (!o.material.empty()) {
      write_file_atomically(o.material, fits[0].bsdf + "\n");
      if (!o.is_quiet) fmt::print("wrote {}, the model {}\n", o.material, fits[0].model);
    }
  }
  if (!o.plot.empty()) write_file_atomically(o.plot, lobe_plot(o.target, table));
  if (!o.json.empty()) write_file_atomically(o.json, out.dump(1) + "\n");
  return 0;
}

std::function<int()> declare_goniometer(CommandOptions& options) {
  auto o = std::make_shared<GoniometerOptions>();
  GoniometerSettings& s = o->settings;
  o->trace.paths = 512, o->trace.replicates = 8;
  options
      .add("target", o->target,
           "scene.xml#id: the id of a BSDF or a shape; or a table (.csv), to fit models to")
      .required();
  options.add("--plan", o->plan, "in_plane, hemispherical or adaptive (denser where f changes)")
      .one_of({"in_plane", "hemispherical", "adaptive"})
      .shows_default();
  options
      .add("--incident", o->directions.incident, "angles of incidence in degrees (default 0,15,30,45,60,75)")
      .separated_by(',');
  options
      .add("--azimuths", o->directions.azimuths,
           "azimuths of incidence in degrees (default 0); several for anisotropic materials")
      .separated_by(',');
  options.add("--directions", o->directions.directions, "detectors for each direction of incidence and side")
      .shows_default();
  options.add("--transmission", o->directions.transmits, "also measure below the sample");
  options.add("--reference", s.by_reference,
              "compare with a Lambertian standard; default: measure the irradiance");
  options.add("--standard", s.standard, "reflectance of the standard").shows_default();
  options
      .add("--lamp-angle", o->lamp_angle,
           "half of the angle under which the sample sees the lamp, in degrees (default 0.5)")
      .between(0, 90);
  options
      .add("--detector-angle", o->detector_angle,
           "half of the angle under which it sees a detector, in degrees (default 0.5)")
      .between(0, 90);
  options.add("--aperture", o->aperture, "diameter of the viewed area (default 10mm)");
  options.add("--lit", o->lit, "diameter of the lit area (default: twice the viewed one)");
  options.add("--sample-size", o->sample, "extent of the sample (default 60mm)");
  options.add("--thickness", o->thickness, "thickness of the slab (default: the shape's smallest extent)");
  options.add("--noise", s.noise, "noise of the detector relative to the signal").shows_default();
  options.add("--dark-noise", s.dark_noise, "noise of the detector without light, in 1/sr").shows_default();
  options.add("--angle-error", s.angle_error, "standard deviation of the polar angles in degrees")
      .shows_default();
  options.add("--range", o->range, "first and last wavelength in nm (default 400,700)")
      .separated_by(',')
      .takes(2);
  options.add("--step", o->step, "largest step between wavelengths in nm").between(0.01, 1e9).shows_default();
  options
      .add("--bandwidth", o->bandwidth,
           "full width of the slit function at half maximum in nm (default: the step)")
      .between(0.01, 1e9);
  options.add("--paths", o->trace.paths, "paths for each pair of directions").shows_default();
  options.add("--seed", o->trace.seed, "seed of the paths and of the noise").shows_default();
  options.add("--threads", o->trace.threads, "threads (default: all cores)");
  options.add("-D,--define", o->defines, "set a $name of the scene: -D name=value").takes_each_time(1);
  add_cache_option(options);
  options.add("-o,--output", o->output, "write the readings to this .csv file, which \"tabulated\" reads")
      .names_output();
  options.add("--fit", o->fit, "fit analytic models to the readings");
  options.add("--models", o->models, "the models to fit (default: all), as in ward,ggx").separated_by(',');
  options.add("--material", o->material, "write the best model as a <bsdf> element to this file")
      .names_output();
  options.add("--report", o->report, "measure reflectances, reciprocity, energy and isotropy");
  options
      .add("--incident-light", o->incident_light,
           "in the report: the part that is scattered of light of this radiance by angle from the normal, as "
           "0:1,60:0.5,90:0.1, or of a picture in latitude and longitude (.exr, .hdr)")
      .names_input();
  options
      .add(
          "--cones", o->cones,
          "in the report: reflectance from cone to cone, theta_i,half_i,theta_o,half_o in degrees; may be several fours")
      .separated_by(',');
  options
      .add(
          "--spread", o->spread,
          "instead: light that leaves a slab beside a spot or a line of light (point, line); --aperture and --lit are the "
          "sizes of receiver and spot (0.5mm)")
      .one_of({"point", "line"});
  options.add("--distances", o->distances, "distances of --spread from the spot in mm (default 0 to 24)")
      .separated_by(',');
  options.add("--json", o->json, "write fits and report to this file").names_output();
  options.add("--plot", o->plot, "write the lobes in the plane of incidence to this SVG file").names_output();
  options.add("-q,--quiet", o->is_quiet, "print errors only");
  return [o] { return goniometer(*o); };
}

AUREOLE_COMMAND("goniometer",
                "Scattering by direction as a traced goniometer measures it, with fits of analytic models",
                declare_goniometer);

}  // namespace
}  // namespace aureole

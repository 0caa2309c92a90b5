// SPDX-License-Identifier: Apache-2.0
// aureole pigment fit: K and S of paints from measured samples, with diagnostics.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>

#include "aureole/core/error.h"
#include "aureole/core/output_file.h"
#include "aureole/instrument/paint/aperture_loss.h"
#include "aureole/instrument/paint/paint_colour.h"
#include "aureole/instrument/paint/paint_files.h"
#include "aureole/instrument/paint/two_flux_doubt.h"
#include "aureole/pigment/measured_paints.h"
#include "aureole/pigment/palette_text.h"
#include "aureole/pigment/prediction.h"
#include "messages.h"
#include "pigment/joint_fit_report.h"
#include "pigment/pigment_options.h"

namespace aureole {
namespace {

struct FitOptions {
  std::vector<std::string> files;
  std::string samples, white = "white", output, json, plot, plot_k, plot_s, plot_differences;
  LightOptions light;
  SurfaceOptions surface;
  JointOptions joint;
  bool is_template = false;
};

struct Errors {
  double mean = 0, worst = 0, rms = 0;
  std::vector<double> differences;

  void add(double difference, double of_rms) {
    const auto count = double(differences.size());
    mean = (mean * count + difference) / (count + 1);
    worst = std::max(worst, difference), rms = std::max(rms, of_rms);
    differences.push_back(difference);
  }
};

/// Returns the median of error/|value| as text, or "-" if errors are unknown.
std::string relative_error(const std::vector<double>& values, const std::vector<double>& errors) {
  if (errors.empty()) return "-";
  std::vector<double> ratios;
  for (std::size_t i = 0; i < values.size(); ++i)
    if (values[i] != 0) ratios.push_back(errors[i] / std::abs(values[i]));
  if (ratios.empty()) return "-";
  std::nth_element(ratios.begin(), ratios.begin() + std::ptrdiff_t(ratios.size() / 2), ratios.end());
  return fmt::format("{:.2g} %", 100 * ratios[ratios.size() / 2]);
}

/// Upper bound of the half-width of a plot's band, as the logarithm of a factor of 100.
constexpr double kWidestBand = 4.6;

/// Plots a quantity of every paint over the wavelength, on a logarithmic axis. `value` is computed from K and
/// S. `spread`, if any, has standard deviations of the quantity's logarithm by paint, drawn as 90 % intervals.
/// Lines have the paints' colours with 0.3 of their K, so that dark paints differ, and 0.8 of R, so that white is
/// visible on the page.
template <class Value>
std::string plot_of(const pigment::Palette& palette, const pigment::Observation& lamp,
                    const std::string& file, const std::string& name, const std::string& unit,
                    const Value& value, const std::vector<std::vector<double>>& spread) {
  Plot plot{name + " of the paints of " + file, "wavelength, nm", name + unit, {}, true};
  pigment::Palette usable = palette;
  pigment::clamp_negative(usable);
  for (const pigment::Pigment& p : usable.pigments) {
    std::vector<double> values, reflectance;
    for (std::size_t i = 0; i < palette.nm.size(); ++i) {
      values.push_back(value(p.k[i], p.s[i]));
      reflectance.push_back(0.8 * (p.s[i] > 0 ? pigment::opaque_reflectance(0.3 * p.k[i] / p.s[i]) : 0));
    }
    PlotSeries& line = plot.series.emplace_back(
        spectrum_line(palette.nm, values, p.name, screen_colour(lamp.xyz(reflectance), lamp.white())));
    if (spread.empty()) continue;
    const std::vector<double>& of_paint = spread[std::size_t(&p - usable.pigments.data())];
    for (std::size_t i = 0; i < values.size(); ++i) {
      const double factor = std::exp(std::min(pigment::kNormal90 * of_paint[i], kWidestBand));
      line.low.push_back(values[i] / factor), line.high.push_back(values[i] * factor);
    }
  }
  return svg_plot(plot);
}

/// Writes the plots of a fit. `ratio_error` has standard deviations of ln(K/S) by paint, after a joint fit.
void write_plots(const FitOptions& o, const pigment::Palette& palette, const pigment::Observation& lamp,
                 const std::vector<std::vector<double>>& ratio_error = {}) {
  const std::string unit = palette.per_film   ? ", per film"
                           : palette.relative ? ", in S of " + o.white
                                              : ", 1/m";
  std::vector<std::vector<double>> k_error, s_error;
  for (const pigment::Pigment& p : palette.pigments) {
    if (ratio_error.empty()) break;
    std::vector<double>&k = k_error.emplace_back(), &s = s_error.emplace_back();
    for (std::size_t i = 0; i < palette.nm.size(); ++i)
      k.push_back(p.k_error[i] / p.k[i]), s.push_back(p.s_error[i] / p.s[i]);
  }
  const auto write = [&](const std::string& file, const std::string& name, const std::string& of,
                         const auto& value, const std::vector<std::vector<double>>& spread) {
    if (!file.empty())
      write_file_atomically(file, plot_of(palette, lamp, o.samples, name, of, value, spread));
  };
  write(
      o.plot, "K/S", "", [](double k, double s) { return s > 0 ? k / s : 0; }, ratio_error);
  write(
      o.plot_k, "K", unit, [](double k, double) { return k; }, k_error);
  write(
      o.plot_s, "S", unit, [](double, double s) { return s; }, s_error);
}

/// Returns the cumulative distribution of the differences: each difference over the fraction of differences
/// that are not larger.
PlotSeries differences_line(std::vector<double> differences, const std::string& label,
                            const std::string& colour) {
  std::sort(differences.begin(), differences.end());
  PlotSeries series;
  series.kind = differences.size() < 3 ? PlotSeries::Kind::points : PlotSeries::Kind::line;
  series.label = label, series.color = colour;
  for (std::size_t i = 0; i < differences.size(); ++i)
    series.x.push_back(100 * double(i + 1) / double(differences.size()));
  series.y = std::move(differences);
  return series;
}

nlohmann::json report_json(const pigment::FitReport& r) {
  nlohmann::json out = {{"method", name_of(r.method)},    {"samples", r.samples},
                        {"measurements", r.measurements}, {"negative_k", r.negative_k},
                        {"negative_s", r.negative_s},     {"undefined", r.undefined}};
  if (r.negative_k + r.negative_s > 0) out["negative_nm"] = {r.negative_from_nm, r.negative_to_nm};
  if (r.residual > 0) out["tints_rms"] = r.residual;
  return out;
}

/// Notes options that have no effect, and names of paints that are not in the table.
void note_unused(const FitOptions& o, const pigment::SampleTable& table) {
  o.surface.note_unused(o.joint.joint && o.joint.theory != "two-flux");
  const JointOptions usual;
  const pigment::JointSettings &set = o.joint.settings, &standard = usual.settings;
  for (const auto& [option, is_given] : {std::pair{"--theory", o.joint.theory != usual.theory},
                                         {"--noise", set.noise != standard.noise},
                                         {"--relative-noise", set.noise_relative != standard.noise_relative},
                                         {"--amount-error", set.dose != standard.dose},
                                         {"--g", o.joint.g != usual.g},
                                         {"--g-error", set.g != standard.g},
                                         {"--thickness-error", set.thickness != standard.thickness},
                                         {"--black", o.joint.black != usual.black}})
    if (is_given && !o.joint.joint) tell("note: {}: has no effect without --joint\n", option);
  for (const auto& [option, is_given] :
       {std::pair{"--g", o.joint.g != usual.g}, {"--g-error", set.g != standard.g}})
    if (is_given && o.joint.joint && o.joint.theory == "two-flux")
      tell("note: {}: has no effect on two fluxes, which have no directions\n", option);
  if (o.joint.joint && !o.joint.hold_out.empty()) return;  // the joint fit notes both names
  std::vector<std::string> names;
  for (const pigment::Sample& s : table.samples)
    for (const pigment::Component& c : s.paints)
      if (std::find(names.begin(), names.end(), c.name) == names.end()) names.push_back(c.name);
  for (const auto& [option, name, standard_name] :
       {std::tuple{"--white", o.white, FitOptions().white}, {"--black", o.joint.black, usual.black}})
    if (name != standard_name && std::find(names.begin(), names.end(), name) == names.end())
      tell("note: {}: no paint of {} is called \"{}\"{}\n", option, o.samples, name,
           did_you_mean(name, names));
}

/// Notes the paints whose measured films are thin or dark enough for two fluxes to fail, with the largest expected colour
/// difference. K and S that were fitted to these films compensate a part of that difference, but they do not
/// for other films.
void note_thin_films(const FitOptions& o, const pigment::SampleTable& table, pigment::Palette palette) {
  constexpr double kDoubtful = 1, kKnown = 0.3;
  if (palette.relative && !palette.per_film) return;  // a palette of opaque layers has no films
  const pigment::Observation lamp = observe(o.light.viewing(), palette.nm);
  pigment::clamp_negative(palette);
  double largest = 0;
  std::vector<std::string> names;
  for (std::size_t p = 0; p < palette.pigments.size(); ++p) {
    const pigment::Pigment& one = palette.pigments[p];
    // Skips guesses, for which no difference is expected.
    if (o.joint.joint && !one.k_error.empty() &&
        one.s_error[one.s.size() / 2] > kKnown * one.s[one.s.size() / 2])
      continue;
    std::set<std::pair<double, std::string>> done;
    double of_paint = 0;
    for (const pigment::Sample& s : table.samples) {
      if (s.paints.size() != 1 || s.paints[0].name != one.name || s.backing == "opaque") continue;
      if ((!palette.relative && !(s.thickness > 0)) || !done.emplace(s.thickness, s.backing).second) continue;
      double below = 0;
      try {
        for (std::size_t l = 0; s.backing != "none" && l < palette.nm.size(); ++l)
          below += pigment::substrate_at(table, palette.surface, s, l) / double(palette.nm.size());
      } catch (const std::domain_error&) {
        continue;  // skips a card that was not measured
      }
      std::vector<double> fractions(palette.pigments.size());
      fractions[p] = 1;
      of_paint =
          std::max(of_paint, two_flux_doubt(pigment::mix(palette, fractions), palette.nm,
                                            palette.relative ? 1 : s.thickness, std::clamp(below, 0.0, 1.0),
                                            palette.surface.k2 > 0 ? o.surface.index : 1, lamp));
    }
    if (of_paint > kDoubtful) names.push_back(one.name);
    largest = std::max(largest, of_paint);
  }
  if (names.empty()) return;
  constexpr std::size_t kShown = 3;
  const std::size_t more = names.size() - std::min(names.size(), kShown);
  names.resize(names.size() - more);
  tell(
      "note: two fluxes may be off by a Delta E of up to {:.1f} for the measured films of {}{} (CIEDE2000 from transport with "
      "g from 0 to 0.8), as for thin, dark or forward-scattering ones; K and S make up for it at this thickness, less at "
      "others\n",
      largest, fmt::join(names, ", "), more > 0 ? fmt::format(" and {} more paints", more) : "");
}

/// Notes what the aperture of the instrument means, if the table states one.
void note_aperture(const FitOptions& o, const pigment::SampleTable& table, const pigment::Palette& palette,
                   nlohmann::json& out) {
  const pigment::Observation lamp = observe(o.light.viewing(), palette.nm);
  if (const std::string text = aperture_text(table, palette, lamp); !text.empty())
    tell("note: {}: {}\n", o.samples, text);
  if (const auto loss = aperture_loss(table, palette, lamp))
    out["aperture"] = {{"diameter_mm", 1e3 * loss->diameter_m},
                       {"edge_loss_delta_e", loss->difference},
                       {"sample", loss->sample}};
}

int fit(FitOptions o) {
  o.samples = fmt::format("{}", fmt::join(o.files, ", "));
  if (o.is_template) {
    if (o.files.size() > 1) throw Error("--template: expected one file to write");
    if (std::filesystem::exists(o.samples)) throw Error("--template: the file " + o.samples + " exists");
    write_file_atomically(o.samples, pigment::sample_table_template());
    fmt::print("{}: an empty table with examples\n", o.samples);
    return 0;
  }
  const pigment::SampleTable table = read_sample_files(o.files);
  const bool ours = o.samples == kMeasuredPaints && !o.surface.given();
  for (const std::string& note : table.notes) tell("note: {}: {}\n", o.samples, note);
  o.surface.take(table.instrument, o.samples);
  note_unused(o, table);
  const pigment::FitSettings settings{ours ? pigment::kimera_surface() : o.surface.surface(), o.white};
  if (!ours && !o.surface.given())
    tell("note: no interface is taken off the reflectances; --geometry or --k1 and --k2 state one\n");
  if (o.joint.joint) {
    nlohmann::json out;
    SurfaceOptions surface = o.surface;
    if (ours) surface.geometry = "45_0";
    fmt::print("interface: {}\n", surface.text());
    const auto [palette, ratio_error] =
        fit_jointly(o.samples, table, o.joint, surface, o.white, o.light.viewing(), out);
    if (!palette.streams) note_thin_films(o, table, palette);
    note_aperture(o, table, palette, out);
    if (!o.output.empty()) write_file_atomically(o.output, pigment::palette_text(palette));
    if (!o.json.empty()) write_file_atomically(o.json, out.dump(1) + "\n");
    write_plots(o, palette, observe(o.light.viewing(), palette.nm), ratio_error);
    if (!o.plot_differences.empty()) tell("note: --plot-differences: is not drawn with --joint\n");
    return 0;
  }
  if (!o.joint.hold_out.empty()) throw Error("--hold-out: needs --joint");
  const pigment::Fit found = fit_file(o.samples, table, settings);
  const pigment::Palette& palette = found.palette;
  note_thin_films(o, table, palette);

  if (!ours) fmt::print("interface: {}\n", o.surface.text());
  fmt::print("{}: {} paints, {} measurements, {} wavelengths from {:g} to {:g} nm; K and S {}\n\n", o.samples,
             palette.pigments.size(), table.samples.size(), palette.nm.size(), palette.nm.front(),
             palette.nm.back(), palette.relative ? "relative to S of \"" + o.white + "\"" : "per metre");
  fmt::print("{:<20} {:<20} {:>7} {:>9} {:>10} {:>10} {:>10}\n", "paint", "method", "samples", "measured",
             "error of K", "error of S", "negative");
  for (std::size_t i = 0; i < palette.pigments.size(); ++i) {
    const pigment::Pigment& p = palette.pigments[i];
    const pigment::FitReport& r = found.reports[i];
    const int negative = r.negative_k + r.negative_s;
    fmt::print("{:<20} {:<20} {:>7} {:>9} {:>10} {:>10} {:>10}{}{}\n", p.name, name_of(r.method), r.samples,
               r.measurements, relative_error(p.k, p.k_error), relative_error(p.s, p.s_error), negative,
               negative ? fmt::format("  ({:g} to {:g} nm)", r.negative_from_nm, r.negative_to_nm) : "",
               r.undefined ? fmt::format("  ({} wavelengths tell nothing of S)", r.undefined) : "");
  }
  fmt::print(
      "Errors are medians over wavelengths of the standard error by repeats. Negative: values of K and S that no layer has.\n");

  nlohmann::json out = palette_json(palette);
  for (std::size_t i = 0; i < found.reports.size(); ++i)
    out["pigments"][i]["fit"] = report_json(found.reports[i]);
  note_aperture(o, table, palette, out);

  const pigment::Observation lamp = observe(o.light.viewing(), palette.nm);
  Plot differences{"Measurements of " + o.samples + " predicted from the others",
                   "per cent of the predictions that are no worse",
                   "CIEDE2000, " + o.light.viewing(),
                   {}};
  const auto left_out = pigment::leave_one_repeat_out(table, settings);
  if (!left_out.empty()) {
    Errors pure, mixed;
    for (const pigment::LeftOut& l : left_out) {
      const pigment::Sample& s = table.samples[l.sample];
      const double difference = pigment::ciede2000(lamp.lab(s.values), lamp.lab(l.predicted));
      (s.paints.size() == 1 ? pure : mixed).add(difference, l.rms);
    }
    fmt::print("\nEach measurement predicted from the others (illuminant {}):\n", o.light.viewing());
    for (const auto& [name, e] : {std::pair{"pure paints", pure}, {"mixtures", mixed}}) {
      if (e.differences.empty()) continue;
      fmt::print(
          "  {:<12} {:3} predictions, Delta E 2000 mean {:.2f}, largest {:.2f}; largest rms of R {:.4f}\n",
          name, e.differences.size(), e.mean, e.worst, e.rms);
      differences.series.push_back(
          differences_line(e.differences, name, differences.series.empty() ? "#2b5d8f" : "#c0562f"));
      out["left_out"][name] = {
          {"count", e.differences.size()}, {"mean", e.mean}, {"worst", e.worst}, {"rms", e.rms}};
    }
  }
  std::vector<double> others;
  // Samples of mixtures that the fit did not use, which test the theory itself.
  for (const pigment::Sample& s : table.samples) {
    const bool unused = s.paints.size() > 2 ||
                        (s.paints.size() == 2 && s.paints[0].name != o.white && s.paints[1].name != o.white);
    if (!unused || (palette.relative && s.backing != "opaque")) continue;
    const double difference =
        pigment::ciede2000(lamp.lab(s.values), lamp.lab(pigment::predict(palette, table, s)));
    fmt::print("  not fitted: {:<40} Delta E 2000 {:.2f}\n", s.name, difference);
    others.push_back(difference);
    out["not_fitted"].push_back({{"sample", s.name}, {"difference", difference}});
  }

  if (!o.output.empty()) write_file_atomically(o.output, pigment::palette_text(palette));
  if (!o.json.empty()) write_file_atomically(o.json, out.dump(1) + "\n");
  write_plots(o, palette, lamp);
  if (!others.empty()) differences.series.push_back(differences_line(others, "not fitted", "#3d7a45"));
  if (!o.plot_differences.empty()) {
    if (differences.series.empty())
      tell(
          "note: --plot-differences: no measurement is repeated and every mixture is fitted: nothing to predict\n");
    else
      write_file_atomically(o.plot_differences, svg_plot(differences));
  }
  return 0;
}

std::function<int()> declare(CommandOptions& options) {
  auto o = std::make_shared<FitOptions>();
  options
      .add(
          "samples", o->files,
          "tables of measured samples (text, CGATS, CxF, .json), for example one of each drawdown; or kimera: 13 "
          "acrylics, by miciwan, CC BY 4.0")
      .required();
  options.add("--white", o->white, "name of the white paint of the tints").shows_default();
  o->surface.declare(options, "the measurements");
  o->joint.declare(options);
  options.add("--template", o->is_template, "write an empty table with examples to the file and end");
  o->light.declare(options, "illuminant of the colour differences");
  options.add("-o,--output", o->output, "write the palette to this file, comma-separated").names_output();
  options.add("--json", o->json, "also write palette and report to this file").names_output();
  options.add("--plot", o->plot, "write K/S of all paints to this SVG file").names_output();
  options.add("--plot-k", o->plot_k, "write K of all paints to this SVG file").names_output();
  options.add("--plot-s", o->plot_s, "write S of all paints to this SVG file").names_output();
  options
      .add("--plot-differences", o->plot_differences,
           "write colour differences of predicted and measured samples to this SVG file")
      .names_output();
  return [o] { return fit(*o); };
}

AUREOLE_COMMAND("pigment fit", "K and S of paints from measured samples, with errors and checks", declare);

}  // namespace
}  // namespace aureole

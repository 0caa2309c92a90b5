// SPDX-License-Identifier: Apache-2.0
#include "pigment/joint_fit_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "aureole/core/error.h"
#include "aureole/core/parallel.h"
#include "aureole/core/units.h"
#include "aureole/instrument/paint/paint_colour.h"
#include "aureole/instrument/paint/paint_files.h"
#include "aureole/pigment/hold_out.h"
#include "messages.h"

namespace aureole {
namespace {

/// Largest rms of a well fitted specimen; specimens above it are named.
constexpr double kWellFitted = 0.005;
/// Relative error of K or S above which the value counts as unknown.
constexpr double kKnown = 0.3;

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return n % 2 ? values[n / 2] : (values[n / 2 - 1] + values[n / 2]) / 2;
}

double mean(const std::vector<double>& values) {
  double sum = 0;
  for (const double v : values) sum += v;
  return values.empty() ? 0 : sum / double(values.size());
}

pigment::StreamsSettings streams_settings(const SurfaceOptions& o, const JointOptions& joint) {
  pigment::StreamsSettings s;
  s.g = joint.g, s.varies_g = joint.settings.g > 0;
  s.index = o.given() && o.geometry != "none" ? o.index : 1;
  s.geometry = pigment::geometry_called(o.geometry);
  s.specular = o.light();
  return s;
}

/// The fit of one theory, and its predictions of specimens that were kept back.
struct Candidate {
  std::string name;
  std::unique_ptr<pigment::FilmTheory> theory;
  std::unique_ptr<pigment::JointFit> fit;
  std::vector<pigment::HeldOut> held;
  std::map<std::string, double> difference;

  /// Returns the mean difference of the specimens that were kept back, by which fits are compared; smaller is
  /// better.
  double merit() const {
    std::vector<double> all;
    for (const auto& [name, d] : difference) all.push_back(d);
    return mean(all);
  }
};

std::string ranges(const std::vector<double>& nm, const std::vector<bool>& marked) {
  std::string text;
  for (std::size_t i = 0; i < nm.size(); ++i) {
    if (!marked[i] || (i > 0 && marked[i - 1])) continue;
    std::size_t last = i;
    while (last + 1 < nm.size() && marked[last + 1]) ++last;
    text += (text.empty() ? "" : ", ") +
            (last == i ? fmt::format("{:g}", nm[i]) : fmt::format("{:g} to {:g}", nm[i], nm[last]));
  }
  return text;
}

double median_ratio(const std::vector<double>& errors, const std::vector<double>& values) {
  std::vector<double> ratios;
  for (std::size_t i = 0; i < values.size(); ++i) ratios.push_back(errors[i] / values[i]);
  return 100 * median(ratios);
}

/// Prints errors by the stated noise, which has the theory's own error in it, and by the residuals (`residuals` times this noise).
void print_paints(pigment::JointFit& fit, double residuals, nlohmann::json& out) {
  const pigment::Palette& palette = fit.palette();
  const std::vector<double> volumes = fit.specific_volumes();
  const std::vector<pigment::MeanCosine> cosines = fit.mean_cosines();
  const std::vector<pigment::UnknownPaint> unknown_paints = fit.unknown_paints();
  const bool tells_noise = residuals > 0;
  const std::vector<pigment::PaintErrors> by_residuals =
      tells_noise ? fit.errors(residuals) : std::vector<pigment::PaintErrors>();
  fmt::print("\n{:<24} {:>8} {:>10} {:>10} {:>10}{}{}  only K/S is known at (nm)\n", "paint", "volume",
             "error of K", "error of S", "of K/S",
             tells_noise ? fmt::format(" {:>26}", "by residuals: K, S, K/S") : "",
             cosines.empty() ? "" : fmt::format(" {:>12}", "g"));
  for (std::size_t p = 0; p < palette.pigments.size(); ++p) {
    const pigment::Pigment& one = palette.pigments[p];
    const std::vector<double>& ratio = fit.ratio_error()[p];
    std::vector<bool> hidden(palette.nm.size());
    const auto unknown = std::find_if(unknown_paints.begin(), unknown_paints.end(),
                                      [&](const pigment::UnknownPaint& u) { return u.name == one.name; });
    if (unknown != unknown_paints.end() && !unknown->ratio_is_known) {
      // A guess has no error, since an error would exclude other solutions that the data allow.
      fmt::print("{:<24} {:>8} unknown: one film over one card, or over cards that are alike\n", one.name,
                 "");
      out["pigments"][p]["fit"] = {{"method", "joint"}, {"unknown", true}};
      continue;
    }
    for (std::size_t l = 0; l < palette.nm.size(); ++l)
      hidden[l] = one.s_error[l] > kKnown * one.s[l] && ratio[l] <= kKnown;
    const auto per_cent = [](const std::vector<double>& of) {
      return fmt::format("{:>6.1f} %", 100 * median(of));
    };
    fmt::print("{:<24} {:>8.2f} {:>8.1f} % {:>8.1f} % {:>8.1f} %{}{}  {}\n", one.name, volumes[p],
               median_ratio(one.k_error, one.k), median_ratio(one.s_error, one.s), 100 * median(ratio),
               tells_noise ? "  " + per_cent(by_residuals[p].k) + " " + per_cent(by_residuals[p].s) + " " +
                                 per_cent(by_residuals[p].ratio)
                           : "",
               cosines.empty() ? "" : fmt::format(" {:>5.2f} +- {:.2f}", cosines[p].g, cosines[p].error),
               ranges(palette.nm, hidden));
    nlohmann::json& json = out["pigments"][p]["fit"];
    if (!cosines.empty()) json["g"] = cosines[p].g, json["g_error"] = cosines[p].error;
    json["method"] = "joint", json["specific_volume"] = volumes[p], json["ln_k_over_s_error"] = ratio;
    json["only_k_over_s_known"] = hidden;
    if (tells_noise)
      json["by_residuals"] = {{"ln_k_error", by_residuals[p].k},
                              {"ln_s_error", by_residuals[p].s},
                              {"ln_k_over_s_error", by_residuals[p].ratio}};
  }
  fmt::print(
      "Errors are medians over wavelengths of one standard deviation, by the stated noise, in which the theory's own error is, "
      "and by the residuals, as if the theory were exact. Volume: per mass, relative to the mean paint; the palette has it as "
      "densities, by which `mix` and `match` convert masses.\n");
}

void print_specimens(const pigment::SampleTable& table, const pigment::JointFit& fit, nlohmann::json& out) {
  const std::vector<pigment::SpecimenReport> all = fit.specimens(true);
  int well = 0;
  for (const pigment::SpecimenReport& r : all) well += r.rms <= kWellFitted;
  fmt::print("\n{} of {} specimens are fitted within {:g} % rms.", well, all.size(), 100 * kWellFitted);
  if (well < int(all.size())) {
    fmt::print(" Outliers:\n{:<24} {:>8} {:>8}  {:<34} {:>9}\n", "specimen", "rms", "weight", "worst",
               "thickness");
    for (const pigment::SpecimenReport& r : all) {
      if (r.rms <= kWellFitted) continue;
      const pigment::Sample& s = table.samples[r.worst_sample];
      fmt::print("{:<24} {:>6.2f} % {:>8.2f}  {:<34} {:>9.2f}\n", r.name, 100 * r.rms, r.weight,
                 fmt::format("{:+.1f} % at {:g} nm, {}", 100 * r.worst, r.worst_nm, s.name), r.thickness);
    }
  } else {
    fmt::print("\n");
  }
  bool first = true;
  for (const pigment::SpecimenReport& r : all)
    for (const pigment::SpecimenReport::Dose& d : r.doses) {
      // Skips deviations below 15 %, and deviations within twice their error, which the data do not
      // determine.
      if (std::abs(std::log(d.factor)) < 0.15 || std::abs(std::log(d.factor)) < 2 * d.error / d.factor)
        continue;
      if (first) fmt::print("\nAmounts that the colours contradict:\n");
      first = false;
      fmt::print("  {}: {:.0f} % {} of {} than stated fits (+- {:.0f} %)\n", r.name,
                 100 * std::abs(d.factor - 1), d.factor > 1 ? "more" : "less", d.paint, 100 * d.error);
    }
  for (const pigment::SpecimenReport& r : all) {
    nlohmann::json one = {{"specimen", r.name},       {"rms", r.rms},
                          {"weight", r.weight},       {"outlier", r.rms > kWellFitted},
                          {"thickness", r.thickness}, {"thickness_error", r.thickness_error}};
    for (const pigment::SpecimenReport::Dose& d : r.doses)
      one["amounts"][d.paint] = {{"factor", d.factor}, {"error", d.error}};
    out["specimens"].push_back(std::move(one));
  }
}

/// Prints how residuals compare with the stated noise, by which errors of K and S are stated as well.
void print_residuals(const pigment::ResidualReport& r, const pigment::JointSettings& settings,
                     nlohmann::json& out) {
  constexpr double kFar = 2;
  out["residuals"] = {{"degrees_of_freedom", r.freedom}, {"values", r.values}};
  const std::string noise = fmt::format("the stated noise ({:g} and {:g} % of R, in squares)", settings.noise,
                                        100 * settings.noise_relative);
  if (r.relative == 0) {
    fmt::print(
        "\nThere are too few measured values beside the unknowns: residuals do not tell whether {} holds.\n",
        noise);
    return;
  }
  out["residuals"]["relative_to_noise"] = r.relative;
  fmt::print("\nThe rms of the residuals is {:.2f} of {}; {:.0f} degrees of freedom.\n", r.relative, noise,
             r.freedom);
  if (r.relative < 1 / kFar)
    fmt::print(
        "Errors by the stated noise are too wide by about a factor of {:.1f} if the theory is exact; those by the residuals are "
        "right then. Whether it is exact enough, the 90 % intervals of --hold-out tell.\n",
        1 / r.relative);
  else if (r.relative > kFar)
    fmt::print(
        "Errors of K and S are too narrow by about a factor of {:.1f}: a larger --noise and --relative-noise say it "
        "better.\n",
        r.relative);
}

/// Notes paints that occur in a single mixture and nowhere else, which often are misspelt names of other
/// paints.
void note_single_uses(const std::string& file, const pigment::SampleTable& table) {
  struct Uses {
    std::set<std::string> mixtures;
    int line = 0;
    bool alone = false;
  };
  std::map<std::string, Uses> paints;
  for (const pigment::Sample& s : table.samples)
    for (const pigment::Component& c : s.paints) {
      Uses& uses = paints[c.name];
      uses.mixtures.insert(pigment::specimen_key(s)), uses.alone = uses.alone || s.paints.size() == 1;
      if (uses.line == 0) uses.line = s.line;
    }
  for (const auto& [name, uses] : paints) {
    if (uses.alone || uses.mixtures.size() > 1) continue;
    std::vector<std::string> others;
    for (const auto& [other, of] : paints)
      if (other != name) others.push_back(other);
    tell("note: {}: the paint \"{}\" is in one mixture only and never alone{}\n",
         uses.line > 0 ? fmt::format("{}:{}", file, uses.line) : file, name, did_you_mean(name, others));
  }
}

/// Prints colour differences of specimens that were kept back, by theory, beside the plain fit's.
void print_held_out(const pigment::SampleTable& table, const std::vector<Candidate>& candidates,
                    const std::map<std::string, double>& plain, const std::string& white,
                    const std::string& black, const std::string& illuminant, nlohmann::json& out) {
  fmt::print("\nSpecimens kept back and predicted from the others, CIEDE2000 ({}):\n{:<24} {:>10}",
             illuminant, "specimen", "plain");
  for (const Candidate& c : candidates) fmt::print(" {:>11}", c.name);
  fmt::print("\n");
  std::vector<std::string> names, determined;
  for (const pigment::HeldOut& h : candidates.front().held) {
    const auto base = plain.find(h.specimen);
    fmt::print("{:<24} {:>10}", h.specimen, base == plain.end() ? "-" : fmt::format("{:.2f}", base->second));
    bool all = base != plain.end();
    nlohmann::json one = {{"specimen", h.specimen}};
    if (all) one["plain"] = base->second;
    for (const Candidate& c : candidates) {
      const auto d = c.difference.find(h.specimen);
      all = all && d != c.difference.end();
      fmt::print(" {:>11}", d == c.difference.end() ? "-" : fmt::format("{:.2f}", d->second));
      if (d != c.difference.end()) one[c.name] = d->second;
    }
    const bool told = pigment::is_determined(table, h.specimen, white, black);
    fmt::print("{}{}\n", told ? "" : "  (no other tint tells how its paint scatters)",
               h.reason.empty() ? "" : "  " + h.reason);
    one["determined"] = told;
    out["held_out"]["specimens"].push_back(std::move(one));
    if (!all) continue;
    names.push_back(h.specimen);
    if (told) determined.push_back(h.specimen);
  }
  const auto summary = [&](const std::string& title, const std::vector<std::string>& of,
                           const std::string& key) {
    if (of.empty()) return;
    const auto line = [&](const std::string& name, const std::map<std::string, double>& of_theory) {
      std::vector<double> values, ratios;
      int better = 0;
      for (const std::string& n : of) {
        values.push_back(of_theory.at(n)), ratios.push_back(of_theory.at(n) / plain.at(n));
        better += of_theory.at(n) < plain.at(n);
      }
      fmt::print("  {:<12} mean {:5.2f}, median {:5.2f}, largest {:6.2f}", name, mean(values), median(values),
                 *std::max_element(values.begin(), values.end()));
      nlohmann::json& json = out["held_out"][key][name];
      json = {{"count", of.size()}, {"mean", mean(values)}, {"median", median(values)}};
      if (&of_theory != &plain) {
        fmt::print("; paired with plain: median ratio {:.2f}, better on {} of {}", median(ratios), better,
                   of.size());
        json["median_ratio"] = median(ratios), json["better"] = better;
      }
      fmt::print("\n");
    };
    fmt::print("{} ({}):\n", title, of.size());
    line("plain", plain);
    for (const Candidate& c : candidates) line(c.name, c.difference);
  };
  summary("All that are predicted", names, "all");
  if (determined.size() < names.size())
    summary("Of these, those whose paints other tints determine", determined, "determined");
  for (const Candidate& c : candidates) {
    const double covered = pigment::interval_coverage(table, c.held);
    fmt::print("90 % intervals of {} cover {:.1f} % of the measured reflectances.\n", c.name, 100 * covered);
    out["held_out"]["coverage"][c.name] = covered;
  }
}

}  // namespace

void JointOptions::declare(CommandOptions& options) {
  options.add(
      "--joint", joint,
      "fit all measurements together, with thickness and amounts as unknowns; films over cards need no "
      "thickness");
  options
      .add(
          "--theory", theory,
          "with --joint: two-flux, streams, or best: both are fitted, and the palette is that of the theory that predicts "
          "specimens better which --hold-out keeps back, else that of two-flux")
      .one_of({"two-flux", "streams", "best"})
      .shows_default();
  options
      .add(
          "--hold-out", hold_out,
          "with --joint: specimens to keep back together and predict, A,B; a number of groups; or each: every "
          "mixture by itself")
      .separated_by(',');
  options.add("--black", black, "with --hold-out: name of the black paint of the shades").shows_default();
  options
      .add(
          "--noise", settings.noise,
          "with --joint: error of a reflectance (0 to 1) besides --relative-noise, the theory's own error included")
      .between(1e-5, 0.2)
      .shows_default();
  options
      .add("--relative-noise", settings.noise_relative,
           "with --joint: error of a reflectance as a part of it, added to --noise in squares")
      .between(0.0, 1.0)
      .shows_default();
  options
      .add("--thickness-error", settings.thickness,
           "with --joint: relative error of a film's thickness that is not stated")
      .between(0.0, 3.0)
      .shows_default();
  options.add("--g", g, "with streams: mean cosine of scattering in the paints")
      .between(-0.95, 0.95)
      .shows_default();
  options
      .add(
          "--g-error", settings.g,
          "with streams: relative error of 1 - g of each paint, which is then an unknown; 0: --g holds for all paints")
      .between(0.0, 3.0)
      .shows_default();
  options.add("--amount-error", settings.dose, "with --joint: relative error of the amounts in mixtures")
      .between(0.0, 3.0)
      .shows_default();
}

JointPalette fit_jointly(const std::string& file, const pigment::SampleTable& table,
                         const JointOptions& options, const SurfaceOptions& surface, const std::string& white,
                         const std::string& illuminant, nlohmann::json& out) {
  const pigment::Observation lamp = observe(illuminant, table.nm);
  const bool keeps_back = !options.hold_out.empty();
  return located_in(file, table, [&] {
    for (const std::string& note : pigment::range_notes(table, surface.surface()))
      tell("note: {}: {}\n", file, note);
    note_single_uses(file, table);
    constexpr double kLong = 60, kTooLong = 24 * 3600;
    const double seconds = pigment::joint_fit_seconds(table, options.settings);
    if (seconds > kTooLong)
      throw Error(
          {file, 0, 0},
          fmt::format("a fit of these {} measurements would take some {:.0f} hours; fit a part of them, such "
                      "as a few tints of each paint, or without --joint",
                      table.samples.size(), seconds / 3600));
    if (seconds > kLong)
      tell("note: {}: a fit of {} measurements takes some {:.0f} minutes\n", file, table.samples.size(),
           std::max(1.0, seconds / 60));
    std::vector<Candidate> candidates;
    const auto add = [&](std::unique_ptr<pigment::FilmTheory> theory) {
      Candidate& c = candidates.emplace_back();
      c.theory = std::move(theory), c.name = c.theory->name();
      c.fit = std::make_unique<pigment::JointFit>(table, *c.theory, options.settings);
    };
    if (options.theory != "streams") add(pigment::two_flux_theory(surface.surface()));
    if (options.theory != "two-flux")
      add(pigment::streams_theory(streams_settings(surface, options), for_ranges));

    for (const std::string& note : pigment::joint_notes(*candidates.front().fit))
      tell("note: {}: {}\n", file, note);

    std::map<std::string, double> plain;
    if (keeps_back) {
      for (const auto& [option, name] : {std::pair{"--white", white}, {"--black", options.black}})
        if (!candidates.front().fit->palette().find(name))
          tell("note: {}: no paint is called \"{}\" ({}); the plain fit goes without it\n", file, name,
               option);
      const pigment::HoldOutGroups groups = pigment::hold_out_groups(table, options.hold_out);
      for (Candidate& c : candidates) {
        c.held = pigment::hold_out(table, *c.theory, options.settings, groups, *c.fit, true, for_ranges);
        c.difference = pigment::held_out_differences(table, c.held, lamp);
      }
      const auto two = pigment::two_flux_theory(surface.surface());
      plain = pigment::held_out_differences(
          table, pigment::hold_out_plain(table, *two, groups, white, options.black, for_ranges), lamp);
    }
    // A smaller sum of squares alone does not tell that a theory predicts better: without specimens kept back two fluxes,
    // the simpler theory, are written.
    Candidate& best =
        !keeps_back
            ? candidates.front()
            : *std::min_element(candidates.begin(), candidates.end(),
                                [](const Candidate& a, const Candidate& b) { return a.merit() < b.merit(); });
    Candidate& written = best;
    written.fit->with_errors();
    pigment::Palette palette = written.fit->palette();
    palette.surface = surface.surface();

    std::set<std::string> specimens;
    int measurements = 0;
    for (const pigment::Sample& s : table.samples)
      if (!s.paints.empty()) specimens.insert(pigment::specimen_key(s)), ++measurements;
    fmt::print(
        "{}: {} paints, {} specimens, {} measurements, {} wavelengths from {:g} to {:g} nm; K and S {}\n",
        file, palette.pigments.size(), specimens.size(), measurements, table.nm.size(), table.nm.front(),
        table.nm.back(), palette.relative ? "per film" : "per metre");
    out.update(palette_json(palette));
    for (const Candidate& c : candidates) {
      std::vector<double> rms;
      for (const pigment::SpecimenReport& r : c.fit->specimens()) rms.push_back(100 * r.rms);
      fmt::print(
          "{:<12} sum of squares {:.0f} in {} steps; rms of a specimen: median {:.2f} %, largest {:.2f} %{}\n",
          c.name + ":", c.fit->cost(), c.fit->iterations(), median(rms),
          *std::max_element(rms.begin(), rms.end()),
          candidates.size() == 1 || &c != &written ? ""
          : keeps_back                             ? " (predicts better: in the palette)"
                       : " (in the palette; --hold-out tells which predicts better)");
      out["theories"][c.name] = {{"cost", c.fit->cost()},
                                 {"median_rms_percent", median(rms)},
                                 {"kept", &c == &written},
                                 {"predicts_better", keeps_back && &c == &best}};
    }
    if (written.name == "streams")
      fmt::print(
          "K and S are 2 sigma_a and 3/4 sigma_s (1 - g). `mix`, `match`, `hide`, Python and the BSDF predict by streams with "
          "them.\n");
    const pigment::ResidualReport residuals = written.fit->residuals();
    print_paints(*written.fit, residuals.relative, out);
    print_specimens(table, *written.fit, out);
    print_residuals(residuals, options.settings, out);
    if (keeps_back) print_held_out(table, candidates, plain, white, options.black, illuminant, out);
    return JointPalette{palette, written.fit->ratio_error()};
  });
}

}  // namespace aureole

// SPDX-License-Identifier: Apache-2.0
// aureole pigment colour: figures of measured samples, alone and against a standard.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "aureole/core/error.h"
#include "aureole/core/output_file.h"
#include "aureole/instrument/paint/colour_figures.h"
#include "aureole/instrument/paint/paint_files.h"
#include "aureole/pigment/joint_fit.h"
#include "aureole/pigment/prediction.h"
#include "messages.h"
#include "pigment/pigment_options.h"

namespace aureole {
namespace {

struct ColourOptions {
  std::string samples, standard, white, cie94, to_geometry, to_specular, json;
  DifferenceOptions differences;
  LightOptions light;
  SurfaceOptions surface;
};

/// Returns the interface to which reflectances are converted, or nothing.
std::optional<pigment::Surface> other_surface(const ColourOptions& o) {
  if (o.to_geometry.empty() && o.to_specular.empty()) return {};
  if (!o.surface.given() || o.surface.geometry == "none")
    throw Error(
        "--to-geometry and --to-specular: need the geometry of the measurements, as in --geometry d8 --specular "
        "included");
  SurfaceOptions to = o.surface;
  if (!o.to_geometry.empty()) to.geometry = o.to_geometry;
  if (!o.to_specular.empty()) to.specular = o.to_specular;
  return to.surface();
}

/// Returns the luminous reflectance of the substrate of a sample; nothing if it is not known.
std::optional<double> luminance_below(const pigment::SampleTable& table, const pigment::Sample& sample,
                                      const pigment::Observation& lamp) {
  if (const auto number = pigment::backing_reflectance(sample)) return *number;
  for (const pigment::Sample& s : table.samples)
    if (s.paints.empty() && s.name == sample.backing) return lamp.xyz(s.values)[1];
  return {};
}

/// Returns contrast ratios of layers that were measured over two cards: luminous reflectance over the darker
/// divided by that over the brighter card.
std::map<std::string, double> contrast_ratios(const pigment::SampleTable& table,
                                              const std::vector<pigment::Panel>& samples,
                                              const pigment::Observation& lamp) {
  struct Pair {
    double dark = 2, bright = -1, over_dark = 0, over_bright = 0;
  };
  std::map<std::string, Pair> pairs;
  for (const pigment::Panel& m : samples) {
    const auto below = luminance_below(table, *m.first, lamp);
    if (m.first->paints.empty() || !below) continue;
    Pair& p = pairs[pigment::specimen_key(*m.first)];
    const double y = lamp.xyz(m.values)[1];
    if (*below < p.dark) p.dark = *below, p.over_dark = y;
    if (*below > p.bright) p.bright = *below, p.over_bright = y;
  }
  std::map<std::string, double> ratios;
  for (const auto& [key, p] : pairs)
    if (p.bright > p.dark && p.over_bright > 0) ratios[key] = p.over_dark / p.over_bright;
  return ratios;
}

/// Notes layers that reflect more over the darker card by more than noise, 1 % of the luminous reflectance: 0.4 of L* at 50.
void note_high_contrast(const std::string& file, const std::vector<pigment::Panel>& samples,
                        const std::map<std::string, double>& contrast) {
  constexpr double kNoise = 0.01;
  std::set<std::string> layers;
  std::string first;
  double largest = 0;
  for (const pigment::Panel& m : samples) {
    const auto at = contrast.find(m.first->paints.empty() ? "" : pigment::specimen_key(*m.first));
    if (at == contrast.end() || at->second <= 1 + kNoise || !layers.insert(at->first).second) continue;
    if (at->second > largest) largest = at->second, first = m.name;
  }
  if (layers.empty()) return;
  tell(
      "note: {}: \"{}\"{}: a contrast ratio of{} {:.4f} is above 1: the layer reflects more over the darker card; are the "
      "cards swapped?\n",
      file, first, layers.size() > 1 ? fmt::format(" and {} more layers", layers.size() - 1) : "",
      layers.size() > 1 ? " up to" : "", largest);
}

std::string number_or_dash(const std::optional<double>& value, int digits = 2) {
  return value ? fmt::format("{:.{}f}", shown(*value), digits) : "-";
}

nlohmann::json figures_json(const ColourFigures& f) {
  nlohmann::json out = {{"xyz", f.xyz},
                        {"chromaticity", {f.chromaticity.x, f.chromaticity.y}},
                        {"lab", {f.lab.l, f.lab.a, f.lab.b}},
                        {"chroma", pigment::chroma(f.lab)},
                        {"hue", pigment::hue_degrees(f.lab)}};
  if (f.whiteness)
    out["whiteness"] = {
        {"whiteness", f.whiteness->whiteness}, {"tint", f.whiteness->tint}, {"valid", f.whiteness->is_valid}};
  if (f.yellowness) out["yellowness"] = *f.yellowness;
  return out;
}

nlohmann::json comparison_json(const ColourComparison& c, const std::vector<std::string>& others) {
  nlohmann::json out = {{"lab", {c.lab.l, c.lab.a, c.lab.b}},
                        {"lch", {c.lch.l, c.lch.c, c.lch.h}},
                        {"cie1976", c.cie1976},
                        {"cmc", c.cmc},
                        {"cie94", c.cie94},
                        {"ciede2000", c.ciede2000},
                        {"din99o", c.din99o},
                        {"metamerism", nlohmann::json::object()}};
  if (c.strength)
    out["strength"] = {{"maximum", c.strength->at_maximum},      {"nm", c.strength->nm},
                       {"summed", c.strength->summed},           {"weighted", c.strength->weighted},
                       {"tone", {c.tone.l, c.tone.c, c.tone.h}}, {"tone_ciede2000", c.tone_ciede2000}};
  for (std::size_t i = 0; i < others.size(); ++i) out["metamerism"][others[i]] = c.metamerism[i];
  return out;
}

/// Notes options about differences that have no standard, and sets default values.
void complete(ColourOptions& o) {
  if (o.standard.empty())
    for (const auto& [option, is_given] : {std::pair{"--white", !o.white.empty()},
                                           {"--others", !o.differences.others.empty()},
                                           {"--cmc", !o.differences.cmc.empty()},
                                           {"--cie94", !o.cie94.empty()}})
      if (is_given) tell("note: {}: has no effect without --standard\n", option);
  o.differences.complete();
}

/// The standard or the white, with its interface and its file.
struct Reference {
  std::string text, file;
  MeasuredReflectance measured;
  SurfaceOptions surface;
};

/// Reads "FILE#SAMPLE". Its interface is the one of its own file, or of `samples` where its file states none.
/// `given` are the options, and `samples` are the options with the geometry of the file of samples, of which
/// all or one are evaluated. Repeats are noted unless they are among these samples. Notes of the file are printed
/// unless they were printed with the samples.
Reference reference_called(const std::string& text, const std::string& option,
                           const std::string& samples_file, const SurfaceOptions& given,
                           const SurfaceOptions& samples, bool samples_are_one) {
  Reference r{text, text.substr(0, std::min(text.rfind('#'), text.size())),
              mean_reflectance_called(text, option), samples};
  if (!r.measured.repeats.empty() && (r.file != samples_file || samples_are_one))
    tell("note: {}: {}\n", r.file, r.measured.repeats);
  if (r.file == samples_file) return r;
  for (const std::string& note : r.measured.notes) tell("note: {}: {}\n", r.file, note);
  if (!r.measured.instrument.geometry.empty()) {
    r.surface = given;
    r.surface.take(r.measured.instrument, r.file, false);
  } else if (!given.given() && samples.given()) {
    tell("note: {}: states no geometry; that of {} is taken for it\n", r.file, samples_file);
  }
  return r;
}

/// Returns the hue angle as text, or a dash for greys, which have no hue.
std::string hue_text(const pigment::Lab& lab) {
  return pigment::chroma(lab) < 0.005 ? "-" : fmt::format("{:.1f}", pigment::hue_degrees(lab));
}

/// Returns the reflectances of a reference as an instrument with the interface of the samples would measure
/// them.
std::vector<double> as_measured_by(const Reference& r, const SurfaceOptions& samples,
                                   const std::vector<double>& nm) {
  std::vector<double> values = r.measured.at(nm);
  if (r.surface.text() == samples.text()) return values;
  const pigment::Surface from = r.surface.surface(), to = samples.surface();
  for (std::size_t i = 0; i < nm.size(); ++i) try {
      values[i] = pigment::converted_reflectance(from, to, values[i]);
    } catch (const std::domain_error& e) {
      throw Error({r.file, 0, 0}, fmt::format("\"{}\" at {:g} nm: {}", r.text, nm[i], e.what()));
    }
  return values;
}

int colour(ColourOptions o) {
  complete(o);
  const auto mark = o.samples.rfind('#');
  const bool is_one = mark != o.samples.npos && mark > 0;
  const std::string file = is_one ? o.samples.substr(0, mark) : o.samples;
  pigment::SampleTable table = read_sample_file(file, pigment::Recipes::optional);
  for (const std::string& note : table.notes) tell("note: {}: {}\n", file, note);
  located_in(file, table, [&] { return pigment::check_not_above_white(table), 0; });
  const SurfaceOptions given = o.surface;
  o.surface.take(table.instrument, file, false);
  const auto to = other_surface(o);
  o.surface.note_unused();
  if (!o.to_specular.empty() && (o.to_geometry.empty() ? o.surface.geometry : o.to_geometry) == "45_0")
    tell("note: --to-specular: has no effect at 45_0, where specular light is never measured\n");
  std::vector<double> nm = table.nm;
  std::vector<double> standard, white;
  ColourSettings settings{
      .viewing = o.light.viewing(),
      .cmc_l = o.differences.cmc[0],
      .cmc_c = o.differences.cmc[1],
      .cie94 = o.cie94 == "textiles" ? pigment::Cie94::textiles : pigment::Cie94::graphic_arts};
  settings.others = o.light.others(o.differences.others);

  // Colours are evaluated at those of the samples' wavelengths that the standard and the white have as well.
  std::optional<Reference> of_standard, of_white;
  if (!o.standard.empty())
    of_standard = reference_called(o.standard, "--standard", file, given, o.surface, is_one);
  if (!o.white.empty() && of_standard)
    of_white = reference_called(o.white, "--white", file, given, o.surface, is_one);
  for (const auto* other : {&of_standard, &of_white})
    if (*other && !to &&
        !((*other)->measured.instrument.geometry == table.instrument.geometry &&
          (*other)->measured.instrument.specular == table.instrument.specular))
      tell(
          "note: {} and {} state different geometries; their differences contain that of the instruments; "
          "--to-geometry and --to-specular convert both\n",
          file, (*other)->text);
  const auto through = std::count_if(
      table.samples.begin(), table.samples.end(),
      [](const pigment::Sample& s) { return s.quantity == pigment::Sample::Quantity::transmittance; });
  if (through > 0) tell("note: {}: {} transmittances are left out\n", file, through);
  std::vector<std::size_t> kept;
  if (nm.size() < 2)
    throw Error({file, 0, 0},
                fmt::format("has one wavelength, {:g} nm; a colour needs those from 400 to 700 nm",
                            nm.empty() ? 0 : nm.front()));
  for (std::size_t i = 0; i < nm.size(); ++i) {
    const auto has = [&](const std::optional<Reference>& m) {
      return !m || (nm[i] >= m->measured.nm.front() && nm[i] <= m->measured.nm.back());
    };
    if (has(of_standard) && has(of_white)) kept.push_back(i);
  }
  if (kept.size() < 2) throw Error("--standard: its wavelengths and those of " + file + " do not overlap");
  if (kept.size() < nm.size())
    tell("note: {}: {} of {} wavelengths are used, which the standard has as well\n", file, kept.size(),
         nm.size());
  const auto cut = [&](const std::vector<double>& values) {
    std::vector<double> result;
    for (const std::size_t i : kept) result.push_back(values[i]);
    return result;
  };
  nm = cut(nm);
  for (pigment::Sample& s : table.samples) s.values = cut(s.values);
  for (const auto* other : {&of_standard, &of_white})
    if (*other && (*other)->measured.nm != table.nm)
      tell(
          "note: {}: has other wavelengths than {}; {} of the latter are used, and values between the {} measured ones are "
          "interpolated\n",
          (*other)->text, file, nm.size(), (*other)->measured.nm.size());
  if (const std::string note = sampling_note(settings.viewing, nm); !note.empty())
    tell("note: {}: {}\n", file, note);
  const auto seen = [&](std::vector<double> values, const std::string& in, const std::string& name,
                        const SurfaceOptions& measured) {
    if (!to) return values;
    const pigment::Surface from = measured.surface();
    for (std::size_t i = 0; i < values.size(); ++i) try {
        values[i] = pigment::converted_reflectance(from, *to, values[i]);
      } catch (const std::domain_error& e) {
        throw Error({in, 0, 0}, fmt::format("sample \"{}\" at {:g} nm: {}", name, nm[i], e.what()));
      }
    return values;
  };
  settings.strength.surface = to ? *to : o.surface.surface();
  if (of_standard) {
    const Reference& r = *of_standard;
    standard = seen(r.measured.at(nm), r.file, r.text, r.surface);
    // The standard for strength is converted, since K/S of each sample follows by its own interface.
    if (!to) settings.standard_for_strength = as_measured_by(r, o.surface, nm);
  }
  if (of_white)
    settings.strength.white =
        to ? seen(of_white->measured.at(nm), of_white->file, of_white->text, of_white->surface)
           : as_measured_by(*of_white, o.surface, nm);

  std::vector<pigment::Panel> samples = pigment::panels_of(table);
  if (is_one) {
    const std::string wanted = o.samples.substr(mark + 1);
    std::vector<pigment::Panel> found = pigment::panels_called(samples, wanted);
    if (found.empty()) mean_reflectance(file, wanted);  // throws an Error with the names of the samples
    samples = std::move(found);
  }
  if (samples.empty()) throw Error({file, 0, 0}, "there is no reflectance");
  std::vector<std::string> repeats;
  for (const pigment::Panel& m : samples)
    if (m.count > 1) repeats.push_back(fmt::format("{} measurements of \"{}\"", m.count, m.name));
  constexpr std::size_t kShown = 3;
  if (!repeats.empty()) {
    const std::size_t more = repeats.size() - std::min(repeats.size(), kShown);
    repeats.resize(repeats.size() - more);
    tell("note: {}: {}{} are averaged\n", file, fmt::join(repeats, ", "),
         more > 0 ? fmt::format(" and those of {} more samples", more) : "");
  }
  for (pigment::Panel& m : samples) {
    m.values = seen(m.values, file, m.name, o.surface);
  }

  const pigment::Observation lamp = observe(settings.viewing, nm);
  const std::map<std::string, double> contrast = contrast_ratios(table, samples, lamp);
  note_high_contrast(file, samples, contrast);
  const auto title = [](const pigment::Panel& m) { return m.name; };
  std::size_t width = 10;
  for (const pigment::Panel& m : samples) width = std::max(width, std::min<std::size_t>(title(m).size(), 40));

  nlohmann::json out = {{"viewing", settings.viewing}, {"samples", nlohmann::json::array()}};
  const bool is_as_measured = !to && o.surface.given() && o.surface.geometry != "none";
  fmt::print("{}, observer {} degrees; {}{}{}\n\n", viewing_of(settings.viewing).illuminant,
             viewing_of(settings.viewing).field == pigment::Field::ten ? 10 : 2,
             is_as_measured ? "colours as measured; interface for K/S: " : "interface: ", o.surface.text(),
             to ? ", converted to " + (o.to_geometry.empty() ? "" : o.to_geometry + " ") +
                      (o.to_specular.empty() ? "" : "specular " + o.to_specular)
                : "");
  fmt::print("{:<{}} {:>7} {:>7} {:>7} {:>7} {:>7} {:>7} {:>7} {:>7} {:>7} {:>7} {:>7} {:>8}\n", "sample",
             width, "X", "Y", "Z", "L*", "a*", "b*", "C*", "h", "W", "T", "YI", "contrast");
  const auto row = [&](const std::string& name, const std::vector<double>& values,
                       const std::optional<double>& ratio) {
    const ColourFigures f = colour_figures(nm, values, settings.viewing);
    // Whether the sample is white enough for the formula of whiteness.
    const bool is_white = f.whiteness && f.whiteness->is_valid;
    fmt::print(
        "{:<{}} {:7.2f} {:7.2f} {:7.2f} {:7.2f} {:7.2f} {:7.2f} {:7.2f} {:>7} {:>7} {:>7} {:>7} {:>8}\n",
        name, width, f.xyz[0], f.xyz[1], f.xyz[2], shown(f.lab.l), shown(f.lab.a), shown(f.lab.b),
        pigment::chroma(f.lab), hue_text(f.lab),
        number_or_dash(is_white ? std::optional(f.whiteness->whiteness) : std::nullopt),
        number_or_dash(is_white ? std::optional(f.whiteness->tint) : std::nullopt),
        number_or_dash(f.yellowness), number_or_dash(ratio, 4));
    nlohmann::json one = figures_json(f);
    one["sample"] = name;
    if (ratio) one["contrast_ratio"] = *ratio;
    return one;
  };
  if (of_standard) out["standard"] = row(o.standard.substr(o.standard.rfind('#') + 1), standard, {});
  for (const pigment::Panel& m : samples) {
    const auto ratio =
        contrast.find(m.first->paints.empty() ? std::string() : pigment::specimen_key(*m.first));
    out["samples"].push_back(
        row(title(m), m.values, ratio == contrast.end() ? std::nullopt : std::optional(ratio->second)));
  }
  fmt::print(
      "W, T: CIE whiteness and tint, of whites under D65. YI: yellowness by ASTM E313, under C and D65. Contrast: "
      "luminous reflectance over the dark card divided by that over the bright one.\n");

  if (of_standard) {
    std::vector<ColourComparison> all;
    for (const pigment::Panel& m : samples) {
      all.push_back(compare_colours(nm, standard, m.values, settings));
      out["samples"][all.size() - 1]["difference"] = comparison_json(all.back(), settings.others);
    }
    fmt::print("\n{:<{}} {:>7} {:>7} {:>7} {:>7} {:>7} {:>8} {:>9} {:>7} {:>9} {:>7}\n", "difference", width,
               "dL*", "da*", "db*", "dC*", "dH*", "dE*ab",
               fmt::format("CMC({:g}:{:g})", o.differences.cmc[0], o.differences.cmc[1]), "CIE94",
               "CIEDE2000", "DIN99o");
    for (std::size_t i = 0; i < all.size(); ++i) {
      const ColourComparison& c = all[i];
      fmt::print(
          "{:<{}} {:+7.2f} {:+7.2f} {:+7.2f} {:+7.2f} {:+7.2f} {:8.2f} {:9.2f} {:7.2f} {:9.2f} {:7.2f}\n",
          title(samples[i]), width, shown(c.lab.l), shown(c.lab.a), shown(c.lab.b), shown(c.lch.c),
          shown(c.lch.h), c.cie1976, c.cmc, c.cie94, c.ciede2000, c.din99o);
    }
    fmt::print("\n{:<{}} {:>8} {:>7} {:>8} {:>9} {:>16} {:>7} {:>7} {:>9}\n", "K/S strength, %", width,
               "maximum", "at nm", "summed", "weighted", "tint tone:  dL*", "dC*", "dH*", "CIEDE2000");
    for (std::size_t i = 0; i < all.size(); ++i) {
      const ColourComparison& c = all[i];
      if (c.strength)
        fmt::print("{:<{}} {:8.2f} {:7.0f} {:8.2f} {:9.2f} {:+16.2f} {:+7.2f} {:+7.2f} {:9.2f}\n",
                   title(samples[i]), width, 100 * c.strength->at_maximum, c.strength->nm,
                   100 * c.strength->summed, 100 * c.strength->weighted, shown(c.tone.l), shown(c.tone.c),
                   shown(c.tone.h), c.tone_ciede2000);
      else
        fmt::print("{:<{}} -  {}\n", title(samples[i]), width, c.no_strength);
    }
    fmt::print("Tint tone: differences that remain at equal strength at the maximum.\n");
    if (!settings.others.empty()) {
      fmt::print("\n{:<{}}", "metamerism", width);
      for (const std::string& other : settings.others) fmt::print(" {:>9}", other);
      fmt::print("\n");
      for (std::size_t i = 0; i < all.size(); ++i) {
        fmt::print("{:<{}}", title(samples[i]), width);
        for (const double index : all[i].metamerism) fmt::print(" {:9.2f}", index);
        fmt::print("\n");
      }
      fmt::print(
          "Metamerism: special index, Delta E*ab under the other illuminant or observer after the sample is corrected "
          "to match under {}.\n",
          settings.viewing);
    }
  }
  if (!o.json.empty()) write_file_atomically(o.json, out.dump(1) + "\n");
  return 0;
}

std::function<int()> declare(CommandOptions& options) {
  auto o = std::make_shared<ColourOptions>();
  options
      .add("samples", o->samples,
           "table of measured samples, or FILE#SAMPLE for one of them; recipes are not needed")
      .required();
  options.add("--standard", o->standard, "FILE#SAMPLE: the standard to compare with").names_input();
  o->light.declare(options, "illuminant of the colours");
  o->differences.declare(options);
  options.add("--cie94", o->cie94, "parametric factors of CIE94: graphic_arts (default) or textiles")
      .one_of({"graphic_arts", "textiles"});
  options
      .add("--white", o->white,
           "FILE#SAMPLE: the white or base without colorant, whose K/S is subtracted for the strength")
      .names_input();
  o->surface.declare(options, "the measurements");
  options.add("--to-geometry", o->to_geometry, "convert reflectances to this geometry: diffuse, d8 or 45_0")
      .one_of({"diffuse", "d8", "45_0"});
  options.add("--to-specular", o->to_specular, "convert reflectances: specular included or excluded")
      .one_of({"included", "excluded"});
  options.add("--json", o->json, "also write the figures to this file").names_output();
  return [o] { return colour(*o); };
}

AUREOLE_COMMAND("pigment colour",
                "Colour, strength, opacity and metamerism of measured samples, alone and against a standard",
                declare);

}  // namespace
}  // namespace aureole

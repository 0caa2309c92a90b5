// SPDX-License-Identifier: Apache-2.0
// aureole pigment colour: figures of measured samples, alone and against a standard.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

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
  std::string samples, standard, white, cie94 = "graphic_arts", to_geometry, to_specular, json;
  std::vector<std::string> others{"A", "F11"};
  std::vector<double> cmc{2, 1};
  LightOptions light;
  SurfaceOptions surface;
};

/// The interface to which reflectances are converted, or nothing.
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

/// Repeats of one sample, averaged.
struct Measured {
  std::string name;
  std::vector<double> values;
  int count = 0;
  const pigment::Sample* first = nullptr;
};

/// Reflectances of the table by name, in the file's order. Samples of one name over different cards are kept apart.
std::vector<Measured> measured_samples(const pigment::SampleTable& table, const std::string& wanted) {
  std::vector<Measured> all;
  for (const pigment::Sample& s : table.samples) {
    if (s.quantity != pigment::Sample::Quantity::reflectance) continue;
    if (!wanted.empty() && s.name != wanted) continue;
    const auto same = std::find_if(all.begin(), all.end(), [&](const Measured& m) {
      return m.name == s.name && m.first->backing == s.backing;
    });
    Measured& m = same == all.end() ? all.emplace_back(Measured{s.name, s.values, 0, &s}) : *same;
    if (same != all.end())
      for (std::size_t i = 0; i < m.values.size(); ++i)
        m.values[i] += (s.values[i] - m.values[i]) / (m.count + 1);
    ++m.count;
  }
  return all;
}

/// Luminous reflectance of what a sample lies on; nothing if it is not known.
std::optional<double> luminance_below(const pigment::SampleTable& table, const pigment::Sample& sample,
                                      const pigment::Observation& lamp) {
  if (const auto number = pigment::backing_reflectance(sample)) return *number;
  for (const pigment::Sample& s : table.samples)
    if (s.paints.empty() && s.name == sample.backing) return lamp.xyz(s.values)[1];
  return {};
}

/// Contrast ratios of layers that were measured over two cards: luminous reflectance over the darker divided by that
/// over the brighter card.
std::map<std::string, double> contrast_ratios(const pigment::SampleTable& table,
                                              const std::vector<Measured>& samples,
                                              const pigment::Observation& lamp) {
  struct Pair {
    double dark = 2, bright = -1, over_dark = 0, over_bright = 0;
  };
  std::map<std::string, Pair> pairs;
  for (const Measured& m : samples) {
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

std::string number_or_dash(const std::optional<double>& value, int digits = 2) {
  return value ? fmt::format("{:.{}f}", *value, digits) : "-";
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

int colour(ColourOptions o) {
  if (o.cmc.size() != 2 || !(o.cmc[0] > 0 && o.cmc[1] > 0))
    throw Error("--cmc: expected two positive numbers l:c, as in 2:1");
  const auto mark = o.samples.rfind('#');
  const bool is_one = mark != o.samples.npos && mark > 0;
  const std::string file = is_one ? o.samples.substr(0, mark) : o.samples;
  pigment::SampleTable table = read_sample_file(file, pigment::Recipes::optional);
  for (const std::string& note : table.notes) tell("note: {}: {}\n", file, note);
  o.surface.take(table.instrument, file);
  const auto to = other_surface(o);
  o.surface.note_unused();
  std::vector<double> nm = table.nm;
  std::vector<double> standard, white;
  ColourSettings settings{
      .viewing = o.light.viewing(),
      .cmc_l = o.cmc[0],
      .cmc_c = o.cmc[1],
      .cie94 = o.cie94 == "textiles" ? pigment::Cie94::textiles : pigment::Cie94::graphic_arts};
  for (const std::string& other : o.others)
    if (viewed_at(other, o.light.observer) != settings.viewing)
      settings.others.push_back(viewed_at(other, o.light.observer));
  if (o.standard.empty() && !o.white.empty()) tell("note: --white: has no effect without --standard\n");

  // All are taken at the samples' wavelengths that the standard and the white have as well.
  std::optional<MeasuredReflectance> of_standard, of_white;
  if (!o.standard.empty()) of_standard = mean_reflectance_called(o.standard, "--standard");
  if (!o.white.empty() && of_standard) of_white = mean_reflectance_called(o.white, "--white");
  for (const auto& [text, other] : {std::pair{o.standard, of_standard}, {o.white, of_white}})
    if (other && !(other->instrument.geometry == table.instrument.geometry &&
                   other->instrument.specular == table.instrument.specular))
      tell("note: {} and {} state different geometries; their differences contain that of the instruments\n",
           file, text);
  const auto through = std::count_if(
      table.samples.begin(), table.samples.end(),
      [](const pigment::Sample& s) { return s.quantity == pigment::Sample::Quantity::transmittance; });
  if (through > 0) tell("note: {}: {} transmittances are left out\n", file, through);
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < nm.size(); ++i) {
    const auto has = [&](const std::optional<MeasuredReflectance>& m) {
      return !m || (nm[i] >= m->nm.front() && nm[i] <= m->nm.back());
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
  const auto seen = [&](std::vector<double> values, const std::string& name) {
    if (!to) return values;
    const pigment::Surface from = o.surface.surface();
    for (std::size_t i = 0; i < values.size(); ++i) try {
        values[i] = pigment::converted_reflectance(from, *to, values[i]);
      } catch (const std::domain_error& e) {
        throw Error({file, 0, 0}, fmt::format("sample \"{}\" at {:g} nm: {}", name, nm[i], e.what()));
      }
    return values;
  };
  settings.strength.surface = to ? *to : o.surface.surface();
  if (of_standard) standard = seen(of_standard->at(nm), o.standard);
  if (of_white) settings.strength.white = seen(of_white->at(nm), o.white);

  std::vector<Measured> samples = measured_samples(table, is_one ? o.samples.substr(mark + 1) : "");
  if (samples.empty() && is_one)
    mean_reflectance(file, o.samples.substr(mark + 1));  // throws, with the names
  if (samples.empty()) throw Error({file, 0, 0}, "there is no reflectance");
  for (Measured& m : samples) m.values = seen(m.values, m.name);

  const pigment::Observation lamp = observe(settings.viewing, nm);
  const std::map<std::string, double> contrast = contrast_ratios(table, samples, lamp);
  const auto title = [&](const Measured& m) {
    const bool repeated = std::count_if(samples.begin(), samples.end(),
                                        [&](const Measured& other) { return other.name == m.name; }) > 1;
    return repeated ? m.name + " over " + m.first->backing : m.name;
  };
  std::size_t width = 10;
  for (const Measured& m : samples) width = std::max(width, std::min<std::size_t>(title(m).size(), 40));

  nlohmann::json out = {{"viewing", settings.viewing}, {"samples", nlohmann::json::array()}};
  fmt::print("{}, observer {} degrees; interface: {}{}\n\n", viewing_of(settings.viewing).illuminant,
             viewing_of(settings.viewing).field == pigment::Field::ten ? 10 : 2, o.surface.text(),
             to ? ", converted to " + (o.to_geometry.empty() ? "" : o.to_geometry + " ") +
                      (o.to_specular.empty() ? "" : "specular " + o.to_specular)
                : "");
  fmt::print("{:<{}} {:>7} {:>7} {:>7} {:>7} {:>7} {:>7} {:>7} {:>7} {:>7} {:>7} {:>7} {:>8}\n", "sample",
             width, "X", "Y", "Z", "L*", "a*", "b*", "C*", "h", "W", "T", "YI", "contrast");
  const auto row = [&](const std::string& name, const std::vector<double>& values,
                       const std::optional<double>& ratio) {
    const ColourFigures f = colour_figures(nm, values, settings.viewing);
    // The formula of whiteness holds for whites only.
    const bool is_white = f.whiteness && f.whiteness->is_valid;
    fmt::print(
        "{:<{}} {:7.2f} {:7.2f} {:7.2f} {:7.2f} {:7.2f} {:7.2f} {:7.2f} {:7.1f} {:>7} {:>7} {:>7} {:>8}\n",
        name, width, f.xyz[0], f.xyz[1], f.xyz[2], f.lab.l, f.lab.a, f.lab.b, pigment::chroma(f.lab),
        pigment::hue_degrees(f.lab),
        number_or_dash(is_white ? std::optional(f.whiteness->whiteness) : std::nullopt),
        number_or_dash(is_white ? std::optional(f.whiteness->tint) : std::nullopt),
        number_or_dash(f.yellowness), number_or_dash(ratio, 4));
    nlohmann::json one = figures_json(f);
    one["sample"] = name;
    if (ratio) one["contrast_ratio"] = *ratio;
    return one;
  };
  if (of_standard) out["standard"] = row(o.standard.substr(o.standard.rfind('#') + 1), standard, {});
  for (const Measured& m : samples) {
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
    for (const Measured& m : samples) {
      all.push_back(compare_colours(nm, standard, m.values, settings));
      out["samples"][all.size() - 1]["difference"] = comparison_json(all.back(), settings.others);
    }
    fmt::print("\n{:<{}} {:>7} {:>7} {:>7} {:>7} {:>7} {:>8} {:>9} {:>7} {:>9} {:>7}\n", "difference", width,
               "dL*", "da*", "db*", "dC*", "dH*", "dE*ab", fmt::format("CMC({:g}:{:g})", o.cmc[0], o.cmc[1]),
               "CIE94", "CIEDE2000", "DIN99o");
    for (std::size_t i = 0; i < all.size(); ++i) {
      const ColourComparison& c = all[i];
      fmt::print(
          "{:<{}} {:+7.2f} {:+7.2f} {:+7.2f} {:+7.2f} {:+7.2f} {:8.2f} {:9.2f} {:7.2f} {:9.2f} {:7.2f}\n",
          title(samples[i]), width, c.lab.l, c.lab.a, c.lab.b, c.lch.c, c.lch.h, c.cie1976, c.cmc, c.cie94,
          c.ciede2000, c.din99o);
    }
    fmt::print("\n{:<{}} {:>8} {:>7} {:>8} {:>9} {:>16} {:>7} {:>7} {:>9}\n", "K/S strength, %", width,
               "maximum", "at nm", "summed", "weighted", "tint tone:  dL*", "dC*", "dH*", "CIEDE2000");
    for (std::size_t i = 0; i < all.size(); ++i) {
      const ColourComparison& c = all[i];
      if (c.strength)
        fmt::print("{:<{}} {:8.2f} {:7.0f} {:8.2f} {:9.2f} {:+16.2f} {:+7.2f} {:+7.2f} {:9.2f}\n",
                   title(samples[i]), width, 100 * c.strength->at_maximum, c.strength->nm,
                   100 * c.strength->summed, 100 * c.strength->weighted, c.tone.l, c.tone.c, c.tone.h,
                   c.tone_ciede2000);
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
  options.add("--standard", o->standard, "FILE#SAMPLE: the standard to compare with");
  o->light.declare(options, "illuminant of the colours");
  options
      .add("--others", o->others,
           "illuminants, or observers as in D65/10, of the metamerism indices (default A,F11)")
      .separated_by(',');
  options.add("--cmc", o->cmc, "l:c of the CMC difference (default 2:1)").separated_by(':');
  options.add("--cie94", o->cie94, "parametric factors of CIE94")
      .one_of({"graphic_arts", "textiles"})
      .shows_default();
  options.add("--white", o->white,
              "FILE#SAMPLE: the white or base without colorant, whose K/S is subtracted for the strength");
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

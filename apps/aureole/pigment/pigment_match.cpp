// SPDX-License-Identifier: Apache-2.0
// aureole pigment match: recipes for a colour, and their differences under other illuminants.
#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>
#include <utility>

#include "aureole/core/error.h"
#include "aureole/core/input_file.h"
#include "aureole/core/letter_case.h"
#include "aureole/core/output_file.h"
#include "aureole/core/parallel.h"
#include "aureole/core/units.h"
#include "aureole/instrument/paint/paint_colour.h"
#include "aureole/instrument/paint/paint_files.h"
#include "aureole/pigment/text_table.h"
#include "messages.h"
#include "pigment/pigment_options.h"

namespace aureole {
namespace {

struct MatchOptions {
  std::string palette = "kimera", target, json, plot, thickness;
  std::vector<std::string> others = kUsualOthers, least, most, only, apart;
  std::string by = "colour", prices;
  int paints = 3, solutions = 5;
  double substrate = 1, smallest = 1e-4, opacity = 0, within = 1;
  bool trade_offs = false;
  LightOptions light;
  SurfaceOptions surface;
};

/// Parses bounds such as "white=0.5".
void set_bounds(const pigment::Palette& palette, const std::vector<std::string>& texts,
                const std::string& option, std::vector<double>& bounds) {
  for (const std::string& text : texts) {
    const auto equals = text.rfind('=');
    if (equals == text.npos) throw Error(option + ": write PAINT=SHARE, got \"" + text + "\"");
    const std::string name = text.substr(0, equals);
    const auto at = palette.find(name);
    if (!at) throw Error(option + ": unknown paint \"" + name + "\"" + did_you_mean(name, palette.names()));
    double share = 0;
    try {
      share = parse_number(text.substr(equals + 1));
    } catch (const Error& e) {
      throw Error(option + " " + text + ": " + e.message());
    }
    if (!(share >= 0 && share <= 1)) throw Error(option + " " + text + ": a share is in [0, 1]");
    bounds[*at] = share;
  }
}

/// Reads pairs such as "white,black".
std::vector<std::pair<std::size_t, std::size_t>> forbidden_pairs(const pigment::Palette& palette,
                                                                 const std::vector<std::string>& texts) {
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  for (const std::string& text : texts) {
    const auto comma = text.find(',');
    if (comma == text.npos || text.find(',', comma + 1) != text.npos)
      throw Error("--apart: write two paints, PAINT,PAINT, got \"" + text + "\"");
    std::size_t found[2];
    for (std::size_t i = 0; i < 2; ++i) {
      std::string name = i == 0 ? text.substr(0, comma) : text.substr(comma + 1);
      name.erase(0, std::min(name.find_first_not_of(' '), name.size()));
      name.erase(name.find_last_not_of(' ') + 1);
      const auto at = palette.find(name);
      if (!at) throw Error("--apart: unknown paint \"" + name + "\"" + did_you_mean(name, palette.names()));
      found[i] = *at;
    }
    if (found[0] == found[1]) throw Error("--apart: two different paints are expected, got \"" + text + "\"");
    pairs.emplace_back(found[0], found[1]);
  }
  return pairs;
}

/// Whether a line of a table of prices has headings, such as "paint" and "price (EUR/kg)".
bool is_heading(const pigment::TextRow& row) {
  const std::string first = lower_case(row.cells[0].text), second = lower_case(row.cells[1].text);
  return first.starts_with("paint") || first.starts_with("pigment") || first == "name" ||
         second.starts_with("price") || second.starts_with("cost");
}

/// Reads a table of two columns, paint and price per mass, for every paint that a recipe may have.
std::vector<double> read_prices(const std::string& file, const pigment::Palette& palette,
                                const std::vector<double>& most) {
  std::vector<double> prices(palette.pigments.size(), -1);
  std::vector<int> lines(palette.pigments.size());
  try {
    const std::string text = pigment::utf8_text(read_table_file(file).str());
    bool is_first = true;
    for (const pigment::TextRow& row : pigment::read_pairs(text, false)) {
      const bool may_be_heading = std::exchange(is_first, false);
      if (row.cells.size() != 2)
        throw pigment::TextError(row.line, 0,
                                 "expected a paint and its price, as in the line\n    white,3.50");
      const auto price = pigment::finite_number(row.cells[1].text);
      if (!price && may_be_heading && is_heading(row)) continue;
      if (!price || *price < 0)
        throw pigment::TextError(
            row.line, row.cells[1].column,
            "expected a price per mass, not negative, got \"" + row.cells[1].text + "\"");
      const auto at = palette.find(row.cells[0].text);
      if (!at) {
        tell("note: {}:{}: the palette has no paint \"{}\"{}\n", file, row.line, row.cells[0].text,
             did_you_mean(row.cells[0].text, palette.names()));
        continue;
      }
      if (lines[*at] > 0)
        throw pigment::TextError(row.line, row.cells[0].column,
                                 fmt::format("\"{}\" has a price in line {} already; one line for each paint",
                                             row.cells[0].text, lines[*at]));
      prices[*at] = *price, lines[*at] = row.line;
    }
  } catch (const pigment::TextError& e) {
    throw Error({file, e.line(), e.column()}, e.what());
  }
  for (std::size_t p = 0; p < prices.size(); ++p) {
    if (prices[p] < 0 && most[p] > 0)
      throw Error({file, 0, 0}, "there is no price of \"" + palette.pigments[p].name + "\"");
    prices[p] = std::max(prices[p], 0.0);
  }
  return prices;
}

/// Sets the interface of the target's instrument, so that recipes are predicted as that instrument measures
/// them, unless options give an interface.
void take_geometry(ColourTarget& wanted, SurfaceOptions& surface) {
  if (wanted.instrument.geometry.empty()) return;
  const bool is_given = surface.given(),
             has_interface = wanted.palette.surface.through < 1 ||
                             (wanted.palette.streams && wanted.palette.streams->index > 1);
  if (!is_given && !has_interface) {
    tell(
        "note: {}: was measured at the geometry {}; that has no effect, since this palette has no interface\n",
        wanted.file, SurfaceOptions::stated(wanted.instrument));
    return;
  }
  surface.take(wanted.instrument, wanted.file);
  if (is_given) return;
  surface.set(wanted.palette, wanted.file);
  tell(
      "note: recipes are predicted with this interface instead of the palette's; --geometry states another\n");
}

int match(MatchOptions o) {
  const pigment::Palette whole = usable_palette(o.palette, o.surface);
  const std::string viewing = o.light.viewing();
  ColourTarget wanted = read_colour_target(o.target, whole, viewing, "target");
  for (const std::string& note : wanted.notes) tell("note: {}: {}\n", wanted.file, note);
  take_geometry(wanted, o.surface);
  o.surface.note_unused();
  const pigment::Palette& palette = wanted.palette;
  const pigment::Observation lamp = observe(viewing, palette.nm);
  std::vector<pigment::Observation> others;
  for (const std::string& other : o.light.others(o.others)) others.push_back(observe(other, palette.nm));

  pigment::MatchSettings settings;
  settings.max_paints = o.paints, settings.solutions = o.solutions;
  settings.least.assign(palette.pigments.size(), 0);
  settings.most.assign(palette.pigments.size(), o.only.empty() ? 1 : 0);
  for (const std::string& name : o.only) set_bounds(palette, {name + "=1"}, "--only", settings.most);
  set_bounds(palette, o.least, "--least", settings.least);
  set_bounds(palette, o.most, "--most", settings.most);
  settings.thickness = thickness_for(palette, o.thickness);
  note_substrate(o.substrate, o.thickness);
  settings.substrate = {o.substrate};
  settings.by = o.by == "spectrum" ? pigment::MatchBy::spectrum
                : o.by == "lamps"  ? pigment::MatchBy::lamps
                                   : pigment::MatchBy::colour;
  settings.forbidden = forbidden_pairs(palette, o.apart);
  settings.smallest = o.smallest, settings.least_contrast = o.opacity;
  settings.trade_offs = o.trade_offs, settings.within = o.within;
  if (!o.prices.empty()) settings.price = read_prices(o.prices, palette, settings.most);
  if (o.within != MatchOptions().within && !o.trade_offs)
    tell("note: --within: has no effect without --trade-offs\n");

  const auto start = std::chrono::steady_clock::now();
  std::vector<pigment::Match> found;
  try {
    found = pigment::match(
        palette, wanted.target, lamp, others, settings,
        [](std::size_t n, const auto& body, std::size_t grain) { for_ranges(n, body, grain); });
  } catch (const std::domain_error& e) {
    throw Error(e.what());
  }
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (!found.empty() && !palette.streams)
    note_two_flux_doubt(palette, pigment::mix(palette, found.front().fractions), settings.thickness,
                        o.substrate, o.surface.index, lamp, "the first recipe");
  const bool spectral = !wanted.target.reflectance.empty();

  const pigment::Lab& lab = wanted.target.lab;
  fmt::print("{}: L* {:.2f}  a* {:.2f}  b* {:.2f} under {}; {} paints{}, at most {} of them, {:.2f} s\n\n",
             o.target, lab.l, shown(lab.a), shown(lab.b), viewing, palette.pigments.size(),
             palette.streams ? ", by streams" : "", o.paints, seconds);
  fmt::print("{:>9}", viewing);
  if (spectral) {
    for (const auto& other : others) fmt::print("{:>9}", other.name());
    fmt::print("{:>9}", "rms R");
  }
  const bool has_layer = !std::isinf(settings.thickness);
  if (!settings.price.empty()) fmt::print("{:>9}", "cost");
  if (has_layer) fmt::print("{:>9}", "contrast");
  fmt::print("{:>9}", "dosing");
  fmt::print("  {:<9}recipe\n", "colour");
  nlohmann::json out = {{"target", {lab.l, lab.a, lab.b}},
                        {"illuminant", viewing},
                        {"theory", palette.streams ? "streams" : "two fluxes"},
                        {"solutions", nlohmann::json::array()}};
  for (const pigment::Match& m : found) {
    const auto recipe = components_of(palette, m.fractions);
    fmt::print("{:9.3f}", m.difference);
    nlohmann::json one = {{"difference", m.difference},
                          {"lab", {m.lab.l, m.lab.a, m.lab.b}},
                          {"recipe", nlohmann::json::object()}};
    if (spectral) {
      for (std::size_t i = 0; i < others.size(); ++i) {
        fmt::print("{:9.3f}", m.differences[i]);
        one["metamerism"][others[i].name()] = m.differences[i];
      }
      fmt::print("{:9.4f}", m.rms);
      one["rms"] = m.rms;
    }
    if (!settings.price.empty()) fmt::print("{:9.3f}", m.cost), one["cost"] = m.cost;
    if (has_layer) fmt::print("{:9.4f}", m.contrast), one["contrast_ratio"] = m.contrast;
    fmt::print("{:9.3f}", m.dosing_error);
    one["dosing_error"] = m.dosing_error;
    for (std::size_t p = 0; p < palette.pigments.size(); ++p)
      if (m.fractions[p] > 0) one["dosing"][palette.pigments[p].name] = m.dosing[p];
    fmt::print("  {:<9}{}\n", screen_colour(lamp.xyz(m.reflectance), lamp.white()),
               pigment::recipe_text(recipe));
    for (const auto& c : recipe) one["recipe"][c.name] = c.fraction;
    out["solutions"].push_back(std::move(one));
  }
  fmt::print("Columns are CIEDE2000 differences to the target under each lamp{}.\n",
             spectral ? "; those beyond the first are metamerism" : "");
  fmt::print(
      "dosing: CIEDE2000 of independent errors of 1 % in the amount of each paint.{}{}\n",
      settings.price.empty() ? "" : " cost: per mass of the mixture, by the prices of " + o.prices + ".",
      has_layer ? " contrast: luminous reflectance over black divided by that over white (0.8)." : "");
  if (o.trade_offs)
    fmt::print(
        "Trade-offs: no recipe within a difference of {:g} is better than one of these in colour difference{} and "
        "metamerism at once.\n",
        o.within, settings.price.empty() ? "" : ", cost");
  if (!spectral)
    fmt::print("The target is a colour, not a reflectance: what it does under other lamps is not known.\n");

  if (!o.json.empty()) write_file_atomically(o.json, out.dump(1) + "\n");
  if (!o.plot.empty()) {
    Plot plot{"Recipes for " + o.target, "wavelength, nm", "reflectance", {}};
    if (spectral)
      plot.series.push_back(spectrum_line(palette.nm, wanted.target.reflectance, "target", "black"));
    const char* const kColours[] = {"#c03020", "#2050c0", "#208030", "#a06000", "#8030a0"};
    for (std::size_t i = 0; i < std::min(found.size(), std::size(kColours)); ++i)
      plot.series.push_back(spectrum_line(palette.nm, found[i].reflectance,
                                          pigment::recipe_text(components_of(palette, found[i].fractions), 1),
                                          kColours[i]));
    write_file_atomically(o.plot, svg_plot(plot));
  }
  return 0;
}

std::function<int()> declare(CommandOptions& options) {
  auto o = std::make_shared<MatchOptions>();
  options.add("palette", o->palette, "palette.csv as `aureole pigment fit` writes it, or kimera").required();
  options.add("target", o->target, "#rrggbb, \"lab(50, 20, -10)\", a colour name of HTML, or FILE#SAMPLE")
      .required();
  options.add("-n,--paints", o->paints, "largest number of paints of a recipe").between(1, 6).shows_default();
  options.add("--solutions", o->solutions, "largest number of recipes to print")
      .between(1, 1000)
      .shows_default();
  o->light.declare(options, "illuminant under which colours are matched");
  options.add("--others", o->others, "illuminants of the report on metamerism (default A,F11)")
      .separated_by(',');
  options
      .add(
          "--by", o->by,
          "what recipes minimise: colour (under the illuminant), lamps (under all of them), or spectrum (rms of R)")
      .one_of({"colour", "lamps", "spectrum"})
      .shows_default();
  options
      .add("--prices", o->prices,
           "table of two columns, paint and price per mass: prints the cost of recipes")
      .names_input();
  options.add("--trade-offs", o->trade_offs,
              "print recipes of which no other is better in colour, cost and metamerism at once");
  options.add("--within", o->within, "with --trade-offs: largest colour difference")
      .between(0.001, 100)
      .shows_default();
  options.add("--apart", o->apart, "PAINT,PAINT: two paints that no recipe has together; may be repeated")
      .takes_each_time(1);
  options.add("--smallest", o->smallest, "smallest fraction of a paint that can be dosed")
      .between(0.0, 0.49)
      .shows_default();
  options
      .add("--opacity", o->opacity,
           "with --thickness: least contrast ratio over black and white (0.8), for example 0.98")
      .between(0.0, 0.9999);
  options.add("--least", o->least, "PAINT=FRACTION: lower bound of a paint in all recipes")
      .takes_each_time(1);
  options.add("--most", o->most, "PAINT=FRACTION: upper bound of a paint in all recipes").takes_each_time(1);
  options.add("--only", o->only, "use only the paints given by this option; may be repeated")
      .takes_each_time(1);
  options.add(
      "--thickness", o->thickness,
      "layer thickness, \"20um\"; for relative palettes a number, in 1/S of the white (default: opaque)");
  options.add("--substrate", o->substrate, "inner reflectance of the substrate, for layers with a thickness")
      .between(0.0, 1.0)
      .shows_default();
  o->surface.declare(options, "the result, instead of the palette's interface");
  options.add("--json", o->json, "also write the solutions to this file").names_output();
  options.add("--plot", o->plot, "write the reflectances of five solutions to this SVG file").names_output();
  return [o] { return match(*o); };
}

AUREOLE_COMMAND("pigment match", "Recipes of at most n paints for a colour", declare);

}  // namespace
}  // namespace aureole

// SPDX-License-Identifier: Apache-2.0
// aureole color: the colour of spectra and of colours that are stated, and their differences.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "aureole/core/error.h"
#include "aureole/core/output_file.h"
#include "aureole/instrument/paint/colour_figures.h"
#include "aureole/instrument/paint/paint_files.h"
#include "aureole/pigment/colour_spaces.h"
#include "command.h"
#include "messages.h"
#include "pigment/pigment_options.h"

namespace aureole {
namespace {

struct ColorOptions {
  std::vector<std::string> targets;
  std::string standard, json;
  DifferenceOptions differences;
  LightOptions light;
};

/// A colour, and its spectrum if it has one.
struct NamedColour {
  std::string name;
  std::vector<double> nm, values;
  pigment::Xyz xyz{}, white{};  ///< a perfect diffuser has Y = 1
};

/// Monochromatic light every 5 nm for the observer of a viewing.
struct SpectrumLocus {
  std::vector<double> nm;
  std::vector<pigment::Chromaticity> points;
};
SpectrumLocus locus_of(const std::string& field) {
  SpectrumLocus locus;
  for (int nm = 360; nm <= 780; ++nm) locus.nm.push_back(nm);
  // Under equal energy, at steps of a nanometre, the weights are the observer's functions.
  const pigment::Observation observer = observe("E/" + field, locus.nm);
  for (const pigment::Xyz& w : observer.weights()) locus.points.push_back(pigment::chromaticity(w));
  // At the ends of the spectrum the chromaticities hardly change and rounding would turn them back.
  const auto first = std::ptrdiff_t(400 - 360), last = std::ptrdiff_t(700 - 360) + 1;
  locus.nm = {locus.nm.begin() + first, locus.nm.begin() + last};
  locus.points = {locus.points.begin() + first, locus.points.begin() + last};
  return locus;
}

std::vector<NamedColour> colours_called(const std::string& text, const std::string& viewing,
                                        const std::string& option) {
  // "FILE" or "FILE#SAMPLE"; "#rrggbb" and names are stated colours.
  const auto mark = text.rfind('#');
  const bool is_stated = mark == 0 || (text.starts_with("lab(")) ||
                         (mark == text.npos && text != kMeasuredPaints && text.find('.') == text.npos &&
                          text.find('/') == text.npos);
  if (is_stated) {
    const ColourTarget target = read_colour_target(text, {}, viewing, option);
    std::vector<double> nm;
    for (int i = 360; i <= 830; ++i) nm.push_back(i);
    NamedColour c{text, {}, {}, {}, observe(viewing, nm).white()};
    c.xyz = pigment::xyz_of_lab(target.target.lab, c.white);
    return {c};
  }
  const std::string file = text.substr(0, mark);
  pigment::SampleTable table = read_sample_file(file, pigment::Recipes::optional);
  for (const std::string& note : table.notes) tell("note: {}: {}\n", file, note);
  std::vector<pigment::Panel> panels = pigment::panels_of(table);
  if (mark != text.npos) {
    panels = pigment::panels_called(panels, text.substr(mark + 1));
    if (panels.empty()) mean_reflectance(file, text.substr(mark + 1));  // throws, with the names
  }
  if (panels.empty()) throw Error({file, 0, 0}, "there is no reflectance");
  const pigment::Observation lamp = observe(viewing, table.nm);
  if (const std::string note = sampling_note(viewing, table.nm); !note.empty())
    tell("note: {}: {}\n", file, note);
  std::vector<NamedColour> all;
  for (const pigment::Panel& p : panels) {
    if (p.count > 1) tell("note: {}: {} measurements of \"{}\" are averaged\n", file, p.count, p.name);
    all.push_back({p.name, table.nm, p.values, lamp.xyz(p.values), lamp.white()});
  }
  return all;
}

nlohmann::json describe(const NamedColour& c, const std::string& viewing, const SpectrumLocus& locus) {
  const Viewing of = viewing_of(viewing);
  const pigment::Chromaticity xy = pigment::chromaticity(c.xyz);
  const pigment::UcsChromaticity uv = pigment::ucs_chromaticity(c.xyz);
  const pigment::Lab lab = pigment::lab_of_xyz(c.xyz, c.white);
  const pigment::Luv luv = pigment::luv_of_xyz(c.xyz, c.white);
  const pigment::DominantWavelength d =
      pigment::dominant_wavelength(xy, pigment::chromaticity(c.white), locus.nm, locus.points);
  fmt::print("{}\n  X {:.3f}  Y {:.3f}  Z {:.3f}   x {:.5f}  y {:.5f}   u' {:.5f}  v' {:.5f}\n", c.name,
             100 * c.xyz[0], 100 * c.xyz[1], 100 * c.xyz[2], xy.x, xy.y, uv.u, uv.v);
  fmt::print("  L* {:.3f}  a* {:.3f}  b* {:.3f}  C*ab {:.3f}  h {:.2f}   u* {:.3f}  v* {:.3f}   {}\n", lab.l,
             shown(lab.a), shown(lab.b), pigment::chroma(lab), pigment::hue_degrees(lab), shown(luv.u),
             shown(luv.v), screen_colour(c.xyz, c.white));
  nlohmann::json out = {{"name", c.name},
                        {"xyz", {100 * c.xyz[0], 100 * c.xyz[1], 100 * c.xyz[2]}},
                        {"xy", {xy.x, xy.y}},
                        {"uv", {uv.u, uv.v}},
                        {"lab", {lab.l, lab.a, lab.b}},
                        {"luv", {luv.l, luv.u, luv.v}}};
  if (d.nm > 0 && d.purity > 1e-4) {
    fmt::print("  {} wavelength {:.1f} nm, excitation purity {:.4f}\n",
               d.is_complementary ? "complementary" : "dominant", d.nm, d.purity);
    out["dominant_wavelength"] = {{"nm", d.nm}, {"complementary", d.is_complementary}, {"purity", d.purity}};
  }
  if (of.illuminant == "D65") {
    const pigment::Whiteness w = pigment::cie_whiteness(c.xyz, c.white, of.field);
    fmt::print("  CIE whiteness {:.2f}, tint {:.2f}{}\n", w.whiteness, w.tint,
               w.is_valid ? "" : " (the sample is no white for which they hold)");
    out["whiteness"] = {{"whiteness", w.whiteness}, {"tint", w.tint}, {"valid", w.is_valid}};
  }
  if (const auto yellow = pigment::yellowness(c.xyz, of.illuminant, of.field)) {
    fmt::print("  yellowness ASTM E313 {:.2f}\n", *yellow);
    out["yellowness"] = *yellow;
  }
  return out;
}

nlohmann::json compare(const NamedColour& standard, const NamedColour& c, const ColorOptions& o,
                       const std::string& viewing) {
  const pigment::Lab a = pigment::lab_of_xyz(standard.xyz, standard.white),
                     b = pigment::lab_of_xyz(c.xyz, c.white);
  const pigment::LchDifference lch = pigment::lch_difference(a, b);
  fmt::print(
      "  against {}: dL* {:.3f}  da* {:.3f}  db* {:.3f}  dC* {:.3f}  dH* {:.3f}\n"
      "  Delta E*ab {:.3f}  CIEDE2000 {:.3f}  CMC({:g}:{:g}) {:.3f}  CIE94 {:.3f}  DIN99o {:.3f}\n",
      standard.name, shown(b.l - a.l), shown(b.a - a.a), shown(b.b - a.b), shown(lch.c), shown(lch.h),
      pigment::cie1976(a, b), pigment::ciede2000(a, b), o.differences.cmc[0], o.differences.cmc[1],
      pigment::cmc(a, b, o.differences.cmc[0], o.differences.cmc[1]), pigment::cie94(a, b),
      pigment::din99o(a, b));
  nlohmann::json out = {{"standard", standard.name},
                        {"cie1976", pigment::cie1976(a, b)},
                        {"ciede2000", pigment::ciede2000(a, b)},
                        {"cmc", pigment::cmc(a, b, o.differences.cmc[0], o.differences.cmc[1])},
                        {"cie94", pigment::cie94(a, b)},
                        {"din99o", pigment::din99o(a, b)}};
  const std::vector<std::string> others = o.light.others(o.differences.others);
  if (standard.values.empty() || c.values.empty() || standard.nm != c.nm) {
    if (!standard.values.empty() && !c.values.empty())
      tell("note: \"{}\" and \"{}\" have other wavelengths; no metamerism is computed\n", standard.name,
           c.name);
    return out;
  }
  const pigment::Observation lamp = observe(viewing, c.nm);
  std::vector<std::string> parts;
  for (const std::string& other : others) {
    const double index = pigment::metamerism_index(lamp, observe(other, c.nm), standard.values, c.values);
    parts.push_back(fmt::format("{} {:.3f}", other, index));
    out["metamerism"][other] = index;
  }
  fmt::print("  metamerism, Delta E*ab: {}\n", fmt::join(parts, "  "));
  return out;
}

int color(ColorOptions o) {
  o.differences.complete();
  const std::string viewing = o.light.viewing();
  const SpectrumLocus locus = locus_of(o.light.field());
  std::optional<NamedColour> standard;
  if (!o.standard.empty()) {
    const std::vector<NamedColour> found = colours_called(o.standard, viewing, "--standard");
    if (found.size() > 1)
      throw Error({o.standard, 0, 0}, fmt::format("has {} samples: name one as FILE#SAMPLE", found.size()));
    standard = found.front();
  }
  nlohmann::json out = {{"viewing", viewing}, {"colours", nlohmann::json::array()}};
  fmt::print("under {}, observer of {} degrees\n", viewing_of(viewing).illuminant, o.light.field());
  for (const std::string& target : o.targets)
    for (const NamedColour& c : colours_called(target, viewing, target)) {
      nlohmann::json one = describe(c, viewing, locus);
      if (standard) one["difference"] = compare(*standard, c, o, viewing);
      out["colours"].push_back(std::move(one));
    }
  if (!o.json.empty()) write_file_atomically(o.json, out.dump(1) + "\n");
  return 0;
}

std::function<int()> declare_color(CommandOptions& options) {
  auto o = std::make_shared<ColorOptions>();
  options
      .add("colors", o->targets,
           "files of spectra (.csv, .cxf, .cgats), FILE#SAMPLE, #rrggbb, names of HTML, or lab(L, a, b)")
      .required();
  options.add("--standard", o->standard, "the colour to compare with, stated likewise");
  o->light.declare(options, "illuminant of the colours");
  o->differences.declare(options);
  options.add("--json", o->json, "also write the figures to this file").names_output();
  return [o] { return color(*o); };
}

AUREOLE_COMMAND(
    "color", "Colour of spectra and of stated colours: CIE coordinates, whiteness, wavelength, differences",
    declare_color);

}  // namespace
}  // namespace aureole

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

#include "aureole/core/output_file.h"
#include "aureole/instrument/paint/colour_description.h"
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

nlohmann::json describe(const NamedColour& c, const std::string& viewing) {
  const ColourDescription d = describe_colour(c, viewing);
  fmt::print("{}\n  X {:.3f}  Y {:.3f}  Z {:.3f}   x {:.5f}  y {:.5f}   u' {:.5f}  v' {:.5f}\n", c.name,
             d.xyz[0], d.xyz[1], d.xyz[2], d.xy.x, d.xy.y, d.uv.u, d.uv.v);
  fmt::print("  L* {:.3f}  a* {:.3f}  b* {:.3f}  C*ab {:.3f}  h {:.2f}   u* {:.3f}  v* {:.3f}   {}\n",
             d.lab.l, shown(d.lab.a), shown(d.lab.b), pigment::chroma(d.lab), pigment::hue_degrees(d.lab),
             shown(d.luv.u), shown(d.luv.v), d.screen);
  nlohmann::json out = {{"name", c.name},
                        {"xyz", d.xyz},
                        {"xy", {d.xy.x, d.xy.y}},
                        {"uv", {d.uv.u, d.uv.v}},
                        {"lab", {d.lab.l, d.lab.a, d.lab.b}},
                        {"luv", {d.luv.l, d.luv.u, d.luv.v}}};
  if (const auto& w = d.dominant) {
    fmt::print("  {} wavelength {:.1f} nm, excitation purity {:.4f}\n",
               w->is_complementary ? "complementary" : "dominant", w->nm, w->purity);
    out["dominant_wavelength"] = {
        {"nm", w->nm}, {"complementary", w->is_complementary}, {"purity", w->purity}};
  }
  if (const auto& w = d.whiteness) {
    fmt::print("  CIE whiteness {:.2f}, tint {:.2f}{}\n", w->whiteness, w->tint,
               w->is_valid ? "" : " (the sample is no white for which they hold)");
    out["whiteness"] = {{"whiteness", w->whiteness}, {"tint", w->tint}, {"valid", w->is_valid}};
  }
  if (d.yellowness) {
    fmt::print("  yellowness ASTM E313 {:.2f}\n", *d.yellowness);
    out["yellowness"] = *d.yellowness;
  }
  return out;
}

nlohmann::json compare(const NamedColour& standard, const NamedColour& c, const ColorOptions& o,
                       const std::string& viewing) {
  std::vector<std::string> notes;
  const ColourDifference d =
      colour_difference(standard, c, viewing, o.differences.cmc, o.light.others(o.differences.others), notes);
  for (const std::string& note : notes) tell("note: {}\n", note);
  fmt::print(
      "  against {}: dL* {:.3f}  da* {:.3f}  db* {:.3f}  dC* {:.3f}  dH* {:.3f}\n"
      "  Delta E*ab {:.3f}  CIEDE2000 {:.3f}  CMC({:g}:{:g}) {:.3f}  CIE94 {:.3f}  DIN99o {:.3f}\n",
      standard.name, shown(d.lab.l), shown(d.lab.a), shown(d.lab.b), shown(d.lch.c), shown(d.lch.h),
      d.cie1976, d.ciede2000, o.differences.cmc[0], o.differences.cmc[1], d.cmc, d.cie94, d.din99o);
  nlohmann::json out = {{"standard", standard.name}, {"cie1976", d.cie1976},
                        {"ciede2000", d.ciede2000},  {"cmc", d.cmc},
                        {"cie94", d.cie94},          {"din99o", d.din99o}};
  std::vector<std::string> parts;
  for (const auto& [other, index] : d.metamerism) {
    parts.push_back(fmt::format("{} {:.3f}", other, index));
    out["metamerism"][other] = index;
  }
  if (!parts.empty()) fmt::print("  metamerism, Delta E*ab: {}\n", fmt::join(parts, "  "));
  return out;
}

int color(ColorOptions o) {
  o.differences.complete();
  const std::string viewing = o.light.viewing();
  std::vector<std::string> notes;
  std::optional<NamedColour> standard;
  if (!o.standard.empty()) standard = colour_called(o.standard, viewing, "--standard", notes);
  nlohmann::json out = {{"viewing", viewing}, {"colours", nlohmann::json::array()}};
  fmt::print("under {}, observer of {} degrees\n", viewing_of(viewing).illuminant, o.light.field());
  for (const std::string& target : o.targets)
    for (const NamedColour& c : colours_called(target, viewing, target, notes)) {
      for (const std::string& note : notes) tell("note: {}\n", note);
      notes.clear();
      nlohmann::json one = describe(c, viewing);
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
  options.add("--standard", o->standard, "the colour to compare with, stated likewise").names_input();
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

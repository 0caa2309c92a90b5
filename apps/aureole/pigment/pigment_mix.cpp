// SPDX-License-Identifier: Apache-2.0
// aureole pigment mix: reflectance and colour of a mixture of paints.
#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "aureole/core/error.h"
#include "aureole/core/output_file.h"
#include "aureole/core/parallel.h"
#include "aureole/instrument/paint/paint_colour.h"
#include "aureole/instrument/paint/paint_files.h"
#include "aureole/pigment/streams_mixture.h"
#include "pigment/pigment_options.h"

namespace aureole {
namespace {

struct MixOptions {
  LayerOfPaint layer;
  double substrate = 1, step = 20;
  std::string plot;
  int ladder = 0;
  bool is_free = false;
  SurfaceOptions surface;
};

/// Returns mixtures of the recipe in which the first paint's fraction varies from one to zero in equal steps.
std::vector<std::vector<double>> ladder_of(const pigment::Palette& palette,
                                           const std::vector<double>& fractions, int steps) {
  const std::size_t first = std::size_t(
      std::find_if(fractions.begin(), fractions.end(), [](double f) { return f > 0; }) - fractions.begin());
  if (fractions[first] == 1) throw Error("--ladder: the recipe has one paint only");
  std::vector<std::vector<double>> all;
  for (int i = 0; i <= steps; ++i) {
    const double share = 1 - double(i) / steps;
    std::vector<double>& f = all.emplace_back(palette.pigments.size());
    for (std::size_t p = 0; p < f.size(); ++p)
      f[p] = p == first ? share : fractions[p] * (1 - share) / (1 - fractions[first]);
  }
  return all;
}

/// Reflectances and transmittances of layers.
struct Measured {
  std::vector<double> reflectance, transmittance;
  explicit Measured(const std::vector<pigment::LayerTransfer>& layers) {
    for (const pigment::LayerTransfer& l : layers)
      reflectance.push_back(l.reflectance), transmittance.push_back(l.transmittance);
  }
};

int mix(const MixOptions& o) {
  o.surface.note_unused();
  if (o.is_free && o.layer.thickness.empty())
    throw Error("--free: a free film has a thickness; give one, as in --thickness 20um");
  if (o.is_free && o.substrate != 1) throw Error("--substrate: a free film (--free) has none");
  const pigment::Palette palette = usable_palette(o.layer.palette, o.surface);
  const std::vector<double> fractions =
      recipe_fractions(palette, o.layer.recipe, o.layer.by_volume, "recipe");
  const double thickness = thickness_for(palette, o.layer.thickness);
  note_substrate(o.substrate, o.layer.thickness);
  const double substrate[] = {o.substrate};
  const pigment::Observation lamp = observe(o.layer.light.viewing(), palette.nm);
  std::optional<pigment::StreamsMixture> streams;
  if (palette.streams) streams.emplace(palette, for_ranges);
  const auto film = [&](const std::vector<double>& f) {
    if (streams) return Measured(streams->free_film(f, thickness));
    std::vector<pigment::LayerTransfer> layers;
    for (const pigment::Coefficients& c : pigment::mix(palette, f))
      layers.push_back(pigment::outer_transfer(palette.surface, pigment::layer(c, thickness)));
    return Measured(layers);
  };
  const auto reflectance = [&](const std::vector<double>& f) {
    if (o.is_free) return film(f).reflectance;
    if (streams) return streams->reflectance(f, thickness, substrate);
    return pigment::paint_reflectance(pigment::mix(palette, f), thickness, substrate, palette.surface);
  };
  const pigment::Paint paint = pigment::mix(palette, fractions);
  const std::vector<double> mixed = reflectance(fractions);
  const std::vector<double> through = o.is_free ? film(fractions).transmittance : std::vector<double>();
  if (!streams && !o.is_free)
    note_two_flux_doubt(palette, paint, thickness, o.substrate, o.surface.index, lamp, "this layer");

  fmt::print("{}\n{}{}, illuminant {}: {}\n\n", pigment::recipe_text(components_of(palette, fractions)),
             std::isinf(thickness) ? "opaque"
             : o.is_free           ? fmt::format("a free film, {} thick", o.layer.thickness)
                                   : fmt::format("{} thick over {:g}", o.layer.thickness, o.substrate),
             streams ? ", by streams" : "", o.layer.light.viewing(), colour_text(lamp, mixed));
  if (o.is_free) fmt::print("in transmission: {}\n\n", colour_text(lamp, through));
  fmt::print("{:>8} {:>12} {:>12} {:>9} {:>9}{}\n", "nm", palette.relative ? "K, relative" : "K, 1/m",
             palette.relative ? "S, relative" : "S, 1/m", "R inner", "R",
             o.is_free ? fmt::format(" {:>9}", "T") : "");
  double next = palette.nm.front();
  for (std::size_t i = 0; i < palette.nm.size(); ++i) {
    if (palette.nm[i] < next) continue;
    while (next <= palette.nm[i]) next += o.step;
    // Streams and free films print no reflectance below the interface: light there is not diffuse, and no single number
    // describes its reflectance.
    fmt::print("{:8.1f} {:12.5g} {:12.5g} {:>9} {:9.5f}{}\n", palette.nm[i], paint[i].k, paint[i].s,
               streams || o.is_free
                   ? "-"
                   : fmt::format("{:.5f}", pigment::inner_reflectance(palette.surface, mixed[i])),
               mixed[i], o.is_free ? fmt::format(" {:9.5f}", through[i]) : "");
  }
  nlohmann::json out = {{"theory", streams ? "streams" : "two fluxes"},
                        {"recipe", nlohmann::json::object()},
                        {"wavelengths_nm", palette.nm},
                        {"reflectance", mixed}};
  if (o.is_free) out["transmittance"] = through;
  for (const auto& c : components_of(palette, fractions)) out["recipe"][c.name] = c.fraction;
  for (const auto& c : paint) out["k"].push_back(c.k), out["s"].push_back(c.s);
  const pigment::Lab lab = lamp.lab(mixed);
  out["lab"] = {lab.l, lab.a, lab.b};

  Plot plot{pigment::recipe_text(components_of(palette, fractions)), "wavelength, nm", "reflectance", {}};
  if (o.ladder > 0) {
    fmt::print("\n{:>8}\n", "ladder");
    for (const auto& step : ladder_of(palette, fractions, o.ladder)) {
      const std::vector<double> r = reflectance(step);
      const std::string recipe = pigment::recipe_text(components_of(palette, step));
      fmt::print("  {}  {}\n", colour_text(lamp, r), recipe);
      plot.series.push_back(spectrum_line(palette.nm, r, "", screen_colour(lamp.xyz(r), lamp.white())));
    }
  }
  plot.series.push_back(spectrum_line(palette.nm, mixed, "",
                                      o.ladder > 0 ? "black" : screen_colour(lamp.xyz(mixed), lamp.white())));
  if (!o.plot.empty()) write_file_atomically(o.plot, svg_plot(plot));
  if (!o.layer.json.empty()) write_file_atomically(o.layer.json, out.dump(1) + "\n");
  return 0;
}

std::function<int()> declare(CommandOptions& options) {
  auto o = std::make_shared<MixOptions>();
  o->layer.declare(options);
  options.add("--substrate", o->substrate, "inner reflectance of the substrate, for layers with a thickness")
      .between(0.0, 1.0)
      .shows_default();
  options.add(
      "--free", o->is_free,
      "a free film of this thickness, without a substrate: reflectance and transmittance, with an interface on each side");
  o->surface.declare(options, "the result, instead of the palette's interface");
  options.add("--step", o->step, "step between printed wavelengths in nm").between(0.01, 1e9).shows_default();
  options
      .add("--ladder", o->ladder,
           "also print that many mixtures, from the first paint alone to the others alone")
      .between(1, 1000);
  options.add("--plot", o->plot, "write the reflectance, with the ladder, to this SVG file").names_output();
  return [o] { return mix(*o); };
}

AUREOLE_COMMAND("pigment mix", "Reflectance and colour of a mixture of paints", declare);

}  // namespace
}  // namespace aureole

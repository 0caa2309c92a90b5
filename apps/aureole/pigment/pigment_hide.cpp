// SPDX-License-Identifier: Apache-2.0
// aureole pigment hide: hiding power of a paint.
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
#include "aureole/pigment/hiding.h"
#include "aureole/pigment/streams_mixture.h"
#include "pigment/pigment_options.h"

namespace aureole {
namespace {

struct HideOptions {
  LayerOfPaint layer;
  double black = 0, white = 0.8, ratio = pigment::kHidden, step = 20, solids = 0, rate = 0;
  std::string plot;
  SurfaceOptions surface;
};

int hide(const HideOptions& o) {
  if (!(o.white > o.black)) throw Error("--white: must reflect more than --black");
  o.surface.note_unused();
  const pigment::Palette palette = usable_palette(o.layer.palette, o.surface);
  const std::vector<double> fractions =
      recipe_fractions(palette, o.layer.recipe, o.layer.by_volume, "recipe");
  const pigment::Paint paint = pigment::mix(palette, fractions);
  const pigment::Observation lamp = observe(o.layer.light.viewing(), palette.nm);
  std::optional<pigment::StreamsMixture> streams;
  if (palette.streams) streams.emplace(palette, for_ranges);
  const std::vector<double> shifts = streams ? pigment::g_shifts(palette, fractions) : std::vector<double>();
  const auto luminous = [&](double thickness, double below) {
    const double substrate[] = {below};
    return lamp.xyz(streams ? streams->reflectance(fractions, thickness, substrate)
                            : pigment::paint_reflectance(paint, thickness, substrate, palette.surface))[1];
  };
  const auto contrast = [&](double thickness) {
    return luminous(thickness, o.black) / luminous(thickness, o.white);
  };
  double rate = 0;
  for (const pigment::Coefficients& c : paint) rate = std::max(rate, c.k + c.s);
  const double hidden = rate > 0 ? pigment::hiding_thickness(contrast, 1 / rate, o.ratio) : INFINITY;
  const auto thickness_text = [&](double t) {
    if (std::isinf(t)) return std::string("never");
    return palette.per_film   ? fmt::format("{:.4g} films", t)
           : palette.relative ? fmt::format("{:.4g} /S of the white", t)
                              : fmt::format("{:.4g} um", 1e6 * t);
  };

  const bool has_thickness = !o.layer.thickness.empty();
  if (!streams)
    note_two_flux_doubt(
        palette, paint, has_thickness ? thickness_for(palette, o.layer.thickness) : hidden, o.black,
        o.surface.index, lamp,
        (has_thickness ? "this layer" : "the layer that just hides") + fmt::format(" over {:g}", o.black));

  fmt::print("{}\n", pigment::recipe_text(components_of(palette, fractions)));
  fmt::print("over {:g} and {:g}, luminous reflectance under {}{}:\n", o.black, o.white,
             o.layer.light.viewing(), streams ? ", by streams" : "");
  fmt::print("  hides (contrast ratio {:g}) from  {}\n", o.ratio, thickness_text(hidden));
  nlohmann::json out = {{"hiding_thickness", std::isinf(hidden) ? nlohmann::json() : nlohmann::json(hidden)},
                        {"unit", palette.per_film   ? "film"
                                 : palette.relative ? "1/S of the white"
                                                    : "m"},
                        {"contrast_ratio", o.ratio},
                        {"theory", streams ? "streams" : "two fluxes"}};
  if (o.solids > 0 && palette.relative)
    throw Error(
        "--solids: a spreading rate needs K and S per metre, of drawdowns with a thickness; those of this palette "
        "have no unit of length");
  if (o.rate > 0 && o.solids == 0)
    throw Error("--spreading-rate: needs --solids, the volume of the dry film per volume of wet paint");
  if (o.solids > 0) {
    if (!std::isinf(hidden)) {
      const double covers = pigment::spreading_rate(hidden, o.solids);
      fmt::print("  spreading rate at that thickness: {:.4g} m^2/l (solids {:g} by volume)\n", covers,
                 o.solids);
      out["spreading_rate"] = covers;
    }
    if (o.rate > 0) {
      const double ratio = contrast(pigment::dry_thickness(o.rate, o.solids));
      fmt::print("  contrast ratio at {:g} m^2/l: {:.4f} (opacity {:.2f} %)\n", o.rate, ratio, 100 * ratio);
      out["at_spreading_rate"] = {{"spreading_rate", o.rate}, {"contrast_ratio", ratio}};
    }
  }
  if (!o.layer.thickness.empty()) {
    const double thickness = thickness_for(palette, o.layer.thickness), ratio = contrast(thickness);
    fmt::print("  contrast ratio at {}: {:.4f} (opacity {:.2f} %)\n", o.layer.thickness, ratio, 100 * ratio);
    out["at_thickness"] = {{"thickness", thickness}, {"contrast_ratio", ratio}};
  }
  fmt::print("\n{:>8} {:>12} {:>12} {:>9}  hides from\n", "nm", palette.relative ? "K, relative" : "K, 1/m",
             palette.relative ? "S, relative" : "S, 1/m", "R opaque");
  double next = palette.nm.front();
  for (std::size_t i = 0; i < palette.nm.size(); ++i) {
    if (palette.nm[i] < next) continue;
    while (next <= palette.nm[i]) next += o.step;
    const auto at = [&](double x) { return pigment::light_of(*streams->theory(), paint[i], shifts[i], x); };
    double deep = 0, covers = INFINITY;
    if (streams) {
      deep = at(INFINITY).seen;
      const double rate_here = paint[i].k + paint[i].s;
      if (rate_here > 0)
        covers = pigment::hiding_thickness(
            [&](double x) { return at(x).over(o.black) / at(x).over(o.white); }, 1 / rate_here, o.ratio);
    } else {
      deep = pigment::outer_reflectance(palette.surface,
                                        paint[i].s > 0 ? pigment::opaque_reflectance(paint[i].ratio()) : 0);
      covers = pigment::hiding_thickness(paint[i], palette.surface, o.ratio, o.black, o.white);
    }
    fmt::print("{:8.1f} {:12.5g} {:12.5g} {:9.5f}  {}\n", palette.nm[i], paint[i].k, paint[i].s, deep,
               thickness_text(covers));
    out["wavelengths"].push_back(
        {{"nm", palette.nm[i]},
         {"k", paint[i].k},
         {"s", paint[i].s},
         {"hiding_thickness", std::isinf(covers) ? nlohmann::json() : nlohmann::json(covers)}});
  }
  if (!o.layer.json.empty()) write_file_atomically(o.layer.json, out.dump(1) + "\n");
  if (!o.plot.empty() && !std::isinf(hidden)) {
    std::vector<double> x, y;
    for (int i = 1; i <= 100; ++i) x.push_back(hidden * i / 50), y.push_back(contrast(x.back()));
    if (!palette.relative)
      for (double& v : x) v *= 1e6;
    Plot plot{"Hiding power of " + pigment::recipe_text(components_of(palette, fractions)),
              palette.per_film   ? "thickness, films"
              : palette.relative ? "thickness, 1/S of the white"
                                 : "thickness, um",
              "contrast ratio",
              {}};
    plot.series.push_back(spectrum_line(x, y, "", "#2b5d8f"));
    write_file_atomically(o.plot, svg_plot(plot));
  }
  return 0;
}

std::function<int()> declare(CommandOptions& options) {
  auto o = std::make_shared<HideOptions>();
  o->layer.declare(options);
  options.add("--black", o->black, "inner reflectance of the black substrate")
      .between(0.0, 1.0)
      .shows_default();
  options.add("--white", o->white, "inner reflectance of the white substrate")
      .between(0.0, 1.0)
      .shows_default();
  options.add("--ratio", o->ratio, "contrast ratio of a hiding layer").between(0.01, 0.9999).shows_default();
  options
      .add("--solids", o->solids,
           "volume of the dry film per volume of wet paint: prints the spreading rate in m^2/l")
      .between(0.001, 1.0);
  options
      .add("--spreading-rate", o->rate,
           "with --solids: print the contrast ratio at this rate in m^2/l (ISO 6504)")
      .between(0.001, 1e6);
  o->surface.declare(options, "the result, instead of the palette's interface");
  options.add("--step", o->step, "step between printed wavelengths in nm").between(0.01, 1e9).shows_default();
  options.add("--plot", o->plot, "write the contrast ratio by thickness to this SVG file").names_output();
  return [o] { return hide(*o); };
}

AUREOLE_COMMAND("pigment hide", "Hiding power of a paint: contrast ratio and hiding thickness", declare);

}  // namespace
}  // namespace aureole

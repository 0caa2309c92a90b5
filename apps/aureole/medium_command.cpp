// SPDX-License-Identifier: Apache-2.0
// aureole medium: absorption, scattering and absorbances of a medium of a scene, by wavelength, and its colour.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "aureole/core/error.h"
#include "aureole/core/output_file.h"
#include "aureole/core/units.h"
#include "aureole/instrument/find_object.h"
#include "aureole/instrument/medium_figures.h"
#include "aureole/instrument/report/svg_plot.h"
#include "aureole/instrument/wavelength_steps.h"
#include "aureole/loading/load.h"
#include "aureole/spectrum/observer.h"
#include "command.h"
#include "messages.h"
#include "scene_loading.h"
#include "table_progress_line.h"

namespace aureole {
namespace {

struct MediumOptions {
  std::string target, length = "1cm", plot, json;
  std::vector<std::string> defines;
  std::vector<double> at{0, 0, 0}, along{0, 0, 1};
  double step = 0;
};

std::string length_text(double metres) {
  if (!std::isfinite(metres)) return "-";
  for (const auto& [unit, size] :
       {std::pair{"km", 1e3}, {"m", 1.0}, {"cm", 1e-2}, {"mm", 1e-3}, {"um", 1e-6}})
    if (metres >= size) return fmt::format("{:.4g} {}", metres / size, unit);
  return fmt::format("{:.4g} nm", metres * 1e9);
}

/// Returns CIE 1931 chromaticity coordinates and an sRGB colour as text.
std::string colour_text(const std::array<double, 3>& c) {
  const double sum = c[0] + c[1] + c[2];
  if (!(sum > 1e-6)) return "black";
  float rgb[3];
  xyz_to_srgb(c.data(), rgb);
  std::string screen;
  for (const float v : rgb) {
    const double linear = std::clamp(double(v), 0.0, 1.0);
    const double encoded = linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
    screen += fmt::format("{:02x}", int(std::lround(255 * encoded)));
  }
  return fmt::format("Y {:.5f}   x {:.4f} y {:.4f}   sRGB #{}", c[1], c[0] / sum, c[1] / sum, screen);
}

std::string phase_plot(const Medium& medium, const std::string& target, const Vec3& p, const Vec3& d) {
  const SpectralGrid& grid = medium.properties().context().grid;
  // Wavelengths of the plot's lines: blue, green and red if the scene covers them.
  std::vector<std::pair<double, const char*>> lines{{450, "#2050c0"}, {550, "#208030"}, {650, "#c03020"}};
  if (grid.min_nm > 450 || grid.max_nm < 650)
    for (std::size_t i = 0; i < 3; ++i)
      lines[i].first = std::lerp(grid.min_nm, grid.max_nm, 0.25 * double(i + 1));
  std::vector<double> angles, degrees;
  for (int i = 0; i <= 1800; ++i) degrees.push_back(0.1 * i), angles.push_back(degrees.back() * M_PI / 180);
  Plot plot{"Phase function of " + target, "scattering angle, degrees", "1/sr", {}, true};
  for (const auto& [nm, colour] : lines)
    plot.series.push_back({.x = degrees,
                           .y = phase_over_angle(medium, nm, angles, p, d),
                           .low = {},
                           .high = {},
                           .label = fmt::format("{:g} nm", nm),
                           .color = colour});
  return svg_plot(plot);
}

nlohmann::json as_json(const MediumFigures& f, double length) {
  nlohmann::json row = {{"nm", f.nm},
                        {"sigma_a", f.absorption},
                        {"sigma_s", f.scattering},
                        {"sigma_t", f.extinction()},
                        {"albedo", f.albedo()},
                        {"g", f.asymmetry},
                        {"transmittance", f.transmittance(length)},
                        {"absorbance", f.absorbance(length)},
                        {"optical_density", f.optical_density(length)}};
  if (f.extinction() > 0) row["mean_free_path"] = f.mean_free_path();
  return row;
}

int medium(const MediumOptions& o) {
  const double length = parse_length_m(o.length);
  if (!(length > 0)) throw Error("--length: must be positive");
  const Vec3 point{float(o.at[0]), float(o.at[1]), float(o.at[2])};
  const Vec3 along{float(o.along[0]), float(o.along[1]), float(o.along[2])};
  if (!(length_squared(along) > 0)) throw Error("--along: the direction has no length");
  const Vec3 d = normalize(along);
  const auto target = file_and_id(o.target);
  const std::string &file = target.first, &id = target.second;
  LoadOptions load = load_options(o.defines);
  const LoadedObjects loaded = [&] {
    TableProgressLine line(false);
    load.progress = [&](const std::string& object, double part) { line.show(object, part); };
    return load_wanted_objects(file, load, is_medium_called(id));
  }();
  for (const auto& note : loaded.notes) tell("note: {}\n", note);
  const MediumPtr found = find_medium(loaded, file, id);
  const std::vector<MediumFigures> rows =
      measure_medium(*found, wavelength_steps(found->properties().context().grid, o.step, 25), point, d);

  fmt::print("{} ({}){}\n\n", o.target, found->properties().type(),
             found->is_uniform() ? "" : fmt::format(", at ({:g}, {:g}, {:g})", o.at[0], o.at[1], o.at[2]));
  fmt::print("{:>7} {:>12} {:>12} {:>12} {:>9} {:>8} {:>11} {:>11} {:>9} {:>9}\n", "nm", "sigma_a, 1/m",
             "sigma_s, 1/m", "sigma_t, 1/m", "albedo", "g", "free path", "T of " + o.length, "A abs.",
             "A ext.");
  for (const MediumFigures& f : rows)
    fmt::print("{:7.1f} {:12.5g} {:12.5g} {:12.5g} {:9.6f} {:8.5f} {:>11} {:11.6f} {:9.4g} {:9.4g}\n", f.nm,
               f.absorption, f.scattering, f.extinction(), f.albedo(), f.asymmetry,
               length_text(f.mean_free_path()), f.transmittance(length), f.absorbance(length),
               f.optical_density(length));
  fmt::print("\nA: absorbance lg(1/T) of {}, by absorption alone and by extinction (optical density)\n",
             o.length);
  const auto passed = colour_behind(*found, length, false, point, d);
  const auto kept = colour_behind(*found, length, true, point, d);
  fmt::print("\nCIE 1931 observer, D65 behind {}\n", o.length);
  fmt::print("  neither absorbed nor scattered  {}\n", colour_text(passed));
  fmt::print("  not absorbed                    {}\n", colour_text(kept));

  if (!o.plot.empty()) write_file_atomically(o.plot, phase_plot(*found, o.target, point, d));
  if (!o.json.empty()) {
    nlohmann::json out = {{"target", o.target}, {"length_m", length}, {"at", o.at}, {"along", o.along}};
    for (const MediumFigures& f : rows) out["wavelengths"].push_back(as_json(f, length));
    out["xyz_unscattered"] = passed, out["xyz_not_absorbed"] = kept;
    write_file_atomically(o.json, out.dump(1) + "\n");
  }
  return 0;
}

std::function<int()> declare(CommandOptions& options) {
  auto o = std::make_shared<MediumOptions>();
  options.add("target", o->target, "scene.xml#id: id of a medium; without one, the only medium").required();
  options.add("-D,--define", o->defines, "set a $name of the scene: -D name=value").takes_each_time(1);
  add_cache_option(options);
  options
      .add("--step", o->step,
           "largest step between wavelengths in nm (default 25, or a hundredth of the range if that is more)")
      .between(0.01, 1e9);
  options.add("--length", o->length, "path length of the transmittance, absorbances and colours")
      .shows_default();
  options.add("--at", o->at, "x,y,z of the point, for spatially varying media (default 0,0,0)")
      .separated_by(',')
      .takes(3);
  options.add("--along", o->along, "x,y,z of the light's direction, for oriented particles (default 0,0,1)")
      .separated_by(',')
      .takes(3);
  options.add("--plot", o->plot, "write the phase function over the scattering angle to this SVG file")
      .names_output();
  options.add("--json", o->json, "also write the results to this file").names_output();
  return [o] { return medium(*o); };
}

AUREOLE_COMMAND("medium", "Absorption and scattering of a medium by wavelength, and its colour", declare);

}  // namespace
}  // namespace aureole

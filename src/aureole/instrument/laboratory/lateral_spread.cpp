// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/laboratory/lateral_spread.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "aureole/core/error.h"
#include "aureole/instrument/laboratory/goniometer_scene.h"
#include "aureole/instrument/medium_figures.h"

namespace aureole {
namespace {

/// The index of refraction below a surface over that above, as samples of its BSDF tell it.
double index_of(const Bsdf& bsdf, const SpectralGrid& grid, double nm) {
  const Wavelengths w = Wavelengths::at(grid, Spectrum(float(nm)));
  SurfacePoint point;
  point.uv = {0.5f, 0.5f};
  for (int k = 0; k < 64; ++k) {
    const float u = (float(k) + 0.5f) / 64;
    const auto s = bsdf.sample({0, 0, 1}, u, {u, 0.5f}, {w, point});
    if (s && s->wo.z < 0) return double(s->eta);
  }
  return 1;
}

/// Transmittance of the surface at normal incidence (Fresnel).
double transmittance_at_normal(double index) { return 4 * index / ((1 + index) * (1 + index)); }

}  // namespace

std::optional<optics::Multipole> diffusion_of(const Specimen& specimen, const SpectralGrid& grid,
                                              double length_unit_m, double nm) {
  if (!specimen.is_slab() || !specimen.medium || !specimen.bsdf || !specimen.medium->is_uniform()) return {};
  const double at[1] = {nm};
  // A point in the middle of the slab, in scene units; the medium is the same everywhere.
  const Vec3 middle{0, 0, float(-0.5 * specimen.thickness_m / length_unit_m)};
  const MediumFigures m = measure_medium(*specimen.medium, at, middle, {0, 0, -1})[0];
  if (!(m.extinction() > 0) || !(m.scattering > 0)) return {};
  try {
    return optics::Multipole(optics::diffusion_coefficients(m.absorption, m.scattering, m.asymmetry),
                             index_of(*specimen.bsdf, grid, nm), specimen.thickness_m);
  } catch (const std::domain_error&) {
    return {};
  }
}

SpreadTable measure_spread(const Bench& bench, const Specimen& specimen, const SpreadSettings& s) {
  if (!specimen.medium && !specimen.bssrdf)
    throw Error(fmt::format(
        "\"{}\" is no slab, in which light could spread: name a shape with an interior medium or a BSSRDF",
        specimen.name));
  const auto require = [](const char* what, double value, double low, double high) {
    if (!(value >= low && value <= high))
      throw Error(fmt::format("{} of {:g} mm: {:g} to {:g} is expected", what, value, low, high));
  };
  require("a spot", s.lit_m * 1e3, 1e-6, 1e4), require("a receiver", s.receiver_m * 1e3, 1e-6, 1e4);
  if (s.at_m.empty()) throw Error("there is no distance at which the spread could be measured");
  for (std::size_t i = 0; i < s.at_m.size(); ++i) {
    if (i > 0 && !(s.at_m[i] > s.at_m[i - 1])) throw Error("distances from the spot must increase");
    if (!(s.at_m[i] >= 0 && s.at_m[i] + 0.5 * s.receiver_m <= 0.5 * s.sample_m))
      throw Error(fmt::format("a receiver at {:g} mm is not over the sample of {:g} mm", 1e3 * s.at_m[i],
                              1e3 * s.sample_m));
  }
  GoniometerSettings g;
  g.lit_m = g.viewed_m = s.lit_m, g.sample_m = s.sample_m, g.distance_m = s.distance_m;
  const std::size_t bands = bench.bands().nm.size();
  SpreadTable table{bench.bands().nm, s.is_line, {}, bench.notes()};
  // Irradiance of the spot times its area is the flux that arrives.
  GonioScenes empty(bench, g);
  empty.add_lamp(0, s.lamp_angle), empty.add_diffuser();
  const Readings irradiance = empty.read();
  const double area = 0.25 * kPiD * s.lit_m * s.lit_m;
  std::vector<std::optional<optics::Multipole>> diffusion;
  for (const double nm : table.nm)
    diffusion.push_back(diffusion_of(specimen, bench.grid(), bench.length_unit_m(), nm));
  // Paths from the receiver would have to find the narrow beam within the slab, and paths from the lamp reach the receiver only
  // where light leaves at a vertex: behind a smooth interface both ends are connected within the slab.
  const char* const integrator = specimen.is_refracting() ? "bdpt" : "ptracer";
  for (const double at : s.at_m) {
    // A point's light on a strip is the spread of a line: it makes no difference which of the two is long.
    GonioScenes scene(bench, g);
    scene.add_specimen(specimen), scene.add_lamp(0, s.lamp_angle);
    scene.add_receiver_beside(at, 0.5 * s.receiver_m, s.is_line);
    const Readings read = scene.read(integrator);
    SpreadReading reading{at, {}, {}};
    for (std::size_t b = 0; b < bands; ++b) {
      Ratio q = ratio_of(read, 0, irradiance, 0, b);
      const double scale = (s.is_line ? s.sample_m : 1) / (kPiD * area);
      q.value *= scale, q.error *= scale;
      reading.values.push_back(q);
      if (!diffusion[b]) continue;
      const double in = transmittance_at_normal(index_of(*specimen.bsdf, bench.grid(), table.nm[b]));
      reading.predicted.push_back(in *
                                  (s.is_line ? diffusion[b]->line_profile(at) : diffusion[b]->profile(at)));
    }
    if (reading.predicted.size() != bands) reading.predicted.clear();
    table.readings.push_back(std::move(reading));
  }
  return table;
}

std::string spread_table_content(const SpreadTable& t) {
  const char* unit = t.is_line ? "1/m" : "1/m^2";
  std::string text = fmt::format(
      "# light that leaves at a distance from a {} for one unit that arrives, in {}; u(...): standard uncertainty; "
      "diffusion(...): predicted\ndistance_mm",
      t.is_line ? "line" : "point", unit);
  const bool has_prediction = !t.readings.empty() && !t.readings[0].predicted.empty();
  for (const double nm : t.nm) {
    text += fmt::format(",{0:g}nm,u({0:g}nm)", nm);
    if (has_prediction) text += fmt::format(",diffusion({:g}nm)", nm);
  }
  text += '\n';
  for (const SpreadReading& r : t.readings) {
    text += fmt::format("{:.6g}", 1e3 * r.at_m);
    for (std::size_t b = 0; b < t.nm.size(); ++b) {
      text += fmt::format(",{:.6g},{:.3g}", r.values[b].value, r.values[b].error);
      if (has_prediction) text += fmt::format(",{:.6g}", r.predicted[b]);
    }
    text += '\n';
  }
  return text;
}

}  // namespace aureole

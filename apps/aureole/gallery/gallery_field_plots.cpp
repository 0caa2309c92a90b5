// SPDX-License-Identifier: Apache-2.0
#include "gallery/gallery_field_plots.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "aureole/core/error.h"
#include "aureole/loading/load.h"
#include "aureole/render/job.h"
#include "scene_loading.h"

namespace aureole {
namespace {

double decibels(double power) { return 10 * std::log10(std::max(power, 1e-30)); }

/// Renders the power in the cells of the map, over that without blocks. A wavelength is 0.1 m.
std::vector<double> rendered_power(const FieldScene& s, const char* polarisation, int width, int height,
                                   int samples, const std::atomic<bool>& stop) {
  constexpr double kMetre = 0.1, kEndless = 400;
  const double angle = s.degrees * std::numbers::pi / 180;
  const std::string open = fmt::format(
      R"(<scene version="3.0.0">
  <integrator type="path"><integer name="max_depth" value="1"/><boolean name="diffraction" value="true"/>
    <string name="diffraction_model" value="segments"/><string name="diffraction_polarisation" value="{}"/></integrator>
  <sensor type="powermap">
    <transform name="to_world"><scale x="{}" y="{}"/><translate x="{}" y="{}"/></transform>
    <film type="specfilm"><integer name="width" value="{}"/><integer name="height" value="{}"/><rfilter type="box"/>
      <string name="wavelength_min" value="99.999mm"/><string name="wavelength_max" value="100.001mm"/>
      <integer name="bins" value="1"/><boolean name="preview" value="false"/></film>
    <sampler type="sobol"><integer name="sample_count" value="{}"/></sampler></sensor>
  <emitter type="directional"><vector name="direction" x="{}" y="{}" z="0"/><spectrum name="irradiance" value="1"/></emitter>
)",
      polarisation, 0.5 * kMetre * (s.x1 - s.x0), 0.5 * kMetre * (s.y1 - s.y0), 0.5 * kMetre * (s.x0 + s.x1),
      0.5 * kMetre * (s.y0 + s.y1), width, height, samples, std::cos(angle), std::sin(angle));
  std::string blocks;
  for (const MetalBlock& b : s.blocks)
    blocks += fmt::format(
        R"(  <shape type="cube"><transform name="to_world"><scale x="{}" y="{}" z="{}"/><translate x="{}" y="{}"/></transform>
    <bsdf type="conductor"><string name="material" value="none"/></bsdf></shape>
)",
        0.5 * kMetre * (b.x1 - b.x0), 0.5 * kMetre * (b.y1 - b.y0), kEndless, 0.5 * kMetre * (b.x0 + b.x1),
        0.5 * kMetre * (b.y0 + b.y1));
  const auto render = [&](const std::string& text) {
    RenderOptions options;
    options.end = samples;
    options.adaptive = AdaptiveTarget::none;
    RenderJob job(load_scene_from_string(text + "</scene>", "field_map.xml", load_options({})), options);
    job.run(stop);
    return job.state().picture();
  };
  const Image with = render(open + blocks), without = render(open);
  std::vector<double> power;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) power.push_back(double(with.at(x, y, 0)) / double(without.at(x, y, 0)));
  return power;
}

double quantile(std::vector<double> values, double part) {
  const auto at = values.begin() + std::ptrdiff_t(part * double(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

}  // namespace

std::vector<FieldMap> field_maps(const FieldScene& s, int width, int samples, const std::atomic<bool>& stop) {
  const double cell = (s.x1 - s.x0) / width, angle = s.degrees * std::numbers::pi / 180;
  const int height = std::max(1, int(std::lround((s.y1 - s.y0) / cell)));
  const auto x_of = [&](int i) { return s.x0 + (i % width + 0.5) * cell; };
  const auto y_of = [&](int i) { return s.y1 - (i / width + 0.5) * (s.y1 - s.y0) / height; };
  std::vector<int> outside;
  for (int i = 0; i < width * height; ++i)
    if (std::none_of(s.blocks.begin(), s.blocks.end(),
                     [&](const MetalBlock& b) { return b.contains(x_of(i), y_of(i)); }))
      outside.push_back(i);
  if (outside.empty()) throw Error("the map of a field has no cell outside the blocks");
  std::vector<FieldMap> maps;
  for (const bool is_hard : {false, true}) {
    const char* name = is_hard ? "hard" : "soft";
    constexpr int kPerWavelength = 8;
    const MetalSolver solver(s.blocks, angle, is_hard, kPerWavelength),
        coarse(s.blocks, angle, is_hard, kPerWavelength / 2);
    if (stop) return {};
    FieldMap solved{width, height, std::vector<double>(std::size_t(width) * std::size_t(height)), ""},
        rendered = solved, difference = solved;
    const auto shade = [&](double db) {
      return std::clamp((db - s.low_db) / (s.high_db - s.low_db), 0.0, 1.0);
    };
    const std::vector<double> power =
        rendered_power(s, is_hard ? "hard" : "soft", width, height, samples, stop);
    // Differences are counted where the field is at least that of the lower end of the range.
    constexpr double kMostDifference = 6;
    std::vector<double> off, off_coarse;
    for (std::size_t n = 0; n < outside.size(); ++n) {
      if (stop) return {};
      const auto i = std::size_t(outside[n]);
      const double x = x_of(outside[n]), y = y_of(outside[n]);
      const double db = decibels(std::norm(solver.field(x, y))), model = decibels(power[i]);
      const double apart = std::abs(model - db);
      solved.values[i] = shade(db), rendered.values[i] = shade(model);
      difference.values[i] = std::min(1.0, apart / kMostDifference);
      if (db < s.low_db) continue;
      off.push_back(apart);
      if (n % 64 == 0) off_coarse.push_back(std::abs(decibels(std::norm(coarse.field(x, y))) - db));
    }
    if (off.empty() || off_coarse.empty())
      throw Error("the field of the solver is below the range of the map");
    solved.caption = fmt::format(
        "{}: boundary integral equation, {} elements; one with half as many is off by {:.2f} dB in the median cell. "
        "Map of {:g} x {:g} wavelengths, {:g} dB dark, {:g} dB bright",
        name, solver.elements(), quantile(off_coarse, 0.5), s.x1 - s.x0, s.y1 - s.y0, s.low_db, s.high_db);
    rendered.caption = fmt::format("{}: model segments, off the solver by {:.2f} dB in the median cell", name,
                                   quantile(off, 0.5));
    difference.caption = fmt::format(
        "{}: difference of both in dB, {:g} and more bright; off by less than {:.2f} dB in 90 % of the cells, and "
        "by less than {:.2f} dB in 98 %",
        name, kMostDifference, quantile(off, 0.9), quantile(off, 0.98));
    for (FieldMap* map : {&solved, &rendered, &difference}) maps.push_back(std::move(*map));
  }
  return maps;
}

}  // namespace aureole

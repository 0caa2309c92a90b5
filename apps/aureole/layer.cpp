// SPDX-License-Identifier: Apache-2.0
// aureole layer: optical data of a sheet, a pane or a layer of a scene: direct and diffuse transmission and
// reflection, by wavelength and for the CIE observer; haze; losses. The data are measured with the BSDF's own
// samples, so that the command works for any BSDF.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "aureole/asset/asset.h"
#include "aureole/bsdf/bsdf.h"
#include "aureole/core/error.h"
#include "aureole/core/output_file.h"
#include "aureole/core/parallel.h"
#include "aureole/instrument/light_budget.h"
#include "aureole/loading/load.h"
#include "aureole/spectrum/observer.h"
#include "aureole/spectrum/tables.h"
#include "command.h"
#include "find_bsdf.h"
#include "messages.h"
#include "wavelength_steps.h"

namespace aureole {
namespace {

struct LayerOptions {
  std::string target, illuminant = "D65", json;
  std::vector<std::string> defines;
  double angle = 0, azimuth = 0, step = 0, haze_angle = 2.5;
  std::vector<double> at{0.5, 0.5};
  int samples = 1 << 16;
};

/// Returns X, Y, Z of the illuminant times a spectral fraction, relative to the illuminant's Y.
std::array<double, 3> tristimulus(const std::vector<LightBudget>& rows, const SampledSpectrum& lamp,
                                  const SpectralGrid& grid,
                                  const std::function<double(const LightBudget&)>& fraction) {
  const auto xyz = observer_xyz(grid);
  std::array<double, 3> sum{};
  double white = 0;
  for (int i = 0; i <= grid.cells; ++i) {
    const double nm = grid.node(i), light = double(lamp.nodes()[std::size_t(i)]);
    const double x = std::clamp((nm - rows.front().nm) / std::max(rows[1].nm - rows[0].nm, 1e-9), 0.0,
                                double(rows.size() - 1));
    const std::size_t k = std::min(std::size_t(x), rows.size() - 2);
    const double f = std::lerp(fraction(rows[k]), fraction(rows[k + 1]), x - double(k));
    for (std::size_t c = 0; c < 3; ++c) sum[c] += light * f * double(xyz[c].nodes()[std::size_t(i)]);
    white += light * double(xyz[1].nodes()[std::size_t(i)]);
  }
  for (double& c : sum) c /= white;
  return sum;
}

struct Quantity {
  const char *name, *key;
  double (*of)(const LightBudget&);
};
constexpr Quantity kQuantities[] = {
    {"direct T", "direct_transmission", [](const LightBudget& b) { return b.direct_transmission; }},
    {"near T", "diffuse_transmission_near", [](const LightBudget& b) { return b.near_transmission; }},
    {"far T", "diffuse_transmission_far", [](const LightBudget& b) { return b.far_transmission; }},
    {"total T", "total_transmission", [](const LightBudget& b) { return b.transmission(); }},
    {"direct R", "direct_reflection", [](const LightBudget& b) { return b.direct_reflection; }},
    {"diffuse R", "diffuse_reflection", [](const LightBudget& b) { return b.diffuse_reflection; }},
    {"total R", "total_reflection", [](const LightBudget& b) { return b.reflection(); }},
    {"lost", "lost", [](const LightBudget& b) { return b.lost(); }}};

int layer(const LayerOptions& options) {
  const std::size_t mark = options.target.rfind('#');
  const std::string file = options.target.substr(0, mark);
  LoadOptions load;
  load.defines = split_defines(options.defines);
  const LoadedObjects loaded = load_objects(file, load);
  for (const auto& note : loaded.notes) tell("note: {}\n", note);
  const auto bsdf = find_bsdf(loaded, file, mark == std::string::npos ? "" : options.target.substr(mark + 1));
  const SpectralGrid grid = loaded.context->grid;
  const auto table = find_illuminant(options.illuminant);
  if (!table)
    throw Error("--illuminant: unknown illuminant \"" + options.illuminant + "\"" +
                did_you_mean(options.illuminant, illuminant_names()));
  const SampledSpectrum lamp = SampledSpectrum::from_points(grid, table->wavelengths_nm, table->values);

  const double theta = options.angle * M_PI / 180, phi = options.azimuth * M_PI / 180;
  const Vec3 wi{float(std::sin(theta) * std::cos(phi)), float(std::sin(theta) * std::sin(phi)),
                float(std::cos(theta))};
  const LightBudgetSettings settings{
      options.haze_angle, options.samples, {float(options.at[0]), float(options.at[1])}};
  std::vector<LightBudget> rows;
  for (const double nm : wavelength_steps(grid, options.step, 20)) rows.emplace_back().nm = nm;
  for_ranges(
      rows.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
          rows[i] = measure_light_budget(*bsdf, wi, rows[i].nm, grid, settings);
      },
      1);

  fmt::print("{} ({}), light at {:g} degrees, {} samples per wavelength\n", options.target,
             bsdf->properties().type(), options.angle, options.samples);
  fmt::print(
      "Fractions of the light that arrives. T: transmitted, R: reflected; near: within {:g} degrees of its "
      "regular "
      "direction, far: beyond.\n\n",
      options.haze_angle);
  fmt::print("{:>8}", "nm");
  for (const Quantity& q : kQuantities) fmt::print("{:>11}", q.name);
  fmt::print("{:>9}\n", "haze");
  const auto haze = [](double far, double total) {
    return total > 0 ? fmt::format("{:8.2f} %", 100 * far / total) : std::string("       -");
  };
  for (const LightBudget& b : rows) {
    fmt::print("{:8.1f}", b.nm);
    for (const Quantity& q : kQuantities) fmt::print("{:11.5f}", q.of(b));
    fmt::print("{}\n", haze(b.far_transmission, b.transmission()));
  }
  const bool visible =
      rows.size() > 1 && tristimulus(rows, lamp, grid, [](const LightBudget&) { return 1.0; })[1] > 0;
  nlohmann::json out = {{"target", options.target},
                        {"angle_degrees", options.angle},
                        {"illuminant", options.illuminant},
                        {"haze_angle_degrees", options.haze_angle},
                        {"samples", options.samples}};
  for (const LightBudget& b : rows) {
    nlohmann::json row = {{"nm", b.nm}};
    for (const Quantity& q : kQuantities) row[q.key] = q.of(b);
    out["wavelengths"].push_back(row);
  }
  if (visible) {
    fmt::print("\nCIE 1931 observer, illuminant {}: luminous fraction Y and chromaticity x, y\n",
               options.illuminant);
    double far = 0, total = 0;
    for (const Quantity& q : kQuantities) {
      const auto c = tristimulus(rows, lamp, grid, q.of);
      const double sum = c[0] + c[1] + c[2];
      if (q.key == std::string("diffuse_transmission_far")) far = c[1];
      if (q.key == std::string("total_transmission")) total = c[1];
      nlohmann::json entry = {{"Y", c[1]}};
      fmt::print("  {:<10} Y {:.5f}", q.name, c[1]);
      if (sum > 1e-4) {
        fmt::print("   x {:.4f} y {:.4f}", c[0] / sum, c[1] / sum);
        entry["x"] = c[0] / sum, entry["y"] = c[1] / sum;
      }
      fmt::print("\n");
      out["cie"][q.key] = entry;
    }
    fmt::print("  haze       {} of the transmitted light leaves beyond {:g} degrees\n", haze(far, total),
               options.haze_angle);
    if (total > 0) out["cie"]["haze"] = far / total;
  }
  if (!options.json.empty()) write_file_atomically(options.json, out.dump(1) + "\n");
  return 0;
}

std::function<int()> declare(CommandOptions& options) {
  auto o = std::make_shared<LayerOptions>();
  options.add("target", o->target, "scene.xml#id: id of a BSDF or a shape; the file needs no sensor")
      .required();
  options.add("-D,--define", o->defines, "set a $name of the scene: -D name=value").takes_each_time(1);
  options.add("--angle", o->angle, "angle of incidence in degrees, above 90 from below (default 0)")
      .between(0.0, 180.0);
  options.add("--azimuth", o->azimuth, "azimuth of the incident light in degrees from the u axis");
  options
      .add("--step", o->step,
           "largest step between wavelengths in nm (default 20, or a hundredth of the range if that is more)")
      .between(0.01, 1e9);
  options.add("--illuminant", o->illuminant, "illuminant of the CIE values (default D65)");
  options
      .add("--haze-angle", o->haze_angle, "angle in degrees above which light counts as haze (default 2.5)")
      .between(0.01, 90.0);
  options.add("--samples", o->samples, "samples per wavelength (default 65536)").between(64, 1 << 26);
  options.add("--at", o->at, "u,v of the point on the surface, for textured layers (default 0.5,0.5)")
      .separated_by(',')
      .takes(2);
  options.add("--json", o->json, "also write the results to this file").names_output();
  return [o] { return layer(*o); };
}

AUREOLE_COMMAND("layer",
                "Transmission, reflection and haze of a BSDF, by wavelength and for the CIE observer",
                declare);

}  // namespace
}  // namespace aureole

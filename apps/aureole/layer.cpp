// SPDX-License-Identifier: Apache-2.0
// aureole layer: optical data of a sheet, a pane or a layer of a scene: direct and diffuse transmission and
// reflection, by wavelength and for the CIE observer; haze; losses. The data are measured with the BSDF's own
// samples, so that the command works for any BSDF.
#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "aureole/core/output_file.h"
#include "aureole/instrument/find_object.h"
#include "aureole/instrument/layer_figures.h"
#include "aureole/loading/load.h"
#include "command.h"
#include "messages.h"
#include "scene_loading.h"

namespace aureole {
namespace {

struct LayerOptions {
  std::string target, illuminant = "D65", json;
  std::vector<std::string> defines;
  double angle = 0, azimuth = 0, step = 0, haze_angle = 2.5;
  std::vector<double> at{0.5, 0.5};
  int samples = 1 << 16;
};

int layer(const LayerOptions& options) {
  const auto [file, id] = file_and_id(options.target);
  LoadOptions load = load_options(options.defines);
  const LoadedObjects loaded = load_wanted_objects(file, load, has_id(id));
  for (const auto& note : loaded.notes) tell("note: {}\n", note);
  const auto bsdf = find_bsdf(loaded, file, id);
  LayerSettings settings{options.angle, options.azimuth, options.step, options.illuminant, {}};
  settings.budget = {options.haze_angle, options.samples, {float(options.at[0]), float(options.at[1])}};
  const LayerFigures figures = measure_layer(*bsdf, loaded.context->grid, settings);
  const std::vector<LightBudget>& rows = figures.rows;

  fmt::print("{} ({}), light at {:g} degrees, {} samples per wavelength\n", options.target,
             bsdf->properties().type(), options.angle, options.samples);
  fmt::print(
      "Fractions of the light that arrives. T: transmitted, R: reflected; near: within {:g} degrees of its "
      "regular "
      "direction, far: beyond.\n\n",
      options.haze_angle);
  fmt::print("{:>8}", "nm");
  for (const LayerQuantity& q : kLayerQuantities) fmt::print("{:>11}", q.name);
  fmt::print("{:>9}\n", "haze");
  const auto haze = [](double far, double total) {
    return total > 0 && std::isfinite(far) ? fmt::format("{:8.2f} %", 100 * far / total)
                                           : std::string("       -");
  };
  for (const LightBudget& b : rows) {
    fmt::print("{:8.1f}", b.nm);
    for (const LayerQuantity& q : kLayerQuantities) fmt::print("{:11.5f}", q.of(b));
    fmt::print("{}\n", haze(b.far_transmission, b.transmission()));
  }
  nlohmann::json out = {{"target", options.target},
                        {"angle_degrees", options.angle},
                        {"illuminant", options.illuminant},
                        {"haze_angle_degrees", options.haze_angle},
                        {"samples", options.samples}};
  for (const LightBudget& b : rows) {
    nlohmann::json row = {{"nm", b.nm}};
    for (const LayerQuantity& q : kLayerQuantities) row[q.key] = q.of(b);
    out["wavelengths"].push_back(row);
  }
  if (!figures.xyz.empty()) {
    fmt::print("\nCIE 1931 observer, illuminant {}: luminous fraction Y and chromaticity x, y\n",
               options.illuminant);
    for (std::size_t k = 0; k < kLayerQuantities.size(); ++k) {
      const LayerQuantity& q = kLayerQuantities[k];
      const auto& c = figures.xyz[k];
      const double sum = c[0] + c[1] + c[2];
      nlohmann::json entry = {{"Y", c[1]}};
      fmt::print("  {:<10} Y {:.5f}", q.name, c[1]);
      if (sum > 1e-4) {
        fmt::print("   x {:.4f} y {:.4f}", c[0] / sum, c[1] / sum);
        entry["x"] = c[0] / sum, entry["y"] = c[1] / sum;
      }
      fmt::print("\n");
      out["cie"][q.key] = entry;
    }
    const double part = figures.haze();
    fmt::print("  haze       {} of the transmitted light leaves beyond {:g} degrees\n", haze(part, 1),
               options.haze_angle);
    if (std::isfinite(part)) out["cie"]["haze"] = part;
  }
  if (!options.json.empty()) write_file_atomically(options.json, out.dump(1) + "\n");
  return 0;
}

std::function<int()> declare(CommandOptions& options) {
  auto o = std::make_shared<LayerOptions>();
  options.add("target", o->target, "scene.xml#id: id of a BSDF or a shape; the file needs no sensor")
      .required();
  options.add("-D,--define", o->defines, "set a $name of the scene: -D name=value").takes_each_time(1);
  add_cache_option(options);
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

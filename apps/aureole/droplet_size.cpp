// SPDX-License-Identifier: Apache-2.0
// aureole droplet-size: radius and area fraction of clear circular scatterers (instrument/corona/droplet_measurement.h).
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "aureole/core/error.h"
#include "aureole/core/output_file.h"
#include "aureole/instrument/corona/droplet_measurement.h"
#include "aureole/instrument/report/svg_plot.h"
#include "command.h"
#include "picture_file.h"

namespace aureole {
namespace {

struct Options : DropletSettings {
  std::string output, plot;
};

/// Prints a value with its standard error and the interval that holds it with a probability of 95 %.
void print_value(const char* name, const char* unit, double value, double error, double most = INFINITY) {
  fmt::print("{:<14} {:.4g}{}, standard error {:.2g}{}, 95 % [{:.4g}, {:.4g}]\n", name, value, unit, error,
             unit, std::max(value - 1.96 * error, 0.0), std::min(value + 1.96 * error, most));
}

void report(const Options& o, const DropletMeasurement& m) {
  const CoronaFit& f = m.fit;
  print_value("radius", " um", f.radius * 1e6, f.radius_error * 1e6);
  const double low = std::max(f.area_fraction - 1.96 * f.area_fraction_error, 0.0),
               high = std::min(f.area_fraction + 1.96 * f.area_fraction_error, 1.0);
  if (f.fraction_fixed)
    fmt::print("area fraction  {:.3g} (given)\n", f.area_fraction);
  else
    fmt::print("area fraction  {:.3g}, standard error {:.2g}, 95 % [{:.3g}, {:.3g}]\n", f.area_fraction,
               f.area_fraction_error, low, high);
  if (o.spread && f.spread > 0)
    print_value("size spread", "", f.spread, f.spread_error);
  else if (o.spread)
    fmt::print("size spread    below {:g}\n", kMinFittedSpread);
  if (o.second_size) {
    print_value("second radius", " um", f.second_radius * 1e6, f.second_radius_error * 1e6);
    print_value("second share", "", f.second_share, f.second_share_error, 1);
  }
  for (const std::string& note : m.notes) fmt::print("note: {}\n", note);
  if (o.output.empty()) return;
  nlohmann::ordered_json j;
  j["radius_um"] = {{"value", f.radius * 1e6}, {"error", f.radius_error * 1e6}};
  j["area_fraction"] = {{"value", f.area_fraction},
                        {"error", std::min(f.area_fraction_error, 1.0)},
                        {"given", f.fraction_fixed}};
  if (o.spread) j["size_spread"] = {{"value", f.spread}, {"error", f.spread_error}};
  if (o.second_size) {
    j["second_radius_um"] = {{"value", f.second_radius * 1e6}, {"error", f.second_radius_error * 1e6}};
    j["second_share"] = {{"value", f.second_share}, {"error", f.second_share_error}};
  }
  j["correlation"] = f.correlation;
  j["residual"] = f.residual;
  const std::string text = j.dump(2) + "\n";
  write_file_atomically(o.output, text);
}

void write_corona_plot(const DropletMeasurement& m, const std::string& file) {
  Plot plot{"Corona: green, measured and fitted", "angle, degrees", "light", {}};
  PlotSeries measured{PlotSeries::Kind::points, {}, {}, {}, {}, 0},
      fitted{PlotSeries::Kind::line, {}, {}, {}, {}, 0};
  for (std::size_t i = 0; i < m.profile.s.size(); ++i) {
    measured.x.push_back(m.ring_deg(i)), measured.y.push_back(m.profile.mean[i][1]);
    measured.low.push_back(m.profile.mean[i][1] - 1.96 * m.profile.sd[i][1]);
    measured.high.push_back(m.profile.mean[i][1] + 1.96 * m.profile.sd[i][1]);
    fitted.x.push_back(measured.x.back()), fitted.y.push_back(m.fit.model[i][1]);
  }
  plot.series = {measured, fitted};
  write_file_atomically(file, svg_plot(plot));
}

int droplet_size(const Options& o) {
  require_droplet_settings(o);
  if (!o.angles.empty() && !o.plot.empty())
    throw Error("--plot: angles alone have no profile; it needs a photo");
  const DropletMeasurement m = measure_droplets(o, o.photo.empty() ? Image{} : read_picture(o.photo));
  if (!m.profile.s.empty())
    fmt::print(
        "lamp at pixel ({:.1f}, {:.1f}); {} rings of pixels from {:.2f} to {:.2f} degrees, RMS of the fit "
        "{:.1f} %\n",
        m.center[0], m.center[1], m.profile.s.size(), m.ring_deg(0), m.ring_deg(m.profile.s.size() - 1),
        100 * m.fit.residual);
  report(o, m);
  if (!o.plot.empty()) write_corona_plot(m, o.plot);
  return 0;
}

std::function<int()> declare(CommandOptions& options) {
  auto o = std::make_shared<Options>();
  options.add("photo", o->photo, "picture with the light source: EXR, or PNG, JPEG, TIFF (sRGB)");
  options.add("--pixel-angle", o->pixel_angle,
              "angle subtended by a pixel at the picture's centre, such as 0.01deg");
  options.add("--fov", o->fov, "horizontal field of view in degrees, instead of --pixel-angle");
  options
      .add("--center", o->center,
           "x,y of the source in pixels (default: the brightest white spot, or the point about which an "
           "overexposed picture is most symmetric)")
      .separated_by(',')
      .takes(2);
  options.add("--lamp", o->lamp, "spectrum: CIE name, file of wavelengths and powers, or wavelength")
      .names_input()
      .shows_default();
  options.add("--lamp-angle", o->lamp_angle,
              "angular diameter of the source, such as 0.15deg (default: a point)");
  options.add("--lamp-distance", o->lamp_distance,
              "distance of the source along the camera axis (default: infinite)");
  options.add("--pane-distance", o->pane_distance, "distance of the pane along the camera axis (default: 0)");
  options.add("--substrate", o->substrate, "none, or thindielectric: corrects for the reflection of a pane")
      .shows_default();
  options.add("--index", o->index, "index of refraction of that pane").shows_default();
  options.add("--inner", o->inner,
              "inner angle of the corona used in the fit (default: 5 pixels from the source's edge)");
  options
      .add(
          "--azimuths", o->azimuths,
          "use only the azimuths around the source from one to another, degrees, 0 right, 90 up; 300 60 is through 0")
      .takes(2);
  options.add("--mask", o->masks, "exclude a disc of the picture, x y radius in pixels; may be repeated")
      .takes_each_time(3);
  options.add("--angles", o->angles,
              "instead of a photo: angles of extrema, such as 2.79:max:G,4.2deg:min:G (colours R, G, B, Y)");
  options.add("--angle-error", o->angle_error, "standard error of those angles").shows_default();
  options.add("--area-fraction", o->area_fraction, "fixed area fraction (with --angles)");
  options
      .add(
          "--correlation", o->correlation,
          "positions of the scatterers: simulated, hard discs in equilibrium as in nature; percus_yevick, the "
          "theory by which scenes place them by default")
      .shows_default();
  options.add("--spread", o->spread, "fit the spread of sizes, too: the standard deviation of ln(radius)");
  options.add("--second-size", o->second_size,
              "fit scatterers of two sizes: a second radius, and its share of the covered area");
  options.add("-o,--output", o->output, "JSON file of the result").names_output();
  options.add("--plot", o->plot, "SVG of the measured and the fitted profile").names_output();
  return [=] { return droplet_size(*o); };
}

AUREOLE_COMMAND("droplet-size", "Fit radius and area fraction of scatterers to the rings of a corona",
                declare);

}  // namespace
}  // namespace aureole

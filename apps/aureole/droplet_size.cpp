// SPDX-License-Identifier: Apache-2.0
// aureole droplet-size: radius and area fraction of clear circular scatterers (droplets, spores, powder) on a
// pane, from the rings around a light source in a photo, or from angles read off a photo.
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
#include "aureole/instrument/corona/corona_fit.h"
#include "aureole/instrument/report/svg_plot.h"
#include "aureole/math/vec.h"
#include "command.h"
#include "picture_file.h"

namespace aureole {
namespace {

struct Options {
  std::string photo, pixel_angle, lamp = "D65", angles, angle_error = "0.05deg", substrate = "none";
  std::string pane_distance, lamp_distance, lamp_angle, inner, output, plot, correlation = "simulated";
  double fov = 0, area_fraction = -1, index = 1.5;
  bool spread = false, second_size = false;
  std::vector<double> center, azimuths{0, 360}, masks;
};

double angle_deg(const std::string& option, std::string text) {
  const auto fail = [&](const std::string& what) { throw Error(option + ": " + what); };
  double factor = 0;
  for (const auto& [unit, f] :
       {std::pair("deg", 1.0), std::pair("mrad", 1e-3 / kDegree), std::pair("rad", 1 / kDegree)})
    if (factor == 0 && text.ends_with(unit)) factor = f, text.resize(text.size() - std::string(unit).size());
  if (factor == 0) fail("\"" + text + "\" has no unit: write an angle as \"0.01deg\" (deg, rad or mrad)");
  double v = 0;
  try {
    v = parse_number(text) * factor;
  } catch (const Error& e) {
    fail(e.message());
  }
  if (!(v > 0 && v < 90)) fail(fmt::format("{:g} degrees are not between 0 and 90", v));
  return v;
}

/// Returns a picture with R, G, B proportional to radiance, and sets the value from which a pixel counts as
/// clipped.
Image linear_picture(const std::string& file, double& clip) {
  Image image = read_picture(file);
  if (image.channel("R") < 0 || image.channel("G") < 0 || image.channel("B") < 0)
    throw Error({file, 0, 0}, "needs the channels R, G and B");
  clip = INFINITY;
  if (!image.srgb_encoded) return image;
  clip = srgb_decode(0.995f);
  for (float& v : image.pixels) v = srgb_decode(v);
  image.srgb_encoded = false;
  return image;
}

/// Prints a value with its standard error and the interval that contains it with a probability of 95 %.
void print_value(const char* name, const char* unit, double value, double error, double most = INFINITY) {
  fmt::print("{:<14} {:.4g}{}, standard error {:.2g}{}, 95 % [{:.4g}, {:.4g}]\n", name, value, unit, error,
             unit, std::max(value - 1.96 * error, 0.0), std::min(value + 1.96 * error, most));
}

void report(const Options& o, const CoronaFit& f) {
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
  if (!f.fraction_fixed && f.area_fraction > kMaxFittedFraction - 0.005)
    fmt::print(
        "note: the area fraction is at the limit of the fit: this is another minimum than the right one, or "
        "no fluid of discs\n");
  if (!f.fraction_fixed && high - low > 0.4)
    fmt::print("note: these rings hardly depend on the area fraction; it is not measured\n");
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

int droplet_size(const Options& o) {
  const bool has_photo = !o.photo.empty(), has_angles = !o.angles.empty();
  if (has_photo == has_angles) throw Error("droplet-size: give either a photo or --angles");
  if (o.substrate != "none" && o.substrate != "thindielectric")
    throw Error("--substrate: unknown value \"" + o.substrate + "\"" +
                did_you_mean(o.substrate, {"none", "thindielectric"}) + "; use none, thindielectric");
  if (o.correlation != "simulated" && o.correlation != "percus_yevick")
    throw Error("--correlation: unknown value \"" + o.correlation + "\"" +
                did_you_mean(o.correlation, {"simulated", "percus_yevick"}) +
                "; use simulated, percus_yevick");
  if (!(o.index >= 1 && o.index < 5)) throw Error("--index must be in [1, 5)");
  if (o.area_fraction != -1 && !(o.area_fraction > 0 && o.area_fraction <= kMaxFittedFraction))
    throw Error(fmt::format("--area-fraction must be in (0, {}]", kMaxFittedFraction));
  if (o.spread && o.second_size) throw Error("give either --spread or --second-size, not both");
  if (has_angles && (o.spread || o.second_size))
    throw Error("--angles: angles alone do not tell several sizes; --spread and --second-size need a photo");
  const LampSpectrum lamp = lamp_spectrum(o.lamp);
  const auto positions = o.correlation == "simulated" ? CoronaModel::Positions::equilibrium
                                                      : CoronaModel::Positions::percus_yevick;
  if (has_angles && !o.plot.empty()) throw Error("--plot: angles alone have no profile; it needs a photo");
  if (!has_angles && o.area_fraction != -1) throw Error("--area-fraction is for --angles; a photo tells it");
  if (has_angles) {
    const auto rings = parse_ring_angles(o.angles);
    const CoronaFit f =
        fit_ring_angles(rings, lamp, angle_deg("--angle-error", o.angle_error), o.area_fraction, positions);
    if (rings.size() < 2 && o.area_fraction < 0)
      fmt::print("note: one angle does not tell the area fraction: 0.5 is taken; give --area-fraction\n");
    report(o, f);
    return 0;
  }

  if (o.pixel_angle.empty() == (o.fov == 0)) throw Error("give either --pixel-angle or --fov");
  if (o.fov != 0 && !(o.fov > 0 && o.fov < 180)) throw Error("--fov must be between 0 and 180 degrees");
  const PictureParts parts = picture_parts(o.azimuths, o.masks);
  double clip = 0;
  const Image image = linear_picture(o.photo, clip);
  const double tangent = o.fov > 0 ? 2 * std::tan(0.5 * o.fov * kDegree) / image.width
                                   : std::tan(angle_deg("--pixel-angle", o.pixel_angle) * kDegree);
  const PinholeCamera camera{tangent, 0.5 * image.width, 0.5 * image.height};
  const auto at = o.center.size() == 2 ? std::array<double, 2>{o.center[0], o.center[1]}
                                       : corona_centre(image, clip, parts);
  if (!(at[0] >= 0 && at[1] >= 0 && at[0] <= image.width && at[1] <= image.height))
    throw Error("--center lies outside of the picture");
  const Direction direction = camera.direction(at[0], at[1]);
  PaneGeometry geometry;
  if (!o.lamp_distance.empty()) geometry.lamp_m = parse_length_m(o.lamp_distance);
  if (!o.pane_distance.empty()) geometry.pane_m = parse_length_m(o.pane_distance);
  if (geometry.lamp_m < 0 || geometry.pane_m < 0)
    throw Error("--pane-distance and --lamp-distance must be positive");
  if (geometry.lamp_m > 0 && geometry.pane_m >= geometry.lamp_m)
    throw Error("--pane-distance must be smaller than --lamp-distance");
  geometry.slab_index = o.substrate == "none" ? 0 : o.index;
  const double lamp_radius =
      o.lamp_angle.empty() ? 0 : 0.5 * angle_deg("--lamp-angle", o.lamp_angle) * kDegree;
  const double inner =
      o.inner.empty() ? 5 * tangent + lamp_radius : std::sin(angle_deg("--inner", o.inner) * kDegree);
  const ScatteredProfile profile = scattered_profile(image, camera, direction, parts, geometry, inner, clip);
  if (profile.s.empty())
    throw Error({o.photo, 0, 0}, "no ring is visible: nothing of the picture is left to look at");
  CoronaModel model(lamp, profile.s.back(), lamp_radius, positions);
  CoronaFit f;
  try {
    f = fit_corona(profile, model,
                   o.spread        ? CoronaSizes::spread
                   : o.second_size ? CoronaSizes::two
                                   : CoronaSizes::one);
  } catch (const Error& e) {
    throw Error({o.photo, 0, 0}, e.message());
  }
  fmt::print(
      "lamp at pixel ({:.1f}, {:.1f}); {} rings of pixels from {:.2f} to {:.2f} degrees, RMS of the fit "
      "{:.1f} %\n",
      at[0], at[1], profile.s.size(), std::asin(profile.s.front()) / kDegree,
      std::asin(profile.s.back()) / kDegree, 100 * f.residual);
  report(o, f);
  const bool several = o.spread || o.second_size;
  if (f.residual > (several ? kGoodResidualOfSizes : kGoodResidual))
    fmt::print(
        "note: the fit leaves {:.1f} % of the rings' range unexplained, where good fits leave {} %, and its "
        "intervals do not include the cause. The scatterers may {}not be round or not be clear of one another, or be droplets that refract (correlated_caps); the inner rings may be clipped or left out (--inner); "
        "the centre may be wrong (--center), the lamp may have another spectrum (--lamp) or size "
        "(--lamp-angle), or other lights may be in the picture (--mask, --azimuths)\n",
        100 * f.residual, several ? 0.4 : 1.5,
        several ? "" : "be of several sizes (--spread, --second-size), ");
  if (o.plot.empty()) return 0;
  Plot plot{"Corona: green, measured and fitted", "angle, degrees", "light", {}};
  PlotSeries measured{PlotSeries::Kind::points, {}, {}, {}, {}, 0},
      fitted{PlotSeries::Kind::line, {}, {}, {}, {}, 0};
  for (size_t i = 0; i < profile.s.size(); ++i) {
    measured.x.push_back(std::asin(profile.s[i]) / kDegree), measured.y.push_back(profile.mean[i][1]);
    measured.low.push_back(profile.mean[i][1] - 1.96 * profile.sd[i][1]);
    measured.high.push_back(profile.mean[i][1] + 1.96 * profile.sd[i][1]);
    fitted.x.push_back(measured.x.back()), fitted.y.push_back(f.model[i][1]);
  }
  plot.series = {measured, fitted};
  const std::string text = svg_plot(plot);
  write_file_atomically(o.plot, text);
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

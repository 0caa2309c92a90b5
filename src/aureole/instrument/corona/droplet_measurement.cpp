// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/corona/droplet_measurement.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "aureole/core/error.h"
#include "aureole/core/units.h"
#include "aureole/math/vec.h"

namespace aureole {

namespace {

double positive_angle_deg(const std::string& option, std::string text) {
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

/// Returns R, G, B proportional to radiance, and the value from which a pixel counts as clipped.
Image linear_photo(Image image, const std::string& name, double& clip) {
  if (image.channel("R") < 0 || image.channel("G") < 0 || image.channel("B") < 0)
    throw Error({name, 0, 0}, "needs the channels R, G and B");
  clip = INFINITY;
  if (!image.srgb_encoded) return image;
  clip = srgb_decode(0.995f);
  for (float& v : image.pixels) v = srgb_decode(v);
  image.srgb_encoded = false;
  return image;
}

/// Adds notes on an area fraction that the rings do not tell.
void note_doubts(DropletMeasurement& m) {
  const CoronaFit& f = m.fit;
  const double low = std::max(f.area_fraction - 1.96 * f.area_fraction_error, 0.0),
               high = std::min(f.area_fraction + 1.96 * f.area_fraction_error, 1.0);
  if (!f.fraction_fixed && f.area_fraction > kMaxFittedFraction - 0.005)
    m.notes.emplace_back(
        "the area fraction is at the limit of the fit: this is another minimum than the right one, or "
        "no fluid of discs");
  if (!f.fraction_fixed && high - low > 0.4)
    m.notes.emplace_back("these rings hardly depend on the area fraction; it is not measured");
}

CoronaModel::Positions positions_of(const DropletSettings& o) {
  return o.correlation == "simulated" ? CoronaModel::Positions::equilibrium
                                      : CoronaModel::Positions::percus_yevick;
}

DropletMeasurement fitted_angles(const DropletSettings& o, const LampSpectrum& lamp) {
  const auto rings = parse_ring_angles(o.angles);
  DropletMeasurement m;
  m.fit = fit_ring_angles(rings, lamp, positive_angle_deg("--angle-error", o.angle_error), o.area_fraction,
                          positions_of(o));
  if (rings.size() < 2 && o.area_fraction < 0)
    m.notes.emplace_back("one angle does not tell the area fraction: 0.5 is taken; give --area-fraction");
  note_doubts(m);
  return m;
}

PaneGeometry pane_geometry(const DropletSettings& o) {
  PaneGeometry geometry;
  if (!o.lamp_distance.empty()) geometry.lamp_m = parse_length_m(o.lamp_distance);
  if (!o.pane_distance.empty()) geometry.pane_m = parse_length_m(o.pane_distance);
  if (geometry.lamp_m < 0 || geometry.pane_m < 0)
    throw Error("--pane-distance and --lamp-distance must be positive");
  if (geometry.lamp_m > 0 && geometry.pane_m >= geometry.lamp_m)
    throw Error("--pane-distance must be smaller than --lamp-distance");
  geometry.slab_index = o.substrate == "none" ? 0 : o.index;
  return geometry;
}

std::string residual_note(double residual, bool several) {
  return fmt::format(
      "the fit leaves {:.1f} % of the rings' range unexplained, where good fits leave {} %, and its "
      "intervals do not include the cause. The scatterers may {}not be round or not be clear of one another, or be droplets that refract (correlated_caps); the inner rings may be clipped or left out (--inner); "
      "the centre may be wrong (--center), the lamp may have another spectrum (--lamp) or size "
      "(--lamp-angle), or other lights may be in the picture (--mask, --azimuths)",
      100 * residual, several ? 0.4 : 1.5, several ? "" : "be of several sizes (--spread, --second-size), ");
}

}  // namespace

double DropletMeasurement::ring_deg(std::size_t ring) const { return std::asin(profile.s[ring]) / kDegree; }

void require_droplet_settings(const DropletSettings& o) {
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
  if (!has_angles && o.area_fraction != -1) throw Error("--area-fraction is for --angles; a photo tells it");
  if (has_angles) return;
  if (o.pixel_angle.empty() == (o.fov == 0)) throw Error("give either --pixel-angle or --fov");
  if (o.fov != 0 && !(o.fov > 0 && o.fov < 180)) throw Error("--fov must be between 0 and 180 degrees");
}

DropletMeasurement measure_droplets(const DropletSettings& o, const Image& photo) {
  require_droplet_settings(o);
  const LampSpectrum lamp = lamp_spectrum(o.lamp);
  if (!o.angles.empty()) return fitted_angles(o, lamp);
  const PictureParts parts = picture_parts(o.azimuths, o.masks);
  double clip = 0;
  const Image image = linear_photo(photo, o.photo, clip);
  const double tangent = o.fov > 0 ? 2 * std::tan(0.5 * o.fov * kDegree) / image.width
                                   : std::tan(positive_angle_deg("--pixel-angle", o.pixel_angle) * kDegree);
  const PinholeCamera camera{tangent, 0.5 * image.width, 0.5 * image.height};
  DropletMeasurement m;
  m.center = o.center.size() == 2 ? std::array{o.center[0], o.center[1]} : corona_centre(image, clip, parts);
  if (!(m.center[0] >= 0 && m.center[1] >= 0 && m.center[0] <= image.width && m.center[1] <= image.height))
    throw Error("--center lies outside of the picture");
  const Direction direction = camera.direction(m.center[0], m.center[1]);
  const PaneGeometry geometry = pane_geometry(o);
  const double lamp_radius =
      o.lamp_angle.empty() ? 0 : 0.5 * positive_angle_deg("--lamp-angle", o.lamp_angle) * kDegree;
  const double inner = o.inner.empty() ? 5 * tangent + lamp_radius
                                       : std::sin(positive_angle_deg("--inner", o.inner) * kDegree);
  m.profile = scattered_profile(image, camera, direction, parts, geometry, inner, clip);
  if (m.profile.s.empty())
    throw Error({o.photo, 0, 0}, "no ring is visible: nothing of the picture is left to look at");
  CoronaModel model(lamp, m.profile.s.back(), lamp_radius, positions_of(o));
  try {
    m.fit = fit_corona(m.profile, model,
                       o.spread        ? CoronaSizes::spread
                       : o.second_size ? CoronaSizes::two
                                       : CoronaSizes::one);
  } catch (const Error& e) {
    throw Error({o.photo, 0, 0}, e.message());
  }
  note_doubts(m);
  const bool several = o.spread || o.second_size;
  if (m.fit.residual > (several ? kGoodResidualOfSizes : kGoodResidual))
    m.notes.push_back(residual_note(m.fit.residual, several));
  return m;
}

}  // namespace aureole

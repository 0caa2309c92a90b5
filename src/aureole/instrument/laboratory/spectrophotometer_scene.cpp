// SPDX-License-Identifier: Apache-2.0
#include "aureole/instrument/laboratory/spectrophotometer_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "aureole/core/error.h"
#include "aureole/math/vec.h"

namespace aureole {
namespace {

using Triple = std::array<double, 3>;

constexpr int kRing = 36;               ///< lamps or detectors of an annular geometry
constexpr double kEight = 8 * kDegree;  ///< the angle of incidence of sphere instruments
constexpr double kGap = 2e-4;           ///< between the sample and a receiver or a plate [m]
constexpr double kLampRadius = 6e-3;    ///< of the lamp inside a sphere [m]
constexpr double kWallField = 15e-3;    ///< radius of the wall that a detector views [m]
constexpr double kBaffleMargin =
    0.575;  ///< radius of a baffle halfway over the sum of the radii that it hides from each other
const Triple kSide{0, 1, 0};  ///< from the sphere's centre to its lamp or its detector
/// From the sphere's centre to the lamp of the reference beam: 60 degrees beside the specimen's port. Its light falls on the
/// wall 60 degrees beside the specular port.
const Triple kReference{0.8660254037844386, 0, -0.5};

const char* const kBlack = "<bsdf type=\"diffuse\"><float name=\"reflectance\" value=\"0\"/></bsdf>";

std::string white(double reflectance) {
  return fmt::format("<bsdf type=\"diffuse\"><float name=\"reflectance\" value=\"{:.9g}\"/></bsdf>",
                     reflectance);
}

/// Opaque where a texture coordinate is beyond `edge`, which is below 0.5: `axis` is 'x' (u) or 'y' (v). A checkerboard of which
/// the coordinate 1 - edge falls on the border of the first square.
std::string opaque_beyond(double edge, char axis, const std::string& bsdf) {
  const double scale = 0.5 / (1 - edge);
  return fmt::format(
      "<bsdf type=\"mask\"><texture name=\"opacity\" type=\"checkerboard\"><float name=\"color0\" value=\"1\"/>"
      "<float name=\"color1\" value=\"0\"/><transform name=\"to_uv\"><scale {0}=\"{1:.12g}\" {2}=\"0.001\"/>"
      "<translate {0}=\"{3:.12g}\"/></transform></texture>{4}</bsdf>",
      axis, -scale, axis == 'x' ? 'y' : 'x', scale, bsdf);
}

std::string directions_at(double theta, double first, int count) {
  std::string text;
  for (int i = 0; i < count; ++i) text += fmt::format("{:g} {:g} ", theta, first + 360.0 * i / count);
  return text;
}

/// The view factor from a disc of radius r to a coaxial one of radius `target` at this distance.
double coaxial_view_factor(double r, double target, double distance) {
  const double a = r / distance, b = target / distance, q = b * b / (a * a), x = 1 + (1 + b * b) / (a * a);
  return 2 * q / (x + std::sqrt(x * x - 4 * q));
}

}  // namespace

SpectrophotometerScenes::SpectrophotometerScenes(const Bench& bench, const SpectrophotometerSettings& s)
    : bench_(bench), s_(s) {
  const auto require = [](const char* what, double value, double low, double high, const char* unit) {
    if (!(value >= low && value <= high))
      throw Error(
          fmt::format("{} of {:g}{}: {:g} to {:g}{} is expected", what, value, unit, low, high, unit));
  };
  require("a viewed diameter", s.viewed_m * 1e3, 1e-3, 1e4, " mm");
  require("a lit diameter", s.lit_m * 1e3, 1e-3, 1e4, " mm");
  require("a lamp's half-angle", s.lamp_angle, 0.01, 20, " degrees");
  require("a detector's half-angle", s.detector_angle, 0.01, 20, " degrees");
  require("a standard's reflectance", s.standard, 1e-3, 1, "");
  require("a distance", s.distance_m * 1e3, 10, 1e6, " mm");
  require("noise", s.noise, 0, 1, "");
  require("dark noise", s.dark_noise, 0, 1, "");
  require("a standard's uncertainty", s.standard_error, 0, 1, "");
  require("an error of wavelengths", s.wavelength_error_nm, 0, 100, " nm");
  const MeasuringGeometry& g = s.geometry;
  double spot = s.viewed_m;
  if (g.light < End::sphere) spot = std::max(spot, s.lit_m);
  if (g.has_sphere()) {
    require("a wall's reflectance", s.wall, 0.01, 0.9999, "");
    require("a sphere's diameter", s.sphere_m * 1e3, 1, 1e5, " mm");
    if (!(s.port_m > 0 && s.port_m < s.sphere_m))
      throw Error(fmt::format("a port of {:g} mm does not fit a sphere of {:g} mm: it must be smaller",
                              s.port_m * 1e3, s.sphere_m * 1e3));
    if (s.port_m > 0.6 * s.sphere_m)
      throw Error(fmt::format(
          "a port of {:g} mm leaves too little of a sphere of {:g} mm: at most 0.6 of its diameter is "
          "expected",
          s.port_m * 1e3, s.sphere_m * 1e3));
    if (s.viewed_m > s.port_m)
      throw Error(fmt::format("the viewed diameter of {:g} mm is larger than the port of {:g} mm",
                              s.viewed_m * 1e3, s.port_m * 1e3));
    if (g.light < End::sphere && s.lit_m > s.port_m)
      throw Error(fmt::format("the lit diameter of {:g} mm is larger than the port of {:g} mm", s.lit_m * 1e3,
                              s.port_m * 1e3));
    spot = s.port_m;
    if (kLampRadius + kWallField > 0.3 * radius())
      throw Error(fmt::format(
          "a sphere of {:g} mm is too small for its lamp and detector: at least 140 mm are expected",
          s.sphere_m * 1e3));
    const std::vector<Port> all = ports();
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (all[i].radius > 0.6 * radius())
        throw Error(
            fmt::format("a port of {:g} mm, which the light needs, does not fit the sphere of {:g} mm",
                        2e3 * all[i].radius, s.sphere_m * 1e3));
      for (std::size_t j = 0; j < i; ++j) {
        const Triple &a = all[i].direction, &b = all[j].direction;
        const double angle = std::acos(std::clamp(a[0] * b[0] + a[1] * b[1] + a[2] * b[2], -1.0, 1.0));
        if (angle < std::asin(all[i].radius / radius()) + std::asin(all[j].radius / radius()))
          throw Error(fmt::format(
              "ports of {:.1f} and {:.1f} mm overlap: the angles of lamp, detector or specular port, or the viewed or lit "
              "diameter, are too large for a sphere of {:g} mm",
              2e3 * all[i].radius, 2e3 * all[j].radius, s.sphere_m * 1e3));
      }
    }
  }
  if (s.sample_m < spot)
    throw Error(fmt::format("the sample of {:g} mm is smaller than the spot of {:g} mm on it",
                            s.sample_m * 1e3, spot * 1e3));
  if (s.by_theory && !g.has_sphere())
    throw Error(fmt::format("{} has no sphere, of which a theory could be used", g.name));
}

double SpectrophotometerScenes::height() const { return std::sqrt(radius() * radius() - port() * port()); }

double SpectrophotometerScenes::chord(double angle) const {
  const double h = height(), across = h * std::sin(angle);
  return h * std::cos(angle) + std::sqrt(radius() * radius() - across * across);
}

bool SpectrophotometerScenes::light_is_reversed() const {
  return s_.geometry.view >= End::sphere && s_.geometry.light < End::sphere;
}

bool SpectrophotometerScenes::has_reference_beam() const {
  return s_.geometry.transmits && light_is_reversed() &&
         s_.method == SpectrophotometerSettings::Method::comparison;
}

double SpectrophotometerScenes::reference_radius() const {
  // The lamp's edge lies on the sphere: r = depth tan(angle), with depth^2 + r^2 = R^2.
  return radius() * std::sin(s_.lamp_angle * kDegree);
}

double SpectrophotometerScenes::reference_depth() const {
  return radius() * std::cos(s_.lamp_angle * kDegree);
}

double SpectrophotometerScenes::reference_flux() const {
  const double target = 0.5 * s_.lit_m, lamp = s_.distance_m * std::tan(s_.lamp_angle * kDegree),
               reference = reference_radius();
  return reference * reference * coaxial_view_factor(reference, target, reference_depth()) /
         (lamp * lamp * coaxial_view_factor(lamp, target, s_.distance_m));
}

double SpectrophotometerScenes::view_angle() const {
  const End end = light_is_reversed() ? s_.geometry.light : s_.geometry.view;
  return end == End::eight ? kEight : 0;
}

/// The mirrored rays of a round aperture through a round field cover a disc of this radius as far behind the field.
double SpectrophotometerScenes::specular_radius() const {
  const double length = chord(view_angle());
  if (s_.specular_angle > 0) {
    // The port's disc is nearer than the wall behind it by the depth of its cap.
    double r = 0;
    for (int i = 0; i < 20; ++i)
      r = (length - radius() + std::sqrt(radius() * radius() - r * r)) *
          std::tan(s_.specular_angle * kDegree);
    return r;
  }
  const bool is_lamp = light_is_reversed();
  const double angle = (is_lamp ? s_.lamp_angle : s_.detector_angle) * kDegree;
  const double field = 0.5 * (is_lamp ? s_.lit_m : s_.viewed_m);
  if (!s_.geometry.transmits) return length * std::tan(angle) + 2 * field + 1e-3;
  return field + length * (std::tan(angle) + field / s_.distance_m) + 1e-3;
}

std::vector<SpectrophotometerScenes::Port> SpectrophotometerScenes::ports() const {
  std::vector<Port> all;
  const auto seen_from_centre = [&](double angle, double sign) {
    const double l = chord(angle);
    return Triple{sign * l * std::sin(angle) / radius(), 0, (l * std::cos(angle) - height()) / radius()};
  };
  const MeasuringGeometry& g = s_.geometry;
  const bool both = g.light >= End::sphere && g.view >= End::sphere;
  const double angle = view_angle();
  if (!g.transmits && !both) {
    const double half = (light_is_reversed() ? s_.lamp_angle : s_.detector_angle) * kDegree;
    all.push_back({seen_from_centre(angle, 1), chord(angle) * std::tan(half) + 5e-4});
  }
  const bool excludes = g.light == End::sphere_without_specular || g.view == End::sphere_without_specular;
  // At normal incidence the port of the detector or of the lamp takes the mirrored light.
  if (excludes && (g.transmits || angle > 0)) all.push_back({seen_from_centre(angle, -1), specular_radius()});
  if (has_reference_beam()) all.push_back({kReference, reference_radius()});
  const double tan_detector = std::tan(s_.detector_angle * kDegree);
  all.push_back({kSide, light_is_reversed() ? 2 * radius() * tan_detector + 1e-3 : kLampRadius});
  return all;
}

IntegratingSphere SpectrophotometerScenes::sphere() const {
  IntegratingSphere sphere;
  sphere.wall = s_.wall, sphere.is_flat = true;
  sphere.sample_port = port_fraction(port(), radius());
  const double baffle = kBaffleMargin * ((light_is_reversed() ? kWallField : kLampRadius) + port());
  sphere.baffles = 0.5 * baffle * baffle / (radius() * radius());
  for (const Port& p : ports()) sphere.ports += port_fraction(p.radius, radius());
  return sphere;
}

Transform SpectrophotometerScenes::placed(double x, double y, double z, const Triple& normal) const {
  const double unit = bench_.length_unit_m();
  return facing({x / unit, y / unit, z / unit}, normal);
}

void SpectrophotometerScenes::add_disc(InstrumentScene& scene, const Transform& place, double r,
                                       const std::string& inner) const {
  scene.content += fmt::format(
      "<shape type=\"disk\"><transform name=\"to_world\"><scale value=\"{}\"/><matrix value=\"{}\"/></transform>{}</shape>",
      text(r), matrix_text(place), inner);
}

void SpectrophotometerScenes::add_port(InstrumentScene& scene, const Transform& station,
                                       const Port& p) const {
  const double depth = std::sqrt(radius() * radius() - p.radius * p.radius);
  const Triple& d = p.direction;
  add_disc(scene,
           station * placed(d[0] * depth, d[1] * depth, height() + d[2] * depth, {-d[0], -d[1], -d[2]}),
           p.radius, kBlack);
}

void SpectrophotometerScenes::add_specimen(InstrumentScene& scene, const Specimen& specimen,
                                           const Transform& station, const char* key) const {
  // An opaque sample covers the port; what light may pass is as large as it is.
  const bool fills_port = s_.geometry.has_sphere() && !specimen.is_translucent();
  const double r = fills_port ? port() : 0.5 * s_.sample_m;
  scene.content += specimen_shape(specimen,
                                  {.matrix = matrix_text(station),
                                   .radius = r / bench_.length_unit_m(),
                                   .length_unit_m = bench_.length_unit_m(),
                                   .key = key},
                                  scene.given);
}

void SpectrophotometerScenes::add_lamp(InstrumentScene& scene, double theta, double phi, double distance,
                                       double r, double target) const {
  const Triple d{std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
  add_disc(scene, placed(d[0] * distance, d[1] * distance, d[2] * distance, {-d[0], -d[1], -d[2]}), r,
           fmt::format("<emitter type=\"beam\"><spectrum name=\"radiance\" value=\"1\"/>"
                       "<float name=\"target_radius\" value=\"{}\"/></emitter>",
                       text(target)));
}

void SpectrophotometerScenes::add_detectors(InstrumentScene& scene, const std::string& directions,
                                            std::size_t count, double distance, double field, double aperture,
                                            const Transform& station) const {
  scene.detectors = count;
  scene.content += fmt::format(
      "<sensor type=\"detector\"><string name=\"directions\" value=\"{}\"/><float name=\"distance\" value=\"{}\"/>"
      "<float name=\"field_radius\" value=\"{}\"/><float name=\"aperture_radius\" value=\"{}\"/>"
      "<transform name=\"to_world\"><matrix value=\"{}\"/></transform>{}</sensor>",
      directions, text(distance), text(field), text(aperture), matrix_text(station), bench_.film(count));
}

void SpectrophotometerScenes::add_receiver(InstrumentScene& scene, double z, bool faces_up,
                                           const Transform& station) const {
  add_disc(scene, station * placed(0, 0, z, {0, 0, faces_up ? 1.0 : -1.0}), 0.5 * s_.viewed_m,
           "<bsdf type=\"null\"/><sensor type=\"irradiancemeter\">" + bench_.film(1) + "</sensor>");
}

void SpectrophotometerScenes::add_sphere(InstrumentScene& scene, const Transform& station,
                                         bool has_hole) const {
  std::string wall = white(s_.wall);
  // The texture coordinate v is the angle from the sphere's pole over pi.
  if (has_hole) wall = opaque_beyond(std::asin(port() / radius()) / kPiD, 'y', wall);
  scene.content += fmt::format(
      "<shape type=\"sphere\"><float name=\"radius\" value=\"{}\"/><boolean name=\"flip_normals\" value=\"true\"/>"
      "<transform name=\"to_world\"><rotate x=\"1\" angle=\"180\"/><translate z=\"{}\"/><matrix value=\"{}\"/></transform>"
      "{}</shape>",
      text(radius()), text(height()), matrix_text(station), wall);
}

void SpectrophotometerScenes::add_baffle(InstrumentScene& scene, const Transform& station, const Triple& from,
                                         const Triple& to, double r) const {
  add_disc(scene,
           station * placed(0.5 * (from[0] + to[0]), 0.5 * (from[1] + to[1]), 0.5 * (from[2] + to[2]),
                            {to[0] - from[0], to[1] - from[1], to[2] - from[2]}),
           r, "<bsdf type=\"twosided\">" + white(s_.wall) + "</bsdf>");
}

/// The detector that views the sample from inside of the sphere.
void SpectrophotometerScenes::add_view(InstrumentScene& scene, const Transform& station) const {
  const double angle = view_angle(), length = chord(angle);
  const double half = (light_is_reversed() ? s_.lamp_angle : s_.detector_angle) * kDegree;
  const double aperture = length * std::tan(half), start = length - aperture * aperture / radius() - 1e-3;
  const double field = 0.5 * (light_is_reversed() ? s_.lit_m : s_.viewed_m);
  add_detectors(scene, fmt::format("{:g} 0", angle / kDegree), 1, start, field, aperture, station);
}

void SpectrophotometerScenes::add_lamp_in_port(InstrumentScene& scene, const Transform& place, double r,
                                               const Vec3& target, const Vec3& target_normal) const {
  add_disc(scene, place, r,
           fmt::format("{}<emitter type=\"beam\"><spectrum name=\"radiance\" value=\"1\"/>"
                       "<point name=\"target\" x=\"{:.9g}\" y=\"{:.9g}\" z=\"{:.9g}\"/>"
                       "<vector name=\"target_normal\" x=\"{:.9g}\" y=\"{:.9g}\" z=\"{:.9g}\"/>"
                       "<float name=\"target_radius\" value=\"{}\"/></emitter>",
                       kBlack, target.x, target.y, target.z, target_normal.x, target_normal.y,
                       target_normal.z, text(0.5 * s_.lit_m)));
}

void SpectrophotometerScenes::add_dark_room(InstrumentScene& scene) const {
  const double wide = std::max(2 * s_.sample_m, 4 * s_.port_m), deep = 2 * s_.distance_m;
  const double hole = port() / wide;
  add_disc(scene, placed(0, 0, kGap, {0, 0, 1}), wide, opaque_beyond(hole, 'x', kBlack));
  add_disc(scene, placed(0, 0, -deep, {0, 0, 1}), wide, kBlack);
  scene.content += fmt::format(
      "<shape type=\"cylinder\"><float name=\"radius\" value=\"{}\"/><point name=\"p0\" x=\"0\" y=\"0\" z=\"{}\"/>"
      "<point name=\"p1\" x=\"0\" y=\"0\" z=\"{}\"/>{}</shape>",
      text(wide), text(-deep), text(kGap), kBlack);
}

InstrumentScene SpectrophotometerScenes::instrument(const Specimen& specimen, const Specimen* beside,
                                                    Reads reads) const {
  InstrumentScene scene;
  const MeasuringGeometry& g = s_.geometry;
  const Transform here;
  if (!g.has_sphere()) {
    if (reads != Reads::irradiance) add_specimen(scene, specimen, here, "sample");
    const double d = s_.distance_m, lamp = d * std::tan(s_.lamp_angle * kDegree), target = 0.5 * s_.lit_m;
    if (g.light == End::ring)
      for (int i = 0; i < kRing; ++i) add_lamp(scene, kPiD / 4, 2 * kPiD * i / kRing, d, lamp, target);
    else
      add_lamp(scene, g.light == End::forty_five ? kPiD / 4 : 0, s_.azimuth * kDegree, d, lamp, target);
    if (reads == Reads::irradiance) {
      add_receiver(scene, 0, true, here);
      return scene;
    }
    const bool is_ring = g.view == End::ring;
    const double theta = g.transmits ? 180 : g.view == End::normal ? 0 : 45;
    add_detectors(scene, directions_at(theta, s_.azimuth, is_ring ? kRing : 1), is_ring ? kRing : 1, d,
                  0.5 * s_.viewed_m, d * std::tan(s_.detector_angle * kDegree), here);
    return scene;
  }
  // The sphere lies above the sample. It lies below where it collects what is transmitted.
  const bool is_below = g.transmits && g.view >= End::sphere && g.light < End::sphere;
  const Transform station = is_below
                                ? Transform::translate(0, 0, -specimen.thickness_m / bench_.length_unit_m()) *
                                      Transform::rotate(1, 0, 0, 180)
                                : here;
  const double h = height() / bench_.length_unit_m();
  const Transform other =
      Transform::translate(0, 0, h) * Transform::rotate(0, 1, 0, 90) * Transform::translate(0, 0, -h);
  add_sphere(scene, station, specimen.is_translucent());
  add_specimen(scene, specimen, here, "sample");
  const Triple side{kSide[0] * radius(), kSide[1] * radius(), height() + kSide[2] * radius()};
  const Triple wall{-side[0], -0.995 * side[1], side[2]};  // just in front of the wall
  const std::vector<Port> all = ports();
  for (std::size_t i = 0; i + 1 < all.size(); ++i) {
    // The lamp of a beam is in its own port.
    const bool is_lamp = (i == 0 && light_is_reversed() && !g.transmits) ||
                         (i + 2 == all.size() && reads == Reads::reference_beam);
    if (!is_lamp) add_port(scene, station, all[i]);
    if (beside && !(is_lamp && reads == Reads::standard_beside)) add_port(scene, other, all[i]);
  }
  if (beside) {
    add_specimen(scene, *beside, other, "beside");
    // Neither sample nor standard may light the other one: a dark sample would make the standard darker than itself.
    add_baffle(scene, here, {0, 0, 0}, {-height(), 0, height()}, 2 * kBaffleMargin * port());
  }
  if (!light_is_reversed()) {
    const double depth = std::sqrt(radius() * radius() - kLampRadius * kLampRadius);
    add_disc(
        scene, station * placed(kSide[0] * depth, kSide[1] * depth, height() + kSide[2] * depth, {0, -1, 0}),
        kLampRadius,
        std::string(kBlack) + "<emitter type=\"area\"><spectrum name=\"radiance\" value=\"1\"/></emitter>");
    const double r = kBaffleMargin * (kLampRadius + port());
    add_baffle(scene, station, side, {0, 0, 0}, r);
    if (beside) add_baffle(scene, other, side, {0, 0, 0}, r);
    if (reads == Reads::irradiance)
      add_receiver(scene, kGap, true, station);
    else if (g.view >= End::sphere)
      add_receiver(scene, g.transmits ? -specimen.thickness_m - kGap : kGap, g.transmits, station);
    else if (g.transmits)
      add_detectors(scene, "180 0", 1, s_.distance_m, 0.5 * s_.viewed_m,
                    s_.distance_m * std::tan(s_.detector_angle * kDegree), station);
    else
      add_view(scene, reads == Reads::standard_beside ? other : station);
    return scene;
  }
  scene.integrator = "ptracer";
  const double angle = view_angle();
  if (reads == Reads::reference_beam) {
    // The beam passes the sphere's centre, where it is as wide as the other one at the specimen.
    const Triple& d = kReference;
    const double depth = reference_depth();
    add_lamp_in_port(
        scene, station * placed(d[0] * depth, d[1] * depth, height() + d[2] * depth, {-d[0], -d[1], -d[2]}),
        reference_radius(), station.point({0, 0, float(height() / bench_.length_unit_m())}),
        station.vector({float(d[0]), float(d[1]), float(d[2])}));
  } else if (g.transmits) {
    add_lamp(scene, 0, 0, s_.distance_m, s_.distance_m * std::tan(s_.lamp_angle * kDegree), 0.5 * s_.lit_m);
  } else {
    // The beam turns to the standard for its reading, as in instruments of two beams.
    const double length = chord(angle), r = length * std::tan(s_.lamp_angle * kDegree);
    const Transform& lit = reads == Reads::standard_beside ? other : here;
    const Vec3 target = lit.point({0, 0, 0}), normal = lit.vector({0, 0, 1});
    const double depth = std::sqrt(radius() * radius() - r * r);
    const Triple d = all[0].direction;
    add_lamp_in_port(scene,
                     lit * placed(d[0] * depth, d[1] * depth, height() + d[2] * depth,
                                  {-std::sin(angle), 0, -std::cos(angle)}),
                     r, target, normal);
    if (reads == Reads::standard_beside) add_port(scene, here, all[0]);
  }
  add_port(scene, station, all.back());
  add_baffle(scene, station, wall, {0, 0, 0}, kBaffleMargin * (kWallField + port()));
  if (beside) add_baffle(scene, other, wall, {0, 0, 0}, kBaffleMargin * (kWallField + port()));
  const double across = 1.98 * radius();
  add_detectors(scene, "0 0", 1, across, kWallField, 2 * radius() * std::tan(s_.detector_angle * kDegree),
                station * placed(wall[0], wall[1], wall[2], {0, 1, 0}));
  return scene;
}

InstrumentScene SpectrophotometerScenes::in_even_light(const Specimen& specimen, Reads reads) const {
  InstrumentScene scene;
  scene.content = "<emitter type=\"constant\"><spectrum name=\"radiance\" value=\"1\"/></emitter>";
  const MeasuringGeometry& g = s_.geometry;
  const Transform here;
  // Where light passes the other way than in the instrument, the sample is turned over.
  const bool is_turned = g.transmits && light_is_reversed();
  add_specimen(scene, specimen,
               is_turned ? Transform::translate(0, 0, -specimen.thickness_m / bench_.length_unit_m()) *
                               Transform::rotate(1, 0, 0, 180)
                         : here,
               "sample");
  if (g.transmits || specimen.is_translucent()) add_dark_room(scene);
  if (g.light >= End::sphere && g.view >= End::sphere && reads != Reads::irradiance) {
    add_receiver(scene, g.transmits ? -specimen.thickness_m - kGap : kGap, g.transmits, here);
    return scene;
  }
  const std::vector<Port> all = ports();
  for (std::size_t i = 0; i + 1 < all.size(); ++i) add_port(scene, here, all[i]);
  if (reads == Reads::irradiance) {
    add_receiver(scene, 0.5 * kGap, true, here);
  } else if (g.transmits) {
    const bool is_lamp = light_is_reversed();
    add_detectors(scene, "180 0", 1, s_.distance_m, 0.5 * (is_lamp ? s_.lit_m : s_.viewed_m),
                  s_.distance_m * std::tan((is_lamp ? s_.lamp_angle : s_.detector_angle) * kDegree), here);
  } else {
    add_view(scene, here);
  }
  return scene;
}

InstrumentScene SpectrophotometerScenes::diffuse_reflection(const Specimen& specimen) const {
  InstrumentScene scene;
  scene.content = "<emitter type=\"constant\"><spectrum name=\"radiance\" value=\"1\"/></emitter>";
  add_specimen(scene, specimen, {}, "sample");
  if (specimen.is_translucent()) add_dark_room(scene);
  add_receiver(scene, specimen.is_translucent() ? 2 * kGap : 1e-5, false, {});
  return scene;
}

}  // namespace aureole

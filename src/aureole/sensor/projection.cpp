// SPDX-License-Identifier: Apache-2.0
#include "aureole/sensor/projection.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "aureole/math/warp.h"
#include "aureole/optics/detector/photodetector.h"
#include "aureole/plugin/registry.h"

namespace aureole {

ClipPlanes::ClipPlanes(const Properties& p) {
  // The clip distances are limited, so that their squares stay within the range of float.
  near = float(std::clamp(p.get_float("near_clip", 1e-2, Range::positive()), 1e-12, 1e12));
  far = float(std::clamp(p.get_float("far_clip", 1e4, Range::positive()), 1e-12, 1e18));
  if (far <= near) throw p.error("far_clip", "must be larger than near_clip");
}

std::string ClipPlanes::note(const Properties& p, const Transform& to_camera, std::span<const Bounds3> boxes,
                             double far_z) const {
  bool any_far = false, any_near = false;
  float first = kInfinity, last = -kInfinity;  // nearest and farthest coordinate of the boxes along the axis
  for (const Bounds3& box : boxes) {
    float low = kInfinity, high = -kInfinity;
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3 q{corner & 1 ? box.upper.x : box.lower.x, corner & 2 ? box.upper.y : box.lower.y,
                   corner & 4 ? box.upper.z : box.lower.z};
      const float z = to_camera.point(q).z;
      low = std::min(low, z), high = std::max(high, z);
    }
    if (!(high < near || double(low) > far_z)) return {};
    (high < near ? any_near : any_far) = true;
    first = std::min(first, low), last = std::max(last, high);
  }
  if (boxes.empty()) return {};
  const char* name = any_far ? "far_clip" : "near_clip";
  const Properties::Entry* e = p.find(name);
  return fmt::format(
      "{}: every shape lies {}, so that the camera sees none: along its axis they reach from {:.4g} to {:.4g}, the "
      "near plane is at {:.4g} and the far plane at {:.4g}",
      (e ? e->where : p.where()).str(),
      any_far && any_near ? "before near_clip or beyond far_clip"
      : any_far           ? "beyond far_clip"
      : last < 0          ? "behind the camera"
                          : "before near_clip",
      first, last, near, far_z);
}

Transform rigid_transform(const Properties& p, const Transform& to_world) {
  for (int c = 0; c < 3; ++c) {
    const auto& m = to_world.matrix();
    const double l = std::hypot(m[0][c], m[1][c], m[2][c]);
    if (std::abs(l - 1) > 1e-3) throw p.error("to_world", "a camera's transform must not scale");
  }
  return to_world;
}

LensCamera::LensCamera(const Properties& p) : Sensor(p), clip_(p), field_of_view_(p) {
  const bool irradiance = p.get_choice("measure", "radiance", {"radiance", "irradiance"}) == "irradiance";
  read_common(p, Measures::picture, irradiance ? MeasuredKind::irradiance : MeasuredKind::radiance);
  film().refuse_flux("the pixels of an ideal camera have no size; those of the sensor \"lens\" have one");
  const bool thin = p.get_choice("aperture", "sine", {"sine", "thin"}) == "thin";
  const double f_number = p.get_float("f_number", 2.8, {1e-3, 1e6});
  if (irradiance) {
    try {
      film_angle_ = float(optics::aperture_solid_angle(
          f_number, thin ? optics::ApertureLaw::thin : optics::ApertureLaw::sine));
    } catch (const std::domain_error& e) {
      throw p.error("f_number", e.what());
    }
  } else {
    for (const char* name : {"f_number", "aperture"})
      if (p.has(name))
        p.note(name, "has no effect: with the measure \"radiance\" the brightness does not depend on it");
  }
  to_world_ = rigid_transform(p, read_motion(p));
  to_camera_ = to_world_.inverse();
  origin_ = to_world_.point({0, 0, 0});
  for (int i = 0; i < 3; ++i) axes_[i] = to_world_.vector({float(i == 0), float(i == 1), float(i == 2)});
  principal_point_offset_[0] = p.get_float("principal_point_offset_x", 0, {-10, 10});
  principal_point_offset_[1] = p.get_float("principal_point_offset_y", 0, {-10, 10});
}

void LensCamera::set_lens(double aperture_radius, double focus_distance) {
  aperture_radius_ = float(aperture_radius);
  inverse_focus_ = float(1 / std::max(focus_distance, 1e-9));
}

void LensCamera::fit(PlacedSensor& at) const {
  const double width = at.part.width, height = at.part.height;
  // Tangent of the angle that a pixel subtends at the centre.
  at.pixel_size = float(2 * field_of_view_.tangent_of_half_width(width / height) / width);
  at.film_center = {float(at.part.left + width * (0.5 - principal_point_offset_[0])),
                    float(height * (0.5 - principal_point_offset_[1]))};
}

std::optional<PinholeView> LensCamera::pinhole(const PlacedSensor& at) const {
  if (aperture_radius_ > 0) return {};
  // The axes are reversed, since camera space has x to the left and y up.
  return PinholeView{Transform::scale(-1, -1, 1) * to_camera_, at.film_center, 1 / at.pixel_size, clip_.near,
                     clip_.far};
}

Vec2 LensCamera::aperture_point(Vec2 lens) const {
  return aperture_radius_ > 0 ? square_to_disc_concentric(lens).p * aperture_radius_ : Vec2{};
}

SensorRay LensCamera::sample_ray(const PlacedSensor& at, Vec2 film, Vec2 lens) const {
  // All rays of a film point intersect the plane of focus at one point, found from the ray through the
  // aperture's centre.
  const Vec2 a = aperture_point(lens);
  const Vec3 v{(at.film_center.x - film.x) * at.pixel_size - a.x * inverse_focus_,
               (at.film_center.y - film.y) * at.pixel_size - a.y * inverse_focus_, 1};
  const Vec3 d = normalize(axes_[0] * v.x + axes_[1] * v.y + axes_[2]);
  // Distances along the ray from plane to plane: a unit along the ray is 1 / |v| along z.
  const float slope = length(v), to_near = clip_.near * slope, to_far = clip_.far * slope;
  const Vec3 from = aperture_radius_ > 0 ? to_world_.point({a.x, a.y, 0}) : origin_;
  return {{from + d * to_near, d, to_far - to_near}, weight(slope)};
}

std::optional<SensorConnection> LensCamera::sample_direct(const PlacedSensor& at, const Vec3& reference,
                                                          Vec2 lens) const {
  const Vec3 q = to_camera_.point(reference);
  if (!(q.z >= clip_.near && q.z <= clip_.far)) return {};
  const Vec2 a = aperture_point(lens);
  const Vec3 v{(q.x - a.x) / q.z, (q.y - a.y) / q.z, 1};  // vector from the aperture to q, scaled to z = 1
  const Vec2 film{at.film_center.x - (v.x + a.x * inverse_focus_) / at.pixel_size,
                  at.film_center.y - (v.y + a.y * inverse_focus_) / at.pixel_size};
  if (!at.part.samples(film)) return {};
  // A unit solid angle covers 1 / cos^3 of film at unit distance; a unit area at distance r subtends 1 / r^2
  // = cos^2 / z^2. Aperture points have the same pdf as for the film's own rays, so that it cancels.
  const Vec3 w = to_world_.vector(v), start = to_world_.point({a.x, a.y, 0}) + w * clip_.near;
  return SensorConnection{-normalize(w), start, film,
                          length(v) * weight(length(v)) / (at.pixel_size * at.pixel_size * q.z * q.z)};
}

std::optional<SensorResponse> LensCamera::eval(const PlacedSensor& at, const Vec3& p, const Vec3& d,
                                               std::optional<Vec2>) const {
  const Vec3 local = to_camera_.vector(d);
  if (!(local.z > 0)) return {};
  const Vec3 q = to_camera_.point(p);
  const Vec2 v{local.x / local.z, local.y / local.z};
  Vec2 a{q.x - v.x * q.z, q.y - v.y * q.z};
  // Whether the ray passes through the pinhole, to within the rounding error of the coordinates.
  const float rounding = 1e-5f * (length(origin_) + length(q));
  const float reach = std::max(aperture_radius_, rounding), r2 = aperture_radius_ * aperture_radius_;
  if (dot(a, a) > reach * reach) return {};
  if (!(aperture_radius_ > 0)) a = {};
  SensorResponse response;
  response.film = {at.film_center.x - (v.x + a.x * inverse_focus_) / at.pixel_size,
                   at.film_center.y - (v.y + a.y * inverse_focus_) / at.pixel_size};
  if (!at.part.samples(response.film)) return {};
  response.pdf_position = aperture_radius_ > 0 ? 1 / (kPi * r2) : 1;
  // A unit solid angle covers 1 / cos^3 of the plane at unit distance.
  const float inverse_cosine = length(local) / local.z, pixel = at.pixel_size;
  response.pdf_direction =
      inverse_cosine * inverse_cosine * inverse_cosine / (pixel * pixel * at.part.sample_area());
  response.weight = weight(inverse_cosine);
  const float distance = q.z * inverse_cosine;
  response.pdf_across = distance > 0 ? response.pdf_direction / (distance * distance) : 0;
  return response;
}

std::vector<ParameterDoc> camera_parameters(std::vector<ParameterDoc> own) {
  own.push_back(
      {"near_clip", "float", "scene units", "0.01",
       "distance of the near clip plane from the camera, measured along its axis and not along the ray: nothing "
       "nearer is visible"});
  own.push_back(
      {"far_clip", "float", "scene units", "10000",
       "distance of the far clip plane from the camera, measured along its axis: nothing farther is visible. "
       "A pixel that meets no shape between the planes has the light of the environment (alpha 1), or is "
       "black (alpha 0)"});
  return own;
}

std::vector<ParameterDoc> lens_camera_parameters(std::vector<ParameterDoc> own) {
  own.push_back({"to_world", "transform", "", "identity",
                 "camera to world; must not scale. An `<animation>` of key frames moves the camera"});
  own.push_back({"fov", "float", "degrees", "from focal_length", "field of view along fov_axis"});
  own.push_back({"fov_axis", "string", "", "x", "x, y, diagonal, smaller or larger"});
  own.push_back({"focal_length", "string", "mm", "50mm",
                 "instead of fov: focal length of a 35 mm camera with the same diagonal field of view"});
  own.push_back({"principal_point_offset_x", "float", "film widths", "0", "shifts the centre of projection"});
  own.push_back(
      {"principal_point_offset_y", "float", "film heights", "0", "shifts the centre of projection"});
  own.push_back(
      {"measure", "string", "", "radiance",
       "radiance along the rays, or irradiance on the film: the radiance times the solid angle of the aperture "
       "and cos^4 of the angle to the axis"});
  own.push_back(
      {"f_number", "float", "", "2.8", "for the irradiance: focal length over diameter of the aperture"});
  own.push_back(
      {"aperture", "string", "", "sine",
       "which solid angle an f-number N has in the middle of the film: sine, pi/(4 N^2), of a lens that meets "
       "Abbe's sine condition; thin, pi sin^2(atan(1/(2 N))), of an ideal thin lens, which `thinlens` is"});
  return camera_parameters(std::move(own));
}

}  // namespace aureole

// SPDX-License-Identifier: Apache-2.0
// Pinhole camera. Looks along local +z; local +x points left and +y up in the picture, as in Mitsuba.
#include <cmath>

#include "aureole/core/units.h"
#include "aureole/plugin/registry.h"
#include "aureole/sensor/sensor.h"

namespace aureole {
namespace {

class PerspectiveSensor final : public Sensor {
public:
  explicit PerspectiveSensor(const Properties& p) : Sensor(p) {
    read_common(p);
    to_world_ = p.get_transform("to_world");
    for (int c = 0; c < 3; ++c) {
      const auto& m = to_world_.matrix();
      const double l = std::hypot(m[0][c], m[1][c], m[2][c]);
      if (std::abs(l - 1) > 1e-3) throw p.error("to_world", "a camera's transform must not scale");
    }
    near_clip_ = float(p.get_float("near_clip", 1e-2, Range::positive()));
    far_clip_ = float(p.get_float("far_clip", 1e4, Range::positive()));
    if (far_clip_ <= near_clip_) throw p.error("far_clip", "must be larger than near_clip");
    if (p.find("focus_distance"))
      p.note("focus_distance", "a pinhole has no focus: \"focus_distance\" has no effect");
    const bool opens = p.find("shutter_open"), closes = p.find("shutter_close");
    if (opens || closes) p.note("shutter_open", "nothing moves: the shutter times have no effect");

    const double width = film().width(), height = film().height(), aspect = width / height;
    const double tangent_x = tangent_of_half_width(p, aspect);
    scale_x_ = float(2 * tangent_x / width);
    scale_y_ = float(2 * tangent_x / width);
    center_x_ = float(width * (0.5 - p.get_float("principal_point_offset_x", 0, {-10, 10})));
    center_y_ = float(height * (0.5 - p.get_float("principal_point_offset_y", 0, {-10, 10})));
    origin_ = to_world_.point({0, 0, 0});
    to_local_ = to_world_.inverse();
  }

  SensorRay sample_ray(Vec2 film, Vec2) const override {
    const Vec3 d = normalize(Vec3{(center_x_ - film.x) * scale_x_, (center_y_ - film.y) * scale_y_, 1});
    const float to_near = near_clip_ / d.z, to_far = far_clip_ / d.z;
    const Vec3 w = to_world_.vector(d);
    return {{origin_ + w * to_near, normalize(w), to_far - to_near}};
  }

  std::optional<SensorConnection> sample_direct(const Vec3& reference, Vec2) const override {
    const Vec3 to = reference - origin_, local = to_local_.vector(to);
    if (!(local.z > near_clip_ && local.z < far_clip_)) return {};
    const float distance = length(to);
    SensorConnection c;
    c.wo = to * (-1 / distance);
    // A ray of the camera starts at the near plane, so that what is nearer hides nothing.
    c.p = origin_ + to * (near_clip_ / local.z);
    c.film = {center_x_ - local.x / (local.z * scale_x_), center_y_ - local.y / (local.z * scale_y_)};
    // The solid angle of an area across wo is 1/distance^2 of it, and the plane at z = 1 has cos^-3 area per
    // solid angle.
    c.importance = distance / (scale_x_ * scale_y_ * local.z * local.z * local.z);
    return c;
  }

private:
  /// tan(half the horizontal field of view), from `fov` about `fov_axis` or from `focal_length` on 35 mm
  /// film.
  static double tangent_of_half_width(const Properties& p, double aspect) {
    const std::string axis = p.get_choice("fov_axis", "x", {"x", "y", "diagonal", "smaller", "larger"});
    double fov = p.get_float("fov", -1, {1e-4, 179.9999});
    if (p.find("focal_length")) {
      if (p.has("fov")) throw p.error("focal_length", "give either \"fov\" or \"focal_length\"");
      double mm = 0;
      std::string text = p.get_string("focal_length");
      if (text.ends_with("mm")) text.resize(text.size() - 2);
      try {
        mm = parse_number(text);
      } catch (const Error&) {
      }
      if (!(mm > 0)) throw p.error("focal_length", "expected a length such as \"50mm\"");
      return std::sqrt(36.0 * 36 + 24 * 24) / (2 * mm) / std::sqrt(1 + 1 / (aspect * aspect));
    }
    if (fov < 0) return std::sqrt(36.0 * 36 + 24 * 24) / (2 * 50) / std::sqrt(1 + 1 / (aspect * aspect));
    const double t = std::tan(0.5 * fov * M_PI / 180);
    if (axis == "y" || (axis == "smaller" && aspect > 1) || (axis == "larger" && aspect < 1))
      return t * aspect;
    if (axis == "diagonal") return t / std::sqrt(1 + 1 / (aspect * aspect));
    return t;
  }

  Transform to_world_, to_local_;
  Vec3 origin_;
  float near_clip_, far_clip_, scale_x_, scale_y_, center_x_, center_y_;
};

AUREOLE_PLUGIN(
    PerspectiveSensor, "sensor", "perspective",
    PluginDoc{"Pinhole camera that looks along its local +z axis.",
              "",
              {{"to_world", "transform", "", "identity", "camera to world; must not scale"},
               {"fov", "float", "degrees", "from focal_length", "field of view along fov_axis"},
               {"fov_axis", "string", "", "x", "x, y, diagonal, smaller or larger"},
               {"focal_length", "string", "mm", "50mm",
                "instead of fov: of a 35 mm camera with the same diagonal angle"},
               {"near_clip", "float", "scene units", "0.01", "nothing nearer is seen"},
               {"far_clip", "float", "scene units", "10000", "nothing farther is seen"},
               {"principal_point_offset_x", "float", "film widths", "0", "shifts the centre of projection"},
               {"principal_point_offset_y", "float", "film heights", "0", "shifts the centre of projection"},
               {"focus_distance", "float", "scene units", "none", "accepted without effect"},
               {"shutter_open", "float", "s", "0", "accepted without effect"},
               {"shutter_close", "float", "s", "0", "accepted without effect"},
               {"film", "film", "", "hdrfilm", "what is measured and stored"},
               {"sampler", "sampler", "", "sobol", "sample points"}},
              {R"(<sensor type="perspective">
    <transform name="to_world"><lookat origin="0, 0, -5" target="0, 0, 0" up="0, 1, 0"/></transform>
    <float name="fov" value="40"/> <string name="fov_axis" value="smaller"/>
    <float name="near_clip" value="0.1"/> <float name="far_clip" value="100"/>
    <float name="principal_point_offset_x" value="0.1"/> <float name="principal_point_offset_y" value="0"/>
    <float name="focus_distance" value="5"/>
    <film type="hdrfilm"/> <sampler type="sobol"/>
</sensor>)",
               R"(<sensor type="perspective"><string name="focal_length" value="35mm"/></sensor>)"}});

}  // namespace
}  // namespace aureole

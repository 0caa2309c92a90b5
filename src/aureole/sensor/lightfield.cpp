// SPDX-License-Identifier: Apache-2.0
// A sensor of the light field through a rectangle, by two planes.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "aureole/plugin/registry.h"
#include "aureole/sensor/projection.h"

namespace aureole {
namespace {

class LightFieldSensor final : public Sensor {
public:
  explicit LightFieldSensor(const Properties& p) : Sensor(p), clip_(p) {
    read_common(p);
    to_world_ = rigid_transform(p, read_motion(p));
    to_camera_ = to_world_.inverse();
    views_x_ = int(p.get_int("views_x", 8, {1, 4096})),
    views_y_ = int(p.get_int("views_y", views_x_, {1, 4096}));
    width_ = p.get_float("aperture_width", {0, 1e9, true});
    height_ = p.get_float("aperture_height", width_, {0, 1e9, true});
    distance_ = p.get_float("plane_distance", {0, 1e9, true});
    field_ = p.get_float("field_width", {0, 1e9, true});
    from_points_ = p.get_choice("positions", "cell", {"cell", "point"}) == "point";
    if (film().width() % views_x_ != 0 || film().height() % views_y_ != 0)
      throw p.error("views_x", fmt::format("the film of {} x {} pixels cannot be divided into {} x {} views",
                                           film().width(), film().height(), views_x_, views_y_));
  }

  bool uses_lens() const override { return !from_points_; }
  bool only_samples_rays() const override { return true; }

  SensorRay sample_ray(const PlacedSensor& at, Vec2 film, Vec2 lens) const override {
    const double view_width = double(at.part.width) / views_x_,
                 view_height = double(at.part.height) / views_y_;
    const double x = std::clamp(double(film.x - at.part.left), 0.0,
                                std::nextafter(double(at.part.width), 0.0)),
                 y = std::clamp(double(film.y), 0.0, std::nextafter(double(at.part.height), 0.0));
    const double i = std::floor(x / view_width), j = std::floor(y / view_height);
    // Camera space has x to the left and y up.
    const double s = width_ * (0.5 - (i + (from_points_ ? 0.5 : double(lens.x))) / views_x_),
                 t = height_ * (0.5 - (j + (from_points_ ? 0.5 : double(lens.y))) / views_y_);
    const double pixel = field_ / view_width, u = field_ / 2 - (x - i * view_width) * pixel,
                 v = (view_height / 2 - (y - j * view_height)) * pixel;
    const Vec3 d{float(u - s), float(v - t), float(distance_)};
    const float slope = length(d) / d.z;
    const Vec3 unit = d * (1 / length(d));
    return {{to_world_.point(Vec3{float(s), float(t), 0} + unit * (clip_.near * slope)),
             normalize(to_world_.vector(unit)), (clip_.far - clip_.near) * slope}};
  }

  std::string clipping_note(std::span<const Bounds3> shapes) const override {
    return clip_.note(properties(), to_camera_, shapes, clip_.far);
  }

private:
  Transform to_world_, to_camera_;
  ClipPlanes clip_;
  int views_x_, views_y_;
  double width_, height_, distance_, field_;
  bool from_points_;
};

AUREOLE_PLUGIN(
    LightFieldSensor, "sensor", "lightfield",
    PluginDoc{
        "The light field through a rectangle, by two planes: the plane of the camera (s, t), and a plane (u, v) before it. "
        "The film is divided into views, one for each cell of the rectangle, each with the window of the plane (u, v) as its "
        "picture. `aureole lightfield` refocuses it and makes views from other places.",
        "Levoy & Hanrahan 1996, \"Light field rendering\"; Gortler, Grzeszczuk, Szeliski & Cohen 1996, \"The lumigraph\"",
        camera_parameters(
            {{"to_world", "transform", "", "identity",
              "camera to world; must not scale. An `<animation>` of key frames moves the camera"},
             {"views_x", "integer", "", "8", "cells of the rectangle along x, which divide the film's width"},
             {"views_y", "integer", "", "views_x", "cells along y, which divide the film's height"},
             {"aperture_width", "float", "scene units", "required", "width of the rectangle"},
             {"aperture_height", "float", "scene units", "aperture_width", "height of the rectangle"},
             {"plane_distance", "float", "scene units", "required", "distance of the plane (u, v)"},
             {"field_width", "float", "scene units", "required",
              "width of the window in the plane (u, v); its height follows from the pixels of a view"},
             {"positions", "string", "", "cell",
              "where rays begin: cell, anywhere in the cell of a view; point, in its middle"}}),
        {R"(<sensor type="lightfield">
    <transform name="to_world"><lookat origin="0, 0, -5" target="0, 0, 0" up="0, 1, 0"/></transform>
    <integer name="views_x" value="4"/> <integer name="views_y" value="4"/>
    <float name="aperture_width" value="0.4"/> <float name="aperture_height" value="0.4"/>
    <float name="plane_distance" value="5"/> <float name="field_width" value="4"/> <string name="positions" value="cell"/>
    <float name="near_clip" value="0.1"/> <float name="far_clip" value="100"/>
    <film type="hdrfilm"><integer name="width" value="256"/><integer name="height" value="256"/></film> <sampler type="sobol"/>
</sensor>)"}});

}  // namespace
}  // namespace aureole

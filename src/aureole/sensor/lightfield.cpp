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

  bool uses_lens() const override { return true; }

  SensorRay sample_ray(const PlacedSensor& at, Vec2 film, Vec2 lens) const override {
    const View view = view_of(at);
    const double x = std::clamp(double(film.x - at.part.left), 0.0,
                                std::nextafter(double(at.part.width), 0.0)),
                 y = std::clamp(double(film.y), 0.0, std::nextafter(double(at.part.height), 0.0));
    const double i = std::floor(x / view.width), j = std::floor(y / view.height);
    // Camera space has x to the left and y up.
    const double s = width_ * (0.5 - (i + (from_points_ ? 0.5 : double(lens.x))) / views_x_),
                 t = height_ * (0.5 - (j + (from_points_ ? 0.5 : double(lens.y))) / views_y_);
    const double u = (0.5 * view.width - (x - i * view.width)) * view.pixel,
                 v = (0.5 * view.height - (y - j * view.height)) * view.pixel;
    const Vec3 d{float(u - s), float(v - t), float(distance_)};
    const float slope = length(d) / d.z;
    const Vec3 unit = d * (1 / length(d)), from{float(s), float(t), 0};
    return {{to_world_.point(from + unit * (clip_.near * slope)), normalize(to_world_.vector(unit)),
             (clip_.far - clip_.near) * slope}};
  }

  std::optional<SensorConnection> sample_direct(const PlacedSensor& at, const Vec3& reference,
                                                Vec2 lens) const override {
    const Vec3 q = to_camera_.point(reference);
    if (!(q.z >= clip_.near && q.z <= clip_.far)) return {};
    const View view = view_of(at);
    double a = double(lens.x) * views_x_, b = double(lens.y) * views_y_;
    if (from_points_) a = std::floor(a) + 0.5, b = std::floor(b) + 0.5;
    const double s = width_ * (0.5 - a / views_x_), t = height_ * (0.5 - b / views_y_);
    const auto film = film_of(at, view, std::floor(a), std::floor(b), s + (q.x - s) * distance_ / q.z,
                              t + (q.y - t) * distance_ / q.z);
    if (!film) return {};
    const Vec3 v{float((q.x - s) / q.z), float((q.y - t) / q.z), 1};
    const Vec3 w = to_world_.vector(v), start = to_world_.point({float(s), float(t), 0}) + w * clip_.near;
    // As of a thin lens, for one view; a view averages over its own cell, and the point is sampled among all of them.
    const double tangent = view.pixel / distance_;
    return SensorConnection{-normalize(w), start, *film,
                            float(double(length(v)) * views_x_ * views_y_ / (tangent * tangent * q.z * q.z))};
  }

  std::optional<SensorResponse> eval(const PlacedSensor& at, const Vec3& p, const Vec3& d,
                                     std::optional<Vec2>) const override {
    const Vec3 local = to_camera_.vector(d), q = to_camera_.point(p);
    if (!(local.z > 0)) return {};
    const double slope_x = double(local.x) / local.z, slope_y = double(local.y) / local.z;
    double s = q.x - slope_x * q.z, t = q.y - slope_y * q.z;
    double a = (0.5 - s / width_) * views_x_, b = (0.5 - t / height_) * views_y_;
    if (from_points_) {
      // Whether the ray passes the middle of a cell, to within the rounding error of the coordinates.
      const double near_a = std::floor(a) + 0.5, near_b = std::floor(b) + 0.5;
      const double rounding = 1e-5 * double(length(to_world_.point({0, 0, 0})) + length(q));
      if (std::abs(a - near_a) * width_ / views_x_ > rounding ||
          std::abs(b - near_b) * height_ / views_y_ > rounding)
        return {};
      a = near_a, b = near_b;
      s = width_ * (0.5 - a / views_x_), t = height_ * (0.5 - b / views_y_);
    }
    if (!(a >= 0 && a < views_x_ && b >= 0 && b < views_y_)) return {};
    const View view = view_of(at);
    const auto film =
        film_of(at, view, std::floor(a), std::floor(b), s + slope_x * distance_, t + slope_y * distance_);
    if (!film) return {};
    SensorResponse response;
    response.film = *film;
    response.pdf_position = float(from_points_ ? 1.0 / (views_x_ * views_y_) : 1 / (width_ * height_));
    const double inverse_cosine = double(length(local)) / local.z, tangent = view.pixel / distance_;
    response.pdf_direction = float(inverse_cosine * inverse_cosine * inverse_cosine /
                                   (tangent * tangent * view.width * view.height));
    const double distance = q.z * inverse_cosine;
    response.pdf_across = distance > 0 ? float(response.pdf_direction / (distance * distance)) : 0;
    return response;
  }

  std::string clipping_note(std::span<const Bounds3> shapes) const override {
    return clip_.note(properties(), to_camera_, shapes, clip_.far);
  }

private:
  /// Size of a view [pixels], and width of a pixel in the plane (u, v).
  struct View {
    double width, height, pixel;
  };
  View view_of(const PlacedSensor& at) const {
    const double width = double(at.part.width) / views_x_;
    return {width, double(at.part.height) / views_y_, field_ / width};
  }
  /// Film position of the point (u, v) in the view (i, j); nothing outside of its window.
  static std::optional<Vec2> film_of(const PlacedSensor& at, const View& view, double i, double j, double u,
                                     double v) {
    const double x = 0.5 * view.width - u / view.pixel, y = 0.5 * view.height - v / view.pixel;
    if (!(x >= 0 && x < view.width && y >= 0 && y < view.height)) return {};
    const Vec2 film{float(at.part.left + i * view.width + x), float(j * view.height + y)};
    if (!at.part.samples(film)) return {};
    return film;
  }

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

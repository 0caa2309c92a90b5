// SPDX-License-Identifier: Apache-2.0
// A grid of receivers on a plane or on a shape.
#include <algorithm>
#include <cmath>

#include "aureole/plugin/registry.h"
#include "aureole/sensor/placed_sensor.h"
#include "aureole/shape/shape_area.h"

namespace aureole {
namespace {

class PowerMap final : public Sensor {
public:
  explicit PowerMap(const Properties& p) : Sensor(p) {
    read_common(p, Measures::picture, MeasuredKind::irradiance);
    shared_film()->use_box_filter("it would spread the power of a cell over its neighbours: a box is used");
    const std::string measure =
        p.get_choice("measure", "fluence", {"fluence", "irradiance", "cylindrical", "semicylindrical"});
    measure_ = measure == "fluence"       ? Receiver::Measure::fluence
               : measure == "irradiance"  ? Receiver::Measure::irradiance
               : measure == "cylindrical" ? Receiver::Measure::cylindrical
                                          : Receiver::Measure::semicylindrical;
    if (measure != "irradiance")
      shared_film()->set_measured(MeasuredKind::irradiance, measure == "fluence" ? "spherical" : measure);
    const Transform to_world = p.get_transform("to_world");
    corner_ = to_world.point({-1, 1, 0});
    right_ = to_world.vector({2, 0, 0}), down_ = to_world.vector({0, -2, 0});
    const Vec3 across = cross(right_, down_);
    area_ = length(across);
    if (!(area_ > 0 && std::isfinite(area_)))
      throw p.error("to_world", "the plane of the receivers needs an area that is neither zero nor infinite");
    normal_ = across * (1 / area_);
    per_right_ = cross(down_, normal_) * (1 / area_);
    per_down_ = cross(normal_, right_) * (1 / area_);
    if (dot(normal_, to_world.normal({0, 0, 1})) < 0) normal_ = -normal_;
    if (measure != "irradiance") film().refuse_flux("its \"measure\" must be \"irradiance\"");
    const double unit = p.context().length_unit_m;
    if (film().measures_flux())
      cell_area_ = float(double(area_) * unit * unit / (double(film().width()) * double(film().height())));
    read_cylinder(p);
  }

  void check_shape(const ShapeArea& area) const override {
    if (properties().has("to_world"))
      throw properties().error(
          "to_world", "a power map on a shape measures on the surface of that: leave \"to_world\" out");
    // Points along a side of the grid at which gaps are searched; it is finer than most gaps between the
    // charts of a texture atlas.
    constexpr int kSide = 64;
    for (int i = 0; i < kSide * kSide; ++i)
      if (area.point_at_uv({(float(i % kSide) + 0.5f) / kSide, (float(i / kSide) + 0.5f) / kSide})) return;
    throw Error(properties().where(),
                "the shape has no texture coordinates in [0, 1] x [0, 1], which the cells of a power map "
                "divide: give it some, or put the map on a plane by \"to_world\"");
  }

  void fit(PlacedSensor& at) const override {
    if (at.area)
      at.cell_areas = std::make_shared<const std::vector<float>>(
          areas_of_cells(*at.area, int(at.part.width), int(at.part.height)));
  }

  bool uses_lens() const override { return true; }

  std::optional<Receiver> receiver(const PlacedSensor& at, Vec2 film) const override {
    const Vec2 u{(film.x - at.part.left) / at.part.width, film.y / at.part.height};
    if (!at.area) return receiver_at(corner_ + right_ * u.x + down_ * u.y, {}, normal_);
    const auto s = at.area->point_at_uv(u);
    if (!s) return {};
    Receiver r = receiver_at(s->p, s->p_error, s->ng);
    r.weight = weight_on_shape(at, u, s->pdf);
    if (!(r.weight > 0)) return {};
    return r;
  }

  SensorRay sample_ray(const PlacedSensor& at, Vec2 film, Vec2 lens) const override {
    const auto place = receiver(at, film);
    return place ? place->sample_ray(lens) : SensorRay{{}, 0};
  }

  std::optional<SensorConnection> sample_direct(const PlacedSensor& at, const Vec3& reference,
                                                Vec2 lens) const override {
    const Vec2 lower = at.part.lower, size = at.part.upper - lower;
    const Vec2 film{lower.x + size.x * lens.x, lower.y + size.y * lens.y};
    const auto place = receiver(at, film);
    if (!place) return {};
    return place->connect(reference, film, at.part.sample_area());
  }

  /// Response of a plane only, since a line may intersect the surface of a shape more than once.
  std::optional<SensorResponse> eval(const PlacedSensor& at, const Vec3& p, const Vec3& d,
                                     std::optional<Vec2>) const override {
    const auto place = place_on_plane(at, {p, -d, kInfinity});
    if (!place) return {};
    SensorResponse response;
    response.film = place->film;
    response.pdf_direction = place->receiver.pdf(d);
    if (!(response.pdf_direction > 0)) return {};
    response.weight = place->receiver.total();
    response.pdf_position = pixels_per_area(at) / at.part.sample_area();
    response.pdf_across = response.pdf_direction / (place->t * place->t);
    return response;
  }

  bool counts_crossings() const override { return true; }
  std::optional<SensorCrossing> crossing(const PlacedSensor& at, const Ray& light) const override {
    const auto place = place_on_plane(at, light);
    if (!place) return {};
    const float seen = place->receiver.response(-light.d), cosine = std::abs(dot(light.d, normal_));
    if (!(seen > 0)) return {};
    return SensorCrossing{place->receiver.p, place->film, pixels_per_area(at) * seen / cosine};
  }

private:
  /// Areas by a lattice in each cell: midpoints along v, multiples of the golden ratio along u, so that no borders of
  /// triangles or of the charts of a texture atlas lie along it.
  static std::vector<float> areas_of_cells(const ShapeArea& area, int width, int height) {
    constexpr double kMostPoints = 4e6, kGolden = 0.6180339887498949;
    const int count = int(std::clamp(kMostPoints / (double(width) * height), 16.0, 4096.0));
    std::vector<float> areas;
    areas.reserve(std::size_t(width) * std::size_t(height));
    for (int row = 0; row < height; ++row)
      for (int column = 0; column < width; ++column) {
        double sum = 0;
        for (int i = 0; i < count; ++i) {
          const double x = 0.5 + kGolden * i, u = (column + x - std::floor(x)) / width,
                       v = (row + (i + 0.5) / count) / height;
          if (const auto s = area.point_at_uv({float(u), float(v)})) sum += 1 / double(s->pdf);
        }
        areas.push_back(float(sum / (double(width) * height * count)));
      }
    return areas;
  }
  /// Points are uniform over the texture coordinates: the weight makes the mean over a cell that over its area, or the power
  /// through it.
  float weight_on_shape(const PlacedSensor& at, Vec2 u, float pdf) const {
    const int width = int(at.part.width), height = int(at.part.height);
    const auto index = [](float x, int count) { return std::clamp(int(x * float(count)), 0, count - 1); };
    const double cells = double(width) * height, area = 1 / double(pdf);
    if (film().measures_flux()) {
      const double unit = properties().context().length_unit_m;
      return float(area / cells * unit * unit);
    }
    const double of_cell = (*at.cell_areas)[std::size_t(index(u.y, height)) * std::size_t(width) +
                                            std::size_t(index(u.x, width))];
    if (!(of_cell > 0)) return 0;
    const double ratio = area / (cells * of_cell);
    // Even cells keep their values from rounding errors.
    constexpr double kRounding = 1e-5;
    return std::abs(ratio - 1) < kRounding ? 1 : float(ratio);
  }

  struct Place {
    Receiver receiver;
    Vec2 film;
    float t;
  };
  /// Returns the intersection of a ray with the plane; nothing outside the map, and for a map on a shape.
  std::optional<Place> place_on_plane(const PlacedSensor& at, const Ray& ray) const {
    if (at.area) return {};
    const float t = dot(corner_ - ray.o, normal_) / dot(ray.d, normal_);
    if (!(t > 0 && t < ray.t_max)) return {};
    const Vec3 p = ray.o + ray.d * t;
    const Vec2 u{dot(p - corner_, per_right_), dot(p - corner_, per_down_)};
    const Vec2 film{at.part.left + u.x * at.part.width, u.y * at.part.height};
    if (!at.part.samples(film)) return {};
    return Place{receiver_at(p, {}, normal_), film, t};
  }
  /// Returns a receiver at a point of the plane or of a shape. On a shape, the axis of a cylinder is along
  /// the normal unless one is stated.
  Receiver receiver_at(const Vec3& p, const Vec3& p_error, const Vec3& ng) const {
    Receiver r{p, p_error, ng, measure_, cell_area_};
    if (measure_ == Receiver::Measure::cylindrical || measure_ == Receiver::Measure::semicylindrical) {
      r.axis = has_axis_ ? axis_ : ng;
      r.ng = measure_ == Receiver::Measure::semicylindrical ? facing_ : Frame::from_normal(r.axis).s;
    }
    return r;
  }
  void read_cylinder(const Properties& p) {
    const bool is_semi = measure_ == Receiver::Measure::semicylindrical,
               is_cylinder = is_semi || measure_ == Receiver::Measure::cylindrical;
    has_axis_ = p.has("axis");
    axis_ = has_axis_ ? unit_direction(p, "axis", p.get_vec3("axis", {})) : normal_;
    p.find("axis");
    const Vec3 up = down_ * -1.f;
    const Vec3 facing =
        p.has("facing") ? unit_direction(p, "facing", p.get_vec3("facing", {})) : normalize(up);
    p.find("facing");
    if (has_axis_ && !is_cylinder) p.note("axis", "has no effect: it is that of a cylinder");
    if (p.has("facing") && !is_semi) p.note("facing", "has no effect: it is that of a semicylinder");
    if (!is_semi) return;
    const Vec3 across = facing - axis_ * dot(facing, axis_);
    if (!(length_squared(across) > 1e-6f))
      throw p.error(p.has("facing") ? "facing" : "axis",
                    "the semicylinder faces along its own axis: give an \"axis\" "
                    "and a \"facing\" at a right angle");
    facing_ = normalize(across);
  }
  float pixels_per_area(const PlacedSensor& at) const { return at.part.width * at.part.height / area_; }

  Receiver::Measure measure_;
  Vec3 corner_, right_, down_;  ///< the picture's upper left corner and its sides, in the world
  /// dual vectors of the sides, which give the picture's coordinates of a point of the plane
  Vec3 per_right_, per_down_;
  Vec3 normal_;
  Vec3 axis_, facing_;  ///< axis of a cylinder, and the direction that a semicylinder faces
  bool has_axis_ = false;
  float area_;
  float cell_area_ =
      1;  ///< area by which the irradiance is multiplied [m^2]; 1 unless the film measures power
};

AUREOLE_PLUGIN(
    PowerMap, "sensor", "powermap",
    PluginDoc{
        .summary =
            "A grid of receivers: each pixel of its film is a cell and holds the power that arrives there "
            "per area [W/(m^2 nm) for a spectral film], averaged over the cell. The cells divide the "
            "square [-1, 1] x [-1, 1] of the plane z = 0 of `to_world`, x to the right and y up in the "
            "picture. As a child of a shape, they divide the texture coordinates [0, 1] x [0, 1] of its "
            "surface instead, u to the right and v down, like a picture on the shape; a cell then holds the mean over "
            "its part of the surface, or the power through that. The plane is not a "
            "surface, and light passes it unchanged; it must not coincide with surfaces. Delta emitters, "
            "such as `point`, count as well. The reconstruction filter is a box. `path` traces rays from "
            "the cells; `ptracer` and, for a plane, `bdpt` connect light paths to them. `ptracer` also "
            "records light from mirrors and beams that crosses a plane. `aureole powermap` writes maps in "
            "dB.",
        .source = "",
        .parameters =
            {{"to_world", "transform", "", "identity",
              "position of the plane: the image of the square with corners (-1, -1, 0) and (1, 1, 0)"},
             {"measure", "string", "", "fluence",
              "fluence: the fluence rate, equal response to all directions: the power per cross section of "
              "a small isotropic receiver; irradiance: with the cosine, on the side of the plane's z axis "
              "or of the shape's normal; cylindrical: the mean over the side of a small cylinder about `axis`, as people "
              "see each other in a room; semicylindrical: the mean over the half of that side about `facing`"},
             {"axis", "vector", "", "the normal of the plane or the shape",
              "axis of the cylinder, usually upwards"},
             {"facing", "vector", "", "up in the picture",
              "direction that a semicylinder faces; its part at a right angle to the axis counts"}},
        .examples = {R"(<sensor type="powermap">
    <transform name="to_world"><scale x="50" y="30"/><translate z="1.5"/></transform>
    <string name="measure" value="fluence"/>
    <film type="hdrfilm">
        <integer name="width" value="100"/> <integer name="height" value="60"/>
        <string name="wavelength_min" value="28.1GHz"/> <string name="wavelength_max" value="27.9GHz"/>
        <string name="response" value="uniform"/> <rfilter type="box"/>
    </film>
    <sampler type="sobol"/>
</sensor>)",
                     R"(<sensor type="powermap"><string name="measure" value="semicylindrical"/>
    <vector name="axis" x="0" y="0" z="1"/><vector name="facing" x="1" y="0" z="0"/>
    <film type="hdrfilm"><string name="quantity" value="illuminance"/></film></sensor>)"}});

}  // namespace
}  // namespace aureole

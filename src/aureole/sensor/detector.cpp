// SPDX-License-Identifier: Apache-2.0
// Detectors behind apertures, around a sample: each views the same field of the sample from its own direction.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "aureole/math/warp.h"
#include "aureole/plugin/number_list.h"
#include "aureole/plugin/registry.h"
#include "aureole/sensor/placed_sensor.h"

namespace aureole {
namespace {

class Detector final : public Sensor {
public:
  explicit Detector(const Properties& p) : Sensor(p) {
    read_common(p, Measures::picture, MeasuredKind::radiance);
    shared_film()->use_box_filter("each pixel is a detector: a box is used");
    read_place(p);
    distance_ = p.get_float("distance", 1, Range::positive());
    field_radius_ = p.get_float("field_radius", Range::positive());
    const auto size = p.find("aperture_size") ? get_number_list(p, "aperture_size") : std::vector<double>{};
    if (!size.empty()) {
      if (p.has("aperture_radius"))
        throw p.error("aperture_size", "give either \"aperture_size\" or \"aperture_radius\"");
      if (size.size() != 2 || !(size[0] > 0 && size[1] > 0))
        throw p.error("aperture_size",
                      "expected two positive numbers: width in the plane of the normal, and height");
      half_width_ = 0.5 * size[0], half_height_ = 0.5 * size[1], is_round_ = false;
    } else {
      half_width_ = half_height_ = p.get_float("aperture_radius", Range::positive());
    }
    const std::vector<double> angles = get_number_list(p, "directions");
    const std::size_t pixels = std::size_t(film().width()) * std::size_t(film().height());
    if (angles.size() % 2 != 0)
      throw p.error("directions", "expected pairs of a polar angle and an azimuth in degrees");
    if (angles.size() != 2 * pixels)
      throw p.error("directions",
                    fmt::format("there are {} directions for {} pixels of the film: one each is expected",
                                angles.size() / 2, pixels));
    for (std::size_t k = 0; k < pixels; ++k) add_view(p, angles[2 * k], angles[2 * k + 1]);
  }

  bool uses_lens() const override { return true; }
  void check_in_batch(const FilmPart&) const override {
    throw Error(properties().where(), "detectors fill a film of their own and cannot be in a batch");
  }

  /// The position within the pixel chooses a point of the field, `lens` one of the aperture. The weight is the element
  /// of etendue over its mean.
  SensorRay sample_ray(const PlacedSensor&, Vec2 position, Vec2 lens) const override {
    const int x = std::clamp(int(position.x), 0, film().width() - 1),
              y = std::clamp(int(position.y), 0, film().height() - 1);
    const View& view = views_[std::size_t(y * film().width() + x)];
    const Vec3 field = field_point({position.x - float(x), position.y - float(y)}),
               aperture = aperture_point(view, lens);
    const Vec3 to = field - aperture;
    const float distance2 = length_squared(to);
    const Vec3 d = to * (1 / std::sqrt(distance2));
    const float element = std::abs(dot(d, normal_)) * std::max(0.f, -dot(d, view.axis)) / distance2;
    return {{aperture, d, kInfinity}, element * view.inverse_mean};
  }

  /// Connects to a uniform point of an aperture; of several detectors each is chosen as often. For a point of the aperture, the
  /// field's area times |cos|/d^2 is the solid angle of the directions.
  std::optional<SensorConnection> sample_direct(const PlacedSensor&, const Vec3& reference,
                                                Vec2 lens) const override {
    const float count = float(views_.size());
    const std::size_t chosen = std::min(std::size_t(lens.x * count), views_.size() - 1);
    const View& view = views_[chosen];
    const Vec3 aperture = aperture_point(view, {lens.x * count - float(chosen), lens.y});
    const Vec3 to = aperture - reference;
    const float distance2 = length_squared(to);
    if (!(distance2 > 0)) return {};
    const Vec3 wo = to * (1 / std::sqrt(distance2));
    const float slope = dot(wo, normal_), facing = dot(wo, view.axis);
    if (!(facing > 0) || slope == 0) return {};
    // The point of the field that the aperture views through the reference.
    const float t = dot(aperture - center_, normal_) / slope;
    const Vec3 field = aperture - wo * t;
    if (!(t > 0) || length_squared(field - center_) > float(field_radius_ * field_radius_)) return {};
    const float area = kPi * float(field_radius_ * field_radius_);
    const Vec2 film_position{float(chosen % std::size_t(film().width())) + 0.5f,
                             float(chosen / std::size_t(film().width())) + 0.5f};
    return SensorConnection{wo, aperture, film_position,
                            count * facing * view.inverse_mean / (area * distance2)};
  }

private:
  struct View {
    Vec3 axis, across, up;   ///< from the field to the aperture; along its width and its height
    float inverse_mean = 1;  ///< over the mean element of etendue
  };

  void read_place(const Properties& p) {
    const Transform to_world = p.get_transform("to_world");
    Vec3 axes[3];
    for (int i = 0; i < 3; ++i) {
      const Vec3 v = to_world.vector({i == 0 ? 1.f : 0.f, i == 1 ? 1.f : 0.f, i == 2 ? 1.f : 0.f});
      if (std::abs(length(v) - 1) > 1e-3f)
        throw p.error("to_world", "must not scale: the sizes of field and aperture are in the scene's units");
      axes[i] = normalize(v);
      for (int k = 0; k < i; ++k)
        if (std::abs(dot(axes[i], axes[k])) > 1e-3f) throw p.error("to_world", "must not shear");
    }
    center_ = to_world.point({0, 0, 0});
    tangent_ = axes[0], bitangent_ = axes[1], normal_ = axes[2];
  }

  void add_view(const Properties& p, double theta, double phi) {
    if (!(theta >= 0 && theta <= 180))
      throw p.error("directions", fmt::format("a polar angle is {:g}; 0 to 180 degrees are expected", theta));
    const double t = theta * kDegree, a = phi * kDegree;
    const auto world = [&](double x, double y, double z) {
      return tangent_ * float(x) + bitangent_ * float(y) + normal_ * float(z);
    };
    View v;
    v.axis = world(std::sin(t) * std::cos(a), std::sin(t) * std::sin(a), std::cos(t));
    v.across = world(std::cos(t) * std::cos(a), std::cos(t) * std::sin(a), -std::sin(t));
    v.up = cross(v.axis, v.across);
    constexpr int kPoints = 2048;
    double sum = 0;
    for (int k = 0; k < kPoints; ++k) {
      const auto point = [&](double x, double y) {
        const double u = 0.5 + x * k, w = 0.5 + y * k;
        return Vec2{float(u - std::floor(u)), float(w - std::floor(w))};
      };
      const Vec3 to = field_point(point(0.8566748838545029, 0.733891856627126)) -
                      aperture_point(v, point(0.6287067210378087, 0.5385972572236101));
      const float distance2 = length_squared(to);
      sum += double(std::abs(dot(to, normal_)) * std::max(0.f, -dot(to, v.axis)) / (distance2 * distance2));
    }
    if (!(sum > 0))
      throw p.error("directions",
                    fmt::format("at {:g} degrees no light of the field reaches the aperture", theta));
    v.inverse_mean = float(kPoints / sum);
    views_.push_back(v);
  }

  Vec3 field_point(Vec2 u) const {
    const Vec2 q = square_to_disc_concentric(u).p * float(field_radius_);
    return center_ + tangent_ * q.x + bitangent_ * q.y;
  }
  Vec3 aperture_point(const View& v, Vec2 u) const {
    const Vec2 q = is_round_ ? square_to_disc_concentric(u).p : Vec2{2 * u.x - 1, 2 * u.y - 1};
    return center_ + v.axis * float(distance_) + v.across * (q.x * float(half_width_)) +
           v.up * (q.y * float(half_height_));
  }

  Vec3 center_, tangent_, bitangent_, normal_;
  double distance_ = 1, field_radius_ = 1, half_width_ = 1, half_height_ = 1;
  bool is_round_ = true;
  std::vector<View> views_;
};

AUREOLE_PLUGIN(
    Detector, "sensor", "detector",
    PluginDoc{
        "Detectors of a goniometer or a spectrophotometer, one for each pixel of the film. Each has an aperture at a "
        "distance from the centre of a round field, perpendicular to its direction, and views the field alone. Its pixel "
        "holds the mean radiance over field and aperture, weighted by the element of etendue cos cos dA dA/d^2: the flux "
        "through both over their etendue. Rays begin at the aperture, which has no geometry itself. `path`, `direct` "
        "and `ptracer` find its light.",
        "F. E. Nicodemus, J. C. Richmond, J. J. Hsia, I. W. Ginsberg, T. Limperis, Geometrical considerations and "
        "nomenclature for reflectance, NBS Monograph 160, 1977",
        {{"directions", "string", "degrees", "required",
          "polar angle from the normal of the field and azimuth from local +x, for each pixel, row by row"},
         {"distance", "float", "scene units", "1", "distance of the apertures from the centre of the field"},
         {"field_radius", "float", "scene units", "required",
          "radius of the field, in the local plane z = 0"},
         {"aperture_radius", "float", "scene units", "required without aperture_size",
          "radius of the apertures"},
         {"aperture_size", "string", "scene units", "none",
          "instead: width, in the plane of the direction and the normal, and height of rectangular apertures"},
         {"to_world", "transform", "", "identity",
          "field to world: its centre is the origin, its normal +z"}},
        {R"(<sensor type="detector">
    <string name="directions" value="0 0, 45 180"/>
    <float name="distance" value="2"/> <float name="field_radius" value="0.1"/> <float name="aperture_radius" value="0.05"/>
    <film type="hdrfilm"><integer name="width" value="2"/><integer name="height" value="1"/><rfilter type="box"/></film>
    <sampler type="sobol"/>
</sensor>)",
         R"(<sensor type="detector">
    <string name="directions" value="60 0"/>
    <float name="field_radius" value="0.01"/> <string name="aperture_size" value="0.08, 0.2"/>
    <transform name="to_world"><translate z="1"/></transform>
    <film type="hdrfilm"><integer name="width" value="1"/><integer name="height" value="1"/><rfilter type="box"/></film>
</sensor>)"}});

}  // namespace
}  // namespace aureole

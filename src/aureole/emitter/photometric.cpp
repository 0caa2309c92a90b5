// SPDX-License-Identifier: Apache-2.0
// A luminaire by the intensities of an IES or EULUMDAT file, as a point or a luminous opening that no ray hits.
#include <cmath>

#include "aureole/emitter/directions/emitter_placement.h"
#include "aureole/emitter/directions/intensity_sampler.h"
#include "aureole/emitter/light.h"
#include "aureole/emitter/luminaire/luminaire_parameters.h"
#include "aureole/math/warp.h"
#include "aureole/plugin/registry.h"

namespace aureole {
namespace {

/// Maps two random numbers to a point of the opening, uniformly over its area if it is flat, else over its
/// volume.
class OpeningPoints {
public:
  OpeningPoints(const LuminousOpening& opening, double length_unit_m)
      : shape_(opening.shape), axis_(opening.axis) {
    for (std::size_t i = 0; i < 3; ++i) half_[i] = float(0.5 * opening.size_m[i] / length_unit_m);
    is_point_ = opening.is_point();
    // The axis of the section: for a cylinder its own axis; for a box the axis of its shortest side, so that
    // the two larger sides come first.
    if (shape_ == LuminousOpening::Shape::box) axis_ = int(std::min_element(half_, half_ + 3) - half_);
  }
  bool is_point() const { return is_point_; }
  /// Half of the extents along the axes of the luminaire [scene units].
  Vec3 half_size() const { return {half_[0], half_[1], half_[2]}; }

  Vec3 sample(Vec2 u) const {
    if (is_point_) return {};
    // The first number is divided into 64 strata, and the rest of it into 64 steps of a third number.
    constexpr float kStrata = 64;
    const float scaled = u.x * kStrata, stratum = std::floor(scaled), rest = (scaled - stratum) * kStrata;
    const float third = (std::floor(rest) + 0.5f) / kStrata;
    const Vec2 v = half_[axis_] > 0 ? Vec2{(stratum + rest - std::floor(rest)) / kStrata, u.y} : u;
    const int a = (axis_ + 1) % 3, b = (axis_ + 2) % 3;
    float p[3] = {};
    switch (shape_) {
      case LuminousOpening::Shape::box:
        p[a] = (2 * v.x - 1) * half_[a], p[b] = (2 * v.y - 1) * half_[b],
        p[axis_] = (2 * third - 1) * half_[axis_];
        break;
      case LuminousOpening::Shape::cylinder: {
        const Vec2 disc = square_to_disc_concentric(v).p;
        p[a] = disc.x * half_[a], p[b] = disc.y * half_[b], p[axis_] = (2 * third - 1) * half_[axis_];
        break;
      }
      case LuminousOpening::Shape::ellipsoid: {
        const Vec3 d = square_to_uniform_sphere(v) * std::cbrt(third);
        p[0] = d.x * half_[0], p[1] = d.y * half_[1], p[2] = d.z * half_[2];
      }
    }
    return {p[0], p[1], p[2]};
  }

private:
  LuminousOpening::Shape shape_;
  int axis_;
  float half_[3];
  bool is_point_;
};

class PhotometricEmitter final : public Emitter {
public:
  explicit PhotometricEmitter(const Properties& p)
      : Emitter(p),
        motion_(get_placement_motion(p)),
        placement_(get_placement(p, motion_.first())),
        light_(get_luminaire(p)),
        sampler_(light_.luminaire.distribution),
        opening_(p.get_choice("opening", "file", {"file", "point"}) == "file" ? light_.luminaire.opening
                                                                              : LuminousOpening{},
                 p.context().length_unit_m) {}

  bool is_delta() const override { return true; }
  const Motion* motion() const override { return motion_.is_moving() ? &motion_ : nullptr; }

  std::optional<DirectSample> sample_direct(const Light&, const Vec3& reference, std::size_t, Vec2 u,
                                            const Wavelengths& w) const override {
    const Vec3 p = point_of_opening(u), to = p - reference;
    const float d2 = length_squared(to);
    if (!(d2 > 0)) return {};
    DirectSample s;
    s.wo = to * (1 / std::sqrt(d2));
    const float cd = float(light_.candela(placement_.axes.to_local(-s.wo)));
    if (!(cd > 0)) return {};
    s.p = p;
    s.radiance = light_.per_candela->eval({}, w) * (cd / d2);
    s.pdf = 1;
    s.delta = true;
    return s;
  }

  std::optional<EmittedRay> sample_ray(const Light&, std::size_t, Vec2 position, Vec2 direction,
                                       const Wavelengths& w) const override {
    EmittedRay r;
    const Vec3 local = sampler_.sample(direction, &r.pdf_direction);
    const float cd = float(light_.candela(local));
    if (!(r.pdf_direction > 0 && cd > 0)) return {};
    r.p = point_of_opening(position);
    r.d = normalize(placement_.axes.to_world(local));
    r.value = light_.per_candela->eval({}, w) * cd;
    r.pdf_position = 1, r.delta_position = true;
    return r;
  }

  RayDensity pdf_ray(const Light&, std::size_t, const SurfacePoint*, const Vec3& d) const override {
    return {1, sampler_.pdf(placement_.axes.to_local(d))};
  }

  SampledSpectrum power_spectrum(const Light&) const override {
    SampledSpectrum s = light_.per_candela->average();
    s.scale(float(light_.flux));
    return s;
  }

  EmissionBounds emission_bounds(const Light&, std::size_t) const override {
    const Vec3 half = opening_.half_size(), o = placement_.origin;
    const Vec3 reach =
        abs(placement_.axes.s) * half.x + abs(placement_.axes.t) * half.y + abs(placement_.axes.n) * half.z;
    // Cone of the bounds: it exceeds the largest angle by the rounding error of the light tree's arithmetic.
    const double edge = std::min(M_PI, light_.luminaire.distribution.widest_angle() + 2e-3);
    const bool wide = edge >= M_PI / 2;
    return {{o - reach, o + reach},
            placement_.axes.n,
            float(wide ? std::cos(edge - M_PI / 2) : 1),
            float(wide ? 0 : std::cos(edge)),
            1,
            float(M_PI * light_.luminaire.distribution.maximum() / light_.flux)};
  }

private:
  Vec3 point_of_opening(Vec2 u) const {
    return opening_.is_point() ? placement_.origin
                               : placement_.origin + placement_.axes.to_world(opening_.sample(u));
  }

  Motion motion_;
  Placement placement_;
  LuminaireLight light_;
  IntensitySampler sampler_;
  OpeningPoints opening_;
};

AUREOLE_PLUGIN(
    PhotometricEmitter, "emitter", "photometric",
    PluginDoc{
        "A luminaire by its luminous intensities, from a file of its maker: IES LM-63 or EULUMDAT. The intensities are "
        "in cd, so that a scene with it is absolute, in W/(m^2 sr nm). Between the angles of the file they are bilinear. "
        "Directions are sampled by the intensity. The light comes from points spread evenly over the luminous opening of "
        "the file (over the volume of one that is not flat), each with the whole distribution. No ray hits it: "
        "`photometricarea` is a luminaire that is seen. The direction of both angles zero (gamma = 0, straight down for "
        "most luminaires) is the local +z axis. For type C, x runs along the luminaire, and C increases "
        "counter-clockwise as seen from above: in LM-63, C = 0 is +x and C = 90 is -y; in EULUMDAT, C = 0 is -y and C = "
        "90 is -x. For types A and B, y is up and a positive horizontal angle is at -x.",
        "ANSI/IES LM-63-19; IESNA LM-63-2002; A. W. Stockmar, EULUMDAT, Licht '90; CIE 121-1996",
        luminaire_parameter_rows(
            {{"opening", "string", "", "file", "file: the luminous opening of the file; point: a point"},
             {"to_world", "transform", "", "identity",
              "light to world: moves the photometric centre and turns +z to the direction of both angles zero. It does "
              "not scale the opening. An `<animation>` of key frames moves the light"}}),
        {R"(<emitter type="photometric">
    <string name="filename" value="downlight.ies"/> <float name="color_temperature" value="3000"/>
    <float name="flux" value="1200"/> <float name="scale" value="0.8"/> <float name="tilt_angle" value="0"/>
    <string name="opening" value="point"/> <string name="c0" value="along"/>
    <transform name="to_world"><lookat origin="0, 3, 0" target="0, 0, 0" up="0, 0, 1"/></transform>
</emitter>)",
         R"(<emitter type="photometric"><string name="filename" value="batten.ldt"/><integer name="lamp_set" value="0"/>
    <float name="lamp_flux" value="4000"/><spectrum name="spectrum" type="illuminant"><string name="name" value="FL11"/></spectrum></emitter>)"}});

}  // namespace
}  // namespace aureole

// SPDX-License-Identifier: Apache-2.0
// A projector of pictures: the reciprocal of a pinhole camera. Its radiometry is Mitsuba's: a value of one
// makes a white diffuse screen at z = 1 as bright as radiance one, so that the screen receives the irradiance
// pi.
#include <cmath>

#include "aureole/emitter/amount/emission_amount.h"
#include "aureole/emitter/directions/emitter_placement.h"
#include "aureole/emitter/light.h"
#include "aureole/math/piecewise.h"
#include "aureole/plugin/field_of_view.h"
#include "aureole/plugin/registry.h"
#include "aureole/texture/texture.h"

namespace aureole {
namespace {

class ProjectorEmitter final : public Emitter {
public:
  explicit ProjectorEmitter(const Properties& p)
      : Emitter(p),
        motion_(get_placement_motion(p)),
        placement_(get_placement(p, motion_.first())),
        scale_(float(p.get_float("scale", 1, Range::non_negative()))) {
    const Emission emission(p, "irradiance");
    irradiance_ = emission.texture();
    if (std::abs(placement_.scale - 1) > 1e-3)
      throw p.error("to_world", "a projector's transform must not scale");
    const auto [width, height] = irradiance_->resolution();
    const double aspect = double(width) / height, tangent = FieldOfView(p).tangent_of_half_width(aspect);
    half_width_ = float(tangent), half_height_ = float(tangent / aspect);
    area_ = 4 * tangent * tangent / aspect;
    irradiance_ = emission.scaled({.flux = per_square_unit(p) / (M_PI * area_)});
    build_distribution(width, height);
  }

  bool is_delta() const override { return true; }
  const Motion* motion() const override { return motion_.is_moving() ? &motion_ : nullptr; }

  std::optional<DirectSample> sample_direct(const Light&, const Vec3& reference, std::size_t, Vec2,
                                            const Wavelengths& w) const override {
    const Vec3 to = reference - placement_.origin;
    const Vec3 local = placement_.axes.to_local(to);
    Vec2 uv;
    if (!project(local, uv)) return {};
    const float distance = length(to), inverse_z = 1 / local.z;
    DirectSample s;
    s.wo = to * (-1 / distance);
    s.p = placement_.origin;
    s.radiance = at(uv, w) * (distance * inverse_z * inverse_z * inverse_z);
    s.pdf = 1;
    s.delta = true;
    return s;
  }

  std::optional<EmittedRay> sample_ray(const Light&, std::size_t, Vec2, Vec2 direction,
                                       const Wavelengths& w) const override {
    float pdf;
    const Vec2 uv = distribution_.sample(direction, &pdf);
    if (!(pdf > 0)) return {};
    const Vec3 local = normalize(Vec3{(1 - 2 * uv.x) * half_width_, (1 - 2 * uv.y) * half_height_, 1});
    const float inverse_cosine3 = 1 / (local.z * local.z * local.z);
    EmittedRay r;
    r.p = placement_.origin;
    r.d = normalize(placement_.axes.to_world(local));
    r.value = at(uv, w) * inverse_cosine3;
    r.pdf_position = 1, r.delta_position = true;
    r.pdf_direction = pdf * inverse_cosine3 / float(area_);
    return r;
  }

  RayDensity pdf_ray(const Light&, std::size_t, const SurfacePoint*, const Vec3& d) const override {
    Vec2 uv;
    const Vec3 local = placement_.axes.to_local(d);
    if (!project(local, uv)) return {1, 0};
    return {1, distribution_.pdf(uv) / (local.z * local.z * local.z * float(area_))};
  }

  SampledSpectrum power_spectrum(const Light&) const override {
    SampledSpectrum s = irradiance_->average();
    s.scale(float(M_PI * scale_ * area_));
    return s;
  }

  EmissionBounds emission_bounds(const Light&, std::size_t) const override {
    // The bound exceeds the picture's half-diagonal by the rounding error of the light tree's arithmetic.
    const double corner = std::atan(std::hypot(half_width_, half_height_));
    return {{placement_.origin, placement_.origin},
            placement_.axes.n,
            1,
            float(std::cos(corner + 2e-3)),
            1,
            float(M_PI / area_)};
  }

private:
  /// Computes the position in the picture of a direction; returns false outside the picture.
  bool project(const Vec3& local, Vec2& uv) const {
    if (!(local.z > 0)) return false;
    uv = {0.5f - 0.5f * local.x / (local.z * half_width_), 0.5f - 0.5f * local.y / (local.z * half_height_)};
    return uv.x >= 0 && uv.x <= 1 && uv.y >= 0 && uv.y <= 1;
  }

  /// Irradiance of the plane z = 1 at `uv`.
  Spectrum at(Vec2 uv, const Wavelengths& w) const {
    SurfacePoint point;
    point.uv = uv;
    return irradiance_->eval(point, w) * (kPi * scale_);
  }

  /// Builds the sampling density: cells of the picture's texels, up to 256 x 256. Each has the mean of a
  /// lattice of points in it, plus a small fraction of the picture's mean, so that texels between lattice
  /// points are never missed.
  void build_distribution(int width, int height) {
    constexpr int kMaxSize = 256, kOfPattern = 64;
    const bool picture = width > 1 || height > 1;
    const int columns = irradiance_->is_constant() ? 1 : picture ? std::min(width, kMaxSize) : kOfPattern;
    const int rows = irradiance_->is_constant() ? 1 : picture ? std::min(height, kMaxSize) : kOfPattern;
    const int points = std::max(width, height) > kMaxSize ? 8 : 4;
    const SpectralGrid& grid = properties().context().grid;
    const Wavelengths w =
        Wavelengths::at(grid, make_spectrum([&](int i) {
                          return float(grid.min_nm + (grid.max_nm - grid.min_nm) * (i + 0.5) / kWavelengths);
                        }));
    std::vector<float> weights;
    double sum = 0;
    for (int y = 0; y < rows; ++y)
      for (int x = 0; x < columns; ++x) {
        float weight = 0;
        for (int j = 0; j < points; ++j)
          for (int i = 0; i < points; ++i)
            weight += mean(at({(float(x) + float(i) / float(points - 1)) / float(columns),
                               (float(y) + float(j) / float(points - 1)) / float(rows)},
                              w));
        weights.push_back(weight);
        sum += weight;
      }
    const float least = float(0.05 * sum / double(weights.size()));
    for (float& weight : weights) weight += least;
    distribution_ = Piecewise2D(weights, columns, rows);
  }

  Motion motion_;
  Placement placement_;
  TexturePtr irradiance_;
  float scale_, half_width_, half_height_;  ///< scale, and half the picture's width and height at z = 1
  double area_;                             ///< area of the picture at z = 1
  Piecewise2D distribution_;
};

AUREOLE_PLUGIN(
    ProjectorEmitter, "emitter", "projector",
    PluginDoc{
        "Projects a picture from a point along the local +z axis, with the geometry of the camera "
        "`perspective`: the left of the picture is at local +x. A uniform picture irradiates a plane "
        "perpendicular to the axis uniformly. A white diffuse screen at distance 1 looks like the "
        "picture: it receives pi times `irradiance` (as in Mitsuba).",
        "",
        with_amount_parameters(
            {{"irradiance", "texture", "W/(m^2 nm), any common scale", "1",
              "the picture; its width and height in pixels give the aspect of the projected rectangle, a square "
              "for a texture without pixels"},
             {"scale", "float", "", "1", "factor of the irradiance"},
             {"fov", "float", "degrees", "from focal_length", "field of view of the picture along fov_axis"},
             {"fov_axis", "string", "", "x", "x, y, diagonal, smaller or larger"},
             {"focal_length", "string", "mm", "50mm",
              "instead of fov: focal length of a 35 mm camera with the same diagonal field of view"},
             {"to_world", "transform", "", "identity",
              "projector to world; must not scale. An `<animation>` of key frames moves the light"}},
            "lm, W", "flux of the picture, before `scale`"),
        {R"(<emitter type="projector">
    <texture name="irradiance" type="d65"><texture type="bitmap"><string name="filename" value="slide.png"/></texture></texture>
    <float name="fov" value="30"/> <string name="fov_axis" value="larger"/> <float name="scale" value="20"/>
    <transform name="to_world"><lookat origin="0, 1, 4" target="0, 1, 0" up="0, 1, 0"/></transform>
</emitter>)",
         R"(<emitter type="projector"><string name="focal_length" value="35mm"/></emitter>)",
         R"(<emitter type="projector"><string name="amount" value="2500 lm"/><float name="color_temperature" value="6500"/></emitter>)",
         R"(<emitter type="projector"><string name="amount" value="200 W"/><float name="efficacy" value="12"/></emitter>)"}});

}  // namespace
}  // namespace aureole

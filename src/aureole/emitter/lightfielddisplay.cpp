// SPDX-License-Identifier: Apache-2.0
// A light-field display: a flat shape that shows the light field of a file to eyes and cameras before it.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "aureole/core/channel_meanings.h"
#include "aureole/core/error.h"
#include "aureole/core/image.h"
#include "aureole/emitter/light.h"
#include "aureole/emitter/surface/cosine_rays.h"
#include "aureole/optics/photometry/solid_angle.h"
#include "aureole/parameter/lightfield/light_field_axes.h"
#include "aureole/plugin/registry.h"
#include "aureole/shape/area_sampler.h"
#include "aureole/spectrum/photometry.h"
#include "aureole/spectrum/tables.h"
#include "aureole/texture/texture.h"

namespace aureole {
namespace {

class LightFieldDisplay final : public Emitter {
public:
  explicit LightFieldDisplay(const Properties& p) : Emitter(p) {
    const std::filesystem::path file = p.get_file("filename");
    scale_ = float(p.get_float("scale", 1, Range::positive()));
    nearest_ = p.get_choice("views", "bilinear", {"bilinear", "nearest"}) == "nearest";
    has_focus_ = p.has("focus_distance");
    focus_ = p.get_float("focus_distance", 1, {0, 1e9, true});
    ExrAttributes attributes;
    const Image picture = read_image(file, &attributes);
    try {
      axes_ = parse_light_field_axes(attributes.strings[kLightFieldAttribute], picture.width, picture.height,
                                     file.filename().string());
    } catch (const Error& e) {
      throw p.error("filename", e.message());
    }
    // A luminance of 1 in cd/m^2 is a radiance of 1/(683 lm/W times the integral of V) times the flat spectrum's.
    if (attributes.strings[kChannelsAttribute].find("cd/m^2") != std::string::npos)
      scale_ *= float(1 / (kPhotopicEfficacy * cie_y_integral()));
    const auto bitmap = make_object(p, "texture", "bitmap",
                                    {{"filename", file.string()}, {"wrap_mode", std::string("clamp")}});
    Properties named(p.type(), p.id(), p.where(), p.shared_context());
    named.add("radiance", ObjectPtr(bitmap), p.where());
    mosaic_ = get_texture(named, "radiance", 1, SpectrumRole::emission);
  }

  std::shared_ptr<const Emitter> fitted_to(const Light& light) const override {
    auto fitted = std::make_shared<LightFieldDisplay>(*this);
    fitted->place(light);
    return fitted;
  }

  std::size_t part_count(const Light& light) const override { return light.area->patch_count(); }
  std::size_t part_of(const Light& light, const SurfacePoint& point) const override {
    return light.area->patch_of_primitive(point.primitive);
  }

  Spectrum eval(const SurfacePoint& point, const Vec3& w, const Wavelengths& wavelengths) const override {
    return dot(point.ng, w) > 0 ? radiance(point.p, w, wavelengths) : Spectrum(0.f);
  }

  std::optional<DirectSample> sample_direct(const Light& light, const Vec3& reference, std::size_t part,
                                            Vec2 u, const Wavelengths& wavelengths) const override {
    const PositionSample s = light.area->sample_direct_position(reference, part, u);
    if (!(s.pdf > 0)) return {};
    DirectSample d;
    d.wo = normalize(s.p - reference);
    if (!(dot(s.ng, d.wo) < 0)) return {};
    d.p = s.p, d.p_error = s.p_error, d.ng = s.ng, d.pdf = s.pdf;
    d.radiance = radiance(s.p, -d.wo, wavelengths);
    return d;
  }

  std::optional<EmittedRay> sample_ray(const Light& light, std::size_t part, Vec2 position, Vec2 direction,
                                       const Wavelengths& wavelengths) const override {
    return sample_cosine_ray(light, part, position, direction, [&](const ShapeSample& s, const Vec3& d) {
      return radiance(s.p, d, wavelengths);
    });
  }
  RayDensity pdf_ray(const Light& light, std::size_t part, const SurfacePoint* point,
                     const Vec3& d) const override {
    return cosine_ray_density(light, part, *point, d);
  }
  float pdf_direct(const Light& light, const Vec3& reference, std::size_t part,
                   const SurfacePoint& point) const override {
    return light.area->pdf_direct(reference, part, point);
  }

  /// The power of the mean radiance into the directions that the light field has.
  SampledSpectrum power_spectrum(const Light& light) const override {
    SampledSpectrum s = mosaic_->average();
    s.scale(float(double(scale_) * projected_ * light.surface_area));
    return s;
  }
  EmissionBounds emission_bounds(const Light& light, std::size_t part) const override {
    const auto [axis, cosine] = light.area->patch_normals(part);
    return {light.area->patch_bounds(part), axis, cosine, 0, patch_fraction(light, part),
            float(M_PI / projected_)};
  }

private:
  /// Finds the window in the place of the shape.
  void place(const Light& light) {
    const auto at = [&](float u, float v) {
      const auto s = light.area->point_at_uv({u, v});
      if (!s)
        throw Error(
            properties().where(),
            "a light-field display needs a shape with texture coordinates over [0, 1] x [0, 1], such as a "
            "rectangle");
      return *s;
    };
    constexpr float kFirst = 1e-4f, kLast = 1 - kFirst, kSpan = kLast - kFirst;
    const ShapeSample middle = at(0.5f, 0.5f), left = at(kFirst, 0.5f), right = at(kLast, 0.5f),
                      low = at(0.5f, kFirst), high = at(0.5f, kLast);
    const Vec3 across = right.p - left.p, along = high.p - low.p;
    const double width = double(length(across) / kSpan), height = double(length(along) / kSpan);
    if (!(width > 0 && height > 0 && std::isfinite(width) && std::isfinite(height)))
      throw Error(properties().where(), "the shape has no area that could show a light field");
    for (const ShapeSample* s : {&left, &right, &low, &high})
      if (dot(s->ng, middle.ng) < 1 - 1e-4f || std::abs(dot(s->p - middle.p, middle.ng)) > 1e-4 * width)
        throw Error(properties().where(), "a light-field display must be flat, such as a rectangle");
    right_ = across * (1 / length(across)), normal_ = middle.ng, up_ = cross(normal_, right_);
    center_ = middle.p;
    if (std::abs(dot(right_, along)) > 1e-3f * length(along))
      throw Error(properties().where(), "a light-field display must not be sheared");
    unit_ = width / axes_.field_width;
    projected_ = mean_projected_angle();
    const double expected = width * axes_.height / axes_.width;
    if (std::abs(height - expected) > 0.01 * expected)
      properties().note(
          "filename", fmt::format("the window of the light field is {:.4g} times as high as wide, the shape "
                                  "{:.4g} times: what lies outside of the window is dark, or missing",
                                  double(axes_.height) / axes_.width, height / width));
  }

  /// Projected solid angle [sr] of the plane (s, t)'s rectangle from the window, in the mean over the window.
  double mean_projected_angle() const {
    constexpr int kSide = 12;
    const double a = 0.5 * axes_.aperture_width, b = 0.5 * axes_.aperture_height, d = axes_.plane_distance;
    double sum = 0;
    for (int i = 0; i < kSide * kSide; ++i) {
      const double u = axes_.field_width * ((i % kSide + 0.5) / kSide - 0.5),
                   v = axes_.field_height() * ((i / kSide + 0.5) / kSide - 0.5);
      const optics::Point3 corners[] = {
          {-a - u, -b - v, d}, {a - u, -b - v, d}, {a - u, b - v, d}, {-a - u, b - v, d}};
      sum += optics::polygon_solid_angle(corners, {0, 0, 1}).projected;
    }
    return sum / (kSide * kSide);
  }

  /// Radiance of the point into the unit direction `w`: bilinear in (u, v), and bilinear in (s, t) or of the nearest view.
  Spectrum radiance(const Vec3& p, const Vec3& w, const Wavelengths& wavelengths) const {
    const double forward = double(dot(w, normal_));
    if (!(forward > 1e-6)) return 0.f;
    // Positions of a picture in units of the light field: x to the right and y down, as an eye before the display sees them.
    const Vec3 from = p - center_;
    const double u = double(dot(from, right_)) / unit_, v = -double(dot(from, up_)) / unit_;
    const double s = u + double(dot(w, right_)) / forward * axes_.plane_distance,
                 t = v - double(dot(w, up_)) / forward * axes_.plane_distance;
    constexpr double kRounding = 1 + 1e-5;  // of points on the border of the window
    if (!(std::abs(s) < 0.5 * axes_.aperture_width && std::abs(t) < 0.5 * axes_.aperture_height &&
          std::abs(u) <= 0.5 * kRounding * axes_.field_width &&
          std::abs(v) <= 0.5 * kRounding * axes_.field_height()))
      return 0.f;
    const double a = (s / axes_.aperture_width + 0.5) * axes_.views_x,
                 b = (t / axes_.aperture_height + 0.5) * axes_.views_y;
    if (nearest_) return view(std::floor(a), std::floor(b), s, t, u, v, wavelengths) * scale_;
    const double x = std::clamp(a - 0.5, 0.0, axes_.views_x - 1.0),
                 y = std::clamp(b - 0.5, 0.0, axes_.views_y - 1.0);
    const double i = std::floor(x), j = std::floor(y);
    Spectrum sum = 0.f;
    for (int k = 0; k < 4; ++k) {
      const double weight = (k & 1 ? x - i : 1 - (x - i)) * (k & 2 ? y - j : 1 - (y - j));
      if (weight > 0) sum += view(i + (k & 1), j + (k >> 1), s, t, u, v, wavelengths) * float(weight);
    }
    return sum * scale_;
  }
  /// The view (i, j) at the point of the plane in focus that the ray from (s, t) through (u, v) hits.
  Spectrum view(double i, double j, double s, double t, double u, double v,
                const Wavelengths& wavelengths) const {
    i = std::clamp(i, 0.0, axes_.views_x - 1.0), j = std::clamp(j, 0.0, axes_.views_y - 1.0);
    const auto middle = axes_.position(int(i), int(j));
    const double shift = has_focus_ ? 1 - axes_.plane_distance / focus_ : 0;
    u += (middle[0] - s) * shift, v += (middle[1] - t) * shift;
    const double x = (u / axes_.field_width + 0.5) * axes_.width,
                 y = (v / axes_.field_height() + 0.5) * axes_.height;
    SurfacePoint point;
    // Half a pixel within the view's border, so that bilinear interpolation does not reach the next view.
    point.uv = {float((i * axes_.width + std::clamp(x, 0.5, axes_.width - 0.5)) /
                      (double(axes_.views_x) * axes_.width)),
                float((j * axes_.height + std::clamp(y, 0.5, axes_.height - 0.5)) /
                      (double(axes_.views_y) * axes_.height))};
    return mosaic_->eval(point, wavelengths);
  }

  LightFieldAxes axes_;
  TexturePtr mosaic_;
  float scale_ = 1;
  bool nearest_ = false, has_focus_ = false;
  double focus_ = 1;
  Vec3 center_, right_, up_, normal_;
  double unit_ = 1;          ///< length of a unit of the light field in the scene
  double projected_ = M_PI;  ///< `mean_projected_angle`
};

AUREOLE_PLUGIN(
    LightFieldDisplay, "emitter", "lightfielddisplay",
    PluginDoc{
        .summary =
            "A light-field display: its flat parent shape, usually a rectangle, is the window (u, v) of a light field "
            "(`aureole lightfield`), and emits from each point into each direction the radiance that the light field has along "
            "that ray. A camera in the place of its plane (s, t), in front of the shape, takes the pictures that were taken "
            "there; beyond its cells there is no light. The window is scaled to the width of the shape, and the plane (s, t) "
            "with it. The right of the pictures is the direction of u on the shape, as an eye before it sees it. Colours become "
            "emission as those of `area`; light fields in cd/m^2 are shown in cd/m^2.",
        .source =
            "Levoy & Hanrahan 1996, \"Light field rendering\", section 4; Wetzstein, Lanman, Hirsch & Raskar 2012, \"Tensor "
            "displays\"",
        .parameters =
            {{"filename", "file", "", "required", "EXR with the axes of a light field in its header"},
             {"scale", "float", "", "1", "factor of the radiance"},
             {"views", "string", "", "bilinear",
              "bilinear: interpolation between the four nearest views; nearest: the views of the cells, as behind lenslets"},
             {"focus_distance", "float", "units of the light field", "plane_distance",
              "distance from the plane (s, t) at which the views are interpolated without ghosts"}},
        .examples = {R"(<emitter type="lightfielddisplay"><string name="filename" value="field.exr"/>
    <float name="scale" value="2"/> <string name="views" value="bilinear"/> <float name="focus_distance" value="3"/></emitter>)"},
        .needs_shape = true});

}  // namespace
}  // namespace aureole

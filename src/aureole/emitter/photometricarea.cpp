// SPDX-License-Identifier: Apache-2.0
// A luminaire by the intensities of an IES or EULUMDAT file, as the radiance of its parent shape.
#include <cmath>

#include "aureole/emitter/directions/emitter_placement.h"
#include "aureole/emitter/light.h"
#include "aureole/emitter/luminaire/luminaire_parameters.h"
#include "aureole/emitter/surface/cosine_rays.h"
#include "aureole/plugin/registry.h"
#include "aureole/shape/area_sampler.h"

namespace aureole {
namespace {

/// The projected area of a convex surface along a direction: the sum of the cosines of its elements that face
/// it.
class ProjectedArea {
public:
  ProjectedArea() = default;
  explicit ProjectedArea(const AreaSampler& sampler) {
    constexpr int kSide = 32;  // points along each side of the unit square that represent a curved patch
    for (std::size_t patch = 0; patch < sampler.patch_count(); ++patch) {
      const float area = sampler.patch_area(patch);
      if (!(area > 0)) continue;
      const auto [normal, cosine] = sampler.patch_normals(patch);
      if (cosine > 1 - 1e-6f) {
        add(normal, area);
        continue;
      }
      for (int i = 0; i < kSide * kSide; ++i) {
        const Vec2 u{(float(i % kSide) + 0.5f) / kSide, (float(i / kSide) + 0.5f) / kSide};
        if (const auto s = sampler.sample_area(patch, u); s && s->pdf > 0)
          add(s->ng, 1 / (s->pdf * kSide * kSide));
      }
    }
  }

  float operator()(const Vec3& d) const {
    float sum = 0;
    for (const Element& e : elements_) sum += e.area * std::max(0.f, dot(e.normal, d));
    return sum;
  }
  std::size_t size() const { return elements_.size(); }

private:
  struct Element {
    Vec3 normal;
    float area;
  };
  /// Adds an element; elements of equal normals are kept as one.
  void add(const Vec3& normal, float area) {
    for (Element& e : elements_)
      if (dot(e.normal, normal) > 1 - 1e-6f) {
        e.area += area;
        return;
      }
    elements_.push_back({normal, area});
  }

  std::vector<Element> elements_;
};

class PhotometricAreaEmitter final : public Emitter {
public:
  explicit PhotometricAreaEmitter(const Properties& p)
      : Emitter(p),
        axes_(get_placement(p).axes),
        light_(std::make_shared<const LuminaireLight>(get_luminaire(p))) {}

  std::shared_ptr<const Emitter> fitted_to(const Light& light) const override {
    auto fitted = std::make_shared<PhotometricAreaEmitter>(*this);
    fitted->projected_ = std::make_shared<const ProjectedArea>(*light.area);
    constexpr std::size_t kMostNormals = 100000;
    if (fitted->projected_->size() == 0 || fitted->projected_->size() > kMostNormals)
      throw Error(properties().where(),
                  "the shape is no luminous area: it has no area, or more than 100000 normals");
    fitted->check_directions();
    return fitted;
  }

  std::size_t part_count(const Light& light) const override { return light.area->patch_count(); }
  std::size_t part_of(const Light& light, const SurfacePoint& point) const override {
    return light.area->patch_of_primitive(point.primitive);
  }

  Spectrum eval(const SurfacePoint& point, const Vec3& w, const Wavelengths& wavelengths) const override {
    return dot(point.ng, w) > 0 ? light_->per_candela->eval({}, wavelengths) * luminance(w) : Spectrum(0.f);
  }

  std::optional<DirectSample> sample_direct(const Light& light, const Vec3& reference, std::size_t part,
                                            Vec2 u, const Wavelengths& wavelengths) const override {
    const PositionSample s = light.area->sample_direct_position(reference, part, u);
    if (!(s.pdf > 0)) return {};
    DirectSample d;
    d.wo = normalize(s.p - reference);
    if (!(dot(s.ng, d.wo) < 0)) return {};
    d.p = s.p, d.p_error = s.p_error, d.ng = s.ng, d.pdf = s.pdf;
    d.radiance = light_->per_candela->eval({}, wavelengths) * luminance(-d.wo);
    return d;
  }

  std::optional<EmittedRay> sample_ray(const Light& light, std::size_t part, Vec2 position, Vec2 direction,
                                       const Wavelengths& wavelengths) const override {
    // Directions are sampled by the cosine about the normal, as in `area`. The file's distribution covers the
    // whole sphere: on a curved shape most of its directions would point into the shape.
    return sample_cosine_ray(light, part, position, direction, [&](const auto&, const Vec3& d) {
      return light_->per_candela->eval({}, wavelengths) * luminance(d);
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

  SampledSpectrum power_spectrum(const Light&) const override {
    SampledSpectrum s = light_->per_candela->average();
    s.scale(float(light_->flux));
    return s;
  }

  EmissionBounds emission_bounds(const Light& light, std::size_t part) const override {
    const auto [axis, cosine] = light.area->patch_normals(part);
    return {light.area->patch_bounds(part),
            axis,
            cosine,
            0,
            patch_fraction(light, part),
            float(M_PI * light_->luminaire.distribution.maximum() / light_->flux)};
  }

private:
  /// Intensity over the projected area in the direction [cd per square of the scene's unit].
  float luminance(const Vec3& d) const {
    const float area = (*projected_)(d);
    return area > 0 ? float(light_->candela(axes_.to_local(d))) / area : 0;
  }

  /// Notes light of the file that the shape cannot emit, because no part of the shape faces its direction.
  void check_directions() const {
    const optics::IntensityDistribution& d = light_->luminaire.distribution;
    constexpr int kSteps = 90;
    double lost = 0, all = 0;
    for (int j = 0; j < kSteps; ++j)
      for (int i = 0; i < kSteps; ++i) {
        const double polar = 180 * (j + 0.5) / kSteps, azimuth = 360 * (i + 0.5) / kSteps;
        const double part = d.at(azimuth, polar) * std::sin(polar * M_PI / 180);
        const auto local = d.direction(azimuth, polar);
        all += part;
        if (!((*projected_)(axes_.to_world({float(local[0]), float(local[1]), float(local[2])})) > 0))
          lost += part;
      }
    if (lost > 1e-3 * all)
      properties().note("to_world",
                        "the shape does not face " + std::to_string(int(std::lround(1000 * lost / all))) +
                            " thousandths of the light of the file, which are lost: turn \"to_world\" or "
                            "the shape, or use \"photometric\"");
  }

  Frame axes_;
  std::shared_ptr<const LuminaireLight> light_;
  std::shared_ptr<const ProjectedArea> projected_;
};

AUREOLE_PLUGIN(
    PhotometricAreaEmitter, "emitter", "photometricarea",
    PluginDoc{
        .summary =
            "A luminaire by its luminous intensities, as `photometric`, from the surface of its parent shape, which is seen. "
            "The radiance in a direction is the intensity over the area of the shape that is seen from there, alike all "
            "over it; so the far field is that of the file, and the luminance is that by which UGR is reckoned. The shape "
            "should be convex: a rectangle, a disk, a box, a sphere.",
        .source = "ANSI/IES LM-63-19; A. W. Stockmar, EULUMDAT, Licht '90; CIE 117-1995 for the luminance",
        .parameters = luminaire_parameter_rows(
            {{"to_world", "transform", "", "identity",
              "orientation as that of `photometric`: +z to the direction of both angles zero, x along the luminaire. "
              "Position and scale have no effect"}}),
        .examples = {R"(<emitter type="photometricarea">
    <string name="filename" value="batten.ldt"/> <float name="color_temperature" value="4000"/>
    <float name="flux" value="5000"/> <float name="scale" value="0.9"/> <float name="tilt_angle" value="0"/>
    <float name="lamp_flux" value="6000"/> <integer name="lamp_set" value="1"/> <string name="c0" value="across"/>
    <transform name="to_world"><rotate x="1" angle="180"/></transform>
</emitter>)",
                     R"(<emitter type="photometricarea"><string name="filename" value="downlight.ies"/>
    <spectrum name="spectrum" value="400:1, 700:2"/></emitter>)"},
        .needs_shape = true});

}  // namespace
}  // namespace aureole

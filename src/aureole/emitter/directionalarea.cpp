// SPDX-License-Identifier: Apache-2.0
// A shape that shines along its normals only. No point of a scene has a chance to be connected to the one
// point of the shape whose normal leads to it: such light is found by light tracing.
#include "aureole/emitter/emitter.h"
#include "aureole/emitter/emitter_docs.h"
#include "aureole/plugin/registry.h"
#include "aureole/shape/shape.h"
#include "aureole/texture/texture.h"

namespace aureole {
namespace {

class DirectionalAreaEmitter final : public Emitter {
public:
  explicit DirectionalAreaEmitter(const Properties& p)
      : Emitter(p), radiance_(get_texture(p, "radiance", 1, SpectrumRole::emission)) {
    p.note("radiance",
           "only light tracing (integrator \"ptracer\") finds the light of a \"directionalarea\"");
  }

  void attach(const Shape& shape) override {
    if (shape_)
      throw Error(properties().where(),
                  "this directionalarea emitter is used by two shapes; give each shape its own");
    shape_ = &shape;
    for (size_t i = 0; i < shape.patch_count(); ++i) area_ += shape.patch_area(i);
  }

  bool is_delta() const override { return true; }
  std::size_t part_count() const override { return shape_->patch_count(); }
  std::size_t part_of(const SurfacePoint& point) const override {
    return shape_->patch_of_primitive(point.primitive);
  }

  std::optional<DirectSample> sample_direct(const Vec3&, std::size_t, Vec2,
                                            const Wavelengths&) const override {
    return {};
  }

  std::optional<EmittedRay> sample_ray(std::size_t part, Vec2 position, Vec2,
                                       const Wavelengths& wavelengths) const override {
    const auto s = shape_->sample_area(part, position);
    if (!s) return {};
    SurfacePoint point;
    point.p = s->p, point.ng = s->ng, point.uv = s->uv, point.shape = shape_;
    point.primitive = s->primitive, point.barycentric = s->barycentric;
    EmittedRay r;
    r.p = s->p, r.p_error = s->p_error, r.ng = r.d = s->ng;
    r.value = radiance_->eval(point, wavelengths);
    r.pdf_position = s->pdf;
    r.pdf_direction = 1, r.delta_direction = true;
    return r;
  }

  SampledSpectrum power_spectrum() const override {
    SampledSpectrum s = radiance_->average();
    s.scale(float(area_));
    return s;
  }

  EmissionBounds emission_bounds(std::size_t part) const override {
    const auto [axis, cosine] = shape_->patch_normals(part);
    // The cone of emission is empty, and `focus` 0 keeps the choice of lights for a point away.
    return {shape_->patch_bounds(part),
            axis,
            cosine,
            1,
            area_ > 0 ? float(shape_->patch_area(part) / area_) : 0,
            0};
  }

private:
  TexturePtr radiance_;
  const Shape* shape_ = nullptr;
  double area_ = 0;
};

AUREOLE_PLUGIN(
    DirectionalAreaEmitter, "emitter", "directionalarea",
    PluginDoc{"Makes the shape it is a child of shine along its normals only: a rectangle sends a parallel "
              "beam. Light "
              "tracing (`ptracer`) finds this light; `path` and `direct` cannot.",
              "",
              emitter_parameters(
                  {{"radiance", "spectrum", "W/(m^2 nm), any common scale", "1",
                    "spectral exitance, the power that leaves per area (the name is Mitsuba's); may be a "
                    "texture"}}),
              {R"(<emitter type="directionalarea"><rgb name="radiance" value="4, 5, 6"/></emitter>)"}});

}  // namespace
}  // namespace aureole

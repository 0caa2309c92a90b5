// SPDX-License-Identifier: Apache-2.0
// A shape that shines from its front, the side of its geometric normal.
#include "aureole/emitter/emitter.h"
#include "aureole/emitter/emitter_docs.h"
#include "aureole/math/warp.h"
#include "aureole/plugin/registry.h"
#include "aureole/shape/shape.h"
#include "aureole/texture/texture.h"

namespace aureole {
namespace {

class AreaEmitter final : public Emitter {
public:
  explicit AreaEmitter(const Properties& p)
      : Emitter(p),
        radiance_(get_texture(p, "radiance", 1, SpectrumRole::emission)),
        is_constant_(radiance_->is_constant()) {}

  void attach(const Shape& shape) override {
    if (shape_)
      throw Error(properties().where(), "this area emitter is used by two shapes; give each shape its own");
    shape_ = &shape;
    for (size_t i = 0; i < shape.patch_count(); ++i) area_ += shape.patch_area(i);
  }

  std::size_t part_count() const override { return shape_->patch_count(); }
  std::size_t part_of(const SurfacePoint& point) const override {
    return shape_->patch_of_primitive(point.primitive);
  }

  Spectrum eval(const SurfacePoint& point, const Vec3& w, const Wavelengths& wavelengths) const override {
    return dot(point.ng, w) > 0 ? radiance_->eval(point, wavelengths) : Spectrum(0.f);
  }

  std::optional<DirectSample> sample_direct(const Vec3& reference, std::size_t part, Vec2 u,
                                            const Wavelengths& wavelengths) const override {
    return sample_direct_facing(reference, {}, part, u, wavelengths);
  }

  std::optional<DirectSample> sample_direct_facing(const Vec3& reference, const Vec3& facing,
                                                   std::size_t part, Vec2 u,
                                                   const Wavelengths& wavelengths) const override {
    std::optional<DirectSample> result;
    if (!is_constant_) {
      const auto s = shape_->sample_direct(reference, part, u);
      if (!s || !set_position({s->p, s->p_error, s->ng, s->pdf}, reference, facing, result)) return result;
      result->radiance = radiance_at(*s, wavelengths);
      return result;
    }
    static const SurfacePoint kAnywhere;
    if (set_position(shape_->sample_direct_position(reference, part, u), reference, facing, result))
      result->radiance = radiance_->eval(kAnywhere, wavelengths);
    return result;
  }

  std::optional<EmittedRay> sample_ray(std::size_t part, Vec2 position, Vec2 direction,
                                       const Wavelengths& wavelengths) const override {
    const auto s = shape_->sample_area(part, position);
    if (!s) return {};
    const Vec3 local = square_to_cosine_hemisphere(direction);
    return EmittedRay{s->p,
                      s->p_error,
                      s->ng,
                      normalize(Frame::from_normal(s->ng).to_world(local)),
                      radiance_at(*s, wavelengths) * local.z,
                      s->pdf,
                      cosine_hemisphere_pdf(local.z)};
  }

  float pdf_direct(const Vec3& reference, const SurfacePoint& point) const override {
    return shape_->pdf_direct(reference, part_of(point), point);
  }

  SampledSpectrum power_spectrum() const override {
    SampledSpectrum s = radiance_->average();
    s.scale(float(kPi * area_));
    return s;
  }

  EmissionBounds emission_bounds(std::size_t part) const override {
    const auto [axis, cosine] = shape_->patch_normals(part);
    return {shape_->patch_bounds(part), axis, cosine, 0,
            area_ > 0 ? float(shape_->patch_area(part) / area_) : 0};
  }

private:
  /// Everything but the radiance; false where the surface turns away or the light comes from behind `facing`.
  static bool set_position(const PositionSample& s, const Vec3& reference, const Vec3& facing,
                           std::optional<DirectSample>& result) {
    const Vec3 wo = normalize(s.p - reference);
    if (!(s.pdf > 0) || !(dot(s.ng, wo) < 0) || dot(facing, wo) < 0) return false;
    DirectSample& d = result.emplace();
    d.wo = wo, d.p = s.p, d.p_error = s.p_error, d.ng = s.ng, d.pdf = s.pdf;
    return true;
  }
  Spectrum radiance_at(const ShapeSample& s, const Wavelengths& wavelengths) const {
    SurfacePoint point;
    point.p = s.p, point.ng = s.ng, point.uv = s.uv, point.shape = shape_;
    point.primitive = s.primitive, point.barycentric = s.barycentric;
    return radiance_->eval(point, wavelengths);
  }

  TexturePtr radiance_;
  bool is_constant_;
  const Shape* shape_ = nullptr;
  double area_ = 0;
};

AUREOLE_PLUGIN(
    AreaEmitter, "emitter", "area",
    PluginDoc{
        "Makes the shape it is a child of shine with the same radiance into all directions of its front "
        "side.",
        "",
        emitter_parameters({{"radiance", "spectrum", "W/(m^2 sr nm), any common scale", "1",
                             "emitted spectral radiance; may be a texture"}}),
        {R"(<emitter type="area"><spectrum name="radiance" value="400:0, 500:8, 700:18"/></emitter>)"}});

}  // namespace
}  // namespace aureole

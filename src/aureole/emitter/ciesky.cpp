// SPDX-License-Identifier: Apache-2.0
// Skies of the CIE without a sun: the overcast sky and the uniform sky.
#include <cmath>

#include "aureole/emitter/amount/emission_amount.h"
#include "aureole/emitter/light.h"
#include "aureole/math/warp.h"
#include "aureole/plugin/registry.h"
#include "aureole/texture/texture.h"

namespace aureole {
namespace {

class CieSky final : public Emitter {
public:
  explicit CieSky(const Properties& p) : Emitter(p) {
    is_overcast_ = p.get_choice("sky", "overcast", {"overcast", "uniform"}) == "overcast";
    const Vec3 up = p.get_transform("to_world").vector({0, 0, 1});
    const float l = length(up);
    if (!(l > 0) || !std::isfinite(l)) throw p.error("to_world", "the sky's zenith has no direction");
    up_ = up * (1 / l);
    const Emission emission(p, "radiance");
    if (!emission.texture()->is_constant()) throw p.error("radiance", "expected a spectrum, not a texture");
    // Scales by the horizontal irradiance over the zenith's radiance: 7 pi/9 for the overcast sky and pi for
    // the uniform one.
    radiance_ = emission.scaled({.irradiance = 1 / (M_PI * (is_overcast_ ? 7.0 / 9 : 1)), .radiance = 1});
  }

  bool is_infinite() const override { return true; }

  Spectrum eval_escaped(const Vec3& d, const Wavelengths& w) const override {
    return radiance_->eval({}, w) * relative(d);
  }

  std::optional<DirectSample> sample_direct(const Light&, const Vec3&, std::size_t, Vec2 u,
                                            const Wavelengths& w) const override {
    return sample_hemisphere_of(Frame::from_normal(up_), square_to_uniform_hemisphere(u),
                                uniform_hemisphere_pdf(), w);
  }
  /// Samples by the cosine the part of the sky above the receiver's horizon. Its projection onto the
  /// receiver's plane is bounded by half of a circle and half of an ellipse, an affine image of the disc in
  /// every line along the horizon's normal.
  std::optional<DirectSample> sample_direct_facing(const Light& light, const Vec3& reference,
                                                   const Vec3& facing, std::size_t part, Vec2 u,
                                                   const Wavelengths& w) const override {
    if (facing == Vec3{}) return sample_direct(light, reference, part, u, w);
    const float cosine = dot(facing, up_), share = seen_share(facing);
    if (!(share > kLeastShare)) return {};
    const DiscPoint disc = square_to_disc_concentric(u);
    const float half_chord = std::sqrt(std::max(0.f, (1 - disc.p.y) * (1 + disc.p.y)));
    const float x = disc.p.x * share + half_chord * 0.5f * (1 - cosine);
    const float z = std::sqrt(std::max(0.f, half_chord * half_chord - x * x));
    if (!(z > 0)) return {};
    return sample_hemisphere_of(Frame::from_normal_tangent(facing, up_), {x, disc.p.y, z}, z / (kPi * share),
                                w);
  }
  float pdf_direct_escaped(const Vec3&, const Vec3& facing, const Vec3& d) const override {
    if (!(dot(d, up_) > 0)) return 0;
    if (facing == Vec3{}) return uniform_hemisphere_pdf();
    const float share = seen_share(facing);
    return share > kLeastShare ? std::max(0.f, dot(d, facing)) / (kPi * share) : 0;
  }

  std::optional<EmittedRay> sample_ray(const Light& light, std::size_t, Vec2 position, Vec2 direction,
                                       const Wavelengths& w) const override {
    const Vec3 from = normalize(Frame::from_normal(up_).to_world(square_to_uniform_hemisphere(direction)));
    EmittedRay r = ray_from_infinity(light, -from, position);
    r.value = eval_escaped(from, w);
    r.pdf_direction = uniform_hemisphere_pdf();
    return r;
  }
  RayDensity pdf_ray(const Light& light, std::size_t, const SurfacePoint*, const Vec3& d) const override {
    return density_from_infinity(light, dot(-d, up_) > 0 ? uniform_hemisphere_pdf() : 0);
  }

  SampledSpectrum power_spectrum(const Light& light) const override {
    SampledSpectrum s = radiance_->average();
    // Power, by the integral of the relative radiance over the upper hemisphere: 4 pi/3 and 2 pi.
    s.scale(kPi * light.scene_radius * light.scene_radius * kPi * (is_overcast_ ? 4.f / 3 : 2.f));
    return s;
  }
  EmissionBounds emission_bounds(const Light&, std::size_t) const override { return {}; }

private:
  /// Radiance in a direction over the zenith's: (1 + 2 sin(elevation))/3, or 1.
  float relative(const Vec3& d) const {
    const float sine = dot(d, up_);
    if (!(sine > 0)) return 0;
    return is_overcast_ ? (1 + 2 * sine) * (1 / 3.f) : 1;
  }
  /// Fraction of a receiver's hemisphere, weighted by the cosine, that the sky fills.
  float seen_share(const Vec3& facing) const { return 0.5f * (1 + dot(facing, up_)); }
  std::optional<DirectSample> sample_hemisphere_of(const Frame& frame, const Vec3& local, float pdf,
                                                   const Wavelengths& w) const {
    DirectSample s;
    s.wo = normalize(frame.to_world(local));
    s.radiance = eval_escaped(s.wo, w);
    s.pdf = pdf;
    s.infinite = true;
    return s;
  }

  static constexpr float kLeastShare = 1e-6f;
  bool is_overcast_;
  Vec3 up_;
  TexturePtr radiance_;  ///< radiance of the zenith
};

AUREOLE_PLUGIN(
    CieSky, "emitter", "ciesky",
    PluginDoc{
        "A sky for daylight factors, from infinity over the upper hemisphere and black below: the overcast sky of the "
        "CIE, whose radiance grows from the horizon to three times as much at the zenith, L = L_z (1 + 2 sin(elevation))/3, "
        "or a uniform one. A building is lit from below by the light that its ground reflects.",
        "P. Moon and D. E. Spencer, Illumination from a non-uniform sky, 1942; ISO 15469:2004 / CIE S 011, type 16",
        with_amount_parameters({{"radiance", "spectrum", "W/(m^2 sr nm), any common scale", "1",
                                 "spectral radiance of the zenith"},
                                {"sky", "string", "", "overcast", "overcast or uniform"},
                                {"to_world", "transform", "", "identity", "turns +z to the zenith"}},
                               "lx, W/m^2, cd/m^2, W/(m^2 sr)",
                               "irradiance of the open ground by the whole sky, or radiance of the zenith"),
        {R"(<emitter type="ciesky"><string name="sky" value="overcast"/><string name="amount" value="10 klx"/>
    <transform name="to_world"><rotate x="1" angle="-90"/></transform></emitter>)",
         R"(<emitter type="ciesky"><rgb name="radiance" value="0.8, 0.9, 1"/></emitter>)",
         R"(<emitter type="ciesky"><string name="amount" value="100 W/m^2"/><float name="color_temperature" value="6500"/></emitter>)"}});

}  // namespace
}  // namespace aureole

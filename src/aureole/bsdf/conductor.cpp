// SPDX-License-Identifier: Apache-2.0
// A smooth metal: a delta lobe of specular reflection with the Fresnel reflectance of a complex index.
#include "aureole/bsdf/fresnel/conductor_index.h"
#include "aureole/bsdf/mirror_reflection.h"
#include "aureole/plugin/registry.h"
#include "aureole/texture/texture.h"

namespace aureole {
namespace {

class Conductor final : public Bsdf, public MirrorReflection {
public:
  explicit Conductor(const Properties& properties)
      : Bsdf(properties),
        index_(ConductorIndex::from(properties)),
        reflectance_(get_optional_texture(properties, "specular_reflectance", SpectrumRole::reflectance)) {}

  BsdfEval eval_pdf(const Vec3&, const Vec3&, const BsdfContext&) const override { return {}; }

  std::optional<BsdfSample> sample(const Vec3& wi, float, Vec2, const BsdfContext& ctx) const override {
    if (!(wi.z > 0)) return {};
    BsdfSample s{reflect(wi), index_.reflectance(wi.z, ctx), 1.f, lobes()};
    if (reflectance_) s.value *= reflectance_->eval(ctx.point, ctx.wavelengths);
    return s;
  }

  Amplitudes reflection_amplitudes(float cos_i, const BsdfContext& ctx) const override {
    Amplitudes reflected = index_.amplitudes(cos_i, ctx);
    if (reflectance_) reflected.scale(reflectance_->eval(ctx.point, ctx.wavelengths));
    return reflected;
  }

  bool needs_tangent() const override { return false; }
  bool needs_choice() const override { return false; }
  Lobe lobes() const override { return Lobe::delta | Lobe::reflect; }

private:
  ConductorIndex index_;
  TexturePtr reflectance_;
};

AUREOLE_PLUGIN(
    Conductor, "bsdf", "conductor",
    PluginDoc{"A smooth metal (or any strongly absorbing medium) in vacuum: Fresnel reflection by a complex "
              "refractive index. Without material, eta and k it is a perfect mirror. It reflects on the side "
              "of its normal and is black on the other; `twosided` makes both sides alike.",
              "M. Born, E. Wolf, Principles of Optics, 7th ed. 1999, section 14.2",
              conductor_parameters(),
              {R"(<bsdf type="conductor">
    <string name="material" value="Au"/>
</bsdf>)",
               R"(<bsdf type="conductor">
    <spectrum name="eta" value="400:1.5, 550:0.4, 700:0.15"/>
    <spectrum name="k" value="400:1.9, 550:2.6, 700:4.0"/>
    <float name="specular_reflectance" value="0.8"/>
</bsdf>)"}});

}  // namespace
}  // namespace aureole

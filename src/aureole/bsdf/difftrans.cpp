// SPDX-License-Identifier: Apache-2.0
// An ideally diffuse transmitter, f = transmittance/pi towards the other side of the surface.
#include "aureole/bsdf/bsdf.h"
#include "aureole/math/warp.h"
#include "aureole/plugin/registry.h"
#include "aureole/texture/texture.h"

namespace aureole {
namespace {

class DiffuseTransmitter final : public Bsdf {
public:
  explicit DiffuseTransmitter(const Properties& properties)
      : Bsdf(properties),
        transmittance_(get_texture(properties, "transmittance", 0.5, SpectrumRole::reflectance)) {}

  BsdfEval eval_pdf(const Vec3& wi, const Vec3& wo, const BsdfContext& ctx) const override {
    if (!(wi.z * wo.z < 0)) return {};
    const float pdf = cosine_hemisphere_pdf(std::abs(wo.z));
    return {transmittance_->eval(ctx.point, ctx.wavelengths) * pdf, pdf};
  }

  std::optional<BsdfSample> sample(const Vec3& wi, float, Vec2 u2, const BsdfContext& ctx) const override {
    std::optional<BsdfSample> result;
    if (wi.z == 0) return result;
    BsdfSample& s = result.emplace();
    s.wo = square_to_cosine_hemisphere(u2);
    const float pdf = cosine_hemisphere_pdf(s.wo.z);
    if (wi.z > 0) s.wo = -s.wo;
    s.value = transmittance_->eval(ctx.point, ctx.wavelengths) * pdf;
    s.pdf = pdf;
    s.lobe = lobes();
    return result;
  }

  bool needs_tangent() const override { return false; }
  bool needs_choice() const override { return false; }
  bool is_constant() const override { return transmittance_->is_constant(); }
  Lobe lobes() const override { return Lobe::diffuse | Lobe::transmit; }

private:
  TexturePtr transmittance_;
};

AUREOLE_PLUGIN(
    DiffuseTransmitter, "bsdf", "difftrans",
    PluginDoc{
        "An ideally diffuse transmitter, the same from both sides: light leaves on the other side with "
        "equal radiance in all directions. It reflects nothing; `blendbsdf` with `diffuse` makes paper or "
        "a leaf. (The name is that of Mitsuba 0.6.)",
        "J. H. Lambert, Photometria, 1760",
        {{"transmittance", "texture", "", "0.5", "fraction of the light that is transmitted"}},
        {R"(<bsdf type="difftrans">
    <rgb name="transmittance" value="0.4, 0.5, 0.2"/>
</bsdf>)"}});

}  // namespace
}  // namespace aureole

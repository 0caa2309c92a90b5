// SPDX-License-Identifier: Apache-2.0
// Marks shapes whose edges diffract light. The surface itself scatters as the nested BSDF; edges are separate
// path vertices (transport/edges.h).
#include "aureole/bsdf/edge_diffraction.h"
#include "aureole/bsdf/mirror_reflection.h"
#include "aureole/bsdf/nested/nested_bsdfs.h"
#include "aureole/plugin/registry.h"

namespace aureole {
namespace {

class FreeSpaceDiffraction final : public Bsdf, public EdgeDiffraction, public ReflectsAsNested {
public:
  explicit FreeSpaceDiffraction(const Properties& properties)
      : Bsdf(properties), nested_(nested_bsdfs(properties, 1).front()) {
    enabled_ = properties.get_bool("enabled", true);
    const double sigma = properties.get_float("sigma", 25.0, Range::positive());
    if (properties.has("sigma")) sigma_ = sigma;
    scale_ = float(properties.get_float("scale", 1.0, Range::non_negative()));
    properties.get_bool("SIR", true);
    if (properties.has("SIR"))
      properties.note("SIR", "\"SIR\" has no effect: directions are drawn from their density");
  }

  BsdfEval eval_pdf(const Vec3& wi, const Vec3& wo, const BsdfContext& ctx) const override {
    return nested_->eval_pdf(wi, wo, ctx);
  }
  Spectrum eval(const Vec3& wi, const Vec3& wo, const BsdfContext& ctx) const override {
    return nested_->eval(wi, wo, ctx);
  }
  std::optional<BsdfSample> sample(const Vec3& wi, float u1, Vec2 u2, const BsdfContext& ctx) const override {
    return nested_->sample(wi, u1, u2, ctx);
  }
  Spectrum null_transmittance(const Vec3& wi, const BsdfContext& ctx) const override {
    return nested_->null_transmittance(wi, ctx);
  }
  Spectrum diffuse_reflectance(const Vec3& wi, const BsdfContext& ctx) const override {
    return nested_->diffuse_reflectance(wi, ctx);
  }
  Vec3 shading_normal(const SurfacePoint& point) const override { return nested_->shading_normal(point); }
  bool interior_index(const Wavelengths& w, Spectrum& n) const override {
    return nested_->interior_index(w, n);
  }
  double single_scattering_loss(bool from_within) const override {
    return nested_->single_scattering_loss(from_within);
  }
  Lobe lobes() const override { return nested_->lobes(); }
  bool needs_choice() const override { return nested_->needs_choice(); }
  bool is_constant() const override { return nested_->is_constant(); }
  bool needs_tangent() const override { return nested_->needs_tangent(); }
  const Bsdf* reflecting() const override { return nested_.get(); }

private:
  BsdfPtr nested_;
};

AUREOLE_PLUGIN(
    FreeSpaceDiffraction, "bsdf", "freespacediffraction",
    PluginDoc{
        "Marks a shape whose edges diffract light; the surface scatters as the nested BSDF. In a scene with "
        "such BSDFs no other shapes diffract. The integrator's `diffraction` must be on.",
        "Steinberg, Ramamoorthi, Bitterli, Mollazainali, d'Eon & Pharr 2024, \"A Free-Space Diffraction BSDF\" "
        "(name and parameters of the authors' scenes)",
        {{"bsdf", "bsdf", "", "required", "BSDF of the surface"},
         {"enabled", "boolean", "", "true", "false: the edges of the shape do not diffract"},
         {"sigma", "float", "wavelengths", "beam_width of the integrator",
          "of the diffraction model `beams`: standard deviation of the width of the beams in which neighbouring edges are coherent. It is one "
          "number for a scene: all shapes that give it must agree, also with the integrator's `beam_width`"},
         {"scale", "float", "", "1",
          "of the diffraction model `beams`: factor of the diffracted radiance; any but 1 violates energy conservation"},
         {"SIR", "boolean", "", "true", "accepted for the authors' scenes, without effect"}},
        {R"(<bsdf type="freespacediffraction">
    <boolean name="enabled" value="true"/>
    <float name="sigma" value="25"/>
    <float name="scale" value="1"/>
    <boolean name="SIR" value="true"/>
    <bsdf type="diffuse"/>
</bsdf>)"}});

}  // namespace
}  // namespace aureole

// SPDX-License-Identifier: Apache-2.0
// A stack of plane layers as one surface: coats of paint and varnish, leaves, prints, skin, slabs between
// slides. The radiative transfer equation is solved when the scene is loaded, by discrete ordinates
// (optics/stack), and tabulated (stack/stack_table.h).
//
// Lobes. Light that smooth interfaces reflect and refract without scattering in a layer is in delta lobes.
// Everything else is one lobe, sampled in proportion to its value. The reflected and the transmitted
// fraction equal the solution's for each direction and wavelength, whichever wavelength is the hero. The BSDF
// is reciprocal, f/n_o^2.
#include <cmath>
#include <optional>

#include "aureole/bsdf/bsdf.h"
#include "aureole/bsdf/stack/layered_stack.h"
#include "aureole/plugin/registry.h"
#include "aureole/plugin/table_holder.h"

namespace aureole {
namespace {

class Layered final : public Bsdf, public TableHolder {
public:
  explicit Layered(const Properties& p) : Bsdf(p) {
    const LayeredStack stack(p);
    is_open_ = stack.is_open(), has_delta_ = stack.has_delta(), substrate_ = stack.lambertian();
    table_ = p.shared_model<StackTable>([&] { return stack.tabulate(); });
  }

  BsdfEval eval_pdf(const Vec3& wi, const Vec3& wo, const BsdfContext& ctx) const override {
    if (wi.z == 0 || wo.z == 0) return {};
    const Wavelengths& w = ctx.wavelengths;
    const Below below(*this, ctx);
    const auto [k, total] = table_->eval<true>(wi, wo, w, below.get());
    const float n_i = table_->index(wi.z < 0), n_o = table_->index(wo.z < 0), cosine = std::abs(wo.z);
    const float n = ctx.mode == TransportMode::radiance ? n_i : n_o;
    return {k * (n * n * cosine), safe_divide(k * (n_o * n_o * cosine), total)};
  }

  Spectrum eval(const Vec3& wi, const Vec3& wo, const BsdfContext& ctx) const override {
    if (wi.z == 0 || wo.z == 0) return 0.f;
    const float n = table_->index(ctx.mode == TransportMode::radiance ? wi.z < 0 : wo.z < 0);
    return table_->eval<false>(wi, wo, ctx.wavelengths, Below(*this, ctx).get()).k * (n * n * std::abs(wo.z));
  }

  std::optional<BsdfSample> sample(const Vec3& wi, float u1, Vec2 u2, const BsdfContext& ctx) const override {
    if (wi.z == 0 || (wi.z < 0 && !is_open_)) return {};
    const Wavelengths& w = ctx.wavelengths;
    const Below below(*this, ctx);
    const StackTable::Shares s = table_->shares(wi, w, below.get());
    const Spectrum total = s.total();
    if (!(total[0] > 0)) return {};
    const Spectrum mirrored = safe_divide(s.mirrored, total), passed = safe_divide(s.passed, total);
    // The delta lobes take both ends of the range of u1, so that samples find them even if they are very
    // improbable.
    if (u1 < mirrored[0]) return BsdfSample{reflect(wi), s.mirrored, mirrored, Lobe::delta | Lobe::reflect};
    if (u1 >= 1 - passed[0]) return pass(wi, s.passed, passed, ctx);
    const float choice = std::min((u1 - mirrored[0]) / (1 - mirrored[0] - passed[0]), 0x1.fffffep-1f);
    const Vec3 wo = table_->sample(wi, choice, u2, w, below.get());
    if (!(std::abs(wo.z) > 0)) return {};
    const BsdfEval e = eval_pdf(wi, wo, ctx);
    if (!(e.pdf[0] > 0)) return {};
    const bool is_reflected = (wi.z > 0) == (wo.z > 0);
    return BsdfSample{wo, e.value, e.pdf, Lobe::glossy | (is_reflected ? Lobe::reflect : Lobe::transmit),
                      table_->index(wo.z < 0) / table_->index(wi.z < 0)};
  }

  Spectrum diffuse_reflectance(const Vec3& wi, const BsdfContext& ctx) const override {
    if (wi.z < 0 && !is_open_) return 0.f;
    return min(table_->shares(wi, ctx.wavelengths, Below(*this, ctx).get()).scattered, 1.f);
  }

  bool needs_tangent() const override { return false; }
  Tables tables() const override { return {table_.get(), table_ ? table_->bytes() : 0}; }
  Lobe lobes() const override {
    Lobe l = Lobe::glossy | Lobe::reflect;
    if (has_delta_) l = l | Lobe::delta;
    if (!is_open_) return l;
    const bool goes_on = has_delta_ && table_ && table_->index(false) == table_->index(true);
    return l | Lobe::transmit | (goes_on ? Lobe::through : Lobe::none);
  }

private:
  /// Reflectance of the Lambertian substrate at one point.
  class Below {
  public:
    Below(const Layered& layered, const BsdfContext& ctx) : is_there_(layered.substrate_ != nullptr) {
      if (is_there_) reflectance_ = min(layered.substrate_->diffuse_reflectance({0, 0, 1}, ctx), 1.f);
    }
    const Spectrum* get() const { return is_there_ ? &reflectance_ : nullptr; }

  private:
    bool is_there_;
    Spectrum reflectance_{0.f};
  };

  std::optional<BsdfSample> pass(const Vec3& wi, const Spectrum& share, const Spectrum& mass,
                                 const BsdfContext& ctx) const {
    const float eta = table_->index(wi.z > 0) / table_->index(wi.z < 0);
    if (eta == 1) return BsdfSample{-wi, share, mass, Lobe::delta | Lobe::transmit | Lobe::through};
    const float sine2 = (1 - wi.z * wi.z) / (eta * eta);
    if (!(sine2 < 1)) return {};
    const float cosine = std::sqrt(1 - sine2);
    BsdfSample s{{-wi.x / eta, -wi.y / eta, wi.z > 0 ? -cosine : cosine},
                 share,
                 mass,
                 Lobe::delta | Lobe::transmit,
                 eta};
    if (ctx.mode == TransportMode::radiance) s.value *= 1 / (eta * eta);
    return s;
  }

  bool is_open_ = false, has_delta_ = false;
  BsdfPtr substrate_;  ///< substrate that is Lambertian and not part of the table; otherwise null
  std::shared_ptr<const StackTable> table_;  ///< table of the stack; null in a scene with errors
};

AUREOLE_PLUGIN(
    Layered, "bsdf", "layered",
    PluginDoc{
        "A stack of plane layers, each a medium of its own thickness and index, with smooth or rough "
        "interfaces, on another BSDF or open below: coats of paint and varnish, leaves, prints, slabs "
        "between slides. Light transport within the stack is solved with all directions when the scene is "
        "loaded (seconds on all cores). Light leaves where it entered, so layers must be thin compared with "
        "visible detail. On a nested BSDF the stack reflects on the side of its normal and is black on the "
        "other. A diffuse nested BSDF may be textured; any other is evaluated at the origin of its "
        "textures. Media, thicknesses and indices are uniform; to vary a coat, `blendbsdf` mixes two stacks "
        "by a texture. Smooth interfaces are delta lobes. Lobes narrower than some 4 degrees (roughness "
        "below 0.1, phase functions with g above 0.95) are blurred by the table, whose energy stays exact. "
        "Tables take 1 to 100 MB (`aureole info` prints their size).",
        "S. Chandrasekhar, Radiative Transfer, 1960; H. C. van de Hulst, Multiple Light Scattering, 1980; T. Nakajima & M. "
        "Tanaka, J. Quant. Spectrosc. Radiat. Transfer 40, 1988 (single scattering)",
        {{"medium", "medium", "", "required",
          "medium of each layer, from the top: uniform media that do not emit"},
         {"thickness", "string", "", "required", "thickness of each layer, \"20um, 5um\", or \"infinite\""},
         {"int_ior", "float or string", "", "1.5",
          "index of refraction of each layer, \"1.5, water\", as numbers or materials' names; one value "
          "applies to all"},
         {"ext_ior", "float or string", "", "air", "index of refraction above the stack, at 589 nm"},
         {"below_ior", "float or string", "", "ext_ior",
          "index of refraction below the stack, if it is open, at 589 nm"},
         {"dispersion", "boolean", "", "true",
          "layers named by their material have its index at each wavelength, where that is above the "
          "indices outside"},
         {"alpha", "float or string", "", "0",
          "roughness of each interface from the top, \"0.2, 0\": 0, smooth, or in [0.05, 1]; the default "
          "for the rest is smooth"},
         {"distribution", "string", "", "beckmann",
          "distribution of the microfacet normals: beckmann or ggx"},
         {"bsdf", "bsdf", "", "none",
          "opaque BSDF below the stack, isotropic about its normal; without it the stack is open below"},
         {"wavelengths", "integer", "", "24", "nodes of the table over the sensor's wavelength range"},
         {"directions", "integer", "", "24 to 64",
          "nodes over the cosine on the side of lower index, more if a lobe is narrow and memory allows; "
          "the stack is solved with four times as many streams or more"},
         {"azimuths", "integer", "", "16 to 40", "cells over 180 degrees, more if a lobe is narrow"}},
        {R"(<bsdf type="layered">
    <medium type="homogeneous"> <float name="sigma_t" value="2e5"/> <rgb name="albedo" value="0.95, 0.8, 0.4"/> </medium>
    <medium type="homogeneous"> <float name="sigma_a" value="1e4"/> <float name="sigma_s" value="1e5"/>
        <phase type="hg"> <float name="g" value="0.5"/> </phase> </medium>
    <string name="thickness" value="10um, 30um"/>
    <string name="int_ior" value="1.5, 1.4"/> <float name="ext_ior" value="1"/>
    <string name="alpha" value="0.3, 0"/> <string name="distribution" value="ggx"/>
    <integer name="wavelengths" value="4"/> <integer name="directions" value="16"/> <integer name="azimuths" value="16"/>
    <bsdf type="diffuse"> <float name="reflectance" value="0.8"/> </bsdf>
</bsdf>)",
         R"(<bsdf type="layered">
    <medium type="homogeneous"> <float name="sigma_t" value="1e5"/> <float name="albedo" value="1"/>
        <phase type="hg"> <float name="g" value="0.6"/> </phase> </medium>
    <string name="thickness" value="20um"/>
    <float name="int_ior" value="1.4"/> <float name="below_ior" value="1.33"/>
    <integer name="directions" value="12"/>
</bsdf>)"}});

}  // namespace
}  // namespace aureole

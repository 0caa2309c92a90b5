// SPDX-License-Identifier: Apache-2.0
// A smooth metal: one delta lobe of reflection, coloured by the complex index.
#include "aureole/bsdf/bsdf.h"
#include "aureole/bsdf/fresnel.h"
#include "aureole/plugin/registry.h"
#include "aureole/spectrum/refractive_index.h"
#include "aureole/texture/texture.h"

namespace aureole {
namespace {

/// The complex index of a conductor, read from `material` or from `eta` and `k`.
class ConductorIndex {
public:
  /// Reads `material` (default none: a perfect mirror), or `eta` and `k` (defaults 0 and 1). Errors are
  /// located.
  static ConductorIndex from(const Properties& properties);

  /// Fresnel reflectance for light from vacuum, cos_i in (0, 1].
  Spectrum reflectance(float cos_i, const BsdfContext& ctx) const;

private:
  bool tabulated_ = false;
  SampledSpectrum eta_, k_;             // of a named or constant material
  TexturePtr eta_texture_, k_texture_;  // where one of them varies over the surface
};

std::vector<std::string> conductor_names() {
  std::vector<std::string> names{"none"};
  for (const std::string& name : refractive_index_names())
    if (find_refractive_index(name, false)->is_dispersive()) names.push_back(name);
  return names;
}

ConductorIndex ConductorIndex::from(const Properties& properties) {
  ConductorIndex c;
  const SpectralGrid& grid = properties.context().grid;
  const std::string material = properties.get_string("material", "none");
  const TexturePtr eta = get_optional_texture(properties, "eta", SpectrumRole::unbounded);
  const TexturePtr k = get_optional_texture(properties, "k", SpectrumRole::unbounded);
  if (material != "none") {
    if (eta || k) throw properties.error(eta ? "eta" : "k", "give either a material or eta and k, not both");
    const auto index = find_refractive_index(material, false);
    // Dielectrics are constants without dispersion: they belong to other BSDFs.
    if (!index || !index->is_dispersive())
      throw properties.error("material", "\"" + material + "\" is not a known conductor" +
                                             did_you_mean(material, conductor_names()));
    c.tabulated_ = true;
    c.eta_ = SampledSpectrum::from_function(grid, [&](double nm) { return index->at(nm).real(); });
    c.k_ = SampledSpectrum::from_function(grid, [&](double nm) { return index->at(nm).imag(); });
    return c;
  }
  if (!eta && !k) return c;
  if ((!eta || eta->is_constant()) && (!k || k->is_constant())) {
    c.tabulated_ = true;
    c.eta_ = eta ? eta->average() : SampledSpectrum::constant(grid, 0);
    c.k_ = k ? k->average() : SampledSpectrum::constant(grid, 1);
    return c;
  }
  c.eta_texture_ = get_texture(properties, "eta", 0, SpectrumRole::unbounded);
  c.k_texture_ = get_texture(properties, "k", 1, SpectrumRole::unbounded);
  return c;
}

Spectrum ConductorIndex::reflectance(float cos_i, const BsdfContext& ctx) const {
  if (tabulated_) return fresnel_conductor(cos_i, eta_.eval(ctx.wavelengths), k_.eval(ctx.wavelengths));
  if (!eta_texture_) return 1.f;
  return fresnel_conductor(cos_i, eta_texture_->eval(ctx.point, ctx.wavelengths),
                           k_texture_->eval(ctx.point, ctx.wavelengths));
}

class Conductor final : public Bsdf {
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
              "refractive "
              "index. Without material, eta and k it is a perfect mirror. It reflects on the side of its "
              "normal and is "
              "black on the other; `twosided` makes both sides alike.",
              "M. Born, E. Wolf, Principles of Optics, 7th ed. 1999, section 14.2",
              {{"material", "string", "", "none",
                "name of a conductor with tabulated index, such as Au or Cu_palik; none is a perfect mirror"},
               {"eta", "texture", "", "0", "real part of the index, instead of a material"},
               {"k", "texture", "", "1",
                "imaginary part of the index (extinction coefficient), instead of a material"},
               {"specular_reflectance", "texture", "", "1",
                "factor of the reflected light; leave at 1 for a real metal"}},
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

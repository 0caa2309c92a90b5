// SPDX-License-Identifier: Apache-2.0
// A rough interface between two transparent media: specular microfacets (Walter et al. 2007, equations 20 and
// 21) with Smith's G = G1(wi) G1(wo), single scattering. The facet that refracts wi into wo depends on the
// index, so with dispersion every wavelength has its own normal. With `energy_preserving` two more lobes, one
// on each side, add multiple scattering (Kulla & Conty 2017); see `Multiple`.
#include <optional>

#include "aureole/bsdf/bsdf.h"
#include "aureole/bsdf/microfacet/microfacet.h"
#include "aureole/bsdf/microfacet/microfacet_energy.h"
#include "aureole/math/warp.h"
#include "aureole/optics/interface/fresnel_equations.h"
#include "aureole/plugin/registry.h"
#include "aureole/spectrum/fresnel.h"
#include "aureole/texture/texture.h"

namespace aureole {
namespace {

// Overloads for one index of all wavelengths (float) and one index per wavelength (Spectrum).
bool positive(float x) { return x > 0; }
SpectrumMask positive(const Spectrum& x) { return x.v > Spectrum(0.f).v; }
float select(bool m, float a, float b) { return m ? a : b; }
float reflectance(float cos_i, float eta) { return fresnel_dielectric(cos_i, eta).reflectance; }
Spectrum reflectance(const Spectrum& cos_i, const Spectrum& eta) { return fresnel_dielectric(cos_i, eta); }
/// Returns 1 - F from both cosines of a refracted ray, by Fresnel's t_s and t_p (Born & Wolf 1999, 1.5.2
/// equation 20). It is equal from both sides, and exact near the critical angle.
template <class T>
T transmittance(const T& cos_i, const T& cos_t, const T& eta) {
  const T s = cos_i + eta * cos_t, p = eta * cos_i + cos_t;
  return eta * cos_i * cos_t * 2.f * (T(1.f) / (s * s) + T(1.f) / (p * p));
}
float density(const Microfacets& d, float x, float y, float z) { return d.density(Vec3{x, y, z}); }
Spectrum density(const Microfacets& d, const Spectrum& x, const Spectrum& y, const Spectrum& z) {
  return d.density(x, y, z);
}
float root(float x) { return std::sqrt(x); }
Spectrum root(const Spectrum& x) { return sqrt(x); }
float larger(float a, float b) { return std::max(a, b); }
Spectrum larger(const Spectrum& a, const Spectrum& b) { return max(a, b); }
float first(float x) { return x; }
float first(const Spectrum& x) { return x[0]; }

class RoughDielectric final : public Bsdf {
public:
  explicit RoughDielectric(const Properties& properties)
      : Bsdf(properties),
        interior_(Ior::from(properties, "int_ior", "bk7")),
        exterior_(Ior::from(properties, "ext_ior", "air")),
        dispersive_(interior_.is_dispersive() || exterior_.is_dispersive()),
        eta_(interior_.at_sodium_d() / exterior_.at_sodium_d()),
        reflectance_(get_optional_texture(properties, "specular_reflectance", SpectrumRole::reflectance)),
        transmittance_(get_optional_texture(properties, "specular_transmittance", SpectrumRole::reflectance)),
        roughness_(properties, true) {
    const std::vector<float> etas = index_nodes(properties.context().grid);
    if (etas.size() == 1 && etas[0] == 1)
      throw properties.error("int_ior", "the index is the same on both sides, which is no interface");
    if (read_energy_preserving(properties)) {
      std::vector<double> key = roughness_.table_key();
      key.insert(key.end(), etas.begin(), etas.end());
      multiple_ = properties.shared_model<Multiple>(
          key, [&] { return std::make_shared<const Multiple>(roughness_, etas); });
    }
  }

  BsdfEval eval_pdf(const Vec3& wi, const Vec3& wo, const BsdfContext& ctx) const override {
    if (!(std::abs(wi.z) > 0 && std::abs(wo.z) > 0)) return {};
    if (disperses(ctx)) return at(State<Spectrum>(*this, wi, ctx), wo, ctx);
    return at(State<float>(*this, wi, ctx), wo, ctx);
  }

  std::optional<BsdfSample> sample(const Vec3& wi, float u1, Vec2 u2, const BsdfContext& ctx) const override {
    if (!(std::abs(wi.z) > 0)) return {};
    if (disperses(ctx)) return sample_from(State<Spectrum>(*this, wi, ctx), u1, u2, ctx);
    return sample_from(State<float>(*this, wi, ctx), u1, u2, ctx);
  }

  bool interior_index(const Wavelengths& w, Spectrum& n) const override {
    n = interior_.eval(w);
    return true;
  }
  bool exterior_index(const Wavelengths& w, Spectrum& n) const override {
    n = exterior_.eval(w);
    return true;
  }
  double single_scattering_loss(bool from_within) const override {
    if (multiple_ || states_energy_preserving(properties())) return 0;
    const float u = roughness_.range_u().y, v = roughness_.is_isotropic() ? u : roughness_.range_v().y;
    return loss_(Microfacets(roughness_.type(), u, v), eta_, from_within);
  }
  bool needs_tangent() const override { return !roughness_.is_isotropic(); }
  Lobe lobes() const override { return Lobe::glossy | Lobe::reflect | Lobe::transmit; }

private:
  /// Multiple scattering. Of the loss of side a the fraction x_a crosses to side b, the rest stays; both
  /// leave in proportion to the loss of their side,
  ///     f_r = (1 - x_a) loss_a(i) loss_a(o) / (pi avg_a),    f_t = x_a loss_a(i) loss_b(o) / (pi avg_b),
  /// so that energy is conserved. Reciprocity, f_t(a to b)/n_b^2 = f_t(b to a)/n_a^2, requires x_a avg_a
  /// n_a^2 = x_b avg_b n_b^2. Since (1 - F_a) n_a^2 = (1 - F_b) n_b^2 for the diffuse reflectances F of a
  /// smooth interface, x_a = (1 - F_a) min(avg_a, avg_b)/avg_a satisfies it and lies in [0, 1].
  struct Multiple {
    LossTable above, below;
    std::vector<float> entering;  ///< transmittance 1 - F from above, at the nodes of the index
    const LossTable& side(bool is_below) const { return is_below ? below : above; }

    static constexpr TableKind kTable{"energy loss of a rough interface", 1};
    template <class Self, class Fields>
    static void fields(Self& self, Fields& all) {
      all(self.above, self.below, self.entering);
    }

    Multiple() = default;
    Multiple(const Roughness& roughness, const std::vector<float>& etas) {
      const auto kept = [](const ScatteredEnergy& e) { return e.reflected + e.transmitted; };
      above = LossTable(roughness, etas, [&](const Microfacets& d, const Vec3& wi, float eta, int points) {
        return kept(scattered_energy(d, wi, eta, points));
      });
      below = LossTable(roughness, etas, [&](const Microfacets& d, const Vec3& wi, float eta, int points) {
        // The critical angle makes the integrand less smooth, so that more points are needed.
        return kept(scattered_energy(d, wi, 1 / eta, 3 * points));
      });
      for (const float eta : etas) entering.push_back(float(1 - optics::fresnel_diffuse_reflectance(eta)));
    }
  };

  /// Quantities that depend only on wi and the point. The frame is flipped so that wi is above.
  template <class T>
  struct State {
    Microfacets facets, sampler;
    Vec3 wi;
    bool below;
    /// index beyond over the index on the side of wi; and index of the interior over the exterior
    T eta, eta_above;
    float masking_over_cos;
    LossTable::Place place;
    T loss{0.f}, average{0.f}, average_beyond{0.f}, crossing{0.f};

    State(const RoughDielectric& b, const Vec3& given, const BsdfContext& ctx)
        : facets(b.roughness_.at(ctx)),
          sampler(facets),
          wi(given.x, given.y, std::abs(given.z)),
          below(given.z < 0),
          eta_above(b.index(ctx, T{})),
          masking_over_cos(facets.masking_over_cos(wi)) {
      eta = below ? T(1.f) / eta_above : eta_above;
      // Sampling all normals gives large weights to normals that are barely visible. A rougher distribution
      // has more of them (Walter et al. 2007, section 5.3).
      if (!b.roughness_.visible()) sampler = facets.scaled(1.2f - 0.2f * std::sqrt(wi.z));
      if (!b.multiple_) return;
      const Multiple& m = *b.multiple_;
      const LossTable &here = m.side(below), &beyond = m.side(!below);
      place = here.locate(facets);
      // The lower bound removes values that single precision cannot distinguish from zero.
      average = larger(here.average(place, eta_above), T(1e-6f));
      average_beyond = larger(beyond.average(place, eta_above), T(1e-6f));
      loss = here.loss(place, wi, eta_above);
      crossing = here.over_indices(eta_above, [&](int e) { return m.entering[std::size_t(e)]; });
      if (below) crossing = crossing / (eta_above * eta_above);
      crossing = crossing * average_beyond / larger(average, average_beyond);
    }
  };

  template <class T>
  std::optional<BsdfSample> sample_from(const State<T>& s, float u1, Vec2 u2, const BsdfContext& ctx) const {
    const float eta = first(s.eta), loss = first(s.loss);
    Vec3 wo;
    if (u1 < loss) {
      const bool crosses = u1 < loss * first(s.crossing);
      wo = multiple_->side(s.below != crosses).sample(s.place, first(s.eta_above), u2);
      if (crosses) wo.z = -wo.z;
    } else {
      const Vec3 m = roughness_.visible() ? s.sampler.sample_visible(s.wi, u2) : s.sampler.sample_all(u2);
      const float cos_im = dot(s.wi, m);
      if (!(cos_im > 0)) return {};
      const DielectricFresnel f = fresnel_dielectric(cos_im, eta);
      const bool reflects = u1 - loss < (1 - loss) * f.reflectance;
      wo = normalize(reflects ? 2 * cos_im * m - s.wi : m * (cos_im / eta - f.cos_t) - s.wi * (1 / eta));
      if (!(reflects ? wo.z > 0 : wo.z < 0)) return {};
    }
    const bool through = wo.z < 0;
    if (s.below) wo.z = -wo.z;
    const BsdfEval e = at(s, wo, ctx);
    if (!(e.pdf[0] > 0)) return {};
    return BsdfSample{wo, e.value, e.pdf, Lobe::glossy | (through ? Lobe::transmit : Lobe::reflect),
                      through ? eta : 1.f};
  }

  template <class T>
  BsdfEval at(const State<T>& s, const Vec3& given_wo, const BsdfContext& ctx) const {
    const Vec3 wo{given_wo.x, given_wo.y, s.below ? -given_wo.z : given_wo.z};
    const bool through = wo.z < 0;
    T value, pdf;
    if (through)
      refracted(s, wo, value, pdf);
    else
      reflected(s, wo, value, pdf);
    if (multiple_) {
      const LossTable& side = multiple_->side(s.below != through);
      const Vec3 up{wo.x, wo.y, std::abs(wo.z)};
      const T part = s.loss * (through ? s.crossing : T(1.f) - s.crossing) * cosine_hemisphere_pdf(up.z);
      pdf = pdf * (T(1.f) - s.loss) + part * side.density_over_cosine(s.place, up.z, s.eta_above);
      value = value + part * side.loss(s.place, up, s.eta_above) / (through ? s.average_beyond : s.average);
    }
    // Radiance is compressed into a smaller solid angle in the denser medium: refraction preserves L/n^2.
    if (through && ctx.mode == TransportMode::radiance) value = value / (s.eta * s.eta);
    BsdfEval e{value, pdf};
    if (const TexturePtr& tint = through ? transmittance_ : reflectance_)
      e.value *= tint->eval(ctx.point, ctx.wavelengths);
    return e;
  }

  template <class T>
  void reflected(const State<T>& s, const Vec3& wo, T& value, T& pdf) const {
    const Vec3 sum = s.wi + wo;
    const float size = length(sum), cos_im = std::min(0.5f * size, 1.f);
    value = pdf = T(0.f);
    if (!(size > 0)) return;
    const Vec3 m = sum / size;
    const float seen = 0.25f * s.facets.density(m) * s.masking_over_cos;
    const T f = reflectance(T(cos_im), s.eta);
    value = f * (seen * s.facets.masking(wo));
    pdf = f * (roughness_.visible() ? seen : 0.25f * s.sampler.density(m) * m.z / cos_im);
  }

  template <class T>
  void refracted(const State<T>& s, const Vec3& wo, T& value, T& pdf) const {
    // The normal lies along wi + eta wo, which points to the side of lower index.
    const T x = s.eta * wo.x + s.wi.x, y = s.eta * wo.y + s.wi.y, z = s.eta * wo.z + s.wi.z;
    const T size2 = x * x + y * y + z * z;
    T scale = T(1.f) / root(larger(size2, T(1e-30f)));
    scale = select(positive(z), scale, scale * -1.f);
    const T mx = x * scale, my = y * scale, mz = z * scale;
    const T cos_im = mx * s.wi.x + my * s.wi.y + mz * s.wi.z, cos_om = mx * wo.x + my * wo.y + mz * wo.z;
    // The facet must face wi with its front and wo with its back; Jacobian dm/dwo (equation 17).
    const auto exists = positive(larger(cos_im, T(0.f)) * larger(cos_om * -1.f, T(0.f)));
    const T cos_i = select(exists, cos_im, T(1.f)), cos_t = select(exists, cos_om * -1.f, T(1.f));
    const T jacobian = s.eta * s.eta * cos_t / larger(size2, T(1e-30f));
    const T transmitted = transmittance(cos_i, cos_t, s.eta) * jacobian;
    const T seen = transmitted * density(s.facets, mx, my, mz) * cos_i * s.masking_over_cos;
    const Vec3 down{wo.x, wo.y, -wo.z};
    value = select(exists, seen * s.facets.masking(down), T(0.f));
    pdf = roughness_.visible() ? seen : transmitted * density(s.sampler, mx, my, mz) * mz;
    pdf = select(exists, pdf, T(0.f));
  }

  float index(const BsdfContext&, float) const { return eta_; }
  Spectrum index(const BsdfContext& ctx, const Spectrum&) const {
    return interior_.eval(ctx.wavelengths) / ctx.eval_exterior(exterior_);
  }

  /// Returns nodes for tables over the index, interior over exterior.
  std::vector<float> index_nodes(const SpectralGrid& grid) const {
    if (!dispersive_) return {eta_};
    float low = kInfinity, high = 0;
    for (int i = 0; i <= grid.cells; ++i) {
      const Wavelengths w = Wavelengths::at(grid, float(grid.node(i)));
      const float eta = interior_.eval(w)[0] / exterior_.eval(w)[0];
      low = std::min(low, eta), high = std::max(high, eta);
    }
    if (high - low < 1e-5f) return {low};
    return {low, 0.5f * (low + high), high};
  }

  bool disperses(const BsdfContext& ctx) const { return dispersive_ || ctx.exterior_index; }

  Ior interior_, exterior_;
  bool dispersive_;
  float eta_;  // relative index of an interface without dispersion
  TexturePtr reflectance_, transmittance_;
  Roughness roughness_;
  /// tables of multiple scattering; null: light is scattered once
  std::shared_ptr<const Multiple> multiple_;
  DiffuseLoss loss_;
};

AUREOLE_PLUGIN(
    RoughDielectric, "bsdf", "roughdielectric",
    PluginDoc{
        "A rough interface between two transparent media, such as ground glass: microfacets that reflect "
        "and refract as `dielectric` does. The interior is on the side opposite to the normal. A material "
        "given by name is dispersive as in `dielectric`. Single scattering makes very rough glass dark. "
        "With `energy_preserving` no light is lost: multiple scattering is added on both sides, "
        "reciprocally, divided by the diffuse reflectance of a smooth interface. A note says what is lost "
        "where the interface bounds a medium that scatters, whose light hits it many times.",
        "B. Walter, S. Marschner, H. Li, K. Torrance, Microfacet models for refraction through rough "
        "surfaces, EGSR 2007; E. Heitz, Understanding the masking-shadowing function in microfacet-based "
        "BRDFs, JCGT 3(2), 2014; C. Kulla, A. Conty, Revisiting physically based shading at Imageworks, "
        "SIGGRAPH courses 2017",
        {{"int_ior", "float or string", "", "1.5046",
          "index of refraction of the interior, as a number or the name of a material"},
         {"ext_ior", "float or string", "", "air",
          "index of refraction of the exterior, as a number or the name of a material"},
         {"dispersion", "boolean", "", "true", "named materials use their dispersion data if available"},
         {"specular_reflectance", "texture", "", "1",
          "factor of the reflected light; leave at 1 for a real interface"},
         {"specular_transmittance", "texture", "", "1",
          "factor of the refracted light; leave at 1 for a real interface"},
         {"distribution", "string", "", "beckmann",
          "distribution of the microfacet normals: beckmann or ggx"},
         {"alpha", "texture", "", "0.1", "roughness; for beckmann sqrt(2) times the RMS slope"},
         {"alpha_u", "texture", "", "alpha",
          "roughness along dp/du; give alpha_u and alpha_v instead of alpha"},
         {"alpha_v", "texture", "", "alpha", "roughness perpendicular to dp/du"},
         {"sample_visible", "boolean", "", "true", "sample visible normals (less noise), not all normals"},
         {"energy_preserving", "boolean", "", "the scene's, else false",
          "add multiple scattering, which Mitsuba omits"}},
        {R"(<bsdf type="roughdielectric">
    <string name="int_ior" value="water"/>
    <string name="ext_ior" value="air"/>
    <string name="distribution" value="ggx"/>
    <float name="alpha_u" value="0.1"/>
    <float name="alpha_v" value="0.3"/>
</bsdf>)",
         R"(<bsdf type="roughdielectric">
    <string name="int_ior" value="bk7"/>
    <boolean name="dispersion" value="true"/>
    <float name="alpha" value="0.3"/>
    <boolean name="sample_visible" value="false"/>
    <boolean name="energy_preserving" value="true"/>
    <rgb name="specular_reflectance" value="0.9, 0.9, 1"/>
    <rgb name="specular_transmittance" value="0.7, 0.9, 0.8"/>
</bsdf>)"}});

}  // namespace
}  // namespace aureole

// SPDX-License-Identifier: Apache-2.0
// A layer of many equal circles, apertures or opaque discs, that do not overlap, on a plane: what makes
// coronas. Model: Yang, Kim, Pediredla & Jarosz, "A wave-optics BSDF for correlated scatterers", 2025,
// equations 14 to 20.
//
// Light that arrives from w_i in an index n_i and leaves along w_o in n_o, both outward, is diffracted by
//     f = (n_o^2/lambda^2) J(q) O c,   q = (2 pi/lambda) (n_o w_o + n_i w_i)_xy,   1/(4 pi^2) int J d2q = Fr
//     (1 - Fr),
// Fr the covered part of the plane, O an obliquity and c the share of reflection or transmission. With O = 1
// the radiance depends on direction cosines alone (Harvey, Vernold, Krywonos & Thompson, "Diffracted
// radiance: a fundamental quantity in nonparaxial scalar diffraction theory", 1999) and f is reciprocal,
// f(i->o)/n_o^2 = f(o->i)/n_i^2; what falls on q that no direction has (evanescent waves) is lost.
//
// Lobes. The part of the light that keeps its direction and the part that meets the substrate go the same
// ways, so they share their delta lobes: D times the substrate's reflection and transmission, with D = Fr^2 +
// (1 - Fr) for apertures (Fr^2 for `none`, whose sheet absorbs) and D = (1 - Fr)^2 for discs (Babinet). The
// diffracted part, S = Fr (1 - Fr), has c = sqrt(R_i R_o) in reflection and 1 - sqrt(R_i R_o) in
// transmission, R the reflectance of the interface (or pane) for either direction seen from its own side, 1
// beyond the critical angle. Discs leave Fr to a nested BSDF.
#include <array>
#include <cmath>
#include <optional>

#include "aureole/bsdf/bsdf.h"
#include "aureole/bsdf/fresnel.h"
#include "aureole/bsdf/scatterer_tables.h"
#include "aureole/math/warp.h"
#include "aureole/optics/scatterer_layer.h"
#include "aureole/optics/structure_factor.h"
#include "aureole/plugin/registry.h"

namespace aureole {
namespace {

class CorrelatedScatterers final : public Bsdf {
public:
  explicit CorrelatedScatterers(const Properties& p) : Bsdf(p) {
    const bool discs = p.get_choice("scatterer", "apertures", {"apertures", "discs"}) == "discs";
    if (!p.has("radius"))
      throw p.error("radius", "the parameter \"radius\" is required, a length such as \"5um\"");
    const double radius = p.get_length_m("radius", 0),
                 correlation = p.get_length_m("correlation_radius", radius);
    if (correlation < radius) throw p.error("correlation_radius", "must not be less than \"radius\"");
    const double ratio = radius / correlation;
    if (ratio < optics::kMinSizeRatio)
      throw p.error("correlation_radius", "must not exceed 64 times \"radius\"");
    const double area_fraction = p.get_float("area_fraction", Range{0, optics::kMaxAreaFraction, true});

    const std::string substrate = p.get_choice("substrate", "none", {"none", "dielectric", "thindielectric"});
    substrate_ = substrate == "none" ? Substrate::none : substrate == "dielectric" ? Substrate::interface : Substrate::pane;
    exterior_ = Ior::from(p, "ext_ior", "air");
    interior_ = substrate_ == Substrate::none ? exterior_ : Ior::from(p, "int_ior", "bk7");
    dispersive_ = exterior_.is_dispersive() || interior_.is_dispersive();
    const std::string obliquity =
        p.get_choice("obliquity", "reciprocal", {"reciprocal", "fraunhofer", "kirchhoff"});
    obliquity_ = obliquity == "reciprocal"   ? Obliquity::reciprocal
                 : obliquity == "fraunhofer" ? Obliquity::fraunhofer
                                             : Obliquity::kirchhoff;

    const double fr = area_fraction * ratio * ratio;
    delta_weight_ =
        float(discs ? (1 - fr) * (1 - fr) : fr * fr + (substrate_ == Substrate::none ? 0 : 1 - fr));
    diffracted_weight_ = float(fr * (1 - fr));
    if (discs) {
      const auto nested = p.get_children<Bsdf>("blocked");
      if (nested.size() > 1)
        throw Error(p.where(), "\"correlated_scatterers\" takes one nested BSDF, not more");
      if (!nested.empty()) blocked_ = nested.front(), blocked_weight_ = float(fr);
    }
    const float all = delta_weight_ + diffracted_weight_ + blocked_weight_;
    delta_probability_ = delta_weight_ / all;
    diffracted_probability_ = diffracted_weight_ / all;
    blocked_probability_ = blocked_weight_ / all;

    phase_nm_ = 2 * M_PI * correlation * 1e9;
    const SpectralGrid& range = p.context().grid;
    if (!(phase_nm_ >= kLeastPhase * range.max_nm && phase_nm_ <= kMostPhase * range.min_nm))
      throw p.error(
          "radius",
          "the circles are too small or too large for the wavelengths: 2 pi times their radius must be " +
              std::string("between a millionth of a wavelength and 10^9 wavelengths"));
    table_ = std::make_shared<optics::RadialTable>(ratio, area_fraction);
    if (p.get_choice("sampling", "product", {"product", "factors"}) == "factors")
      factors_.emplace(ratio, area_fraction);
    if (p.get_bool("renormalize", false)) {
      if (obliquity_ != Obliquity::reciprocal)
        throw p.error("renormalize",
                      "needs the obliquity \"reciprocal\": the others do not conserve energy by themselves");
      const auto indices = [this, grid = p.context().grid](double nm) {
        const Wavelengths w = Wavelengths::at(grid, float(nm));
        return std::pair<double, double>{exterior_.eval(w)[0], interior_.eval(w)[0]};
      };
      balance_.emplace(*table_, phase_nm_, p.context().grid, indices,
                       substrate_ == Substrate::none        ? ScattererBalance::Surface::open
                       : substrate_ == Substrate::interface ? ScattererBalance::Surface::interface
                                                            : ScattererBalance::Surface::pane);
    }
  }

  BsdfEval eval_pdf(const Vec3& wi, const Vec3& wo, const BsdfContext& ctx) const override {
    if (wi.z == 0 || wo.z == 0) return {};
    BsdfEval e = diffracted(wi, wo, ctx);
    if (blocked_) {
      const BsdfEval b = blocked_->eval_pdf(wi, wo, ctx);
      e.value += b.value * blocked_weight_;
      e.pdf += b.pdf * blocked_probability_;
    }
    return e;
  }

  std::optional<BsdfSample> sample(const Vec3& wi, float u1, Vec2 u2, const BsdfContext& ctx) const override {
    if (wi.z == 0) return {};
    if (u1 < delta_probability_) return sample_delta(wi, u1 / delta_probability_, ctx);
    u1 -= delta_probability_;
    if (u1 < diffracted_probability_ || !blocked_)
      return sample_diffracted(wi, std::min(u1 / diffracted_probability_, kOneMinusEpsilon), u2, ctx);
    u1 = std::min((u1 - diffracted_probability_) / blocked_probability_, kOneMinusEpsilon);
    auto s = blocked_->sample(wi, u1, u2, ctx);
    if (!s) return {};
    if (s->is_delta()) {
      s->value *= blocked_weight_;
      s->pdf *= blocked_probability_;
    } else {
      const BsdfEval e = eval_pdf(wi, s->wo, ctx);
      s->value = e.value, s->pdf = e.pdf;
    }
    return s;
  }

  Lobe lobes() const override {
    Lobe l = Lobe::delta | Lobe::glossy | Lobe::transmit;
    if (substrate_ != Substrate::none) l = l | Lobe::reflect;
    if (substrate_ != Substrate::interface) l = l | Lobe::through;
    return blocked_ ? l | blocked_->lobes() : l;
  }

private:
  enum class Substrate { none, interface, pane };
  enum class Obliquity { reciprocal, fraunhofer, kirchhoff };

  Spectrum index(const Ior& ior, const BsdfContext& ctx) const {
    return dispersive_ ? ior.eval(ctx.wavelengths) : Spectrum(ior.at_sodium_d());
  }

  /// The indices that light meets from the side where a direction has the sign of `z`.
  struct Indices {
    Spectrum here, beyond;
    Spectrum
        fresnel_beyond;  ///< behind the first interface: of a pane the glass, where `beyond` is the air again
  };
  Indices indices(float z, const BsdfContext& ctx) const {
    const Spectrum n_ext = index(exterior_, ctx), n_int = index(interior_, ctx);
    if (substrate_ != Substrate::interface) return {n_ext, n_ext, n_int};
    return z > 0 ? Indices{n_ext, n_int, n_int} : Indices{n_int, n_ext, n_ext};
  }

  /// Reflectance for a direction seen from its own side.
  Spectrum reflectance(float cosine, const Indices& n) const {
    Spectrum r;
    if (dispersive_)
      r = fresnel_dielectric(cosine, n.fresnel_beyond / n.here);
    else
      r = fresnel_dielectric(cosine, n.fresnel_beyond[0] / n.here[0]).reflectance;
    return substrate_ == Substrate::pane ? thin_slab(r) : r;
  }

  BsdfEval diffracted(const Vec3& wi, const Vec3& wo, const BsdfContext& ctx) const {
    const bool reflected = (wi.z > 0) == (wo.z > 0);
    if (substrate_ == Substrate::none && reflected) return {};
    const float cos_i = std::abs(wi.z), cos_o = std::abs(wo.z);
    const Indices n = indices(wi.z, ctx);
    const Spectrum n_o = reflected ? n.here : n.beyond;
    const Spectrum phase = Spectrum(float(phase_nm_)) / ctx.wavelengths.nm;  // k a
    const float sin_i = std::sqrt(wi.x * wi.x + wi.y * wi.y);
    const Spectrum u_max = phase * (max(n.here, n.beyond) + n.here * sin_i);
    Spectrum u;
    if (dispersive_) {
      const Spectrum x = n_o * wo.x + n.here * wi.x, y = n_o * wo.y + n.here * wi.y;
      u = phase * sqrt(x * x + y * y);
    } else {
      // Two directions nearly cancel here: what is left of them is exact in double precision.
      const double a = n_o[0], b = n.here[0];
      const double x = a * wo.x + b * wi.x, y = a * wo.y + b * wi.y;
      u = phase * float(std::sqrt(x * x + y * y));
    }

    // Density of wo over solid angle of what `table_` has over q, and the share of this side.
    Spectrum measure = phase * phase * n_o * n_o * (cos_o * 0.5f * kInvPi);
    if (substrate_ != Substrate::none) {
      const Spectrum r_o = reflectance(cos_o, reflected ? n : indices(wo.z, ctx));
      const Spectrum both = sqrt(reflectance(cos_i, n) * r_o);
      measure *= reflected ? both : Spectrum(1.f) - both;
    }
    const Spectrum g = make_spectrum([&](int j) { return table_->eval(u[j]); });

    BsdfEval e;
    e.value = g * measure * diffracted_weight_;
    if (factors_)
      e.pdf = make_spectrum([&](int j) { return factors_->density(u[j], u_max[j]); });
    else
      e.pdf = make_spectrum([&](int j) { return g[j] / float(table_->cdf(u_max[j])); });
    e.pdf *= measure * diffracted_probability_;
    if (ctx.mode == TransportMode::radiance && !reflected && substrate_ == Substrate::interface)
      e.value *= n.here * n.here / (n_o * n_o);
    if (obliquity_ != Obliquity::reciprocal) e.value *= obliquity(wi, wo, n.here, n_o, ctx.mode);
    if (balance_) {
      const float sin_o = std::sqrt(wo.x * wo.x + wo.y * wo.y);
      e.value *= balance_->factor(ctx.wavelengths.nm, n.here, n.beyond, sin_i) *
                 balance_->factor(ctx.wavelengths.nm, n_o, reflected ? n.beyond : n.here, sin_o);
    }
    return e;
  }

  /// O: theta_s is where the arriving light would go if it were only refracted or reflected to the side on
  /// which it leaves.
  Spectrum obliquity(const Vec3& wi, const Vec3& wo, const Spectrum& n_i, const Spectrum& n_o,
                     TransportMode mode) const {
    const bool radiance = mode == TransportMode::radiance;
    const Vec3& arrives = radiance ? wo : wi;
    const Vec3& leaves = radiance ? wi : wo;
    const Spectrum ratio = radiance ? n_o / n_i : n_i / n_o;
    // 1 - (ratio sin)^2, written so that grazing light keeps its digits.
    const Spectrum c2 =
        Spectrum(arrives.z * arrives.z) * ratio * ratio + (Spectrum(1.f) - ratio) * (Spectrum(1.f) + ratio);
    const SpectrumMask exists = c2.v > Spectrum(0.f).v;
    const Spectrum cos_s = sqrt(select(exists, c2, 1.f)),
                   cos_l = std::max(std::abs(leaves.z), kSmallestCosine);
    const Spectrum mean_cosine = (cos_s + cos_l) * 0.5f;
    const Spectrum o = obliquity_ == Obliquity::fraunhofer
                           ? cos_s / cos_l
                           : mean_cosine * mean_cosine / (max(cos_s, kSmallestCosine) * cos_l);
    return select(exists, o, 0.f);
  }

  std::optional<BsdfSample> sample_delta(const Vec3& wi, float u1, const BsdfContext& ctx) const {
    if (substrate_ == Substrate::none)
      return BsdfSample{-wi, delta_weight_, delta_probability_, Lobe::delta | Lobe::transmit | Lobe::through};
    const Indices n = indices(wi.z, ctx);
    const Spectrum r = reflectance(std::abs(wi.z), n);
    if (u1 < r[0])
      return BsdfSample{reflect(wi), r * delta_weight_, r * delta_probability_, Lobe::delta | Lobe::reflect};
    Spectrum t = Spectrum(1.f) - r;
    if (substrate_ == Substrate::pane)
      return BsdfSample{-wi, t * delta_weight_, t * delta_probability_,
                        Lobe::delta | Lobe::transmit | Lobe::through};
    // Another index sends its wavelength elsewhere: it has no part in this direction.
    const Spectrum etas = n.beyond / n.here;
    const float eta = etas[0], cos_t = fresnel_dielectric(std::abs(wi.z), eta).cos_t;
    t = select(etas.v == Spectrum(eta).v, t, 0.f);
    if (!(t[0] > 0) || !(cos_t > 0)) return {};
    const Vec3 wo{-wi.x / eta, -wi.y / eta, wi.z > 0 ? -cos_t : cos_t};
    BsdfSample s{wo, t * delta_weight_, t * delta_probability_, Lobe::delta | Lobe::transmit, eta};
    if (ctx.mode == TransportMode::radiance) s.value *= 1 / (eta * eta);
    return s;
  }

  /// q in proportion to J, then reflection or transmission in proportion to their shares: with O = 1 all
  /// samples have the same weight, but for those whose q is evanescent, which are lost.
  std::optional<BsdfSample> sample_diffracted(const Vec3& wi, float u1, Vec2 u2,
                                              const BsdfContext& ctx) const {
    const Indices all = indices(wi.z, ctx);
    const double n_i = all.here[0], n_t = all.beyond[0];
    const float phase = float(phase_nm_) / ctx.wavelengths.nm[0];
    const double sin_i = std::sqrt(wi.x * wi.x + wi.y * wi.y);
    const double u_max = phase * (std::max(n_i, n_t) + n_i * sin_i);
    const double u = factors_ ? factors_->sample(u2.x, u_max) : table_->sample(u2.x, u_max);
    const Vec2 azimuth = cos_sin_2pi(u2.y);
    // n_o w_o across the normal, on whichever side.
    const double x = u / phase * azimuth.x - n_i * wi.x, y = u / phase * azimuth.y - n_i * wi.y;
    const double r2 = x * x + y * y;

    bool reflected = false;
    if (substrate_ != Substrate::none) {
      const double c2 = 1 - r2 / (n_i * n_i);
      const Spectrum r_i = reflectance(std::abs(wi.z), all);
      const float r_o = c2 > 0 ? reflectance(float(std::sqrt(c2)), all)[0] : 1;
      reflected = u1 < std::sqrt(r_i[0] * r_o);
    }
    const double n_o = reflected ? n_i : n_t;
    const double c2 = 1 - r2 / (n_o * n_o);
    if (!(c2 > 0)) return {};
    const float z = float(std::sqrt(c2));
    const Vec3 wo{float(x / n_o), float(y / n_o), (wi.z > 0) == reflected ? z : -z};
    const BsdfEval e = eval_pdf(wi, wo, ctx);
    if (!(e.pdf[0] > 0)) return {};
    return BsdfSample{wo, e.value, e.pdf, Lobe::glossy | (reflected ? Lobe::reflect : Lobe::transmit),
                      float(n_o / n_i)};
  }

  static constexpr float kSmallestCosine = 1e-5f;
  static constexpr double kLeastPhase = 1e-6, kMostPhase = 1e9;  // of k a, for single precision

  Substrate substrate_;
  Obliquity obliquity_;
  Ior exterior_, interior_;
  bool dispersive_;
  double phase_nm_;  // 2 pi correlation_radius in nm: k a times the wavelength
  float delta_weight_, diffracted_weight_, blocked_weight_ = 0;
  float delta_probability_, diffracted_probability_, blocked_probability_;
  std::shared_ptr<const optics::RadialTable> table_;
  std::optional<ScattererFactors> factors_;
  std::optional<ScattererBalance> balance_;
  BsdfPtr blocked_;
};

AUREOLE_PLUGIN(
    CorrelatedScatterers, "bsdf", "correlated_scatterers",
    PluginDoc{"A layer of equal circles that do not overlap, diffracting light into coloured rings "
              "around every lamp (a corona): openings in a sheet or in the mist on a pane, or "
              "opaque discs. Their places are those of hard discs, Percus-Yevick; the empty centre "
              "of the corona comes from that order. Part of the light keeps its direction, part is "
              "diffracted, and the rest meets the substrate between apertures (absorbed for "
              "\"none\") or is blocked by discs. With Fr the covered part, apertures: Fr^2, Fr - "
              "Fr^2, 1 - Fr; discs: (1 - Fr)^2, Fr - Fr^2, Fr. Diffracted waves without a real "
              "direction (evanescent) are lost, about 2/(pi k a (1 - Fr)) of the diffracted part at"
              " normal incidence and more at grazing; renormalize gives that power back.",
              "R. Yang, J. Kim, A. Pediredla, W. Jarosz, A wave-optics BSDF for correlated "
              "scatterers, 2025, equations 14 to 20; J. E. Harvey et al., Diffracted radiance: a "
              "fundamental quantity in nonparaxial scalar diffraction theory, Appl. Opt. 38, 1999",
              {{"scatterer", "string", "", "apertures",
                "apertures (the light goes through the circles) or discs (around them)"},
               {"radius", "length", "", "required", "radius of the circles, such as 5um"},
               {"correlation_radius", "length", "", "radius",
                "half the smallest distance of two centres; between radius and 64 times that"},
               {"area_fraction", "float", "", "required",
                "part of the plane that discs of correlation_radius would cover, in (0, 0.7]"},
               {"substrate", "string", "", "none",
                "none: a sheet in one medium, nothing is reflected; dielectric: the interface of two "
                "media; thindielectric: a pane in one surface"},
               {"int_ior", "float or string", "", "1.5046",
                "index below the interface or of the pane; not for none"},
               {"ext_ior", "float or string", "", "air", "index above, and on both sides of a sheet or pane"},
               {"dispersion", "boolean", "", "true",
                "named materials use their dispersion data where there are any"},
               {"obliquity", "string", "", "reciprocal",
                "factor of the diffracted radiance, with s the specular and o the outgoing angle of "
                "the light: reciprocal: 1; fraunhofer: cos s/cos o, as published, not reciprocal; "
                "kirchhoff: ((cos s + cos o)/2)^2/(cos s cos o)"},
               {"renormalize", "boolean", "", "false",
                "scale by h(w_i) h(w_o) such that no diffracted power is lost to evanescent waves; "
                "only with reciprocal"},
               {"sampling", "string", "", "product",
                "product: in proportion to the diffracted intensity; factors: by its two factors in "
                "turn, as published; the picture is the same, with more noise"},
               {"blocked", "bsdf", "", "none",
                "what the discs do with the light they block (absorbed without); not for apertures"}},
              {R"(<bsdf type="correlated_scatterers">
    <string name="scatterer" value="apertures"/>
    <string name="radius" value="5um"/>
    <float name="area_fraction" value="0.5"/>
    <string name="substrate" value="thindielectric"/>
    <string name="int_ior" value="bk7"/> <string name="ext_ior" value="air"/>
    <boolean name="dispersion" value="false"/>
    <boolean name="renormalize" value="true"/>
</bsdf>)",
               R"(<bsdf type="correlated_scatterers">
    <string name="scatterer" value="discs"/>
    <string name="radius" value="4um"/> <string name="correlation_radius" value="5um"/>
    <float name="area_fraction" value="0.3"/>
    <string name="obliquity" value="kirchhoff"/>
    <string name="sampling" value="factors"/>
    <bsdf name="blocked" type="diffuse"/>
</bsdf>)"}});

}  // namespace
}  // namespace aureole

// SPDX-License-Identifier: Apache-2.0
// A plane layer of many scatterers, apertures or opaque discs of any shapes, which produces coronas. Model:
// Yang, Kim, Pediredla & Jarosz, "A wave-optics BSDF for correlated scatterers", 2025, equations 14 to 28.
//
// Light from w_i in a medium of index n_i that leaves along w_o in index n_o (both outward) is diffracted
// with
//     f = (n_o^2/lambda^2) J(q) O c,   q = (2 pi/lambda) (n_o w_o + n_i w_i)_xy,
//     1/(4 pi^2) int J d2q = Fr (1 - Fr),
// where Fr is the covered fraction of the plane, O an obliquity factor and c the fraction reflected or
// transmitted. With O = 1 the radiance depends on direction cosines alone (Harvey, Vernold, Krywonos &
// Thompson, "Diffracted radiance: a fundamental quantity in nonparaxial scalar diffraction theory", 1999).
// Then f is reciprocal, f(i->o)/n_o^2 = f(o->i)/n_i^2. Power of evanescent waves, whose q has no real
// direction, is lost.
//
// Lobes. The undiffracted (0th-order) light and the light that reaches the substrate have common directions,
// so they share delta lobes: D times the substrate's reflection and transmission. D = Fr^2 + (1 - Fr) for
// apertures (Fr^2 for `none`, whose sheet absorbs or has its own BSDF) and D = (1 - Fr)^2 for discs
// (Babinet). The diffracted lobe, S = Fr (1 - Fr), has c = sqrt(R_i R_o) in reflection and 1 - sqrt(R_i R_o)
// in transmission. R is the reflectance of the interface (or pane) for either direction on its own side, 1
// beyond the critical angle. Discs leave the fraction Fr to a nested BSDF.
#include <cmath>
#include <optional>

#include "aureole/bsdf/bsdf.h"
#include "aureole/bsdf/layer/layer_obliquity.h"
#include "aureole/bsdf/layer/layer_substrate.h"
#include "aureole/bsdf/layer/layer_tables.h"
#include "aureole/bsdf/nested/nested_bsdfs.h"
#include "aureole/bsdf/parameter/scalar_texture.h"
#include "aureole/math/warp.h"
#include "aureole/plugin/registry.h"
#include "aureole/plugin/table_holder.h"

namespace aureole {
namespace {

class CorrelatedScatterers final : public Bsdf, public TableHolder {
public:
  explicit CorrelatedScatterers(const Properties& p) : Bsdf(p) {
    discs_ = p.get_choice("scatterer", "apertures", {"apertures", "discs"}) == "discs";
    LayerShapes shapes = read_layer_shapes(p);
    if (!p.has("area_fraction"))
      throw p.error("area_fraction", "the parameter \"area_fraction\" is required");
    area_fraction_ = ScalarTexture::from(p, "area_fraction", 0, Range{0, optics::kClosestDiscPacking});
    if (!(area_fraction_.maximum() > 0)) throw p.error("area_fraction", "must be above 0 somewhere");
    radius_scale_ = ScalarTexture::from(p, "radius_scale", 1, Range{1.0 / 64, 64});
    rotation_ = ScalarTexture::from(p, "rotation", 0, Range{-1e4, 1e4});

    substrate_ = LayerSubstrate::from(p);
    obliquity_ = LayerObliquity::from(p);
    const auto nested = p.get_children<Bsdf>("bsdf");
    if (nested.size() > 1)
      throw Error(nested[1]->properties().where(),
                  "\"correlated_scatterers\" takes one nested BSDF, not more");
    if (!nested.empty()) {
      if (!discs_ && !substrate_.is_none())
        throw Error(nested[0]->properties().where(),
                    "a nested BSDF is what lies between apertures; that is already the substrate \"" +
                        p.get_string("substrate") + "\"");
      nested_ = nested.front();
    }

    phase_nm_ = 2 * M_PI * shapes.correlation_radius * 1e9;
    const SpectralGrid& range = p.context().grid;
    if (!(phase_nm_ * radius_scale_.minimum() >= kMinPhase * range.max_nm &&
          phase_nm_ * radius_scale_.maximum() <= kMaxPhase * range.min_nm))
      throw p.error(
          "radius",
          "the scatterers are too small or too large for the wavelengths: 2 pi times their radius must be "
          "between a millionth of a wavelength and 10^9 wavelengths");
    const LayerRanges ranges{area_fraction_.minimum(), area_fraction_.maximum(), radius_scale_.minimum(),
                             radius_scale_.maximum()};
    tables_ = p.shared_model<LayerTables>([&] {
      return std::make_shared<const LayerTables>(
          make_layer_tables(p, std::move(shapes), ranges, phase_nm_, substrate_, obliquity_.is_reciprocal()));
    });
    if (!tables_ || !tables_->model) return;
    model_ = tables_->model;
    sampler_ = tables_->sampler;
    balance_ = tables_->balance;
    needs_tangent_ = !model_->is_isotropic();
  }

  BsdfEval eval_pdf(const Vec3& wi, const Vec3& wo, const BsdfContext& ctx) const override {
    if (wi.z == 0 || wo.z == 0) return {};
    const Point point = at(ctx);
    BsdfEval e = diffracted<true>(wi, wo, point, ctx);
    if (nested_) {
      const BsdfEval b = nested_->eval_pdf(wi, wo, ctx);
      e.value += b.value * point.nested;
      e.pdf += b.pdf * (point.nested * point.probability);
    }
    return e;
  }

  Spectrum eval(const Vec3& wi, const Vec3& wo, const BsdfContext& ctx) const override {
    if (wi.z == 0 || wo.z == 0) return 0.f;
    const Point point = at(ctx);
    const Spectrum value = diffracted<false>(wi, wo, point, ctx).value;
    return nested_ ? value + nested_->eval(wi, wo, ctx) * point.nested : value;
  }

  std::optional<BsdfSample> sample(const Vec3& wi, float u1, Vec2 u2, const BsdfContext& ctx) const override {
    if (wi.z == 0) return {};
    const Point point = at(ctx);
    if (!(point.probability > 0)) return {};
    const float delta = point.delta * point.probability, diffracted = point.diffracted * point.probability;
    if (u1 < delta) return substrate_.sample(wi, remap_below(u1, delta), point.delta, delta, ctx);
    u1 -= delta;
    if (u1 < diffracted || !nested_)
      return sample_diffracted(wi, remap_below(u1, diffracted), u2, point, ctx);
    const float probability = point.nested * point.probability;
    auto s = nested_->sample(wi, remap_below(u1 - diffracted, probability), u2, ctx);
    if (!s) return {};
    if (s->is_delta()) {
      s->value *= point.nested;
      s->pdf *= probability;
    } else {
      const BsdfEval e = eval_pdf(wi, s->wo, ctx);
      s->value = e.value, s->pdf = e.pdf;
    }
    return s;
  }

  Spectrum null_transmittance(const Vec3& wi, const BsdfContext& ctx) const override {
    const Point point = at(ctx);
    Spectrum straight = substrate_.straight(wi, ctx) * point.delta;
    if (nested_ && nested_->is_passable()) straight += nested_->null_transmittance(wi, ctx) * point.nested;
    return straight;
  }

  Lobe lobes() const override {
    Lobe l = Lobe::delta | Lobe::glossy | Lobe::transmit;
    if (!substrate_.is_none()) l = l | Lobe::reflect;
    if (substrate_.is_passable()) l = l | Lobe::through | Lobe::null;
    return nested_ ? l | nested_->lobes() : l;
  }

  Tables tables() const override {
    return {tables_.get(), tables_ ? model_->bytes() + sampler_->bytes() : 0};
  }
  bool needs_tangent() const override { return needs_tangent_ || (nested_ && nested_->needs_tangent()); }

private:
  /// The layer at one point of the surface. Weights are fractions of the light; a weight times `probability`
  /// is the probability of its lobe.
  struct Point {
    ScattererModel::State state;
    double phase_nm;  ///< product of k a (correlation radius a) and the wavelength
    float cosine, sine;
    float delta, diffracted, nested, probability;
  };
  Point at(const BsdfContext& ctx) const {
    Point x;
    x.state = model_->at(area_fraction_.eval(ctx));
    x.phase_nm = phase_nm_ * radius_scale_.eval(ctx);
    x.cosine = 1, x.sine = 0;
    if (needs_tangent_) {
      const float angle = rotation_.eval(ctx) * float(M_PI / 180);
      x.cosine = std::cos(angle), x.sine = std::sin(angle);
    }
    const float fr = model_->covered(x.state.area_fraction);
    x.diffracted = model_->diffracted(x.state.area_fraction);
    x.delta = discs_ ? (1 - fr) * (1 - fr) : fr * fr + (substrate_.is_none() ? 0 : 1 - fr);
    // The nested BSDF of discs gets the light that they do not transmit, and the nested BSDF of openings gets
    // the light on the screen between them.
    x.nested = nested_ ? (discs_ ? std::max(1 - x.delta - x.diffracted, 0.f) : 1 - fr) : 0;
    const float all = x.delta + x.diffracted + x.nested;
    x.probability = all > 0 ? 1 / all : 0;
    return x;
  }

  template <bool kDensity>
  BsdfEval diffracted(const Vec3& wi, const Vec3& wo, const Point& point, const BsdfContext& ctx) const {
    const bool reflected = (wi.z > 0) == (wo.z > 0);
    if (substrate_.is_none() && reflected) return {};
    const float cos_i = std::abs(wi.z), cos_o = std::abs(wo.z);
    const LayerSubstrate::Indices n = substrate_.indices(wi.z, ctx.wavelengths);
    const Spectrum n_o = reflected ? n.here : n.beyond;
    const Spectrum phase = Spectrum(float(point.phase_nm)) / ctx.wavelengths.nm;  // k a
    const float sin_i = std::sqrt(wi.x * wi.x + wi.y * wi.y);
    DiffractedWave u;
    if (substrate_.is_dispersive()) {
      u.x = phase * (n_o * wo.x + n.here * wi.x), u.y = phase * (n_o * wo.y + n.here * wi.y);
      u.length = sqrt(u.x * u.x + u.y * u.y);
    } else {
      // The two transverse components nearly cancel here; double precision keeps their difference accurate.
      const double a = n_o[0], b = n.here[0];
      const double x = a * wo.x + b * wi.x, y = a * wo.y + b * wi.y;
      u.x = phase * float(x), u.y = phase * float(y);
      u.length = phase * float(std::sqrt(x * x + y * y));
    }
    if (needs_tangent_) {  // rotates the wave to the frame of the shapes
      const Spectrum x = u.x;
      u.x = x * point.cosine + u.y * point.sine;
      u.y = u.y * point.cosine - x * point.sine;
    }

    // Converts the density 1/(2 pi) over u to a density of wo over solid angle, and includes the probability
    // of this side.
    const Spectrum jacobian = phase * phase * n_o * n_o * (cos_o * 0.5f * kInvPi);
    Spectrum share(1.f);
    if (!substrate_.is_none()) {
      const Spectrum r_o =
          substrate_.reflectance(cos_o, reflected ? n : substrate_.indices(wo.z, ctx.wavelengths));
      const Spectrum both = sqrt(substrate_.reflectance(cos_i, n) * r_o);
      share = reflected ? both : Spectrum(1.f) - both;
    }
    BsdfEval e;
    e.value = model_->intensity(point.state, u) * jacobian * share * point.diffracted;
    const float probability = point.diffracted * point.probability;
    if (!kDensity) {
      // the value alone, without the pdf
    } else if (sampler_) {
      const Spectrum u_max = phase * (max(n.here, n.beyond) + n.here * sin_i);
      e.pdf = sampler_->density(point.state, u, u_max) * jacobian * share * probability;
    } else {
      e.pdf = cos_o * kInvPi * probability * (substrate_.is_none() ? 1.f : 0.5f);
    }
    if (ctx.mode == TransportMode::radiance && !reflected &&
        substrate_.kind() == LayerSubstrate::Kind::interface)
      e.value *= n.here * n.here / (n_o * n_o);
    if (!obliquity_.is_reciprocal()) e.value *= obliquity_.factor(wi, wo, n.here, n_o, ctx.mode);
    if (balance_) {
      const float sin_o = std::sqrt(wo.x * wo.x + wo.y * wo.y);
      e.value *= balance_->factor(ctx.wavelengths.nm, n.here, n.beyond, sin_i) *
                 balance_->factor(ctx.wavelengths.nm, n_o, reflected ? n.beyond : n.here, sin_o);
    }
    return e;
  }

  /// Samples a wave, then reflection or transmission in proportion to their fractions. With O = 1 and waves
  /// in proportion to J all samples have equal weight, except for evanescent q, which are lost.
  std::optional<BsdfSample> sample_diffracted(const Vec3& wi, float u1, Vec2 u2, const Point& point,
                                              const BsdfContext& ctx) const {
    const LayerSubstrate::Indices all = substrate_.indices(wi.z, ctx.wavelengths);
    const double n_i = all.here[0], n_t = all.beyond[0];
    bool reflected = false;
    Vec3 wo;
    if (sampler_) {
      const float phase = float(point.phase_nm) / ctx.wavelengths.nm[0];
      const double sin_i = std::sqrt(wi.x * wi.x + wi.y * wi.y);
      const double u_max = phase * (std::max(n_i, n_t) + n_i * sin_i);
      const ScattererSampler::Wave u = sampler_->sample(point.state, u1, u2, u_max);
      // Transverse components of n_o w_o, on either side.
      const double x = (u.x * point.cosine - u.y * point.sine) / phase - n_i * wi.x;
      const double y = (u.x * point.sine + u.y * point.cosine) / phase - n_i * wi.y;
      const double r2 = x * x + y * y;
      if (!substrate_.is_none()) {
        const double c2 = 1 - r2 / (n_i * n_i);
        const Spectrum r_i = substrate_.reflectance(std::abs(wi.z), all);
        const float r_o = c2 > 0 ? substrate_.reflectance(float(std::sqrt(c2)), all)[0] : 1;
        reflected = u1 < std::sqrt(r_i[0] * r_o);
      }
      const double n_o = reflected ? n_i : n_t;
      const double c2 = 1 - r2 / (n_o * n_o);
      if (!(c2 > 0)) return {};
      const float z = float(std::sqrt(c2));
      wo = {float(x / n_o), float(y / n_o), (wi.z > 0) == reflected ? z : -z};
    } else {
      reflected = !substrate_.is_none() && u1 < 0.5f;
      wo = square_to_cosine_hemisphere(u2);
      if ((wi.z > 0) != reflected) wo.z = -wo.z;
    }
    const BsdfEval e = eval_pdf(wi, wo, ctx);
    if (!(e.pdf[0] > 0)) return {};
    return BsdfSample{wo, e.value, e.pdf, Lobe::glossy | (reflected ? Lobe::reflect : Lobe::transmit),
                      float((reflected ? n_i : n_t) / n_i)};
  }

  static constexpr double kMinPhase = 1e-6, kMaxPhase = 1e9;  // bounds of k a for single precision

  LayerSubstrate substrate_;
  LayerObliquity obliquity_;
  bool discs_, needs_tangent_ = false;
  double phase_nm_;  // 2 pi correlation_radius [nm]: k a times the wavelength
  ScalarTexture area_fraction_, radius_scale_, rotation_;
  /// tables, shared by equal layers; null in a scene with errors
  std::shared_ptr<const LayerTables> tables_;
  std::shared_ptr<const ScattererModel> model_;
  std::shared_ptr<const ScattererSampler> sampler_;  // sampler of the diffracted wave; null: cosine sampling
  std::optional<ScattererBalance> balance_;
  BsdfPtr nested_;
};

AUREOLE_PLUGIN(
    CorrelatedScatterers, "bsdf", "correlated_scatterers",
    PluginDoc{
        "A layer of many scatterers, openings in a sheet or in the mist on a pane, or opaque discs, "
        "whose diffracted light makes coloured rings or stars around every light source (a corona). "
        "Shapes are nested apertures, several for a mixture, or circles of one radius. Their "
        "positions are those of hard discs, or of the nested correlation. One part of the light is "
        "undiffracted, one is diffracted, and the rest falls on the area between apertures (absorbed "
        "for \"none\" without a nested BSDF) or is blocked by discs. With the covered fraction Fr, "
        "these parts are Fr^2, Fr - Fr^2, 1 - Fr for apertures and (1 - Fr)^2, Fr - Fr^2, Fr for "
        "discs. Diffracted waves without a real direction (evanescent) are lost, about 2/(pi k a (1 - "
        "Fr)) of the diffracted power at normal incidence and more at grazing; renormalize restores "
        "that power. Shapes or correlations without circular symmetry are oriented by the surface's "
        "uv, or by a normal map's frame.",
        "R. Yang, J. Kim, A. Pediredla, W. Jarosz, A wave-optics BSDF for correlated scatterers, 2025, "
        "equations 14 to 28; J. E. Harvey et al., Diffracted radiance: a fundamental quantity in "
        "nonparaxial scalar diffraction theory, Appl. Opt. 38, 1999",
        {{"scatterer", "string", "", "apertures",
          "apertures (light passes through the shapes) or discs (light passes around them)"},
         {"radius", "length", "", "none",
          "radius of the circles, such as 5um; required without nested apertures"},
         {"aperture", "aperture", "", "none", "shapes, whose fractions sum to 1; replaces radius"},
         {"correlation_radius", "length", "", "the largest shape's",
          "half the smallest distance of two centres: at least the radius of the largest shape's "
          "circumcircle, at most 64 times that"},
         {"area_fraction", "float or texture", "", "required",
          "fraction of the plane that discs of correlation_radius would cover; up to 0.7 for "
          "percus_yevick, never above 0.9069"},
         {"correlation", "correlation", "", "percus_yevick", "spatial correlation of the positions"},
         {"sizes", "string", "", "labelled",
          "labelled: scatterers of all sizes are in equal discs, of correlation_radius; polydisperse: "
          "each is in a disc in proportion to its own size, the largest of correlation_radius, packed "
          "as such discs are (up to 8 classes of sizes; area_fraction refers to all discs)"},
         {"radius_scale", "float or texture", "", "1", "factor of all lengths, in [1/64, 64]"},
         {"rotation", "float or texture", "degrees", "0",
          "rotates shapes and positions counter-clockwise from the u axis"},
         {"substrate", "string", "", "none",
          "none: a sheet in one medium, without reflection; dielectric: the interface of two media; "
          "thindielectric: a pane as one surface"},
         {"int_ior", "float or string", "", "1.5046",
          "index of refraction below the interface or of the pane; not for none"},
         {"ext_ior", "float or string", "", "air",
          "index of refraction above, and on both sides of a sheet or pane"},
         {"dispersion", "boolean", "", "true", "named materials use their dispersion data if available"},
         {"obliquity", "string", "", "reciprocal",
          "factor of the diffracted radiance, with s the specular and o the outgoing angle of the "
          "light: reciprocal: 1; fraunhofer: cos s/cos o, as published, not reciprocal; kirchhoff: "
          "((cos s + cos o)/2)^2/(cos s cos o)"},
         {"renormalize", "boolean", "", "false",
          "scale by h(w_i) h(w_o) such that no diffracted power is lost to evanescent waves; only "
          "with reciprocal, and for uniform layers with circular symmetry"},
         {"sampling", "string", "", "product",
          "product: in proportion to the diffracted intensity; factor_mis (or factors): by shapes or "
          "by correlation, as published; table: by one table of the intensity, computed for this "
          "layer alone; cosine. They differ in noise only; product has the least"},
         {"bsdf", "bsdf", "", "none",
          "BSDF of the area between apertures, such as cloth (only for the substrate none), or of "
          "discs; without it light that falls there is absorbed"}},
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
    <string name="sampling" value="factor_mis"/>
    <bsdf name="blocked" type="diffuse"/>
</bsdf>)",
         R"(<bsdf type="correlated_scatterers">
    <aperture type="rectangle">
        <string name="width" value="3um"/> <string name="height" value="2um"/> <float name="fraction" value="0.6"/>
    </aperture>
    <aperture type="circle"> <string name="radius" value="1um"/> <float name="fraction" value="0.4"/> </aperture>
    <texture type="checkerboard" name="area_fraction">
        <float name="color0" value="0.2"/> <float name="color1" value="0.6"/>
    </texture>
    <float name="radius_scale" value="1.5"/> <float name="rotation" value="30"/>
    <correlation type="percus_yevick"/>
</bsdf>)"}});

}  // namespace
}  // namespace aureole

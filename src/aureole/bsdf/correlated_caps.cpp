// SPDX-License-Identifier: Apache-2.0
// A plane layer of transparent scatterers with complex amplitudes: caps of spheres, such as mist on a window, or flat
// discs that retard light. Model: optics/layer/phase_scatterer.h; tables and energy: bsdf/caps/cap_tables.h.
//
// Lobes. The undiffracted light of each wavelength is a null lobe. The rest is scattered to the other side, turned
// back to its own side, or absorbed. Caps lie on the side of the normal; the BSDF is reciprocal.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>

#include "aureole/bsdf/bsdf.h"
#include "aureole/bsdf/caps/cap_tables.h"
#include "aureole/correlation/correlation.h"
#include "aureole/math/warp.h"
#include "aureole/parameter/ior.h"
#include "aureole/plugin/registry.h"
#include "aureole/plugin/table_holder.h"
#include "aureole/texture/texture.h"

namespace aureole {
namespace {

class CorrelatedCaps final : public Bsdf, public TableHolder {
public:
  explicit CorrelatedCaps(const Properties& p) : Bsdf(p) {
    const SpectralGrid grid = p.context().grid;
    CapLayer layer;
    if (!p.has("radius"))
      throw p.error("radius", "the parameter \"radius\" is required, a length such as \"5um\"");
    layer.radius_nm = p.get_length_m("radius", 0) * 1e9;
    if (!(layer.radius_nm > 0)) throw p.error("radius", "must be positive");
    layer.area_fraction = p.get_float("area_fraction", Range{0, optics::kMaxAreaFraction, true});
    layer.sizes = optics::SizeDistribution::log_normal(p.get_float("size_spread", 0, Range{0, kMaxSpread}));

    exterior_ = Ior::from(p, "ext_ior", "air");
    interior_ = Ior::from(p, "int_ior", "water");
    const auto index = [grid](const Ior& ior, double nm) {
      return double(ior.eval(Wavelengths::at(grid, float(nm)))[0]);
    };
    layer.medium = [=, ior = exterior_](double nm) { return index(ior, nm); };
    layer.relative_index = [=, outside = exterior_, inside = interior_](double nm) {
      return index(inside, nm) / index(outside, nm);
    };
    double largest_index = 1;
    for (int i = 0; i <= grid.cells; ++i) {
      const double m = layer.relative_index(grid.node(i));
      largest_index = std::max(largest_index, m);
      if (!(m > 1.001 && m < 4))
        throw p.error("int_ior", "the index of the scatterers over that outside is " + std::to_string(m) +
                                     "; it must be above 1.001 and below 4");
    }

    const bool flat = p.get_choice("profile", "cap", {"cap", "disc"}) == "disc";
    const auto transmittance = get_optional_spectrum(p, "transmittance", SpectrumRole::reflectance);
    const char *needed = flat ? "height" : "contact_angle", *other = flat ? "contact_angle" : "height";
    if (p.has(other))
      throw p.error(other, std::string("is for the profile \"") + (flat ? "cap" : "disc") + "\"");
    if (!p.has(needed)) throw p.error(needed, std::string("the parameter \"") + needed + "\" is required");
    if (flat) {
      const double height_nm = p.get_length_m("height", 0) * 1e9;
      layer.height = height_nm / layer.radius_nm;
      // The phases of all discs are equal and rotate with the wavelength; tables have nodes for some turns.
      const double difference =
          2 * M_PI * height_nm * (largest_index - 1) * (1 / grid.min_nm - 1 / grid.max_nm);
      if (!(difference <= kMaxPhaseDifference))
        throw p.error("height", "the discs are too high: (n - 1) 2 pi height/lambda differs by " +
                                    std::to_string(difference) +
                                    " rad between the ends of the film's range, and may differ by at most " +
                                    std::to_string(int(kMaxPhaseDifference)));
      if (transmittance) transmittance_ = *transmittance;
    } else {
      layer.profile.contact_angle = p.get_float("contact_angle", Range{1, 90}) * M_PI / 180;
      layer.profile.relative_index =
          layer.relative_index(std::clamp(550.0, double(grid.min_nm), double(grid.max_nm)));
      layer.height = layer.profile.cap_height();
      if (transmittance) throw p.error("transmittance", "is for the profile \"disc\"");
    }
    layer.transmittance = [=, t = transmittance_](double nm) {
      return t ? double(t->eval(Wavelengths::at(grid, float(nm)))[0]) : 1.0;
    };

    const double smallest_phase =
        2 * M_PI * layer.radius_nm *
        std::min(layer.medium(grid.min_nm) / grid.min_nm, layer.medium(grid.max_nm) / grid.max_nm);
    if (!(smallest_phase >= kMinPhase))
      throw p.error(
          "radius",
          "the scatterers are too small for the wavelengths: 2 pi n radius/lambda must be at least 3; "
          "\"correlated_spheres\" has no such limit");
    const auto correlation = get_correlation(p);
    if (correlation->may_overlap())
      throw p.error("correlation", "caps cannot overlap: positions must be those of discs that do not");
    try {
      layer.structure = correlation->structure_factor(layer.area_fraction);
    } catch (const std::domain_error& e) {
      throw p.error("area_fraction", e.what());
    }
    if (!layer.structure->is_isotropic())
      p.note("correlation",
             "the arrangement is anisotropic; its structure factor is averaged over the azimuth");
    tables_ = p.shared_model<CapTables>([&] {
      try {
        return std::make_shared<const CapTables>(layer, grid);
      } catch (const std::domain_error& e) {
        throw flat
            ? p.error("height", std::string(e.what()) + "; radius and height are too large")
            : p.error("radius", std::string(e.what()) +
                                    "; larger drops diffract as discs of \"correlated_scatterers\" and "
                                    "refract as meshes");
      }
    });
  }

  BsdfEval eval_pdf(const Vec3& wi, const Vec3& wo, const BsdfContext& ctx) const override {
    if (!(std::abs(wi.z) > 0 && std::abs(wo.z) > 0)) return {};
    const Lights l = lights(ctx);
    const bool back = (wi.z > 0) == (wo.z > 0);
    const LobeProbabilities m(*this, l, wi);
    BsdfEval e;
    e.value = make_spectrum([&](int j) {
      return back ? tables_->turned_back(l[j], m.shares[std::size_t(j)].turned_back, wo)
                  : tables_->scattered(l[j], wi, wo);
    });
    e.pdf = make_spectrum([&](int j) {
      return back ? m.rest[j] * m.shares[j].turned_back * std::abs(wo.z) * kInvPi
                  : m.rest[j] * m.shares[j].scattered * tables_->density(l[j], wi, wo);
    });
    return e;
  }

  std::optional<BsdfSample> sample(const Vec3& wi, float u1, Vec2 u2, const BsdfContext& ctx) const override {
    if (!(std::abs(wi.z) > 0)) return {};
    const Lights l = lights(ctx);
    const LobeProbabilities m(*this, l, wi);
    const float back = m.shares[0].turned_back * m.rest[0], scattered = m.shares[0].scattered * m.rest[0];
    if (u1 < m.undiffracted || !(back + scattered > 0)) {
      if (!(u1 < m.undiffracted)) return {};
      return BsdfSample{-wi, make_spectrum([&](int j) { return m.shares[j].undiffracted; }), m.undiffracted,
                        kNullLobe};
    }
    Vec3 wo;
    const bool is_back = u1 - m.undiffracted < back;
    if (is_back) {
      wo = square_to_cosine_hemisphere(u2);
      if (wi.z < 0) wo.z = -wo.z;
    } else if (!tables_->sample(l[0], wi, u2, wo)) {
      return {};
    }
    const BsdfEval e = eval_pdf(wi, wo, ctx);
    if (!(e.pdf[0] > 0)) return {};
    return BsdfSample{wo, e.value, e.pdf,
                      is_back ? Lobe::diffuse | Lobe::reflect : Lobe::glossy | Lobe::transmit};
  }

  Spectrum null_transmittance(const Vec3& wi, const BsdfContext& ctx) const override {
    const Lights l = lights(ctx);
    return make_spectrum([&](int j) { return tables_->shares(l[j], wi.z > 0, std::abs(wi.z)).undiffracted; });
  }

  Lobe lobes() const override {
    return kNullLobe | Lobe::glossy | Lobe::diffuse | Lobe::reflect | Lobe::transmit | Lobe::through;
  }
  bool needs_tangent() const override { return false; }
  Tables tables() const override { return {tables_.get(), tables_ ? tables_->bytes() : 0}; }

private:
  static constexpr double kMaxSpread = 0.3, kMinPhase = 3, kMaxPhaseDifference = 16;

  using Lights = std::array<CapTables::Light, kWavelengths>;
  Lights lights(const BsdfContext& ctx) const {
    const Spectrum outside = exterior_.eval(ctx.wavelengths),
                   inside = interior_.eval(ctx.wavelengths) / outside,
                   through = transmittance_ ? transmittance_->eval(ctx.wavelengths) : Spectrum(1.f);
    Lights l;
    for (int j = 0; j < kWavelengths; ++j)
      l[std::size_t(j)] = tables_->light(ctx.wavelengths.nm[j], outside[j], inside[j], through[j]);
    return l;
  }

  /// Probabilities of `sample`. The null lobe needs one probability for all wavelengths, the mean of their
  /// undiffracted fractions; `rest` is the factor of the fractions of other lobes.
  struct LobeProbabilities {
    std::array<CapTables::Shares, kWavelengths> shares;
    float undiffracted = 0;
    Spectrum rest{0.f};

    LobeProbabilities(const CorrelatedCaps& caps, const Lights& l, const Vec3& wi) {
      for (int j = 0; j < kWavelengths; ++j) {
        shares[std::size_t(j)] = caps.tables_->shares(l[std::size_t(j)], wi.z > 0, std::abs(wi.z));
        undiffracted += shares[std::size_t(j)].undiffracted / kWavelengths;
      }
      rest = make_spectrum([&](int j) {
        const float other = shares[std::size_t(j)].scattered + shares[std::size_t(j)].turned_back;
        return other > 0 ? (1 - undiffracted) / other : 0.f;
      });
    }
  };

  Ior exterior_, interior_;
  std::optional<SampledSpectrum> transmittance_;
  std::shared_ptr<const CapTables> tables_;
};

AUREOLE_PLUGIN(
    CorrelatedCaps, "bsdf", "correlated_caps",
    PluginDoc{
        "A layer of many transparent caps on a plane, such as the droplets of mist on a window, or of flat discs "
        "that retard light: coronas with the light that the droplets themselves refract. The plane is one surface "
        "in one medium, with the caps on the side of its normal; the pane is another surface at a small distance. "
        "Light passes undiffracted, is diffracted and refracted to the other side, or is turned back by total "
        "reflection within caps, which is spread evenly. Discs may absorb. A layer that does not absorb loses no "
        "light. Droplets far above the wavelength look like opaque discs (`correlated_scatterers`) near a lamp, and "
        "refract light into the dark around it; those of few micrometres have coronas of other colours, since light "
        "through them and light beside them interfere.\n\nThe light that leaves a cap after reflections within it "
        "has no caustics, and caps do not shadow each other at grazing angles. Discs also turn back what their "
        "phases at other angles do not carry: energy is kept within 2 %, and (n - 1) 2 pi height/lambda may differ by "
        "at most 16 rad between the ends of the film's range. 2 pi n radius/lambda, with n the index outside, must be "
        "at least 3; the table of phases takes at most 72 MiB, enough for drops of 30 um with contact angles of 60 "
        "degrees in visible light.",
        "R. Yang, J. Kim, A. Pediredla, W. Jarosz, A wave-optics BSDF for correlated scatterers, 2025, with complex "
        "amplitudes; H. C. van de Hulst, Light Scattering by Small Particles, 1957, chapter 11",
        {{"radius", "length", "", "required", "radius of the bases (the median), such as 5um"},
         {"area_fraction", "float", "", "required",
          "fraction of the plane that the bases cover, in (0, 0.7]"},
         {"profile", "string", "", "cap", "cap: part of a sphere; disc: flat"},
         {"contact_angle", "float", "degrees", "required for caps",
          "angle between the plane and the surface of a cap at its rim, 1 to 90: water on clean glass 10 to 30, on "
          "glass of a window 40 to 70"},
         {"height", "length", "", "required for discs",
          "height of a disc; its phase is 2 pi (n - 1) height/lambda"},
         {"transmittance", "spectrum", "", "1", "fraction of light that a disc does not absorb"},
         {"size_spread", "float", "", "0",
          "standard deviation of ln(radius), log-normal, up to 0.3; positions are those of equal discs of the same "
          "covered fraction"},
         {"int_ior", "float or string", "", "water",
          "index of refraction of the caps, 1.001 to 4 times that around them"},
         {"ext_ior", "float or string", "", "air", "index of refraction around them"},
         {"correlation", "correlation", "", "hard discs",
          "spatial correlation of the positions; default: hard discs (Percus and Yevick)"}},
        {R"(<bsdf type="correlated_caps">
    <string name="radius" value="6um"/>
    <float name="area_fraction" value="0.4"/>
    <float name="contact_angle" value="50"/>
    <float name="size_spread" value="0.1"/>
    <float name="int_ior" value="1.333"/> <float name="ext_ior" value="1"/>
</bsdf>)",
         R"(<bsdf type="correlated_caps">
    <string name="radius" value="4um"/>
    <float name="area_fraction" value="0.3"/>
    <string name="profile" value="disc"/>
    <string name="height" value="800nm"/>
    <spectrum name="transmittance" value="400:0.5, 700:0.9"/>
    <correlation type="percus_yevick"/>
</bsdf>)"}});

}  // namespace
}  // namespace aureole

// SPDX-License-Identifier: Apache-2.0
// A measured surface or sheet given by a table of directions and values, at any outgoing directions.
#include <fmt/format.h>

#include <optional>

#include "aureole/bsdf/bsdf.h"
#include "aureole/bsdf/measured/half_vector_density.h"
#include "aureole/bsdf/measured/incident_side.h"
#include "aureole/bsdf/measured/scattered_table.h"
#include "aureole/bsdf/measured/set_sample.h"
#include "aureole/math/warp.h"
#include "aureole/parameter/data_range.h"
#include "aureole/plugin/registry.h"
#include "aureole/plugin/table_holder.h"
#include "aureole/spectrum/rgb_primaries.h"

namespace aureole {
namespace {

class Tabulated final : public Bsdf, public TableHolder {
public:
  explicit Tabulated(const Properties& properties)
      : Bsdf(properties),
        incident_(IncidentSide::from(properties)),
        primaries_(rgb_primaries(properties.context().grid)) {
    const bool has_cosine = properties.get_choice("quantity", "bsdf", {"bsdf", "intensity"}) == "intensity";
    const std::filesystem::path file = properties.get_file("filename");
    properties.tolerate(0, [&] {
      const ScatteredMeasurements m = read_scattered_measurements(file, has_cosine);
      const SpectralGrid& grid = properties.context().grid;
      is_spectral_ = !m.nm.empty(), is_coloured_ = m.channels == 3;
      reflection_ = ScatteredTable(m, false, file.string(), grid);
      transmission_ = ScatteredTable(m, true, file.string(), grid);
      const auto note = [&](const std::string& text) {
        properties.note("filename", "parameter \"filename\": " + text);
      };
      if (is_spectral_)
        note_data_range(properties, "filename", "the table", {m.nm.front(), m.nm.back()});
      else
        note(is_coloured_ ? "the table has colours (linear sRGB), not spectra; they become smooth spectra"
                          : "the table has one value, which is used at all wavelengths");
      if (!m.errors.empty()) note("uncertainties stand in the table; they do not change the picture");
      if (m.negative > 0)
        note(fmt::format("{} of {} values are negative and count as 0", m.negative, m.values.size()));
      for (const auto* t : {&reflection_, &transmission_})
        if (t->was_mirrored())
          note(fmt::format(
              "azimuths of {} directions cover half of the circle; the other half is its mirror image",
              t == &reflection_ ? "reflected" : "transmitted"));
      double powers[2] = {0, 0};
      for (const bool transmitted : {false, true}) {
        const ScatteredTable& t = transmitted ? transmission_ : reflection_;
        if (t.empty()) continue;
        HalfVectorDensity::Resolution resolution;
        if (!t.is_isotropic()) resolution.azimuths = 17;
        densities_[transmitted] = std::make_shared<const HalfVectorDensity>(
            resolution, [&](const Vec3& wi, const Vec3& wo) { return t.mean(wi, wo) * wo.z; });
        for (const auto& e : densities_[transmitted]->energies()) powers[transmitted] += e.fraction;
        if (const std::string text = energy_note(densities_[transmitted]->energies()); !text.empty())
          note(text);
      }
      if (reflection_.empty() && transmission_.empty())
        throw properties.error("filename", "the table has no directions");
      transmitted_part_ = powers[0] + powers[1] > 0 ? float(powers[1] / (powers[0] + powers[1])) : 0.5f;
      if (reflection_.empty() != transmission_.empty())
        transmitted_part_ = reflection_.empty() ? 1.f : 0.f;
      else
        transmitted_part_ = std::min(std::max(transmitted_part_, 0.05f), 0.95f);
      return 0;
    });
  }

  BsdfEval eval_pdf(const Vec3& wi, const Vec3& wo, const BsdfContext& ctx) const override {
    if (wi.z == 0 || wo.z == 0 || (wi.z < 0 && wo.z < 0)) return {};
    const bool transmitted = (wi.z > 0) != (wo.z > 0);
    const auto& density = densities_[transmitted];
    if (!density) return {};
    // The lower side has only the lobe of transmission.
    const float part = wi.z < 0 ? 1.f : transmitted ? transmitted_part_ : 1 - transmitted_part_;
    return {eval(wi, wo, ctx), part * density->pdf(up(wi), up(wo))};
  }

  Spectrum eval(const Vec3& wi, const Vec3& wo, const BsdfContext& ctx) const override {
    if (wi.z == 0 || wo.z == 0 || (wi.z < 0 && wo.z < 0)) return 0.f;
    const bool transmitted = (wi.z > 0) != (wo.z > 0);
    const ScatteredTable& table = transmitted ? transmission_ : reflection_;
    if (table.empty()) return 0.f;
    // Transmission was measured for light from above; light from below takes the same path back (Helmholtz).
    const bool exchanged = transmitted ? wi.z < 0 : incident_.is_exchanged(ctx);
    const Vec3 i = up(exchanged ? wo : wi), o = up(exchanged ? wi : wo);
    const float cosine = std::abs(wo.z);
    if (is_spectral_) return table.spectrum(i, o, ctx.wavelengths) * cosine;
    const std::array<float, 3> c = table.colour(i, o);
    if (!is_coloured_) return c[0] * cosine;
    return rgb_spectrum(primaries_, c, ctx.wavelengths) * cosine;
  }

  std::optional<BsdfSample> sample(const Vec3& wi, float u1, Vec2 u2, const BsdfContext& ctx) const override {
    std::optional<BsdfSample> result;
    if (wi.z == 0) return result;
    const bool transmitted = wi.z < 0 || u1 < transmitted_part_;
    const auto& density = densities_[transmitted];
    if (!density) return result;
    Vec3 wo = density->sample(up(wi), u2);
    if (!(wo.z > 0)) return result;
    if ((wi.z > 0) == transmitted) wo.z = -wo.z;
    set_sample(*this, wi, wo, ctx, Lobe::glossy | (transmitted ? Lobe::transmit : Lobe::reflect), result);
    return result;
  }

  bool needs_tangent() const override {
    return (!reflection_.empty() && !reflection_.is_isotropic()) ||
           (!transmission_.empty() && !transmission_.is_isotropic());
  }
  bool is_constant() const override { return true; }
  Lobe lobes() const override {
    return Lobe::glossy | (reflection_.empty() ? Lobe::none : Lobe::reflect) |
           (transmission_.empty() ? Lobe::none : Lobe::transmit);
  }
  Tables tables() const override { return {this, reflection_.bytes() + transmission_.bytes()}; }

private:
  static Vec3 up(const Vec3& w) { return {w.x, w.y, std::abs(w.z)}; }

  IncidentSide incident_;
  std::array<SampledSpectrum, 3> primaries_;
  bool is_spectral_ = false, is_coloured_ = false;
  ScatteredTable reflection_, transmission_;
  std::shared_ptr<const HalfVectorDensity>
      densities_[2];            ///< densities of reflection and of transmission; null where there is none
  float transmitted_part_ = 0;  ///< probability of sampling transmission from above
};

AUREOLE_PLUGIN(
    Tabulated, "bsdf", "tabulated",
    PluginDoc{
        "A measured surface or sheet from a table in text: rows of the angles theta_i, phi_i, theta_o, phi_o "
        "(degrees) and of values f (1/sr) for wavelengths, for linear sRGB, or for all. Outgoing directions may "
        "lie anywhere: they are triangulated. All azimuths of incidence need the same angles of incidence; one "
        "azimuth makes the surface isotropic. theta_o above 90 degrees is transmission, which works both ways. "
        "Reflection is on the side of the normal alone.",
        "B. Delaunay, Sur la sphere vide, Izvestia Akademii Nauk SSSR 7, 1934; J. Dupuy, W. Jakob, An adaptive "
        "parameterization for efficient material acquisition and rendering, ACM TOG 37(6), 2018 (grid of half vectors)",
        {{"filename", "file", "", "required", "a .csv file"},
         {"quantity", "string", "", "bsdf",
          "bsdf: values are f; intensity: they are f times the cosine of theta_o, as of detectors that count the "
          "scattered power"},
         IncidentSide::documentation()},
        {R"(<bsdf type="tabulated">
    <string name="filename" value="glossy_table.csv"/>
</bsdf>)",
         R"(<bsdf type="tabulated">
    <string name="filename" value="paper_table.csv"/>
    <string name="quantity" value="intensity"/>
    <string name="incident" value="light"/>
</bsdf>)"}});

}  // namespace
}  // namespace aureole

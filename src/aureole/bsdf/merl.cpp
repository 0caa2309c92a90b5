// SPDX-License-Identifier: Apache-2.0
// Isotropic measured BRDFs of the MERL database: W. Matusik, H. Pfister, M. Brand and L. McMillan, "A data-driven
// reflectance model", ACM TOG 22(3), 2003.
#include <fmt/format.h>

#include <optional>

#include "aureole/bsdf/bsdf.h"
#include "aureole/bsdf/measured/half_vector_density.h"
#include "aureole/bsdf/measured/incident_side.h"
#include "aureole/bsdf/measured/merl_table.h"
#include "aureole/bsdf/measured/set_sample.h"
#include "aureole/plugin/registry.h"
#include "aureole/plugin/table_holder.h"
#include "aureole/spectrum/rgb_primaries.h"

namespace aureole {
namespace {

class Merl final : public Bsdf, public TableHolder {
public:
  explicit Merl(const Properties& properties)
      : Bsdf(properties),
        incident_(IncidentSide::from(properties)),
        is_linear_(properties.get_choice("interpolation", "linear", {"linear", "nearest"}) == "linear"),
        primaries_(rgb_primaries(properties.context().grid)) {
    const std::filesystem::path file = properties.get_file("filename");
    if (file.empty()) return;
    table_ = properties.tolerate(std::shared_ptr<const MerlTable>(),
                                 [&] { return std::make_shared<const MerlTable>(file); });
    if (!table_) return;
    if (table_->missing() > 0)
      properties.note("filename",
                      fmt::format("parameter \"filename\": {} of {} bins have negative values, that is, no "
                                  "measurement; they are black",
                                  table_->missing(), table_->bins()));
    density_ = std::make_shared<const HalfVectorDensity>(
        HalfVectorDensity::Resolution{}, [&](const Vec3& wi, const Vec3& wo) {
          const std::array<float, 3> c = table_->rgb(wi, wo, is_linear_);
          return (c[0] + c[1] + c[2]) / 3 * wo.z;
        });
    if (const std::string note = energy_note(density_->energies()); !note.empty())
      properties.note("filename", "parameter \"filename\": " + note);
  }

  BsdfEval eval_pdf(const Vec3& wi, const Vec3& wo, const BsdfContext& ctx) const override {
    if (!(wi.z > 0 && wo.z > 0)) return {};
    return {eval(wi, wo, ctx), density_->pdf(wi, wo)};
  }

  Spectrum eval(const Vec3& wi, const Vec3& wo, const BsdfContext& ctx) const override {
    if (!(wi.z > 0 && wo.z > 0)) return 0.f;
    const bool exchanged = incident_.is_exchanged(ctx);
    const std::array<float, 3> c = table_->rgb(exchanged ? wo : wi, exchanged ? wi : wo, is_linear_);
    return rgb_spectrum(primaries_, c, ctx.wavelengths) * wo.z;
  }

  std::optional<BsdfSample> sample(const Vec3& wi, float, Vec2 u2, const BsdfContext& ctx) const override {
    std::optional<BsdfSample> result;
    if (!(wi.z > 0)) return result;
    const Vec3 wo = density_->sample(wi, u2);
    if (!(wo.z > 0)) return result;
    set_sample(*this, wi, wo, ctx, lobes(), result);
    return result;
  }

  bool needs_tangent() const override { return false; }
  bool needs_choice() const override { return false; }
  bool is_constant() const override { return true; }
  Lobe lobes() const override { return Lobe::glossy | Lobe::reflect; }
  Tables tables() const override { return {table_.get(), table_ ? table_->bytes() + density_->bytes() : 0}; }

private:
  IncidentSide incident_;
  bool is_linear_;
  std::array<SampledSpectrum, 3> primaries_;
  std::shared_ptr<const MerlTable> table_;  ///< table of the file; null after an error
  std::shared_ptr<const HalfVectorDensity> density_;
};

AUREOLE_PLUGIN(
    Merl, "bsdf", "merl",
    PluginDoc{
        "An isotropic measured surface in the format of the MERL database: 90 x 90 x 180 bins of linear sRGB "
        "over half and difference angles, or 360 for a full circle of phi_d. Colours become smooth spectra. "
        "Bins without a measurement are black, with a note. It reflects on the side of its normal and is "
        "black on the other; `twosided` makes both sides alike.",
        "W. Matusik, H. Pfister, M. Brand, L. McMillan, A data-driven reflectance model, ACM TOG 22(3), 2003",
        {{"filename", "file", "", "required", "a .binary file"},
         {"interpolation", "string", "", "linear",
          "linear between the centres of the bins, or nearest: the value of the bin, as the database's own "
          "program reads it"},
         IncidentSide::documentation()},
        {R"(<bsdf type="merl">
    <string name="filename" value="small_merl.binary"/>
</bsdf>)",
         R"(<bsdf type="merl">
    <string name="filename" value="small_merl.binary"/>
    <string name="interpolation" value="nearest"/>
    <string name="incident" value="light"/>
</bsdf>)"}});

}  // namespace
}  // namespace aureole

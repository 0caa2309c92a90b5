// SPDX-License-Identifier: Apache-2.0
// Measured BRDFs of RGL's material database, with the sampling density of their parametrisation: J. Dupuy and W. Jakob,
// "An adaptive parameterization for efficient material acquisition and rendering", ACM TOG 37(6), 2018.
#include <fmt/format.h>

#include <optional>

#include "aureole/bsdf/bsdf.h"
#include "aureole/bsdf/measured/incident_side.h"
#include "aureole/bsdf/measured/rgl_file.h"
#include "aureole/bsdf/measured/rgl_table.h"
#include "aureole/bsdf/measured/set_sample.h"
#include "aureole/parameter/data_range.h"
#include "aureole/plugin/registry.h"
#include "aureole/plugin/table_holder.h"

namespace aureole {
namespace {

class Measured final : public Bsdf, public TableHolder {
public:
  explicit Measured(const Properties& properties)
      : Bsdf(properties), incident_(IncidentSide::from(properties)) {
    const std::filesystem::path file = properties.get_file("filename");
    if (file.empty()) return;
    properties.tolerate(0, [&] {
      RglNotes notes;
      const RglFile content = read_rgl_file(file, notes);
      if (notes.negative_spectra > 0)
        properties.note(
            "filename",
            fmt::format(
                "parameter \"filename\": {} of {} values are negative; where the interpolated value is "
                "negative, it counts as 0",
                notes.negative_spectra, content.spectra.size()));
      if (content.nm.empty())
        properties.note(
            "filename",
            "parameter \"filename\": the file has colours (linear sRGB), not spectra; they become smooth spectra");
      else
        note_data_range(properties, "filename", "the material",
                        {double(content.nm.front()), double(content.nm.back())});
      try {
        table_ = std::make_shared<const RglTable>(content, properties.context().grid);
      } catch (const Error& e) {
        throw properties.error("filename", file.filename().string() + ": " + e.message());
      }
      return 0;
    });
  }

  BsdfEval eval_pdf(const Vec3& wi, const Vec3& wo, const BsdfContext& ctx) const override {
    if (!(wi.z > 0 && wo.z > 0)) return {};
    if (!incident_.is_exchanged(ctx)) return table_->eval_pdf(wi, wo, ctx.wavelengths);
    return {table_->value(wo, wi, ctx.wavelengths) * (wo.z / wi.z), table_->pdf(wi, wo)};
  }

  Spectrum eval(const Vec3& wi, const Vec3& wo, const BsdfContext& ctx) const override {
    if (!(wi.z > 0 && wo.z > 0)) return 0.f;
    if (!incident_.is_exchanged(ctx)) return table_->value(wi, wo, ctx.wavelengths);
    return table_->value(wo, wi, ctx.wavelengths) * (wo.z / wi.z);
  }

  std::optional<BsdfSample> sample(const Vec3& wi, float, Vec2 u2, const BsdfContext& ctx) const override {
    std::optional<BsdfSample> result;
    if (!(wi.z > 0)) return result;
    const Vec3 wo = table_->sample(wi, u2);
    if (!(wo.z > 0)) return result;
    set_sample(*this, wi, wo, ctx, lobes(), result);
    return result;
  }

  bool needs_tangent() const override { return table_ && table_->depends_on_azimuth(); }
  bool needs_choice() const override { return false; }
  bool is_constant() const override { return true; }
  Lobe lobes() const override { return Lobe::glossy | Lobe::reflect; }
  Tables tables() const override { return {table_.get(), table_ ? table_->bytes() : 0}; }

private:
  IncidentSide incident_;
  std::shared_ptr<const RglTable> table_;  ///< table of the file; null after an error
};

AUREOLE_PLUGIN(
    Measured, "bsdf", "measured",
    PluginDoc{
        "A measured reflective surface, isotropic or anisotropic, from a `.bsdf` file of RGL's material "
        "database, with spectra or colours; `aureole convert-bsdf` writes such files. Directions are sampled "
        "by the file's own density, which follows its lobes. It reflects on the side of its normal and is "
        "black on the other; `twosided` makes both sides alike.",
        "J. Dupuy, W. Jakob, An adaptive parameterization for efficient material acquisition and rendering, "
        "ACM TOG 37(6), 2018",
        {{"filename", "file", "", "required", "a .bsdf file"}, IncidentSide::documentation()},
        {R"(<bsdf type="measured">
    <string name="filename" value="golden_paint.bsdf"/>
</bsdf>)",
         R"(<bsdf type="measured">
    <string name="filename" value="brushed_rgb.bsdf"/>
    <string name="incident" value="light"/>
</bsdf>)"}});

}  // namespace
}  // namespace aureole

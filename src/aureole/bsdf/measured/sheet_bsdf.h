// SPDX-License-Identifier: Apache-2.0
// A BSDF of a sheet with separately measured reflection and transmission of both sides, and the notes about
// its file.
#pragma once

#include <array>
#include <optional>

#include "aureole/bsdf/bsdf.h"
#include "aureole/bsdf/measured/incident_side.h"
#include "aureole/bsdf/measured/klems_matrix.h"
#include "aureole/bsdf/measured/set_sample.h"
#include "aureole/math/warp.h"
#include "aureole/plugin/table_holder.h"
#include "aureole/spectrum/rgb_primaries.h"

namespace aureole {

/// Probability of cosine-distributed directions to both sides, which bounds value / pdf where light and view are
/// exchanged in a table that is not quite reciprocal.
inline constexpr float kSheetCosinePart = 0.05f;

/// `Sheet` answers for directions that are mirrored to positive z. Side 0 faces +z.
///   f(side, transmitted, i, o)             scattering of light from i on that side, three channels [1/sr]
///   pdf(side, transmitted, i, o)           [1/sr] of `sample`
///   sample(side, i, u1, u2, transmitted)   a direction distributed as f cos(theta_o), or nothing
///   is_coloured, needs_tangent, bytes
template <class Sheet>
class SheetBsdf : public Bsdf, public TableHolder {
public:
  SheetBsdf(const Properties& properties, std::shared_ptr<const Sheet> sheet)
      : Bsdf(properties),
        sheet_(std::move(sheet)),
        incident_(IncidentSide::from(properties)),
        primaries_(rgb_primaries(properties.context().grid)) {}

  BsdfEval eval_pdf(const Vec3& wi, const Vec3& wo, const BsdfContext& ctx) const override {
    if (wi.z == 0 || wo.z == 0) return {};
    const bool transmitted = (wi.z > 0) != (wo.z > 0);
    const float table = sheet_->pdf(side(wi), transmitted, up(wi), up(wo));
    return {eval(wi, wo, ctx),
            (1 - kSheetCosinePart) * table + 0.5f * kSheetCosinePart * cosine_hemisphere_pdf(std::abs(wo.z))};
  }

  Spectrum eval(const Vec3& wi, const Vec3& wo, const BsdfContext& ctx) const override {
    if (wi.z == 0 || wo.z == 0) return 0.f;
    const bool transmitted = (wi.z > 0) != (wo.z > 0);
    const Vec3 &i = incident_.is_exchanged(ctx) ? wo : wi, &o = incident_.is_exchanged(ctx) ? wi : wo;
    const std::array<float, 3> c = sheet_->f(side(i), transmitted, up(i), up(o));
    if (!sheet_->is_coloured()) return c[0] * std::abs(wo.z);
    return rgb_spectrum(primaries_, c, ctx.wavelengths) * std::abs(wo.z);
  }

  std::optional<BsdfSample> sample(const Vec3& wi, float u1, Vec2 u2, const BsdfContext& ctx) const override {
    std::optional<BsdfSample> result;
    if (wi.z == 0) return result;
    Vec3 wo;
    bool transmitted = false;
    if (u1 < kSheetCosinePart) {
      transmitted = u1 >= 0.5f * kSheetCosinePart;
      wo = square_to_cosine_hemisphere(u2);
    } else {
      const auto found = sheet_->sample(side(wi), up(wi), remap_above(u1, kSheetCosinePart), u2, transmitted);
      if (!found) return result;
      wo = *found;
    }
    if (!(wo.z > 0)) return result;
    if ((wi.z > 0) == transmitted) wo.z = -wo.z;
    set_sample(*this, wi, wo, ctx, Lobe::glossy | (transmitted ? Lobe::transmit : Lobe::reflect), result);
    return result;
  }

  bool needs_tangent() const override { return sheet_ && sheet_->needs_tangent(); }
  bool is_constant() const override { return true; }
  Lobe lobes() const override { return Lobe::glossy | Lobe::reflect | Lobe::transmit; }
  Tables tables() const override { return {sheet_.get(), sheet_ ? sheet_->bytes() : 0}; }

private:
  static int side(const Vec3& w) { return w.z > 0 ? 0 : 1; }
  static Vec3 up(const Vec3& w) { return {w.x, w.y, std::abs(w.z)}; }

  std::shared_ptr<const Sheet> sheet_;  ///< table of the sheet; null after an error
  IncidentSide incident_;
  std::array<SampledSpectrum, 3> primaries_;
};

/// Notes the parts of a file that are not used, and the data that replace missing parts.
void note_window_file(const Properties& properties, const WindowFile& file, const WindowNotes& notes,
                      bool is_coloured);

/// Reads the file of the parameter `filename` and makes a sheet of it by `make(file, notes)`; null after an error.
/// `expects_tree` says which structure is wanted; the other one is an error that names `other`, its plug-in.
template <class Sheet, class Make>
std::shared_ptr<const Sheet> read_sheet(const Properties& properties, bool expects_tree, const char* other,
                                        Make&& make) {
  return properties.tolerate(std::shared_ptr<const Sheet>(), [&]() -> std::shared_ptr<const Sheet> {
    const auto file = read_window_file(properties.get_file("filename"));
    if (file->is_tree() != expects_tree)
      throw Error(file->structure_where, std::string("the file has ") +
                                             (expects_tree ? "matrices of patches" : "a tensor tree") +
                                             ", which the BSDF \"" + other + "\" reads");
    WindowNotes notes;
    auto sheet = std::make_shared<const Sheet>(make(*file, notes));
    note_window_file(properties, *file, notes, sheet->is_coloured());
    return sheet;
  });
}

}  // namespace aureole

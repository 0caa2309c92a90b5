// SPDX-License-Identifier: Apache-2.0
// One number, or three that are not a colour, constant over the surface.
#include <algorithm>

#include "aureole/plugin/registry.h"
#include "aureole/texture/texture.h"

namespace aureole {
namespace {

class RawConstant final : public Texture {
public:
  explicit RawConstant(const Properties& p) : Texture(p), grid_(p.context().grid) {
    const Properties::Entry* e = p.find("value");
    if (!e) throw p.error("value", "needs the parameter \"value\"");
    if (std::holds_alternative<Vec3>(e->value)) {
      numbers_ = p.get_vec3("value", {});
      has_three_ = true;
      value_ = 0.2126f * numbers_.x + 0.7152f * numbers_.y + 0.0722f * numbers_.z;
    } else {
      value_ = float(p.get_float("value", Range{}));
      numbers_ = {value_, value_, value_};
    }
  }

  Spectrum eval(const SurfacePoint&, const Wavelengths&) const override { return value_; }
  float eval_scalar(const SurfacePoint&) const override { return value_; }
  Vec2 gradient(const SurfacePoint&) const override { return {}; }
  Vec3 eval_rgb(const SurfacePoint&) const override { return numbers_; }
  bool has_rgb() const override { return has_three_; }
  SampledSpectrum average(const Shape*) const override { return SampledSpectrum::constant(grid_, value_); }
  bool is_constant() const override { return true; }
  float maximum() const override { return value_; }
  float minimum() const override { return value_; }

private:
  SpectralGrid grid_;
  Vec3 numbers_;
  bool has_three_ = false;
  float value_ = 0;
};

AUREOLE_PLUGIN(
    RawConstant, "texture", "rawconstant",
    PluginDoc{
        "One number, or three that are not a colour, such as a normal for `normalmap`. Where a spectrum "
        "or a single number is needed, three numbers are replaced by their luminance.",
        "",
        {{"value", "float or vector", "", "required", "the number or the three numbers"}},
        {R"(<texture type="rawconstant"><float name="value" value="0.4"/></texture>)",
         R"(<texture type="rawconstant"><vector name="value" value="0.5, 0.6, 0.9"/></texture>)"}});

}  // namespace
}  // namespace aureole

// SPDX-License-Identifier: Apache-2.0
// CIE illuminant D65, alone or multiplied by a colour or another texture.
#include "aureole/plugin/registry.h"
#include "aureole/spectrum/observer.h"
#include "aureole/texture/constant_texture.h"

namespace aureole {
namespace {

class D65 final : public Texture {
public:
  explicit D65(const Properties& properties)
      : Texture(properties),
        d65_(d65_spectrum(properties.context().grid,
                          properties.get_float("scale", 1, Range::non_negative()))) {
    const auto nested = properties.get_children<Texture>("texture");
    if (nested.size() > 1) throw Error(properties.where(), "\"d65\" takes one nested texture at most");
    if (!nested.empty()) nested_ = nested.front();
    if (nested_)
      if (TexturePtr filter = nested_->in_role(SpectrumRole::response)) nested_ = std::move(filter);
    if (properties.find("color")) {
      if (nested_) throw properties.error("color", "give either a color or a nested texture, not both");
      multiply(spectrum_of_rgb(d65_.grid(), get_rgb(properties, "color", true).rgb, true));
    }
    if (nested_ && nested_->is_constant()) {
      multiply(nested_->average());
      nested_ = nullptr;
    }
  }

  Spectrum eval(const SurfacePoint& point, const Wavelengths& w) const override {
    const Spectrum d65 = d65_.eval(w);
    return nested_ ? d65 * nested_->eval(point, w) : d65;
  }
  SampledSpectrum average(const Shape* shape) const override {
    return nested_ ? product(d65_, nested_->average(shape)) : d65_;
  }
  bool is_constant() const override { return !nested_; }
  float maximum() const override { return d65_.maximum() * (nested_ ? nested_->maximum() : 1); }
  float minimum() const override { return d65_.minimum() * (nested_ ? nested_->minimum() : 1); }
  std::pair<int, int> resolution() const override {
    return nested_ ? nested_->resolution() : std::pair{1, 1};
  }

private:
  void multiply(const SampledSpectrum& s) { d65_ = product(d65_, s); }

  SampledSpectrum d65_;
  TexturePtr nested_;
};

AUREOLE_PLUGIN(D65, "texture", "d65",
               PluginDoc{"CIE standard illuminant D65, average daylight, with the luminance of a flat "
                         "spectrum of value one. Plain numbers and rgb colours of emitters multiply this "
                         "spectrum. A nested texture turns a picture into an emission.",
                         "CIE 15:2004, Colorimetry",
                         {{"scale", "float", "", "1", "factor"},
                          {"color", "rgb", "", "1, 1, 1",
                           "linear sRGB colour that multiplies the illuminant; may exceed one"},
                          {"texture", "texture", "", "none",
                           "a nested texture, under any name, that multiplies the illuminant"}},
                         {R"(<spectrum type="d65">
    <float name="scale" value="3"/>
    <rgb name="color" value="2, 1.4, 0.6"/>
</spectrum>)",
                          R"(<texture type="d65">
    <texture type="checkerboard"/>
</texture>)"}});

}  // namespace
}  // namespace aureole

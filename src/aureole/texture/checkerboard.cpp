// SPDX-License-Identifier: Apache-2.0
// Two textures in alternating squares of half a unit of uv.
#include <cmath>

#include "aureole/plugin/registry.h"
#include "aureole/texture/texture.h"
#include "aureole/texture/uv_transform.h"

namespace aureole {
namespace {

class Checkerboard final : public Texture {
public:
  /// The use of the texture decides whether its colours are reflectances or emissions.
  explicit Checkerboard(const Properties& properties, SpectrumRole role = SpectrumRole::unbounded)
      : Texture(properties),
        role_(role),
        color0_(get_texture(properties, "color0", 0.4, role)),
        color1_(get_texture(properties, "color1", 0.2, role)),
        to_uv_(properties.get_transform("to_uv")) {}

  Spectrum eval(const SurfacePoint& point, const Wavelengths& w) const override {
    return square(point).eval(point, w);
  }
  float eval_scalar(const SurfacePoint& point) const override { return square(point).eval_scalar(point); }
  Vec2 gradient(const SurfacePoint& point) const override { return square(point).gradient(point); }
  bool has_gradient() const override { return color0_->has_gradient() && color1_->has_gradient(); }
  SampledSpectrum average(const Shape* shape) const override {
    const SampledSpectrum a = color0_->average(shape), b = color1_->average(shape);
    std::vector<float> nodes(a.nodes().size());
    for (std::size_t i = 0; i < nodes.size(); ++i) nodes[i] = 0.5f * (a.nodes()[i] + b.nodes()[i]);
    return {a.grid(), std::move(nodes)};
  }
  float maximum() const override { return std::max(color0_->maximum(), color1_->maximum()); }
  float minimum() const override { return std::min(color0_->minimum(), color1_->minimum()); }
  void note_ends(const Properties&, std::string_view) const override {
    color0_->note_ends(properties(), "color0"), color1_->note_ends(properties(), "color1");
  }
  TexturePtr in_role(SpectrumRole role) const override {
    return role == role_ ? nullptr : std::make_shared<const Checkerboard>(properties(), role);
  }

private:
  const Texture& square(const SurfacePoint& point) const {
    const Vec2 uv = to_uv_(point.uv);
    const bool u = uv.x - std::floor(uv.x) > 0.5f, v = uv.y - std::floor(uv.y) > 0.5f;
    return u == v ? *color0_ : *color1_;
  }

  SpectrumRole role_;
  TexturePtr color0_, color1_;
  UvTransform to_uv_;
};

AUREOLE_PLUGIN(Checkerboard, "texture", "checkerboard",
               PluginDoc{
                   "Two colours or textures in alternating squares, two by two per unit of uv. The use of "
                   "the texture decides whether numbers and colours are reflectances or emissions.",
                   "",
                   {{"color0", "texture", "", "0.4", "the squares at uv = (0, 0) and (0.5, 0.5)"},
                    {"color1", "texture", "", "0.2", "the other squares"},
                    {"to_uv", "transform", "", "identity",
                     "transform of uv before the look-up; larger scales give smaller squares"}},
                   {R"(<texture type="checkerboard">
    <rgb name="color0" value="0.1, 0.1, 0.1"/>
    <rgb name="color1" value="0.5, 0.5, 0.5"/>
    <transform name="to_uv">
        <scale x="10" y="10"/>
    </transform>
</texture>)"}});

}  // namespace
}  // namespace aureole

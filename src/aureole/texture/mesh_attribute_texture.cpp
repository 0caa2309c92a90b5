// SPDX-License-Identifier: Apache-2.0
// A texture that shows an attribute of its mesh, such as vertex colours.
#include <algorithm>

#include "aureole/plugin/registry.h"
#include "aureole/shape/shape.h"
#include "aureole/texture/texture.h"

namespace aureole {
namespace {

class MeshAttributeTexture final : public AttributeTexture {
public:
  explicit MeshAttributeTexture(const Properties& properties)
      : AttributeTexture(properties),
        name_(properties.get_string("name")),
        scale_(float(properties.get_float("scale", 1, Range::non_negative()))) {
    const std::string& name = name_.text();
    if (!name.starts_with("vertex_") && !name.starts_with("face_"))
      throw properties.error(
          "name", "an attribute's name starts with \"vertex_\" or \"face_\", got \"" + name + "\"");
  }

  Spectrum eval(const SurfacePoint& point, const Wavelengths& w) const override {
    const MeshAttribute* attribute = point.shape ? point.shape->attribute(name_) : nullptr;
    return attribute ? point.shape->eval_attribute(*attribute, point, w) * scale_ : Spectrum(0.f);
  }
  SampledSpectrum average(const Shape* shape) const override {
    const SpectralGrid& grid = properties().context().grid;
    const MeshAttribute* attribute = shape ? shape->attribute(name_) : nullptr;
    if (!attribute) return SampledSpectrum::constant(grid, 0.5f * scale_);
    SampledSpectrum mean = attribute->mean(grid);
    mean.scale(scale_);
    return mean;
  }
  // Returns the bound of a reflectance, because the mesh and the range of its attribute are not known yet.
  float maximum() const override { return std::min(scale_, 1.f); }
  float minimum() const override { return 0; }

  const AttributeName& attribute_name() const override { return name_; }
  void check(const MeshAttribute& attribute, double most) const override {
    constexpr float kRounding = 1e-5f;
    const auto [minimum, maximum] = attribute.range();
    if (minimum < 0)
      throw properties().error(
          "name", "\"" + name_.text() + "\" has negative values, down to " + std::to_string(minimum));
    if (double(maximum * scale_) > most + double(kRounding))
      throw properties().error("name", "a reflectance or transmittance lies in [0, 1], but \"" +
                                           name_.text() + "\" goes up to " + std::to_string(maximum) +
                                           "; give a smaller scale");
  }

private:
  AttributeName name_;
  float scale_;
};

AUREOLE_PLUGIN(MeshAttributeTexture, "texture", "mesh_attribute",
               PluginDoc{
                   "An attribute of the mesh it is on: `vertex_...` is interpolated over the triangles, "
                   "`face_...` is constant on each face. Attributes with one component have equal values "
                   "at all wavelengths. Attributes with three components are colours, upsampled to "
                   "spectra, which are interpolated. The shape `ply` documents the attributes of a file.",
                   "",
                   {{"name", "string", "", "required", "the attribute, such as vertex_color or face_color"},
                    {"scale", "float", "", "1", "multiplies the values"}},
                   {R"(<texture type="mesh_attribute">
    <string name="name" value="vertex_color"/>
    <float name="scale" value="0.8"/>
</texture>)"}});

}  // namespace
}  // namespace aureole

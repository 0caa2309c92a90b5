// SPDX-License-Identifier: Apache-2.0
// Shows an attribute of the mesh that it is on, such as the colours of its vertices.
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
    if (!name_.starts_with("vertex_") && !name_.starts_with("face_"))
      throw properties.error(
          "name", "an attribute's name starts with \"vertex_\" or \"face_\", got \"" + name_ + "\"");
  }

  Spectrum eval(const SurfacePoint& point, const Wavelengths& w) const override {
    return point.shape ? point.shape->attribute(*this, point, w) * scale_ : Spectrum(0.f);
  }
  SampledSpectrum average() const override {
    const SpectralGrid& grid = properties().context().grid;
    if (sum_.empty()) return SampledSpectrum::constant(grid, 0.5f * scale_);
    std::vector<float> nodes = sum_;
    for (float& v : nodes) v *= scale_ / float(meshes_);
    return {grid, std::move(nodes)};
  }
  // Before a mesh is attached, what a reflectance may have.
  float maximum() const override { return meshes_ ? maximum_ * scale_ : std::min(scale_, 1.f); }
  float minimum() const override { return meshes_ ? minimum_ * scale_ : 0; }
  void used_as(SpectrumRole role) const override { is_reflectance_ |= role == SpectrumRole::reflectance; }

  const std::string& attribute_name() const override { return name_; }
  void attach(float minimum, float maximum, const SampledSpectrum& mean) const override {
    constexpr float kRounding = 1e-5f;
    if (minimum < 0)
      throw properties().error("name",
                               "\"" + name_ + "\" has negative values, down to " + std::to_string(minimum));
    if (is_reflectance_ && maximum * scale_ > 1 + kRounding)
      throw properties().error("name", "a reflectance or transmittance lies in [0, 1], but \"" + name_ +
                                           "\" goes up to " + std::to_string(maximum) +
                                           "; give a smaller scale");
    minimum_ = meshes_ ? std::min(minimum_, minimum) : minimum;
    maximum_ = std::max(maximum_, maximum);
    sum_.resize(mean.nodes().size());
    for (std::size_t i = 0; i < sum_.size(); ++i) sum_[i] += mean.nodes()[i];
    ++meshes_;
  }

private:
  std::string name_;
  float scale_;
  // Known when the meshes are built, which comes after the textures.
  mutable bool is_reflectance_ = false;
  mutable int meshes_ = 0;
  mutable float minimum_ = 0, maximum_ = 0;
  mutable std::vector<float> sum_;  ///< of the meshes' means
};

AUREOLE_PLUGIN(MeshAttributeTexture, "texture", "mesh_attribute",
               PluginDoc{
                   "An attribute of the mesh it is on: `vertex_...` is interpolated over the triangles, "
                   "`face_...` is constant "
                   "on each face. Attributes of one component are the same at every wavelength; those of "
                   "three are colours, "
                   "upsampled to spectra, which are interpolated. `ply` says which attributes a file has.",
                   "",
                   {{"name", "string", "", "required", "the attribute, such as vertex_color or face_color"},
                    {"scale", "float", "", "1", "multiplies the values"}},
                   {R"(<texture type="mesh_attribute">
    <string name="name" value="vertex_color"/>
    <float name="scale" value="0.8"/>
</texture>)"}});

}  // namespace
}  // namespace aureole

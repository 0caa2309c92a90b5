// SPDX-License-Identifier: Apache-2.0
// A solid texture: the values of a volume at the points of a surface.
#include <algorithm>
#include <vector>

#include "aureole/plugin/registry.h"
#include "aureole/shape/shape.h"
#include "aureole/texture/texture.h"
#include "aureole/volume/volume.h"

namespace aureole {
namespace {

class VolumeTexture final : public Texture {
public:
  /// The use of the texture decides whether its numbers and colours are reflectances or emissions.
  explicit VolumeTexture(const Properties& p, SpectrumRole role = SpectrumRole::unbounded)
      : Texture(p), role_(role), volume_(get_optional_volume(p, "volume", role)) {
    if (!volume_) throw p.error("volume", "needs the parameter \"volume\"");
  }

  Spectrum eval(const SurfacePoint& point, const Wavelengths& w) const override {
    return volume_->eval(place(point), w);
  }
  float eval_scalar(const SurfacePoint& point) const override { return volume_->eval_scalar(place(point)); }
  bool has_gradient() const override { return volume_->is_constant(); }
  SampledSpectrum average(const Shape* shape) const override;
  bool is_constant() const override { return volume_->is_constant(); }
  float maximum() const override { return volume_->maximum(); }
  float minimum() const override { return volume_->minimum(); }
  void note_ends(const Properties&, std::string_view) const override { volume_->note_ends(); }
  TexturePtr in_role(SpectrumRole role) const override {
    return role == role_ ? nullptr : std::make_shared<const VolumeTexture>(properties(), role);
  }

private:
  /// The volume belongs to the group of an instanced shape, and moves with it.
  Vec3 place(const SurfacePoint& point) const {
    return point.instance && !volume_->is_constant() ? point.instance->point_to_group(point.p, point.time)
                                                     : point.p;
  }

  SpectrumRole role_;
  VolumePtr volume_;
};

/// The mean over a lattice in the box around the shape or, without a shape, around the data. A fraction of
/// the maximum is added for values between its points, so that emission there is not missed.
SampledSpectrum VolumeTexture::average(const Shape* shape) const {
  constexpr int kPoints = 6;
  constexpr float kBetween = 0.01f;
  const SpectralGrid& grid = properties().context().grid;
  Bounds3 box{{0, 0, 0}, {1, 1, 1}};
  Transform to_world;
  if (shape)
    box = shape->bounds();
  else if (const auto to_box = volume_->to_box())
    to_world = to_box->inverse();
  std::vector<float> nodes(std::size_t(grid.cells) + 1, kBetween * volume_->maximum());
  const int n = volume_->is_constant() ? 1 : kPoints;
  const float share = (1 - kBetween) / float(n * n * n);
  for (int node = 0; node <= grid.cells; node += kWavelengths) {
    const Wavelengths w = Wavelengths::at(
        grid, make_spectrum([&](int i) { return float(grid.node(std::min(node + i, grid.cells))); }));
    Spectrum sum = 0.f;
    for (int i = 0; i < n * n * n; ++i) {
      const Vec3 at{(float(i % n) + 0.5f) / float(n), (float(i / n % n) + 0.5f) / float(n),
                    (float(i / (n * n)) + 0.5f) / float(n)};
      sum += volume_->eval(to_world.point(box.lower + box.diagonal() * at), w);
    }
    for (int i = 0; i < kWavelengths && node + i <= grid.cells; ++i)
      nodes[std::size_t(node + i)] += share * sum[i];
  }
  return {grid, std::move(nodes)};
}

AUREOLE_PLUGIN(
    VolumeTexture, "texture", "volume",
    PluginDoc{"A solid texture: the value of a `volume` at each point of a surface. The use of the texture "
              "decides whether numbers and colours are reflectances or emissions. On a shape of a group the "
              "volume has the group's coordinates, so that it moves with every instance.",
              "",
              {{"volume", "volume", "", "required", "the volume, such as a `gridvolume`"}},
              {R"(<texture type="volume">
    <volume type="gridvolume" name="volume">
        <string name="filename" value="smoke.vol"/>
    </volume>
</texture>)"}});

}  // namespace
}  // namespace aureole

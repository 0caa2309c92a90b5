// SPDX-License-Identifier: Apache-2.0
#include "aureole/volume/volume.h"

#include <fmt/format.h>

#include "aureole/plugin/registry.h"
#include "aureole/spectrum/observer.h"
#include "aureole/spectrum/value_limit.h"
#include "aureole/volume/constant_volume.h"

namespace aureole {

namespace {

/// The product of another volume and CIE D65.
class Illuminated final : public Volume {
public:
  Illuminated(const Properties& properties, std::shared_ptr<const Volume> volume)
      : Volume(properties), volume_(std::move(volume)), d65_(d65_spectrum(properties.context().grid, 1)) {}

  Spectrum eval(const Vec3& p, const Wavelengths& w) const override {
    return volume_->eval(p, w) * d65_.eval(w);
  }
  float eval_scalar(const Vec3& p) const override {
    const SpectralGrid& grid = d65_.grid();
    const Spectrum nm = make_spectrum(
        [&](int i) { return float(grid.min_nm + (grid.max_nm - grid.min_nm) * (i + 0.5) / kWavelengths); });
    return mean(eval(p, Wavelengths::at(grid, nm)));
  }
  bool is_constant() const override { return volume_->is_constant(); }
  float maximum() const override { return volume_->maximum() * d65_.maximum(); }
  float minimum() const override { return volume_->minimum() * d65_.minimum(); }
  std::optional<Transform> to_box() const override { return volume_->to_box(); }
  std::array<int, 3> resolution() const override { return volume_->resolution(); }
  void bound(const std::array<int, 3>& cells, std::span<float> bounds) const override {
    volume_->bound(cells, bounds);
  }
  Spectrum envelope(const Wavelengths& w) const override { return volume_->envelope(w) * d65_.eval(w); }

private:
  std::shared_ptr<const Volume> volume_;
  SampledSpectrum d65_;
};

}  // namespace

VolumePtr get_optional_volume(const Properties& properties, std::string_view name, SpectrumRole role) {
  const Properties::Entry* e = properties.find(name);
  if (!e) return nullptr;
  const auto* object = std::get_if<ObjectPtr>(&e->value);
  if (!object || !std::dynamic_pointer_cast<const Volume>(*object)) {
    TexturePtr value = get_optional_texture(properties, name, role);
    if (!value->is_constant())
      throw properties.error(name, "a texture that varies over a surface has no value inside a volume");
    return std::make_shared<ConstantVolume>(properties, std::move(value));
  }
  auto volume = std::dynamic_pointer_cast<const Volume>(*object);
  volume->prepare();
  if (volume->channels() != 1)
    throw properties.error(name,
                           fmt::format("needs one number or a colour at each point, but the volume has {} "
                                       "numbers that are no colours",
                                       volume->channels()));
  constexpr float kTolerance = 1e-4f;  // margin for the rounding of upsampled colours
  if (volume->minimum() < 0)
    throw properties.error(
        name, fmt::format("must not be negative, but the volume goes down to {:.6g}", volume->minimum()));
  if (!(double(volume->maximum()) <= kLargestSpectrumValue))
    throw properties.error(name, "the volume has values too large to be computed with: 1e37 is the most");
  if (role == SpectrumRole::reflectance && volume->maximum() > 1 + kTolerance)
    throw properties.error(
        name, fmt::format("must lie in [0, 1], but the volume goes up to {:.6g}", volume->maximum()));
  if (VolumePtr meant = volume->in_role(role))
    volume = std::move(meant);
  else if (role == SpectrumRole::emission)
    return std::make_shared<Illuminated>(properties, volume);
  if (ends_of(role) == SpectrumEnds::zero) return volume;
  if (properties.plugin() == nullptr || properties.plugin()->family != "texture") volume->note_ends();
  return volume;
}

VolumePtr get_volume(const Properties& properties, std::string_view name, double fallback,
                     SpectrumRole role) {
  if (VolumePtr volume = get_optional_volume(properties, name, role)) return volume;
  return std::make_shared<ConstantVolume>(properties, get_texture(properties, name, fallback, role));
}

AUREOLE_FAMILY(FamilyInfo{.name = "volume", .is_reusable = true});

}  // namespace aureole

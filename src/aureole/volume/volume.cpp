// SPDX-License-Identifier: Apache-2.0
#include "aureole/volume/volume.h"

#include <fmt/format.h>

#include "aureole/plugin/registry.h"

namespace aureole {

namespace {

/// A texture that is the same everywhere, or a spectrum or number, as a volume.
class ConstantVolume final : public Volume {
public:
  ConstantVolume(const Properties& properties, TexturePtr value)
      : Volume(properties), value_(std::move(value)) {}

  Spectrum eval(const Vec3&, const Wavelengths& w) const override { return value_->eval({}, w); }
  float eval_scalar(const Vec3&) const override { return value_->eval_scalar({}); }
  bool is_constant() const override { return true; }
  float maximum() const override { return value_->maximum(); }
  float minimum() const override { return value_->minimum(); }
  Spectrum envelope(const Wavelengths& w) const override { return value_->eval({}, w); }

private:
  TexturePtr value_;
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
  const auto volume = std::dynamic_pointer_cast<const Volume>(*object);
  constexpr float kTolerance = 1e-4f;  // rounding of upsampled colours
  if (volume->minimum() < 0)
    throw properties.error(
        name, fmt::format("must not be negative, but the volume goes down to {:.6g}", volume->minimum()));
  if (role == SpectrumRole::reflectance && volume->maximum() > 1 + kTolerance)
    throw properties.error(
        name, fmt::format("must lie in [0, 1], but the volume goes up to {:.6g}", volume->maximum()));
  return volume;
}

VolumePtr get_volume(const Properties& properties, std::string_view name, double fallback,
                     SpectrumRole role) {
  if (VolumePtr volume = get_optional_volume(properties, name, role)) return volume;
  return std::make_shared<ConstantVolume>(properties, get_texture(properties, name, fallback, role));
}

AUREOLE_FAMILY(FamilyInfo{.name = "volume", .is_reusable = true});

}  // namespace aureole

// SPDX-License-Identifier: Apache-2.0
// The volume family: quantities that vary in space, such as the extinction or the albedo of a medium.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>

#include "aureole/math/transform.h"
#include "aureole/plugin/object.h"
#include "aureole/plugin/properties.h"
#include "aureole/spectrum/wavelengths.h"
#include "aureole/texture/texture.h"

namespace aureole {

class Volume : public Object {
public:
  static constexpr const char* kFamily = "a volume";
  using Object::Object;

  /// Value at a point of the world at the path's wavelengths.
  virtual Spectrum eval(const Vec3& p, const Wavelengths& wavelengths) const = 0;
  /// The value as one number, for quantities without wavelength (weights, temperatures): of several channels
  /// the first, of a spectrum the mean over the sensor's range.
  virtual float eval_scalar(const Vec3& p) const = 0;
  /// Numbers stored for a point, and these numbers, for quantities that are no colours (directions, matrices):
  /// more than one of them have no spectrum, and `get_volume` takes none such.
  virtual int channels() const { return 1; }
  virtual void eval_channels(const Vec3& p, float* out) const { *out = eval_scalar(p); }

  /// The volume as an emission: numbers and colours multiply CIE D65 there, as those of a scene file do
  /// (SpectrumRole). Null where all values are numbers or upsampled colours, which `get_volume` multiplies.
  virtual std::shared_ptr<const Volume> as_emission() const { return nullptr; }

  /// True where the value does not depend on the point.
  virtual bool is_constant() const { return false; }
  /// Bounds over space and all wavelengths, of all channels.
  virtual float maximum() const = 0;
  virtual float minimum() const = 0;

  /// From the world to the box [0, 1]^3 that the data fill. Nothing where they are everywhere.
  virtual std::optional<Transform> to_box() const { return {}; }
  /// Number of samples along the axes of that box.
  virtual std::array<int, 3> resolution() const { return {1, 1, 1}; }
  /// For each of cells[0] * cells[1] * cells[2] equal parts of the box, x fastest, an upper bound b of the
  /// values in it and on its faces: eval(p, w) <= b * envelope(w).
  virtual void bound(const std::array<int, 3>& /*cells*/, std::span<float> bounds) const {
    for (float& b : bounds) b = 1;
  }
  virtual Spectrum envelope(const Wavelengths& /*w*/) const { return 1.f; }
};
using VolumePtr = std::shared_ptr<const Volume>;

/// The volume, spectrum or number given under `name`; `fallback` where absent. Values that the role excludes
/// (a reflectance above 1, anything negative) are errors located at the parameter, and so is a volume of
/// several numbers per point.
VolumePtr get_volume(const Properties& properties, std::string_view name, double fallback, SpectrumRole role);
/// The same, or null where absent.
VolumePtr get_optional_volume(const Properties& properties, std::string_view name, SpectrumRole role);

}  // namespace aureole

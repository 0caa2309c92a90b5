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

struct ScalarGrid;

class Volume : public Object {
public:
  static constexpr const char* kFamily = "a volume";
  using Object::Object;

  /// Returns the value at a point in world space, at the path's wavelengths.
  virtual Spectrum eval(const Vec3& p, const Wavelengths& wavelengths) const = 0;
  /// Returns the value as one number, for quantities that do not depend on the wavelength (weights,
  /// temperatures): the first of several channels, or a spectrum's mean over the sensor's range.
  virtual float eval_scalar(const Vec3& p) const = 0;
  /// Returns how many numbers are stored for a point; `eval_channels` returns them, for quantities that are
  /// not colours (directions, matrices). Several numbers have no spectrum, and `get_volume` rejects such
  /// volumes.
  virtual int channels() const { return 1; }
  /// Whether the values are colours, which have a spectrum at each point.
  virtual bool has_colors() const { return false; }
  virtual void eval_channels(const Vec3& p, float* out) const { *out = eval_scalar(p); }

  /// Returns the volume with its numbers, colours and spectra interpreted in the given role (`SpectrumRole`).
  /// Null if all values are numbers or upsampled colours, which `get_volume` multiplies by CIE D65 for
  /// emission.
  virtual std::shared_ptr<const Volume> in_role(SpectrumRole) const { return nullptr; }

  /// Notes at which wavelengths of the film the spectrum of the volume has no data, see `Texture::note_ends`.
  virtual void note_ends() const {}

  /// Whether the value is constant in space.
  virtual bool is_constant() const { return false; }
  /// Bounds over space and all wavelengths, of all channels.
  virtual float maximum() const = 0;
  virtual float minimum() const = 0;

  /// Returns the transform from world space to the box [0, 1]^3 that the data fill; empty if there is no box.
  virtual std::optional<Transform> to_box() const { return {}; }
  /// Returns the number of samples along the axes of that box.
  virtual std::array<int, 3> resolution() const { return {1, 1, 1}; }
  /// Sets, for each of cells[0] * cells[1] * cells[2] equal cells of the box, x fastest, an upper bound b of
  /// the values in the cell and on its faces: eval(p, w) <= b * envelope(w).
  virtual void bound(const std::array<int, 3>& /*cells*/, std::span<float> bounds) const {
    for (float& b : bounds) b = 1;
  }
  virtual Spectrum envelope(const Wavelengths& /*w*/) const { return 1.f; }

  /// Returns the numbers as their file stores them, for a volume that has one number at each voxel, uses
  /// these numbers as its values, and whose voxels fill the box; else null.
  virtual std::shared_ptr<const ScalarGrid> stored_grid() const { return nullptr; }
  /// Makes the tables of `eval` and `bound` that are otherwise made at their first call. Throws a located Error.
  virtual void prepare() const {}
};
using VolumePtr = std::shared_ptr<const Volume>;

/// Returns the volume, spectrum or number of the parameter `name`; `fallback` if absent. Values that the role
/// excludes (a reflectance above 1, negative values) are errors located at the parameter, and so is a volume
/// of several numbers per point.
VolumePtr get_volume(const Properties& properties, std::string_view name, double fallback, SpectrumRole role);
/// Returns the volume, spectrum or number of a parameter as `get_volume` does, or null if absent.
VolumePtr get_optional_volume(const Properties& properties, std::string_view name, SpectrumRole role);

}  // namespace aureole

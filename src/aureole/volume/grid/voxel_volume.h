// SPDX-License-Identifier: Apache-2.0
// `VoxelVolume`: a volume with values on a regular grid, from any file format.
#pragma once

#include <atomic>
#include <functional>
#include <mutex>
#include <optional>
#include <vector>

#include "aureole/plugin/registry.h"
#include "aureole/spectrum/upsampled_color.h"
#include "aureole/volume/grid/brick_grid.h"
#include "aureole/volume/volume.h"

namespace aureole {

/// Continuation of the grid beyond its borders.
enum class VoxelWrap { clamp, repeat, mirror };

/// Interpolation and continuation; the parameters filter_type and wrap_mode.
struct VoxelFilter {
  bool nearest = false;
  VoxelWrap wrap = VoxelWrap::clamp;

  static VoxelFilter read(const Properties& properties);
  static VoxelFilter read_without_wrap(const Properties& properties);
  static std::vector<ParameterDoc> rows();
};

/// Values in the box [0, 1]^3, which size[0] * size[1] * size[2] equal voxels fill. The value of a voxel
/// holds at its centre. Between centres the values are interpolated linearly along each axis, or it is
/// constant in each voxel. Colours become spectra voxel by voxel, and the spectra are interpolated.
class VoxelVolume : public Volume {
public:
  Spectrum eval(const Vec3& p, const Wavelengths& w) const final;
  float eval_scalar(const Vec3& p) const final;
  int channels() const final { return numbers_.size() > 1 ? int(numbers_.size()) : 1; }
  bool has_colors() const final { return has_colors_; }
  void eval_channels(const Vec3& p, float* out) const final;
  float maximum() const final { return maximum_; }
  float minimum() const final { return minimum_; }
  std::optional<Transform> to_box() const final { return to_box_; }
  std::array<int, 3> resolution() const final { return size_; }
  void bound(const std::array<int, 3>& cells, std::span<float> bounds) const final;
  Spectrum envelope(const Wavelengths& w) const final;

  void prepare() const final { numbers(); }

  std::size_t memory_bytes() const;

protected:
  using Numbers = BrickGrid<float>;
  using Colors = BrickGrid<UpsampledColor>;

  /// `to_box` must be invertible.
  VoxelVolume(const Properties& properties, const Transform& to_box, const VoxelFilter& filter)
      : Volume(properties), to_box_(to_box), filter_(filter) {}
  /// Sets one grid per number of a voxel: one number is the value, several are numbers that are not colours.
  void set(std::vector<Numbers> numbers);
  void set(Colors colors);
  /// Sets one grid that `make` returns at the first call that needs it, or never. Its values lie in `range`. A located
  /// Error of `make` is thrown by that call.
  void set_later(const std::array<int, 3>& size, const std::array<float, 2>& range,
                 std::function<Numbers()> make);
  bool repeats() const { return filter_.wrap == VoxelWrap::repeat; }

private:
  /// A position in the grid: the lower corner of the eight voxels around it, and the offset from there.
  struct Place {
    int x, y, z;
    float tx, ty, tz;
  };
  Place place(const Vec3& p) const;
  void set_size(const std::array<int, 3>& size);
  template <class Value, class Grid>
  void bound_grid(const Grid& grid, const Value& value, const std::array<int, 3>& cells,
                  std::span<float> bounds) const;

  Transform to_box_;
  VoxelFilter filter_;
  std::array<int, 3> size_{};
  float rows_[3][4];  ///< world space to coordinates in units of voxels
  float slip_[3];     ///< rounding error of these coordinates inside the box
  /// The grids of numbers, which are made at the first call after `set_later`.
  const std::vector<Numbers>& numbers() const {
    if (is_pending_.load(std::memory_order_acquire)) make_numbers();
    return numbers_;
  }
  void make_numbers() const;

  // Either numbers or colours are stored; numbers may still have to be made (`set_later`).
  mutable std::vector<Numbers> numbers_;
  Colors colors_;
  bool has_colors_ = false;
  mutable std::atomic<bool> is_pending_ = false;
  mutable std::mutex making_;
  mutable std::function<Numbers()> make_;
  float minimum_ = 0, maximum_ = 0;
  std::vector<float> envelope_;  ///< largest value of the colours in each of equal wavelength intervals
};

}  // namespace aureole

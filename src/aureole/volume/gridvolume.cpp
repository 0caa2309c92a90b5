// SPDX-License-Identifier: Apache-2.0
// Values on a dense grid, from Mitsuba's format .vol.
#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "aureole/parameter/voxel_data.h"
#include "aureole/spectrum/value_limit.h"
#include "aureole/volume/grid/voxel_volume.h"

namespace aureole {
namespace {

/// Returns the transform from world space to [0, 1]^3.
Transform box_of(const Properties& p, const VoxelData& data) {
  const Transform to_local = p.get_transform("to_world").inverse();
  if (!p.get_bool("use_grid_bbox", false)) return to_local;
  const auto& [x0, y0, z0] = data.lower;
  const auto& [x1, y1, z1] = data.upper;
  return Transform::scale(1 / (x1 - x0), 1 / (y1 - y0), 1 / (z1 - z0)) * Transform::translate(-x0, -y0, -z0) *
         to_local;
}

class GridVolume final : public VoxelVolume {
public:
  explicit GridVolume(const Properties& p) : GridVolume(p, read_voxels(p, "data")) {}

private:
  GridVolume(const Properties& p, VoxelData data) : VoxelVolume(p, box_of(p, data), VoxelFilter::read(p)) {
    const char* const parameter = voxels_parameter(p, "data");
    const bool raw = p.get_bool("raw", false);
    p.get_bool("accel", true);
    if (p.has("accel")) p.note("accel", "has no effect");
    const int channels = data.channels;
    if (channels != 1 && channels != 3 && channels != 6)
      throw p.error(parameter, fmt::format("has {} numbers at each voxel; 1, 3 (colours) and 6 are supported",
                                           channels));
    const bool colors = channels == 3 && !raw;
    if (colors || channels == 1) drop_noise(p, data, parameter);
    if (colors) check_colors(p, data, parameter);
    try {
      if (colors && !is_grey(data))
        set_colors(data);
      else
        set_numbers(data, colors ? 1 : channels);
    } catch (const Error& problem) {
      throw p.error(parameter, problem.message());
    }
  }

  /// Voxels below 0 by rounding count as 0, with a note.
  static void drop_noise(const Properties& p, VoxelData& data, const char* parameter) {
    float largest = 0;
    for (const float v : data.values) largest = std::max(largest, v);
    NoiseClamp clamp(0, std::numeric_limits<double>::infinity(), largest);
    for (float& v : data.values) v = clamp(v);
    if (clamp.any()) p.note(parameter, clamp.note());
  }
  static void check_colors(const Properties& p, const VoxelData& data, const char* parameter) {
    for (const float v : data.values)
      if (v < 0)
        throw p.error(
            parameter,
            fmt::format("a colour must not be negative, but a voxel has {}; \"raw\" is for numbers that "
                        "are no colours",
                        v));
  }
  /// Whether all colours are grey, so that they need no spectrum.
  static bool is_grey(const VoxelData& data) {
    for (std::size_t i = 0; i < data.values.size(); i += 3)
      if (data.values[i] != data.values[i + 1] || data.values[i] != data.values[i + 2]) return false;
    return true;
  }

  void set_numbers(const VoxelData& data, int count) {
    std::vector<Numbers> numbers;
    for (int c = 0; c < count; ++c)
      numbers.emplace_back(
          data.size, repeats(),
          [&](int x, int y, int z) { return data.values[data.voxel(x, y, z) + std::size_t(c)]; },
          [](auto&&...) { return std::optional<float>(); });
    set(std::move(numbers));
  }
  void set_colors(const VoxelData& data) {
    const auto color = [&](int x, int y, int z) {
      const float* v = &data.values[data.voxel(x, y, z)];
      return UpsampledColor::of_rgb_or_black(v[0], v[1], v[2]);
    };
    set(Colors(data.size, repeats(), color, [](auto&&...) { return std::optional<UpsampledColor>(); }));
  }
};

std::vector<ParameterDoc> rows() {
  std::vector<ParameterDoc> all = {
      {"filename", "file", "", "required, or data", "a .vol file of 1, 3 or 6 numbers at each voxel"},
      {"data", "array", "", "none",
       "instead of filename, from Python: depth x height x width [x 1, 3 or 6] numbers"},
      {"to_world", "transform", "", "identity",
       "transform from the unit cube [0, 1]^3, which the grid fills, to world space"},
      {"use_grid_bbox", "boolean", "", "false",
       "the grid fills the box stored in the file, instead of the unit cube, before to_world"},
      {"raw", "boolean", "", "false", "three numbers are a vector, not a colour, and have no spectrum"},
      {"accel", "boolean", "", "true", "accepted for compatibility with Mitsuba, without effect"}};
  const std::vector<ParameterDoc> filter = VoxelFilter::rows();
  all.insert(all.begin() + 2, filter.begin(), filter.end());
  return all;
}

AUREOLE_PLUGIN(GridVolume, "volume", "gridvolume",
               PluginDoc{
                   "Values on a regular grid in Mitsuba's format .vol. One number per voxel is the value at "
                   "every wavelength; three are a colour, which becomes a spectrum like a texture's "
                   "(docs/conventions.md); spectra are interpolated. As an emission both multiply D65. Six "
                   "are numbers without spectrum, such as a symmetric matrix.",
                   "",
                   rows(),
                   {R"(<volume type="gridvolume">
    <string name="filename" value="smoke.vol"/>
    <boolean name="use_grid_bbox" value="true"/>
    <transform name="to_world">
        <scale value="2"/>
    </transform>
</volume>)",
                    R"(<volume type="gridvolume">
    <string name="filename" value="smoke.vol"/>
    <string name="filter_type" value="nearest"/>
    <string name="wrap_mode" value="repeat"/>
    <boolean name="raw" value="false"/>
    <boolean name="accel" value="false"/>
</volume>)"}});

}  // namespace
}  // namespace aureole

// SPDX-License-Identifier: Apache-2.0
// Values on a sparse grid, from OpenVDB's format .vdb or NanoVDB's .nvdb.
#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "aureole/parameter/vdb/vdb_file.h"
#include "aureole/plugin/registry.h"
#include "aureole/spectrum/value_limit.h"
#include "aureole/volume/grid/voxel_volume.h"

namespace aureole {
namespace {

/// The voxels of a grid. Coordinates start at the corner of a box of all active voxels and one more on each
/// side, where interpolated values fall to the background.
class Voxels {
public:
  explicit Voxels(const SparseVoxels& from) : from_(from) {
    std::size_t count = 1;
    for (std::size_t i = 0; i < 3; ++i) {
      constexpr int kFarthest = 1 << 30;  // bound of a coordinate, far from overflow
      if (from.lower[i] < -kFarthest || from.upper[i] > kFarthest)
        throw Error(fmt::format("is too large: the grid \"{}\" has voxels at {} to {}, which is too far out",
                                from.name, from.lower[i], from.upper[i]));
      const std::int64_t size = std::int64_t(from.upper[i]) - from.lower[i] + 3;
      constexpr std::int64_t kLongest = 1 << 20;
      if (size > kLongest)
        throw Error(
            fmt::format("is too large: the grid \"{}\" spans {} voxels along an axis; {} are possible",
                        from.name, size, kLongest));
      size_[i] = int(size);
      first_[i] = floor_block(from.lower[i]);
      blocks_[i] = floor_block(from.upper[i]) - first_[i] + 1;
      if (count > kMaxBlocks / std::size_t(blocks_[i]))
        throw Error(
            fmt::format("is too large: the box around the grid \"{}\" has more than {} blocks of 8^3 voxels",
                        from.name, kMaxBlocks));
      count *= std::size_t(blocks_[i]);
    }
    map_.assign(count, kBackground);
    for (std::size_t t = 0; t < from.tiles.size(); ++t) {
      SparseVoxels::Coordinates low, high;
      for (std::size_t i = 0; i < 3; ++i) {
        low[i] = floor_block(from.tiles[t].lower[i]) - first_[i];
        high[i] = floor_block(from.tiles[t].upper[i]) - first_[i];
      }
      for (int z = low[2]; z <= high[2]; ++z)
        for (int y = low[1]; y <= high[1]; ++y)
          for (int x = low[0]; x <= high[0]; ++x) map_[place(x, y, z)] = -2 - std::int32_t(t);
    }
    for (std::size_t b = 0; b < from.blocks.size(); ++b) {
      const SparseVoxels::Coordinates& at = from.blocks[b];
      map_[place(floor_block(at[0]) - first_[0], floor_block(at[1]) - first_[1],
                 floor_block(at[2]) - first_[2])] = std::int32_t(b);
    }
  }

  const std::array<int, 3>& size() const { return size_; }

  /// Returns the numbers of a voxel.
  const float* at(int x, int y, int z) const {
    const std::array<int, 3> c = coordinates({x, y, z});
    const std::int32_t block = block_at(c);
    if (block < 0) return uniform_value(block);
    const auto in = [&](std::size_t i) { return std::size_t(c[i] & (SparseVoxels::kEdge - 1)); };
    constexpr std::size_t n = SparseVoxels::kEdge;
    return &from_.values[(std::size_t(block) * SparseVoxels::kBlockVoxels + (in(2) * n + in(1)) * n + in(0)) *
                         std::size_t(from_.channels)];
  }
  /// Returns the numbers of all voxels in [lower, upper] if they are known to be equal, else null.
  const float* all_of(const std::array<int, 3>& lower, const std::array<int, 3>& upper) const {
    const std::array<int, 3> low = coordinates(lower), high = coordinates(upper);
    const std::int32_t first = block_at(low);
    if (first >= 0) return nullptr;
    // The ranges are at most two blocks wide.
    for (int corner = 1; corner < 8; ++corner)
      if (block_at({(corner & 1 ? high : low)[0], (corner & 2 ? high : low)[1],
                    (corner & 4 ? high : low)[2]}) != first)
        return nullptr;
    return uniform_value(first);
  }

private:
  /// upper bound of the number of blocks: 2048^3 voxels
  static constexpr std::size_t kMaxBlocks = std::size_t(1) << 24;
  /// index for a block of background; smaller numbers are tiles
  static constexpr std::int32_t kBackground = -1;

  static int floor_block(int i) { return i >> 3; }
  std::array<int, 3> coordinates(const std::array<int, 3>& c) const {
    return {c[0] + from_.lower[0] - 1, c[1] + from_.lower[1] - 1, c[2] + from_.lower[2] - 1};
  }
  std::size_t place(int x, int y, int z) const {
    return (std::size_t(z) * std::size_t(blocks_[1]) + std::size_t(y)) * std::size_t(blocks_[0]) +
           std::size_t(x);
  }
  std::int32_t block_at(const std::array<int, 3>& c) const {
    int b[3];
    for (std::size_t i = 0; i < 3; ++i) {
      b[i] = floor_block(c[i]) - first_[i];
      if (b[i] < 0 || b[i] >= blocks_[i]) return kBackground;
    }
    return map_[place(b[0], b[1], b[2])];
  }
  const float* uniform_value(std::int32_t block) const {
    return block == kBackground ? from_.background.data() : from_.tiles[std::size_t(-2 - block)].value.data();
  }

  const SparseVoxels& from_;
  std::array<int, 3> size_{}, first_{}, blocks_{};
  std::vector<std::int32_t> map_;
};

Transform box_of(const Properties& p, const SparseVoxels& voxels) {
  const Transform to_space(voxels.to_space);
  if (to_space.is_singular())
    throw p.error("filename", "the grid \"" + voxels.name + "\" has a singular transform");
  std::array<double, 3> size, corner;
  for (std::size_t i = 0; i < 3; ++i) {
    size[i] = double(voxels.upper[i]) - voxels.lower[i] + 3;
    corner[i] = voxels.lower[i] - 1.5;  // lower corner of the box with a margin of one voxel
  }
  return Transform::scale(1 / size[0], 1 / size[1], 1 / size[2]) *
         Transform::translate(-corner[0], -corner[1], -corner[2]) * to_space.inverse() *
         p.get_transform("to_world").inverse();
}

/// Voxels below 0 by rounding count as 0, with a note.
void drop_noise(const Properties& p, SparseVoxels& voxels) {
  const auto each = [&](const auto& f) {
    for (float& v : voxels.background) f(v);
    for (SparseVoxels::Tile& tile : voxels.tiles)
      for (float& v : tile.value) f(v);
    for (float& v : voxels.values) f(v);
  };
  float largest = 0;
  each([&](float v) { largest = std::max(largest, v); });
  NoiseClamp clamp(0, std::numeric_limits<double>::infinity(), largest);
  each([&](float& v) { v = clamp(v); });
  if (clamp.any()) p.note("filename", clamp.note());
}

SparseVoxels read(const Properties& p) {
  const std::filesystem::path file = p.get_file("filename");
  const std::string wanted = p.get_string("grid", "");
  bool unknown = false;
  try {
    SparseVoxels voxels = read_vdb_file(file, wanted.empty() ? std::nullopt : std::optional(wanted), unknown);
    if (voxels.channels == 1 || !p.get_bool("raw", false)) drop_noise(p, voxels);
    return voxels;
  } catch (const Error& problem) {
    throw p.error(unknown ? "grid" : "filename", "\"" + file.string() + "\" " + problem.message());
  }
}

class VdbVolume final : public VoxelVolume {
public:
  explicit VdbVolume(const Properties& p) : VdbVolume(p, read(p)) {}

private:
  VdbVolume(const Properties& p, const SparseVoxels& from)
      : VoxelVolume(p, box_of(p, from), VoxelFilter::read_without_wrap(p)) {
    const bool raw = p.get_bool("raw", false);
    try {
      const Voxels voxels(from);
      if (from.channels == 3 && !raw)
        set_colors(p, from, voxels);
      else
        set_numbers(voxels, from.channels);
    } catch (const Error& problem) {
      if (!problem.where().file.empty()) throw;
      throw p.error("filename", "\"" + p.get_file("filename").string() + "\" " + problem.message());
    }
  }

  void set_numbers(const Voxels& voxels, int channels) {
    std::vector<Numbers> numbers;
    for (int c = 0; c < channels; ++c)
      numbers.emplace_back(
          voxels.size(), false, [&](int x, int y, int z) { return voxels.at(x, y, z)[c]; },
          [&](const auto& lower, const auto& upper) {
            const float* const v = voxels.all_of(lower, upper);
            return v ? std::optional(v[c]) : std::nullopt;
          });
    set(std::move(numbers));
  }
  void set_colors(const Properties& p, const SparseVoxels& from, const Voxels& voxels) {
    const auto color = [&](const float* v) {
      if (v[0] < 0 || v[1] < 0 || v[2] < 0)
        throw p.error("filename",
                      "the grid \"" + from.name +
                          "\" has negative components, which no colour has; \"raw\" is for vectors "
                          "that are no colours");
      return UpsampledColor::of_rgb_or_black(v[0], v[1], v[2]);
    };
    set(Colors(
        voxels.size(), false, [&](int x, int y, int z) { return color(voxels.at(x, y, z)); },
        [&](const auto& lower, const auto& upper) {
          const float* const v = voxels.all_of(lower, upper);
          return v ? std::optional(color(v)) : std::nullopt;
        }));
  }
};

AUREOLE_PLUGIN(
    VdbVolume, "volume", "vdbvolume",
    PluginDoc{
        "Values on a sparse grid of OpenVDB or NanoVDB: floats and doubles are the value at every "
        "wavelength; vectors of three are a colour, which becomes a spectrum like a texture's "
        "(docs/conventions.md); spectra are interpolated. As an emission both multiply D65. Its box has all "
        "active voxels and half a voxel more; outside is the grid's background.",
        "K. Museth, VDB: High-resolution sparse volumes with dynamic topology, ACM Transactions on Graphics 32(3), "
        "2013",
        {{"filename", "file", "", "required",
          "a .vdb file, or a .nvdb file of NanoVDB 32 (whose first bytes are NanoVDB0)"},
         {"grid", "string", "", "density, or else the first", "name of the grid in the file"},
         {"to_world", "transform", "", "identity", "applied after the grid's own transform"},
         {"filter_type", "string", "", "trilinear",
          "interpolation between the centres of voxels: trilinear, or nearest for none"},
         {"raw", "boolean", "", "false", "three numbers are a vector, not a colour, and have no spectrum"}},
        {R"(<volume type="vdbvolume">
    <string name="filename" value="cloud.vdb"/>
    <string name="grid" value="density"/>
    <transform name="to_world">
        <scale value="0.1"/>
    </transform>
</volume>)",
         R"(<volume type="vdbvolume">
    <string name="filename" value="cloud.nvdb"/>
    <string name="filter_type" value="nearest"/>
    <boolean name="raw" value="true"/>
</volume>)"}});

}  // namespace
}  // namespace aureole

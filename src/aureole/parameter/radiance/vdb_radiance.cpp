// SPDX-License-Identifier: Apache-2.0
// Radiance grids of OpenVDB (Museth 2013, "VDB: high-resolution sparse volumes with dynamic topology").
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>
#include <unordered_map>

#include "aureole/core/error.h"
#include "aureole/core/input_file.h"
#include "aureole/core/memory.h"
#include "aureole/parameter/radiance/radiance_reader.h"
#include "aureole/parameter/splat/spherical_harmonics.h"
#include "aureole/parameter/vdb/vdb_file.h"

namespace aureole::radiance_reader {

namespace {

using Coordinates = SparseVoxels::Coordinates;

/// Numbers of a sparse grid by coordinates, within a box.
class SparseLookup {
public:
  SparseLookup(const SparseVoxels& from, const Coordinates& lower, const Coordinates& upper) : from_(from) {
    for (std::size_t t = 0; t < from.tiles.size(); ++t) {
      Coordinates low, high;
      for (std::size_t k = 0; k < 3; ++k) {
        low[k] = std::max(from.tiles[t].lower[k], lower[k]) >> kShift;
        high[k] = std::min(from.tiles[t].upper[k], upper[k]) >> kShift;
      }
      for (int x = low[0]; x <= high[0]; ++x)
        for (int y = low[1]; y <= high[1]; ++y)
          for (int z = low[2]; z <= high[2]; ++z) places_[key(x, y, z)] = -1 - std::int64_t(t);
    }
    for (std::size_t b = 0; b < from.blocks.size(); ++b) {
      const Coordinates& at = from.blocks[b];
      places_[key(at[0] >> kShift, at[1] >> kShift, at[2] >> kShift)] = std::int64_t(b);
    }
  }

  /// Returns the numbers of a voxel, or null where the file states none but the background.
  const float* find(const Coordinates& c) const {
    const auto found = places_.find(key(c[0] >> kShift, c[1] >> kShift, c[2] >> kShift));
    if (found == places_.end()) return nullptr;
    if (found->second < 0) return from_.tiles[std::size_t(-1 - found->second)].value.data();
    constexpr std::size_t n = SparseVoxels::kEdge;
    const auto in = [&](std::size_t k) { return std::size_t(c[k] & (SparseVoxels::kEdge - 1)); };
    return &from_.values[(std::size_t(found->second) * SparseVoxels::kBlockVoxels + (in(2) * n + in(1)) * n +
                          in(0)) *
                         std::size_t(from_.channels)];
  }

private:
  static constexpr int kShift = 3;  ///< blocks have 8 voxels along an edge
  static std::uint64_t key(int x, int y, int z) {
    constexpr std::uint64_t kMask = (std::uint64_t(1) << 21) - 1;
    return (std::uint64_t(x) & kMask) << 42 | (std::uint64_t(y) & kMask) << 21 | (std::uint64_t(z) & kMask);
  }

  const SparseVoxels& from_;
  std::unordered_map<std::uint64_t, std::int64_t> places_;  ///< a block, or -1 - a tile
};

std::optional<SparseVoxels> find_grid(const std::filesystem::path& file, const std::string& name,
                                      int channels) {
  bool is_unknown = false;
  try {
    SparseVoxels voxels = read_vdb_file(file, name, is_unknown);
    if (voxels.channels != channels)
      throw Error(fmt::format("the grid \"{}\" has {} at a voxel, but {} is expected", name,
                              voxels.channels == 1 ? "a number" : "a vector",
                              channels == 1 ? "a number" : "a vector"));
    return voxels;
  } catch (const Error&) {
    if (!is_unknown) throw;
    return {};
  }
}

bool have_same_transform(const SparseVoxels& a, const SparseVoxels& b) {
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t k = 0; k < 4; ++k) {
      const double x = a.to_space[i][k], y = b.to_space[i][k];
      if (!(std::abs(x - y) <= 1e-6 * std::max(std::abs(x), std::abs(y)))) return false;
    }
  return true;
}

/// Sets the box by the transform of the density, whose axes may have different scales.
void set_box(const SparseVoxels& density, const Coordinates& lower, RadianceVoxels& g) {
  const auto& m = density.to_space;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t k = 0; k < 3; ++k)
      if (i != k && m[i][k] != 0)
        throw Error(
            "has a transform that rotates or shears: a scale and a translation are read, and \"to_world\" places the grid");
    if (!(m[i][i] > 0) || !std::isfinite(m[i][i]) || !std::isfinite(m[i][3]))
      throw Error(fmt::format("has a voxel of the edge {:g}; an edge is larger than 0", m[i][i]));
    const int axis = int(i);
    g.radius[axis] = float(0.5 * m[i][i] * g.size[i]);
    g.center[axis] = float(m[i][3] + m[i][i] * (double(lower[i]) + 0.5 * (g.size[i] - 1)));
    if (!(g.radius[axis] > 0) || !std::isfinite(g.radius[axis]) || !std::isfinite(g.center[axis]))
      throw Error("has a transform whose numbers are beyond those of floats");
  }
}

struct VdbColors {
  std::vector<SparseVoxels> grids;  ///< of the coefficients, or one of a linear colour
  bool are_harmonics = false;
  int degree = 0;
};

VdbColors find_colors(const std::filesystem::path& file, std::vector<std::string>& notes) {
  VdbColors colors;
  constexpr std::size_t kMostRead = std::size_t(kMaxHarmonicDegree + 1) * (kMaxHarmonicDegree + 1);
  while (colors.grids.size() < kMostRead) {
    auto grid = find_grid(file, fmt::format("sh_{}", colors.grids.size()), 3);
    if (!grid) break;
    colors.grids.push_back(std::move(*grid));
  }
  if (!colors.grids.empty()) {
    colors.are_harmonics = true;
    const std::size_t n = colors.grids.size();
    while (std::size_t(colors.degree + 1) * std::size_t(colors.degree + 1) < n) ++colors.degree;
    if (std::size_t(colors.degree + 1) * std::size_t(colors.degree + 1) != n)
      throw Error(fmt::format(
          "has the grids \"sh_0\" to \"sh_{}\" of coefficients; 1, 4, 9 or 16 are expected, harmonics of degree 0 to 3",
          n - 1));
    if (n == kMostRead && find_grid(file, fmt::format("sh_{}", n), 3))
      notes.push_back("has harmonics of degree 4, which are left out");
    return colors;
  }
  for (const char* name : {"color", "Cd"})
    if (auto grid = find_grid(file, name, 3)) {
      colors.grids.push_back(std::move(*grid));
      return colors;
    }
  throw Error(
      "has no colours: vectors \"sh_0\", \"sh_1\", ... of coefficients of harmonics are expected, or vectors \"color\" or "
      "\"Cd\" of linear colours");
}

/// The voxels of the box that are stored: those with a density, and then their neighbours.
struct StoredVoxels {
  std::vector<Coordinates> places;  ///< relative to the box
  std::size_t with_density = 0;
};

StoredVoxels find_stored(const SparseLookup& density, const Coordinates& lower, RadianceVoxels& g) {
  StoredVoxels stored;
  g.links.resize(std::size_t(g.size[0]) * std::size_t(g.size[1]) * std::size_t(g.size[2]));
  std::fill(g.links.begin(), g.links.end(), -1);
  for (int x = 0; x < g.size[0]; ++x)
    for (int y = 0; y < g.size[1]; ++y)
      for (int z = 0; z < g.size[2]; ++z) {
        const float* value = density.find({lower[0] + x, lower[1] + y, lower[2] + z});
        if (!value || *value == 0) continue;
        g.links[g.link_index(x, y, z)] = std::int32_t(stored.places.size());
        stored.places.push_back({x, y, z});
      }
  stored.with_density = stored.places.size();
  for (std::size_t i = 0; i < stored.with_density; ++i) {
    const Coordinates c = stored.places[i];
    for (int x = std::max(0, c[0] - 1); x <= std::min(g.size[0] - 1, c[0] + 1); ++x)
      for (int y = std::max(0, c[1] - 1); y <= std::min(g.size[1] - 1, c[1] + 1); ++y)
        for (int z = std::max(0, c[2] - 1); z <= std::min(g.size[2] - 1, c[2] + 1); ++z) {
          std::int32_t& link = g.links[g.link_index(x, y, z)];
          if (link >= 0) continue;
          link = std::int32_t(stored.places.size());
          stored.places.push_back({x, y, z});
        }
  }
  return stored;
}

/// Sets the coefficients of all stored voxels. Voxels without density and without a colour in the file get the mean of their
/// neighbours with density, so that interpolated colours do not fall to the background at silhouettes.
void set_colors(const VdbColors& colors, const StoredVoxels& stored, const Coordinates& lower,
                RadianceVoxels& g) {
  const std::size_t terms = g.coefficients(), n = stored.places.size();
  g.harmonics.resize(3 * terms * n);
  std::vector<char> is_stated(n, 0);
  for (std::size_t term = 0; term < terms; ++term) {
    const SparseVoxels& grid = colors.grids[term];
    Coordinates upper = lower;
    for (std::size_t k = 0; k < 3; ++k) upper[k] += g.size[k] - 1;
    const SparseLookup lookup(grid, lower, upper);
    for (std::size_t i = 0; i < n; ++i) {
      const Coordinates& c = stored.places[i];
      const float* value = lookup.find({lower[0] + c[0], lower[1] + c[1], lower[2] + c[2]});
      if (value && !std::equal(value, value + 3, grid.background.begin())) is_stated[i] = 1;
      if (!value) value = grid.background.data();
      for (std::size_t k = 0; k < 3; ++k)
        g.harmonics[3 * (terms * i + term) + k] =
            colors.are_harmonics ? value[k] : (value[k] - 0.5f) / kHarmonic0;
    }
  }
  for (std::size_t i = stored.with_density; i < n; ++i) {
    if (is_stated[i]) continue;
    const Coordinates& c = stored.places[i];
    std::vector<float> sum(3 * terms, 0.f);
    int count = 0;
    for (int x = std::max(0, c[0] - 1); x <= std::min(g.size[0] - 1, c[0] + 1); ++x)
      for (int y = std::max(0, c[1] - 1); y <= std::min(g.size[1] - 1, c[1] + 1); ++y)
        for (int z = std::max(0, c[2] - 1); z <= std::min(g.size[2] - 1, c[2] + 1); ++z) {
          const std::int32_t link = g.links[g.link_index(x, y, z)];
          if (link < 0 || std::size_t(link) >= stored.with_density) continue;
          ++count;
          for (std::size_t k = 0; k < sum.size(); ++k)
            sum[k] += g.harmonics[3 * terms * std::size_t(link) + k];
        }
    for (std::size_t k = 0; k < sum.size(); ++k) g.harmonics[3 * terms * i + k] = sum[k] / float(count);
  }
}

RadianceVoxels read_grids(const std::filesystem::path& file) {
  RadianceVoxels g;
  const auto found = find_grid(file, "density", 1);
  if (!found) throw Error("has no grid \"density\"");
  const SparseVoxels& density = *found;
  if (density.background[0] != 0)
    throw Error(fmt::format("has the density {:g} outside of its voxels; 0 is expected there",
                            density.background[0]));
  // A margin of one voxel, in which interpolated densities fall to 0.
  Coordinates lower, upper;
  double count = 1;
  for (std::size_t k = 0; k < 3; ++k) {
    constexpr int kFarthest = 1 << 20;
    if (density.lower[k] < -kFarthest || density.upper[k] > kFarthest)
      throw Error(fmt::format("has voxels at {} to {}; coordinates to {} are possible", density.lower[k],
                              density.upper[k], kFarthest));
    lower[k] = density.lower[k] - 1, upper[k] = density.upper[k] + 1;
    g.size[k] = upper[k] - lower[k] + 1;
    count *= g.size[k];
  }
  constexpr double kMostVoxels = double(std::size_t(1) << 29);
  if (count > kMostVoxels)
    throw Error(fmt::format("spans {} x {} x {} voxels; {:.0f} are possible", g.size[0], g.size[1], g.size[2],
                            kMostVoxels));
  const double file_bytes = double(std::filesystem::file_size(file));
  constexpr double kPerByte = 1000;  // sparse grids are compressed
  require_content(count * sizeof(std::int32_t), file_bytes, kPerByte);
  set_box(density, lower, g);
  const VdbColors colors = find_colors(file, g.notes);
  for (const SparseVoxels& grid : colors.grids)
    if (!have_same_transform(grid, density))
      throw Error(fmt::format("the grids \"density\" and \"{}\" have different transforms", grid.name));
  g.degree = colors.degree;
  g.is_linear = !colors.are_harmonics;
  const SparseLookup lookup(density, lower, upper);
  const StoredVoxels stored = find_stored(lookup, lower, g);
  if (stored.with_density == 0) throw Error("has no density but 0");
  require_content(double(stored.places.size()) * double(sizeof(float)) * double(1 + 3 * g.coefficients()),
                  file_bytes, kPerByte);
  g.densities.resize(stored.places.size());
  for (std::size_t i = 0; i < stored.places.size(); ++i) {
    const Coordinates& c = stored.places[i];
    g.densities[i] =
        i < stored.with_density ? *lookup.find({lower[0] + c[0], lower[1] + c[1], lower[2] + c[2]}) : 0.f;
  }
  set_colors(colors, stored, lower, g);
  empty_bad_voxels(g);
  return g;
}

}  // namespace

bool is_vdb(const std::filesystem::path& file) {
  InputFile input(file);
  char first[8] = {};
  input.read(first, std::min<std::uint64_t>(sizeof first, input.size()));
  return std::memcmp(first, " BDV", 4) == 0 || std::memcmp(first, "NanoVDB", 7) == 0;
}

RadianceVoxels read_vdb(const std::filesystem::path& file) {
  try {
    return read_grids(file);
  } catch (const Error& problem) {
    if (!problem.where().file.empty()) throw;
    throw Error({file.string(), 0, 0}, problem.message());
  }
}

}  // namespace aureole::radiance_reader

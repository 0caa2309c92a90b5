// SPDX-License-Identifier: Apache-2.0
// `ProjectedSplats`: the splats of a scene as the footprints that a camera sees, sorted by depth and listed by tiles of the
// film.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "aureole/core/unfilled.h"
#include "aureole/integrator/splat/splat_settings.h"
#include "aureole/medium/splats/splat_medium.h"
#include "aureole/sensor/placed_sensor.h"

namespace aureole {

/// A splat in the picture. At the film position (x + dx, y + dy) its exponent is -(A^2 + B^2) / (2 D^2) with A = a0 dx +
/// a1 dy, B = b0 dx + b1 dy, D = 1 + d0 dx + d1 dy.
struct SplatFootprint {
  float x, y;            ///< film position of the centre [pixels]
  float a0, a1, b0, b1;  ///< coefficients of A and B [1/pixels]
  float d0, d1;          ///< gradient of D [1/pixels]; 0 for a linearised perspective
  float weight;          ///< opacity at the centre, or the weight of an interpolating footprint
  float min_exponent;    ///< the footprint ends where the exponent is smaller
  float color[3];
  float distance;  ///< distance of the centre from the camera [length]
  float range;     ///< points up to this distance behind belong to the same surface [length]
  float reach_y;   ///< the footprint lies within y - reach_y and y + reach_y [pixels]
};

/// Conventions that all splats of a picture share, with those of the files applied.
struct SplatConventions {
  SplatHints::Sorting sorting;
  SplatHints::Projection projection;
  SplatHints::Colors colors;

  /// Throws an Error, located at the integrator, where files differ and the settings do not decide.
  static SplatConventions of(std::span<const SplatMedium* const> media, const SplatSettings& settings,
                             const Properties& properties);
};

class ProjectedSplats {
public:
  static constexpr int kTile = 16;  ///< pixels along a side of a tile

  /// `part` is the part of the film with positions of rays, `corner` a film pixel at which a tile begins.
  ProjectedSplats(std::span<const SplatMedium* const> media, const SplatSettings& settings,
                  const SplatConventions& conventions, const PinholeView& view, const FilmPart& part,
                  int corner_x, int corner_y);

  /// Returns the number of the tile of a film position; positions outside of the film belong to the nearest tile.
  int tile_of(Vec2 film) const;
  /// Returns indices of `footprints` in the order of depth, from front to back.
  std::span<const std::uint32_t> tile(int number) const {
    return std::span(entries_).subspan(first_[std::size_t(number)],
                                       first_[std::size_t(number) + 1] - first_[std::size_t(number)]);
  }
  /// All footprints that reach the film, in the order of depth.
  std::span<const SplatFootprint> footprints() const { return footprints_; }
  const SplatConventions& conventions() const { return conventions_; }
  std::size_t entry_count() const { return entries_.size(); }
  /// Number of splats whose projection has no area, which occurs without dilation.
  std::size_t without_area() const { return without_area_; }

private:
  struct Found;
  struct TileRange {
    int x0, y0, x1, y1;  ///< first and last tile that the footprint reaches, inclusive
  };
  void project(const SplatMedium& medium, const SplatSettings& settings, const PinholeView& view,
               std::vector<Found>& parts);
  void list_by_tiles(const UnfilledVector<TileRange>& ranges);

  SplatConventions conventions_;
  FilmPart part_;
  int left_, top_, columns_, rows_;  ///< grid of tiles: top left corner [pixels], numbers of columns and rows
  UnfilledVector<SplatFootprint> footprints_;
  UnfilledVector<std::uint32_t> entries_;
  std::vector<std::size_t> first_;
  std::size_t without_area_ = 0;
};

}  // namespace aureole

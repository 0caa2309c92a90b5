// SPDX-License-Identifier: Apache-2.0
#include "aureole/integrator/splat/projected_splats.h"

#include <algorithm>
#include <cmath>

#include "aureole/core/parallel.h"
#include "aureole/integrator/splat/depth_sort.h"
#include "aureole/integrator/splat/splat_projector.h"

namespace aureole {

SplatConventions SplatConventions::of(std::span<const SplatMedium* const> media,
                                      const SplatSettings& settings, const Properties& properties) {
  const SplatHints& first = media.front()->cloud().hints;
  for (const SplatMedium* medium : media) {
    const SplatHints& h = medium->cloud().hints;
    const auto require = [&](bool same, const char* name) {
      if (!same)
        throw properties.error(name, "the files of splats differ in it: state which one they are blended by");
    };
    require(settings.sorting || h.sorting == first.sorting, "sorting");
    require(settings.projection || h.projection == first.projection, "projection");
    require(settings.colors || h.colors == first.colors, "color_space");
  }
  SplatConventions c{settings.sorting.value_or(first.sorting), settings.projection.value_or(first.projection),
                     settings.colors.value_or(first.colors)};
  if (!settings.blends()) c.projection = SplatHints::Projection::perspective;
  return c;
}

/// Footprints of a range of splats.
struct ProjectedSplats::Found {
  std::vector<SplatFootprint> footprints;
  std::vector<float> depths;
  std::vector<TileRange> ranges;
  std::size_t without_area = 0;
};

ProjectedSplats::ProjectedSplats(std::span<const SplatMedium* const> media, const SplatSettings& settings,
                                 const SplatConventions& conventions, const PinholeView& view,
                                 const FilmPart& part, int corner_x, int corner_y)
    : conventions_(conventions), part_(part) {
  const auto tiles_before = [](float from, int corner) {
    return int(std::ceil((float(corner) - from) / kTile));
  };
  left_ = corner_x - kTile * std::max(0, tiles_before(part.lower.x, corner_x));
  top_ = corner_y - kTile * std::max(0, tiles_before(part.lower.y, corner_y));
  columns_ = std::max(1, int(std::ceil((part.upper.x - float(left_)) / kTile)));
  rows_ = std::max(1, int(std::ceil((part.upper.y - float(top_)) / kTile)));
  std::vector<Found> parts;
  for (const SplatMedium* medium : media) project(*medium, settings, view, parts);

  std::vector<std::size_t> begins;
  std::size_t n = 0;
  for (const Found& found : parts) {
    begins.push_back(n);
    n += found.depths.size(), without_area_ += found.without_area;
  }
  UnfilledVector<float> depths(n);
  UnfilledVector<const SplatFootprint*> where(n);
  UnfilledVector<const TileRange*> range_of(n);
  for_ranges(
      parts.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k)
          for (std::size_t i = 0; i < parts[k].depths.size(); ++i) {
            depths[begins[k] + i] = parts[k].depths[i];
            where[begins[k] + i] = &parts[k].footprints[i];
            range_of[begins[k] + i] = &parts[k].ranges[i];
          }
      },
      1);
  const UnfilledVector<std::uint32_t> order = sort_by_depth(depths);
  footprints_.resize(n);
  UnfilledVector<TileRange> ranges(n);
  for_ranges(n, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      footprints_[i] = *where[order[i]], ranges[i] = *range_of[order[i]];
  });
  list_by_tiles(ranges);
}

void ProjectedSplats::project(const SplatMedium& medium, const SplatSettings& settings,
                              const PinholeView& view, std::vector<Found>& parts) {
  constexpr std::size_t kPart = 4096;
  const SplatProjector projector(medium, settings, conventions_, view, part_);
  const std::size_t n = medium.cloud().size(), first = parts.size(), count = (n + kPart - 1) / kPart;
  parts.resize(first + count);
  for_ranges(
      count,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
          Found& found = parts[first + k];
          for (std::size_t i = k * kPart; i < std::min(n, (k + 1) * kPart); ++i) {
            SplatFootprint f;
            float depth;
            SplatReach reach;
            const auto outcome = projector.project(i, f, depth, reach);
            found.without_area += outcome == SplatProjector::Outcome::no_area;
            if (outcome != SplatProjector::Outcome::visible) continue;
            const double x0 = double(f.x) + reach.x0, x1 = double(f.x) + reach.x1,
                         y0 = double(f.y) + reach.y0, y1 = double(f.y) + reach.y1;
            if (!(x1 >= double(part_.lower.x) && x0 <= double(part_.upper.x) && y1 >= double(part_.lower.y) &&
                  y0 <= double(part_.upper.y)))
              continue;
            const auto tile = [](double at, int corner, int tiles) {
              return int(std::clamp(std::floor((at - corner) / kTile), 0., double(tiles - 1)));
            };
            found.ranges.push_back({tile(x0, left_, columns_), tile(y0, top_, rows_),
                                    tile(x1, left_, columns_), tile(y1, top_, rows_)});
            projector.set_color(i, f);
            found.footprints.push_back(f);
            found.depths.push_back(depth);
          }
        }
      },
      1);
}

void ProjectedSplats::list_by_tiles(const UnfilledVector<TileRange>& ranges) {
  const std::size_t n = ranges.size(), tiles = std::size_t(columns_) * std::size_t(rows_);
  const std::size_t parts = std::clamp<std::size_t>(n >> 13, 1, 16), length = (n + parts - 1) / parts;
  std::vector<std::vector<std::size_t>> next(parts, std::vector<std::size_t>(tiles, 0));
  const auto for_entries = [&](const auto& visit) {
    for_ranges(
        parts,
        [&](std::size_t begin, std::size_t end) {
          for (std::size_t p = begin; p < end; ++p)
            for (std::size_t i = std::min(n, p * length); i < std::min(n, (p + 1) * length); ++i)
              for (int y = ranges[i].y0; y <= ranges[i].y1; ++y)
                for (int x = ranges[i].x0; x <= ranges[i].x1; ++x)
                  visit(next[p][std::size_t(y) * std::size_t(columns_) + std::size_t(x)], i);
        },
        1);
  };
  for_entries([](std::size_t& count, std::size_t) { ++count; });
  first_.assign(tiles + 1, 0);
  std::size_t sum = 0;
  for (std::size_t t = 0; t < tiles; ++t) {
    first_[t] = sum;
    for (auto& counts : next) {
      const std::size_t here = counts[t];
      counts[t] = sum;
      sum += here;
    }
  }
  first_[tiles] = sum;
  entries_.resize(sum);
  for_entries([&](std::size_t& at, std::size_t i) { entries_[at++] = std::uint32_t(i); });
}

int ProjectedSplats::tile_of(Vec2 film) const {
  const int x = std::clamp(int(std::floor((film.x - float(left_)) / kTile)), 0, columns_ - 1),
            y = std::clamp(int(std::floor((film.y - float(top_)) / kTile)), 0, rows_ - 1);
  return y * columns_ + x;
}

}  // namespace aureole

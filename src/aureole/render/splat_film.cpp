// SPDX-License-Identifier: Apache-2.0
#include "aureole/render/splat_film.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace aureole {

namespace {

/// For each pixel of a row of `size`, the integral of its filter over the positions of samples, [-outside,
/// size + outside].
std::vector<float> filter_integrals(const FilterTable& filter, int size, int outside) {
  // With a box filter, each sample is added to its own pixel only, with weight 1.
  if (filter.is_box()) return std::vector<float>(size_t(size), 1.f);
  const auto integral = [&](double from, double to) {
    constexpr int kSteps = 8192;  // midpoint rule: the table is linear between fewer nodes
    double sum = 0;
    for (int i = 0; i < kSteps; ++i) sum += filter.eval(float(from + (to - from) * (i + 0.5) / kSteps));
    return sum * (to - from) / kSteps;
  };
  const double radius = filter.radius(), whole = integral(-radius, radius);
  std::vector<float> result;
  for (int x = 0; x < size; ++x) {
    const double below = x + 0.5 + outside, above = size + outside - (x + 0.5);
    result.push_back(float(below >= radius && above >= radius
                               ? whole
                               : integral(-std::min(below, radius), std::min(above, radius))));
  }
  return result;
}

}  // namespace

SplatFilm::SplatFilm(const Film& film, const FilterTable& filter, bool may_be_negative)
    : film_(&film), filter_(filter), may_be_negative_(may_be_negative) {
  const int outside = film.sample_border() ? filter.border() : 0;
  area_ = FilmPart::of(film, 0, 1);
  // Bands are at least as high as the filter, so that a splat reaches at most two of them.
  band_height_ = std::max(16, 2 * filter.border() + 1);
  band_locks_ = std::make_unique<std::mutex[]>(size_t(film.crop_height() / band_height_ + 1));
  sample_area_ = (area_.upper.x - area_.lower.x) * (area_.upper.y - area_.lower.y);
  weights_x_ = filter_integrals(filter, film.crop_width(), outside);
  weights_y_ = filter_integrals(filter, film.crop_height(), outside);
}

void SplatFilm::append(std::span<const Splat> splats, std::span<const Path> paths, bool* valid,
                       SplatList& list) const {
  const size_t channels = size_t(film_->measured_channels()), before = list.paths.size();
  const Vec2 corner{float(film_->crop_x()), float(film_->crop_y())};
  for (const Splat& s : splats) {
    bool& path_valid = valid[s.path];
    if (!path_valid || !area_.samples(s.film)) continue;
    path_valid = may_be_negative_ ? is_finite(s.estimate) : is_valid_radiance(s.estimate);
    if (!path_valid) continue;
    const size_t at = list.measured.size();
    list.measured.resize(at + channels);
    film_->measure(s.estimate, paths[size_t(s.path)].wavelengths, &list.measured[at]);
    for (size_t c = 0; c < channels; ++c) path_valid &= std::abs(list.measured[at + c]) < kFixedLimit;
    list.positions.push_back(s.film - corner);
    list.paths.push_back(s.path);
  }
  const auto kept = [&](int path) { return valid[path]; };
  if (std::all_of(list.paths.begin() + std::ptrdiff_t(before), list.paths.end(), kept)) return;
  size_t to = before;
  for (size_t k = before; k < list.paths.size(); ++k) {
    if (!kept(list.paths[k])) continue;
    list.paths[to] = list.paths[k], list.positions[to] = list.positions[k];
    std::copy_n(list.measured.begin() + std::ptrdiff_t(k * channels), channels,
                list.measured.begin() + std::ptrdiff_t(to * channels));
    ++to;
  }
  list.paths.resize(to), list.positions.resize(to), list.measured.resize(to * channels);
}

void SplatFilm::sort_into_bands(SplatList& list) const {
  const int height = film_->crop_height(), border = filter_.border();
  const auto bands_of = [&](size_t i) {
    const int y = int(std::floor(list.positions[i].y));
    return std::pair(std::clamp(y - border, 0, height - 1) / band_height_,
                     std::clamp(y + border, 0, height - 1) / band_height_);
  };
  const size_t count = size_t((height - 1) / band_height_ + 1), splats = list.positions.size();
  // Counting sort: the prefix sums are the bands' ends; filling backwards turns them into the bands'
  // beginnings.
  list.band_begin.assign(count + 1, 0);
  for (size_t i = 0; i < splats; ++i) {
    const auto [first, last] = bands_of(i);
    for (int b = first; b <= last; ++b) ++list.band_begin[size_t(b)];
  }
  std::partial_sum(list.band_begin.begin(), list.band_begin.end(), list.band_begin.begin());
  list.in_band.resize(list.band_begin.back());
  for (size_t i = 0; i < splats; ++i) {
    const auto [first, last] = bands_of(i);
    for (int b = first; b <= last; ++b) list.in_band[--list.band_begin[size_t(b)]] = std::uint32_t(i);
  }
}

void SplatFilm::add(const SplatList& list, FilmBuffer& film) const {
  const int channels = film.measured_channels(), border = filter_.border();
  const size_t bands = list.band_begin.size() - 1;
  for (size_t k = 0; k < bands; ++k) {
    // Units start with different bands, so that threads do not wait for each other.
    const size_t band = (k + list.in_band.size()) % bands;
    if (list.band_begin[band] == list.band_begin[band + 1]) continue;
    const int band_y0 = int(band) * band_height_, band_y1 = std::min(band_y0 + band_height_, film.height());
    struct Reach {
      int x0, x1, y0, y1;
    };
    const auto reach = [&](Vec2 s) {
      const int x = int(std::floor(s.x)), y = int(std::floor(s.y));
      return Reach{std::max(x - border, 0), std::min(x + border + 1, film.width()),
                   std::max(y - border, band_y0), std::min(y + border + 1, band_y1)};
    };
    const auto prefetch = [&](const Reach& r) {
      for (int y = r.y0; y < r.y1; ++y)
        for (const char *
                 p = reinterpret_cast<const char*>(film.pixel(r.x0, y)),
                *end = p + std::ptrdiff_t(r.x1 - r.x0) * film.stride() * std::ptrdiff_t(sizeof(Fixed));
             p < end; p += 64)
          __builtin_prefetch(p, 1);
    };
    const std::lock_guard guard(band_locks_[band]);
    for (size_t i = list.band_begin[band], end = list.band_begin[band + 1]; i < end; ++i) {
      // Prefetches pixels, since splats are at random positions of a film larger than the caches.
      if (i + 2 < end) prefetch(reach(list.positions[list.in_band[i + 2]]));
      const size_t splat = list.in_band[i];
      const Vec2 s = list.positions[splat];
      const float* measured = &list.measured[splat * size_t(channels)];
      const Reach r = reach(s);
      float wx[FilterTable::kMaxReach];
      for (int x = r.x0; x < r.x1; ++x) wx[x - r.x0] = border == 0 ? 1 : filter_.eval(float(x) + 0.5f - s.x);
      for (int y = r.y0; y < r.y1; ++y) {
        const float wy = border == 0 ? 1 : filter_.eval(float(y) + 0.5f - s.y);
        Fixed* p = film.pixel(r.x0, y);
        for (int x = r.x0; x < r.x1; ++x, p += film.stride()) {
          const float weight = wx[x - r.x0] * wy;
          for (int c = 0; c < channels; ++c) p[c] += to_fixed(weight * measured[c]);
        }
      }
    }
  }
}

void SplatFilm::set_weights(RenderState& state) const {
  std::vector<std::int64_t> paths(state.films.size());
  const std::int64_t per_block = state.units_per_block();
  const auto add = [&](std::int64_t unit, std::int64_t blocks) {
    const WorkUnit u = state.unit(unit);
    paths[size_t(u.replicate)] += u.samples() * blocks;
  };
  for (const UnitRanges::Range& range : state.done.ranges()) {
    // Whole blocks of kSampleBlock samples have equal numbers of samples in the units of all pictures, so that they
    // are counted together. The last block may be shorter.
    const std::int64_t last_whole = (state.end - state.begin) / kSampleBlock * per_block;
    const std::int64_t first = (range.begin + per_block - 1) / per_block * per_block,
                       last = std::min(range.end, last_whole) / per_block * per_block;
    if (first >= last) {
      for (std::int64_t unit = range.begin; unit < range.end; ++unit) add(unit, 1);
      continue;
    }
    for (std::int64_t unit = range.begin; unit < first; ++unit) add(unit, 1);
    for (std::int64_t unit = 0; unit < per_block; ++unit) add(first + unit, (last - first) / per_block);
    for (std::int64_t unit = last; unit < range.end; ++unit) add(unit, 1);
  }
  for (size_t r = 0; r < paths.size(); ++r) {
    FilmBuffer& film = state.splat_film(r);
    const int channels = film.measured_channels();
    for (int y = 0; y < film.height(); ++y)
      for (int x = 0; x < film.width(); ++x) {
        // The weight is an integer multiple in fixed point, so that the weights of partial pictures add up
        // exactly to the whole picture's.
        const Fixed weight = Fixed(paths[r]) * to_fixed(weights_x_[size_t(x)] * weights_y_[size_t(y)]);
        Fixed* p = film.pixel(x, y);
        p[channels] = p[channels + 1] = weight;
      }
  }
}

}  // namespace aureole

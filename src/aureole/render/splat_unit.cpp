// SPDX-License-Identifier: Apache-2.0
#include "aureole/render/splat_unit.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "aureole/render/camera_sample.h"

namespace aureole {

namespace {

/// Integrals of the filter over the positions of samples, [-outside, size + outside], for the pixels of a row
/// of `size`.
std::vector<float> filter_integrals(const FilterTable& filter, int size, int outside) {
  // The job gives a sample to its own pixel alone where the filter reaches no other.
  if (filter.is_box()) return std::vector<float>(size_t(size), 1.f);
  const auto integral = [&](double from, double to) {
    constexpr int kSteps = 8192;  // midpoint rule: the table is straight between fewer nodes
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

SplatRenderer::SplatRenderer(const Scene& scene, const SplatIntegrator& integrator, const FilterTable& filter,
                             std::uint64_t seed)
    : scene_(&scene), integrator_(&integrator), filter_(filter), seed_(seed) {
  const Film& film = scene.film();
  const int outside = film.sample_border() ? filter.border() : 0;
  area_ = FilmPart::of(film, 0, 1);
  // A splat reaches two bands at most.
  band_height_ = std::max(16, 2 * filter.border() + 1);
  band_locks_ = std::make_unique<std::mutex[]>(size_t(film.crop_height() / band_height_ + 1));
  sample_area_ = (area_.upper.x - area_.lower.x) * (area_.upper.y - area_.lower.y);
  weights_x_ = filter_integrals(filter, film.crop_width(), outside);
  weights_y_ = filter_integrals(filter, film.crop_height(), outside);
}

void SplatRenderer::append(Vec2 position, const Spectrum& estimate, const Wavelengths& w, SplatUnit& unit,
                           bool& valid) const {
  const Film& film = scene_->film();
  if (!area_.samples(position)) return;
  const size_t channels = size_t(film.measured_channels()), at = unit.measured.size();
  unit.measured.resize(at + channels);
  unit.positions.push_back(position - Vec2{float(film.crop_x()), float(film.crop_y())});
  valid = valid && is_valid_radiance(estimate);
  if (!valid) return;
  film.measure(estimate, w, &unit.measured[at]);
  for (size_t c = 0; c < channels; ++c) valid = valid && std::abs(unit.measured[at + c]) < kFixedLimit;
}

bool SplatRenderer::trace_path(int x, int y, std::int64_t index, int replicate, SplatUnit& unit,
                               const PathLog& log) const {
  x += scene_->film().crop_x(), y += scene_->film().crop_y();
  SampleStream stream;
  Wavelengths w;
  Vec2 position;
  const SensorRay camera =
      begin_camera_sample(*scene_, pixel_key(seed_, replicate, x, y), x, y, index, stream, w, position);

  const size_t splats_before = unit.positions.size(), numbers_before = unit.measured.size();
  bool valid = true;
  const Spectrum seen = integrator_->seen_directly(*scene_, camera.ray, w, log);
  if (!is_valid_radiance(seen) || !is_black(seen))
    append(position, seen * (camera.weight * sample_area_), w, unit, valid);
  unit.path.clear();
  integrator_->trace(*scene_, w, stream, unit.path, log);
  for (const Splat& s : unit.path) append(s.film, s.estimate, w, unit, valid);
  if (!valid) {
    unit.positions.resize(splats_before);
    unit.measured.resize(numbers_before);
  }
  return valid;
}

void SplatRenderer::trace(const RenderState& layout, std::int64_t index, SplatUnit& result) const {
  static const PathLog no_log;
  const WorkUnit u = layout.unit(index);
  result.replicate = u.replicate;
  result.positions.clear(), result.measured.clear(), result.invalid.clear();
  for (int y = u.y0; y < u.y1; ++y)
    for (int x = u.x0; x < u.x1; ++x)
      for (std::int64_t i = u.first; i < u.last; ++i)
        if (!trace_path(x, y, i, u.replicate, result, no_log))
          result.invalid.push_back({x, y, u.replicate, i});
  sort_into_bands(result);
}

void SplatRenderer::sort_into_bands(SplatUnit& unit) const {
  const int height = scene_->film().crop_height(), border = filter_.border();
  const auto bands_of = [&](size_t i) {
    const int y = int(std::floor(unit.positions[i].y));
    return std::pair(std::clamp(y - border, 0, height - 1) / band_height_,
                     std::clamp(y + border, 0, height - 1) / band_height_);
  };
  const size_t count = size_t((height - 1) / band_height_ + 1), splats = unit.positions.size();
  // Counting sort: the counts become ends, and filling from the back makes them beginnings.
  unit.band_begin.assign(count + 1, 0);
  for (size_t i = 0; i < splats; ++i) {
    const auto [first, last] = bands_of(i);
    for (int b = first; b <= last; ++b) ++unit.band_begin[size_t(b)];
  }
  std::partial_sum(unit.band_begin.begin(), unit.band_begin.end(), unit.band_begin.begin());
  unit.in_band.resize(unit.band_begin.back());
  for (size_t i = 0; i < splats; ++i) {
    const auto [first, last] = bands_of(i);
    for (int b = first; b <= last; ++b) unit.in_band[--unit.band_begin[size_t(b)]] = std::uint32_t(i);
  }
}

void SplatRenderer::add(const SplatUnit& unit, std::vector<FilmBuffer>& films) const {
  FilmBuffer& film = films[size_t(unit.replicate)];
  const int channels = film.measured_channels(), border = filter_.border();
  const size_t bands = unit.band_begin.size() - 1;
  for (size_t k = 0; k < bands; ++k) {
    // Units begin with different bands, so that threads do not queue.
    const size_t band = (k + unit.in_band.size()) % bands;
    if (unit.band_begin[band] == unit.band_begin[band + 1]) continue;
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
    for (size_t i = unit.band_begin[band], end = unit.band_begin[band + 1]; i < end; ++i) {
      // Splats fall anywhere on a film that no cache holds.
      if (i + 2 < end) prefetch(reach(unit.positions[unit.in_band[i + 2]]));
      const size_t splat = unit.in_band[i];
      const Vec2 s = unit.positions[splat];
      const float* measured = &unit.measured[splat * size_t(channels)];
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

void SplatRenderer::set_weights(RenderState& state) const {
  std::vector<std::int64_t> paths(state.films.size());
  for (size_t i = 0; i < state.done.size(); ++i)
    if (state.done[i]) {
      const WorkUnit u = state.unit(std::int64_t(i));
      paths[size_t(u.replicate)] += u.samples();
    }
  for (size_t r = 0; r < state.films.size(); ++r) {
    FilmBuffer& film = state.films[r];
    const int channels = film.measured_channels();
    for (int y = 0; y < film.height(); ++y)
      for (int x = 0; x < film.width(); ++x) {
        // A whole multiple, so that the weights of parts of a picture add up to those of the whole.
        const Fixed weight = Fixed(paths[r]) * to_fixed(weights_x_[size_t(x)] * weights_y_[size_t(y)]);
        Fixed* p = film.pixel(x, y);
        p[channels] = p[channels + 1] = weight;
      }
  }
}

}  // namespace aureole

// SPDX-License-Identifier: Apache-2.0
#include "aureole/render/splat_unit.h"

#include <algorithm>
#include <cmath>

#include "aureole/core/random.h"

namespace aureole {

namespace {

constexpr int kMaxReach = 65;  // as the job allows

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
  sample_area_ = float(film.crop_width() + 2 * outside) * float(film.crop_height() + 2 * outside);
  weights_x_ = filter_integrals(filter, film.crop_width(), outside);
  weights_y_ = filter_integrals(filter, film.crop_height(), outside);
}

void SplatRenderer::append(Vec2 position, const Spectrum& estimate, const Wavelengths& w, SplatUnit& unit,
                           bool& valid) const {
  const Film& film = scene_->film();
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
  // As a sample of the camera has them: place on the film, wavelengths, lens.
  const Film& film = scene_->film();
  const Sensor& sensor = scene_->sensor();
  const std::uint64_t pixel =
      std::uint64_t(std::uint32_t(y + film.crop_y())) << 32 | std::uint32_t(x + film.crop_x());
  const std::uint64_t key = combine_bits(combine_bits(seed_, std::uint64_t(replicate)), pixel);
  SampleStream stream(sensor.sampler(), key, std::uint32_t(index));
  const Vec2 position = stream.get2(0) + Vec2{float(x + film.crop_x()), float(y + film.crop_y())};
  const Wavelengths w = scene_->wavelengths().sample(stream.get1(2));
  const bool lens = sensor.uses_lens();
  const SensorRay camera = sensor.sample_ray(position, lens ? stream.get2(3) : Vec2{});
  stream.set_first(lens ? 5 : 3);

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
        if (!trace_path(x, y, i, u.replicate, result, no_log)) result.invalid.push_back({x, y, i});
}

void SplatRenderer::add(const SplatUnit& unit, std::vector<FilmBuffer>& films) const {
  FilmBuffer& film = films[size_t(unit.replicate)];
  const int channels = film.measured_channels(), border = filter_.border();
  float wx[kMaxReach], wy[kMaxReach];
  for (size_t i = 0; i < unit.positions.size(); ++i) {
    const Vec2 s = unit.positions[i];
    const float* measured = &unit.measured[i * size_t(channels)];
    const int x0 = int(std::floor(s.x)) - border, y0 = int(std::floor(s.y)) - border;
    const int x1 = std::min(x0 + 2 * border + 1, film.width()),
              y1 = std::min(y0 + 2 * border + 1, film.height());
    const int first_x = std::max(x0, 0), first_y = std::max(y0, 0);
    for (int x = first_x; x < x1; ++x) wx[x - x0] = border == 0 ? 1 : filter_.eval(float(x) + 0.5f - s.x);
    for (int y = first_y; y < y1; ++y) wy[y - y0] = border == 0 ? 1 : filter_.eval(float(y) + 0.5f - s.y);
    for (int y = first_y; y < y1; ++y)
      for (int x = first_x; x < x1; ++x) {
        Fixed* p = film.pixel(x, y);
        const float weight = wx[x - x0] * wy[y - y0];
        for (int c = 0; c < channels; ++c) p[c] += to_fixed(weight * measured[c]);
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

// SPDX-License-Identifier: Apache-2.0
#include "aureole/render/unit_renderer.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "aureole/render/camera_sample.h"

namespace aureole {

namespace {

/// Above this size, samples of the pilot are traced again instead of being kept.
constexpr double kMaxPilotBytes = double(512 << 20);

}  // namespace

/// Adds samples to the pixels in reach of the filter. Values of a row of pixels are contiguous, and so are
/// copies of a sample's values for that row. They are added as vectors, whatever the number of channels.
class UnitRenderer::SampleSpread {
public:
  /// Vector width in floats. Up to this many floats behind the last value of a row are rewritten with
  /// unchanged values.
  static constexpr int kTogether = 8;

  SampleSpread(const FilterTable& filter, int channels)
      : filter_(filter),
        channels_(channels),
        length_((2 * filter.border() + 1) * (channels + 2)),
        numbers_(size_t(padded(channels + 2)), 0.f),
        weights_(size_t(length_ + padded(channels + 2))),
        values_(weights_.size()) {}

  /// Adds sample `s`. `corner` is the first pixel in reach: its channels, alpha and weight; `row` is the
  /// distance of rows in floats.
  void add(const Sample& s, const float* values, float* corner, size_t row) {
    const int border = filter_.border(), stride = channels_ + 2, length = length_;
    const bool is_box = filter_.is_box();
    float *const numbers = numbers_.data(), *const weights = weights_.data(),
                 *const repeated = values_.data();
    for (int c = 0; c < channels_; ++c) numbers[c] = values[c];
    numbers[channels_] = s.alpha, numbers[channels_ + 1] = 1;
    for (int k = -border, at = 0; k <= border; ++k, at += stride) {
      const float weight = is_box ? 1.f : filter_.eval(float(s.id.x + k) + 0.5f - s.position.x);
      // Lanes behind the values of one pixel belong to the next one and are overwritten later, or are 0.
      for (int c = 0; c < stride; c += kTogether) {
        put(weights + at + c, weight - Lanes{});  // the weight in all lanes
        put(repeated + at + c, get(numbers + c));
      }
    }
    for (int k = -border; k <= border; ++k, corner += row) {
      const float weight =
          s.id.weight * (is_box ? 1.f : filter_.eval(float(s.id.y + k) + 0.5f - s.position.y));
      for (int i = 0; i < length; i += kTogether)
        put(corner + i, get(corner + i) + get(weights + i) * weight * get(repeated + i));
    }
  }

private:
  using Lanes = float __attribute__((vector_size(kTogether * sizeof(float))));
  static int padded(int n) { return (n + kTogether - 1) / kTogether * kTogether; }
  static Lanes get(const float* p) {
    Lanes v;
    std::memcpy(&v, p, sizeof v);
    return v;
  }
  static void put(float* p, const Lanes& v) { std::memcpy(p, &v, sizeof v); }

  const FilterTable& filter_;
  const int channels_, length_;  ///< floats of a row of pixels within reach of a sample
  std::vector<float> numbers_;   ///< values of the sample, padded with zeros
  std::vector<float> weights_, values_;
};

/// Collects samples in their order and traces their paths together, whether of one pixel or of several.
class UnitRenderer::Batch {
public:
  /// `splats` receives the splats of valid samples; it may be null if paths make none. `log` records the
  /// events of one path.
  Batch(const UnitRenderer& renderer, SplatList* splats, const BatchLog& log = {})
      : renderer_(renderer), splats_(splats), log_(log), measured_(size_t(renderer.channels_ * kPaths), 0.f) {
    for (int i = 0; i < kPaths; ++i) paths_[i].aovs = values(i) + renderer.scene_->film().measured_channels();
  }

  /// Appends a sample to be traced. A full batch is traced at once; `use(sample, measured)` is called for
  /// each of its samples in order.
  template <class Use>
  void add(const SampleId& id, std::uint64_t key, const Use& use) {
    const Film& film = renderer_.scene_->film();
    const int i = path_count_++;
    Entry& e = entries_[count_++];
    e.sample.id = id, e.path = i, e.values = values(i);
    const SensorRay camera =
        begin_camera_sample(*renderer_.scene_, key, id.x + film.crop_x(), id.y + film.crop_y(), id.index,
                            paths_[i].samples, paths_[i].wavelengths, positions_[i]);
    paths_[i].ray = camera.ray, paths_[i].film = positions_[i], weights_[i] = camera.weight;
    e.sample.position = positions_[i] - Vec2{float(film.crop_x()), float(film.crop_y())};
    if (path_count_ == kPaths || count_ == kEntries) finish(use);
  }
  /// Appends a sample that the pilot has traced.
  template <class Use>
  void add_traced(const SampleId& id, const float* record, const Use& use) {
    const float* rest = record + renderer_.channels_;
    entries_[count_++] = {{id, {rest[0], rest[1]}, rest[2], rest[3] != 0}, -1, record};
    if (count_ == kEntries) finish(use);
  }
  /// Traces the samples of the last, incomplete batch.
  template <class Use>
  void finish(const Use& use) {
    if (path_count_ > 0)
      renderer_.integrator_->estimate(*renderer_.scene_, std::span(paths_, size_t(path_count_)), found_,
                                      log_);
    bool valid[kPaths];
    for (int i = 0; i < path_count_; ++i) valid[i] = keep_result(i);
    if (splats_) {
      renderer_.splat_film_->append(found_, paths_, valid, *splats_);
      found_.clear();
    }
    for (int i = 0; i < count_; ++i) {
      Entry& e = entries_[i];
      if (e.path >= 0) {
        e.sample.alpha = paths_[e.path].result.alpha * paths_[e.path].wavelengths.time_weight;
        e.sample.valid = valid[e.path];
      }
      use(std::as_const(e.sample), e.values);
    }
    count_ = path_count_ = 0;
  }

private:
  static constexpr int kPaths = kBatch, kEntries = 4 * kPaths;
  struct Entry {
    Sample sample;
    int path;  ///< index of the path in the batch; -1: traced by the pilot
    const float* values;
  };
  float* values(int path) { return &measured_[size_t(path * renderer_.channels_)]; }

  /// Measures the radiance of a path, or turns it into a splat if it belongs to no pixel. Returns whether it
  /// is valid; its splats are checked later.
  bool keep_result(int i) {
    const Spectrum& estimate = paths_[i].result.estimate;
    if (renderer_.keeps_pixels_) return renderer_.measure(paths_[i], weights_[i], values(i));
    if (!is_black(estimate))
      found_.push_back({i, positions_[i], estimate * (weights_[i] * renderer_.splat_film_->sample_area())});
    return true;
  }

  const UnitRenderer& renderer_;
  SplatList* splats_;
  const BatchLog log_;
  Path paths_[kPaths];
  Vec2 positions_[kPaths];  ///< film position
  float weights_[kPaths];   ///< weight of the sensor's ray
  std::vector<Splat> found_;
  Entry entries_[kEntries];
  std::vector<float> measured_;
  int count_ = 0, path_count_ = 0;
};

UnitRenderer::UnitRenderer(const Scene& scene, const Integrator& integrator, const FilterTable& filter,
                           std::uint64_t seed, int measured_channels)
    : scene_(&scene),
      integrator_(&integrator),
      filter_(filter),
      seed_(seed),
      channels_(measured_channels),
      keeps_pixels_(integrator.leaves() != Integrator::Leaves::film) {
  if (integrator.leaves() != Integrator::Leaves::pixel)
    splat_film_.emplace(scene.film(), filter, scene.diffraction() != nullptr);
}

std::uint64_t UnitRenderer::key_of(int x, int y, int replicate) const {
  return pixel_key(seed_, replicate, x + scene_->film().crop_x(), y + scene_->film().crop_y());
}

bool UnitRenderer::measure(const Path& path, float sensor_weight, float* measured) const {
  // Diffracted fields that interfere destructively give negative estimates.
  if (!(scene_->diffraction() ? is_finite(path.result.estimate) : is_valid_radiance(path.result.estimate)))
    return false;
  scene_->film().measure(path.result.estimate * sensor_weight, path.wavelengths, measured);
  bool valid = true;
  for (int c = scene_->film().measured_channels(); path.wavelengths.time_weight != 1 && c < channels_; ++c)
    measured[c] *= path.wavelengths.time_weight;
  for (int c = 0; c < channels_; ++c) valid &= std::abs(measured[c]) < kFixedLimit;
  return valid;
}

void UnitRenderer::trace(const RenderState& layout, std::int64_t index, const Pilot* pilot,
                         UnitResult& result) const {
  const WorkUnit u = layout.unit(index);
  const int border = filter_.border(), stride = channels_ + 2;
  result.replicate = u.replicate;
  result.x0 = u.x0 - border, result.y0 = u.y0 - border;
  result.width = u.x1 - u.x0 + 2 * border, result.height = u.y1 - u.y0 + 2 * border;
  const size_t numbers = keeps_pixels_ ? size_t(result.width) * size_t(result.height) * size_t(stride) : 0;
  result.sums.assign(numbers > 0 ? numbers + SampleSpread::kTogether : 0, 0.f);
  result.splats.clear();
  result.invalid.clear();
  const auto pixel = [&](int x, int y) {
    return &result.sums[(size_t(y - result.y0) * size_t(result.width) + size_t(x - result.x0)) *
                        size_t(stride)];
  };
  SampleSpread spread(filter_, channels_);
  const auto use = [&](const Sample& s, const float* values) {
    if (!s.valid) {
      result.invalid.push_back({s.id.x, s.id.y, u.replicate, s.id.index});
      return;
    }
    if (!keeps_pixels_) return;
    spread.add(s, values, pixel(s.id.x - border, s.id.y - border), size_t(result.width) * size_t(stride));
  };
  Batch batch(*this, splat_film_ ? &result.splats : nullptr);
  for (int y = u.y0; y < u.y1; ++y)
    for (int x = u.x0; x < u.x1; ++x) {
      const std::uint64_t key = key_of(x, y, u.replicate);
      const int density = layout.density_exponent(x, y);
      const std::int64_t first = samples_up_to(u.first, density), last = samples_up_to(u.last, density);
      // All pixels have the same weight, whatever their density. Otherwise the filter would favour dense
      // pixels.
      const float weight = float(u.last - u.first) / float(last - first);
      std::int64_t i = first;
      if (pilot && !pilot->samples.empty() && u.replicate == 0) {
        const float* records = &pilot->samples[pilot_record(layout, x, y)];
        for (; i < std::min<std::int64_t>(last, kPilotSamples); ++i)
          batch.add_traced({x, y, i, weight}, records + size_t(i) * record_size(channels_), use);
      }
      for (; i < last; ++i) batch.add({x, y, i, weight}, key, use);
    }
  batch.finish(use);
  if (splat_film_) splat_film_->sort_into_bands(result.splats);
}

double UnitRenderer::kept_numbers(double pixels, int measured_channels, std::int64_t begin) {
  const double numbers = pixels * kPilotSamples * double(record_size(measured_channels));
  // A partial rendering that begins later contains no sample of the pilot.
  return begin == 0 && numbers * sizeof(float) <= kMaxPilotBytes ? numbers : 0;
}

double UnitRenderer::pilot_bytes(double pixels, int measured_channels, std::int64_t begin) {
  return pixels * sizeof(PixelNoise) + kept_numbers(pixels, measured_channels, begin) * sizeof(float);
}

size_t UnitRenderer::pilot_record(const RenderState& layout, int x, int y) const {
  return layout.pixel_index(x, y) * kPilotSamples * record_size(channels_);
}

Pilot UnitRenderer::make_pilot(const RenderState& layout) const {
  Pilot pilot;
  const size_t pixels = layout.sampled_pixels();
  pilot.noise.resize(pixels);
  pilot.samples.resize(size_t(kept_numbers(double(pixels), channels_, layout.begin)));
  return pilot;
}

void UnitRenderer::trace_pilot(const RenderState& layout, std::int64_t tile, Pilot& pilot) const {
  static_assert(kPilotSamples <= samples_up_to(kSampleBlock, kMinDensityExponent));
  const WorkUnit u = layout.unit(tile);
  const Film& film = scene_->film();
  struct Sums {
    double value[3] = {}, square[3] = {};
    int n = 0;
  };
  std::vector<Sums> sums(size_t(u.x1 - u.x0) * size_t(u.y1 - u.y0));
  std::vector<double> channels(size_t(film.measured_channels()));
  const auto at = [&](int x, int y) { return size_t(y - u.y0) * size_t(u.x1 - u.x0) + size_t(x - u.x0); };
  const auto use = [&](const Sample& s, const float* values) {
    if (!pilot.samples.empty()) {
      float* record =
          &pilot.samples[pilot_record(layout, s.id.x, s.id.y) + size_t(s.id.index) * record_size(channels_)];
      record = std::copy(values, values + channels_, record);
      record[0] = s.position.x, record[1] = s.position.y, record[2] = s.alpha, record[3] = s.valid;
    }
    if (!s.valid) return;
    std::copy(values, values + channels.size(), channels.begin());
    float rgb[3];
    film.develop_rgb(channels.data(), rgb);
    Sums& p = sums[at(s.id.x, s.id.y)];
    for (int c = 0; c < 3; ++c) p.value[c] += rgb[c], p.square[c] += double(rgb[c]) * rgb[c];
    ++p.n;
  };
  Batch batch(*this, nullptr);
  for (int y = u.y0; y < u.y1; ++y)
    for (int x = u.x0; x < u.x1; ++x) {
      const std::uint64_t key = key_of(x, y, 0);
      for (int i = 0; i < kPilotSamples; ++i) batch.add({x, y, i, 1.f}, key, use);
    }
  batch.finish(use);
  for (int y = u.y0; y < u.y1; ++y)
    for (int x = u.x0; x < u.x1; ++x) {
      const Sums& p = sums[at(x, y)];
      PixelNoise& result = pilot.noise[layout.pixel_index(x, y)];
      if (p.n < 2) continue;
      for (int c = 0; c < 3; ++c) {
        result.mean += float(p.value[c] / p.n / 3);
        result.variance += float(std::max(0.0, p.square[c] - p.value[c] * p.value[c] / p.n) / (p.n - 1) / 3);
      }
    }
}

std::vector<ReplayedSample> UnitRenderer::replay(int x, int y, std::int64_t first, std::int64_t last,
                                                 int replicate, const PathLog& log,
                                                 std::int64_t logged) const {
  std::vector<ReplayedSample> samples;
  SplatList splats;
  Batch batch(*this, splat_film_ ? &splats : nullptr, BatchLog(log, int(logged - first)));
  const auto use = [&](const Sample& s, const float* values) {
    ReplayedSample& r = samples.emplace_back();
    r.valid = s.valid;
    if (keeps_pixels_ && s.valid) r.measured.assign(values, values + channels_);
  };
  const std::uint64_t key = key_of(x, y, replicate);
  for (std::int64_t i = first; i < last; ++i) batch.add({x, y, i, 1.f}, key, use);
  batch.finish(use);
  const size_t channels = size_t(scene_->film().measured_channels());
  for (size_t k = 0; k < splats.paths.size(); ++k) {
    std::vector<float>& to = samples[size_t(splats.paths[k])].splatted;
    const auto from = splats.measured.begin() + std::ptrdiff_t(k * channels);
    to.insert(to.end(), from, from + std::ptrdiff_t(channels));
  }
  return samples;
}

}  // namespace aureole

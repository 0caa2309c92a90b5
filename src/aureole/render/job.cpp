// SPDX-License-Identifier: Apache-2.0
#include "aureole/render/job.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <mutex>
#include <shared_mutex>

#include "aureole/core/parallel.h"
#include "aureole/core/version.h"
#include "aureole/render/camera_sample.h"
#include "aureole/render/splat_unit.h"

namespace aureole {

struct RenderJob::Lock {
  std::mutex mutex;
  std::shared_mutex splats;  ///< locked after `mutex`; shared by threads that add splats
};

namespace {

double available_memory_bytes() {
  std::ifstream in("/proc/meminfo");
  std::string key, unit;
  double kib;
  while (in >> key >> kib >> unit)
    if (key == "MemAvailable:") return kib * 1024;
  return double(sysconf(_SC_PHYS_PAGES)) * double(sysconf(_SC_PAGESIZE));
}

double now_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

Development development_of(const Film& film, const std::vector<std::string>& aovs) {
  Development d;
  d.names = film.channel_names();
  d.half = film.pixel_type() == ExrPixel::half;
  const size_t channels = size_t(film.measured_channels());
  const bool alpha = d.names.back() == "A";
  const size_t own_rows = d.names.size() - (alpha ? 1 : 0);
  d.rows.assign(own_rows + aovs.size(), std::vector<float>(channels + aovs.size()));
  d.rgb_rows.assign(3, std::vector<float>(channels + aovs.size()));
  std::vector<float> out(d.names.size());
  for (size_t k = 0; k < channels; ++k) {
    std::vector<double> unit(channels, 0.0);
    unit[k] = 1;
    film.develop(unit.data(), 0, out.data());
    for (size_t c = 0; c < own_rows; ++c) d.rows[c][k] = out[c];
    float rgb[3];
    film.develop_rgb(unit.data(), rgb);
    for (size_t c = 0; c < 3; ++c) d.rgb_rows[c][k] = rgb[c];
  }
  d.names.insert(d.names.begin() + std::ptrdiff_t(own_rows), aovs.begin(), aovs.end());
  for (size_t k = 0; k < aovs.size(); ++k) d.rows[own_rows + k][channels + k] = 1;
  return d;
}

RenderJob::RenderJob(std::shared_ptr<const Scene> scene, const RenderOptions& options)
    : scene_(std::move(scene)),
      options_(options),
      filter_(scene_->film().filter()),
      lock_(std::make_shared<Lock>()) {
  const Object* integrator = scene_->integrator_object().get();
  integrator_ = dynamic_cast<const RadianceIntegrator*>(integrator);
  const auto* light_tracer = dynamic_cast<const SplatIntegrator*>(integrator);
  if (!integrator_ && !light_tracer) throw Error("the scene has no integrator");
  const Film& film = scene_->film();
  const Sampler& sampler = scene_->sensor().sampler();
  const std::int64_t end = options_.end.value_or(sampler.sample_count());
  if (end <= options_.begin || options_.begin < 0)
    throw Error(fmt::format("nothing to render: samples {}:{}", options_.begin, end));
  if (options_.begin % kSampleBlock != 0)
    throw Error(
        fmt::format("samples {}:{}: the first must be a multiple of {} (try {}), so that parts rendered "
                    "apart make the same picture",
                    options_.begin, end, kSampleBlock, options_.begin / kSampleBlock * kSampleBlock));
  if (options_.replicates < 1) throw Error("there must be at least one replicate");
  if (2 * filter_.border() + 1 > FilterTable::kMaxReach)
    throw Error(film.filter().properties().where(), "the reconstruction filter is wider than 65 pixels");
  // The samplers' index has 32 bits.
  if (end > std::int64_t(1) << 32)
    throw Error(fmt::format("samples {}:{}: at most 2^32 samples per pixel", options_.begin, end));
  seed_ = options_.seed.value_or(sampler.seed());
  if (light_tracer) splats_ = std::make_shared<SplatRenderer>(*scene_, *light_tracer, filter_, seed_);

  // A copy is needed to save or show it; a byte per work unit keeps account.
  const double units = double(film.crop_width() / kTileSize + 2) * (film.crop_height() / kTileSize + 2) *
                       options_.replicates * double((end - options_.begin) / kSampleBlock + 1);
  const std::vector<std::string> aovs = integrator_ ? integrator_->aov_names() : std::vector<std::string>();
  const int channels = film.measured_channels() + int(aovs.size());
  const double needed =
      2 * (units + state_bytes(film.crop_width(), film.crop_height(), channels, options_.replicates));
  const double available = available_memory_bytes();
  if (needed > 0.8 * available)
    throw Error(
        film.properties().where(),
        fmt::format("a picture of {} x {} pixels and {} samples{} needs about {:.1f} GiB of memory, and "
                    "{:.1f} GiB are "
                    "available: render it in "
                    "parts with crop_offset_x, crop_width, ... or --samples",
                    film.crop_width(), film.crop_height(), end - options_.begin,
                    options_.replicates > 1 ? fmt::format(" and {} replicates", options_.replicates) : "",
                    needed / (1 << 30), available / (1 << 30)));
  PictureIdentity id;
  id.scene = scene_->loaded().file.filename().string();
  id.version = kVersion;
  id.sampler = sampler.properties().type();
  id.integrator = integrator->properties().type();
  id.scene_hash = scene_->hash();
  id.seed = seed_;
  id.wavelengths = kWavelengths;
  id.width = film.crop_width(), id.height = film.crop_height();
  id.border = film.sample_border() ? filter_.border() : 0;
  id.measured_channels = channels;
  id.replicates = options_.replicates;
  state_ = RenderState(std::move(id), development_of(film, aovs), options_.begin, end);
}

void RenderJob::resume(RenderState state) {
  if (const std::string d = state_.identity.difference(state.identity); !d.empty())
    throw Error("the saved state belongs to another picture: they differ in their " + d);
  state.set_range(state_.begin, state_.end);
  state_ = std::move(state);
  wrote_state_ = true;
}

void RenderJob::camera_path(int x, int y, std::uint64_t key, std::int64_t index, CameraPath& path,
                            Sample& sample) const {
  const Film& film = scene_->film();
  const SensorRay camera = begin_camera_sample(*scene_, key, x + film.crop_x(), y + film.crop_y(), index,
                                               path.samples, path.wavelengths, sample.position);
  sample.position = sample.position - Vec2{float(film.crop_x()), float(film.crop_y())};
  path.ray = camera.ray;
  sample.weight = camera.weight;
}

std::uint64_t RenderJob::key_of(int x, int y, int replicate) const {
  return pixel_key(seed_, replicate, x + scene_->film().crop_x(), y + scene_->film().crop_y());
}

void RenderJob::measure(const CameraPath& path, Sample& sample, float* measured) const {
  sample.alpha = path.result.alpha;
  sample.valid = is_valid_radiance(path.result.estimate);
  if (!sample.valid) return;
  scene_->film().measure(path.result.estimate * sample.weight, path.wavelengths, measured);
  for (int c = 0; c < state_.identity.measured_channels; ++c)
    sample.valid &= std::abs(measured[c]) < kFixedLimit;
}

void RenderJob::render_light_unit(std::int64_t unit) {
  SplatUnit result;
  splats_->trace(state_, unit, result);
  std::shared_lock adding(lock_->splats, std::defer_lock);
  {
    // Counted as done before it is added, and not looked at before it is: who looks holds both locks, and
    // while he waits for the second nobody begins to add.
    const std::lock_guard guard(lock_->mutex);
    state_.done[size_t(unit)] = 1;
    state_.invalid_samples += result.invalid.size();
    for (const auto& s : result.invalid)
      if (invalid_.size() < 16)
        invalid_.push_back(
            {s.x + scene_->film().crop_x(), s.y + scene_->film().crop_y(), result.replicate, s.sample});
    adding.lock();
  }
  splats_->add(result, state_.films);
}

void RenderJob::render_unit(std::int64_t unit, std::vector<float>& sums) {
  if (splats_) return render_light_unit(unit);
  const auto [replicate, x0, y0, x1, y1, first, last] = state_.unit(unit);
  const int border = filter_.border(), channels = state_.identity.measured_channels, stride = channels + 2;
  const int width = x1 - x0 + 2 * border, height = y1 - y0 + 2 * border;
  sums.assign(size_t(width) * size_t(height) * size_t(stride), 0.f);
  std::vector<InvalidSample> invalid;
  std::vector<float> measured(size_t(channels * kSampleBlock), 0.f);
  float wx[FilterTable::kMaxReach], wy[FilterTable::kMaxReach];
  const int reach = 2 * border + 1;
  const int film_channels = scene_->film().measured_channels();
  CameraPath paths[kSampleBlock];
  Sample samples[kSampleBlock];
  static_assert(kSampleBlock <= RadianceIntegrator::kTogether);
  const int count = int(last - first);
  for (int y = y0; y < y1; ++y)
    for (int x = x0; x < x1; ++x) {
      const std::uint64_t key = key_of(x, y, replicate);
      for (int i = 0; i < count; ++i) {
        camera_path(x, y, key, first + i, paths[i], samples[i]);
        paths[i].aovs = &measured[size_t(i * channels + film_channels)];
      }
      integrator_->radiance_of(*scene_, std::span(paths, size_t(count)));
      for (int i = 0; i < count; ++i) {
        Sample& s = samples[i];
        const float* values = &measured[size_t(i * channels)];
        measure(paths[i], s, &measured[size_t(i * channels)]);
        if (!s.valid) {
          invalid.push_back({x + scene_->film().crop_x(), y + scene_->film().crop_y(), replicate, first + i});
          continue;
        }
        if (border == 0) {
          float* p = &sums[(size_t(y - y0) * size_t(width) + size_t(x - x0)) * size_t(stride)];
          for (int c = 0; c < channels; ++c) p[c] += values[c];
          p[channels] += s.alpha;
          p[channels + 1] += 1;
          continue;
        }
        for (int k = 0; k < reach; ++k) {
          wx[k] = filter_.eval(float(x - border + k) + 0.5f - s.position.x);
          wy[k] = filter_.eval(float(y - border + k) + 0.5f - s.position.y);
        }
        for (int j = 0; j < reach; ++j) {
          float* p = &sums[(size_t(y - y0 + j) * size_t(width) + size_t(x - x0)) * size_t(stride)];
          for (int k = 0; k < reach; ++k, p += stride) {
            const float weight = wx[k] * wy[j];
            for (int c = 0; c < channels; ++c) p[c] += weight * values[c];
            p[channels] += weight * s.alpha;
            p[channels + 1] += weight;
          }
        }
      }
    }
  const std::lock_guard guard(lock_->mutex);
  state_.films[size_t(replicate)].add(x0 - border, y0 - border, width, height, sums.data());
  state_.done[size_t(unit)] = 1;
  state_.invalid_samples += invalid.size();
  for (const auto& s : invalid)
    if (invalid_.size() < 16) invalid_.push_back(s);
}

RenderState RenderJob::snapshot() const {
  const std::lock_guard guard(lock_->mutex);
  const std::lock_guard alone(lock_->splats);
  RenderState copy = state_;
  if (splats_) splats_->set_weights(copy);
  return copy;
}

RenderJob::Outcome RenderJob::run(const std::atomic<bool>& stop,
                                  const std::function<void(const Progress&)>& report) {
  const double start = now_s(), spent_before = state_.seconds;
  double last_checkpoint = start;
  const std::int64_t units = state_.units(), done_at_start = state_.units_done();
  const double samples_per_unit =
      double(state_.identity.width) * state_.identity.height * kSampleBlock / double(state_.tiles());
  const int threads = options_.threads > 0 ? options_.threads : default_thread_count();

  std::atomic<std::int64_t> next{0}, finished{0};
  std::atomic<bool> failed{false};
  std::int64_t limit = units;
  const auto work = [&](int thread) {
    std::vector<float> sums;
    double last_report = now_s();
    try {
      while (!stop.load(std::memory_order_relaxed) && !failed.load(std::memory_order_relaxed)) {
        const std::int64_t unit = next.fetch_add(1);
        if (unit >= limit) return;
        if (state_.done[size_t(unit)]) continue;
        render_unit(unit, sums);
        ++finished;
        if (thread != 0) continue;
        const double t = now_s();
        if (report && t - last_report > 0.2) {
          last_report = t;
          report({done_at_start + finished, units, t - start,
                  double(finished) * samples_per_unit / (t - start)});
        }
        if (!options_.state_file.empty() && t - last_checkpoint > options_.checkpoint_interval_s) {
          checkpoint(spent_before + t - start);
          last_checkpoint = now_s();
        }
      }
    } catch (...) {
      failed = true;
      throw;
    }
  };
  bool out_of_time = false;
  if (options_.time_limit_s <= 0) {
    run_workers(threads, work);
  } else {
    // With a time limit all threads meet after each block, so that the picture ends on whole blocks that
    // every pixel has.
    const std::int64_t per_block = state_.units_per_block();
    for (std::int64_t begin = 0; begin < units && !stop && !out_of_time; begin += per_block) {
      const std::int64_t finished_before = finished;
      next = begin;
      limit = begin + per_block;
      run_workers(threads, work);
      out_of_time = finished > finished_before && now_s() - start >= options_.time_limit_s && limit < units;
    }
  }
  const double seconds = now_s() - start;
  const bool complete = state_.units_done() == units;
  if (report)
    report({done_at_start + finished, units, seconds,
            double(finished) * samples_per_unit / std::max(1e-9, seconds)});
  if (!options_.state_file.empty() && (!complete || options_.keep_state)) {
    checkpoint(spent_before + seconds);
  } else {
    const std::lock_guard guard(lock_->mutex);
    const std::lock_guard alone(lock_->splats);
    state_.seconds = spent_before + seconds;
    if (splats_) splats_->set_weights(state_);
  }
  return complete ? Outcome::finished : out_of_time ? Outcome::time_limit : Outcome::interrupted;
}

void RenderJob::checkpoint(double seconds) {
  const std::lock_guard guard(lock_->mutex);
  const std::lock_guard alone(lock_->splats);
  state_.seconds = seconds;
  if (splats_) splats_->set_weights(state_);
  try {
    state_.save(options_.state_file);
    wrote_state_ = true;
    checkpoint_problem_.clear();
  } catch (const std::exception& e) {
    // A full disc must not cost the picture: it is kept in memory, and the next checkpoint tries again.
    checkpoint_problem_ = e.what();
  }
}

void RenderJob::remove_state() const {
  std::error_code ignored;
  if (wrote_state_ && !options_.keep_state && state_.units_done() == state_.units())
    std::filesystem::remove(options_.state_file, ignored);
}

std::optional<std::vector<float>> RenderJob::replay(int x, int y, std::int64_t sample, int replicate,
                                                    const PathLog& log) const {
  const Film& film = scene_->film();
  if (splats_) {
    SplatUnit path;
    if (!splats_->trace_path(x - film.crop_x(), y - film.crop_y(), sample, replicate, path, log)) return {};
    return path.measured;
  }
  std::vector<float> measured(size_t(state_.identity.measured_channels));
  Sample s;
  CameraPath path;
  x -= film.crop_x(), y -= film.crop_y();
  camera_path(x, y, key_of(x, y, replicate), sample, path, s);
  path.result = integrator_->radiance(*scene_, path.ray, path.wavelengths, path.samples, log,
                                      measured.data() + film.measured_channels());
  measure(path, s, measured.data());
  if (!s.valid) return {};
  return measured;
}

}  // namespace aureole

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
#include "aureole/render/camera_unit.h"
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
  const auto* path_tracer = dynamic_cast<const RadianceIntegrator*>(integrator);
  const auto* light_tracer = dynamic_cast<const SplatIntegrator*>(integrator);
  if (!path_tracer && !light_tracer) throw Error("the scene has no integrator");
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
  const std::uint64_t seed = options_.seed.value_or(sampler.seed());
  AdaptiveTarget adaptive = options_.adaptive.value_or(sampler.adaptive());
  // Less than a block is less than twice the pilot.
  if (end - options_.begin < kSampleBlock) adaptive = AdaptiveTarget::none;
  if (adaptive != AdaptiveTarget::none) {
    if (light_tracer)
      throw Error(
          integrator->properties().where(),
          fmt::format("paths of \"{}\" start at emitters: they can't be adaptive to pixels (\"adaptive\" "
                      "of the sampler, or --adaptive, must be none)",
                      integrator->properties().type()));
    if (end > (std::int64_t(1) << 32) >> kMaxDensityExponent)
      throw Error(fmt::format("samples {}:{}: at most 2^{} samples per pixel where they are adaptive",
                              options_.begin, end, 32 - kMaxDensityExponent));
  }

  // A copy is needed to save or show it; a byte per work unit keeps account.
  const double units = double(film.crop_width() / kTileSize + 2) * (film.crop_height() / kTileSize + 2) *
                       options_.replicates * double((end - options_.begin) / kSampleBlock + 1);
  const std::vector<std::string> aovs = path_tracer ? path_tracer->aov_names() : std::vector<std::string>();
  const int channels = film.measured_channels() + int(aovs.size());
  const int outside = film.sample_border() ? filter_.border() : 0;
  const double sampled = double(film.crop_width() + 2 * outside) * (film.crop_height() + 2 * outside);
  const double needed =
      2 * (units + state_bytes(film.crop_width(), film.crop_height(), channels, options_.replicates)) +
      (adaptive != AdaptiveTarget::none
           ? CameraRenderer::pilot_bytes(sampled, channels, options_.begin) + density_bytes(sampled)
           : 0);
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
  id.adaptive = name_of(adaptive);
  id.seed = seed;
  id.wavelengths = kWavelengths;
  id.width = film.crop_width(), id.height = film.crop_height();
  id.border = outside;
  id.measured_channels = channels;
  id.replicates = options_.replicates;
  state_ = RenderState(std::move(id), development_of(film, aovs), options_.begin, end);
  if (light_tracer)
    splats_ = std::make_shared<SplatRenderer>(*scene_, *light_tracer, filter_, seed);
  else
    camera_ = std::make_shared<CameraRenderer>(*scene_, *path_tracer, filter_, seed, channels);
}

void RenderJob::resume(RenderState state) {
  if (const std::string d = state_.identity.difference(state.identity); !d.empty())
    throw Error("the saved state belongs to another picture: they differ in their " + d);
  state.set_range(state_.begin, state_.end);
  state_ = std::move(state);
  pilot_.reset();
  pilot_tiles_left_ = 0;
  wrote_state_ = true;
}

void RenderJob::count_as_done(std::int64_t unit, const std::vector<InvalidSample>& invalid) {
  const Film& film = scene_->film();
  state_.done[size_t(unit)] = 1;
  state_.invalid_samples += invalid.size();
  for (const InvalidSample& s : invalid)
    if (invalid_.size() < 16)
      invalid_.push_back({s.x + film.crop_x(), s.y + film.crop_y(), s.replicate, s.sample});
}

void RenderJob::render_light_unit(std::int64_t unit) {
  SplatUnit result;
  splats_->trace(state_, unit, result);
  std::shared_lock adding(lock_->splats, std::defer_lock);
  {
    // Counted as done before it is added, and not looked at before it is: who looks holds both locks, and
    // while he waits for the second nobody begins to add.
    const std::lock_guard guard(lock_->mutex);
    count_as_done(unit, result.invalid);
    adding.lock();
  }
  splats_->add(result, state_.films);
}

void RenderJob::render_unit(std::int64_t unit, CameraUnit& result) {
  if (splats_) return render_light_unit(unit);
  const bool in_pilot = pilot_tiles_left_ > 0 && unit < state_.tiles();
  camera_->trace(state_, unit, in_pilot ? pilot_.get() : nullptr, result);
  const std::lock_guard guard(lock_->mutex);
  state_.films[size_t(result.replicate)].add(result.x0, result.y0, result.width, result.height,
                                             result.sums.data());
  count_as_done(unit, result.invalid);
  if (in_pilot && --pilot_tiles_left_ == 0) pilot_.reset();
}

void RenderJob::find_densities(int threads, const std::atomic<bool>& stop,
                               const std::function<void(std::int64_t)>& report) {
  const auto pilot = std::make_shared<Pilot>(camera_->make_pilot(state_));
  std::atomic<std::int64_t> next{0}, traced{0};
  std::atomic<bool> failed{false};
  run_workers(threads, [&](int thread) {
    try {
      while (!stop.load(std::memory_order_relaxed) && !failed.load(std::memory_order_relaxed)) {
        const std::int64_t tile = next.fetch_add(1);
        if (tile >= state_.tiles()) return;
        camera_->trace_pilot(state_, tile, *pilot);
        ++traced;
        if (thread == 0) report(traced);
      }
    } catch (...) {
      failed = true;
      throw;
    }
  });
  report(traced);
  if (traced < state_.tiles()) return;
  std::vector<std::int8_t> density =
      sample_densities(state_.sampled_width(), state_.sampled_height(), pilot->noise,
                       adaptive_target(state_.identity.adaptive));
  const std::lock_guard guard(lock_->mutex);
  state_.density = std::move(density);
  // Its samples are those of the first units, which are the tiles of replicate 0.
  if (state_.begin == 0)
    pilot_tiles_left_ =
        std::count(state_.done.begin(), state_.done.begin() + state_.tiles(), std::uint8_t(0));
  if (pilot_tiles_left_ > 0) pilot_ = pilot;
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

  // Tiles of the pilot count as units, though they have fewer samples.
  const bool with_pilot =
      state_.identity.adaptive != "none" && state_.density.empty() && done_at_start < units;
  const std::int64_t all_units = units + (with_pilot ? state_.tiles() : 0);
  std::int64_t traced = 0;
  const auto report_units = [&](std::int64_t finished, double seconds) {
    const double blocks = double(finished) + double(traced) * kPilotSamples / kSampleBlock;
    report({done_at_start + traced + finished, all_units, seconds,
            blocks * samples_per_unit / std::max(1e-9, seconds)});
  };
  if (with_pilot) {
    double last_report = now_s();
    find_densities(threads, stop, [&](std::int64_t tiles) {
      traced = tiles;
      const double t = now_s();
      if (!report || t - last_report <= 0.2) return;
      last_report = t;
      report_units(0, t - start);
    });
  }

  std::atomic<std::int64_t> next{0}, finished{0};
  std::atomic<bool> failed{false};
  std::int64_t limit = units;
  const auto work = [&](int thread) {
    CameraUnit buffers;
    double last_report = now_s();
    try {
      while (!stop.load(std::memory_order_relaxed) && !failed.load(std::memory_order_relaxed)) {
        const std::int64_t unit = next.fetch_add(1);
        if (unit >= limit) return;
        if (state_.done[size_t(unit)]) continue;
        render_unit(unit, buffers);
        ++finished;
        if (thread != 0) continue;
        const double t = now_s();
        if (report && t - last_report > 0.2) {
          last_report = t;
          report_units(finished, t - start);
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
  if (report) report_units(finished, seconds);
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
  return camera_->replay(x - film.crop_x(), y - film.crop_y(), sample, replicate, log);
}

}  // namespace aureole

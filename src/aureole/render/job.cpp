// SPDX-License-Identifier: Apache-2.0
#include "aureole/render/job.h"

#include <algorithm>
#include <chrono>
#include <mutex>
#include <shared_mutex>

#include "aureole/core/parallel.h"

namespace aureole {

struct RenderJob::Lock {
  std::mutex mutex;
  std::shared_mutex splats;  ///< locked after `mutex`; threads that add splats hold it as readers
};

namespace {

constexpr double kFirstCheckpoint_s = 2;

double now_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

RenderJob::RenderJob(const LoadedScene& loaded, const RenderOptions& options)
    : scene_(loaded.scene),
      integrator_(loaded.integrator),
      options_(options),
      state_(planned_state(loaded, options)),
      lock_(std::make_shared<Lock>()) {
  renderer_ = std::make_shared<UnitRenderer>(*scene_, *integrator_, FilterTable(scene_->film().filter()),
                                             state_.identity.seed, state_.identity.measured_channels);
  if (const auto& units = options.units;
      units && !(units->begin >= 0 && units->begin < units->end && units->end <= state_.units()))
    throw Error("the units " + std::to_string(units->begin) + " to " + std::to_string(units->end) +
                " are not a part of the " + std::to_string(state_.units()) + " of this picture");
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
  state_.done.insert(unit);
  state_.invalid_samples += invalid.size();
  for (const InvalidSample& s : invalid)
    if (invalid_.size() < 16)
      invalid_.push_back({s.x + film.crop_x(), s.y + film.crop_y(), s.replicate, s.sample});
}

void RenderJob::render_unit(std::int64_t unit, UnitResult& result) {
  const bool in_pilot = pilot_tiles_left_ > 0 && unit < state_.tiles();
  renderer_->trace(state_, unit, in_pilot ? pilot_.get() : nullptr, result);
  const SplatFilm* splats = renderer_->splat_film();
  std::shared_lock adding(lock_->splats, std::defer_lock);
  {
    const std::lock_guard guard(lock_->mutex);
    if (!result.sums.empty())
      state_.films[size_t(result.replicate)].add(result.x0, result.y0, result.width, result.height,
                                                 result.sums.data());
    count_as_done(unit, result.invalid);
    if (in_pilot && --pilot_tiles_left_ == 0) pilot_.reset();
    // The unit is marked as done before its splats are added. Code that reads the state holds both locks, so
    // that it waits until the splats of all units marked as done are added.
    if (splats) adding.lock();
  }
  if (splats) splats->add(result.splats, state_.splat_film(size_t(result.replicate)));
}

void RenderJob::find_densities(int threads, const std::atomic<bool>& stop,
                               const std::function<void(std::int64_t)>& report) {
  const auto pilot = std::make_shared<Pilot>(renderer_->make_pilot(state_));
  std::atomic<std::int64_t> next{0}, traced{0};
  std::atomic<bool> failed{false};
  run_workers(threads, [&](int thread) {
    try {
      while (!stop.load(std::memory_order_relaxed) && !failed.load(std::memory_order_relaxed)) {
        const std::int64_t tile = next.fetch_add(1);
        if (tile >= state_.tiles()) return;
        renderer_->trace_pilot(state_, tile, *pilot);
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
  // The pilot's samples belong to the first units of the job, which are the tiles of replicate 0.
  if (state_.begin == 0) pilot_tiles_left_ = state_.tiles() - state_.done.count({0, state_.tiles()});
  if (pilot_tiles_left_ > 0) pilot_ = pilot;
}

RenderState RenderJob::snapshot() const {
  const std::lock_guard guard(lock_->mutex);
  const std::lock_guard alone(lock_->splats);
  RenderState copy = state_;
  finish(copy);
  return copy;
}

void RenderJob::measure_approximations(int threads) {
  const PictureIdentity& picture = state_.identity;
  const double samples =
      double(state_.end - state_.begin) * picture.width * picture.height * picture.replicates;
  std::vector<std::string> texts;
  for (ApproximationError& error : integrator_->approximation_errors(*scene_, samples, threads))
    texts.push_back(std::move(error.text));
  const std::lock_guard guard(lock_->mutex);
  state_.approximations = std::move(texts);
}

void RenderJob::finish(RenderState& state) const {
  if (renderer_->splat_film()) renderer_->splat_film()->set_weights(state);
}

RenderJob::Outcome RenderJob::run(const std::atomic<bool>& stop,
                                  const std::function<void(const Progress&)>& report) {
  const double start = now_s(), spent_before = state_.seconds;
  // The first checkpoint comes early, so that a job killed in its first half minute loses little.
  double last_checkpoint = start,
         until_checkpoint = std::min(kFirstCheckpoint_s, options_.checkpoint_interval_s);
  const std::int64_t units = state_.units(), done_at_start = state_.units_done();
  const double samples_per_unit =
      double(state_.identity.width) * state_.identity.height * kSampleBlock / double(state_.tiles());
  const int threads = options_.threads > 0 ? options_.threads : default_thread_count();

  // Tiles of the pilot count as units, although they have fewer samples.
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

  const UnitRanges::Range wanted = options_.units.value_or(UnitRanges::Range{0, units});
  std::atomic<std::int64_t> next{wanted.begin}, finished{0};
  std::atomic<bool> failed{false};
  const UnitRanges done_before = state_.done;
  std::int64_t limit = wanted.end;
  const auto work = [&](int thread) {
    UnitResult buffers;
    double last_report = now_s();
    try {
      while (!stop.load(std::memory_order_relaxed) && !failed.load(std::memory_order_relaxed)) {
        const std::int64_t unit = next.fetch_add(1);
        if (unit >= limit) return;
        if (const std::int64_t end = done_before.end_of(unit); end > unit) {
          for (std::int64_t n = next; n < end && !next.compare_exchange_weak(n, end);) {
          }
          continue;
        }
        render_unit(unit, buffers);
        ++finished;
        if (thread != 0) continue;
        const double t = now_s();
        if (report && t - last_report > 0.2) {
          last_report = t;
          report_units(finished, t - start);
        }
        if (!options_.state_file.empty() && t - last_checkpoint > until_checkpoint) {
          checkpoint(spent_before + t - start);
          last_checkpoint = now_s(), until_checkpoint = options_.checkpoint_interval_s;
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
    // With a time limit, all threads synchronise after each block, so that the picture ends with whole blocks
    // that every pixel has.
    const std::int64_t per_block = state_.units_per_block();
    for (std::int64_t begin = 0; begin < units && !stop && !out_of_time; begin += per_block) {
      if (done_before.contains({begin, begin + per_block})) continue;
      const std::int64_t finished_before = finished;
      next = begin;
      limit = begin + per_block;
      run_workers(threads, work);
      out_of_time = finished > finished_before && now_s() - start >= options_.time_limit_s && limit < units;
    }
  }
  const bool complete = state_.done.contains(wanted);
  // One of several parts of a picture, or one that continues later, would repeat the work of the others.
  if ((complete || out_of_time) && !options_.units) measure_approximations(threads);
  const double seconds = now_s() - start;
  if (report) report_units(finished, seconds);
  if (!options_.state_file.empty() && (!complete || options_.keep_state)) {
    checkpoint(spent_before + seconds);
  } else {
    const std::lock_guard guard(lock_->mutex);
    const std::lock_guard alone(lock_->splats);
    state_.seconds = spent_before + seconds;
    finish(state_);
  }
  return complete ? Outcome::finished : out_of_time ? Outcome::time_limit : Outcome::interrupted;
}

void RenderJob::checkpoint(double seconds) {
  const std::lock_guard guard(lock_->mutex);
  const std::lock_guard alone(lock_->splats);
  state_.seconds = seconds;
  finish(state_);
  try {
    state_.save(options_.state_file);
    wrote_state_ = true;
    checkpoint_problem_.clear();
  } catch (const std::exception& e) {
    // A full disc must not lose the picture: it stays in memory, and the next checkpoint tries again.
    checkpoint_problem_ = e.what();
  }
}

void RenderJob::remove_state() const {
  std::error_code ignored;
  if (wrote_state_ && !options_.keep_state && state_.units_done() == state_.units())
    std::filesystem::remove(options_.state_file, ignored);
}

ReplayedSample RenderJob::replay(int x, int y, std::int64_t sample, int replicate, const PathLog& log) const {
  const Film& film = scene_->film();
  const std::int64_t first = sample / kSampleBlock * kSampleBlock;
  const std::int64_t last = std::min(first + kSampleBlock, std::max(state_.end, sample + 1));
  return std::move(renderer_->replay(x - film.crop_x(), y - film.crop_y(), first, last, replicate, log,
                                     sample)[size_t(sample - first)]);
}

std::vector<ReplayedSample> RenderJob::replay_block(int x, int y, std::int64_t first, std::int64_t last,
                                                    int replicate) const {
  const Film& film = scene_->film();
  return renderer_->replay(x - film.crop_x(), y - film.crop_y(), first, last, replicate, {}, -1);
}

}  // namespace aureole

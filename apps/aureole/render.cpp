// SPDX-License-Identifier: Apache-2.0
// aureole render: renders a scene file to a picture.
#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <mutex>
#include <thread>

#include "aureole/core/error.h"
#include "aureole/core/letter_case.h"
#include "aureole/core/output_file.h"
#include "aureole/core/units.h"
#include "aureole/core/workers.h"
#include "aureole/instrument/picture/tev_viewer.h"
#include "aureole/render/job.h"
#include "aureole/render/output.h"
#include "aureole/render/plan.h"
#include "aureole/render/sample_density.h"
#include "command.h"
#include "measured_scene.h"
#include "messages.h"
#include "package_command.h"
#include "picture_file.h"
#include "scene_loading.h"
#include "table_progress_line.h"

namespace aureole {
namespace {

std::atomic<bool> stop_requested{false};
extern "C" void request_stop(int) {
  // A second Ctrl-C ends the program immediately.
  if (stop_requested.exchange(true)) _exit(130);
}

struct Arguments {
  std::string scene, output, samples, sampler, integrator, pixel, adaptive, tonemap, tev;

  std::optional<Tone> tone() const {
    if (tonemap.empty()) return {};
    try {
      return Tone::parse(tonemap);
    } catch (const Error& e) {
      throw Error("--tonemap " + e.message());
    }
  }
  std::vector<std::string> defines;
  std::optional<std::int64_t> spp, seed;
  int threads = 0, replicates = 1;
  double time_s = 0, checkpoint_s = 30;
  bool resume = false, restart = false, preview = false, quiet = false, denoise = false;
};

/// Parses "A:B" to two integers.
std::pair<std::int64_t, std::int64_t> parse_pair(const std::string& text, char separator,
                                                 const char* option) {
  const size_t at = text.find(separator);
  if (at != std::string::npos) {
    try {
      const double a = parse_number(text.substr(0, at)), b = parse_number(text.substr(at + 1));
      if (a == std::floor(a) && b == std::floor(b) && std::abs(a) < 1e15 && std::abs(b) < 1e15)
        return {std::int64_t(a), std::int64_t(b)};
    } catch (const Error&) {
    }
  }
  throw Error(fmt::format("{} {}: expected two integers, such as {} 0{}64", option, text, option, separator));
}

class ProgressLine {
public:
  explicit ProgressLine(bool quiet) : shown_(!quiet && isatty(2)) {}
  ~ProgressLine() { clear(); }
  void show(const Progress& p) {
    if (!shown_) return;
    const double part = p.units > 0 ? double(p.units_done) / double(p.units) : 1.0;
    const double left =
        p.samples_per_second > 0 && part > 0 ? p.seconds * (1 - part) / std::max(part, 1e-9) : 0;
    const int width = 30, filled = int(part * width);
    std::fprintf(stderr, "\r[%.*s%*s] %5.1f %%  %.2f Msamples/s  %s left \033[K", filled,
                 "##############################", width - filled, "", 100 * part,
                 p.samples_per_second * 1e-6, clock_text(left).c_str());
    std::fflush(stderr);
  }
  void clear() {
    if (shown_) std::fprintf(stderr, "\r\033[K");
  }

private:
  bool shown_;
};

/// Updates the PNG, or the picture in a viewer, every few seconds while a job runs.
class Preview {
public:
  /// Prepares previews. Without `has_png` the viewer alone is updated, and without a viewer the PNG alone.
  Preview(const RenderJob& job, std::filesystem::path output, const std::optional<Tone>& tone, bool has_png,
          std::unique_ptr<TevViewer> viewer)
      : job_(job),
        output_(std::move(output)),
        tone_(tone),
        has_png_(has_png),
        viewer_(std::move(viewer)),
        thread_([this] { loop(); }) {}
  /// Shows the last picture in the viewer.
  ~Preview() {
    done_ = true;
    thread_.join();
    try {
      update();
    } catch (const std::exception& e) {
      tell("note: the viewer does not have the last picture: {}\n", e.what());
    }
  }

private:
  void loop() {
    for (int tick = 1; !done_; ++tick) {
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
      try {
        if (tick % 20 == 0) update();
      } catch (const std::exception& e) {
        tell("\nnote: no more previews: {}\n", e.what());
        viewer_.reset();
        return;
      }
    }
  }
  void update() {
    const RenderState state = job_.snapshot();
    if (state.units_done() == 0) return;
    if (has_png_ && !done_) write_preview(state, output_, tone_);
    if (viewer_) viewer_->show(output_.filename().string(), state.picture());
  }

  const RenderJob& job_;
  std::filesystem::path output_;
  std::optional<Tone> tone_;
  bool has_png_;
  std::unique_ptr<TevViewer> viewer_;
  std::atomic<bool> done_{false};
  std::thread thread_;
};

/// Traces samples [begin, end) of a pixel again, as the job does, and prints the events of each if there are
/// few.
template <class Use>
void replay_samples(const RenderJob& job, int x, int y, std::int64_t begin, std::int64_t end,
                    const char* name, const Use& use) {
  const auto check = [&](std::int64_t i, const ReplayedSample& s) {
    if (!s.valid) fmt::print("{} {}: INVALID (NaN, infinite or negative radiance)\n", name, i);
    if (s.valid) use(s);
  };
  if (end - begin <= kSampleBlock) {
    for (std::int64_t i = begin; i < end; ++i) {
      fmt::print("{} {}\n", name, i);
      check(i, job.replay(x, y, i, 0, [](const PathEvent& event) { fmt::print("{}\n", to_string(event)); }));
    }
    return;
  }
  for (std::int64_t first = begin; first < end; first += kSampleBlock) {
    const auto samples = job.replay_block(x, y, first, std::min(first + kSampleBlock, end), 0);
    for (size_t k = 0; k < samples.size(); ++k) check(first + std::int64_t(k), samples[k]);
  }
}

int replay_pixel(const RenderJob& job, const Film& film, const Arguments& a, const RenderOptions& options) {
  const auto [x, y] = parse_pair(a.pixel, ',', "--pixel");
  if (x < film.crop_x() || y < film.crop_y() || x >= film.crop_x() + film.crop_width() ||
      y >= film.crop_y() + film.crop_height())
    throw Error(fmt::format("--pixel {}: outside the film ({} x {})", a.pixel, film.width(), film.height()));
  const std::int64_t begin = options.begin, end = job.state().end;
  const bool verbose = end - begin <= kSampleBlock;
  const size_t channels = size_t(film.measured_channels());
  const auto print_splats = [&](const ReplayedSample& s) {
    fmt::print("  {} splats on the film\n", s.splatted.size() / channels);
  };
  if (job.integrator().leaves() == Integrator::Leaves::film) {
    fmt::print(
        "paths of \"{}\" start at emitters and belong to no pixel: these are the paths that are counted as "
        "samples of pixel ({}, {}), wherever they go\n",
        job.integrator().properties().type(), x, y);
    replay_samples(job, int(x), int(y), begin, end, "path", [&](const ReplayedSample& s) {
      if (verbose) print_splats(s);
    });
    return 0;
  }
  if (job.state().identity.adaptive != "none")
    fmt::print(
        "samples are numbered by pixel: in an adaptive picture this one may have half or up to 4 times as "
        "many\n");
  std::vector<double> sum;
  std::int64_t valid = 0;
  replay_samples(job, int(x), int(y), begin, end, "sample", [&](const ReplayedSample& s) {
    sum.resize(s.measured.size());
    for (size_t c = 0; c < s.measured.size(); ++c) sum[c] += s.measured[c];
    ++valid;
    if (verbose) fmt::print("  measured {:.7g}\n", fmt::join(s.measured, ", "));
    if (verbose && !s.splatted.empty()) print_splats(s);
  });
  for (double& s : sum) s /= double(std::max<std::int64_t>(1, valid));
  fmt::print("pixel ({}, {}): mean of {} samples {:.7g}{}\n", x, y, valid, fmt::join(sum, ", "),
             film.properties().type() != "hdrfilm" || film.measured_channels() != 3 ? ""
             : sum.size() > 3 ? " (X, Y, Z, then the integrator's channels)"
                              : " (X, Y, Z)");
  return 0;
}

void check_numbers(const Arguments& a) {
  check_sampling(a.spp, a.seed, a.threads);
  if (a.replicates < 1) throw Error(fmt::format("--replicates {}: must be at least 1", a.replicates));
  if (!(a.time_s >= 0)) throw Error(fmt::format("--time {}: must not be negative", a.time_s));
  a.tone();
  if (a.denoise && !a.pixel.empty()) throw Error("give either --denoise or --pixel");
  if (a.denoise && !a.samples.empty())
    throw Error(
        "--denoise: --samples renders a part; merge the parts, then aureole denoise removes the noise");
  if (!(a.checkpoint_s > 0)) throw Error(fmt::format("--checkpoint {}: must be positive", a.checkpoint_s));
}

/// Locks the pictures of a job. Throws Error if they cannot be written, or another program writes them.
/// Replaying a pixel writes no pictures.
void require_output(const Arguments& a, const std::filesystem::path& output,
                    std::optional<OutputLock>& lock) {
  for (const char* extension : {".exr", ".hdr", ".rgbe", ".pfm"})
    if (lower_extension(output) == extension) {
      if (!a.pixel.empty()) return;
      lock.emplace(output);
      require_writable(output);
      require_writable(std::filesystem::path(output).replace_extension(".png"));
      require_writable(std::filesystem::path(output).replace_extension(".state"));
      return;
    }
  throw Error("-o " + output.string() +
              ": the output is an .exr, .hdr or .pfm file (a .png is written beside it)");
}

void note_missing_threads(const Arguments& a) {
  const int wanted = a.threads > 0 ? a.threads : default_thread_count(), possible = available_threads(wanted);
  if (possible < wanted && !a.quiet)
    tell("note: {} of {} threads are used: the system refuses more\n", possible, wanted);
}

RenderOptions render_options(const Arguments& a) {
  RenderOptions options;
  if (a.spp) options.end = *a.spp;
  if (!a.samples.empty() && a.spp) throw Error("give either --spp or --samples");
  if (a.resume && a.restart) throw Error("give either --resume or --restart");
  if (!a.samples.empty()) {
    const auto [first, last] = parse_pair(a.samples, ':', "--samples");
    options.begin = first, options.end = last;
    options.keep_state = true;
  }
  if (a.seed) options.seed = std::uint64_t(*a.seed);
  if (!a.adaptive.empty()) options.adaptive = adaptive_target(a.adaptive);
  options.threads = a.threads;
  options.replicates = a.replicates;
  options.time_limit_s = a.time_s;
  options.checkpoint_interval_s = a.checkpoint_s;
  return options;
}

void print_notes(const LoadedScene& loaded) {
  for (const auto& note : loaded.notes) tell("note: {}\n", note);
  for (const Primitive& part : loaded.scene->parts().surfaces)
    for (const auto& remark : part.remarks) tell("note: {}: {}\n", part.element->where().str(), remark);
}

/// Continues an earlier job's samples if requested. Throws Error if a checkpoint exists and neither --resume
/// nor --restart is given.
void take_up(const Arguments& a, const std::filesystem::path& state_file, RenderJob& job) {
  const bool exists = std::filesystem::exists(state_file);
  if (!a.resume && !a.restart && exists)
    throw Error({state_file.string(), 0, 0},
                "holds the samples of an earlier job: --resume continues it, --restart discards it");
  if (!a.resume) return;
  if (exists) {
    job.resume(RenderState::load(state_file));
    if (!a.quiet)
      tell("resuming: {:.1f} % done\n",
           100.0 * double(job.state().units_done()) / double(job.state().units()));
  } else if (!a.quiet) {
    tell("note: there is no {} to resume from: starting at the beginning\n", state_file.string());
  }
}

RenderJob::Outcome run(const Arguments& a, const std::filesystem::path& output, RenderJob& job) {
  std::signal(SIGINT, request_stop);
  std::signal(SIGTERM, request_stop);
  std::signal(SIGHUP, request_stop);
  ProgressLine line(a.quiet);
  std::optional<Preview> preview;
  std::unique_ptr<TevViewer> viewer;
  try {
    if (!a.tev.empty()) viewer = std::make_unique<TevViewer>(a.tev);
  } catch (const Error& e) {
    throw Error("--tev: " + e.message());
  }
  try {
    if (a.preview || viewer) preview.emplace(job, output, a.tone(), a.preview, std::move(viewer));
  } catch (const std::system_error& e) {
    tell("note: no previews: {}\n", e.what());
  }
  std::string problem;
  return job.run(stop_requested, [&](const Progress& p) {
    // The problem is compared, since `report` is called from the thread that writes checkpoints.
    if (job.checkpoint_problem() != problem) {
      problem = job.checkpoint_problem();
      line.clear();
      if (!problem.empty()) tell("note: no checkpoint: {}; the next one tries again\n", problem);
    }
    line.show(p);
  });
}

void print_invalid_samples(const RenderJob& job) {
  if (job.state().invalid_samples == 0) return;
  tell(
      "note: {} samples were invalid (NaN, infinite, negative or beyond 2^60) and left out; the "
      "first ones:\n",
      job.state().invalid_samples);
  for (const auto& s : job.invalid_samples())
    tell("  --pixel {},{} --samples {}:{}{}\n", s.x, s.y, s.sample / kSampleBlock * kSampleBlock,
         s.sample + 1, s.replicate ? fmt::format(" (replicate {})", s.replicate) : "");
}

void print_speed(const RenderState& state) {
  const double mean = mean_density(state.density);
  const std::int64_t samples = state.samples_everywhere();
  const double rate =
      double(samples) * state.identity.width * state.identity.height * state.identity.replicates;
  tell("{} in {:.2f} s ({:.2f} Msamples/s)\n",
       state.density.empty() ? fmt::format("{} samples per pixel", samples)
                             : fmt::format("{:.2f} samples per pixel on average", double(samples) * mean),
       state.seconds, rate * mean / std::max(1e-9, state.seconds) * 1e-6);
}

/// Writes the pictures of a job and, where they cannot be written to their own path, also its state. Returns
/// the file written.
WrittenFile write_results(const Arguments& a, const std::filesystem::path& output, const RenderState& state) {
  const auto beside = [](std::filesystem::path file, const char* extension) {
    return file.replace_extension(extension);
  };
  const Image picture = state.picture();
  const WrittenFile written = write_somewhere(
      output, [&](const std::filesystem::path& file) { write_picture(state, picture, file); });
  if (!written.problem.empty()) {
    tell("error: {}\nerror: the picture is in {} instead\n", written.problem, written.file.string());
    try {
      state.save(beside(written.file, ".state"));
      tell("error: its samples are in {}\n", beside(written.file, ".state").string());
    } catch (const Error& e) {
      tell("error: {}\n", e.what());
    }
  }
  write_preview(state, written.file, a.tone());
  return written;
}

constexpr const char* kDenoiseModule = "_denoise_command";

/// Throws Error before anything is rendered if the picture could not be denoised.
void require_denoiser(const std::filesystem::path& output) {
  if (lower_extension(output) != ".exr")
    throw Error("-o " + output.string() +
                ": with --denoise the output is an .exr, which keeps both pictures");
  if (run_in_package(kDenoiseModule, {"--check"}) != 0)
    throw Error(
        "--denoise: aureole's Python package and Open Image Denoise are needed: pip install 'aureole[denoise]'");
}

/// Replaces a picture by the one without noise, which keeps the noisy one as a layer. Returns the exit code.
int denoise_picture(const Arguments& a, const std::filesystem::path& file) {
  std::vector<std::string> words{file.string(), "-o", file.string(), "-q"};
  if (!a.tonemap.empty()) words.insert(words.end(), {"--tonemap", a.tonemap});
  if (run_in_package(kDenoiseModule, words) == 0) return 0;
  tell("error: the picture is not denoised: {} is the noisy one\n", file.string());
  return 1;
}

/// Prints how the job ended and returns the exit code.
int report(const Arguments& a, const std::filesystem::path& output, const RenderJob& job,
           RenderJob::Outcome outcome) {
  const RenderState& state = job.state();
  print_invalid_samples(job);
  if (!a.quiet) {
    print_speed(state);
    for (const std::string& text : state.approximations) tell("error of {}\n", text);
    fmt::print("{}\n{}\n", output.string(), std::filesystem::path(output).replace_extension(".png").string());
  }
  if (state.invalid_samples > 0 && state.invalid_samples >= std::uint64_t(state.samples_everywhere()) *
                                                                std::uint64_t(state.identity.width) *
                                                                std::uint64_t(state.identity.height)) {
    tell("error: no sample was valid\n");
    return 1;
  }
  // The result of a part, or of an interrupted job, is its state file.
  if (!job.checkpoint_problem().empty() && (!a.samples.empty() || outcome != RenderJob::Outcome::finished)) {
    tell("error: the samples are in the picture alone, there is no state file of them to {}: {}\n",
         a.samples.empty() ? "resume from" : "merge", job.checkpoint_problem());
    return 1;
  }
  if (outcome == RenderJob::Outcome::interrupted) {
    tell("interrupted at {:.1f} %: what is done is written; the same command with --resume continues\n",
         100.0 * double(state.units_done()) / double(state.units()));
    return 1;
  }
  return 0;
}

int render(const Arguments& a) {
  check_numbers(a);
  // Unwritable output files are reported before a large scene is read.
  std::filesystem::path output = a.output;
  std::optional<OutputLock> lock;
  if (!output.empty()) require_output(a, output, lock);
  RenderOptions options = render_options(a);
  LoadOptions load = load_options(a.defines);
  load.for_denoising = a.denoise;
  load.sampler = a.sampler;
  load.integrator = a.integrator;
  const LoadedScene loaded = [&] {
    TableProgressLine line(a.quiet);
    load.progress = [&](const std::string& object, double part) { line.show(object, part); };
    return load_scene(a.scene, load);
  }();
  if (output.empty()) {
    output = default_output(a.scene, loaded.scene->film().file_extension());
    require_output(a, output, lock);
  }
  options.state_file = std::filesystem::path(output).replace_extension(".state");
  if (a.pixel.empty())
    add_outputs({{"-o", output},
                 {"the preview of -o", std::filesystem::path(output).replace_extension(".png")},
                 {"the checkpoint of -o", options.state_file}});
  if (!a.quiet) print_notes(loaded);
  if (a.denoise) {
    require_denoiser(output);
    divide_for_denoising(loaded, options);
    if (!a.quiet && options.replicates > a.replicates)
      tell("note: {} samples per pixel are divided among {} replicates for denoising\n",
           *options.end * options.replicates, options.replicates);
  }
  RenderJob job(loaded, options);
  note_missing_threads(a);
  require_format(job.state().development, options.replicates, output);
  if (!a.pixel.empty()) return replay_pixel(job, loaded.scene->film(), a, options);

  take_up(a, options.state_file, job);
  const RenderJob::Outcome outcome = run(a, output, job);
  if (job.state().units_done() == 0) {
    tell("interrupted before anything was done: no picture is written\n");
    return 1;
  }
  const WrittenFile written = write_results(a, output, job.state());
  if (written.problem.empty()) job.remove_state();
  int code = report(a, written.file, job, outcome);
  if (a.denoise && code == 0) code = denoise_picture(a, written.file);
  return written.problem.empty() ? code : 1;
}

std::function<int()> declare(CommandOptions& options) {
  auto a = std::make_shared<Arguments>();
  options.add("scene", a->scene, "scene file (Mitsuba XML)").required();
  options.add("-o,--output", a->output,
              "output .exr, .hdr or .pfm (default: the scene's name, in the working folder)");
  options.add("-D,--define", a->defines, "set a $name of the scene: -D name=value").takes_each_time(1);
  add_cache_option(options);
  options.add("--spp", a->spp, "samples per pixel (default: the scene's sample_count)");
  options.add("--seed", a->seed, "seed of the samples (default: the scene's)");
  options.add("--threads", a->threads, "threads (default: all cores); the picture does not depend on it");
  options.add("--time", a->time_s, "stop after this many seconds, on whole sample blocks");
  options.add("--samples", a->samples,
              "render only samples A:B of the picture, for merging; A must be a multiple of 16");
  options.add("--replicates", a->replicates,
              "number of independently scrambled pictures; stores their mean and its variance");
  options.add(
      "--denoise", a->denoise,
      "remove noise by Open Image Denoise (Python package): box filter, features and variance are rendered "
      "with the picture, and the EXR keeps the noisy one, too");
  options.add("--sampler", a->sampler, "replace the scene's sampler: sobol, independent");
  options
      .add("--adaptive", a->adaptive,
           "more samples in noisy pixels, at most --spp on average, for absolute, display or relative error")
      .one_of(adaptive_target_names());
  options.add("--integrator", a->integrator,
              "replace the scene's integrator: path, direct, ptracer, depth, ...");
  options.add("--checkpoint", a->checkpoint_s,
              "seconds between checkpoints (default 30); the first comes after 2");
  options.add("--pixel", a->pixel, "replay one pixel, x,y, and print the events of its paths");
  options.add("--resume", a->resume, "continue from the checkpoint of the same command");
  options.add("--restart", a->restart, "discard the checkpoint of an earlier job and start again");
  options.add("--tonemap", a->tonemap,
              "asinh:C:E: tone-map the PNG by asinh(C y)/asinh(C), y the luminance times 2^E, for high "
              "dynamic range (default: only highlights are compressed)");
  options.add("--preview", a->preview, "update the PNG while rendering");
  options.add("--tev", a->tev,
              "show the picture while rendering in the viewer tev at HOST:PORT (localhost:14158)");
  options.add("-q,--quiet", a->quiet, "print errors only");
  return [a] { return render(*a); };
}

AUREOLE_COMMAND("render", "Render a scene file to an EXR and a PNG", declare);

}  // namespace
}  // namespace aureole

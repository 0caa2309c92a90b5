// SPDX-License-Identifier: Apache-2.0
#include "fuzz/run_case.h"

#include <cxxabi.h>
#include <fmt/format.h>

#include <cctype>
#include <cmath>
#include <ctime>
#include <typeinfo>

#include "aureole/core/error.h"
#include "aureole/render/job.h"

namespace aureole::fuzz {

namespace {

constexpr double kLargestFilmBytes = 32 << 20, kMaxSamples = 20000, kMaxSeconds = 1;
/// No machine has the memory for such a film: the job has to refuse it.
constexpr double kImpossibleBytes = 1e13;

double cpu_seconds() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}

/// "file:line" at the start; errors about the command line have no location in a file.
bool is_located(const std::string& error) {
  if (error.starts_with("--") || error.find(": -D ") != std::string::npos) return true;
  if (!error.starts_with("/")) return false;  // the scene was given by an absolute path
  for (std::size_t at = error.find(':'); at != std::string::npos; at = error.find(':', at + 1))
    if (at + 1 < error.size() && std::isdigit(static_cast<unsigned char>(error[at + 1]))) return true;
  return false;
}

/// Words of the standard library's exceptions: somebody caught what should not have been thrown.
bool is_internal(const std::string& error) {
  for (const char* text : {"bad_alloc", "std::", "vector::", "basic_string", "map::at", "bad optional",
                           "bad_variant", "undocumented", "stoi", "stod", "filesystem error", "regex_error",
                           "in a wrong family", "made no object"})
    if (error.find(text) != std::string::npos) return true;
  return false;
}

Verdict judge(const std::vector<std::string>& errors) {
  Verdict v{Verdict::refused, "", 0};
  for (const std::string& error : errors) {
    v.message += error + "\n";
    if (v.kind == Verdict::failed) continue;
    const char* why = !is_located(error)   ? "an error without file and line: "
                      : is_internal(error) ? "an exception reported as an error: "
                                           : nullptr;
    if (why) v = {Verdict::failed, why + error + "\n", 0};
  }
  if (errors.empty()) v = {Verdict::failed, "an empty list of errors", 0};
  return v;
}

bool is_finite(const Image& image) {
  for (const float x : image.pixels)
    if (!std::isfinite(x)) return false;
  return true;
}

Verdict render(const LoadedScene& loaded) {
  const Film& film = loaded.scene->film();
  RenderOptions options;
  options.threads = 1;
  options.end = std::min<std::int64_t>(loaded.scene->sensor().sampler().sample_count(), 2);
  const double bytes = state_bytes(film.crop_width(), film.crop_height(), film.measured_channels() + 16, 1);
  if (bytes > kImpossibleBytes) {
    const RenderJob job(loaded, options);
    return {Verdict::failed, "a film for which there is no memory was accepted", 0};
  }
  if (bytes > kLargestFilmBytes) return {Verdict::too_large, "", 0};

  RenderJob job(loaded, options);
  const double start = cpu_seconds();
  constexpr int kSamples = 6;
  for (int i = 0; i < kSamples; ++i) {
    const int x = film.crop_x() + int(std::int64_t(film.crop_width()) * i / kSamples);
    const int y = film.crop_y() + int(std::int64_t(film.crop_height()) * i / kSamples);
    (void)job.replay(x, y, i % *options.end, 0, [](const PathEvent&) {});
  }
  // A sample is replayed with the others of its pixel.
  const double per_sample = (cpu_seconds() - start) / double(kSamples * *options.end);
  const RenderState& state = job.state();
  const double samples = (state.identity.width + 2.0 * state.identity.border) *
                         (state.identity.height + 2.0 * state.identity.border) * double(*options.end);
  if (samples > kMaxSamples) return {Verdict::too_large, "", 0};
  if (samples * per_sample > kMaxSeconds) return {Verdict::too_slow, "", 0};

  const std::atomic<bool> stop{false};
  if (job.run(stop) != RenderJob::Outcome::finished) return {Verdict::failed, "the job did not finish", 0};
  if (!is_finite(state.picture()) || !is_finite(display_picture(state.rgb_picture())))
    return {Verdict::failed, "a pixel of the picture is not finite", 0};
  return {Verdict::picture, "", state.invalid_samples};
}

std::string type_of(const std::exception& e) {
  int status = 0;
  char* name = abi::__cxa_demangle(typeid(e).name(), nullptr, nullptr, &status);
  const std::string text = name ? name : typeid(e).name();
  std::free(name);
  return text;
}

}  // namespace

Verdict run_case(const Case& c, const std::filesystem::path& folder) {
  try {
    return render(load_scene(folder / kMainFile, c.options));
  } catch (const ErrorList& list) {
    return judge(list.errors());
  } catch (const Error& e) {
    return judge({e.what()});
  } catch (const std::exception& e) {
    return {Verdict::failed, "the exception " + type_of(e) + ": " + e.what(), 0};
  } catch (...) {
    return {Verdict::failed, "an exception of unknown type", 0};
  }
}

}  // namespace aureole::fuzz

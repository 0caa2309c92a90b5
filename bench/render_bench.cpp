// SPDX-License-Identifier: Apache-2.0
// Times whole renders: seconds, samples and rays per second, or (--replicates) the efficiency.
//
// Rays are counted between the renderer and Embree: the linker sends its calls here first (--wrap in
// CMakeLists.txt), so the renderer knows nothing of it. A count is an increment of a thread's own number.
#include <embree3/rtcore.h>
#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <string>
#include <vector>

#include "aureole/core/error.h"
#include "aureole/render/job.h"

namespace {

/// The rays of one thread.
struct RayCounter {
  std::uint64_t nearest = 0, occlusion = 0;
};
constexpr int kMaxThreads = 256;
RayCounter* counters[kMaxThreads];
std::atomic<int> counters_used{0};

RayCounter& counter() {
  thread_local RayCounter* mine = [] {
    const int slot = counters_used++;
    if (slot >= kMaxThreads) std::abort();
    // A cache line of its own.
    return counters[slot] = new (std::align_val_t(64)) RayCounter[8]();
  }();
  return *mine;
}

}  // namespace

extern "C" {
void __real_rtcIntersect1(RTCScene, RTCIntersectContext*, RTCRayHit*);
void __real_rtcOccluded1(RTCScene, RTCIntersectContext*, RTCRay*);
void __wrap_rtcIntersect1(RTCScene scene, RTCIntersectContext* context, RTCRayHit* ray) {
  ++counter().nearest;
  __real_rtcIntersect1(scene, context, ray);
}
void __wrap_rtcOccluded1(RTCScene scene, RTCIntersectContext* context, RTCRay* ray) {
  ++counter().occlusion;
  __real_rtcOccluded1(scene, context, ray);
}

// Packets: the rays that are valid.
#define AUREOLE_COUNT_PACKETS(LANES)                                                              \
  void __real_rtcIntersect##LANES(const int*, RTCScene, RTCIntersectContext*, RTCRayHit##LANES*); \
  void __real_rtcOccluded##LANES(const int*, RTCScene, RTCIntersectContext*, RTCRay##LANES*);     \
  void __wrap_rtcIntersect##LANES(const int* valid, RTCScene scene, RTCIntersectContext* context, \
                                  RTCRayHit##LANES* rays) {                                       \
    for (int i = 0; i < LANES; ++i) counter().nearest += valid[i] != 0;                           \
    __real_rtcIntersect##LANES(valid, scene, context, rays);                                      \
  }                                                                                               \
  void __wrap_rtcOccluded##LANES(const int* valid, RTCScene scene, RTCIntersectContext* context,  \
                                 RTCRay##LANES* rays) {                                           \
    for (int i = 0; i < LANES; ++i) counter().occlusion += valid[i] != 0;                         \
    __real_rtcOccluded##LANES(valid, scene, context, rays);                                       \
  }
AUREOLE_COUNT_PACKETS(8)
AUREOLE_COUNT_PACKETS(16)
#undef AUREOLE_COUNT_PACKETS
}

namespace aureole {
namespace {

struct Options {
  std::string name, scene;
  LoadOptions load;
  RenderOptions render;
  int repeats = 1;
};

RayCounter rays_so_far() {
  RayCounter all;
  for (int i = 0; i < counters_used; ++i) {
    all.nearest += counters[i]->nearest;
    all.occlusion += counters[i]->occlusion;
  }
  return all;
}

double processor_seconds() {
  rusage u;
  getrusage(RUSAGE_SELF, &u);
  return double(u.ru_utime.tv_sec + u.ru_stime.tv_sec) +
         1e-6 * double(u.ru_utime.tv_usec + u.ru_stime.tv_usec);
}

struct Measurement {
  double wall_s = 0, processor_s = 0, samples = 0;
  RayCounter rays;
  RenderState state;
};

Measurement measure(const LoadedScene& scene, const RenderOptions& options) {
  RenderJob job(scene, options);
  const std::atomic<bool> stop{false};
  const RayCounter before = rays_so_far();
  const double start = processor_seconds();
  job.run(stop);
  Measurement m;
  m.processor_s = processor_seconds() - start;
  m.wall_s = job.state().seconds;
  m.rays = rays_so_far();
  m.rays.nearest -= before.nearest, m.rays.occlusion -= before.occlusion;
  const PictureIdentity& i = job.state().identity;
  m.samples = double(job.state().samples_everywhere()) * i.width * i.height * i.replicates;
  m.state = job.state();
  return m;
}

/// 1/(variance x time) of one pixel's estimate, with the variance in units of a squared mean: of the picture,
/// and pixel by pixel (there 1 % of the picture's squared mean is added, as in relMSE).
struct Efficiency {
  double mean = 0, variance = 0, relative_variance = 0;
};

Efficiency efficiency_of(const RenderState& state) {
  const Image picture = state.picture();
  Efficiency e;
  std::vector<std::pair<int, int>> pairs;
  for (std::size_t c = 0; c < picture.channels.size(); ++c) {
    const int v = picture.channel("variance." + picture.channels[c]);
    if (v >= 0 && picture.channels[c] != "A") pairs.emplace_back(int(c), v);
  }
  if (pairs.empty()) throw Error("the picture has no variances: ask for two replicates or more");
  const double values = double(picture.width) * picture.height * double(pairs.size());
  const auto each = [&](auto&& f) {
    for (int y = 0; y < picture.height; ++y)
      for (int x = 0; x < picture.width; ++x)
        // The picture stores the variance of the mean of the replicates; a replicate's own is asked for.
        for (const auto& [c, v] : pairs)
          f(picture.at(x, y, c), double(picture.at(x, y, v)) * state.identity.replicates);
  };
  each([&](double mean, double variance) { e.mean += mean / values, e.variance += variance / values; });
  each([&](double mean, double variance) {
    e.relative_variance += variance / (mean * mean + 0.01 * e.mean * e.mean) / values;
  });
  return e;
}

LoadedScene load(const Options& o) { return load_scene(o.scene, o.load); }

void print_speed(const Options& o) {
  const auto scene = load(o);
  std::optional<Measurement> best;
  for (int i = 0; i < o.repeats; ++i) {
    Measurement m = measure(scene, o.render);
    if (!best || m.wall_s < best->wall_s) best = std::move(m);
  }
  const PictureIdentity& id = best->state.identity;
  const double rays = double(best->rays.nearest + best->rays.occlusion);
  fmt::print("{:<22} {:>9} {:>5} {:>8.2f} {:>8.2f} {:>9.3f} {:>9.3f} {:>12.3f} {:>11.2f} {:>8.0f}\n", o.name,
             fmt::format("{}x{}", id.width, id.height), best->state.samples_everywhere(), best->wall_s,
             best->processor_s, best->samples / best->wall_s * 1e-6, rays / best->wall_s * 1e-6,
             rays / best->processor_s * 1e-6, rays / best->samples,
             100 * double(best->rays.occlusion) / rays);
}

void print_efficiency(const Options& o) {
  const auto scene = load(o);
  std::optional<Measurement> best;
  for (int i = 0; i < o.repeats; ++i) {
    Measurement m = measure(scene, o.render);
    if (!best || m.processor_s < best->processor_s) best = std::move(m);
  }
  const Efficiency e = efficiency_of(best->state);
  const PictureIdentity& id = best->state.identity;
  // Time of one picture, all threads together: what other programs take is not in it.
  const double seconds = best->processor_s / id.replicates;
  fmt::print("{:<22} {:>2} {:>9} {:>5} {:>9.3f} {:>10.5f} {:>11.4e} {:>11.4e} {:>11.4g} {:>11.4g}\n", o.name,
             kWavelengths, fmt::format("{}x{}", id.width, id.height), best->state.samples_everywhere(),
             best->processor_s / best->samples * 1e6, e.mean, e.variance, e.relative_variance,
             e.mean * e.mean / (e.variance * seconds), 1 / (e.relative_variance * seconds));
}

constexpr const char* kUsage =
    "aureole_render_bench --header speed|efficiency\n"
    "aureole_render_bench NAME SCENE [--spp N] [--seed N] [--sampler S] [-D name=value]... [--threads N] "
    "[--repeats N]\n"
    "                     [--replicates R]    R > 1: efficiency instead of speed\n";

void print_header(const std::string& kind) {
  if (kind == "efficiency")
    fmt::print("{:<22} {:>2} {:>9} {:>5} {:>9} {:>10} {:>11} {:>11} {:>11} {:>11}\n", "scene", "N", "size",
               "spp", "us/sample", "mean", "variance", "rel. var.", "efficiency", "by pixel");
  else
    fmt::print("{:<22} {:>9} {:>5} {:>8} {:>8} {:>9} {:>9} {:>12} {:>11} {:>8}\n", "scene", "size", "spp",
               "seconds", "cpu s", "Msample/s", "Mrays/s", "Mrays/cpu s", "rays/sample", "shadow %");
}

int run(int argc, char** argv) {
  const std::vector<std::string> args(argv + 1, argv + argc);
  if (args.size() == 2 && args[0] == "--header") return print_header(args[1]), 0;
  if (args.size() < 2 || args.size() % 2) return fmt::print(stderr, "{}", kUsage), 2;
  Options o;
  o.name = args[0], o.scene = args[1];
  o.render.threads = 2;
  for (std::size_t i = 2; i < args.size(); i += 2) {
    const std::string &key = args[i], &value = args[i + 1];
    const std::size_t equals = value.find('=');
    if (key == "--spp") {
      o.render.end = std::stoll(value);
    } else if (key == "--seed") {
      o.render.seed = std::stoull(value);
    } else if (key == "--sampler") {
      o.load.sampler = value;
    } else if (key == "-D" && equals != std::string::npos) {
      o.load.defines.emplace_back(value.substr(0, equals), value.substr(equals + 1));
    } else if (key == "--threads") {
      o.render.threads = std::stoi(value);
    } else if (key == "--repeats") {
      o.repeats = std::stoi(value);
    } else if (key == "--replicates") {
      o.render.replicates = std::stoi(value);
    } else {
      return fmt::print(stderr, "{}", kUsage), 2;
    }
  }
  o.render.replicates > 1 ? print_efficiency(o) : print_speed(o);
  return 0;
}

}  // namespace
}  // namespace aureole

int main(int argc, char** argv) {
  try {
    return aureole::run(argc, argv);
  } catch (const std::exception& e) {
    fmt::print(stderr, "{}\n", e.what());
    return 2;
  }
}

// SPDX-License-Identifier: Apache-2.0
#include "aureole/core/parallel.h"

#ifndef AUREOLE_STD_THREADS
#include <pthread.h>
#include <sys/resource.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>

#include <algorithm>
#include <atomic>
#endif

namespace aureole {

#ifdef AUREOLE_STD_THREADS

void run_workers(int threads, const std::function<void(int)>& worker) { run_std_threads(threads, worker); }

void run_together(const std::function<void()>& here, const std::function<void()>& elsewhere) {
  here();
  elsewhere();
}

void limit_library_threads() {}

#else

namespace {

/// A forked child process has none of oneTBB's threads, but inherits state that refers to them. So it uses
/// std::thread.
std::atomic<bool> is_forked{false};
[[maybe_unused]] const int registered = pthread_atfork(nullptr, nullptr, [] { is_forked = true; });

}  // namespace

void run_workers(int threads, const std::function<void(int)>& worker) {
  if (is_forked) return run_std_threads(threads, worker);
  const int together = available_threads(threads);
  run_guarded(worker, [&](const Worker& guarded) {
    // More threads than cores are allowed on request; the determinism tests use them.
    tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                              size_t(std::max(together, available_threads(default_thread_count()))));
    tbb::task_arena arena(together);
    arena.execute([&] { tbb::parallel_for(0, threads, 1, guarded, tbb::simple_partitioner()); });
  });
}

namespace {

/// Whether the address space of the process is limited. The heap of a second thread reserves a large part of it, which
/// other libraries may need.
bool has_limited_memory() {
  rlimit limit{};
  return getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY;
}

}  // namespace

void run_together(const std::function<void()>& here, const std::function<void()>& elsewhere) {
  if (is_forked || has_limited_memory()) {
    here();
    return elsewhere();
  }
  tbb::task_group tasks;
  tasks.run(elsewhere);
  try {
    here();
  } catch (...) {
    tasks.cancel();  // tasks that have not begun are cancelled
    tasks.wait();
    throw;
  }
  tasks.wait();
}

void limit_library_threads() {
  if (is_forked) return;
  const int cores = default_thread_count(), possible = available_threads(cores);
  if (possible < cores)
    static const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, size_t(possible));
}

#endif

void for_ranges(std::size_t n, const std::function<void(std::size_t, std::size_t)>& body, std::size_t grain) {
  if (n > grain) return share_ranges(n, body, grain, default_thread_count(), run_workers);
  // no threads for a small range, such as a small mesh, of which a scene may have many
  if (n > 0) body(0, n);
}

void for_rows(int width, int height, const std::function<void(std::size_t, std::size_t)>& body) {
  constexpr int kPixels = 1 << 16;  // pixels of one range
  for_ranges(std::size_t(height), body, std::size_t(std::max(1, kPixels / std::max(1, width))));
}

}  // namespace aureole

// SPDX-License-Identifier: Apache-2.0
#include "aureole/core/parallel.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

#ifndef AUREOLE_STD_THREADS
#include <pthread.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#endif

namespace aureole {

namespace {

#ifndef AUREOLE_STD_THREADS
/// A child of a fork has none of oneTBB's threads, and what they held when it was made: it takes its own.
std::atomic<bool> is_forked{false};
[[maybe_unused]] const int registered = pthread_atfork(nullptr, nullptr, [] { is_forked = true; });
#endif

void run_std_threads(int threads, const std::function<void(int)>& worker) {
  std::vector<std::thread> pool;
  for (int i = 0; i < threads; ++i) pool.emplace_back(worker, i);
  for (auto& t : pool) t.join();
}

}  // namespace

int default_thread_count() { return std::max(1, int(std::thread::hardware_concurrency())); }

void run_workers(int threads, const std::function<void(int)>& worker) {
  std::exception_ptr first;
  std::mutex mutex;
  const auto guarded = [&](int i) {
    try {
      worker(i);
    } catch (...) {
      const std::lock_guard lock(mutex);
      if (!first) first = std::current_exception();
    }
  };
#ifdef AUREOLE_STD_THREADS
  run_std_threads(threads, guarded);
#else
  if (is_forked) {
    run_std_threads(threads, guarded);
    if (first) std::rethrow_exception(first);
    return;
  }
  // More threads than cores are allowed on request: the determinism tests use them.
  tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                            size_t(std::max(threads, default_thread_count())));
  tbb::task_arena arena(threads);
  arena.execute([&] { tbb::parallel_for(0, threads, 1, guarded, tbb::simple_partitioner()); });
#endif
  if (first) std::rethrow_exception(first);
}

void for_ranges(std::size_t n, const std::function<void(std::size_t, std::size_t)>& body, std::size_t grain) {
  const std::size_t ranges = (n + grain - 1) / grain;
  const int threads = int(std::min<std::size_t>(ranges, std::size_t(default_thread_count())));
  if (threads < 2) {
    if (n > 0) body(0, n);
    return;
  }
  std::atomic<std::size_t> next{0};
  run_workers(threads, [&](int) {
    for (std::size_t k; (k = next.fetch_add(1)) < ranges;) body(k * grain, std::min(n, (k + 1) * grain));
  });
}

}  // namespace aureole

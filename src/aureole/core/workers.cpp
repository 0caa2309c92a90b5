// SPDX-License-Identifier: Apache-2.0
#include "aureole/core/workers.h"

#include <malloc.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <cstdio>
#include <exception>
#include <limits>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

namespace aureole {

int default_thread_count() { return std::max(1, int(std::thread::hardware_concurrency())); }

namespace {

/// Reserves half of the remaining address space where that is limited (`ulimit -v`), so that threads leave it
/// to other allocations.
class ReservedSpace {
public:
  ReservedSpace() {
    rlimit limit;
    std::size_t used_pages = 0;
    if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return;
    // All threads share the one arena of malloc, since each further arena reserves 64 MiB, and 128 MiB for a
    // moment in which another thread may ask for memory.
    mallopt(M_ARENA_MAX, 1);
    if (std::FILE* statm = std::fopen("/proc/self/statm", "re")) {
      if (std::fscanf(statm, "%zu", &used_pages) != 1) used_pages = 0;
      std::fclose(statm);
    }
    const std::size_t used = used_pages * std::size_t(sysconf(_SC_PAGESIZE));
    if (limit.rlim_cur <= used) return;
    size_ = std::size_t(limit.rlim_cur - used) / 2;
    space_ = mmap(nullptr, size_, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  }
  ~ReservedSpace() {
    if (space_ != MAP_FAILED) munmap(space_, size_);
  }
  ReservedSpace(const ReservedSpace&) = delete;
  ReservedSpace& operator=(const ReservedSpace&) = delete;

private:
  std::size_t size_ = 0;
  void* space_ = MAP_FAILED;
};

/// Starts up to `count` threads that all run at the same time; returns how many were started.
int started_together(int count) {
  const ReservedSpace reserved;
  std::mutex mutex;
  std::condition_variable all_started;
  bool done = false;
  std::vector<std::thread> pool;
  pool.reserve(std::size_t(count));
  try {
    while (int(pool.size()) < count)
      pool.emplace_back([&] {
        std::unique_lock lock(mutex);
        all_started.wait(lock, [&] { return done; });
      });
  } catch (const std::system_error&) {
  }
  {
    const std::lock_guard lock(mutex);
    done = true;
  }
  all_started.notify_all();
  for (std::thread& t : pool) t.join();
  return int(pool.size());
}

}  // namespace

int available_threads(int wanted) {
  static std::mutex mutex;
  static int possible = 1, impossible = std::numeric_limits<int>::max();
  const std::lock_guard lock(mutex);
  if (wanted <= possible) return std::max(wanted, 1);
  if (wanted < impossible) {
    const int started = 1 + started_together(wanted - 1);  // the calling thread counts as one
    if (started >= wanted) return possible = wanted;
    impossible = wanted;
    possible = std::max(possible, started);
  }
  return possible;
}

void run_guarded(const Worker& worker, const std::function<void(const Worker&)>& start) {
  std::exception_ptr first;
  std::mutex mutex;
  start([&](int i) {
    try {
      worker(i);
    } catch (...) {
      const std::lock_guard lock(mutex);
      if (!first) first = std::current_exception();
    }
  });
  if (first) std::rethrow_exception(first);
}

void run_std_threads(int threads, const Worker& worker) {
  run_guarded(worker, [&](const Worker& guarded) {
    std::vector<std::thread> pool;
    pool.reserve(std::size_t(std::max(threads, 0)));
    int i = 0;
    try {
      for (; i < threads; ++i) pool.emplace_back(guarded, i);
    } catch (const std::system_error&) {
    }
    for (; i < threads; ++i) guarded(i);
    for (auto& t : pool) t.join();
  });
}

void share_ranges(std::size_t n, const std::function<void(std::size_t, std::size_t)>& body, std::size_t grain,
                  int most_threads, const std::function<void(int, const Worker&)>& run) {
  const std::size_t ranges = (n + grain - 1) / grain;
  const int threads = int(std::min<std::size_t>(ranges, std::size_t(most_threads)));
  if (threads < 2) {
    if (n > 0) body(0, n);
    return;
  }
  std::atomic<std::size_t> next{0};
  run(threads, [&](int) {
    for (std::size_t k; (k = next.fetch_add(1)) < ranges;) body(k * grain, std::min(n, (k + 1) * grain));
  });
}

}  // namespace aureole

// SPDX-License-Identifier: Apache-2.0
#include "aureole/core/workers.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace aureole {

int default_thread_count() { return std::max(1, int(std::thread::hardware_concurrency())); }

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
    for (int i = 0; i < threads; ++i) pool.emplace_back(guarded, i);
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

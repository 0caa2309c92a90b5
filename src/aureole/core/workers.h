// SPDX-License-Identifier: Apache-2.0
// Common parts of the two backends of threads, core/parallel.h and core/parallel_for.h.
#pragma once

#include <cstddef>
#include <functional>

namespace aureole {

using Worker = std::function<void(int)>;

/// Number of cores, at least 1: the number of threads a job uses when none is asked for.
int default_thread_count();

/// Calls `start(guarded)`, which calls `guarded(i)` from several threads and waits for them. Exceptions of
/// `worker` do not leave the threads: the first one is rethrown here.
void run_guarded(const Worker& worker, const std::function<void(const Worker& guarded)>& start);

/// Calls `worker(i)` for i in [0, threads), each on a thread of its own, and returns when all have returned.
/// The first exception is rethrown.
void run_std_threads(int threads, const Worker& worker);

/// Hands out [0, n) in ranges of `grain` or fewer to as many workers as are of use, at most `most_threads`,
/// which `run(threads, worker)` starts.
void share_ranges(std::size_t n, const std::function<void(std::size_t, std::size_t)>& body, std::size_t grain,
                  int most_threads, const std::function<void(int, const Worker&)>& run);

}  // namespace aureole

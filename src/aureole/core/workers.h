// SPDX-License-Identifier: Apache-2.0
// Common code of both threading backends, core/parallel.h and core/parallel_for.h.
#pragma once

#include <cstddef>
#include <functional>

namespace aureole {

using Worker = std::function<void(int)>;

/// Number of cores, at least 1: the default number of threads of a job.
int default_thread_count();

/// Returns how many of `wanted` threads can run at the same time, at least 1: fewer where the system or a limit
/// (`ulimit -v`, `ulimit -u`) refuses them. They are counted by starting them, once for each larger number, since
/// oneTBB ends the program where a thread cannot be made.
int available_threads(int wanted);

/// Calls `start(guarded)`, which must call `guarded(i)` from several threads and wait for them. Exceptions of
/// `worker` are caught in the threads, and the first one is rethrown here.
void run_guarded(const Worker& worker, const std::function<void(const Worker& guarded)>& start);

/// Calls `worker(i)` for i in [0, threads), each on its own thread, and returns when all have returned. Calls for
/// which no thread can be made run on the calling thread. The first exception is rethrown.
void run_std_threads(int threads, const Worker& worker);

/// Distributes ranges of at most `grain` that partition [0, n) to as many workers as useful, at most
/// `most_threads`. The workers are started by `run(threads, worker)`.
void share_ranges(std::size_t n, const std::function<void(std::size_t, std::size_t)>& body, std::size_t grain,
                  int most_threads, const std::function<void(int, const Worker&)>& run);

}  // namespace aureole

// SPDX-License-Identifier: Apache-2.0
// The thread backend: oneTBB, or std::thread in builds for ThreadSanitizer (uninstrumented TBB hides races).
#pragma once

#include <cstddef>
#include <functional>

namespace aureole {

/// Number of threads a job uses when none is asked for.
int default_thread_count();

/// Calls `worker(i)` for i in [0, threads), concurrently where the machine can, and returns when all have
/// returned. Workers share work through state of their own (an atomic counter); each must be able to finish
/// it alone. The first exception is rethrown.
void run_workers(int threads, const std::function<void(int)>& worker);

/// Calls `body(begin, end)` for ranges of `grain` or fewer that make up [0, n), on all cores if there are
/// several. Ranges must not depend on one another.
void for_ranges(std::size_t n, const std::function<void(std::size_t, std::size_t)>& body,
                std::size_t grain = 1 << 14);

}  // namespace aureole

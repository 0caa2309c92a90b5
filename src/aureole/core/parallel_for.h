// SPDX-License-Identifier: Apache-2.0
// `ParallelFor`: the interface by which callers provide threads to a computation, so that it does not depend
// on a threading library. The renderer passes `for_ranges` (core/parallel.h), which uses oneTBB.
#pragma once

#include <cstddef>
#include <functional>

namespace aureole {

/// `parallel_for(n, body, grain)` calls `body(begin, end)` for ranges that partition [0, n), in any order and
/// on any threads, and returns when all calls have returned. The first exception is rethrown. Ranges shorter
/// than `grain` are not worth a thread. Ranges must be independent of each other; results are then the same
/// bit for bit with any threads.
using ParallelFor = std::function<void(
    std::size_t n, const std::function<void(std::size_t, std::size_t)>& body, std::size_t grain)>;

/// A `ParallelFor` that uses only the calling thread.
void serial_for(std::size_t n, const std::function<void(std::size_t, std::size_t)>& body, std::size_t grain);

/// A `ParallelFor` with `threads` threads of the standard library, started anew by each call; 0: one per
/// core.
ParallelFor std_thread_for(int threads = 0);

}  // namespace aureole

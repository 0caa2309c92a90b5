// SPDX-License-Identifier: Apache-2.0
// How a computation that can use several threads is given them: its caller hands it a `ParallelFor`, so that
// it depends on no library of threads. The renderer hands over `for_ranges` (core/parallel.h), which runs on
// oneTBB.
#pragma once

#include <cstddef>
#include <functional>

namespace aureole {

/// `parallel_for(n, body, grain)` calls `body(begin, end)` for ranges that make up [0, n), in any order and
/// on any threads, and returns when all calls have returned. The first exception is rethrown. A range shorter
/// than `grain` is not worth a thread. Ranges must not depend on one another: then results are the same, bit
/// by bit, whoever computes them.
using ParallelFor = std::function<void(
    std::size_t n, const std::function<void(std::size_t, std::size_t)>& body, std::size_t grain)>;

/// A `ParallelFor` that stays on the calling thread.
void serial_for(std::size_t n, const std::function<void(std::size_t, std::size_t)>& body, std::size_t grain);

/// A `ParallelFor` on `threads` threads of the standard library, which each call starts anew; 0: one for each
/// core.
ParallelFor std_thread_for(int threads = 0);

}  // namespace aureole

// SPDX-License-Identifier: Apache-2.0
// The threading backend: oneTBB, or std::thread in builds for ThreadSanitizer (uninstrumented TBB would hide
// races).
#pragma once

#include <cstddef>
#include <functional>

#include "aureole/core/workers.h"

namespace aureole {

/// Calls `worker(i)` for i in [0, threads), concurrently if possible, and returns when all calls have
/// returned. Workers share work through state of their own (an atomic counter). Each must be able to finish
/// all work alone. The first exception is rethrown.
void run_workers(int threads, const std::function<void(int)>& worker);

/// Calls `here` on this thread, and `elsewhere` meanwhile on an idle thread or, if there is none, after it.
/// Returns when both have returned. An exception of `here` is rethrown, else one of `elsewhere`.
void run_together(const std::function<void()>& here, const std::function<void()>& elsewhere);

/// Limits the threads of oneTBB to the number that can be made. Call it before a library that uses oneTBB
/// starts.
void limit_library_threads();

/// The `ParallelFor` of the renderer, on all cores: calls `body(begin, end)` for ranges of at most `grain`
/// that partition [0, n). Ranges must be independent of each other.
void for_ranges(std::size_t n, const std::function<void(std::size_t, std::size_t)>& body,
                std::size_t grain = 1 << 14);

/// Calls `body(begin, end)` for ranges of rows of a picture, on all cores.
void for_rows(int width, int height, const std::function<void(std::size_t, std::size_t)>& body);

}  // namespace aureole

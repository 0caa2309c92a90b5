// SPDX-License-Identifier: Apache-2.0
#include "aureole/core/parallel_for.h"

#include "aureole/core/workers.h"

namespace aureole {

void serial_for(std::size_t n, const std::function<void(std::size_t, std::size_t)>& body, std::size_t) {
  if (n > 0) body(0, n);
}

ParallelFor std_thread_for(int threads) {
  if (threads < 1) threads = default_thread_count();
  return [threads](std::size_t n, const std::function<void(std::size_t, std::size_t)>& body,
                   std::size_t grain) { share_ranges(n, body, grain, threads, run_std_threads); };
}

}  // namespace aureole

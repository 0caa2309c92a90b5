// SPDX-License-Identifier: Apache-2.0
#include "aureole/core/memory.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <string>

#include "aureole/core/error.h"

namespace aureole {

namespace {

double free_memory_bytes() {
  std::ifstream in("/proc/meminfo");
  std::string key, unit;
  double kib;
  while (in >> key >> kib >> unit)
    if (key == "MemAvailable:") return kib * 1024;
  return double(sysconf(_SC_PHYS_PAGES)) * double(sysconf(_SC_PAGESIZE));
}

}  // namespace

double available_memory_bytes() {
  double available = free_memory_bytes();
  rlimit limit;
  double used_pages = 0;
  if (getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY &&
      std::ifstream("/proc/self/statm") >> used_pages)
    available = std::min(available,
                         std::max(0.0, double(limit.rlim_cur) - used_pages * double(sysconf(_SC_PAGESIZE))));
  return available;
}

void require_content(double bytes, double file_bytes, double per_byte) {
  if (bytes <= std::max(kFreeContentBytes, per_byte * file_bytes)) return;
  const auto mebibytes = [](double b) { return std::to_string((long long)(b / (1 << 20))) + " MiB"; };
  throw Error("its content needs " + mebibytes(bytes) + " of memory; a file of " +
              std::to_string((long long)file_bytes) + " bytes may need " +
              mebibytes(std::max(kFreeContentBytes, per_byte * file_bytes)));
}

}  // namespace aureole

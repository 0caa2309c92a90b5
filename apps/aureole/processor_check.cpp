// SPDX-License-Identifier: Apache-2.0
// Runs before all other initialisers and is compiled for the oldest x86-64, so that a processor without AVX2
// gets an error message instead of a crash.
#include <unistd.h>

namespace {

__attribute__((constructor(101))) void check_processor() {
  __builtin_cpu_init();
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") && __builtin_cpu_supports("bmi2"))
    return;
  static const char message[] =
      "aureole: this processor lacks AVX2, FMA or BMI2 (x86-64-v3), which this build needs\n";
  const auto written = write(2, message, sizeof message - 1);
  _exit(written < 0 ? 3 : 2);
}

}  // namespace

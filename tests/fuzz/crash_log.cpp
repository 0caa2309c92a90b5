// SPDX-License-Identifier: Apache-2.0
#include "fuzz/crash_log.h"

#include <execinfo.h>
#include <signal.h>
#include <unistd.h>

#include <cstring>
#include <initializer_list>

namespace aureole::fuzz {

namespace {

#if !defined(__SANITIZE_ADDRESS__)
extern "C" void print_stack(int number) {
  const char* name = sigabbrev_np(number);
  if (!name) name = "?";
  if (write(2, "SIG", 3) < 0 || write(2, name, std::strlen(name)) < 0 || write(2, "\n", 1) < 0) _exit(1);
  void* frames[64];
  backtrace_symbols_fd(frames, backtrace(frames, 64), 2);
  signal(number, SIG_DFL);
  raise(number);
}
#endif

}  // namespace

void log_crashes() {
#if !defined(__SANITIZE_ADDRESS__)
  // A stack of its own: the usual one may have overflowed.
  static char stack[1 << 16];
  const stack_t alternative{stack, 0, sizeof stack};
  sigaltstack(&alternative, nullptr);
  void* warm_up[1];
  backtrace(warm_up, 1);  // loads its library while there still is memory
  struct sigaction action {};
  action.sa_handler = print_stack;
  action.sa_flags = int(SA_ONSTACK | SA_RESETHAND);
  for (const int number : {SIGSEGV, SIGBUS, SIGILL, SIGFPE, SIGABRT, SIGTRAP})
    sigaction(number, &action, nullptr);
#endif
}

}  // namespace aureole::fuzz

// Read by the sanitizers at the start of the program.
extern "C" const char* __asan_default_options() {
  return "detect_leaks=1:handle_abort=1:allocator_may_return_null=0:max_allocation_size_mb=3000:"
         "quarantine_size_mb=32:detect_stack_use_after_return=0";
}
extern "C" const char* __ubsan_default_options() { return "halt_on_error=1:print_stacktrace=1"; }

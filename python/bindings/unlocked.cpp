// SPDX-License-Identifier: Apache-2.0
#include "unlocked.h"

#include <pthread.h>

#include <atomic>
#include <chrono>
#include <thread>

namespace aureole::python {

namespace {

std::atomic<int> unlocked_scopes{0};
std::atomic<bool> leaving{false};
std::thread::id leaver;  ///< the thread that ends the program, which may go on; written before `leaving`

[[noreturn]] void stay() {
  for (;;) std::this_thread::sleep_for(std::chrono::hours(1));
}

void leave() {
  leaver = std::this_thread::get_id();
  leaving = true;
  if (unlocked_scopes > 0) nb::set_leak_warnings(false);  // blocked threads keep their objects
  // Other threads may need Python's lock to finish.
  PyThreadState* const state = PyEval_SaveThread();
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(10);
  while (unlocked_scopes > 0 && std::chrono::steady_clock::now() < deadline)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  PyEval_RestoreThread(state);
}

}  // namespace

bool is_leaving() { return leaving && std::this_thread::get_id() != leaver; }

Unlocked::Unlocked() {
  ++unlocked_scopes;
  state_ = PyEval_SaveThread();
  if (!is_leaving()) return;
  --unlocked_scopes;
  stay();
}

Unlocked::~Unlocked() {
  if (is_leaving()) {
    --unlocked_scopes;
    stay();
  }
  PyEval_RestoreThread(state_);
  --unlocked_scopes;
}

void bind_leaving() {
  pthread_atfork(nullptr, nullptr, [] { unlocked_scopes = 0; });  // a child has the forking thread alone
  nb::module_::import_("atexit").attr("register")(nb::cpp_function(&leave));
}

}  // namespace aureole::python

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
thread_local int callbacks = 0;  ///< this thread is in
std::thread::id leaver;  ///< the thread that ends the program, which may go on; written before `leaving`

void leave() {
  leaver = std::this_thread::get_id();
  leaving = true;
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(10);
  const auto must_wait = [&] { return unlocked_scopes > 0 && std::chrono::steady_clock::now() < deadline; };
  do {
    // Other threads may need Python's lock to finish. One that has it may begin a scope before this one gets it back.
    PyThreadState* const state = PyEval_SaveThread();
    while (must_wait()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    PyEval_RestoreThread(state);
  } while (must_wait());
}

}  // namespace

bool is_leaving() { return leaving && callbacks == 0 && std::this_thread::get_id() != leaver; }

Callback::Callback() { ++callbacks; }
Callback::~Callback() { --callbacks; }

Unlocked::Unlocked(std::function<void()> before_staying) : before_staying_(std::move(before_staying)) {
  ++unlocked_scopes;
  state_ = PyEval_SaveThread();
  if (is_leaving()) stay();
}

Unlocked::~Unlocked() {
  if (is_leaving()) stay();
  PyEval_RestoreThread(state_);
  --unlocked_scopes;
}

void Unlocked::stay() {
  if (before_staying_) before_staying_();
  nb::set_leak_warnings(false);  // this thread keeps its objects
  --unlocked_scopes;
  for (;;) std::this_thread::sleep_for(std::chrono::hours(1));
}

Unfinished::Unfinished() { ++unlocked_scopes; }
Unfinished::~Unfinished() { --unlocked_scopes; }

void bind_leaving() {
  pthread_atfork(nullptr, nullptr, [] { unlocked_scopes = 0; });  // a child has the forking thread alone
  nb::module_::import_("atexit").attr("register")(nb::cpp_function(&leave));
}

}  // namespace aureole::python

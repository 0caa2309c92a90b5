// SPDX-License-Identifier: Apache-2.0
// Ctrl-C while a scene is loaded whose tables take long.
#pragma once

#include <atomic>
#include <memory>
#include <thread>
#include <utility>

#include "aureole/plugin/table_progress.h"
#include "unlocked.h"

namespace aureole::python {

/// Ends a loading where the handler of a signal raises an exception, which only the thread that loads can see.
class LoadingSignals {
public:
  /// For `LoadOptions::progress`. It does nothing once this object is gone.
  TableProgress progress() const {
    return [state = std::weak_ptr(state_)](const std::string&, double) {
      const auto s = state.lock();
      if (!s) return;
      if (std::this_thread::get_id() == s->loader && s->check.raised()) s->stop = true;
      if (s->stop) throw Stopped();
    };
  }
  /// Returns load(); to be called in the thread that made this object, without Python's lock. Throws the handler's
  /// exception.
  template <class Load>
  auto run(Load&& load) const {
    try {
      return std::forward<Load>(load)();
    } catch (const Stopped&) {
      state_->check.rethrow();
      throw;
    }
  }

private:
  struct Stopped {};  // no std::exception, which would become an error of the scene
  struct State {
    std::thread::id loader = std::this_thread::get_id();
    SignalCheck check;
    std::atomic<bool> stop{false};
  };
  std::shared_ptr<State> state_ = std::make_shared<State>();
};

}  // namespace aureole::python

// SPDX-License-Identifier: Apache-2.0
// Ctrl-C while a scene is loaded whose tables take long, and reports of their progress to Python.
#pragma once

#include <atomic>
#include <chrono>
#include <exception>
#include <memory>
#include <string>
#include <thread>
#include <utility>

#include "aureole/plugin/table_progress.h"
#include "text.h"
#include "unlocked.h"

namespace aureole::python {

/// Ends a loading where the handler of a signal raises an exception, which only the thread that loads can see. From the first second on that
/// thread tells `aureole._bars.show_tables` which part of an object's tables is done; an exception that it raises ends the loading as well.
class LoadingSignals {
public:
  /// For `LoadOptions::progress`. It does nothing once this object is gone.
  TableProgress progress() const {
    return [state = std::weak_ptr(state_)](const std::string& object, double part) {
      const auto s = state.lock();
      if (!s) return;
      if (!s->stop && std::this_thread::get_id() == s->loader) {
        if (s->check.raised())
          s->stop = true;
        else
          s->show(object, part);
      }
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
      if (state_->failure) std::rethrow_exception(std::exchange(state_->failure, nullptr));
      state_->check.rethrow();
      throw;
    }
  }

private:
  using Clock = std::chrono::steady_clock;
  struct Stopped {};  // no std::exception, which would become an error of the scene
  struct State {
    std::thread::id loader = std::this_thread::get_id();
    SignalCheck check;
    std::exception_ptr failure;  // of show_tables
    Clock::time_point begun = Clock::now(), shown = begun;
    std::atomic<bool> stop{false};

    void show(const std::string& object, double part) {
      const auto now = Clock::now();
      if (now - begun < std::chrono::seconds(1) || now - shown < std::chrono::milliseconds(200) ||
          is_leaving())
        return;
      shown = now;
      const Callback lock;
      try {
        nb::module_::import_("aureole._bars").attr("show_tables")(decoded(object), part);
      } catch (const nb::python_error&) {
        failure = std::current_exception();
        stop = true;
      }
    }
  };
  std::shared_ptr<State> state_ = std::make_shared<State>();
};

}  // namespace aureole::python

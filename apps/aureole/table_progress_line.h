// SPDX-License-Identifier: Apache-2.0
// A progress line on the terminal, with the remaining time, while tables of a scene's objects are computed.
#pragma once

#include <chrono>
#include <mutex>
#include <string>

namespace aureole {

/// Returns a time as text, such as "0:05" or "1:02:03".
std::string clock_text(double seconds);

/// A callback for `LoadOptions::progress` while a scene is loaded. It prints on terminals only, starting
/// after one second.
class TableProgressLine {
public:
  explicit TableProgressLine(bool quiet);
  ~TableProgressLine();
  TableProgressLine(const TableProgressLine&) = delete;
  TableProgressLine& operator=(const TableProgressLine&) = delete;

  void show(const std::string& object, double part);

private:
  using Clock = std::chrono::steady_clock;
  const bool enabled_;
  bool shown_ = false;
  std::mutex mutex_;
  std::string object_;
  Clock::time_point begin_, last_;
};

}  // namespace aureole

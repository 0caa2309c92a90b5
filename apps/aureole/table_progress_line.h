// SPDX-License-Identifier: Apache-2.0
// A line on the terminal while tables of a scene's objects are computed, with the remaining time.
#pragma once

#include <chrono>
#include <mutex>
#include <string>

namespace aureole {

/// "0:05" or "1:02:03".
std::string clock_text(double seconds);

/// For `LoadOptions::progress`, while the scene is loaded. Shown on terminals only, from the second second on.
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

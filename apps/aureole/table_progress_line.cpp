// SPDX-License-Identifier: Apache-2.0
#include "table_progress_line.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>

namespace aureole {

std::string clock_text(double seconds) {
  const auto n = static_cast<long>(seconds + 0.5);
  return n >= 3600 ? fmt::format("{}:{:02}:{:02}", n / 3600, n / 60 % 60, n % 60)
                   : fmt::format("{}:{:02}", n / 60, n % 60);
}

TableProgressLine::TableProgressLine(bool quiet) : enabled_(!quiet && isatty(2)) {}
TableProgressLine::~TableProgressLine() {
  if (shown_) std::fprintf(stderr, "\r\033[K");
}

void TableProgressLine::show(const std::string& object, double part) {
  if (!enabled_) return;
  const std::lock_guard guard(mutex_);
  const Clock::time_point now = Clock::now();
  if (object != object_) object_ = object, begin_ = last_ = now;
  const double spent = std::chrono::duration<double>(now - begin_).count();
  if (spent < 1 || now - last_ < std::chrono::milliseconds(200)) return;
  last_ = now;
  shown_ = true;
  std::fprintf(stderr, "\rtables of %s: %.0f %%, %s left \033[K", object.c_str(), 100 * part,
               clock_text(part > 0 ? spent * (1 - part) / part : 0).c_str());
  std::fflush(stderr);
}

}  // namespace aureole

// SPDX-License-Identifier: Apache-2.0
#include "interruption.h"

#include <csignal>

namespace aureole {
namespace {

std::atomic<bool> interrupted_flag{false};
extern "C" void note_interruption(int) { interrupted_flag = true; }

}  // namespace

const std::atomic<bool>& stop_on_interrupt() {
  std::signal(SIGINT, note_interruption);
  return interrupted_flag;
}

bool is_interrupted() { return interrupted_flag; }

}  // namespace aureole

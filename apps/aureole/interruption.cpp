// SPDX-License-Identifier: Apache-2.0
#include "interruption.h"

#include <csignal>

namespace aureole {
namespace {

std::atomic<bool> is_interrupted{false};
extern "C" void note_interruption(int) { is_interrupted = true; }

}  // namespace

const std::atomic<bool>& stop_on_interrupt() {
  std::signal(SIGINT, note_interruption);
  return is_interrupted;
}

}  // namespace aureole

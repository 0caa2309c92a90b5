// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace aureole::fuzz {

/// From now on a signal that ends the process prints its name and the stack to stderr first. Without effect
/// in builds with AddressSanitizer, which prints these itself.
void log_crashes();

}  // namespace aureole::fuzz

// SPDX-License-Identifier: Apache-2.0
// `TransportNotes`: media that integrators which follow light show otherwise than their parameters state.
#pragma once

#include <string>
#include <vector>

namespace aureole {

/// A second base of such a medium.
class TransportNotes {
public:
  virtual ~TransportNotes() = default;
  /// Notes for scenes whose integrator follows light in the medium, each with its place in the file. May make the tables that
  /// such an integrator needs; throws a located Error where they cannot be made.
  virtual std::vector<std::string> transport_notes() const = 0;
};

}  // namespace aureole

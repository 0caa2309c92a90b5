// SPDX-License-Identifier: Apache-2.0
// Lengths of apertures as scene files give them.
#pragma once

#include <string>

#include "aureole/plugin/properties.h"

namespace aureole {

/// The required length `name` in metres. Apertures are between 1 nm and 1 m: their areas stay normal numbers
/// in single precision, and beyond is a mistaken unit.
inline double get_aperture_length_m(const Properties& p, const std::string& name) {
  const double length = p.get_length_m(name, 0);
  if (!p.has(name)) throw p.error(name, "needs the parameter \"" + name + "\", a length such as \"5um\"");
  if (!(length >= 1e-9 && length <= 1)) throw p.error(name, "must be between 1nm and 1m");
  return length;
}

}  // namespace aureole

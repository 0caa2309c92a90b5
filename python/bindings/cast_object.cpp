// SPDX-License-Identifier: Apache-2.0
#include <nanobind/stl/shared_ptr.h>

#include "aureole/aperture/aperture.h"
#include "aureole/bsdf/bsdf.h"
#include "aureole/bssrdf/bssrdf.h"
#include "aureole/emitter/emitter.h"
#include "aureole/medium/medium.h"
#include "aureole/phase/phase.h"
#include "aureole/texture/texture.h"
#include "objects.h"

namespace aureole::python {

nb::object cast_object(const ObjectPtr& object) {
  if (!object) return nb::none();
  if (auto p = std::dynamic_pointer_cast<Bsdf>(object)) return nb::cast(p);
  if (auto p = std::dynamic_pointer_cast<Bssrdf>(object)) return nb::cast(p);
  if (auto p = std::dynamic_pointer_cast<Emitter>(object)) return nb::cast(p);
  if (auto p = std::dynamic_pointer_cast<Aperture>(object)) return nb::cast(p);
  if (auto p = std::dynamic_pointer_cast<Texture>(object)) return nb::cast(p);
  if (auto p = std::dynamic_pointer_cast<PhaseFunction>(object)) return nb::cast(p);
  if (auto p = std::dynamic_pointer_cast<Medium>(object)) return nb::cast(p);
  return nb::cast(object);
}

}  // namespace aureole::python

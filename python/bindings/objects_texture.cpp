// SPDX-License-Identifier: Apache-2.0
// Textures, spectra and apertures over arrays.
#include <nanobind/stl/shared_ptr.h>

#include "aureole/aperture/aperture.h"
#include "aureole/texture/texture.h"
#include "bindings.h"
#include "object_arrays.h"

namespace aureole::python {

void bind_textures(nb::module_& m) {
  nb::class_<Texture, Object>(m, "Texture");
  nb::class_<Aperture, Object>(m, "Aperture");
}

}  // namespace aureole::python

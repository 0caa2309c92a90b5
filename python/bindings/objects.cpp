// SPDX-License-Identifier: Apache-2.0
// Plug-in objects: made of scene text, alone or as parts of a scene.
#include <nanobind/stl/map.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>

#include "aureole/aperture/aperture.h"
#include "aureole/bsdf/bsdf.h"
#include "aureole/emitter/emitter.h"
#include "aureole/scene/build.h"
#include "aureole/texture/texture.h"
#include "bindings.h"

namespace aureole::python {

void bind_objects(nb::module_& m) {
  nb::class_<Object>(m, "Object", "An instance of a plug-in.")
      .def_prop_ro("id", &Object::id, "The id in the scene file, or an empty string.");
  nb::class_<Bsdf, Object>(m, "Bsdf");
  nb::class_<Emitter, Object>(m, "Emitter");
  nb::class_<Aperture, Object>(m, "Aperture");
  nb::class_<Texture, Object>(m, "Texture");

  m.def(
      "load_object",
      [](const std::string& text, const std::string& file, double min_nm, double max_nm,
         const std::map<std::string, ObjectPtr>& given) -> nb::object {
        LoadOptions options;
        options.given = given;
        LoadedObject loaded;
        {
          const nb::gil_scoped_release release;
          loaded = load_object_from_string(text, file, SpectralGrid::over(min_nm, max_nm), options);
        }
        // The most derived class that is known here.
        if (auto p = std::dynamic_pointer_cast<Bsdf>(loaded.object)) return nb::cast(p);
        if (auto p = std::dynamic_pointer_cast<Emitter>(loaded.object)) return nb::cast(p);
        if (auto p = std::dynamic_pointer_cast<Aperture>(loaded.object)) return nb::cast(p);
        if (auto p = std::dynamic_pointer_cast<Texture>(loaded.object)) return nb::cast(p);
        return nb::cast(loaded.object);
      },
      nb::arg("text"), nb::arg("file"), nb::arg("min_nm"), nb::arg("max_nm"), nb::arg("given"),
      "The last object of the scene file in `text`.");
}

}  // namespace aureole::python

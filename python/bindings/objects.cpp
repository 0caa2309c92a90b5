// SPDX-License-Identifier: Apache-2.0
// Plug-in objects: made of scene text, alone or as parts of a scene.
#include "objects.h"

#include <nanobind/stl/map.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>

#include "aureole/aperture/aperture.h"
#include "aureole/bsdf/bsdf.h"
#include "aureole/emitter/emitter.h"
#include "aureole/plugin/registry.h"
#include "aureole/scene/build.h"
#include "aureole/shape/shape.h"
#include "aureole/texture/texture.h"
#include "bindings.h"
#include "object_arrays.h"

namespace aureole::python {

SurfacePoint flat_point(Vec2 uv) {
  // The square [-1, 1]^2, for BSDFs that ask how the surface lies.
  static const std::shared_ptr<const Shape> square = [] {
    const PluginInfo* const plugin = Registry::instance().find("shape", "rectangle");
    return std::dynamic_pointer_cast<const Shape>(
        plugin->create(Properties("rectangle", "", {}, nullptr, plugin)));
  }();
  SurfacePoint point;
  point.uv = uv;
  point.ng = {0, 0, 1};
  point.shape = square.get();
  return point;
}

void throw_direction(const Argument& a, const char* at, const std::string& where) {
  std::string got;
  double square = 0;
  for (int k = 0; k < 3; ++k)
    got += (k ? ", " : "(") + number_text(a.number(at, k)), square += a.number(at, k) * a.number(at, k);
  got += std::isfinite(square) ? ") of length " + number_text(std::sqrt(square)) : ")";
  throw Error(std::string(a.name()) + ": expected unit vectors, got " + got + where);
}

void throw_uv(const Argument& a, const char* at, const std::string& where) {
  throw Error(std::string(a.name()) + ": expected finite texture coordinates up to 10^6, got (" +
              number_text(a.number(at, 0)) + ", " + number_text(a.number(at, 1)) + ")" + where);
}

void throw_wavelength(const Argument& a, double nm, const WavelengthRange& range, const std::string& where) {
  throw Error(std::string(a.name()) + ": expected " + number_text(range.grid.min_nm) + " to " +
              number_text(range.grid.max_nm) + " nm, which this object is made for, got " + number_text(nm) +
              where);
}

PlaceArguments::PlaceArguments(const char* a_name, nb::handle a_value, const char* b_name, nb::handle b_value,
                               nb::handle uv_value, nb::handle wavelength_value)
    : a(a_name, a_value, {0, 0, 1}, 3),
      b(b_name, b_value, {0, 0, 1}, 3),
      uv("uv", uv_value, {0.5, 0.5, 0}, 2),
      wavelength("wavelength", wavelength_value),
      broadcast({&a, &b, &uv, &wavelength}, 3) {}

void bind_objects(nb::module_& m) {
  nb::class_<Object>(m, "Object", "An instance of a plug-in.")
      .def_prop_ro("id", &Object::id, "The id in the scene file, or an empty string.");
  bind_bsdfs(m);
  bind_emitters(m);
  bind_textures(m);

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
        return cast_object(loaded.object);
      },
      nb::arg("text"), nb::arg("file"), nb::arg("min_nm"), nb::arg("max_nm"), nb::arg("given"),
      "The last object of the scene file in `text`.");
}

}  // namespace aureole::python

// SPDX-License-Identifier: Apache-2.0
// Plug-in objects, made from scene text by themselves or as parts of a scene.
#include <nanobind/stl/map.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>

#include <unordered_set>

#include "aureole/aperture/aperture.h"
#include "aureole/bsdf/bsdf.h"
#include "aureole/emitter/emitter.h"
#include "aureole/loading/load.h"
#include "aureole/plugin/array.h"
#include "aureole/plugin/registry.h"
#include "aureole/shape/shape.h"
#include "aureole/texture/texture.h"
#include "bindings.h"
#include "current_tables.h"
#include "loading_signals.h"
#include "object_arrays.h"
#include "objects.h"
#include "python_bsdf.h"

namespace aureole::python {

SurfacePoint flat_point(Vec2 uv) {
  // The square [-1, 1]^2, for BSDFs that need the surface's derivatives.
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

namespace {

/// Whether the object or something below it shows an attribute of a mesh.
bool shows_attribute(const Object& object, std::unordered_set<const Object*>& seen) {
  if (!seen.insert(&object).second) return false;
  if (dynamic_cast<const AttributeTexture*>(&object)) return true;
  for (const Properties::Entry& e : object.properties().entries())
    if (const auto* child = std::get_if<ObjectPtr>(&e.value); child && *child)
      if (shows_attribute(**child, seen)) return true;
  return false;
}

std::string family_of(const Object& object) {
  if (const PluginInfo* plugin = object.properties().plugin()) return plugin->family;
  if (dynamic_cast<const Bsdf*>(&object)) return "bsdf";
  return dynamic_cast<const Array*>(&object) ? "array" : "";
}

nb::object python_value(const Properties::Value& value) {
  if (const auto* b = std::get_if<bool>(&value)) return nb::cast(*b);
  if (const auto* i = std::get_if<std::int64_t>(&value)) return nb::cast(*i);
  if (const auto* d = std::get_if<double>(&value)) return nb::cast(*d);
  if (const auto* s = std::get_if<std::string>(&value)) return nb::cast(*s);
  if (const auto* v = std::get_if<Vec3>(&value))
    return nb::make_tuple(double(v->x), double(v->y), double(v->z));
  if (const auto* t = Properties::transform_of(value)) {
    const Result<double> matrix({4, 4});
    for (int i = 0; i < 16; ++i) matrix.data()[i] = t->matrix()[std::size_t(i / 4)][std::size_t(i % 4)];
    return matrix.object();
  }
  if (const auto* object = std::get_if<ObjectPtr>(&value)) return cast_object(*object);
  if (const auto* motion = Properties::motion_of(value)) {
    nb::list frames;
    for (const KeyFrame& frame : motion->frames())
      frames.append(
          nb::make_tuple(frame.time, python_value(Properties::Value(Shared<Transform>(frame.transform)))));
    return frames;
  }
  const auto& literal = *Properties::spectrum_of(value);
  nb::dict d;
  d["type"] = literal.kind == SpectrumLiteral::Kind::rgb ? "rgb" : "spectrum";
  if (literal.kind == SpectrumLiteral::Kind::value) {
    d["value"] = literal.value;
  } else if (literal.kind == SpectrumLiteral::Kind::rgb) {
    d["value"] = nb::make_tuple(literal.rgb[0], literal.rgb[1], literal.rgb[2]);
  } else {
    nb::list points;
    for (std::size_t k = 0; k < std::min(literal.nm.size(), literal.values.size()); ++k)
      points.append(nb::make_tuple(literal.nm[k], literal.values[k]));
    d["value"] = points;
  }
  return d;
}

nb::dict parameters_of(const Object& object) {
  nb::dict d;
  for (const Properties::Entry& e : object.properties().entries()) {
    std::string name = e.name;
    if (name.empty()) {
      // A child without a name is addressed by its id or its family.
      const auto* child = std::get_if<ObjectPtr>(&e.value);
      const std::string base = !child || !*child        ? "child"
                               : (*child)->id().empty() ? family_of(**child)
                                                        : (*child)->id();
      name = base;
      for (int k = 2; d.contains(name.c_str()); ++k) name = base + "_" + std::to_string(k);
    }
    d[name.c_str()] = python_value(e.value);
  }
  return d;
}

std::string short_repr(nb::handle value) {
  std::string text;
  if (nb::hasattr(value, "shape"))
    text = "<array of shape " + text_of(value.attr("shape")) + ">";
  else
    text = text_of(nb::repr(value));
  constexpr std::size_t kLongest = 200;
  return text.size() > kLongest ? text.substr(0, kLongest - 3) + "..." : text;
}

std::string repr_of(nb::handle self) {
  std::string text = text_of(nb::type_name(self.type()));
  if (!nb::inst_ready(self)) return "<" + text + " that was not made>";
  const auto& object = nb::cast<const Object&>(self);
  text = text.substr(text.rfind('.') + 1) + "('" + object.properties().type() + "'";
  if (!object.id().empty()) text += ", id='" + object.id() + "'";
  if (const auto* p = dynamic_cast<const PythonBsdf*>(&object))
    text += ", " + short_repr(p->instance().attr("target"));
  for (const auto& [name, value] : parameters_of(object))
    text += ", " + text_of(nb::borrow(name)) + "=" + short_repr(value);
  return text + ")";
}

nb::list children_of(const Object& object) {
  nb::list found;
  for (const Properties::Entry& e : object.properties().entries())
    if (const auto* child = std::get_if<ObjectPtr>(&e.value); child && *child)
      found.append(cast_object(*child));
  return found;
}

}  // namespace

void require_standalone(const Object& object) {
  std::unordered_set<const Object*> seen;
  if (shows_attribute(object, seen))
    throw Error("\"" + object.properties().type() +
                "\" has a \"mesh_attribute\" texture, which has values on a mesh only");
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
      .def("__reduce__",
           [](nb::handle self) -> nb::tuple {
             const std::string name = nb::cast<std::string>(self.type().attr("__name__"));
             throw nb::type_error(
                 ("an object of the class " + name +
                  " cannot be pickled: pass the dictionary or the XML it was made of, and call "
                  "load_dict or load_string there")
                     .c_str());
           })
      // Objects do not change, so that a copy would be the same.
      .def("__copy__", [](nb::object self) { return self; })
      .def(
          "__deepcopy__", [](nb::object self, const nb::handle&) { return self; }, nb::arg("memo"))
      .def_prop_ro("id", &Object::id, "The id in the scene file, or an empty string.")
      .def_prop_ro(
          "type", [](const Object& o) { return o.properties().type(); },
          "Name of the plug-in, such as \"roughconductor\".")
      .def_prop_ro("family", &family_of, "What the plug-in is: bsdf, emitter, texture, aperture, shape, ...")
      .def_prop_ro("parameters", &parameters_of, nb::sig("def parameters(self) -> dict[str, typing.Any]"),
                   R"(The parameters that it was made from, without those left at their defaults.

Numbers, strings and booleans are what they are, vectors are tuples, transforms arrays of shape (4, 4), nested objects are objects, and
spectra dicts as `load_dict` takes them. A child without a name goes by its id, or by its family.
)")
      .def_prop_ro("children", &children_of, nb::sig("def children(self) -> list[Object]"),
                   "The nested objects, in order.")
      .def("__repr__", &repr_of);
  bind_bsdfs(m);
  bind_bssrdfs(m);
  bind_emitters(m);
  bind_phases(m);
  bind_media(m);
  bind_textures(m);

  m.def(
      "load_object",
      [](const std::string& text, const std::string& file, double min_nm, double max_nm,
         const std::map<std::string, ObjectPtr>& given) -> nb::object {
        LoadOptions options;
        options.given = given;
        options.tables = current_tables();
        LoadedObject loaded;
        {
          const Unlocked release;
          const LoadingSignals signals;
          options.progress = signals.progress();
          loaded = signals.run([&] {
            return load_object_from_string(text, file, SpectralGrid::over(min_nm, max_nm), options);
          });
        }
        return cast_object(loaded.object);
      },
      nb::arg("text"), nb::arg("file"), nb::arg("min_nm"), nb::arg("max_nm"), nb::arg("given"),
      "The last object of the scene file in `text`.");
}

}  // namespace aureole::python

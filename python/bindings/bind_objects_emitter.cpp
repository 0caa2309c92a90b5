// SPDX-License-Identifier: Apache-2.0
// Emitters over arrays.
#include <nanobind/stl/shared_ptr.h>

#include <cmath>
#include <limits>
#include <mutex>
#include <unordered_map>
#include <vector>

#include "aureole/plugin/registry.h"
#include "aureole/scene/scene.h"
#include "bindings.h"
#include "object_arrays.h"
#include "objects.h"

namespace aureole::python {

namespace {

WavelengthRange range_of(const Emitter& emitter) {
  return WavelengthRange(emitter.properties().context().grid);
}

/// On a shape, which may be gone: only the surface's own radiance can be evaluated.
bool is_on_surface(const Emitter& emitter) {
  const PluginInfo* plugin = emitter.properties().plugin();
  return plugin && plugin->doc.needs_shape;
}

std::string quoted_type(const Emitter& emitter) { return "\"" + emitter.properties().type() + "\""; }

/// An emitter that stands alone.
Light alone(const Emitter& emitter) {
  Light light;
  light.emitter = &emitter;
  return light;
}

nb::object radiance(const Emitter& emitter, nb::handle direction, nb::handle wavelength, nb::handle uv) {
  if (emitter.is_delta())
    throw Error(
        "a " + quoted_type(emitter) +
        " emitter has no radiance, since all its light comes from one point or into one direction; use " +
        (emitter.is_infinite() ? "sample_direct" : "intensity or sample_direct"));
  require_standalone(emitter);
  const PlaceArguments in("direction", direction, "", {}, optional(uv), wavelength);
  const Result<double> result(in.broadcast.shape());
  const bool infinite = emitter.is_infinite();
  for_places(in, range_of(emitter), result.data(),
             [&, point = flat_point()](const Vec3& d, const Vec3&, Vec2 at, const Wavelengths& w) mutable {
               point.uv = at;
               return infinite ? emitter.eval_escaped(d, w) : emitter.eval(point, d, w);
             });
  return result.object();
}

nb::object intensity(const Emitter& emitter, nb::handle direction, nb::handle wavelength) {
  if (!emitter.is_delta() || emitter.is_infinite() || is_on_surface(emitter))
    throw Error("a " + quoted_type(emitter) + " emitter is no point: it has no intensity");
  const PlaceArguments in("direction", direction, "", {}, {}, wavelength);
  const Result<double> result(in.broadcast.shape());
  const Vec3 position = emitter.emission_bounds(alone(emitter), 0).box.center();
  for_places(in, range_of(emitter), result.data(),
             [&](const Vec3& d, const Vec3&, Vec2, const Wavelengths& w) {
               // The irradiance at a distance r, times r^2.
               const Vec3 reference = position + d;
               const auto s = alone(emitter).sample_direct(reference, 0, {0.5f, 0.5f}, w);
               return s ? s->radiance * length_squared(s->p - reference) : Spectrum(0.f);
             });
  return result.object();
}

nb::object sample_direct(const Emitter& emitter, nb::handle reference, nb::handle wavelength, nb::handle u) {
  if (is_on_surface(emitter))
    throw Error("a " + quoted_type(emitter) +
                " emitter is sampled on its shape; alone it has only the radiance of its surface, eval");
  const Argument from("reference", reference, 3), random("u", u, 2), nm("wavelength", wavelength);
  const Broadcast<3> broadcast({&from, &random, &nm}, 2);
  const WavelengthRange range = range_of(emitter);
  const Extents& shape = broadcast.shape();
  const Result<double> wo(shape, 3), value(shape), pdf(shape), distance(shape);
  const Result<bool> valid(shape);
  {
    const Unlocked release;
    Interrupts interrupts;
    broadcast.for_rows([&](const auto& row) {
      for (Py_ssize_t i = 0, out = row.out; i < row.count; ++i, out += row.out_step) {
        const auto at = [&](std::size_t k) { return row.at[k] + i * row.step[k]; };
        const Vec3 p = from.vec3(at(0));
        if (!(length_squared(p) <= 1e30f))
          throw Error("reference: expected finite points, got (" + number_text(from.number(at(0), 0)) + ", " +
                      number_text(from.number(at(0), 1)) + ", " + number_text(from.number(at(0), 2)) + ")" +
                      broadcast.where(0, out));
        const Vec3 numbers = read_random(random, at(1), broadcast, 1, out);
        const Spectrum hero = float(nm.number(at(2)));
        if (!range.holds(hero)) throw_wavelength(nm, nm.number(at(2)), range, broadcast.where(2, out));
        const auto s =
            alone(emitter).sample_direct(p, 0, {numbers.x, numbers.y}, Wavelengths::at(range.grid, hero));
        valid.data()[out] = s && s->pdf > 0;
        const bool good = valid.data()[out];
        for (int k = 0; k < 3; ++k) wo.data()[3 * out + k] = good ? double(s->wo[k]) : 0;
        value.data()[out] = good ? double(s->radiance[0]) : 0;
        pdf.data()[out] = good ? double(s->pdf) : 0;
        distance.data()[out] = !good ? 0
                               : s->infinite || emitter.is_infinite()
                                   ? std::numeric_limits<double>::infinity()
                                   : double(length(s->p - p));
        interrupts.check();
      }
    });
  }
  return nb::module_::import_("aureole._objects")
      .attr("EmitterSample")(wo.object(), value.object(), pdf.object(), distance.object(), valid.object(),
                             emitter.is_delta());
}

/// The scenes that emitters belong to, for functions that depend on an emitter's place.
class Places {
public:
  void add(const std::shared_ptr<const Scene>& scene) {
    const std::lock_guard lock(mutex_);
    std::erase_if(scenes_, [](const auto& place) { return place.second.expired(); });
    for (const Light& light : scene->emitters()) scenes_[light.emitter] = scene;
  }
  /// The scene that was added last, or null.
  std::shared_ptr<const Scene> of(const Emitter& emitter) {
    const std::lock_guard lock(mutex_);
    const auto found = scenes_.find(&emitter);
    return found == scenes_.end() ? nullptr : found->second.lock();
  }

private:
  std::mutex mutex_;
  std::unordered_map<const Emitter*, std::weak_ptr<const Scene>> scenes_;
};
Places& places() {
  static Places all;
  return all;
}

SampledSpectrum power_spectrum(const Emitter& emitter) {
  const std::shared_ptr<const Scene> scene = places().of(emitter);
  std::vector<float> sum;
  for (std::size_t i = 0; scene && i < scene->emitters().size(); ++i) {
    const Light& light = scene->emitters()[i];
    if (light.emitter != &emitter) continue;
    const SampledSpectrum power = light.power_spectrum();
    sum.resize(power.nodes().size());
    for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += power.nodes()[k];
  }
  if (sum.empty()) return alone(emitter).power_spectrum();
  return {emitter.properties().context().grid, std::move(sum)};
}

nb::object power(const Emitter& emitter, nb::handle wavelength) {
  const SampledSpectrum spectrum = power_spectrum(emitter);
  if (is_on_surface(emitter) && !(spectrum.maximum() > 0))
    throw Error("a " + quoted_type(emitter) + " emitter that sits on no shape has no area and no power");
  const PlaceArguments in("", {}, "", {}, {}, wavelength);
  const Result<double> result(in.broadcast.shape());
  for_places(in, range_of(emitter), result.data(),
             [&](const Vec3&, const Vec3&, Vec2, const Wavelengths& w) { return spectrum.eval(w); });
  return result.object();
}

#define ARRAY "numpy.typing.ArrayLike"
#define RESULT "numpy.typing.NDArray[numpy.float64]"

}  // namespace

void remember_lights(const std::shared_ptr<const Scene>& scene) { places().add(scene); }

void bind_emitters(nb::module_& m) {
  nb::class_<Emitter, Object>(
      m, "Emitter",
      "A light. Units are absolute up to one factor that all emitters of a scene have in common.")
      .def_prop_ro("is_infinite", &Emitter::is_infinite, "It lies at infinity: an environment, the sun.")
      .def_prop_ro("is_delta", &Emitter::is_delta,
                   "It is a point or shines into one direction, so that no ray meets it by chance.")
      .def("eval", &radiance, nb::arg("direction").none(), nb::arg("wavelength").none(), nb::kw_only(),
           nb::arg("uv").none() = nb::none(),
           nb::sig("def eval(self, direction: " ARRAY ", wavelength: " ARRAY ", *, uv: " ARRAY
                   " | None = None) -> " RESULT),
           R"(Spectral radiance.

Parameters
----------
direction : array_like, shape (..., 3)
    Unit vectors. For an emitter at infinity, in the world: where one looks, so that light arrives along -direction. For a surface, in its own
    frame (z its normal): where light goes.
wavelength : array_like, shape (...)
    [nm], broadcast against the directions.
uv : array_like, shape (..., 2), optional
    Texture coordinates on a surface, (0.5, 0.5) by default.

Returns
-------
ndarray of float64, shape (...)
    [W/(m^2 sr nm)]. Emitters that are points or shine into one direction have none: an `aureole.Error`.
)")
      .def("intensity", &intensity, nb::arg("direction").none(), nb::arg("wavelength").none(),
           nb::sig("def intensity(self, direction: " ARRAY ", wavelength: " ARRAY ") -> " RESULT),
           R"(Spectral radiant intensity of an emitter that is a point [W/(sr nm)].

Parameters
----------
direction : array_like, shape (..., 3)
    Unit vectors in the world along which light leaves.
wavelength : array_like, shape (...)
    [nm].

Returns
-------
ndarray of float64, shape (...)
)")
      .def("sample_direct", &sample_direct, nb::arg("reference").none(), nb::arg("wavelength").none(),
           nb::arg("u").none(),
           nb::sig("def sample_direct(self, reference: " ARRAY ", wavelength: " ARRAY ", u: " ARRAY
                   ") -> aureole._objects.EmitterSample"),
           R"(Directions from points towards the emitter, and the light that arrives if nothing is in its way.

Parameters
----------
reference : array_like, shape (..., 3)
    Points in the world.
wavelength : array_like, shape (...)
    [nm].
u : array_like, shape (..., 2)
    Random numbers in [0, 1).

Returns
-------
aureole.EmitterSample
    Arrays `wo`, `radiance`, `pdf`, `distance`, `valid`. Emitters on surfaces are sampled in scenes only.
)")
      .def("power", &power, nb::arg("wavelength").none(),
           nb::sig("def power(self, wavelength: " ARRAY ") -> " RESULT),
           R"(Spectral power [W/nm].

Of an emitter at infinity what it sends through a sphere: that around the scene it is in, or of radius 1 where it stands alone. It is what the
choice of lights in a render goes by; of an environment map it is that of the map's mean colour.

Parameters
----------
wavelength : array_like, shape (...)
    [nm].

Returns
-------
ndarray of float64, shape (...)
)");
}

}  // namespace aureole::python

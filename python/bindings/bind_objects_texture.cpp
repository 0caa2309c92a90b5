// SPDX-License-Identifier: Apache-2.0
// Textures, spectra and apertures over arrays.
#include <nanobind/stl/complex.h>
#include <nanobind/stl/shared_ptr.h>

#include "aureole/aperture/aperture.h"
#include "aureole/texture/texture.h"
#include "bindings.h"
#include "object_arrays.h"

namespace aureole::python {

namespace {

WavelengthRange range_of(const Texture& texture) {
  return WavelengthRange(texture.properties().context().grid);
}

nb::object eval(const Texture& texture, nb::handle wavelength, nb::handle uv) {
  require_standalone(texture);
  const PlaceArguments in("", {}, "", {}, optional(uv), wavelength);
  const Result<double> result(in.broadcast.shape());
  for_places(in, range_of(texture), result.data(),
             [&, point = flat_point()](const Vec3&, const Vec3&, Vec2 at, const Wavelengths& w) mutable {
               point.uv = at;
               return texture.eval(point, w);
             });
  return result.object();
}

nb::object mean(const Texture& texture, nb::handle wavelength) {
  require_standalone(texture);
  const PlaceArguments in("", {}, "", {}, {}, wavelength);
  const Result<double> result(in.broadcast.shape());
  const SampledSpectrum average = texture.average();
  for_places(in, range_of(texture), result.data(),
             [&](const Vec3&, const Vec3&, Vec2, const Wavelengths& w) { return average.eval(w); });
  return result.object();
}

nb::object eval_scalar(const Texture& texture, nb::handle uv) {
  require_standalone(texture);
  const Argument place("uv", uv, 2);
  const Broadcast<1> broadcast({&place}, 1);
  const Result<double> result(broadcast.shape());
  {
    const Unlocked release;
    Interrupts interrupts;
    SurfacePoint point = flat_point();
    broadcast.for_rows([&](const auto& row) {
      for (Py_ssize_t i = 0, out = row.out; i < row.count; ++i, out += row.out_step) {
        const char* const at = row.at[0] + i * row.step[0];
        point.uv = place.vec2(at);
        if (!is_sane(point.uv)) throw_uv(place, at, broadcast.where(0, out));
        result.data()[out] = double(texture.eval_scalar(point));
        interrupts.check();
      }
    });
  }
  return result.object();
}

nb::object transform_aperture(const Aperture& aperture, nb::handle q) {
  const Argument vectors("q", q, 2);
  const Broadcast<1> broadcast({&vectors}, 1);
  const Result<std::complex<double>> result(broadcast.shape());
  {
    const Unlocked release;
    Interrupts interrupts;
    broadcast.for_rows([&](const auto& row) {
      for (Py_ssize_t i = 0, out = row.out; i < row.count; ++i, out += row.out_step) {
        const char* const at = row.at[0] + i * row.step[0];
        const double x = vectors.number(at, 0), y = vectors.number(at, 1);
        if (!std::isfinite(x) || !std::isfinite(y))
          throw Error("q: expected finite numbers, got (" + number_text(x) + ", " + number_text(y) + ")" +
                      broadcast.where(0, out));
        result.data()[out] = aperture.shape()->transform(x, y);
        interrupts.check();
      }
    });
  }
  return result.object();
}

#define ARRAY "numpy.typing.ArrayLike"
#define RESULT "numpy.typing.NDArray[numpy.float64]"

}  // namespace

void bind_textures(nb::module_& m) {
  nb::class_<Texture, Object>(m, "Texture", "A spectrum that may vary over a surface.")
      .def_prop_ro("is_constant", &Texture::is_constant, "The value is the same everywhere on a surface.")
      .def("eval", &eval, nb::arg("wavelength").none(), nb::kw_only(), nb::arg("uv").none() = nb::none(),
           nb::sig("def eval(self, wavelength: " ARRAY ", *, uv: " ARRAY " | None = None) -> " RESULT),
           R"(The value of the spectrum.

Parameters
----------
wavelength : array_like, shape (...)
    [nm].
uv : array_like, shape (..., 2), optional
    Texture coordinates, broadcast against the wavelengths without their last axis; (0.5, 0.5) by default.

Returns
-------
ndarray of float64, shape (...)
    Without a unit for a reflectance, [W/(m^2 sr nm)] and the like for an emission.
)")
      .def("mean", &mean, nb::arg("wavelength").none(),
           nb::sig("def mean(self, wavelength: " ARRAY ") -> " RESULT),
           R"(The mean over texture coordinates in [0, 1]^2.

Parameters
----------
wavelength : array_like, shape (...)
    [nm].

Returns
-------
ndarray of float64, shape (...)
)")
      .def(
          "eval_scalar", &eval_scalar, nb::arg("uv").none(),
          nb::sig("def eval_scalar(self, uv: " ARRAY ") -> " RESULT),
          R"(The value as one number, as opacities, weights and heights are read: of a colour the luminance, else the mean over the wavelengths.

Parameters
----------
uv : array_like, shape (..., 2)
    Texture coordinates.

Returns
-------
ndarray of float64, shape (...)
)");

  nb::class_<Aperture, Object>(m, "Aperture",
                               "The shape of openings (or opaque discs) in a layer of scatterers.")
      .def_prop_ro(
          "area", [](const Aperture& a) { return a.shape()->area(); }, "Integral of the transmittance [m^2].")
      .def_prop_ro(
          "bounding_radius", [](const Aperture& a) { return a.shape()->bounding_radius(); },
          "Radius of the smallest circle about the origin that holds the shape [m].")
      .def_prop_ro(
          "shape",
          [](const Aperture& a) { return std::const_pointer_cast<optics::ApertureShape>(a.shape()); },
          "The unturned shape, as those of `aureole.optics`.")
      .def_prop_ro("fraction", &Aperture::fraction, "Its part of the number of scatterers of a layer.")
      .def_prop_ro("rotation", &Aperture::rotation,
                   "Angle that every scatterer is turned by, counter-clockwise [rad].")
      .def_prop_ro("is_randomly_rotated", &Aperture::is_randomly_rotated,
                   "Every scatterer is turned by a random angle of its own.")
      .def(
          "transform", &transform_aperture, nb::arg("q").none(),
          nb::sig("def transform(self, q: " ARRAY ") -> numpy.typing.NDArray[numpy.complex128]"),
          R"(Fourier transform of the unturned shape, F(q) = integral of A(x) exp(-i q.x) over the plane, with F(0) the area.

Parameters
----------
q : array_like, shape (..., 2)
    [rad/m].

Returns
-------
ndarray of complex128, shape (...)
    [m^2].
)");
}

}  // namespace aureole::python

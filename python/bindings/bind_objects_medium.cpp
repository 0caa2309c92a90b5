// SPDX-License-Identifier: Apache-2.0
// Media over arrays of wavelengths.
#include <nanobind/stl/array.h>
#include <nanobind/stl/shared_ptr.h>

#include <array>
#include <vector>

#include "aureole/instrument/medium_figures.h"
#include "aureole/medium/medium.h"
#include "bindings.h"
#include "object_arrays.h"

namespace aureole::python {

namespace {

WavelengthRange range_of(const Medium& medium) { return WavelengthRange(medium.properties().context().grid); }

nb::object coefficients(const Medium& medium, nb::handle wavelength, nb::handle d,
                        const std::array<double, 3>& p) {
  const Vec3 point = point_of(p);
  const PlaceArguments in("d", optional(d), "", {}, {}, wavelength);
  const Extents& shape = in.broadcast.shape();
  const Result<double> sigma_t(shape), sigma_s(shape), emission(shape);
  const auto fill = [&](const Result<double>& result, Spectrum MediumCoefficients::*member) {
    for_places(in, range_of(medium), result.data(),
               [&](const Vec3& along, const Vec3&, Vec2, const Wavelengths& w) {
                 MediumCoefficients c;
                 medium.eval(point, along, w, c);
                 return c.*member;
               });
  };
  fill(sigma_t, &MediumCoefficients::sigma_t);
  fill(sigma_s, &MediumCoefficients::sigma_s);
  fill(emission, &MediumCoefficients::emission);
  return nb::module_::import_("aureole._objects")
      .attr("MediumCoefficients")(sigma_t.object(), sigma_s.object(), emission.object());
}

nb::object asymmetry(const Medium& medium, nb::handle wavelength, const std::array<double, 3>& d,
                     const std::array<double, 3>& p) {
  const Vec3 point = point_of(p);
  Vec3 along{float(d[0]), float(d[1]), float(d[2])};
  if (!make_unit(along)) throw Error("d: expected a unit vector");
  const Argument given("wavelength", wavelength);
  const Broadcast<1> broadcast({&given}, 1);
  const WavelengthRange range = range_of(medium);
  const Result<double> result(broadcast.shape());
  std::vector<double> nm;
  std::vector<Py_ssize_t> places;
  broadcast.for_rows([&](const auto& row) {
    for (Py_ssize_t i = 0, out = row.out; i < row.count; ++i, out += row.out_step) {
      nm.push_back(given.number(row.at[0] + i * row.step[0])), places.push_back(out);
      if (!range.holds(Spectrum(float(nm.back()))))
        throw_wavelength(given, nm.back(), range, broadcast.where(0, out));
    }
  });
  {
    const Unlocked release;
    const std::vector<MediumFigures> figures = measure_medium(medium, nm, point, along);
    for (std::size_t i = 0; i < nm.size(); ++i) result.data()[places[i]] = figures[i].asymmetry;
  }
  return result.object();
}

#define ARRAY "numpy.typing.ArrayLike"
#define RESULT "numpy.typing.NDArray[numpy.float64]"
#define TRIPLE "tuple[float, float, float]"

constexpr const char* kCoefficientsDoc =
    R"(Coefficients of extinction and scattering, and the emission, by wavelength.

Lengths are in units of the scene; an object that was loaded alone has metres.

Parameters
----------
wavelength : array_like, shape (...)
    In vacuum [nm], within the range that the object was made for (360 to 830 if nothing else was said).
d : array_like, shape (..., 3), optional
    Direction of the light, which particles that are neither spheres nor turned at random care about; a unit vector, (0, 0, 1) by
    default. It broadcasts against the wavelengths without its last axis.
p : sequence of 3 floats
    The place in the world, for media that vary in space.

Returns
-------
aureole.MediumCoefficients
    Arrays `sigma_t`, `sigma_s`, `sigma_a`, `albedo` and `emission`, shape (...).

Examples
--------
>>> water = aureole.load_dict({"type": "solution"})
>>> [round(float(a), 3) for a in water.coefficients([550, 700]).sigma_a]
[0.056, 0.624]
)";

constexpr const char* kAsymmetryDoc =
    R"(Mean cosine of the scattering angle, by quadrature of the phase function; 0 where nothing scatters.

Parameters
----------
wavelength : array_like, shape (...)
    As for `coefficients`.
d, p : sequence of 3 floats
    Direction of the light and the place, as for `coefficients`.

Returns
-------
ndarray of float64, shape (...)
)";

}  // namespace

void bind_media(nb::module_& m) {
  const std::array<double, 3> origin{}, z{0, 0, 1};
  nb::class_<Medium, Object>(m, "Medium", "Matter that absorbs, scatters and emits light between surfaces.")
      .def("coefficients", &coefficients, nb::arg("wavelength").none(), nb::kw_only(),
           nb::arg("d").none() = nb::none(), nb::arg("p") = origin,
           nb::sig("def coefficients(self, wavelength: " ARRAY ", *, d: " ARRAY " | None = None, p: " TRIPLE
                   " = (0.0, 0.0, 0.0)) -> aureole._objects.MediumCoefficients"),
           kCoefficientsDoc)
      .def("asymmetry", &asymmetry, nb::arg("wavelength").none(), nb::kw_only(), nb::arg("d") = z,
           nb::arg("p") = origin,
           nb::sig("def asymmetry(self, wavelength: " ARRAY ", *, d: " TRIPLE " = (0.0, 0.0, 1.0), p: " TRIPLE
                   " = (0.0, 0.0, 0.0)) -> " RESULT),
           kAsymmetryDoc)
      .def_prop_ro(
          "phase", [](const Medium& medium) -> const PhaseFunction& { return medium.phase(); },
          nb::rv_policy::reference_internal, "Into which directions it scatters: an `aureole.Phase`.")
      .def_prop_ro("is_uniform", &Medium::is_uniform, "Coefficients are the same everywhere.");
}

}  // namespace aureole::python

// SPDX-License-Identifier: Apache-2.0
// Phase functions over arrays.
#include <nanobind/stl/array.h>
#include <nanobind/stl/shared_ptr.h>

#include <array>
#include <cmath>

#include "aureole/phase/phase.h"
#include "bindings.h"
#include "object_arrays.h"

namespace aureole::python {

namespace {

WavelengthRange range_of(const PhaseFunction& phase) {
  return WavelengthRange(phase.properties().context().grid);
}

/// The value of each element, or with `Pdf` the density.
template <bool Pdf>
nb::object evaluate_phase(const PhaseFunction& phase, nb::handle wi, nb::handle wo, nb::handle wavelength,
                          const std::array<double, 3>& p) {
  const Vec3 point = point_of(p);
  const PlaceArguments in("wi", wi, "wo", wo, {}, wavelength);
  Result<double> result(in.broadcast.shape());
  for_places(in, range_of(phase), result.data(),
             [&](const Vec3& i, const Vec3& o, Vec2, const Wavelengths& w) {
               const PhaseEval e = phase.eval_pdf(i, o, {w, point});
               return Pdf ? e.pdf : e.value;
             });
  return result.object();
}

nb::object sample_phase(const PhaseFunction& phase, nb::handle wi, nb::handle wavelength, nb::handle u,
                        const std::array<double, 3>& p) {
  const Vec3 point = point_of(p);
  const Argument given("wi", wi, 3), random("u", u, 3), nm("wavelength", wavelength);
  const Broadcast<3> broadcast({&given, &random, &nm}, 3);
  const WavelengthRange range = range_of(phase);
  const Extents& shape = broadcast.shape();
  const Result<double> wo(shape, 3), value(shape), pdf(shape);
  const Result<bool> valid(shape);
  {
    const Unlocked release;
    Interrupts interrupts;
    broadcast.for_rows([&](const auto& row) {
      for (Py_ssize_t i = 0, out = row.out; i < row.count; ++i, out += row.out_step) {
        const auto at = [&](std::size_t k) { return row.at[k] + i * row.step[k]; };
        Vec3 w = given.vec3(at(0));
        if (!make_unit(w)) throw_direction(given, at(0), broadcast.where(0, out));
        const Vec3 numbers = read_random(random, at(1), broadcast, 1, out);
        const Spectrum hero = float(nm.number(at(2)));
        if (!range.holds(hero)) throw_wavelength(nm, nm.number(at(2)), range, broadcast.where(2, out));
        const Wavelengths wavelengths = Wavelengths::at(range.grid, hero);
        const auto s = phase.sample(w, numbers.x, {numbers.y, numbers.z}, {wavelengths, point});
        valid.data()[out] = bool(s);
        for (int k = 0; k < 3; ++k) wo.data()[3 * out + k] = s ? double(s->wo[k]) : 0;
        value.data()[out] = s ? double(s->value[0]) : 0;
        pdf.data()[out] = s ? double(s->pdf[0]) : 0;
        interrupts.check();
      }
    });
  }
  return nb::module_::import_("aureole._objects")
      .attr("PhaseSample")(wo.object(), value.object(), pdf.object(), valid.object());
}

nb::object projected_area(const PhaseFunction& phase, nb::handle d, const std::array<double, 3>& p) {
  const Vec3 point = point_of(p);
  const Argument directions("d", d, 3);
  const Broadcast<1> broadcast({&directions}, 1);
  const Result<double> result(broadcast.shape());
  {
    const Unlocked release;
    Interrupts interrupts;
    broadcast.for_rows([&](const auto& row) {
      for (Py_ssize_t i = 0, out = row.out; i < row.count; ++i, out += row.out_step) {
        const char* const at = row.at[0] + i * row.step[0];
        Vec3 w = directions.vec3(at);
        if (!make_unit(w)) throw_direction(directions, at, broadcast.where(0, out));
        result.data()[out] = double(phase.projected_area(w, point));
        interrupts.check();
      }
    });
  }
  return result.object();
}

#define ARRAY "numpy.typing.ArrayLike"
#define RESULT "numpy.typing.NDArray[numpy.float64]"
#define POINT ", p: tuple[float, float, float] = (0.0, 0.0, 0.0)"

constexpr const char* kPhaseEvalDoc =
    R"(Value of the phase function: a density over directions, integral 1 over the sphere.

Directions are unit vectors of the world that point away from the place: wi towards where the path came from, wo into the new
direction. Light goes straight on where wo = -wi: the cosine of the scattering angle is -dot(wi, wo). All arguments but p broadcast as
numpy's do, directions without their last axis. Elements one after another that share wi and wo go through one evaluation of up to 8
wavelengths: put wavelengths into an axis of their own where many are wanted.

Parameters
----------
wi, wo : array_like, shape (..., 3)
    Given and sampled direction. A length may differ from 1 by 0.001; such vectors are normalised.
wavelength : array_like, shape (...)
    In vacuum [nm], within the range that the object was made for (360 to 830 if nothing else was said).
p : sequence of 3 floats
    The place in the world, for phase functions that vary in space.

Returns
-------
ndarray of float64, shape (...)
    [1/sr].

Examples
--------
>>> import numpy as np
>>> phase = aureole.load_dict({"type": "rayleigh"})
>>> round(phase.eval((0, 0, -1), (1, 0, 0), 550) * 16 * np.pi / 3, 6)
1.0
)";

constexpr const char* kPhasePdfDoc =
    R"(Density of `sample` for the direction wo [1/sr] if `wavelength` is the one that is sampled for.

Arguments and broadcasting are those of `eval`.
)";

constexpr const char* kPhaseSampleDoc =
    R"(Draws directions, one per element, each for its own wavelength.

Parameters
----------
wi : array_like, shape (..., 3)
    Given directions, as for `eval`.
wavelength : array_like, shape (...)
    [nm].
u : array_like, shape (..., 3)
    Random numbers in [0, 1): the first chooses between parts, the others the direction.
p : sequence of 3 floats
    As for `eval`.

Returns
-------
aureole.PhaseSample
    Arrays `wo` (..., 3), `value`, `pdf` and `valid` (...).
)";

constexpr const char* kAreaDoc =
    R"(Area that the particles show to light along a direction: the factor of the medium's coefficients.

1 unless the particles are neither spheres nor turned at random, as those of `sggx`.

Parameters
----------
d : array_like, shape (..., 3)
    Unit vectors; d and -d have the same area.
p : sequence of 3 floats
    As for `eval`.

Returns
-------
ndarray of float64, shape (...)
)";

}  // namespace

void bind_phases(nb::module_& m) {
  const std::array<double, 3> origin{};
  nb::class_<PhaseFunction, Object>(m, "Phase", "Into which directions a medium scatters light.")
      .def("eval", &evaluate_phase<false>, nb::arg("wi").none(), nb::arg("wo").none(),
           nb::arg("wavelength").none(), nb::kw_only(), nb::arg("p") = origin,
           nb::sig("def eval(self, wi: " ARRAY ", wo: " ARRAY ", wavelength: " ARRAY ", *" POINT
                   ") -> " RESULT),
           kPhaseEvalDoc)
      .def("pdf", &evaluate_phase<true>, nb::arg("wi").none(), nb::arg("wo").none(),
           nb::arg("wavelength").none(), nb::kw_only(), nb::arg("p") = origin,
           nb::sig("def pdf(self, wi: " ARRAY ", wo: " ARRAY ", wavelength: " ARRAY ", *" POINT
                   ") -> " RESULT),
           kPhasePdfDoc)
      .def("sample", &sample_phase, nb::arg("wi").none(), nb::arg("wavelength").none(), nb::arg("u").none(),
           nb::kw_only(), nb::arg("p") = origin,
           nb::sig("def sample(self, wi: " ARRAY ", wavelength: " ARRAY ", u: " ARRAY ", *" POINT
                   ") -> aureole._objects.PhaseSample"),
           kPhaseSampleDoc)
      .def("projected_area", &projected_area, nb::arg("d").none(), nb::kw_only(), nb::arg("p") = origin,
           nb::sig("def projected_area(self, d: " ARRAY ", *" POINT ") -> " RESULT), kAreaDoc);
}

}  // namespace aureole::python

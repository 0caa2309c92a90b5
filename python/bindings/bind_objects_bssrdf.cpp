// SPDX-License-Identifier: Apache-2.0
// Profiles of BSSRDFs over arrays.
#include <nanobind/stl/shared_ptr.h>

#include <cmath>

#include "aureole/bssrdf/bssrdf.h"
#include "bindings.h"
#include "object_arrays.h"

namespace aureole::python {

namespace {

/// Calls `f(x, context) -> double` for each element of `numbers`, broadcast against the wavelengths, where `read` has
/// checked it.
template <class Read, class F>
nb::object for_each_element(const Bssrdf& bssrdf, const Argument& numbers, nb::handle wavelength,
                            const Read& read, const F& f) {
  const Argument nm("wavelength", wavelength);
  const Broadcast<2> broadcast({&numbers, &nm}, 2);
  const WavelengthRange range(bssrdf.properties().context().grid);
  const Result<double> result(broadcast.shape());
  {
    const Unlocked release;
    Interrupts interrupts;
    const SurfacePoint point = flat_point();
    broadcast.for_rows([&](const auto& row) {
      for (Py_ssize_t i = 0, out = row.out; i < row.count; ++i, out += row.out_step) {
        const auto at = [&](std::size_t k) { return row.at[k] + i * row.step[k]; };
        const float x = read(at(0), broadcast, out);
        const Spectrum hero = float(nm.number(at(1)));
        if (!range.holds(hero)) throw_wavelength(nm, nm.number(at(1)), range, broadcast.where(1, out));
        const Wavelengths wavelengths = Wavelengths::at(range.grid, hero);
        result.data()[out] = double(f(x, BssrdfContext{wavelengths, point}));
        interrupts.check();
      }
    });
  }
  return result.object();
}

/// The value of each element, or with `Pdf` the density.
template <bool Pdf>
nb::object evaluate_bssrdf(const Bssrdf& bssrdf, nb::handle distance, nb::handle wavelength) {
  const Argument r("distance", distance);
  return for_each_element(
      bssrdf, r, wavelength,
      [&](const char* at, const Broadcast<2>& broadcast, Py_ssize_t out) {
        const double x = r.number(at);
        if (!(x >= 0 && std::isfinite(float(x))))
          throw Error("distance: expected numbers that are finite and not negative, got " + number_text(x) +
                      broadcast.where(0, out));
        return float(x);
      },
      [&](float x, const BssrdfContext& context) {
        const BssrdfEval e = bssrdf.eval_pdf(x, context);
        return Pdf ? e.pdf[0] : e.value[0];
      });
}

nb::object sample_bssrdf(const Bssrdf& bssrdf, nb::handle wavelength, nb::handle u) {
  const Argument random("u", u);
  return for_each_element(
      bssrdf, random, wavelength,
      [&](const char* at, const Broadcast<2>& broadcast, Py_ssize_t out) {
        const double x = random.number(at);
        if (!(x >= 0 && x < 1))
          throw Error("u: expected numbers in [0, 1), got " + number_text(x) + broadcast.where(0, out));
        return below_one(float(x));
      },
      [&](float x, const BssrdfContext& context) { return bssrdf.sample_distance(x, context); });
}

#define ARRAY "numpy.typing.ArrayLike"
#define RESULT "numpy.typing.NDArray[numpy.float64]"

constexpr const char* kBssrdfEvalDoc =
    R"(The profile: of the light that has entered at a point, the part that leaves per area at a distance.

It is for a flat, thick body. Its integral over the plane is the part of the light inside that comes out again. What the boundary
reflects, and how much it lets in, is that of `boundary`.

Parameters
----------
distance : array_like, shape (...)
    From where the light has entered, in units of the scene; an object that was loaded alone has metres.
wavelength : array_like, shape (...)
    In vacuum [nm], within the range that the object was made for (360 to 830 if nothing else was said). Both arguments
    broadcast as numpy's do.

Returns
-------
ndarray of float64, shape (...)
    [1/length^2].

Examples
--------
>>> import numpy as np
>>> wax = aureole.load_dict({"type": "normalized_diffusion", "sigma_a": 10, "sigma_s": 2000})
>>> profile = wax.eval([1e-4, 1e-3], 550)
>>> bool(profile[0] > profile[1] > 0)
True
)";

constexpr const char* kBssrdfPdfDoc =
    R"(Density per area with which `sample` finds a distance [1/length^2] if `wavelength` is the one that is sampled for.

Arguments are those of `eval`. The density of the distance itself is 2 pi distance times as large.
)";

constexpr const char* kBssrdfSampleDoc =
    R"(Draws distances at which light leaves, one per element, each for its own wavelength.

Parameters
----------
wavelength : array_like, shape (...)
    [nm].
u : array_like, shape (...)
    Random numbers in [0, 1).

Returns
-------
ndarray of float64, shape (...)
    In units of the scene.
)";

}  // namespace

void bind_bssrdfs(nb::module_& m) {
  nb::class_<Bssrdf, Object>(m, "Bssrdf", "Where light leaves a translucent body that it has entered.")
      .def("eval", &evaluate_bssrdf<false>, nb::arg("distance").none(), nb::arg("wavelength").none(),
           nb::sig("def eval(self, distance: " ARRAY ", wavelength: " ARRAY ") -> " RESULT), kBssrdfEvalDoc)
      .def("pdf", &evaluate_bssrdf<true>, nb::arg("distance").none(), nb::arg("wavelength").none(),
           nb::sig("def pdf(self, distance: " ARRAY ", wavelength: " ARRAY ") -> " RESULT), kBssrdfPdfDoc)
      .def("sample", &sample_bssrdf, nb::arg("wavelength").none(), nb::arg("u").none(),
           nb::sig("def sample(self, wavelength: " ARRAY ", u: " ARRAY ") -> " RESULT), kBssrdfSampleDoc)
      .def_prop_ro(
          "boundary", [](const Bssrdf& b) -> const Bsdf& { return *b.boundary(); },
          nb::rv_policy::reference_internal,
          "The surface as light meets it from outside: what it reflects, an `aureole.Bsdf`.");
}

}  // namespace aureole::python

// SPDX-License-Identifier: Apache-2.0
// BSDFs over arrays.
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>

#include <cmath>
#include <cstdint>

#include "bindings.h"
#include "object_arrays.h"
#include "python_bsdf.h"

namespace aureole::python {

namespace {

TransportMode mode_of(const std::string& name) {
  if (name == "radiance") return TransportMode::radiance;
  if (name == "importance") return TransportMode::importance;
  throw Error("mode: expected \"radiance\" or \"importance\", got \"" + name + "\"");
}

std::uint32_t key_of(std::int64_t seed) {
  if (seed < 0 || seed > 0xffffffff)
    throw Error("seed: expected 0 to 4294967295, got " + std::to_string(seed));
  return std::uint32_t(seed);
}

WavelengthRange range_of(const Object& object) { return WavelengthRange(object.properties().context().grid); }

/// The value of each element, or with `Pdf` the density.
template <bool Pdf>
nb::object evaluate_bsdf(const Bsdf& bsdf, nb::handle wi, nb::handle wo, nb::handle wavelength, nb::handle uv,
                         const std::string& mode, std::int64_t seed) {
  const TransportMode transport = mode_of(mode);
  const std::uint32_t key = key_of(seed);
  // A BSDF written in Python takes whole arrays in one call.
  if (const auto* p = dynamic_cast<const PythonBsdf*>(&bsdf))
    return p->instance().attr(Pdf ? "pdf_array" : "eval_array")(wi, wo, wavelength, uv, mode);
  require_standalone(bsdf);
  const PlaceArguments in("wi", wi, "wo", wo, optional(uv), wavelength);
  Result<double> result(in.broadcast.shape());
  for_places(in, range_of(bsdf), result.data(),
             [&, point = flat_point()](const Vec3& i, const Vec3& o, Vec2 at, const Wavelengths& w) mutable {
               point.uv = at;
               const BsdfContext ctx{w, point, transport, key};
               return Pdf ? bsdf.eval_pdf(i, o, ctx).pdf : bsdf.eval(i, o, ctx);
             });
  return result.object();
}

nb::object sample_bsdf(const Bsdf& bsdf, nb::handle wi, nb::handle wavelength, nb::handle u, nb::handle uv,
                       const std::string& mode, std::int64_t seed) {
  const TransportMode transport = mode_of(mode);
  const std::uint32_t key = key_of(seed);
  if (const auto* p = dynamic_cast<const PythonBsdf*>(&bsdf))
    return p->instance().attr("sample_array")(wi, wavelength, u, uv, mode);
  require_standalone(bsdf);
  const Argument given("wi", wi, 3), random("u", u, 3), place("uv", optional(uv), {0.5, 0.5, 0}, 2),
      nm("wavelength", wavelength);
  const Broadcast<4> broadcast({&given, &random, &place, &nm}, 3);
  const WavelengthRange range = range_of(bsdf);
  const Extents& shape = broadcast.shape();
  const Result<double> wo(shape, 3), value(shape), pdf(shape), eta(shape);
  const Result<bool> valid(shape);
  const Result<std::uint32_t> lobe(shape);
  {
    const Unlocked release;
    Interrupts interrupts;
    SurfacePoint point = flat_point();
    broadcast.for_rows([&](const auto& row) {
      for (Py_ssize_t i = 0, out = row.out; i < row.count; ++i, out += row.out_step) {
        const auto at = [&](std::size_t k) { return row.at[k] + i * row.step[k]; };
        Vec3 w = given.vec3(at(0));
        if (!make_unit(w)) throw_direction(given, at(0), broadcast.where(0, out));
        const Vec3 numbers = read_random(random, at(1), broadcast, 1, out);
        point.uv = place.vec2(at(2));
        if (!is_sane(point.uv)) throw_uv(place, at(2), broadcast.where(2, out));
        const Spectrum hero = float(nm.number(at(3)));
        if (!range.holds(hero)) throw_wavelength(nm, nm.number(at(3)), range, broadcast.where(3, out));
        const Wavelengths wavelengths = Wavelengths::at(range.grid, hero);
        auto s = bsdf.sample(w, numbers.x, {numbers.y, numbers.z}, {wavelengths, point, transport, key});
        if (s && !(s->pdf[0] > 0)) s.reset();
        valid.data()[out] = bool(s);
        for (int k = 0; k < 3; ++k) wo.data()[3 * out + k] = s ? double(s->wo[k]) : 0;
        value.data()[out] = s ? double(s->value[0]) : 0;
        pdf.data()[out] = s ? double(s->pdf[0]) : 0;
        eta.data()[out] = s ? double(s->eta) : 1;
        lobe.data()[out] = s ? std::uint32_t(s->lobe) : 0;
        interrupts.check();
      }
    });
  }
  return nb::module_::import_("aureole._objects")
      .attr("BsdfSample")(wo.object(), value.object(), pdf.object(), valid.object(), lobe.object(),
                          eta.object());
}

/// Which directions an albedo counts.
struct Part {
  bool reflected = true, transmitted = true;
  explicit Part(const std::string& name) {
    if (name != "all" && name != "reflect" && name != "transmit")
      throw Error(R"(part: expected "all", "reflect" or "transmit", got ")" + name + "\"");
    reflected = name != "transmit", transmitted = name != "reflect";
  }
};

struct Estimate {
  double mean = 0, error = 0;
};

/// Copies of one set of points, each moved at random: their means are independent, so that their spread is
/// the error.
constexpr int kCopies = 8;

/// The mean of value/pdf over points of the unit cube that fill it evenly (an additive recurrence by powers
/// of the root of x^4 = x + 1, the generalised golden ratio).
Estimate estimate_albedo(const Bsdf& bsdf, const Vec3& wi, const BsdfContext& ctx, const Part& part,
                         int samples, Interrupts& interrupts) {
  constexpr double kRoot = 1.2207440846057594754;
  constexpr std::array<double, 3> kSteps = {1 / kRoot, 1 / (kRoot * kRoot), 1 / (kRoot * kRoot * kRoot)};
  const int per_copy = (samples + kCopies - 1) / kCopies;
  std::uint64_t state = ctx.key;
  double sum = 0, squares = 0;
  for (int copy = 0; copy < kCopies; ++copy) {
    std::array<double, 3> u;
    for (double& x : u) {  // splitmix64
      std::uint64_t z = (state += 0x9e3779b97f4a7c15u);
      z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
      z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
      x = double((z ^ (z >> 31)) >> 11) * 0x1p-53;
    }
    double mean = 0;
    for (int i = 0; i < per_copy; ++i) {
      for (int k = 0; k < 3; ++k) u[k] += kSteps[k], u[k] -= u[k] >= 1;
      const auto s =
          bsdf.sample(wi, below_one(float(u[0])), {below_one(float(u[1])), below_one(float(u[2]))}, ctx);
      interrupts.check();
      if (!s || !(s->pdf[0] > 0)) continue;
      if (s->wo.z * wi.z >= 0 ? part.reflected : part.transmitted)
        mean += double(s->value[0]) / double(s->pdf[0]);
    }
    mean /= per_copy;
    sum += mean, squares += mean * mean;
  }
  const double mean = sum / kCopies, variance = std::max(squares / kCopies - mean * mean, 0.0);
  return {mean, std::sqrt(variance / (kCopies - 1))};
}

nb::object albedo(const Bsdf& bsdf, nb::handle theta, nb::handle wavelength, nb::handle phi, nb::handle uv,
                  const std::string& mode, const std::string& part_name, std::int64_t samples,
                  std::int64_t seed, bool return_error) {
  const TransportMode transport = mode_of(mode);
  const std::uint32_t key = key_of(seed);
  const Part part(part_name);
  if (samples < kCopies || samples > 100'000'000)
    throw Error("samples: expected 8 to 100000000, got " + std::to_string(samples));
  if (const auto* p = dynamic_cast<const PythonBsdf*>(&bsdf))
    return p->instance().attr("albedo_array")(theta, wavelength, phi, uv, mode, part_name, samples, seed,
                                              return_error);
  require_standalone(bsdf);
  const Argument polar("theta", theta), azimuth("phi", phi, {0, 0, 0}, 0),
      place("uv", optional(uv), {0.5, 0.5, 0}, 2), nm("wavelength", wavelength);
  const Broadcast<4> broadcast({&polar, &azimuth, &place, &nm}, 3);
  const WavelengthRange range = range_of(bsdf);
  const Result<double> mean(broadcast.shape()), error(broadcast.shape());
  {
    const Unlocked release;
    Interrupts interrupts;
    SurfacePoint point = flat_point();
    broadcast.for_rows([&](const auto& row) {
      for (Py_ssize_t i = 0, out = row.out; i < row.count; ++i, out += row.out_step) {
        const auto at = [&](std::size_t k) { return row.at[k] + i * row.step[k]; };
        const double t = polar.number(at(0)), p = azimuth.number(at(1));
        if (!(t >= 0 && t <= M_PI + 1e-6))
          throw Error("theta: expected angles from 0 to pi rad, got " + number_text(t) +
                      broadcast.where(0, out));
        if (!(std::abs(p) <= 1e6))
          throw Error("phi: expected finite angles in rad, got " + number_text(p) + broadcast.where(1, out));
        point.uv = place.vec2(at(2));
        if (!is_sane(point.uv)) throw_uv(place, at(2), broadcast.where(2, out));
        const Spectrum hero = float(nm.number(at(3)));
        if (!range.holds(hero)) throw_wavelength(nm, nm.number(at(3)), range, broadcast.where(3, out));
        const Wavelengths wavelengths = Wavelengths::at(range.grid, hero);
        const Vec3 wi{float(std::sin(t) * std::cos(p)), float(std::sin(t) * std::sin(p)), float(std::cos(t))};
        const Estimate e =
            estimate_albedo(bsdf, wi, {wavelengths, point, transport, key}, part, int(samples), interrupts);
        mean.data()[out] = e.mean, error.data()[out] = e.error;
      }
    });
  }
  if (return_error) return nb::make_tuple(mean.object(), error.object());
  return mean.object();
}

nb::tuple lobe_names(const Bsdf& bsdf) {
  nb::list names;
  const std::pair<Lobe, const char*> all[] = {{Lobe::diffuse, "diffuse"},   {Lobe::glossy, "glossy"},
                                              {Lobe::delta, "delta"},       {Lobe::reflect, "reflect"},
                                              {Lobe::transmit, "transmit"}, {Lobe::through, "through"},
                                              {Lobe::null, "null"}};
  for (const auto& [flag, name] : all)
    if (has(bsdf.lobes(), flag)) names.append(name);
  return nb::tuple(names);
}

#define ARRAY "numpy.typing.ArrayLike"
#define RESULT "numpy.typing.NDArray[numpy.float64]"

constexpr const char* kBsdfEvalDoc =
    R"(Value of the BSDF times the cosine, f |cos theta_o|, without delta lobes.

Directions are unit vectors in the frame of the surface, z its normal, and point away from it: a flat surface is meant, with x along
dp/du. In radiance mode light travels from wo to wi. All arguments broadcast as numpy's do, directions without their last axis.
Elements one after another that share wi, wo and uv go through one evaluation of up to 8 wavelengths: put wavelengths into an axis
of their own (wi of shape (n, 1, 3), wavelength of shape (m,)) where many are wanted.

Parameters
----------
wi, wo : array_like, shape (..., 3)
    Given and sampled direction. float32 and float64 arrays of any strides are read where they lie. A length may differ from 1 by
    0.001; such vectors are normalised.
wavelength : array_like, shape (...)
    In vacuum [nm], within the range that the object was made for (360 to 830 if nothing else was said).
uv : array_like, shape (..., 2), optional
    Texture coordinates, (0.5, 0.5) by default.
mode : str
    "radiance" or "importance" (light travels from wi to wo); they differ for light that is refracted.
seed : int
    Random key of a stochastic BSDF; others do not look at it.

Returns
-------
ndarray of float64, shape (...)
    [1/sr]. The renderer computes in single precision; these are its numbers, whatever else is evaluated beside them.

Examples
--------
>>> import numpy as np
>>> bsdf = aureole.load_dict({"type": "diffuse", "reflectance": 0.5})
>>> round(bsdf.eval((0, 0, 1), (0, 0.6, 0.8), 550) * np.pi, 6)
0.4
)";

constexpr const char* kBsdfPdfDoc =
    R"(Density of `sample` for the direction wo [1/sr] if `wavelength` is the one that is sampled for, without delta lobes.

Arguments and broadcasting are those of `eval`.
)";

constexpr const char* kBsdfSampleDoc =
    R"(Draws directions, one per element, each for its own wavelength.

Parameters
----------
wi : array_like, shape (..., 3)
    Given directions, as for `eval`.
wavelength : array_like, shape (...)
    [nm].
u : array_like, shape (..., 3)
    Random numbers in [0, 1): the first chooses a lobe, the others the direction within it.
uv, mode, seed
    As for `eval`.

Returns
-------
aureole.BsdfSample
    Arrays `wo` (..., 3), `value`, `pdf`, `valid`, `lobe`, `eta` and `is_delta` (...).
)";

constexpr const char* kAlbedoDoc =
    R"(Directional albedo: the fraction of the light that arrives from a direction and is scattered, delta lobes included.

The mean of value/pdf over directions that the BSDF draws for points which fill the cube of random numbers evenly: exact where value/pdf
is constant, as for a Lambertian surface, else with an error that falls about as 1/samples for smooth BSDFs. Each element depends on its own
arguments and the seed only.

Parameters
----------
theta : array_like, shape (...)
    Angle of incidence to the normal [rad], 0 to pi; above pi/2 light arrives from below.
wavelength : array_like, shape (...)
    [nm].
phi : array_like, shape (...)
    Azimuth of incidence [rad].
uv : array_like, shape (..., 2), optional
    As for `eval`.
mode : str
    "importance": of the light that arrives from theta. "radiance": what the surface shows to a viewer at theta under light of
    radiance 1 from everywhere; differs for light that is refracted.
part : str
    "all", or only what leaves to the side of incidence ("reflect") or to the other one ("transmit").
samples : int
    Directions per element, at least 8; rounded up to a multiple of 8.
seed : int
    Of the random shifts of the points.
return_error : bool
    Return a standard error, too, from 8 sets of points that are shifted independently.

Returns
-------
ndarray of float64, shape (...)
    Or with `return_error` a tuple of two of them, the albedo and its standard error.
)";

}  // namespace

void bind_bsdfs(nb::module_& m) {
  // Two overloads, for type checkers: the flag decides the type of the result.
  const auto bind_albedo = [](nb::class_<Bsdf, Object>& c, const auto&... extra) {
    c.def("albedo", &albedo, nb::arg("theta").none(), nb::arg("wavelength").none(), nb::kw_only(),
          nb::arg("phi").none() = 0.0, nb::arg("uv").none() = nb::none(), nb::arg("mode") = "importance",
          nb::arg("part") = "all", nb::arg("samples") = 1024, nb::arg("seed") = 0,
          nb::arg("return_error") = false, extra...);
  };
  nb::class_<Bsdf, Object> bsdf(m, "Bsdf", "How a surface scatters light.");
  bsdf.def_prop_ro(
          "lobes", &lobe_names, nb::sig("def lobes(self) -> tuple[str, ...]"),
          "Names of all that its lobes do: diffuse, glossy, delta, reflect, transmit, through, null.")
      .def("eval", &evaluate_bsdf<false>, nb::arg("wi").none(), nb::arg("wo").none(),
           nb::arg("wavelength").none(), nb::kw_only(), nb::arg("uv").none() = nb::none(),
           nb::arg("mode") = "radiance", nb::arg("seed") = 0,
           nb::sig("def eval(self, wi: " ARRAY ", wo: " ARRAY ", wavelength: " ARRAY ", *, uv: " ARRAY
                   " | None = None, mode: str = 'radiance', seed: int = 0) -> " RESULT),
           kBsdfEvalDoc)
      .def("pdf", &evaluate_bsdf<true>, nb::arg("wi").none(), nb::arg("wo").none(),
           nb::arg("wavelength").none(), nb::kw_only(), nb::arg("uv").none() = nb::none(),
           nb::arg("mode") = "radiance", nb::arg("seed") = 0,
           nb::sig("def pdf(self, wi: " ARRAY ", wo: " ARRAY ", wavelength: " ARRAY ", *, uv: " ARRAY
                   " | None = None, mode: str = 'radiance', seed: int = 0) -> " RESULT),
           kBsdfPdfDoc)
      .def("sample", &sample_bsdf, nb::arg("wi").none(), nb::arg("wavelength").none(), nb::arg("u").none(),
           nb::kw_only(), nb::arg("uv").none() = nb::none(), nb::arg("mode") = "radiance",
           nb::arg("seed") = 0,
           nb::sig("def sample(self, wi: " ARRAY ", wavelength: " ARRAY ", u: " ARRAY ", *, uv: " ARRAY
                   " | None = None, mode: str = 'radiance', seed: int = 0) -> aureole._objects.BsdfSample"),
           kBsdfSampleDoc);
  bind_albedo(
      bsdf,
      nb::sig("def albedo(self, theta: " ARRAY ", wavelength: " ARRAY ", *, phi: " ARRAY " = 0.0, uv: " ARRAY
              " | None = None, mode: str = 'importance', part: str = 'all', samples: int = 1024, "
              "seed: int = 0, return_error: typing.Literal[False] = False) -> " RESULT),
      kAlbedoDoc);
  bind_albedo(
      bsdf,
      nb::sig("def albedo(self, theta: " ARRAY ", wavelength: " ARRAY ", *, phi: " ARRAY " = 0.0, uv: " ARRAY
              " | None = None, mode: str = 'importance', part: str = 'all', samples: int = "
              "1024, seed: int = 0, return_error: typing.Literal[True]) -> tuple[" RESULT ", " RESULT "]"));
}

}  // namespace aureole::python

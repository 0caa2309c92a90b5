// SPDX-License-Identifier: Apache-2.0
// BSDFs over arrays.
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>

#include <cstdint>

#include "bindings.h"
#include "object_arrays.h"

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

/// The value of each element, or with `Pdf` the density.
template <bool Pdf>
nb::object evaluate(const Bsdf& bsdf, nb::handle wi, nb::handle wo, nb::handle wavelength, nb::handle uv,
                    const std::string& mode, std::int64_t seed) {
  const PlaceArguments in("wi", wi, "wo", wo, uv, wavelength);
  const TransportMode transport = mode_of(mode);
  const std::uint32_t key = key_of(seed);
  Result<double> result(in.broadcast.shape());
  SurfacePoint point = flat_point();
  for_places(in, WavelengthRange(bsdf.properties().context().grid), result.data(),
             [&](const Vec3& i, const Vec3& o, Vec2 at, const Wavelengths& w) {
               point.uv = at;
               const BsdfContext ctx{w, point, transport, key};
               return Pdf ? bsdf.eval_pdf(i, o, ctx).pdf : bsdf.eval(i, o, ctx);
             });
  return result.object();
}

}  // namespace

void bind_bsdfs(nb::module_& m) {
  nb::class_<Bsdf, Object>(m, "Bsdf")
      .def("eval", &evaluate<false>, nb::arg("wi"), nb::arg("wo"), nb::arg("wavelength"), nb::kw_only(),
           nb::arg("uv") = nb::none(), nb::arg("mode") = "radiance", nb::arg("seed") = 0)
      .def("pdf", &evaluate<true>, nb::arg("wi"), nb::arg("wo"), nb::arg("wavelength"), nb::kw_only(),
           nb::arg("uv") = nb::none(), nb::arg("mode") = "radiance", nb::arg("seed") = 0);
}

}  // namespace aureole::python

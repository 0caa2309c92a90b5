// SPDX-License-Identifier: Apache-2.0
// Shapes of openings: `ApertureShape`, which scenes' apertures have too, and makers of it.
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>

#include <cmath>
#include <cstdio>
#include <memory>
#include <vector>

#include "arrays.h"
#include "aureole/optics/aperture/aperture_shape.h"
#include "aureole/optics/aperture/mask_aperture.h"
#include "aureole/optics/aperture/polygon_aperture.h"
#include "aureole/optics/aperture/round_aperture.h"
#include "optics_bindings.h"
#include "vectorised.h"

namespace aureole::python {
namespace {

using optics::ApertureShape;
using ShapePtr = std::shared_ptr<ApertureShape>;

/// F at q of shape (..., 2).
nb::object transform_shape(const ApertureShape& shape, const nb::object& q) {
  const nb::module_ numpy = nb::module_::import_("numpy");
  nb::object checked = nb::module_::import_("aureole._arrays").attr("real")("q", q);
  const nb::tuple size = nb::cast<nb::tuple>(checked.attr("shape"));
  if (size.size() == 0 || nb::cast<std::size_t>(size[size.size() - 1]) != 2)
    throw Error(std::string("q: expected an array of shape (..., 2), got shape ") + text_of(size));
  const auto flat = nb::cast<Reals>(numpy.attr("ascontiguousarray")(checked.attr("ravel")()));
  const std::size_t n = flat.size() / 2;
  nb::object result = numpy.attr("empty")(n, "complex128");
  const auto to = nb::cast<Array<Complex>>(result);
  // Phases of more radians than that would be rounding errors.
  constexpr double kMaxRadians = 1e9;
  for (std::size_t i = 0; i < 2 * n; ++i)
    if (!(std::abs(flat.data()[i]) * shape.bounding_radius() <= kMaxRadians))
      throw Error("q: expected rad/m below 1e9/bounding_radius, got " + std::to_string(flat.data()[i]));
  for_each(n, [&shape, from = flat.data(), to = to.data()](std::size_t i) {
    to[i] = shape.transform(from[2 * i], from[2 * i + 1]);
  });
  nb::list shaped;
  for (std::size_t i = 0; i + 1 < size.size(); ++i) shaped.append(size[i]);
  return result.attr("reshape")(shaped).attr("__getitem__")(nb::tuple());
}

/// `vertices`: x, y of all rings in sequence, `sizes`: how many vertices each has.
ShapePtr polygon(const Reals& vertices, const Array<const std::int64_t>& sizes, bool centroid) {
  std::vector<optics::Ring> rings;
  std::size_t at = 0;
  for (std::size_t r = 0; r < sizes.size(); ++r) {
    require_size(sizes.data()[r] >= 0 && std::size_t(sizes.data()[r]) <= vertices.size() / 2 - at, "polygon");
    optics::Ring ring;
    for (std::int64_t i = 0; i < sizes.data()[r]; ++i, ++at)
      ring.push_back({vertices.data()[2 * at], vertices.data()[2 * at + 1]});
    rings.push_back(std::move(ring));
  }
  const Unlocked release;
  return naming("vertices", [&]() -> ShapePtr {
    const optics::PolygonRegion region = optics::PolygonRegion::even_odd(std::move(rings));
    return std::make_shared<optics::PolygonAperture>(
        region.placed(centroid ? region.centroid() : optics::PlanePoint{}, 1));
  });
}

ShapePtr mask(const Array<const float, 2>& open, double pixel_size, bool centroid) {
  if (open.size() > std::size_t(1) << 25) throw Error("open: expected at most 2^25 pixels");
  optics::Mask m;
  m.width = int(open.shape(1)), m.height = int(open.shape(0));
  m.open.assign(open.data(), open.data() + open.size());
  const Unlocked release;
  return naming(
      "open", [&]() -> ShapePtr { return std::make_shared<optics::MaskAperture>(m, pixel_size, centroid); });
}

}  // namespace

void bind_apertures(nb::module_& m) {
  using nb::arg;
  nb::class_<ApertureShape>(m, "ApertureShape", R"(One opening (or one opaque disc, by Babinet's principle).

Made by the functions of `aureole.optics`: `circle`, `ellipse`, `annulus`, `ngon`, `rectangle`, `star`,
`polygon`, `mask`. Lengths in metres.)")
      .def_prop_ro("area", &ApertureShape::area, "Integral of the transmittance over the plane, in m^2.")
      .def_prop_ro("squared_area", &ApertureShape::squared_area,
                   "Integral of the squared transmittance in m^2: `area` but for grey masks.")
      .def_prop_ro(
          "radius", [](const ApertureShape& s) { return std::sqrt(s.area() / M_PI); },
          "Radius in m of the disc of the same area.")
      .def_prop_ro("bounding_radius", &ApertureShape::bounding_radius,
                   "Radius in m of the smallest circle about the origin that holds the shape.")
      .def_prop_ro("is_circular", &ApertureShape::is_circular, "The transform depends on |q| alone.")
      .def("transform", &transform_shape, arg("q"),
           nb::sig("def transform(self, q: numpy.typing.ArrayLike) -> "
                   "numpy.typing.NDArray[numpy.complex128]"),
           R"(The Fourier transform F(q) = integral of A(x) exp(-i q.x) dx dy: the far field of the opening.

Parameters
----------
q : array_like, shape (..., 2)
    Wave vectors along x and y in rad/m: 2 pi/wavelength times the difference of the sines
    of the directions before and after.

Returns
-------
numpy.ndarray of complex128, shape (...)
    In m^2; F(0) is `area`.

References
----------
Goodman, Introduction to Fourier Optics, 4th ed. 2017, chapter 4.)")
      .def("__repr__", [](const ApertureShape& s) {
        char text[96];
        std::snprintf(text, sizeof text, "<ApertureShape of %.6g m^2, within a radius of %.6g m>", s.area(),
                      s.bounding_radius());
        return std::string(text);
      });
  m.def(
      "ellipse_aperture",
      [](double radius_x, double radius_y) -> ShapePtr {
        return naming("radius_x",
                      [&] { return std::make_shared<optics::EllipseAperture>(radius_x, radius_y); });
      },
      arg("radius_x"), arg("radius_y"));
  m.def(
      "annulus_aperture",
      [](double radius, double inner_radius) -> ShapePtr {
        return naming("inner_radius",
                      [&] { return std::make_shared<optics::AnnulusAperture>(radius, inner_radius); });
      },
      arg("radius"), arg("inner_radius"));
  m.def("polygon_aperture", &polygon, arg("vertices"), arg("sizes"), arg("centroid"));
  m.def("mask_aperture", &mask, arg("open"), arg("pixel_size"), arg("centroid"));
}

}  // namespace aureole::python

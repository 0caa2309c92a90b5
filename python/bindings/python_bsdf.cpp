// SPDX-License-Identifier: Apache-2.0
// A BSDF that is a class written in Python: every evaluation is a call with arrays of 8 rows, one per
// wavelength. Threads of the renderer take Python's lock for it; an exception of the class travels through
// the renderer as it is.
#include "python_bsdf.h"

#include <nanobind/stl/shared_ptr.h>

#include <memory>

#include "arrays.h"
#include "bindings.h"

namespace aureole::python {

namespace {

/// An array of numpy's with 8 rows of the same vector.
nb::object rows(const Vec3& v) {
  const Result<double> array({kWavelengths}, 3);
  for (int i = 0; i < kWavelengths; ++i)
    for (int k = 0; k < 3; ++k) array.data()[3 * i + k] = double(v[k]);
  return array.object();
}

nb::object rows(Vec2 v) {
  const Result<double> array({kWavelengths}, 2);
  for (int i = 0; i < kWavelengths; ++i)
    array.data()[2 * i] = double(v.x), array.data()[2 * i + 1] = double(v.y);
  return array.object();
}

nb::object numbers(const Spectrum& s) {
  const Result<double> array({kWavelengths});
  for (int i = 0; i < kWavelengths; ++i) array.data()[i] = double(s[i]);
  return array.object();
}

/// Values that the adapter has checked: an array of `count` numbers.
Spectrum spectrum(const char* name, nb::handle array) {
  const Argument values(name, array);
  if (values.shape() != Extents{kWavelengths}) throw Error(std::string(name) + ": wrong shape");
  return make_spectrum([&](int i) { return float(values.number(values.data() + i * values.strides()[0])); });
}

const char* name_of(TransportMode mode) {
  return mode == TransportMode::radiance ? "radiance" : "importance";
}

}  // namespace

PythonBsdf::PythonBsdf(const Properties& properties, nb::object adapter)
    : Bsdf(properties),
      adapter_(std::move(adapter)),
      lobes_(Lobe(nb::cast<unsigned>(adapter_.attr("lobes")))),
      needs_tangent_(nb::cast<bool>(adapter_.attr("needs_tangent"))) {}

PythonBsdf::~PythonBsdf() {
  if (!nb::is_alive()) {
    adapter_.release();  // the interpreter is gone, and its objects with it
    return;
  }
  const nb::gil_scoped_acquire lock;
  adapter_.reset();
}

BsdfEval PythonBsdf::eval_pdf(const Vec3& wi, const Vec3& wo, const BsdfContext& ctx) const {
  const Callback lock;
  const nb::object both = adapter_.attr("eval_pdf_rows")(rows(wi), rows(wo), numbers(ctx.wavelengths.nm),
                                                         rows(ctx.point.uv), name_of(ctx.mode));
  return {spectrum("eval", both[0]), spectrum("pdf", both[1])};
}

Spectrum PythonBsdf::eval(const Vec3& wi, const Vec3& wo, const BsdfContext& ctx) const {
  const Callback lock;
  return spectrum("eval", adapter_.attr("eval_rows")(rows(wi), rows(wo), numbers(ctx.wavelengths.nm),
                                                     rows(ctx.point.uv), name_of(ctx.mode)));
}

std::optional<BsdfSample> PythonBsdf::sample(const Vec3& wi, float u1, Vec2 u2,
                                             const BsdfContext& ctx) const {
  const Callback lock;
  const nb::object drawn =
      adapter_.attr("sample_hero")(rows(wi), numbers(ctx.wavelengths.nm), rows(Vec3{u1, u2.x, u2.y}),
                                   rows(ctx.point.uv), name_of(ctx.mode));
  if (drawn.is_none()) return {};
  BsdfSample s;
  for (int k = 0; k < 3; ++k) s.wo[k] = float(nb::cast<double>(drawn[0][k]));
  s.wo = normalize(s.wo);
  s.value = spectrum("sample", drawn[1]);
  s.pdf = spectrum("sample", drawn[2]);
  s.lobe = Lobe(nb::cast<unsigned>(drawn[3]));
  // A class says what it does on both sides; a sample is on one.
  if (has(s.lobe, Lobe::reflect) && has(s.lobe, Lobe::transmit))
    s.lobe = Lobe(unsigned(s.lobe) & ~unsigned(s.wo.z * wi.z > 0 ? Lobe::transmit : Lobe::reflect));
  s.eta = float(nb::cast<double>(drawn[4]));
  if (!(s.pdf[0] > 0)) return {};  // below the smallest float
  return s;
}

void bind_python_bsdf(nb::module_& m) {
  m.def(
      "python_bsdf",
      [](const nb::object& instance) {
        const nb::object adapter = nb::module_::import_("aureole._python_bsdf").attr("Adapter")(instance);
        return std::shared_ptr<Bsdf>(
            std::make_shared<PythonBsdf>(Properties("python", "", {}, nullptr), adapter));
      },
      nb::arg("instance"),
      R"(The BSDF that an object with the methods of `aureole.PythonBsdf` is.

It holds the object alive, so that the object should not hold it in turn.
)");
}

}  // namespace aureole::python

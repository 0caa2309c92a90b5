// SPDX-License-Identifier: Apache-2.0
// The renderer's colorimetric tables, conversions of colours and refractive indices. aureole/spectrum.py
// checks the arguments and shapes the results.
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <vector>

#include "aureole/core/image.h"
#include "aureole/plugin/registry.h"
#include "aureole/spectrum/observer.h"
#include "aureole/spectrum/refractive_index.h"
#include "aureole/spectrum/tables.h"
#include "aureole/spectrum/upsampling.h"
#include "aureole/spectrum/upsampling_fit.h"
#include "bindings.h"
#include "vectorised.h"

namespace aureole::python {
namespace {

nb::object new_array(std::span<const double> values) {
  nb::object result = nb::module_::import_("numpy").attr("empty")(values.size());
  std::copy(values.begin(), values.end(), nb::cast<Array<double>>(result).data());
  return result;
}

TabulatedSpectrum illuminant(const std::string& name) {
  const auto found = find_illuminant(name);
  if (!found)
    throw Error("name: there is no illuminant \"" + name + "\"" + did_you_mean(name, illuminant_names()));
  return *found;
}

RefractiveIndex material(const std::string& name, bool dispersion) {
  const auto found = find_refractive_index(name, dispersion);
  if (!found)
    throw Error("name: there is no material \"" + name + "\"" + did_you_mean(name, refractive_index_names()));
  return *found;
}

/// Colours one by one; rows of three.
template <class F>
void map_colors(const Array<const double, 2>& from, const Array<double, 2>& to, const F& f) {
  const std::size_t n = from.shape(0);
  require_size(from.shape(1) == 3 && to.shape(0) == n && to.shape(1) == 3, "colours");
  for_each(n, [f, from = from.data(), to = to.data()](std::size_t i) { f(from + 3 * i, to + 3 * i); });
}

template <float (*kCurve)(float)>
void map_curve(const Reals& from, const Array<double>& to) {
  require_size(to.size() == from.size(), "curve");
  for_each(from.size(),
           [from = from.data(), to = to.data()](std::size_t i) { to[i] = kCurve(float(from[i])); });
}

/// As the renderer does: `table` for textures, else for colours in scene files. Colours in [0, 1] and spectra
/// up to one, or, `unbounded`, any and with a scale, which makes an emitter's spectrum times an illuminant.
void upsample(const Array<const double, 2>& rgb, const Reals& nm, bool table, bool unbounded,
              const Array<double, 2>& result) {
  const std::size_t n = rgb.shape(0), wavelengths = nm.size();
  require_size(rgb.shape(1) == 3 && result.shape(0) == n && result.shape(1) == wavelengths, "upsample");
  for_each(n, [=, rgb = rgb.data(), nm = nm.data(), result = result.data()](std::size_t i) {
    const double* c = rgb + 3 * i;
    double* to = result + i * wavelengths;
    if (table) {
      const auto sample = unbounded ? &upsample_unbounded : &upsample_srgb;
      const SigmoidSpectrum s = sample(float(c[0]), float(c[1]), float(c[2]));
      for (std::size_t k = 0; k < wavelengths; ++k) to[k] = s.at(float(nm[k]));
      return;
    }
    const double largest = std::max({c[0], c[1], c[2]});
    if (largest <= 0 || (c[0] == c[1] && c[1] == c[2])) {
      std::fill(to, to + wavelengths, std::max(largest, 0.0));
      return;
    }
    const Rgb color{c[0], c[1], c[2]};
    const SigmoidSpectrum s = unbounded ? fit_unbounded(color) : fit_srgb(color);
    for (std::size_t k = 0; k < wavelengths; ++k) to[k] = double(s.at(float(nm[k])));
  });
}

}  // namespace

void bind_spectrum(nb::module_& m) {
  using nb::arg;
  m.def(
      "observer_table",
      [] {
        const Observer& o = cie_1931_observer();
        std::vector<double> nm(o.y.size());
        for (std::size_t i = 0; i < nm.size(); ++i) nm[i] = o.start_nm + o.step_nm * double(i);
        return nb::make_tuple(new_array(nm), new_array(o.x), new_array(o.y), new_array(o.z));
      },
      nb::sig("def observer_table() -> tuple[numpy.typing.NDArray[numpy.float64], ...]"));
  m.def("cie_y_integral", &cie_y_integral);
  m.def("illuminant_names", &illuminant_names);
  m.def(
      "illuminant_table",
      [](const std::string& name) {
        const TabulatedSpectrum s = illuminant(name);
        return nb::make_tuple(new_array(s.wavelengths_nm), new_array(s.values),
                              cie_y_integral() / cie_tristimulus(s)[1]);
      },
      arg("name"),
      nb::sig("def illuminant_table(name: str) -> tuple[numpy.typing.NDArray[numpy.float64], "
              "numpy.typing.NDArray[numpy.float64], float]"),
      "Wavelengths, values, and the factor to the luminance of a flat spectrum of one.");

  m.def("material_names", &refractive_index_names);
  m.def(
      "material",
      [](const std::string& name, bool dispersion) {
        const RefractiveIndex index = material(name, dispersion);
        // Some tables absorb in a part of their range.
        bool absorbs = false;
        constexpr int kSamples = 4096;
        const double low = index.min_nm(), high = index.max_nm();
        for (int i = 0; index.is_dispersive() && i <= kSamples; ++i)
          absorbs = absorbs || index.at(low + (high - low) * i / kSamples).imag() > 0;
        return nb::make_tuple(low, high, index.is_dispersive(), absorbs, std::string(index.source()));
      },
      arg("name"), arg("dispersion"),
      nb::sig("def material(name: str, dispersion: bool) -> tuple[float, float, bool, bool, str]"),
      "Range in nm, whether it is dispersive, whether it absorbs, source.");
  m.def(
      "refractive_index",
      [](const std::string& name, bool dispersion, const Reals& nm, const Array<Complex>& result) {
        const RefractiveIndex index = material(name, dispersion);
        require_size(result.size() == nm.size(), "refractive_index");
        for_each(nm.size(),
                 [&index, nm = nm.data(), to = result.data()](std::size_t i) { to[i] = index.at(nm[i]); });
      },
      arg("name"), arg("dispersion"), arg("nm"), arg("result").noconvert());

  m.def(
      "xyz_to_srgb",
      [](const Array<const double, 2>& xyz, const Array<double, 2>& result) {
        map_colors(xyz, result, [](const double* from, double* to) {
          float rgb[3];
          xyz_to_srgb(from, rgb);
          std::copy(rgb, rgb + 3, to);
        });
      },
      arg("xyz"), arg("result").noconvert());
  m.def("srgb_encode", &map_curve<srgb_encode>, arg("linear"), arg("result").noconvert());
  m.def("srgb_decode", &map_curve<srgb_decode>, arg("encoded"), arg("result").noconvert());
  m.def("upsample", &upsample, arg("rgb"), arg("nm"), arg("table"), arg("unbounded"),
        arg("result").noconvert());
}

}  // namespace aureole::python

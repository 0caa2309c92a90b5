// SPDX-License-Identifier: Apache-2.0
// What the bindings of plug-in objects over arrays share.
#pragma once

#include <nanobind/nanobind.h>

#include <cstddef>
#include <string>

#include "arrays.h"
#include "aureole/bsdf/bsdf.h"
#include "aureole/plugin/object.h"
#include "aureole/plugin/properties.h"
#include "aureole/shape/surface_point.h"
#include "aureole/spectrum/wavelengths.h"

namespace aureole::python {

// Parts of bind_objects.
void bind_bsdfs(nb::module_& m);
void bind_emitters(nb::module_& m);
void bind_textures(nb::module_& m);  ///< and apertures

/// The place where objects that stand alone are asked: a point of a flat square with the frame x, y, z.
SurfacePoint flat_point(Vec2 uv = {0.5f, 0.5f});

/// Throws Error for what has values on a shape only.
void require_standalone(const Object& object);

/// A direction as the renderer wants it. False where it is not a unit vector within 1e-3; what differs by
/// more than rounding is normalised.
inline bool make_unit(Vec3& w) {
  const float square = length_squared(w), off = std::abs(square - 1);
  if (!(off <= 2e-3f)) return false;
  if (off > 2e-6f) w = w * (1 / std::sqrt(square));
  return true;
}

/// Texture coordinates that a texture may be asked for.
inline bool is_sane(Vec2 uv) { return std::abs(uv.x) <= 1e6f && std::abs(uv.y) <= 1e6f; }

/// The wavelengths that an object knows.
struct WavelengthRange {
  SpectralGrid grid;
  float min_nm, max_nm;
  explicit WavelengthRange(const SpectralGrid& g)
      : grid(g), min_nm(float(g.min_nm)), max_nm(float(g.max_nm)) {}
  bool holds(const Spectrum& nm) const { return !any(~((nm.v >= min_nm) & (nm.v <= max_nm))); }
};

/// Up to 8 wavelengths from `at` on; the last one is repeated.
inline Spectrum load_wavelengths(const Argument& argument, const char* at, Py_ssize_t step, int count) {
  if (count == kWavelengths && argument.is_double() && step == Py_ssize_t(sizeof(double))) {
    double nm[kWavelengths];
    std::memcpy(nm, at, sizeof nm);
    return make_spectrum([&](int i) { return float(nm[i]); });
  }
  Spectrum nm;
  for (int i = 0; i < count; ++i) nm[i] = float(argument.number(at + i * step));
  for (int i = count; i < kWavelengths; ++i) nm[i] = nm[count - 1];
  return nm;
}

[[noreturn]] void throw_direction(const Argument& a, const char* at, const std::string& where);
[[noreturn]] void throw_uv(const Argument& a, const char* at, const std::string& where);
[[noreturn]] void throw_wavelength(const Argument& a, double nm, const WavelengthRange& range,
                                   const std::string& where);

/// Rounding to single precision must not leave [0, 1).
inline float below_one(float u) { return std::min(u, 0x1.fffffep-1f); }

/// Components of argument `a` of a broadcast, which must lie in [0, 1).
template <std::size_t N>
Vec3 read_random(const Argument& argument, const char* at, const Broadcast<N>& broadcast, std::size_t a,
                 Py_ssize_t out) {
  Vec3 u;
  for (int k = 0; k < argument.components(); ++k) {
    const double x = argument.number(at, k);
    if (!(x >= 0 && x < 1))
      throw Error(std::string(argument.name()) + ": expected numbers in [0, 1), got " + number_text(x) +
                  broadcast.where(a, out));
    u[k] = below_one(float(x));
  }
  return u;
}

/// The arguments of a function of two directions, a place on the surface and a wavelength. Those that are
/// None, or that a function does not have, are constants.
struct PlaceArguments {
  Argument a, b, uv, wavelength;
  Broadcast<4> broadcast;

  PlaceArguments(const char* a_name, nb::handle a_value, const char* b_name, nb::handle b_value,
                 nb::handle uv_value, nb::handle wavelength_value);
};

/// Calls `f(a, b, uv, wavelengths) -> Spectrum` and writes its values to `out`. Elements one after another
/// that share their directions and place go to one call.
template <class F>
void for_places(const PlaceArguments& in, const WavelengthRange& range, double* out, F&& f) {
  const nb::gil_scoped_release release;
  Interrupts interrupts;
  Vec3 a, b;
  Vec2 uv;
  Wavelengths wavelengths = Wavelengths::at(range.grid, range.min_nm);
  const char *last_a = nullptr, *last_b = nullptr, *last_uv = nullptr;
  in.broadcast.for_rows([&](const auto& row) {
    const bool constant = row.step[0] == 0 && row.step[1] == 0 && row.step[2] == 0;
    for (Py_ssize_t i = 0; i < row.count;) {
      const char *const at_a = row.at[0] + i * row.step[0], *const at_b = row.at[1] + i * row.step[1],
                        *const at_uv = row.at[2] + i * row.step[2],
                        *const at_nm = row.at[3] + i * row.step[3];
      double* const to = out + row.out + i * row.out_step;
      const auto where = [&](std::size_t argument, Py_ssize_t k) {
        return in.broadcast.where(argument, (to - out) + k * row.out_step);
      };
      if (at_a != last_a) {
        a = in.a.vec3(last_a = at_a);
        if (!make_unit(a)) throw_direction(in.a, at_a, where(0, 0));
      }
      if (at_b != last_b) {
        b = in.b.vec3(last_b = at_b);
        if (!make_unit(b)) throw_direction(in.b, at_b, where(1, 0));
      }
      if (at_uv != last_uv) {
        uv = in.uv.vec2(last_uv = at_uv);
        if (!is_sane(uv)) throw_uv(in.uv, at_uv, where(2, 0));
      }
      const int most = int(std::min<Py_ssize_t>(kWavelengths, row.count - i));
      int count = constant ? most : 1;
      if (!constant)
        while (count < most && in.b.equal(at_b, at_b + count * row.step[1]) &&
               in.a.equal(at_a, at_a + count * row.step[0]) &&
               in.uv.equal(at_uv, at_uv + count * row.step[2]))
          ++count;
      const Spectrum nm = load_wavelengths(in.wavelength, at_nm, row.step[3], count);
      if (any(nm.v != wavelengths.nm.v)) {
        if (!range.holds(nm))
          for (int k = 0; k < count; ++k)
            if (!range.holds(nm[k]))
              throw_wavelength(in.wavelength, in.wavelength.number(at_nm + k * row.step[3]), range,
                               where(3, k));
        wavelengths = Wavelengths::at(range.grid, nm);
      }
      const Spectrum value = f(a, b, uv, wavelengths);
      if (count == kWavelengths && row.out_step == 1)
        for (int k = 0; k < kWavelengths; ++k) to[k] = double(value[k]);
      else
        for (int k = 0; k < count; ++k) to[k * row.out_step] = double(value[k]);
      i += count;
      interrupts.check();
    }
  });
}

}  // namespace aureole::python

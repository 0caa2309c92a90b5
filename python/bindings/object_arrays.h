// SPDX-License-Identifier: Apache-2.0
// Shared by the bindings that evaluate plug-in objects over arrays.
#pragma once

#include <nanobind/nanobind.h>

#include <array>
#include <atomic>
#include <cstddef>
#include <new>
#include <string>
#include <type_traits>

#include "arrays.h"
#include "aureole/bsdf/bsdf.h"
#include "aureole/core/parallel.h"
#include "aureole/plugin/object.h"
#include "aureole/plugin/properties.h"
#include "aureole/shape/surface_point.h"
#include "aureole/spectrum/wavelengths.h"

namespace aureole::python {

// Parts of bind_objects.
void bind_bsdfs(nb::module_& m);
void bind_bssrdfs(nb::module_& m);
void bind_emitters(nb::module_& m);
void bind_media(nb::module_& m);
void bind_phases(nb::module_& m);
void bind_textures(nb::module_& m);  ///< and apertures

/// The surface point for evaluating single objects: on a flat square with the frame x, y, z.
SurfacePoint flat_point(Vec2 uv = {0.5f, 0.5f});

/// Throws Error for objects that have values on a shape only.
void require_standalone(const Object& object);

/// A direction as the renderer wants it. False where it is not a unit vector within 1e-3; what differs by
/// more than rounding is normalised.
inline bool make_unit(Vec3& w) {
  const float square = length_squared(w), off = std::abs(square - 1);
  if (!(off <= 2e-3f)) return false;
  if (off > 2e-6f) w = w * (1 / std::sqrt(square));
  return true;
}

/// The argument `p`, a place; throws Error where a number is not finite.
inline Vec3 point_of(const std::array<double, 3>& p) {
  const Vec3 point{float(p[0]), float(p[1]), float(p[2])};
  if (!is_finite(point))
    throw Error("p: expected three finite numbers, got (" + number_text(p[0]) + ", " + number_text(p[1]) +
                ", " + number_text(p[2]) + ")");
  return point;
}

/// Texture coordinates that a texture may be asked for.
inline bool is_sane(Vec2 uv) { return std::abs(uv.x) <= 1e6f && std::abs(uv.y) <= 1e6f; }

/// The range of wavelengths that an object has data for.
struct WavelengthRange {
  SpectralGrid grid;
  float min_nm, max_nm;
  explicit WavelengthRange(const SpectralGrid& g)
      : grid(g), min_nm(float(g.min_nm)), max_nm(float(g.max_nm)) {}
  bool holds(const Spectrum& nm) const { return !any(~((nm.v >= min_nm) & (nm.v <= max_nm))); }
};

/// Up to 8 wavelengths from `at` on; the last one is repeated. Vectors are not written number by number: to
/// load them then would wait for the stores.
template <class T>
inline Spectrum load_wavelengths(const Argument& argument, const char* at, Py_ssize_t step, int count) {
  if (count == 1) return float(argument.number<T>(at));
  if constexpr (!std::is_void_v<T>) {
    if (count == kWavelengths && step == Py_ssize_t(sizeof(T))) {
      T __attribute__((vector_size(sizeof(T) * kWavelengths))) nm;
      std::memcpy(&nm, at, sizeof nm);
      return Spectrum(__builtin_convertvector(nm, SpectrumVector));
    }
  }
  Spectrum nm;
  for (int i = 0; i < kWavelengths; ++i)
    nm[i] = float(argument.number<T>(at + std::min(i, count - 1) * step));
  return nm;
}

inline void store(const Spectrum& value, double* to, Py_ssize_t step, int count) {
  if (count == kWavelengths && step == 1) {
    const double __attribute__((vector_size(sizeof(double) * kWavelengths))) numbers =
        __builtin_convertvector(value.v, double __attribute__((vector_size(sizeof(double) * kWavelengths))));
    std::memcpy(to, &numbers, sizeof numbers);
    return;
  }
  for (int k = 0; k < count; ++k) to[k * step] = double(value[k]);
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

/// One of 8 wavelengths, 8 times.
inline Wavelengths only(const Wavelengths& w, int k) {
  return {w.nm.data()[k], w.pdf, SpectrumMask{} + reinterpret_cast<const int*>(&w.cell)[k],
          w.fraction.data()[k]};
}

/// `for_places` for a part of the elements and arguments of type T; void: of several types.
template <class T, class F>
void for_typed_places(const PlaceArguments& in, const Broadcast<4>& part, const WavelengthRange& range,
                      double* out, F f, Interrupts& interrupts) {
  Vec3 a, b;
  Vec2 uv;
  Wavelengths wavelengths = Wavelengths::at(range.grid, range.min_nm);
  const char *last_a = nullptr, *last_b = nullptr, *last_uv = nullptr;
  part.for_rows([&](const auto& row) {
    const char *at_a = row.at[0], *at_b = row.at[1], *at_uv = row.at[2], *at_nm = row.at[3];
    const Py_ssize_t step_a = row.step[0], step_b = row.step[1], step_uv = row.step[2], step_nm = row.step[3],
                     out_step = row.out_step;
    const bool constant = step_a == 0 && step_b == 0 && step_uv == 0;
    double* to = out + row.out;
    const auto where = [&](std::size_t argument, Py_ssize_t k) {
      return in.broadcast.where(argument, (to - out) + k * out_step);
    };
    const auto load_place = [&](Py_ssize_t k) {
      if (at_a != last_a) {
        a = in.a.vec3<T>(last_a = at_a);
        if (!make_unit(a)) throw_direction(in.a, at_a, where(0, k));
      }
      if (at_b != last_b) {
        b = in.b.vec3<T>(last_b = at_b);
        if (!make_unit(b)) throw_direction(in.b, at_b, where(1, k));
      }
      if (at_uv != last_uv) {
        uv = in.uv.vec2(last_uv = at_uv);
        if (!is_sane(uv)) throw_uv(in.uv, at_uv, where(2, k));
      }
    };
    for (Py_ssize_t left = row.count; left > 0; left -= kWavelengths) {
      const int count = int(std::min<Py_ssize_t>(kWavelengths, left));
      const Spectrum nm = load_wavelengths<T>(in.wavelength, at_nm, step_nm, count);
      if (any(nm.v != wavelengths.nm.v)) {
        if (!range.holds(nm))
          for (int k = 0; k < count; ++k)
            if (!range.holds(nm[k]))
              throw_wavelength(in.wavelength, in.wavelength.number(at_nm + k * step_nm), range, where(3, k));
        // Constructed in place: an assignment by half vectors would stall the first load (store forwarding).
        new (&wavelengths) Wavelengths(Wavelengths::at(range.grid, nm));
      }
      if (constant) {
        load_place(0);
        store(f(a, b, uv, wavelengths), to, out_step, count);
      } else {
        for (int k = 0; k < count;) {
          load_place(k);
          const int first = k++;
          const auto move = [&] { at_a += step_a, at_b += step_b, at_uv += step_uv; };
          for (move(); k < count && in.b.equal<T>(at_b, last_b) && in.a.equal<T>(at_a, last_a) &&
                       in.uv.equal<void>(at_uv, last_uv);
               ++k)
            move();
          if (k == first + 1) {
            to[first * out_step] = double(f(a, b, uv, only(wavelengths, first))[0]);
          } else {
            const Spectrum value = f(a, b, uv, wavelengths);
            for (int i = first; i < k; ++i) to[i * out_step] = double(value[i]);
          }
        }
      }
      at_nm += count * step_nm, to += count * out_step;
      interrupts.check();
    }
  });
}

/// Calls `f(a, b, uv, wavelengths) -> Spectrum` and writes its values to `out`. Elements one after another
/// that share their directions and place go to one call. Large arrays are divided among all cores: each part
/// has a copy of `f`.
template <class F>
void for_places(const PlaceArguments& in, const WavelengthRange& range, double* out, const F& f) {
  const auto all = [&](bool is_double) {
    for (const Argument* a : {&in.a, &in.b, &in.wavelength})
      if (!a->is_constant() && a->is_double() != is_double) return false;
    return true;
  };
  // The constant of an argument that is not given is of type double.
  const bool given = !in.a.is_constant() && !in.b.is_constant();
  const bool doubles = all(true), floats = given && all(false);
  const Unlocked release;
  constexpr Py_ssize_t kPart = 1 << 14;
  const std::vector<Broadcast<4>> parts = in.broadcast.parts(kPart, kWavelengths);
  std::atomic<std::size_t> next{0};
  std::atomic<bool> failed{false};
  const auto work = [&](int) {
    Interrupts interrupts;  // one for all parts, since each is too short to check by itself
    try {
      for (std::size_t i; !failed && (i = next++) < parts.size();)
        if (doubles)
          for_typed_places<double>(in, parts[i], range, out, f, interrupts);
        else if (floats)
          for_typed_places<float>(in, parts[i], range, out, f, interrupts);
        else
          for_typed_places<void>(in, parts[i], range, out, f, interrupts);
    } catch (...) {
      failed = true;
      throw;
    }
  };
  const int threads = int(std::min<std::size_t>(parts.size(), std::size_t(default_thread_count())));
  if (threads < 2)
    work(0);
  else
    run_workers(threads, work);
}

}  // namespace aureole::python

// SPDX-License-Identifier: Apache-2.0
// The loop that a program in C++ writes to evaluate a BSDF for many (direction, wavelength) triples, as a
// library that bench/python_eval.py loads to compare `Bsdf.eval` of the Python module with it on one machine
// at one time.
#include <chrono>
#include <cstdint>
#include <memory>

#include "aureole/bsdf/bsdf.h"
#include "aureole/shape/surface_point.h"
#include "tests/harness/properties_builder.h"

namespace {

using namespace aureole;

struct Loop {
  std::shared_ptr<const BuildContext> context = testing::make_context();
  std::shared_ptr<const Bsdf> bsdf;
};

double seconds_since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

}  // namespace

extern "C" {

void* loop_make(const char* xml) {
  auto loop = std::make_unique<Loop>();
  loop->bsdf = testing::build<Bsdf>(xml, loop->context);
  return loop.release();
}

void loop_free(void* loop) { delete static_cast<Loop*>(loop); }

/// n triples with nothing in common; returns seconds.
double loop_triples(const void* data, const Vec3* wi, const Vec3* wo, const float* nm, std::int64_t n,
                    float* out) {
  const auto& loop = *static_cast<const Loop*>(data);
  const Bsdf& bsdf = *loop.bsdf;
  const SpectralGrid& grid = loop.context->grid;
  const SurfacePoint point;
  const auto begin = std::chrono::steady_clock::now();
  for (std::int64_t i = 0; i < n; ++i) {
    const Wavelengths w = Wavelengths::at(grid, nm[i]);
    out[i] = bsdf.eval(wi[i], wo[i], {w, point})[0];
  }
  return seconds_since(begin);
}

/// n pairs of directions, each with its own 8 wavelengths.
double loop_directions(const void* data, const Vec3* wi, const Vec3* wo, const float* nm, std::int64_t n,
                       float* out) {
  const auto& loop = *static_cast<const Loop*>(data);
  const Bsdf& bsdf = *loop.bsdf;
  const SpectralGrid& grid = loop.context->grid;
  const SurfacePoint point;
  const auto begin = std::chrono::steady_clock::now();
  for (std::int64_t i = 0; i < n; ++i) {
    const Wavelengths w =
        Wavelengths::at(grid, make_spectrum([&](int k) { return nm[i * kWavelengths + k]; }));
    const Spectrum value = bsdf.eval(wi[i], wo[i], {w, point});
    for (int k = 0; k < kWavelengths; ++k) out[i * kWavelengths + k] = value[k];
  }
  return seconds_since(begin);
}
}

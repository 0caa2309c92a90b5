// SPDX-License-Identifier: Apache-2.0
// Colours by direction in real spherical harmonics with the Condon-Shortley phase, as Gaussian splats store
// them (KHR_gaussian_splatting, appendix on spherical harmonics; signs as in 3D Gaussian splatting).
#pragma once

#include <cstddef>

#include "aureole/math/vec.h"

namespace aureole {

/// The constant function Y_00. A colour of 1 has the coefficient 0.5 / kHarmonic0.
inline constexpr float kHarmonic0 = 0.28209479177387814f;
inline constexpr int kMaxHarmonicDegree = 3;
/// Largest magnitude of a coefficient in files of splats and grids. A colour is decoded by the power 2.4, and the sum of 16
/// coefficients beyond this one would be no radiance that a film counts (2^60).
inline constexpr float kMostHarmonic = 1e6f;

/// Writes the (degree + 1)^2 functions of a unit direction to `out`, in the order of l and then of m = -l to l.
inline void eval_harmonics(int degree, const Vec3& d, float* out) {
  out[0] = kHarmonic0;
  if (degree < 1) return;
  constexpr float k1 = 0.4886025119029199f;
  out[1] = -k1 * d.y, out[2] = k1 * d.z, out[3] = -k1 * d.x;
  if (degree < 2) return;
  const float xx = d.x * d.x, yy = d.y * d.y, zz = d.z * d.z;
  constexpr float k2 = 1.0925484305920792f;
  out[4] = k2 * d.x * d.y;
  out[5] = -k2 * d.y * d.z;
  out[6] = 0.31539156525252005f * (2 * zz - xx - yy);
  out[7] = -k2 * d.x * d.z;
  out[8] = 0.5462742152960396f * (xx - yy);
  if (degree < 3) return;
  out[9] = -0.5900435899266435f * d.y * (3 * xx - yy);
  out[10] = 2.890611442640554f * d.x * d.y * d.z;
  out[11] = -0.4570457994644658f * d.y * (4 * zz - xx - yy);
  out[12] = 0.3731763325901154f * d.z * (2 * zz - 3 * xx - 3 * yy);
  out[13] = -0.4570457994644658f * d.x * (4 * zz - xx - yy);
  out[14] = 1.445305721320277f * d.z * (xx - yy);
  out[15] = -0.5900435899266435f * d.x * (xx - 3 * yy);
}

/// Whether function number `k` changes its sign where an axis of the direction (0: x, 1: y, 2: z) is reversed.
constexpr bool is_odd_harmonic(int k, int axis) {
  // Bits 0 to 2 of each entry: whether that polynomial is odd in x, y, z.
  constexpr unsigned char kOdd[16] = {0, 2, 4, 1, 3, 6, 0, 5, 0, 2, 7, 2, 4, 1, 4, 1};
  return (kOdd[k] >> axis & 1) != 0;
}

/// Returns the colour of a splat by its coefficients, 1/2 plus their sum, before negative values are clamped.
inline Vec3 harmonic_color(const float* coefficients, const float* functions, std::size_t count) {
  Vec3 c{0.5f, 0.5f, 0.5f};
  for (std::size_t k = 0; k < count; ++k)
    c += Vec3{coefficients[3 * k], coefficients[3 * k + 1], coefficients[3 * k + 2]} * functions[k];
  return c;
}

}  // namespace aureole

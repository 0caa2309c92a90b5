// SPDX-License-Identifier: Apache-2.0
#include "aureole/spectrum/upsampling_fit.h"

#include <cstddef>

#include "aureole/spectrum/tables.h"

namespace aureole {
namespace {

using Triple = std::array<double, 3>;
using Mat3 = std::array<Triple, 3>;

constexpr double kCentre = 595.0, kHalfWidth = 235.0;  // centre and half-width [nm] of the range 360-830 nm
constexpr std::size_t kSize = 471;

/// Limit of |coefficient|: spectra change by less than 1e-8 beyond |x| of this order, and float evaluation
/// gets worse.
constexpr double kMaxCoefficient = 5000.0;

Triple multiply(const Mat3& m, const Triple& v) {
  Triple r;
  for (int i = 0; i < 3; ++i) r[i] = m[i][0] * v[0] + m[i][1] * v[1] + m[i][2] * v[2];
  return r;
}

/// Solves m x = v by Cramer's rule.
Triple solve(const Mat3& m, const Triple& v) {
  const auto det = [](const Triple& a, const Triple& b, const Triple& c) {
    return a[0] * (b[1] * c[2] - b[2] * c[1]) - b[0] * (a[1] * c[2] - a[2] * c[1]) +
           c[0] * (a[1] * b[2] - a[2] * b[1]);
  };
  const Triple a{m[0][0], m[1][0], m[2][0]}, b{m[0][1], m[1][1], m[2][1]}, c{m[0][2], m[1][2], m[2][2]};
  const double d = det(a, b, c);
  return {det(v, b, c) / d, det(a, v, c) / d, det(a, b, v) / d};
}

/// The observer times D65, per nm, and the matrices of sRGB. All are relative to the white, whose X, Y, Z are
/// 1.
struct Colorimetry {
  struct Node {
    double t;
    Triple weight;
  };
  std::array<Node, kSize> nodes;
  Mat3 from_srgb;

  Colorimetry() {
    const Observer& observer = cie_1931_observer();
    const TabulatedSpectrum d65 = *find_illuminant("D65");
    const Triple white = cie_tristimulus(d65);
    for (std::size_t i = 0; i < kSize; ++i) {
      const double nm = observer.start_nm + static_cast<double>(i) * observer.step_nm;
      const double power = d65.at(nm) * observer.step_nm * (i == 0 || i + 1 == kSize ? 0.5 : 1.0);
      nodes[i] = {(nm - kCentre) / kHalfWidth,
                  {power * observer.x[i] / white[0], power * observer.y[i] / white[1],
                   power * observer.z[i] / white[2]}};
    }
    // The columns of the matrix are the primaries, scaled so that they sum to the white.
    const double chromaticity[3][2] = {{0.64, 0.33}, {0.30, 0.60}, {0.15, 0.06}};
    Mat3 primaries;
    for (int j = 0; j < 3; ++j) {
      const double x = chromaticity[j][0], y = chromaticity[j][1];
      primaries[0][j] = x / y;
      primaries[1][j] = 1.0;
      primaries[2][j] = (1.0 - x - y) / y;
    }
    const Triple luminance = solve(primaries, {white[0] / white[1], 1.0, white[2] / white[1]});
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) from_srgb[i][j] = primaries[i][j] * luminance[j] * white[1] / white[i];
  }
};

const Colorimetry& colorimetry() {
  static const Colorimetry instance;
  return instance;
}

/// CIELAB of tristimulus values relative to the white, and the derivative of its nonlinearity (CIE
/// 15:2004, 8.2.1).
struct Lab {
  Triple lab, slope;

  explicit Lab(const Triple& xyz) {
    constexpr double kDelta = 6.0 / 29.0;
    Triple f;
    for (int i = 0; i < 3; ++i) {
      if (xyz[i] > kDelta * kDelta * kDelta) {
        f[i] = std::cbrt(xyz[i]);
        slope[i] = 1.0 / (3.0 * f[i] * f[i]);
      } else {
        slope[i] = 1.0 / (3.0 * kDelta * kDelta);
        f[i] = xyz[i] * slope[i] + 4.0 / 29.0;
      }
    }
    lab = combine(f);
  }

  /// L*, a*, b* without the -16 of L*, which cancels in differences and derivatives.
  static Triple combine(const Triple& f) {
    return {116.0 * f[1], 500.0 * (f[0] - f[1]), 200.0 * (f[1] - f[2])};
  }
};

double squared(const Triple& v) { return v[0] * v[0] + v[1] * v[1] + v[2] * v[2]; }

/// Tristimulus values of a spectrum relative to the white, and their derivatives: jacobian[i][j] = d xyz_i /
/// d c_j. A fit spends nearly all of its time here. So the roots and quotients of all nodes come first,
/// several at once, then the sums over the spectrum and its three derivatives side by side.
void integrate(const Triple& c, Triple& xyz, Mat3& jacobian) {
  using Two = double __attribute__((vector_size(16)));
  const Colorimetry& colours = colorimetry();
  std::array<double, kSize> s, ds;
  for (std::size_t i = 0; i < kSize; ++i) {
    const double t = colours.nodes[i].t, x = c[0] + t * (c[1] + t * c[2]);
    const double r = 1.0 / std::sqrt(1.0 + x * x);
    s[i] = 0.5 + 0.5 * x * r, ds[i] = 0.5 * r * r * r;
  }
  Two spectrum[3] = {}, further[3] = {};  // accumulators {xyz, jacobian 0} and {jacobian 1, 2}
  for (std::size_t i = 0; i < kSize; ++i) {
    const Colorimetry::Node& node = colours.nodes[i];
    const double ds_t = ds[i] * node.t;
    const Two a = {s[i], ds[i]}, b = {ds_t, ds_t * node.t};
    for (int k = 0; k < 3; ++k) {
      const Two w = {node.weight[k], node.weight[k]};
      spectrum[k] += w * a, further[k] += w * b;
    }
  }
  for (int k = 0; k < 3; ++k) {
    xyz[k] = spectrum[k][0];
    jacobian[k] = {spectrum[k][1], further[k][0], further[k][1]};
  }
}

/// Clamps components to [0, most]; NaN becomes 0.
Rgb clamped(const Rgb& rgb, double most) {
  Rgb c;
  for (int i = 0; i < 3; ++i) c[i] = rgb[i] > 0 ? std::min(rgb[i], most) : 0.0;
  return c;
}

/// Returns the constant argument x whose spectrum is the grey v.
double grey_argument(double v) {
  const double spread = v * (1.0 - v);
  if (!(spread > 0)) return v > 0.5 ? SigmoidPolynomial::kSaturated : -SigmoidPolynomial::kSaturated;
  return (v - 0.5) / std::sqrt(spread);
}

}  // namespace

SigmoidPolynomial FitCoefficients::polynomial() const {
  const double a = c[2] / (kHalfWidth * kHalfWidth), b = c[1] / kHalfWidth;
  return {static_cast<float>(a), static_cast<float>(b - 2.0 * a * kCentre),
          static_cast<float>(c[0] - b * kCentre + a * kCentre * kCentre)};
}

double refine_fit(const Rgb& linear_rgb, FitCoefficients& start) {
  constexpr int kMaxSteps = 60;
  constexpr double kConverged = 1e-14;  // squared Delta E below which a fit has converged
  const Triple target = Lab(multiply(colorimetry().from_srgb, linear_rgb)).lab;

  Triple& c = start.c;
  Triple xyz;
  Mat3 dxyz;
  integrate(c, xyz, dxyz);
  double damping = 0.0;
  const auto residual_at = [&target](const Lab& lab) {
    return Triple{lab.lab[0] - target[0], lab.lab[1] - target[1], lab.lab[2] - target[2]};
  };
  Lab lab(xyz);
  Triple residual = residual_at(lab);
  double error = squared(residual);
  for (int step = 0; step < kMaxSteps && error > kConverged; ++step) {
    Mat3 j;
    for (int col = 0; col < 3; ++col) {
      const Triple f = Lab::combine(
          {lab.slope[0] * dxyz[0][col], lab.slope[1] * dxyz[1][col], lab.slope[2] * dxyz[2][col]});
      for (int row = 0; row < 3; ++row) j[row][col] = f[row];
    }
    // Normal equations of the step, with Levenberg-Marquardt damping of the diagonal.
    Mat3 normal;
    Triple gradient;
    for (int p = 0; p < 3; ++p) {
      gradient[p] = j[0][p] * residual[0] + j[1][p] * residual[1] + j[2][p] * residual[2];
      for (int q = 0; q < 3; ++q) normal[p][q] = j[0][p] * j[0][q] + j[1][p] * j[1][q] + j[2][p] * j[2][q];
    }
    for (int p = 0; p < 3; ++p) normal[p][p] *= 1.0 + damping;
    const Triple move = damping > 0 ? solve(normal, gradient) : solve(j, residual);
    Triple next;
    bool usable = true;
    for (int p = 0; p < 3; ++p) {
      next[p] = c[p] - move[p];
      usable = usable && std::abs(next[p]) < kMaxCoefficient;  // the comparison is also false for NaN
    }
    bool better = false;
    if (usable) {
      Triple next_xyz;
      Mat3 next_dxyz;
      integrate(next, next_xyz, next_dxyz);
      const Lab next_lab(next_xyz);
      const Triple next_residual = residual_at(next_lab);
      const double next_error = squared(next_residual);
      if (next_error < error) {
        better = true;
        c = next;
        dxyz = next_dxyz;
        lab = next_lab;
        residual = next_residual;
        error = next_error;
      }
    }
    damping = better ? (damping > 1e-6 ? damping * 0.1 : 0.0) : std::max(1e-4, damping * 8.0);
    if (damping > 1e12) break;
  }
  return std::sqrt(error);
}

SigmoidPolynomial fit_sigmoid(const Rgb& linear_rgb) {
  const Rgb rgb = clamped(linear_rgb, 1.0);
  if (rgb[0] == rgb[1] && rgb[1] == rgb[2]) return {0, 0, static_cast<float>(grey_argument(rgb[0]))};
  // The fit continues from the grey of equal mean towards the colour, with more steps if a fit has not
  // converged.
  const double mean = (rgb[0] + rgb[1] + rgb[2]) / 3.0;
  FitCoefficients best;
  double best_error = 1e30;
  for (int steps = 1; steps <= 16 && best_error > 1e-4; steps *= 4) {
    FitCoefficients fit{{grey_argument(mean), 0, 0}};
    double error = 0;
    for (int i = 1; i <= steps; ++i) {
      const double a = static_cast<double>(i) / steps;
      Rgb between;
      for (int k = 0; k < 3; ++k) between[k] = mean + a * (rgb[k] - mean);
      error = refine_fit(between, fit);
    }
    if (error < best_error) {
      best_error = error;
      best = fit;
    }
  }
  return best.polynomial();
}

SigmoidSpectrum fit_srgb(const Rgb& linear_rgb) {
  const Rgb c = clamped(linear_rgb, 1.0);
  const double scale = scale_below_white(c[0], c[1], c[2]);
  if (!(scale < 1) || (c[0] == c[1] && c[1] == c[2])) return {fit_sigmoid(c), 1.f};
  return {fit_sigmoid({(1 - c[0]) / scale, (1 - c[1]) / scale, (1 - c[2]) / scale}),
          -static_cast<float>(scale)};
}

SigmoidSpectrum fit_unbounded(const Rgb& linear_rgb) {
  const Rgb c = clamped(linear_rgb, 1e37);
  const double scale = 2 * std::max({c[0], c[1], c[2]});
  if (!(scale > 0)) return {};
  return {fit_sigmoid({c[0] / scale, c[1] / scale, c[2] / scale}), static_cast<float>(scale)};
}

Rgb srgb_of_reflectance(const SigmoidSpectrum& spectrum) {
  Triple xyz{};
  for (const Colorimetry::Node& node : colorimetry().nodes) {
    const double s = spectrum.at(static_cast<float>(kCentre + kHalfWidth * node.t));
    for (int i = 0; i < 3; ++i) xyz[i] += node.weight[i] * s;
  }
  return solve(colorimetry().from_srgb, xyz);
}

double delta_e(const Rgb& linear_a, const Rgb& linear_b) {
  const Triple a = Lab(multiply(colorimetry().from_srgb, linear_a)).lab;
  const Triple b = Lab(multiply(colorimetry().from_srgb, linear_b)).lab;
  return std::sqrt(squared({a[0] - b[0], a[1] - b[1], a[2] - b[2]}));
}

}  // namespace aureole

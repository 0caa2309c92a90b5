// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/diffraction/uniform_theory.h"

#include <gtest/gtest.h>

#include <boost/math/quadrature/gauss.hpp>
#include <boost/math/special_functions/bessel.hpp>
#include <cmath>

#include "aureole/optics/faddeeva.h"

namespace aureole::optics {
namespace {

using Complex = std::complex<double>;

// The table in the program of Kouyoumjian & Pathak's coefficients (Balanis, Advanced Engineering Electromagnetics, 2nd ed. 2012, chapter 13;
// four digits; their time dependence). Its row for 0.3, .5729 + .2677 i, is .005 off the integral and left out.
TEST(UniformTheory, TransitionFunctionAsPublished) {
  const struct {
    double x, re, im;
  } table[] = {{0.5, 0.6768, 0.2682}, {0.7, 0.7439, 0.2549}, {1.0, 0.8095, 0.2322}, {1.5, 0.8730, 0.1982},
               {2.3, 0.9240, 0.1577}, {4.0, 0.9658, 0.1073}, {5.5, 0.9797, 0.0828}};
  for (const auto& row : table) {
    EXPECT_NEAR(transition_function(row.x).real(), row.re, 6e-5) << row.x;
    EXPECT_NEAR(transition_function(row.x).imag(), -row.im, 6e-5) << row.x;
  }
  EXPECT_EQ(transition_function(0), 0.0);
  EXPECT_NEAR(std::abs(transition_function(1e9) - 1.0), 0, 1e-9);
  EXPECT_THROW(transition_function(-1), std::domain_error);
}

/// (exp(-i pi/4)/sqrt(pi)) integral from a on of exp(i t^2) dt, on the path of steepest descent by Gauss's rule.
Complex sommerfeld_integral(double a) {
  if (a < 0) return 1.0 - sommerfeld_integral(-a);
  using Rule = boost::math::quadrature::gauss<double, 30>;
  const Complex turn = std::polar(1.0, M_PI / 4);
  Complex sum = 0;
  for (int cell = 0; cell < 14; ++cell)
    for (std::size_t k = 0; k < Rule::abscissa().size(); ++k)
      for (int side : {-1, 1}) {
        const Complex t = a + turn * (0.5 * (cell + 0.5 + 0.5 * side * Rule::abscissa()[k]));
        sum += 0.25 * Rule::weights()[k] * std::exp(Complex(0, 1) * t * t);
      }
  return sum / std::sqrt(M_PI);
}

/// Sommerfeld's exact half plane (Born & Wolf 1999, 11.5), E along the edge (soft) or H (hard).
Complex half_plane(double k, double rho, double phi, double phi_i, bool is_hard) {
  const auto part = [&](double b) {
    return std::polar(1.0, -k * rho * std::cos(b)) *
           sommerfeld_integral(-std::sqrt(2 * k * rho) * std::cos(0.5 * b));
  };
  return is_hard ? part(phi - phi_i) + part(phi + phi_i) : part(phi - phi_i) - part(phi + phi_i);
}

TEST(UniformTheory, OfAHalfPlaneIsSommerfeldsSolution) {
  const Wedge screen(2);
  const double phi_i = 1.1, k = 2 * M_PI;
  double worst = 0;
  for (bool is_hard : {false, true})
    for (double rho : {0.01, 0.3, 1.0, 10.0, 1000.0})
      for (double phi = 0.01; phi < 6.28; phi += 0.0391)
        worst = std::max(
            worst, std::abs(screen.plane_wave_field(k, rho, phi, phi_i, is_hard ? kHardMetal : kSoftMetal) -
                            half_plane(k, rho, phi, phi_i, is_hard)));
  std::printf("UTD half plane against Sommerfeld's solution: %.1e of the incident field\n", worst);
  EXPECT_LT(worst, 1e-10);
}

TEST(UniformTheory, IsContinuousAcrossBoundaries) {
  for (double n : {2.0, 1.5, 1.8})
    for (bool is_hard : {false, true})
      for (double phi_i : {0.4, 1.3, 2.9}) {
        const Wedge wedge(n);
        const WedgeFaces faces = is_hard ? kHardMetal : kSoftMetal;
        for (double boundary : {M_PI + phi_i, M_PI - phi_i, phi_i - M_PI, (2 * n - 1) * M_PI - phi_i}) {
          if (boundary <= 0 || boundary >= n * M_PI) continue;
          const Complex on = wedge.plane_wave_field(6.28, 5, boundary, phi_i, faces);
          for (double side : {-1e-9, 1e-9, -1e-13, 1e-13})
            EXPECT_LT(std::abs(wedge.plane_wave_field(6.28, 5, boundary + side, phi_i, faces) - on), 1e-7)
                << n << " " << phi_i << " " << boundary << " " << side;
        }
      }
}

TEST(UniformTheory, FarFromBoundariesIsKellers) {
  for (double n : {2.0, 1.5})
    for (bool is_hard : {false, true}) {
      const Wedge wedge(n);
      const double k = 2 * M_PI, sin_beta = 0.7;
      for (auto [phi, phi_i] : {std::pair(0.5, 1.0), {n * M_PI - 0.3, 0.6}, {1.4, 0.9}}) {
        const Complex keller = wedge.keller_coefficient(k, sin_beta, phi, phi_i, is_hard);
        const Complex uniform =
            wedge.coefficient(k, 1e7, sin_beta, phi, phi_i, is_hard ? kHardMetal : kSoftMetal);
        EXPECT_LT(std::abs(uniform - keller), 1e-6 * std::abs(keller)) << n << " " << phi;
      }
    }
}

/// The exact field of a plane wave at a wedge of metal, a series of Bessel functions (Bowman, Senior & Uslenghi 1969, Electromagnetic and
/// Acoustic Scattering by Simple Shapes, chapter 6).
Complex wedge_series(double n, double k, double rho, double phi, double phi_i, bool is_hard) {
  Complex sum = 0;
  const int terms = int(n * (k * rho + 30 + 6 * std::cbrt(k * rho)));
  for (int m = 0; m <= terms; ++m) {
    const double nu = m / n, a = nu * phi, b = nu * phi_i;
    const double product = is_hard ? std::cos(a) * std::cos(b) : std::sin(a) * std::sin(b);
    sum += (m == 0 ? 1.0 : 2.0) * std::polar(1.0, -M_PI / 2 * nu) * boost::math::cyl_bessel_j(nu, k * rho) *
           product;
  }
  return 2 / n * sum;
}

TEST(UniformTheory, WedgesAgainstTheExactSeries) {
  const double phi_i = 0.9, k = 2 * M_PI;
  for (double n : {1.5, 1.75})
    for (double rho : {0.5, 2.0, 10.0}) {
      const Wedge wedge(n);
      double worst = 0;
      for (bool is_hard : {false, true})
        for (double phi = 0.05; phi < n * M_PI; phi += 0.13)
          worst = std::max(
              worst, std::abs(wedge.plane_wave_field(k, rho, phi, phi_i, is_hard ? kHardMetal : kSoftMetal) -
                              wedge_series(n, k, rho, phi, phi_i, is_hard)));
      std::printf(
          "UTD wedge n = %.2f, %4.1f wavelengths from the edge: %.1e of the incident field off the exact series\n",
          n, rho, worst);
      EXPECT_LT(worst, 0.03 / rho);
    }
}

// The wave of an absorbing half plane, Fresnel's integral of the exact detour, times the factor of a wedge: in the shadow it is
// the exact series, and light is continuous across the boundary of the shadow.
TEST(UniformTheory, WedgesFromTheWaveOfAHalfPlane) {
  const double k = 2 * M_PI;
  const struct {
    double degrees, soft_db, hard_db;  // over the half plane, from the series at 200 wavelengths
  } kRows[] = {{9, -1.42, 1.69}, {21, -3.96, 3.68}};
  for (const auto& [degrees, soft_db, hard_db] : kRows) {
    const double phi_i = M_PI / 4, phi = phi_i + M_PI + degrees * M_PI / 180, rho = 200;
    for (bool is_hard : {false, true}) {
      const Complex factor =
          Wedge(1.5).over_half_plane(k * rho, phi, phi_i, is_hard ? kHardMetal : kSoftMetal);
      EXPECT_NEAR(20 * std::log10(std::abs(factor)), is_hard ? hard_db : soft_db, 0.01) << degrees;
    }
  }
  double worst = 0;
  for (double n : {2.0, 1.75, 1.5})
    for (double phi_i : {0.3, M_PI / 4, 1.4})
      for (double rho : {5.0, 50.0})
        for (bool is_hard : {false, true})
          for (double phi = phi_i + M_PI + 1e-3; phi < n * M_PI - 0.1; phi += 0.07) {
            const double turn = phi - phi_i - M_PI, detour = rho * (1 - std::cos(turn));
            const Complex exact = wedge_series(n, k, rho, phi, phi_i, is_hard);
            const Complex wave =
                Wedge(n).over_half_plane(k * rho, phi, phi_i, is_hard ? kHardMetal : kSoftMetal) *
                knife_edge_field(-std::sqrt(4 * detour)) * std::polar(1.0, k * rho * std::cos(turn));
            worst = std::max(worst, std::abs(wave - exact) / std::max(std::abs(exact), 1e-2));
          }
  std::printf("factors of wedges in the shadow: %.1e off the exact series\n", worst);
  EXPECT_LT(worst, 0.02);
  // Across the boundary of the shadow: the mean of the factors on both sides is 1, for any faces, so that light is continuous, and
  // it is that of the exact series. The faces reflect no light there.
  for (double n : {2.0, 1.5})
    for (double phi_i : {0.2, 1.0})
      for (const WedgeFaces& faces : {kSoftMetal, kHardMetal}) {
        const double rho = 10;
        const auto factor = [&](double off) {
          return Wedge(n).over_half_plane(k * rho, phi_i + M_PI + off, phi_i, faces);
        };
        const auto field = [&](double off) {
          const double v = std::sqrt(8 * rho) * std::sin(0.5 * off);
          const Complex wave = off > 0 ? knife_edge_field(-v) : -knife_edge_field(v);
          return (off > 0 ? 0.0 : 1.0) + factor(off) * wave;
        };
        EXPECT_LT(std::abs(0.5 * (factor(1e-6) + factor(-1e-6)) - 1.0), 1e-5) << n << " " << phi_i;
        for (double off : {0.0, 1e-9})
          EXPECT_LT(std::abs(factor(off) - factor(1e-6)), 1e-5) << n << " " << phi_i;
        EXPECT_LT(std::abs(factor(-1e-9) - factor(-1e-6)), 1e-5) << n << " " << phi_i;
        EXPECT_LT(std::abs(field(1e-6) - field(-1e-6)), 1e-4) << n << " " << phi_i;
        for (double off : {1e-4, -1e-4, -1e-3})
          EXPECT_LT(std::abs(field(off) * std::polar(1.0, k * rho * std::cos(off)) -
                             wedge_series(n, k, rho, phi_i + M_PI + off, phi_i, faces.o == 1.0)),
                    0.01)
              << n << " " << phi_i << " " << off;
      }
  // Source and observer may be exchanged, on both sides of the boundary.
  for (double phi : {1.3, 2.9, 3.6, 4.5})
    EXPECT_LT(std::abs(Wedge(1.5).over_half_plane(40, phi, 0.4, kSoftMetal) -
                       Wedge(1.5).over_half_plane(40, 0.4, phi, kSoftMetal)),
              1e-12)
        << phi;
  // A half plane that absorbs is itself.
  EXPECT_LT(std::abs(Wedge(2).over_half_plane(40, 5, 1, {0.0, 0.0}) - 1.0), 1e-12);
}

TEST(UniformTheory, PointSourcesAndOtherFaces) {
  EXPECT_DOUBLE_EQ(point_source_distance(2, 6, 0.5), 2.0 * 6 / 8 * 0.25);
  EXPECT_NEAR(point_source_distance(1e12, 6, 0.5), plane_wave_distance(6, 0.5), 1e-10);
  EXPECT_DOUBLE_EQ(point_source_spreading(2, 6), std::sqrt(2.0 / 48));
  EXPECT_NEAR(point_source_spreading(1e12, 6), plane_wave_spreading(6), 1e-11);
  // An absorbing half plane keeps the terms of the direct wave: Fresnel's knife edge at small angles.
  const Wedge screen(2);
  const double k = 2 * M_PI, rho = 2000, theta = 0.03;
  const Complex absorbing = screen.plane_wave_field(k, rho, 1.5 * M_PI + theta, M_PI / 2, {0, 0});
  const double v = -2 * std::sqrt(2 * rho) * std::sin(theta / 2);
  EXPECT_NEAR(std::abs(absorbing) / std::abs(knife_edge_field(v)), 1, 1e-3);
  // 1/sin(beta) of oblique incidence.
  EXPECT_NEAR(std::abs(screen.coefficient(k, 7, 0.5, 0.3, 1, kSoftMetal) /
                       screen.coefficient(k, 7, 1, 0.3, 1, kSoftMetal)),
              2, 1e-12);
  EXPECT_THROW(Wedge(1), std::domain_error);
  EXPECT_THROW(Wedge(2.1), std::domain_error);
  EXPECT_THROW(screen.coefficient(k, 7, 1, 7, 1, kSoftMetal), std::domain_error);
  EXPECT_THROW(screen.coefficient(k, 0, 1, 1, 1, kSoftMetal), std::domain_error);
}

// The wave of a wedge minus those of half planes for the source and for its image has no poles: it is continuous at
// the boundaries of shadow and of reflection, vanishes on the face for soft waves and is even there for hard ones. Far
// from the boundaries it is the difference of Keller's coefficients, of cotangents and cosines.
TEST(UniformTheory, TermsBesideTheImageHaveNoPoles) {
  constexpr double kPi = 3.141592653589793, kNear = 1e-5;
  for (const double n : {1.5, 1.2})
    for (const double k_distance : {3.0, 100.0, 1e5})
      for (const double face : {-1.0, 1.0})
        for (const double phi_i : {0.6 * kPi, 0.97 * kPi, kPi, 1.1 * kPi}) {
          const auto terms = [&](double phi) {
            return Wedge(n).terms_beside_image(k_distance, phi, phi_i, {face, face});
          };
          // The term of light that the n-face reflects has its own boundary, which is not near these ones.
          for (const double boundary : {kPi - phi_i, phi_i - kPi}) {
            if (boundary < kNear || boundary > 0.4 * kPi) continue;
            EXPECT_LT(std::abs(terms(boundary + kNear) - terms(boundary - kNear)), 2e-2)
                << n << ", " << k_distance << ", " << face << ", " << phi_i;
          }
          if (face < 0)
            EXPECT_LT(std::abs(terms(0)), 1e-6) << n << ", " << phi_i;
          else
            EXPECT_LT(std::abs(terms(kNear) - terms(0)), 1e-4) << n << ", " << phi_i;
        }
  const double n = 1.5, phi = 0.3, phi_i = 2.2, k = 1e6;
  const auto keller = [](double m, double angle) {
    return 4 / m * std::sin(kPi / m) / (std::cos(kPi / m) - std::cos(angle / m));
  };
  for (const double face : {-1.0, 1.0}) {
    const double expected = keller(n, phi - phi_i) + face * keller(n, phi + phi_i) - keller(2, phi - phi_i) -
                            face * keller(2, phi + phi_i);
    const Complex found = Wedge(n).terms_beside_image(k, phi, phi_i, {face, face});
    EXPECT_NEAR(std::abs(found), std::abs(expected), 1e-3 * std::abs(expected)) << face;
  }
}

}  // namespace
}  // namespace aureole::optics

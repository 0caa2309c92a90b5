// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/diffraction/uniform_theory.h"

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include "aureole/optics/constants.h"
#include "aureole/optics/faddeeva.h"

namespace aureole::optics {
namespace {

using std::numbers::pi;

const Complex kQuarter = std::polar(1.0, pi / 4);

void require(bool right, const char* name, double value, const char* expected) {
  if (!right)
    throw std::domain_error(std::string(name) + ": expected " + expected + ", got " + std::to_string(value));
}

/// Returns cot((pi + b)/(2 n)) F(k L a(b)) of KP equation 25, for b = +-(phi -+ phi'). With the angle t from
/// the nearest pole, pi + b = 2 pi n N + t, it is cot(t/2n) F(2 k L sin^2(t/2)); the root in F cancels the
/// pole and leaves a jump at t = 0.
Complex term(double n, double k_distance, double b) {
  const double turns = std::round((pi + b) / (2 * pi * n));
  const double t = pi + b - 2 * pi * n * turns;
  // Within rounding errors of the angles the observer is on the boundary: the result is the mean of both
  // sides.
  if (std::abs(t) < 4e-15) return 0;
  const double root = std::sqrt(2 * k_distance) * std::abs(std::sin(0.5 * t));
  const Complex over_root = std::sqrt(pi) * std::conj(kQuarter) * faddeeva(root * kQuarter);
  return root / std::tan(0.5 * t / n) * over_root;
}

/// Returns the two terms of one sum or difference of the angles.
Complex both_terms(double n, double k_distance, double angle) {
  return term(n, k_distance, angle) + term(n, k_distance, -angle);
}
/// Returns the four terms for the difference and the sum of the angles, those of the sum times the faces' coefficients.
Complex wedge_terms(double n, double k_distance, double difference, double sum, const WedgeFaces& faces) {
  return both_terms(n, k_distance, difference) + faces.n * term(n, k_distance, sum) +
         faces.o * term(n, k_distance, -sum);
}

/// Returns phi moved away from the boundary of the shadow of a source at phi_i. There `term` is the mean of both
/// sides, which is 0 for a half plane.
double beside_shadow(double phi, double phi_i) {
  constexpr double kNearest = 1e-7;
  const double to_shadow = phi > phi_i ? pi : -pi, off = phi - phi_i - to_shadow;
  return std::abs(off) < kNearest ? phi_i + to_shadow + std::copysign(kNearest, off) : phi;
}

double side_of(double angle) { return std::abs(angle) < 4e-15 ? 0.5 : angle > 0 ? 1 : 0; }

}  // namespace

std::complex<double> transition_function(double x) {
  require(x >= 0, "argument of the transition function", x, "at least 0");
  if (x == INFINITY) return 1;
  const double root = std::sqrt(x);
  return std::sqrt(pi) * root * std::conj(kQuarter) * faddeeva(root * kQuarter);
}

Wedge::Wedge(double n) : n_(n) {
  require(n > 1 && n <= 2, "angle outside a wedge over pi", n, "a number in (1, 2]");
}

std::complex<double> Wedge::coefficient(double k, double distance, double sin_beta, double phi, double phi_i,
                                        WedgeFaces faces) const {
  require(k > 0, "wave number", k, "a positive number");
  require(distance > 0, "distance parameter", distance, "a positive length");
  require(sin_beta > 0 && sin_beta <= 1, "sine of the angle to the edge", sin_beta, "a number in (0, 1]");
  const double end = n_ * pi + 1e-12;
  require(phi >= -1e-12 && phi <= end, "angle of the observer", phi, "0 to n pi");
  require(phi_i >= -1e-12 && phi_i <= end, "angle of the source", phi_i, "0 to n pi");
  const double difference = phi - phi_i, sum = phi + phi_i, kl = k * distance;
  const Complex terms = term(n_, kl, difference) + term(n_, kl, -difference) + faces.n * term(n_, kl, sum) +
                        faces.o * term(n_, kl, -sum);
  return -kQuarter / (2 * n_ * std::sqrt(2 * pi * k) * sin_beta) * terms;
}

std::complex<double> Wedge::keller_coefficient(double k, double sin_beta, double phi, double phi_i,
                                               bool is_hard) const {
  const double c = std::cos(pi / n_);
  const double first = 1 / (c - std::cos((phi - phi_i) / n_)),
               second = 1 / (c - std::cos((phi + phi_i) / n_));
  return kQuarter * std::sin(pi / n_) / (n_ * std::sqrt(2 * pi * k) * sin_beta) *
         (is_hard ? first + second : first - second);
}

std::complex<double> Wedge::faded(std::complex<double> face, double k_distance, double phi, double phi_i,
                                  double boundary, double from_boundary) {
  if (face == 0.0 || from_boundary <= 0) return 0;
  const double to_shadow = phi > phi_i ? pi : -pi;
  const auto transition = [&](double to_angle) {
    const double s = std::sin(0.5 * (to_angle - boundary));
    return std::abs(transition_function(2 * k_distance * s * s));
  };
  const double whole = std::sqrt(transition(2 * phi_i + to_shadow) * transition(2 * phi - to_shadow));
  const double here = transition(phi + phi_i);
  return here < whole ? face * (here / whole) * (here / whole) : face;
}

std::complex<double> Wedge::over_half_plane(double k_distance, double phi, double phi_i,
                                            WedgeFaces faces) const {
  phi = beside_shadow(phi, phi_i);
  const double difference = phi - phi_i, sum = phi + phi_i;
  if (std::abs(difference) < pi) {
    const double n_boundary = (2 * n_ - 1) * pi;
    faces.o = faded(faces.o, k_distance, phi, phi_i, pi, sum - pi);
    faces.n = faded(faces.n, k_distance, phi, phi_i, n_boundary, n_boundary - sum);
  }
  return wedge_terms(n_, k_distance, difference, sum, faces) / both_terms(2, k_distance, difference) *
         (2 / n_);
}

std::complex<double> Wedge::terms_beside_image(double k_distance, double phi, double phi_i,
                                               WedgeFaces faces) const {
  phi = beside_shadow(phi, phi_i);
  const double difference = phi - phi_i, sum = phi + phi_i;
  if (std::abs(difference) < pi) {
    const double n_boundary = (2 * n_ - 1) * pi;
    faces.n = faded(faces.n, k_distance, phi, phi_i, n_boundary, n_boundary - sum);
  }
  return wedge_terms(n_, k_distance, difference, sum, faces) * (2 / n_) -
         both_terms(2, k_distance, difference) - faces.o * both_terms(2, k_distance, sum);
}

std::complex<double> half_plane_terms(double k_distance, double difference) {
  return both_terms(2, k_distance, beside_shadow(difference, 0));
}

std::complex<double> Wedge::over_half_plane_and_image(double k_distance, double phi, double phi_i,
                                                      std::complex<double> face) const {
  // For soft polarisation both sums vanish at grazing angles.
  constexpr double kGrazing = 1e-4;
  phi_i = std::max(phi_i, kGrazing);
  phi = beside_shadow(std::max(phi, kGrazing), phi_i);
  // At grazing incidence the boundaries of shadow and of reflection coincide: the larger angle is moved out of the
  // gap between them that the smaller angle leaves.
  const double least = std::min(phi, phi_i);
  if (least < 2 * kGrazing && std::abs(phi - phi_i) < pi && phi + phi_i > pi)
    (phi > phi_i ? phi : phi_i) += 2.5 * least;
  const auto with_image = [&](double n) {
    return both_terms(n, k_distance, phi - phi_i) + face * both_terms(n, k_distance, phi + phi_i);
  };
  return with_image(n_) / with_image(2) * (2 / n_);
}

WedgeLight Wedge::light(double phi, double phi_i) const {
  return {side_of(pi - std::abs(phi - phi_i)), side_of(pi - phi - phi_i),
          side_of(phi + phi_i - (2 * n_ - 1) * pi)};
}

std::complex<double> Wedge::plane_wave_field(double k, double rho, double phi, double phi_i,
                                             WedgeFaces faces) const {
  const WedgeLight lit = light(phi, phi_i);
  const auto wave = [&](double angle) { return std::polar(1.0, -k * rho * std::cos(angle)); };
  return lit.direct * wave(phi - phi_i) + lit.reflected_o * faces.o * wave(phi + phi_i) +
         lit.reflected_n * faces.n * wave(2 * n_ * pi - phi - phi_i) +
         coefficient(k, rho, 1, phi, phi_i, faces) * plane_wave_spreading(rho) * std::polar(1.0, k * rho);
}

double plane_wave_distance(double s, double sin_beta) { return s * sin_beta * sin_beta; }
double point_source_distance(double s_i, double s, double sin_beta) {
  return s * s_i / (s + s_i) * sin_beta * sin_beta;
}
double point_source_spreading(double s_i, double s) { return std::sqrt(s_i / (s * (s + s_i))); }
double plane_wave_spreading(double s) { return 1 / std::sqrt(s); }

}  // namespace aureole::optics

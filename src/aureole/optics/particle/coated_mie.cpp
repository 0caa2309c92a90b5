// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/particle/coated_mie.h"

#include <cmath>
#include <stdexcept>
#include <string>

#include "aureole/optics/constants.h"
#include "aureole/optics/particle/mie_sphere.h"
#include "aureole/optics/particle/riccati_bessel.h"

namespace aureole::optics {
namespace {

constexpr Complex kI{0, 1};

void check_index(Complex m, const char* part) {
  if (!(m.real() > 0 && m.imag() >= 0 && std::abs(m) <= Mie::kMaxIndex))
    throw std::domain_error(std::string("relative index of the ") + part +
                            " of a sphere must have a positive real part, no negative imaginary part and a "
                            "modulus up to 100, got " +
                            std::to_string(m.real()) + " + " + std::to_string(m.imag()) + "i");
}

/// Returns the logarithmic derivatives of zeta_n(z) = z h_n^(1)(z) for n = 0 ... count, by the stable upward
/// recurrence, given those of psi_n (Yang 2003, equations 18 to 21).
std::vector<Complex> outgoing_derivatives(Complex z, const std::vector<Complex>& psi) {
  std::vector<Complex> d(psi.size());
  d[0] = kI;
  Complex product = 0.5 * (1.0 - std::exp(2.0 * kI * z));  // product psi_0 zeta_0
  for (std::size_t n = 1; n < psi.size(); ++n) {
    const Complex ratio = double(n) / z;
    product *= (ratio - psi[n - 1]) * (ratio - d[n - 1]);
    d[n] = psi[n] + kI / product;
  }
  return d;
}

}  // namespace

CoatedMie::CoatedMie(double core_x, double x, Complex core, Complex coat) : PartialWaves(x) {
  if (!(x >= Mie::kMinSize && x <= Mie::kMaxSize))
    throw std::domain_error("size parameter of a sphere must be in [1e-6, 1e5], got " + std::to_string(x));
  if (!(core_x > 0 && core_x <= x))
    throw std::domain_error("size parameter of the core must be positive and at most that of the sphere, " +
                            std::to_string(x) + ", got " + std::to_string(core_x));
  check_index(core, "core");
  check_index(coat, "coat");

  const int count = term_count(x);
  const Complex inner = coat * core_x, outer = coat * x;
  const auto core_psi = logarithmic_derivatives(core * core_x, count);
  const auto inner_psi = logarithmic_derivatives(inner, count);
  const auto outer_psi = logarithmic_derivatives(outer, count);
  const auto inner_zeta = outgoing_derivatives(inner, inner_psi);
  const auto outer_zeta = outgoing_derivatives(outer, outer_psi);

  // The ratio of psi_n(inner)/zeta_n(inner) to psi_n(outer)/zeta_n(outer) (Yang 2003, equations 32 to 34).
  std::vector<Complex> electric(count + 1), magnetic(count + 1);
  Complex ratio = std::exp(-2 * (outer.imag() - inner.imag())) *
                  (std::exp(-2.0 * kI * inner.real()) - std::exp(-2 * inner.imag())) /
                  (std::exp(-2.0 * kI * outer.real()) - std::exp(-2 * outer.imag()));
  for (int n = 1; n <= count; ++n) {
    const double order = n;
    ratio *= (outer_psi[n] + order / outer) / (inner_psi[n] + order / inner) *
             ((order / outer - outer_zeta[n - 1]) / (order / inner - inner_zeta[n - 1]));
    // The logarithmic derivative of the field in the coat at its outer surface (equations 24, 25).
    const auto derivative = [&](Complex regular, Complex outgoing) {
      return (outgoing * outer_psi[n] - ratio * regular * outer_zeta[n]) / (outgoing - ratio * regular);
    };
    electric[n] =
        derivative(coat * core_psi[n] - core * inner_psi[n], coat * core_psi[n] - core * inner_zeta[n]);
    magnetic[n] =
        derivative(core * core_psi[n] - coat * inner_psi[n], core * core_psi[n] - coat * inner_zeta[n]);
  }
  const Complex per_coat = 1.0 / coat;
  for (int n = 1; n <= count; ++n) electric[n] *= per_coat, magnetic[n] *= coat;
  match(electric, magnetic);
}

}  // namespace aureole::optics

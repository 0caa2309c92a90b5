// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/particle/mie.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace aureole::optics {
namespace {

using Complex = std::complex<double>;

/// Number of terms after which the series has converged in double precision (Wiscombe, "Improved Mie
/// scattering algorithms", 1980, equation 26, with a few more).
int term_count(double x) { return int(std::ceil(x + 4.05 * std::cbrt(x) + 8)); }

/// psi_n'(z)/psi_n(z) for n = 1 ... count, by downward recurrence. Errors of its start decay only at n > |z|,
/// over some |z|^(1/3) terms: a start at |z| itself gives wrong results for large absorbing spheres.
std::vector<Complex> logarithmic_derivatives(Complex z, int count) {
  const double size = std::abs(z);
  const int start = std::max(count, int(std::ceil(size + 8 * std::cbrt(size)))) + 16;
  std::vector<Complex> d(count + 1);
  const Complex inverse = 1.0 / z;
  Complex value = double(start + 1) * inverse;
  for (int n = start; n > 0; --n) {
    if (n <= count) d[n] = value;
    const Complex ratio = double(n) * inverse, sum = value + ratio;
    value = ratio - std::conj(sum) / std::norm(sum);
  }
  return d;
}

/// psi_n(x) = x j_n(x) for n = 0 ... count: upward as long as that is stable, n < x, and from there by the
/// ratios psi_n/psi_(n-1) of a downward recurrence.
std::vector<double> riccati_bessel(double x, int count) {
  std::vector<double> psi(count + 1);
  const int turn = std::min(count, int(x));
  psi[0] = std::sin(x);
  double before = std::cos(x);
  for (int n = 1; n <= turn; ++n) {
    psi[n] = (2 * n - 1) / x * psi[n - 1] - before;
    before = psi[n - 1];
  }
  double ratio = 0;
  for (int n = count + 16 + int(4 * std::cbrt(x)); n > turn; --n) {
    ratio = 1 / ((2 * n + 1) / x - ratio);
    if (n <= count) psi[n] = ratio;
  }
  for (int n = turn + 1; n <= count; ++n) psi[n] *= psi[n - 1];
  return psi;
}

}  // namespace

Mie::Mie(double x, Complex m) : x_(x) {
  if (!(x >= kMinSize && x <= kMaxSize))
    throw std::domain_error("size parameter of a sphere must be in [1e-6, 1e5], got " + std::to_string(x));
  if (!(m.real() > 0 && m.imag() >= 0 && std::abs(m) <= kMaxIndex))
    throw std::domain_error(
        "relative index of a sphere must have a positive real part, no negative imaginary part and a modulus "
        "up to 100, got " +
        std::to_string(m.real()) + " + " + std::to_string(m.imag()) + "i");
  find_coefficients(m);
  find_efficiencies();
}

void Mie::find_coefficients(Complex m) {
  const int count = term_count(x_);
  const auto d = logarithmic_derivatives(m * x_, count);
  const auto psi = riccati_bessel(x_, count);
  a_.resize(count), b_.resize(count), terms_.resize(count);
  double chi_before = -std::sin(x_), chi = std::cos(x_);  // chi_(-1), chi_0; xi = psi - i chi
  for (int n = 1; n <= count; ++n) {
    const double next = (2 * n - 1) / x_ * chi - chi_before;
    chi_before = chi, chi = next;
    // Bohren & Huffman, equation 4.88. The denominators differ from the numerators by -i chi in place of psi.
    const auto coefficient = [&](Complex factor) {
      const Complex numerator = factor * psi[n] - psi[n - 1], other = factor * chi - chi_before;
      const Complex denominator = numerator - Complex(0, 1) * other;
      return numerator * (std::conj(denominator) / std::norm(denominator));
    };
    a_[n - 1] = coefficient(d[n] / m + n / x_);
    b_[n - 1] = coefficient(m * d[n] + n / x_);
    const double weight = (2 * n + 1.0) / (double(n) * (n + 1));
    const Complex a = weight * a_[n - 1], b = weight * b_[n - 1];
    terms_[n - 1] = {a.real(), a.imag(), b.real(), b.imag()};
  }
}

void Mie::find_efficiencies() {
  double extinction = 0, scattering = 0, cosine = 0;
  Complex backward = 0;
  // The small terms first: sums of large ones would swallow them.
  for (int n = int(a_.size()); n > 0; --n) {
    const Complex a = a_[n - 1], b = b_[n - 1];
    const double weight = 2 * n + 1;
    forward_ += 0.5 * weight * (a + b);
    extinction += weight * (a.real() + b.real());
    scattering += weight * (std::norm(a) + std::norm(b));
    backward += (n % 2 ? -weight : weight) * (a - b);
    cosine += weight / (double(n) * (n + 1)) * (a * std::conj(b)).real();
    if (n < int(a_.size()))
      cosine += double(n) * (n + 2) / (n + 1) * (a * std::conj(a_[n]) + b * std::conj(b_[n])).real();
  }
  const double x2 = x_ * x_;
  extinction_ = 2 / x2 * extinction;
  // Rounding must not let scattering exceed extinction.
  scattering_ = std::min(2 / x2 * scattering, extinction_ > 0 ? extinction_ : 0);
  extinction_ = std::max(extinction_, 0.0);
  backscattering_ = std::norm(backward) / x2;
  asymmetry_ = scattering > 0 ? 2 * cosine / scattering : 0;
}

MieAmplitudes Mie::amplitudes(double mu) const {
  MieAmplitudes s;
  amplitudes(std::span(&mu, 1), std::span(&s, 1));
  return s;
}

void Mie::amplitudes(std::span<const double> mu, std::span<MieAmplitudes> at,
                     std::span<MieAmplitudes> mirrored) const {
  constexpr std::size_t kLanes = 4;
  using Vector = double __attribute__((vector_size(sizeof(double) * kLanes)));
  for (std::size_t first = 0; first < mu.size(); first += kLanes) {
    const std::size_t lanes = std::min(kLanes, mu.size() - first);
    Vector cosine{};
    for (std::size_t i = 0; i < kLanes; ++i) cosine[i] = mu[first + std::min(i, lanes - 1)];
    // pi_n and tau_n (Bohren & Huffman, equation 4.47): pi is odd or even as n - 1, tau as n.
    Vector before{}, pi = cosine * 0 + 1;
    Vector s1r{}, s1i{}, s2r{}, s2i{}, m1r{}, m1i{}, m2r{}, m2i{};
    for (std::size_t k = 0; k < terms_.size(); ++k) {
      const Term& t = terms_[k];
      const double n = double(k + 1), inverse = 1 / n;
      const Vector along = cosine * pi, tau = along * n - before * (n + 1);
      const Vector pi_a_r = pi * t.ar, pi_a_i = pi * t.ai, tau_b_r = tau * t.br, tau_b_i = tau * t.bi;
      const Vector tau_a_r = tau * t.ar, tau_a_i = tau * t.ai, pi_b_r = pi * t.br, pi_b_i = pi * t.bi;
      s1r += pi_a_r + tau_b_r, s1i += pi_a_i + tau_b_i;
      s2r += tau_a_r + pi_b_r, s2i += tau_a_i + pi_b_i;
      if (k % 2) {
        m1r -= pi_a_r - tau_b_r, m1i -= pi_a_i - tau_b_i;
        m2r -= pi_b_r - tau_a_r, m2i -= pi_b_i - tau_a_i;
      } else {
        m1r += pi_a_r - tau_b_r, m1i += pi_a_i - tau_b_i;
        m2r += pi_b_r - tau_a_r, m2i += pi_b_i - tau_a_i;
      }
      const Vector next = (along * (2 * n + 1) - before * (n + 1)) * inverse;
      before = pi, pi = next;
    }
    for (std::size_t i = 0; i < lanes; ++i) {
      at[first + i] = {{s1r[i], s1i[i]}, {s2r[i], s2i[i]}};
      if (!mirrored.empty()) mirrored[first + i] = {{m1r[i], m1i[i]}, {m2r[i], m2i[i]}};
    }
  }
}

}  // namespace aureole::optics

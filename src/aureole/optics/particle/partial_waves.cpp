// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/particle/partial_waves.h"

#include <algorithm>
#include <cmath>

#include "aureole/optics/constants.h"
#include "aureole/optics/particle/riccati_bessel.h"

namespace aureole::optics {

void PartialWaves::match(std::span<const Complex> electric, std::span<const Complex> magnetic) {
  const int count = int(electric.size()) - 1;
  const auto psi = riccati_bessel(x_, count);
  a_.resize(count), b_.resize(count), terms_.resize(count);
  const double per_x = 1 / x_;
  double chi_before = -std::sin(x_), chi = std::cos(x_);  // chi_(-1) and chi_0 of xi = psi - i chi
  for (int n = 1; n <= count; ++n) {
    const double next = (2 * n - 1) * per_x * chi - chi_before;
    chi_before = chi, chi = next;
    // The denominators differ from the numerators by -i chi in place of psi. They are written out because
    // products of std::complex check for infinities, which would dominate the cost.
    const auto coefficient = [&](Complex inside) {
      const double fr = inside.real() + n * per_x, fi = inside.imag();
      const double nr = fr * psi[n] - psi[n - 1], ni = fi * psi[n];
      const double dr = nr + fi * chi, di = ni - (fr * chi - chi_before);
      const double scale = 1 / (dr * dr + di * di);
      return Complex((nr * dr + ni * di) * scale, (ni * dr - nr * di) * scale);
    };
    const Complex a = a_[n - 1] = coefficient(electric[n]), b = b_[n - 1] = coefficient(magnetic[n]);
    const double weight = (2 * n + 1.0) / (double(n) * (n + 1));
    terms_[n - 1] = {weight * a.real(), weight * a.imag(), weight * b.real(), weight * b.imag()};
  }
  find_efficiencies();
}

void PartialWaves::find_efficiencies() {
  double extinction = 0, scattering = 0, cosine = 0;
  Complex backward = 0;
  // Small terms are summed first, so that large sums do not absorb them.
  for (int n = int(a_.size()); n > 0; --n) {
    const Complex a = a_[n - 1], b = b_[n - 1];
    const double weight = 2 * n + 1;
    const auto along = [](Complex u, Complex v) { return u.real() * v.real() + u.imag() * v.imag(); };
    forward_ += 0.5 * weight * (a + b);
    extinction += weight * (a.real() + b.real());
    scattering += weight * (std::norm(a) + std::norm(b));
    backward += (n % 2 ? -weight : weight) * (a - b);
    const double share = 1 / (double(n) * (n + 1));
    cosine += weight * share * along(a, b);
    if (n < int(a_.size())) cosine += double(n) * n * (n + 2) * share * (along(a, a_[n]) + along(b, b_[n]));
  }
  const double x2 = x_ * x_;
  extinction_ = 2 / x2 * extinction;
  // The bound keeps rounding errors from making scattering exceed extinction.
  scattering_ = std::min(2 / x2 * scattering, extinction_ > 0 ? extinction_ : 0);
  extinction_ = std::max(extinction_, 0.0);
  backscattering_ = std::norm(backward) / x2;
  asymmetry_ = scattering > 0 ? 2 * cosine / scattering : 0;
}

namespace {

/// Returns the part of a partial wave that is absorbed: Re a - |a|^2.
double absorbed(Complex a) { return std::max(a.real() - std::norm(a), 0.0); }

/// Returns the mean of `absorbed` from -h to h; the three values of a are those at -d, 0 and d.
///
/// 1/a = 1 + u + i c, and the wave absorbs u/((1 + u)^2 + c^2). Without absorption u = 0, and c = C/A is the
/// quotient of two smooth real functions of the size (Bohren & Huffman 1983, section 4.4: numerator and denominator
/// of a are A and A + i C). A weak absorption gives u = v/A^2 with a smooth v. At a resonance C runs through 0 while
/// A is small, so that its width in the size, (1 + u) over the slope of c, may be tiny. C, A and v are taken as linear
/// in the distance t: c = (p + q t)/(1 + r t). The root of C is the resonance; in its neighbourhood u and the slope
/// of c are constant and the mean has a closed form. Where there is no narrow resonance nearby, or where A
/// changes much between 0 and the resonance, the mean is approximated by the value at 0.
double mean_absorbed(Complex before, Complex a, Complex after, double d, double h) {
  constexpr double kReach = 6, kMostChange = 1.5, kNarrow = 0.3;
  const double middle = absorbed(a);
  const double n0 = std::norm(before), n1 = std::norm(a), n2 = std::norm(after);
  if (!(middle > 0 && std::min({n0, n1, n2}) > 1e-60)) return middle;
  const double c0 = -before.imag() / n0, c = -a.imag() / n1, c2 = -after.imag() / n2;
  const double slope = (c2 - c0) / (2 * d), curvature = (c2 - 2 * c + c0) / (d * d);
  const double r = -curvature / (2 * slope), q = slope + r * c, root = -c / q, change = 1 + r * root;
  if (!(std::abs(root) < kReach * h && change > 1 / kMostChange && change < kMostChange)) return middle;
  const double v0 = absorbed(before) / n0 * (1 - r * d) * (1 - r * d),
               v2 = absorbed(after) / n2 * (1 + r * d) * (1 + r * d), v1 = middle / n1;
  const double there = v1 + (v2 - v0) / (2 * d) * root;
  const double u = (there > 0 ? there : v1) / (change * change), speed = q / change, width = 1 + u;
  if (!(std::abs(speed) * h > kNarrow * width)) return middle;
  return u / (width * speed * 2 * h) *
         (std::atan(speed * (h - root) / width) + std::atan(speed * (h + root) / width));
}

}  // namespace

double PartialWaves::mean_absorption(const PartialWaves& below, const PartialWaves& above,
                                     double half_width) const {
  const double d = 0.5 * (above.x_ - below.x_);
  double sum = 0;
  for (std::size_t n = std::min({below.a_.size(), a_.size(), above.a_.size()}); n-- > 0;)
    sum += (2 * double(n) + 3) * (mean_absorbed(below.a_[n], a_[n], above.a_[n], d, half_width) +
                                  mean_absorbed(below.b_[n], b_[n], above.b_[n], d, half_width));
  return 2 / (x_ * x_) * sum;
}

MieAmplitudes PartialWaves::amplitudes(double mu) const {
  MieAmplitudes s;
  amplitudes(std::span(&mu, 1), std::span(&s, 1));
  return s;
}

void PartialWaves::amplitudes(std::span<const double> mu, std::span<MieAmplitudes> at,
                              std::span<MieAmplitudes> mirrored) const {
  constexpr std::size_t kLanes = 4;
  using Vector = double __attribute__((vector_size(sizeof(double) * kLanes)));
  for (std::size_t first = 0; first < mu.size(); first += kLanes) {
    const std::size_t lanes = std::min(kLanes, mu.size() - first);
    Vector cosine{};
    for (std::size_t i = 0; i < kLanes; ++i) cosine[i] = mu[first + std::min(i, lanes - 1)];
    // pi_n and tau_n (Bohren & Huffman, equation 4.47): pi_n has the parity of n - 1, tau_n that of n.
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

void PartialWaves::intensities(std::span<const double> mu, std::span<double> at,
                               std::span<double> mirrored) const {
  constexpr std::size_t kLanes = 4;
  using Vector = double __attribute__((vector_size(sizeof(double) * kLanes)));
  // Sums and differences of the amplitudes need half as many products. With p = pi + tau and m = pi - tau
  //     S1 + S2 = sum w (a + b) p,   S1 - S2 = sum w (a - b) m.
  // At -mu, p and m are exchanged, with the sign (-1)^(n - 1).
  struct Step {
    double sum_r, sum_i, difference_r, difference_i;
    double forward, back;  // coefficients of pi_(n+1) = forward mu pi_n - back pi_(n-1)
  };
  std::vector<Step> steps(terms_.size());
  for (std::size_t k = 0; k < terms_.size(); ++k) {
    const Term& t = terms_[k];
    const double per_n = 1 / double(k + 1);
    steps[k] = {t.ar + t.br, t.ai + t.bi, t.ar - t.br, t.ai - t.bi, 2 + per_n, 1 + per_n};
  }
  for (std::size_t first = 0; first < mu.size(); first += kLanes) {
    const std::size_t lanes = std::min(kLanes, mu.size() - first);
    Vector cosine{};
    for (std::size_t i = 0; i < kLanes; ++i) cosine[i] = mu[first + std::min(i, lanes - 1)];
    Vector before{}, pi = cosine * 0 + 1;
    Vector pr{}, pi_{}, mr{}, mi{}, opr{}, opi{}, omr{}, omi{};
    const auto advance = [&](const Step& s, double n, bool odd) __attribute__((always_inline)) {
      const Vector tau = (cosine * pi) * n - before * (n + 1), p = pi + tau, m = pi - tau;
      pr += p * s.sum_r, pi_ += p * s.sum_i, mr += m * s.difference_r, mi += m * s.difference_i;
      if (odd) {
        opr += m * s.sum_r, opi += m * s.sum_i, omr += p * s.difference_r, omi += p * s.difference_i;
      } else {
        opr -= m * s.sum_r, opi -= m * s.sum_i, omr -= p * s.difference_r, omi -= p * s.difference_i;
      }
      const Vector next = (cosine * s.forward) * pi - before * s.back;
      before = pi, pi = next;
    };
    std::size_t k = 0;
    for (; k + 1 < steps.size(); k += 2) {
      advance(steps[k], double(k + 1), true);
      advance(steps[k + 1], double(k + 2), false);
    }
    if (k < steps.size()) advance(steps[k], double(k + 1), true);
    const Vector all = 0.25 * (pr * pr + pi_ * pi_ + mr * mr + mi * mi);
    const Vector opposite = 0.25 * (opr * opr + opi * opi + omr * omr + omi * omi);
    for (std::size_t i = 0; i < lanes; ++i) {
      at[first + i] = all[i];
      if (!mirrored.empty()) mirrored[first + i] = opposite[i];
    }
  }
}

}  // namespace aureole::optics

// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/arrangement/partial_structure_factors.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "aureole/optics/arrangement/cholesky.h"
#include "aureole/optics/bessel.h"
#include "aureole/optics/constants.h"

namespace aureole::optics {
namespace {

/// Number of intervals of a correction between r = 0 and contact.
constexpr int kInside = 8;

/// The positive nodes of the Gauss-Legendre rule with 8 points, and their weights.
constexpr double kNodes[4] = {0.1834346424956498, 0.5255324099163290, 0.7966664774136267, 0.9602898564975363};
constexpr double kWeights[4] = {0.3626837833783620, 0.3137066458778873, 0.2223810344533745,
                                0.1012285362903763};

/// Returns the matrix (1 - C)^-1 of structure factors.
std::vector<double> structure(std::vector<double> direct, int n, bool& definite) {
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) direct[i * n + j] = (i == j) - direct[i * n + j];
  const Cholesky factor(std::move(direct), n);
  definite = factor.is_definite();
  return definite ? factor.inverse() : std::vector<double>();
}

}  // namespace

PartialStructureFactors::PartialStructureFactors(const HardDiscMixture& mixture, double q_max)
    : mixture_(mixture), q_max_(q_max) {
  if (!(q_max > 0 && std::isfinite(q_max)))
    throw std::domain_error("a table of structure factors needs a positive range");
  tabulate();
}

PartialStructureFactors::PartialStructureFactors(const HardDiscMixture& mixture, double q_max,
                                                 const RingStructureFactor& measured)
    : mixture_(mixture), q_max_(q_max) {
  if (!(q_max > 0 && std::isfinite(q_max)))
    throw std::domain_error("a table of structure factors needs a positive range");
  if (measured.classes() != classes() || measured.rings() < 32)
    throw std::domain_error("a fit of structure factors needs 32 rings at least, and the mixture's classes");
  fit(measured);
  tabulate();
}

int PartialStructureFactors::pair(int m, int l) const {
  if (m > l) std::swap(m, l);
  return m * classes() - m * (m - 1) / 2 + (l - m);
}

std::vector<double> PartialStructureFactors::Correction::basis(double q) const {
  std::vector<double> out(coefficients.size(), 0.0);
  for (size_t k = 0; k + 1 < knots.size(); ++k) {
    const double start = knots[k], width = knots[k + 1] - start;
    if (width == 0) continue;
    // Number of Gauss rules of 8 points, one for every 8 rad of q r.
    const int parts = 1 + int(q * width / 8);
    double left = 0, right = 0;
    for (int part = 0; part < parts; ++part)
      for (int i = 0; i < 8; ++i) {
        const double t = (part + 0.5 + 0.5 * (i < 4 ? kNodes[i] : -kNodes[i - 4])) / parts;
        const double r = start + t * width;
        const double w = kPi * kWeights[i % 4] * width / parts * r * bessel_j0(q * r);
        left += w * (1 - t), right += w * t;
      }
    if (k < out.size()) out[k] += left;
    if (k + 1 < out.size()) out[k + 1] += right;
  }
  for (double& v : out) v *= scale;
  return out;
}

void PartialStructureFactors::fit(const RingStructureFactor& measured) {
  const int n = classes(), pairs = n * (n + 1) / 2, rings = measured.rings();
  const double mean = mixture_.mean_radius();
  const double fa = mixture_.area_fraction(), crowding = 1 / ((1 - fa) * (1 - fa) * (1 - fa));
  corrections_.resize(pairs);
  // Effective number of independent wave vectors in each ring; each gives 2 real samples of S.
  std::vector<double> samples(rings);
  std::vector<std::vector<double>> inverse(rings);
  for (int r = 0; r < rings; ++r) {
    double correlated = 0;
    std::vector<double> s(size_t(n) * n);
    for (int m = 0; m < n; ++m) {
      correlated += measured.partial(r, m, m).correlation_time() / n;
      for (int l = 0; l < n; ++l) s[m * n + l] = measured.partial(r, m, l).mean();
    }
    samples[r] = measured.vectors(r) * double(measured.total(r).count()) / std::max(correlated, 1.0);
    const Cholesky factor(std::move(s), n);
    if (!factor.is_definite() || samples[r] < 2 * n + 8) continue;
    inverse[r] = factor.inverse();
    // The factor makes the inverse unbiased, by the mean of an inverse Wishart matrix.
    for (double& v : inverse[r]) v *= (2 * samples[r] - n - 1) / (2 * samples[r]);
  }

  std::vector<std::vector<double>> all_basis(size_t(pairs) * rings), theory(rings);
  for (int m = 0; m < n; ++m)
    for (int l = m; l < n; ++l) {
      Correction& c = corrections_[pair(m, l)];
      const double contact = mixture_.radius(m) + mixture_.radius(l);
      for (int i = 0; i <= kInside; ++i) c.knots.push_back(contact * i / kInside);
      // The second shell becomes sharper towards freezing and needs fine steps.
      for (double beyond = 0; beyond < 12.1; beyond += beyond < 5 ? 0.25 : beyond < 7 ? 0.5 : 1)
        c.knots.push_back(contact + beyond * mean);
      c.coefficients.assign(c.knots.size() - 1, 0.0);
      c.scale = mixture_.density() * std::sqrt(mixture_.fraction(m) * mixture_.fraction(l));
      for (int r = 0; r < rings; ++r) all_basis[pair(m, l) * rings + r] = c.basis(measured.q(r));
    }
  for (int r = 0; r < rings; ++r) theory[r] = theory_matrix(measured.q(r));

  // Errors of 1/S follow from S itself; the second pass takes S from the first fit instead of the noisy data.
  for (int pass = 0; pass < 2; ++pass) {
    std::vector<std::vector<double>> expected(rings);
    for (int r = 0; r < rings; ++r) {
      expected[r] = theory[r];
      if (pass > 0)
        for (int m = 0; m < n; ++m)
          for (int l = 0; l < n; ++l) {
            const Correction& c = corrections_[pair(m, l)];
            const std::vector<double>& b = all_basis[pair(m, l) * rings + r];
            for (size_t i = 0; i < b.size(); ++i) expected[r][m * n + l] += c.coefficients[i] * b[i];
          }
      for (int m = 0; m < n; ++m)
        for (int l = 0; l < n; ++l) expected[r][m * n + l] = (m == l) - expected[r][m * n + l];
    }
    double squares = 0;
    std::int64_t data = 0;
    for (int m = 0; m < n; ++m)
      for (int l = m; l < n; ++l) {
        Correction& c = corrections_[pair(m, l)];
        const int size = int(c.coefficients.size());
        const double contact = mixture_.radius(m) + mixture_.radius(l);
        std::vector<double> normal(size_t(size) * size, 0.0), right(size, 0.0), weight(rings, 0.0);
        // The prior's standard deviation is the order of magnitude that a correction can have. It only
        // suppresses noise in combinations of coefficients that the data do not determine.
        for (int i = 0; i < size; ++i) {
          const double beyond = (c.knots[i] - contact) / mean;
          const double prior = i <= kInside ? 0.3 * fa * crowding + 0.01
                                            : (0.5 * fa * fa * crowding + 0.01) * std::exp(-beyond / 1.6);
          normal[i * size + i] = 1 / (prior * prior);
        }
        for (int r = 0; r < rings; ++r) {
          if (inverse[r].empty()) continue;
          const double* p = expected[r].data();
          const double variance =
              (p[m * n + m] * p[l * n + l] + p[m * n + l] * p[m * n + l]) / (2 * samples[r]);
          if (!(variance > 0)) continue;
          weight[r] = 1 / variance;
          const std::vector<double>& b = all_basis[pair(m, l) * rings + r];
          const double residual = (m == l) - inverse[r][m * n + l] - theory[r][m * n + l];
          for (int i = 0; i < size; ++i) {
            right[i] += weight[r] * residual * b[i];
            for (int j = 0; j <= i; ++j) normal[i * size + j] += weight[r] * b[i] * b[j];
          }
        }
        const Cholesky factor(std::move(normal), size);
        if (!factor.is_definite()) throw std::domain_error("the fit of structure factors is singular");
        c.coefficients = factor.solve(right);
        c.covariance = factor.inverse();
        for (int r = 0; r < rings; ++r) {
          if (weight[r] == 0) continue;
          const std::vector<double>& b = all_basis[pair(m, l) * rings + r];
          double residual = (m == l) - inverse[r][m * n + l] - theory[r][m * n + l];
          for (int i = 0; i < size; ++i) residual -= c.coefficients[i] * b[i];
          squares += weight[r] * residual * residual;
          ++data;
        }
      }
    chi_squared_ = squares / double(std::max<std::int64_t>(data, 1));
  }
}

std::vector<double> PartialStructureFactors::theory_matrix(double q) const {
  const int n = classes();
  std::vector<double> direct(size_t(n) * n);
  for (int m = 0; m < n; ++m)
    for (int l = m; l < n; ++l) direct[m * n + l] = direct[l * n + m] = mixture_.direct(m, l, q);
  return direct;
}

void PartialStructureFactors::tabulate() {
  const int n = classes(), pairs = n * (n + 1) / 2;
  const int cells =
      int(std::ceil(q_max_ * std::max(16 * mixture_.largest_radius(), 32.0 * mixture_.mean_radius())));
  step_ = q_max_ / cells;
  values_.resize(size_t(pairs) * (cells + 1));
  errors_.assign(values_.size(), 0.0f);
  for (int k = 0; k <= cells; ++k) {
    const double q = k * step_;
    // Towards the end of the table the correction and all but the first order of C fade out, so that `eval`
    // is continuous there.
    const double t = std::clamp(4 * (q / q_max_ - 0.75), 0.0, 1.0), fade = 1 - t * t * (3 - 2 * t);
    const std::vector<double> theory = theory_matrix(q);
    // correction of C and its variance
    std::vector<double> correction(theory.size(), 0.0), variance(pairs, 0.0);
    for (int m = 0; m < n && !corrections_.empty(); ++m)
      for (int l = m; l < n; ++l) {
        const Correction& c = corrections_[pair(m, l)];
        const std::vector<double> b = c.basis(q);
        double value = 0, sum = 0;
        for (size_t i = 0; i < b.size(); ++i) {
          value += c.coefficients[i] * b[i];
          for (size_t j = 0; j < b.size(); ++j) sum += b[i] * b[j] * c.covariance[i * b.size() + j];
        }
        correction[m * n + l] = correction[l * n + m] = value;
        variance[pair(m, l)] = sum * std::max(1.0, chi_squared_);
      }
    bool definite = false;
    std::vector<double> s;
    for (double weight = fade; !definite; weight = weight > 0.01 ? weight / 2 : 0) {
      std::vector<double> direct = theory;
      for (size_t i = 0; i < direct.size(); ++i) direct[i] += weight * correction[i];
      s = structure(std::move(direct), n, definite);
      if (!definite && weight == 0) throw std::domain_error("the theory of hard discs is unstable here");
    }
    for (int m = 0; m < n; ++m)
      for (int l = m; l < n; ++l) {
        const double first = (m == l) + theory[m * n + l];
        values_[size_t(pair(m, l)) * (cells + 1) + k] = float(fade * s[m * n + l] + (1 - fade) * first);
      }
    if (corrections_.empty()) continue;
    for (int m = 0; m < n; ++m)
      for (int l = m; l < n; ++l) {
        double sum = 0;  // error of S by dS = S dC S
        for (int i = 0; i < n; ++i)
          for (int j = i; j < n; ++j) {
            double slope = s[m * n + i] * s[j * n + l];
            if (i != j) slope += s[m * n + j] * s[i * n + l];
            sum += slope * slope * variance[pair(i, j)];
          }
        errors_[size_t(pair(m, l)) * (cells + 1) + k] = float(fade * std::sqrt(sum));
      }
  }
}

double PartialStructureFactors::look_up(const std::vector<float>& table, int pair, double q) const {
  const int cells = int(table.size() / (size_t(classes()) * (classes() + 1) / 2)) - 1;
  const float* v = &table[size_t(pair) * (cells + 1)];
  const double at = q / step_;
  const int i = std::min(int(at), cells - 1);
  const double t = at - i;
  // Catmull-Rom spline; the function is even about 0.
  const double a = i > 0 ? v[i - 1] : v[1], b = v[i], c = v[i + 1], d = i + 2 <= cells ? v[i + 2] : 2 * c - b;
  return b + 0.5 * t * (c - a + t * (2 * a - 5 * b + 4 * c - d + t * (3 * (b - c) + d - a)));
}

double PartialStructureFactors::eval(int m, int l, double q) const {
  q = std::abs(q);
  if (q < q_max_) {
    const double s = look_up(values_, pair(m, l), q);
    return m == l ? std::max(s, 0.0) : s;
  }
  return (m == l) + mixture_.direct(m, l, q);
}

double PartialStructureFactors::error(int m, int l, double q) const {
  q = std::abs(q);
  return q < q_max_ ? std::max(0.0, look_up(errors_, pair(m, l), q)) : 0;
}

}  // namespace aureole::optics

// SPDX-License-Identifier: Apache-2.0
// `RadialFunction`: a smooth function of u >= 0 for look-up in single precision, without transcendental
// functions. `RadialDistribution`: a density over u that is sampled exactly.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace aureole::optics {

/// Cells of [0, end]: `kFine` per unit up to kSplit, `kCoarse` per unit beyond.
template <int kFine, int kCoarse>
struct RadialCells {
  static constexpr int kSplit = 64;
  static constexpr int kFineCells = kSplit * kFine;

  static int count(int end) { return end <= kSplit ? end * kFine : kFineCells + (end - kSplit) * kCoarse; }
  static double start(int i) {
    return i < kFineCells ? double(i) / kFine : kSplit + double(i - kFineCells) / kCoarse;
  }
  static double width(int i) { return i < kFineCells ? 1.0 / kFine : 1.0 / kCoarse; }
  /// Finds the cell that contains u, and the position of u in it as a fraction. The linear index functions of
  /// both ranges cross at kSplit and the smaller one applies, which saves a branch.
  template <class Real>
  static int find(Real u, Real& fraction) {
    const Real fine = u * Real(kFine), coarse = u * Real(kCoarse) + Real(kFineCells - kSplit * kCoarse);
    const Real position = fine < coarse ? fine : coarse;
    const int index = static_cast<int>(position);
    fraction = position - static_cast<Real>(index);
    return index;
  }
};

/// A cubic in each cell, through four of its points. It suits functions without frequencies above 2, such as
/// the squared transforms of shapes within a circle of radius 1. For a sinusoid of that frequency the error
/// is 2e-7 of its amplitude up to u = 64 and 5e-5 beyond, including rounding to single precision.
class RadialFunction {
public:
  /// A function without a table, to be read.
  RadialFunction() = default;
  /// Tabulates f over [0, end]; `end` is a whole number. Beyond `end` the function is c/u^3, with c the mean
  /// of f u^3 over the last sixteenth: which is Porod's law for shapes with an edge. With `decays` false the
  /// function is 0 there, for functions that oscillate about 0.
  RadialFunction(const std::function<double(double)>& f, int end, bool decays);
  /// Makes the table from the values of f at `places(end)`.
  RadialFunction(const std::vector<double>& values, int end, bool decays);
  static std::vector<double> places(int end);

  /// Returns the function at u >= 0. GCC vectorises a loop over it by gathers.
  float eval(float u) const {
    const float inside = u < end_ ? u : last_;
    float t;
    const float* k = &coefficients_[4 * std::size_t(Cells::find(inside, t))];
    const float value = ((k[3] * t + k[2]) * t + k[1]) * t + k[0];
    return u < end_ ? value : tail_ / (u * u * u);
  }
  int end() const { return int(end_); }
  std::size_t bytes() const { return coefficients_.size() * sizeof(float); }
  /// Calls `all` with the members, for tables that are kept; `self` is constant or not.
  template <class Self, class Fields>
  static void fields(Self& self, Fields& all) {
    all(self.coefficients_, self.end_, self.last_, self.tail_);
  }

private:
  using Cells = RadialCells<16, 4>;
  std::vector<float> coefficients_;
  float end_ = 0, last_ = 0, tail_ = 0;
};

/// A density over u that is linear in each of its cells up to `end` and falls as 1/u^2 beyond, with its
/// cumulative distribution. Samples follow exactly the density that `eval` returns.
class RadialDistribution {
public:
  /// A distribution without a table, to be read.
  RadialDistribution() = default;
  /// `density` returns u g(u) >= 0 up to a constant factor; beyond `end` it is `tail`/u^2 with that factor.
  RadialDistribution(const std::function<double(double)>& density, int end, double tail);

  /// Returns g(u), normalised so that the integral of u g(u) du over [0, infinity) is 1.
  float eval(float u) const {
    u = u > 1e-15f ? u : 1e-15f;
    return density(u) / u;
  }
  /// Returns the integral of u' g(u') du' over [0, u], in [0, 1].
  double cdf(double u) const;
  /// Returns the u in [0, u_max] with cdf(u) = xi cdf(u_max), for xi in [0, 1) and u_max > 0.
  double sample(double xi, double u_max) const;
  std::size_t bytes() const { return nodes_.size() * 4 + power_.size() * 8 + guide_.size() * 4; }
  /// Calls `all` with the members, for tables that are kept; `self` is constant or not.
  template <class Self, class Fields>
  static void fields(Self& self, Fields& all) {
    all(self.end_, self.nodes_, self.power_, self.guide_, self.tail_, self.total_);
  }

private:
  using Cells = RadialCells<64, 4>;

  template <class Real>
  Real density(Real u) const {
    const Real inside = u < Real(end_) ? u : Real(end_);
    Real t;
    const int i = Cells::find(inside, t);
    const Real a = static_cast<Real>(nodes_[i]), b = static_cast<Real>(nodes_[i + 1]);
    const Real decay = inside / u;  // the factor is 1 inside the table
    return (a + t * (b - a)) * decay * decay;
  }

  int end_ = 0;
  /// Values at the start of each cell and at end_; `eval` reads one more value with weight 0.
  std::vector<float> nodes_;
  std::vector<double> power_;  ///< integral up to the start of each cell and up to end_
  /// cell in which a search starts, at equal steps of the cumulative distribution
  std::vector<std::uint32_t> guide_;
  double tail_ = 0, total_ = 0;
};

}  // namespace aureole::optics

// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/stack/operators.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "aureole/optics/interface/fresnel_equations.h"

namespace aureole::optics {
namespace {

Matrix symmetric(const Matrix& a) { return 0.5 * (a + a.transpose()); }

/// Returns (1 - a b)^-1, all orders of interreflection between two parts. A channel with total reflection
/// from both, as in the glass of a slide, has neither light nor an inverse, so its row is omitted.
Eigen::PartialPivLU<Matrix> interreflection(const Matrix& a, const Matrix& b) {
  Matrix m = -product(a, b);
  m.diagonal() = m.diagonal().unaryExpr([](double x) { return x == -1 ? 1 : 1 + x; });
  return m.partialPivLu();
}

}  // namespace

Matrix product(const Matrix& a, const Matrix& b) { return a * b; }
Matrix inverse(const Matrix& a) { return a.inverse(); }

Operators Operators::stacked(const Operators& upper, const Operators& lower) {
  const auto orders = interreflection(upper.r_below, lower.r_above);
  const Matrix down = orders.solve(upper.t_down),
               back = orders.solve(product(upper.r_below, lower.t_down.transpose()));
  return {symmetric(upper.r_above + product(upper.t_down.transpose(), product(lower.r_above, down))),
          product(lower.t_down, down), symmetric(lower.r_below + product(lower.t_down, back))};
}

FieldBetween::FieldBetween(const Operators& upper, const Operators& lower, const Matrix& from_above,
                           const Matrix& from_below) {
  const Matrix up_first = product(lower.t_down.transpose(), from_below),
               down_first = product(upper.t_down, from_above) + product(upper.r_below, up_first);
  down = interreflection(upper.r_below, lower.r_above).solve(down_first);
  up = up_first + product(lower.r_above, down);
}

Vector root_etendues(const Channels& channels, double index) {
  Vector root(channels.count(index));
  for (int i = 0; i < root.size(); ++i) root[i] = std::sqrt(channels.etendue(i));
  return root;
}

UniformLayer::UniformLayer(const Channels& channels, double index, double albedo, std::vector<double> moments)
    : count_(channels.count(index)),
      albedo_(albedo),
      moments_(std::move(moments)),
      mu_(count_),
      root_etendue_(root_etendues(channels, index)),
      scale_(albedo / (4 * std::numbers::pi * index * index)),
      forward_(Vector::Zero(count_)) {
  for (int i = 0; i < count_; ++i) mu_[i] = channels.mu(i, index);
  // A quadrature with nodes mapped by refraction misses some scattered light, or counts an excess. The
  // difference is added to the forward direction (Grant & Hunt 1969, Proc. R. Soc. A 313, 183; Wiscombe 1976,
  // J. Quant. Spectrosc. Radiat. Transfer 16, 637): energy is exact, and reciprocity is kept. With the double
  // Gauss rule only rounding errors are corrected.
  const Vector lost = rates(0).difference * root_etendue_;
  forward_ = lost.array() / root_etendue_.array() - (1 - albedo) / mu_.array();
}

bool UniformLayer::scatters(int mode) const {
  return albedo_ > 0 && std::any_of(moments_.begin() + std::min<std::size_t>(mode, moments_.size()),
                                    moments_.end(), [](double chi) { return chi != 0; });
}

UniformLayer::Rates UniformLayer::rates(int mode) const {
  Rates rates{Matrix::Zero(count_, count_), Matrix::Zero(count_, count_)};
  // Normalised associated Legendre functions sqrt((l - m)!/(l + m)!) P_l^m, times sqrt(e)/mu. In the addition
  // theorem mu -> -mu gives each term the sign (-1)^(l + m), so terms of one parity contribute only to A - B,
  // the others to A + B.
  const int terms = int(moments_.size()) - mode;
  if (scatters(mode)) {
    Matrix even(count_, (terms + 1) / 2), odd(count_, terms / 2);
    Vector even_weight((terms + 1) / 2), odd_weight(terms / 2);
    Eigen::ArrayXd before = Eigen::ArrayXd::Zero(count_), p = root_etendue_.array() / mu_.array();
    const Eigen::ArrayXd sine = (1 - mu_.array().square()).sqrt();
    for (int k = 1; k <= mode; ++k) p *= sine * std::sqrt((2 * k - 1.0) / (2 * k));
    for (int l = mode; l < int(moments_.size()); ++l) {
      const int i = l - mode;
      (i % 2 ? odd : even).col(i / 2) = p;
      (i % 2 ? odd_weight : even_weight)[i / 2] = 2 * scale_ * (2 * l + 1) * moments_[l];
      const Eigen::ArrayXd next =
          ((2 * l + 1) * mu_.array() * p - std::sqrt(double(l - mode) * (l + mode)) * before) /
          std::sqrt(double(l + 1 - mode) * (l + 1 + mode));
      before = p, p = next;
    }
    rates.difference = -product(even * even_weight.asDiagonal(), even.transpose());
    rates.sum = -product(odd * odd_weight.asDiagonal(), odd.transpose());
  }
  const Vector out = mu_.cwiseInverse() - forward_;
  rates.difference.diagonal() += out;
  rates.sum.diagonal() += out;
  return rates;
}

Operators UniformLayer::attenuation(double optical_thickness) const {
  const Vector pass = (-optical_thickness * (mu_.cwiseInverse() - forward_)).array().exp();
  return {Matrix::Zero(count_, count_), pass.asDiagonal(), Matrix::Zero(count_, count_)};
}

// With s = x_down + x_up and d = x_down - x_up the equation of transfer is
//     ds/dtau = -(A + B) d,   dd/dtau = -(A - B) s.
// For equal light incident from both sides d = E s at the upper face, E = (A - B) tanh(h G)/G. For opposite
// light s = O d, O = tanh(h G)/G (A + B). Here G^2 = (A + B)(A - B) and h is half of the thickness.
// For a thin layer tanh(z)/z is the third approximant of Lambert's continued fraction (Abramowitz & Stegun
// 1964, 4.5.70). Thicker layers follow by doubling, tanh(2 z) = 2 tanh(z)/(1 + tanh(z)^2). D = 1 - tanh(z)^2
// is computed along with it, so that the transmittance of thick layers keeps its relative precision.
// At albedo 1 the fluxes sqrt(e) are a left null vector of A - B and of E, whatever the other rounding
// errors. So energy does not drift with the number of doublings, as it does if reflection and transmission
// are doubled.
Operators UniformLayer::operators(double optical_thickness, int mode) const {
  if (!(optical_thickness > 0) || !scatters(mode)) return attenuation(optical_thickness);
  const auto [sum, difference] = rates(mode);
  constexpr double kThin = 0.25;  // Largest z of the approximant, which has an error of 1e-13 there.
  const double rate = mu_.cwiseInverse().maxCoeff();
  const int doublings = std::max(0, int(std::ceil(std::log2(0.5 * optical_thickness * rate / kThin))));
  const double half = std::ldexp(0.5 * optical_thickness, -doublings);

  const Matrix one = Matrix::Identity(count_, count_), x = (half * half) * product(sum, difference),
               x2 = product(x, x);
  const Eigen::PartialPivLU<Matrix> below(Matrix(one + (4.0 / 9) * x + x2 / 63));
  const Matrix tanh_over = below.solve(Matrix(half * one + (half / 9) * x + (half / 945) * x2));
  Matrix even = symmetric(product(difference, tanh_over)), odd = symmetric(product(tanh_over, sum));
  Matrix rest = one - product(even, odd);
  for (int i = 0; i < doublings; ++i) {
    const Matrix inverted = inverse(one + product(even, odd)), root = product(inverted, rest);
    even = symmetric(2 * product(inverted, even));
    odd = symmetric(2 * product(odd, inverted));
    rest = product(root, root);
  }
  const Matrix from_even = inverse(one + even), from_odd = inverse(one + odd);
  const Matrix r = symmetric(product(product(from_even, odd - even), from_odd)),
               t = symmetric(product(product(from_even, rest), from_odd));
  return {r, t, r};
}

Operators smooth_interface(const Channels& channels, double index_above, double index_below) {
  const int above = channels.count(index_above), below = channels.count(index_below);
  Vector r_above = Vector::Ones(above), r_below = Vector::Ones(below);
  Matrix t = Matrix::Zero(below, above);
  for (int i = 0; i < std::min(above, below); ++i) {
    // The reflectance is equal from both sides; computed from the side of lower index, it is accurate at
    // grazing angles.
    const double n = std::min(index_above, index_below);
    r_above[i] = r_below[i] = fresnel_reflectance(channels.mu(i, n), n, std::max(index_above, index_below));
    t(i, i) = 1 - r_above[i];
  }
  return {r_above.asDiagonal(), t, r_below.asDiagonal()};
}

Operators lambertian_substrate(const Channels& channels, double index, double reflectance, int mode) {
  const Vector root = root_etendues(channels, index);
  const int n = int(root.size());
  Matrix r = Matrix::Zero(n, n);
  if (mode == 0) r = root * root.transpose() * (reflectance / (std::numbers::pi * index * index));
  return {r, Matrix::Zero(0, n), Matrix::Zero(0, 0)};
}

std::vector<Matrix> substrate_kernels(const Channels& channels, double index,
                                      const std::function<double(double, double, double)>& brdf, int modes) {
  const Vector root = root_etendues(channels, index);
  const int n = int(root.size());
  constexpr int kWithin = 2;
  std::vector<Quadrature> within;
  for (int i = 0; i < n; ++i) within.push_back(channels.within(i, index, kWithin));
  // The substitution phi = pi t^2 puts many nodes near azimuth 0, where lobes are.
  const Quadrature turn = gauss_legendre(32 + modes, 0, 1);
  const int steps = int(turn.x.size());
  Matrix by_mode(modes, steps);
  for (int k = 0; k < steps; ++k)
    for (int m = 0; m < modes; ++m)
      by_mode(m, k) = 2 * turn.x[k] * turn.weight[k] * std::cos(m * std::numbers::pi * turn.x[k] * turn.x[k]);
  std::vector<Matrix> kernels(modes, Matrix::Zero(n, n));
  Vector values(steps);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j <= i; ++j) {
      values.setZero();
      for (std::size_t a = 0; a < within[i].x.size(); ++a)
        for (std::size_t b = 0; b < within[j].x.size(); ++b)
          for (int k = 0; k < steps; ++k)
            values[k] += within[i].weight[a] * within[j].weight[b] *
                         brdf(within[i].x[a], within[j].x[b], std::numbers::pi * turn.x[k] * turn.x[k]);
      const Vector means = by_mode * values * (root[i] * root[j] / (index * index));
      for (int m = 0; m < modes; ++m) kernels[m](i, j) = kernels[m](j, i) = means[m];
    }
  const Vector keeps = (kernels[0] * root).cwiseQuotient(root).unaryExpr([](double r) {
    return 1 / std::sqrt(std::max(1.0, r));
  });
  const double least = keeps.minCoeff();
  if (least < 1)
    for (Matrix& k : kernels) k *= least * least;
  return kernels;
}

}  // namespace aureole::optics

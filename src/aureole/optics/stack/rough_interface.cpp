// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/stack/rough_interface.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "aureole/optics/constants.h"
#include "aureole/optics/gauss_legendre.h"
#include "aureole/optics/interface/fresnel_equations.h"

namespace aureole::optics {
namespace {

/// Isotropic microfacets of one roughness; normals are given by their cosine.
class Facets {
public:
  explicit Facets(const StackInterface& interface) : kind_(interface.kind), alpha_(interface.alpha) {}

  /// Returns the density of normals, 1/sr (Walter et al. 2007, (25), (33)).
  double density(double cosine) const {
    const double c2 = cosine * cosine, t2 = (1 - c2) / (c2 * alpha_ * alpha_),
                 unit = 1 / (kPi * alpha_ * alpha_ * c2 * c2);
    return kind_ == InterfaceKind::ggx ? unit / ((1 + t2) * (1 + t2)) : unit * std::exp(-t2);
  }
  /// Returns Smith's G1 of a direction (Walter et al. 2007, (34); for Beckmann the exact form, Smith 1967).
  double unmasked(double cosine) const {
    const double t = alpha_ * std::sqrt(1 - cosine * cosine) / cosine;
    if (t == 0) return 1;
    if (kind_ == InterfaceKind::ggx) return 2 / (1 + std::sqrt(1 + t * t));
    const double a = 1 / t;
    return 2 / (1 + std::erf(a) + std::exp(-a * a) / (a * std::sqrt(kPi)));
  }

private:
  InterfaceKind kind_;
  double alpha_;
};

/// A direction, on one side of the interface.
struct Side {
  double index, mu;
  bool is_above;
  double unmasked = 1;  ///< Smith's masking function G1
};

/// Returns the basic radiance that leaves along `o`, per flux incident along `i`; symmetric in both.
class Kernel {
public:
  Kernel(const Facets& facets, double index_above, double index_below)
      : facets_(facets), index_above_(index_above), index_below_(index_below) {}

  double operator()(const Side& i, const Side& o, double cos_phi) const {
    // Both directions point away from the interface, so their azimuth is the azimuth of propagation plus half
    // a turn.
    const double sine_i = std::sqrt(1 - i.mu * i.mu), sine_o = std::sqrt(1 - o.mu * o.mu);
    const double along = -sine_i * sine_o * cos_phi;
    const double mask = i.unmasked * o.unmasked;
    if (i.is_above == o.is_above) {
      const double dot = along + i.mu * o.mu, length = std::sqrt(2 + 2 * dot);
      const double m = (i.mu + o.mu) / length;  // cosine of the facet's normal
      const double reflected =
          fresnel_reflectance(std::min(1.0, length / 2), i.index, i.is_above ? index_below_ : index_above_);
      return reflected * facets_.density(m) * mask / (4 * i.mu * o.mu * i.index * i.index);
    }
    // The half vector n_i i + n_o o, on the side of lower index; `i` and `o` are on opposite sides of the
    // facet.
    const double dot = along - i.mu * o.mu;
    const double square = i.index * i.index + o.index * o.index + 2 * i.index * o.index * dot;
    if (!(square > 0)) return 0;
    const double length = std::sqrt(square), sign = i.index > o.index ? 1 : -1;
    const double at_i = sign * (i.index + o.index * dot) / length,
                 at_o = sign * (i.index * dot + o.index) / length;
    const double m = sign * (i.index * i.mu - o.index * o.mu) / length;
    if (!(at_i > 0 && at_o < 0 && m > 0)) return 0;
    const double passed = 1 - fresnel_reflectance(std::min(1.0, at_i), i.index, o.index);
    return passed * facets_.density(m) * mask * at_i * -at_o / (i.mu * o.mu * square);
  }

  /// Returns the slope of the least tilted normal that reflects or refracts `i` into `o`, at azimuth 0.
  double slope(const Side& i, const Side& o) const {
    const double sine_i = std::sqrt(1 - i.mu * i.mu), sine_o = std::sqrt(1 - o.mu * o.mu);
    const double along = i.index * sine_i - o.index * sine_o;
    return std::abs(along / (i.index * i.mu + (i.is_above == o.is_above ? 1 : -1) * o.index * o.mu));
  }

private:
  Facets facets_;
  double index_above_, index_below_;
};

/// The directions of a channel: its central one and others in its range, which resolve lobes narrower than
/// the range.
struct Row {
  struct Part {
    Side side;
    double weight;
  };
  Part middle;
  std::vector<Part> within;
  double width;  ///< width of the range of directions [rad]
};

}  // namespace

std::vector<Operators> rough_interface(const Channels& channels, double index_above, double index_below,
                                       const StackInterface& interface, int modes) {
  const int above = channels.count(index_above), below = channels.count(index_below), all = above + below;
  const Facets facets(interface);
  const Kernel kernel(facets, index_above, index_below);
  const auto channel_of = [&](int row) { return row < above ? row : row - above; };
  const auto index_of = [&](int row) { return row < above ? index_above : index_below; };

  // Width of the lobe: refraction deflects light by less than the tilt of the facets.
  const double contrast = std::abs(index_above - index_below) / std::max(index_above, index_below);
  const double lobe = interface.alpha * contrast;
  std::vector<Row> rows;
  Vector root(all);
  for (int row = 0; row < all; ++row) {
    const int channel = channel_of(row);
    root[row] = std::sqrt(channels.etendue(channel));
    const double n = index_of(row);
    const double width = channels.is_extra(channel) ? 0 : channels.width(channel, n);
    const auto side = [&](double mu) { return Side{n, mu, row < above, facets.unmasked(mu)}; };
    rows.push_back({{side(channels.mu(channel, n)), 1}, {}, width});
    const Quadrature q = channels.within(channel, n, std::clamp(int(std::ceil(2 * width / lobe)), 2, 8));
    for (std::size_t i = 0; i < q.x.size(); ++i) rows[row].within.push_back({side(q.x[i]), q.weight[i]});
  }
  // The substitution phi = pi t^2 puts many nodes near azimuth 0, where lobes are.
  const Quadrature turn = gauss_legendre(64 + 2 * modes, 0, 1);
  const int steps = int(turn.x.size());
  std::vector<double> cos_phi;
  Matrix by_mode(modes, steps);
  for (int k = 0; k < steps; ++k) {
    const double phi = kPi * turn.x[k] * turn.x[k];
    cos_phi.push_back(std::cos(phi));
    for (int m = 0; m < modes; ++m) by_mode(m, k) = 2 * turn.x[k] * turn.weight[k] * std::cos(m * phi);
  }

  std::vector<Matrix> kernels(modes, Matrix::Zero(all, all));
  for (int i = 0; i < all; ++i)
    for (int j = 0; j <= i; ++j) {
      const double reach = 4 * interface.alpha + (rows[i].width + rows[j].width) / (2 * contrast);
      const bool is_near = kernel.slope(rows[i].middle.side, rows[j].middle.side) < reach;
      using Parts = std::span<const Row::Part>;
      const Parts to = is_near ? Parts(rows[i].within) : Parts(&rows[i].middle, 1),
                  from = is_near ? Parts(rows[j].within) : Parts(&rows[j].middle, 1);
      Vector values = Vector::Zero(steps);
      for (const Row::Part& a : to)
        for (const Row::Part& b : from)
          for (int k = 0; k < steps; ++k)
            values[k] += a.weight * b.weight * kernel(a.side, b.side, cos_phi[k]);
      const Vector means = by_mode * values * (root[i] * root[j]);
      for (int m = 0; m < modes; ++m) kernels[m](i, j) = kernels[m](j, i) = means[m];
    }

  // Correction for energy conservation: the matrix times `root` must be `root`.
  Matrix& mean = kernels[0];
  const Vector missing = (root - mean * root).cwiseMax(0);
  const double sum = missing.dot(root);
  if (sum > 0) mean += missing * missing.transpose() / sum;
  Vector factor = Vector::Ones(all);
  for (int k = 0; k < 1000; ++k) {
    const Vector got = factor.cwiseProduct(mean * factor.cwiseProduct(root));
    if ((got.array() / root.array() - 1).abs().maxCoeff() < 1e-14) break;
    factor.array() *= (root.array() / got.array()).sqrt();
  }
  std::vector<Operators> result;
  Vector rest;
  for (int m = 0; m < modes; ++m) {
    Matrix scaled = factor.asDiagonal() * kernels[m] * factor.asDiagonal();
    if (m == 0) rest = (root - scaled * root).cwiseQuotient(root);
    scaled.diagonal() += rest;
    result.push_back({scaled.topLeftCorner(above, above), scaled.bottomLeftCorner(below, above),
                      scaled.bottomRightCorner(below, below)});
  }
  return result;
}

}  // namespace aureole::optics

// SPDX-License-Identifier: Apache-2.0
// The transform of a polygon, by the divergence theorem a sum over its edges e_j with midpoints v_j:
//   F(q) = (i/|q|^2) sum_j (q x e_j) sinc(q.e_j/2) exp(-i q.v_j)
// (Lee & Mittra 1983, "Fourier transform of a polygonal shape function and its application in
// electromagnetics", IEEE Trans. Antennas Propag. 31(1)). It needs one exponential per vertex:
// with E_j = exp(-i q.p_j) of the edge's ends and h = q.e_j/2,
//   sinc(h) exp(-i q.v_j) = (E_j - E_j+1)/(2 i h) = (E_j + E_j+1)/2 tan(h)/h,
// the second form where h is small and the difference cancels. Near q = 0 the sum itself cancels, and a power
// series with the moments of the polygon takes its place.
#include "aureole/optics/aperture/polygon_aperture.h"

#include <algorithm>
#include <boost/math/quadrature/gauss.hpp>
#include <cmath>

#include "aureole/optics/lanes.h"

namespace aureole::optics {

namespace {

/// Power series of tan(h)/h for h^2 < 1/64.
Lanes tangent_over_argument(const Lanes& h2) {
  Lanes t = h2 * (929569 / 638512875.0) + 21844 / 6081075.0;
  t = t * h2 + 1382 / 155925.0;
  t = t * h2 + 62 / 2835.0;
  t = t * h2 + 17 / 315.0;
  t = t * h2 + 2 / 15.0;
  t = t * h2 + 1 / 3.0;
  return t * h2 + 1;
}

double sum(const Lanes& v) { return (v[0] + v[1]) + (v[2] + v[3]); }

}  // namespace

PolygonAperture::PolygonAperture(const PolygonRegion& region)
    : area_(region.area()), bounding_radius_(0), centroid_(region.centroid()), radius_(0) {
  for (const Ring& ring : region.rings()) {
    const std::size_t first = x_.size();
    for (const PlanePoint& p : ring) {
      bounding_radius_ = std::max(bounding_radius_, std::hypot(p.x, p.y));
      radius_ = std::max(radius_, std::hypot(p.x - centroid_.x, p.y - centroid_.y));
      x_.push_back(p.x);
      y_.push_back(p.y);
    }
    x_.push_back(x_[first]);
    y_.push_back(y_[first]);
    for (std::size_t i = first; i + 1 < x_.size(); ++i) {
      edge_x_.push_back(x_[i + 1] - x_[i]);
      edge_y_.push_back(y_[i + 1] - y_[i]);
    }
    edge_x_.push_back(0);
    edge_y_.push_back(0);
  }

  // Moments: integral of x^a y^b dA = sum_j (p_j x e_j)/(a + b + 2) integral over the edge of x^a y^b dt. The
  // integrand is a polynomial of degree a + b, which Gauss quadrature integrates exactly.
  moments_.assign((kOrder + 1) * (kOrder + 2) / 2, 0.0);
  using Rule = boost::math::quadrature::gauss<double, kOrder / 2 + 2>;
  double power_x[kOrder + 1] = {1}, power_y[kOrder + 1] = {1};
  for (std::size_t i = 0; i < x_.size(); ++i) {
    const double x = (x_[i] - centroid_.x) / radius_, y = (y_[i] - centroid_.y) / radius_,
                 ex = edge_x_[i] / radius_, ey = edge_y_[i] / radius_;
    const double cross = x * ey - y * ex;
    for (std::size_t k = 0; k < Rule::abscissa().size(); ++k)
      for (int side : {-1, 1}) {
        const double t = 0.5 * (1 + side * Rule::abscissa()[k]);
        for (int n = 1; n <= kOrder; ++n) {
          power_x[n] = power_x[n - 1] * (x + t * ex) / n;
          power_y[n] = power_y[n - 1] * (y + t * ey) / n;
        }
        const double weight = 0.5 * Rule::weights()[k] * cross * radius_ * radius_;
        for (int n = 0, at = 0; n <= kOrder; ++n)
          for (int a = 0; a <= n; ++a, ++at)
            moments_[at] += ((n & 2) ? -weight : weight) / (n + 2) * power_x[a] * power_y[n - a];
      }
  }

  while (x_.size() % kLanes != 0)
    x_.push_back(x_.back()), y_.push_back(y_.back()), edge_x_.push_back(0), edge_y_.push_back(0);
}

std::complex<double> PolygonAperture::series(double qx, double qy) const {
  const double ux = qx * radius_, uy = qy * radius_;
  double power_x[kOrder + 1], power_y[kOrder + 1];
  power_x[0] = power_y[0] = 1;
  for (int n = 1; n <= kOrder; ++n) {
    power_x[n] = power_x[n - 1] * ux;
    power_y[n] = power_y[n - 1] * uy;
  }
  double even = 0, odd = 0;
  const double* moment = moments_.data();
  for (int n = 0; n <= kOrder; ++n) {
    double order = 0;
    for (int a = 0; a <= n; ++a) order += *moment++ * power_x[a] * power_y[n - a];
    (n & 1 ? odd : even) += order;
  }
  return std::complex<double>(even, -odd) * std::polar(1.0, -(qx * centroid_.x + qy * centroid_.y));
}

std::complex<double> PolygonAperture::transform(double qx, double qy) const {
  const double q2 = qx * qx + qy * qy;
  // Below the threshold the remainder of the series is 1/17! of the area; above it the sum loses one or two
  // digits.
  if (!(q2 * radius_ * radius_ > 1)) return series(qx, qy);
  constexpr std::size_t kBlock = 64;
  double cosines[kBlock + kLanes], sines[kBlock + kLanes];
  Lanes real{}, imaginary{};
  const std::size_t count = x_.size();
  const auto exponentials = [&](std::size_t i, double* cosine, double* sine) {
    Lanes s, c;
    sine_cosine(load_lanes(&x_[i]) * qx + load_lanes(&y_[i]) * qy, s, c);
    store_lanes(cosine, c);
    store_lanes(sine, s);
  };
  for (std::size_t begin = 0; begin < count; begin += kBlock) {
    const std::size_t size = std::min(kBlock, count - begin);
    for (std::size_t i = 0; i < size; i += kLanes) exponentials(begin + i, cosines + i, sines + i);
    // The last edge of the block also needs its end point.
    if (begin + size < count)
      exponentials(begin + size, cosines + size, sines + size);
    else
      cosines[size] = sines[size] = 0;
    for (std::size_t i = 0; i < size; i += kLanes) {
      const Lanes ex = load_lanes(&edge_x_[begin + i]), ey = load_lanes(&edge_y_[begin + i]);
      const Lanes along = ex * qx + ey * qy, flux = ey * qx - ex * qy;
      const Lanes c0 = load_lanes(cosines + i), c1 = load_lanes(cosines + i + 1), s0 = load_lanes(sines + i),
                  s1 = load_lanes(sines + i + 1);
      const Lanes h2 = along * along * 0.25;
      const LaneBits is_small = h2 < 1 / 64.0;
      const Lanes inverse = 1 / (is_small ? Lanes{} + 1 : along);
      const Lanes half_tangent = 0.5 * tangent_over_argument(h2);
      real += flux * (is_small ? half_tangent * (c0 + c1) : (s1 - s0) * inverse);
      imaginary += flux * (is_small ? -half_tangent * (s0 + s1) : (c1 - c0) * inverse);
    }
  }
  return {-sum(imaginary) / q2, sum(real) / q2};
}

}  // namespace aureole::optics

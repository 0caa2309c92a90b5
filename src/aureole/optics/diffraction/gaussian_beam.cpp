// SPDX-License-Identifier: Apache-2.0
#include "aureole/optics/diffraction/gaussian_beam.h"

#include <algorithm>
#include <boost/math/special_functions/owens_t.hpp>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

namespace aureole::optics {
namespace {

using std::numbers::pi;

double owens_t(double h, double a) {
  using Policy = boost::math::policies::policy<boost::math::policies::promote_double<false>>;
  return boost::math::owens_t(h, a, Policy());
}

}  // namespace

GaussianBeam::GaussianBeam(double sigma) : sigma_(sigma), peak_(1 / (std::sqrt(2 * pi) * sigma)) {
  if (!(sigma > 0 && sigma < INFINITY))
    throw std::domain_error("standard deviation of a beam: expected a positive length, got " +
                            std::to_string(sigma));
}

double GaussianBeam::amplitude(PlanePoint p) const {
  return peak_ * std::exp(-(p.x * p.x + p.y * p.y) / (4 * sigma_ * sigma_));
}

double GaussianBeam::intensity(PlanePoint p) const {
  const double a = amplitude(p);
  return a * a;
}

PlanePoint GaussianBeam::sample(double u1, double u2) const {
  const double r = sigma_ * std::sqrt(-2 * std::log1p(-u1)), phi = 2 * pi * u2;
  return {r * std::cos(phi), r * std::sin(phi)};
}

double GaussianBeam::power(std::span<const PlanePoint> ring) const {
  // Seen from the centre, an edge at the distance h (in sigma) subtends the angles phi1 to phi2 from its
  // foot. The part of the beam between centre and edge is the integral of (1 - exp(-h^2/(2 cos^2 phi)))/(2
  // pi) over these angles.
  double sum = 0;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const PlanePoint a = ring[i], b = ring[(i + 1) % ring.size()];
    const double ex = b.x - a.x, ey = b.y - a.y, length = std::hypot(ex, ey);
    if (length == 0) continue;
    const double h = (a.x * ey - a.y * ex) / length;  // > 0 if counter-clockwise about the centre
    if (h == 0) continue;
    const double t1 = (a.x * ex + a.y * ey) / length / std::abs(h),
                 t2 = (b.x * ex + b.y * ey) / length / std::abs(h);
    const double part =
        (std::atan(t2) - std::atan(t1)) / (2 * pi) - owens_t(h / sigma_, t2) + owens_t(h / sigma_, t1);
    sum += std::copysign(part, h);
  }
  return sum;
}

double GaussianBeam::power(const PolygonRegion& region) const {
  double sum = 0;
  for (const Ring& ring : region.rings()) sum += power(ring);
  return sum;
}

std::size_t GaussianBeam::light(PlanePoint from, PlanePoint to, double reach, double piece,
                                std::span<DiffractingEdge> out) const {
  const double ex = to.x - from.x, ey = to.y - from.y, length = std::hypot(ex, ey);
  if (!(length > 0)) return 0;
  const double foot = -(from.x * ex + from.y * ey) / length, h = (from.x * ey - from.y * ex) / length;
  const double limit = reach * sigma_, half2 = limit * limit - h * h;
  if (!(half2 > 0)) return 0;
  const double half = std::sqrt(half2), begin = std::max(0.0, foot - half),
               end = std::min(length, foot + half);
  if (!(end - begin > 1e-12 * length)) return 0;
  const std::size_t count = std::size_t(std::max(1.0, std::ceil((end - begin) / (piece * sigma_) - 1e-9)));
  if (count > out.size()) return count;
  const auto at = [&](double s) { return PlanePoint{from.x + s / length * ex, from.y + s / length * ey}; };
  PlanePoint p = at(begin);
  double a = amplitude(p);
  for (std::size_t i = 0; i < count; ++i) {
    const PlanePoint q = at(begin + (end - begin) * double(i + 1) / double(count));
    const double b = amplitude(q);
    out[i] = {p, q, a, b};
    p = q, a = b;
  }
  return count;
}

}  // namespace aureole::optics

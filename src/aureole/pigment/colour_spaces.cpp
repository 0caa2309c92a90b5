// SPDX-License-Identifier: Apache-2.0
#include "aureole/pigment/colour_spaces.h"

#include <cmath>

namespace aureole::pigment {
namespace {

/// The intersection of a ray from `from` along (dx, dy) with a segment: the position along the ray, and the fraction of the
/// segment in `at`; a negative number if they do not meet.
double meet(const Chromaticity& from, double dx, double dy, const Chromaticity& a, const Chromaticity& b,
            double& at) {
  const double ex = b.x - a.x, ey = b.y - a.y, determinant = dx * ey - dy * ex;
  if (std::abs(determinant) < 1e-15) return -1;
  const double t = ((a.x - from.x) * ey - (a.y - from.y) * ex) / determinant;
  at = ((a.x - from.x) * dy - (a.y - from.y) * dx) / determinant;
  return at >= 0 && at <= 1 ? t : -1;
}

}  // namespace

UcsChromaticity ucs_chromaticity(const Xyz& xyz) {
  const double sum = xyz[0] + 15 * xyz[1] + 3 * xyz[2];
  if (!(sum > 0)) return {};
  return {4 * xyz[0] / sum, 9 * xyz[1] / sum};
}

Luv luv_of_xyz(const Xyz& xyz, const Xyz& white) {
  // L* is that of CIELAB.
  const double l = lab_of_xyz({white[0], xyz[1], white[2]}, white).l;
  const UcsChromaticity c = ucs_chromaticity(xyz), n = ucs_chromaticity(white);
  if (!(l > 0)) return {};
  return {l, 13 * l * (c.u - n.u), 13 * l * (c.v - n.v)};
}

DominantWavelength dominant_wavelength(const Chromaticity& colour, const Chromaticity& white,
                                       std::span<const double> nm, std::span<const Chromaticity> locus) {
  DominantWavelength result;
  const double dx = colour.x - white.x, dy = colour.y - white.y;
  if (std::hypot(dx, dy) < 1e-9 || locus.size() < 2) return result;
  // The nearest hit along the ray, which is 1 long, is the border of all colours there.
  const auto border = [&](double sx, double sy, double& wavelength) {
    double nearest = -1, at = 0;
    for (std::size_t i = 0; i + 1 < locus.size(); ++i) {
      const double t = meet(white, sx, sy, locus[i], locus[i + 1], at);
      if (t > 1e-9 && (nearest < 0 || t < nearest))
        nearest = t, wavelength = nm[i] + at * (nm[i + 1] - nm[i]);
    }
    return nearest;
  };
  double t = border(dx, dy, result.nm);
  if (t < 0) {
    double at = 0;
    result.is_complementary = true;
    border(-dx, -dy, result.nm);
    t = meet(white, dx, dy, locus.front(), locus.back(), at);
  }
  result.purity = t > 0 ? 1 / t : 0;
  return result;
}

}  // namespace aureole::pigment

// SPDX-License-Identifier: Apache-2.0
#include "aureole/pigment/colour_difference.h"

#include <cmath>

#include "aureole/optics/constants.h"

namespace aureole::pigment {
namespace {

using optics::kDegree;

constexpr double kTurn = 2 * optics::kPi;
constexpr double kKnee = 6.0 / 29.0;

double compressed(double t) {
  return t > kKnee * kKnee * kKnee ? std::cbrt(t) : t / (3 * kKnee * kKnee) + 4.0 / 29.0;
}
double expanded(double f) { return f > kKnee ? f * f * f : 3 * kKnee * kKnee * (f - 4.0 / 29.0); }

double hue(double a, double b) {
  if (a == 0 && b == 0) return 0;
  const double h = std::atan2(b, a);
  return h < 0 ? h + kTurn : h;
}

/// sqrt(C^7/(C^7 + 25^7)).
double chroma_factor(double chroma) {
  const double c2 = chroma * chroma, c7 = c2 * c2 * c2 * chroma;
  return std::sqrt(c7 / (c7 + 6103515625.0));
}

/// Mean of two hue angles on the circle; their sum if one of the colours is grey.
double mean_hue(double h1, double h2, bool grey) {
  if (grey) return h1 + h2;
  const double sum = h1 + h2;
  if (std::abs(h1 - h2) <= optics::kPi) return sum / 2;
  return sum < kTurn ? (sum + kTurn) / 2 : (sum - kTurn) / 2;
}

}  // namespace

Lab lab_of_xyz(const Xyz& xyz, const Xyz& white) {
  const double x = compressed(xyz[0] / white[0]), y = compressed(xyz[1] / white[1]),
               z = compressed(xyz[2] / white[2]);
  return {116 * y - 16, 500 * (x - y), 200 * (y - z)};
}

Xyz xyz_of_lab(const Lab& lab, const Xyz& white) {
  const double y = (lab.l + 16) / 116;
  return {white[0] * expanded(y + lab.a / 500), white[1] * expanded(y), white[2] * expanded(y - lab.b / 200)};
}

std::array<double, 3> ciede2000_components(const Lab& p, const Lab& q) {
  // Names as in Sharma, Wu and Dalal; angles in radians.
  const double g = 0.5 * (1 - chroma_factor((std::hypot(p.a, p.b) + std::hypot(q.a, q.b)) / 2));
  const double a1 = (1 + g) * p.a, a2 = (1 + g) * q.a;
  const double c1 = std::hypot(a1, p.b), c2 = std::hypot(a2, q.b);
  const double h1 = hue(a1, p.b), h2 = hue(a2, q.b);
  const bool grey = c1 * c2 == 0;
  double dh = grey ? 0 : h2 - h1;
  if (dh > optics::kPi) dh -= kTurn;
  if (dh < -optics::kPi) dh += kTurn;
  const double delta_h = 2 * std::sqrt(c1 * c2) * std::sin(dh / 2);

  const double l = (p.l + q.l) / 2, c = (c1 + c2) / 2, h = mean_hue(h1, h2, grey);
  const double t = 1 - 0.17 * std::cos(h - 30 * kDegree) + 0.24 * std::cos(2 * h) +
                   0.32 * std::cos(3 * h + 6 * kDegree) - 0.20 * std::cos(4 * h - 63 * kDegree);
  const double turned = (h / kDegree - 275) / 25;
  const double rotation = -std::sin(2 * 30 * kDegree * std::exp(-turned * turned)) * 2 * chroma_factor(c);
  const double l50 = (l - 50) * (l - 50);
  const double x = (q.l - p.l) / (1 + 0.015 * l50 / std::sqrt(20 + l50));
  const double y = (c2 - c1) / (1 + 0.045 * c), z = delta_h / (1 + 0.015 * c * t);
  // Decomposes y^2 + z^2 + rotation y z into two squares; |rotation| is less than 2.
  return {x, y + 0.5 * rotation * z, z * std::sqrt(1 - 0.25 * rotation * rotation)};
}

double ciede2000(const Lab& a, const Lab& b) {
  const auto d = ciede2000_components(a, b);
  return std::hypot(d[0], d[1], d[2]);
}

}  // namespace aureole::pigment

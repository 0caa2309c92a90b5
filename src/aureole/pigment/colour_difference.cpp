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

/// Returns sqrt(C^7/(C^7 + 25^7)) of a chroma C (CIEDE2000).
double chroma_factor(double chroma) {
  const double c2 = chroma * chroma, c7 = c2 * c2 * c2 * chroma;
  return std::sqrt(c7 / (c7 + 6103515625.0));
}

/// Mean of two hue angles on the circle; their sum if one of the colours is grey (CIEDE2000).
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

double chroma(const Lab& lab) { return std::hypot(lab.a, lab.b); }
double hue_degrees(const Lab& lab) { return hue(lab.a, lab.b) / kDegree; }

LchDifference lch_difference(const Lab& standard, const Lab& sample) {
  const double c1 = chroma(standard), c2 = chroma(sample);
  // Delta H = (a1 b2 - a2 b1)/sqrt((c1 c2 + a1 a2 + b1 b2)/2) (R. Seve, Color Res. Appl. 16, 1991), which has no
  // cancellation; opposite hues have 0/0.
  const double along = 0.5 * (c1 * c2 + standard.a * sample.a + standard.b * sample.b);
  const double across = standard.a * sample.b - sample.a * standard.b;
  const double h = along > 1e-12 * c1 * c2 ? across / std::sqrt(along) : 2 * std::sqrt(c1 * c2);
  return {sample.l - standard.l, c2 - c1, h};
}

double cie1976(const Lab& a, const Lab& b) { return std::hypot(a.l - b.l, a.a - b.a, a.b - b.b); }

double cmc(const Lab& standard, const Lab& sample, double l, double c) {
  const LchDifference d = lch_difference(standard, sample);
  const double c1 = chroma(standard), h1 = hue_degrees(standard);
  const double s_l = standard.l < 16 ? 0.511 : 0.040975 * standard.l / (1 + 0.01765 * standard.l);
  const double s_c = 0.0638 * c1 / (1 + 0.0131 * c1) + 0.638;
  const double c4 = c1 * c1 * c1 * c1, f = std::sqrt(c4 / (c4 + 1900));
  const double t = h1 >= 164 && h1 <= 345 ? 0.56 + std::abs(0.2 * std::cos((h1 + 168) * kDegree))
                                          : 0.36 + std::abs(0.4 * std::cos((h1 + 35) * kDegree));
  return std::hypot(d.l / (l * s_l), d.c / (c * s_c), d.h / (s_c * (f * t + 1 - f)));
}

double cie94(const Lab& standard, const Lab& sample, Cie94 application) {
  const bool textiles = application == Cie94::textiles;
  const LchDifference d = lch_difference(standard, sample);
  const double c1 = chroma(standard);
  return std::hypot(d.l / (textiles ? 2 : 1), d.c / (1 + (textiles ? 0.048 : 0.045) * c1),
                    d.h / (1 + (textiles ? 0.014 : 0.015) * c1));
}

Lab din99o_of_lab(const Lab& lab) {
  const double turn = 26 * kDegree;
  const double e = lab.a * std::cos(turn) + lab.b * std::sin(turn);
  const double f = 0.83 * (lab.b * std::cos(turn) - lab.a * std::sin(turn));
  const double c = std::log1p(0.075 * std::hypot(e, f)) / 0.0435;
  const double h = (e == 0 && f == 0 ? 0 : std::atan2(f, e)) + turn;
  return {303.67 * std::log1p(0.0039 * lab.l), c * std::cos(h), c * std::sin(h)};
}

double din99o(const Lab& a, const Lab& b) { return cie1976(din99o_of_lab(a), din99o_of_lab(b)); }

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

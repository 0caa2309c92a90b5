// SPDX-License-Identifier: Apache-2.0
// Radius and area fraction from ring angles that a user has read off a picture.
#include <algorithm>
#include <cmath>
#include <limits>

#include "aureole/core/error.h"
#include "aureole/core/units.h"
#include "aureole/instrument/corona/corona_fit.h"
#include "aureole/math/simplex.h"
#include "aureole/math/vec.h"

namespace aureole {
namespace {

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> out(1);
  for (const char c : text)
    if (c == separator)
      out.emplace_back();
    else if (c != ' ')
      out.back() += c;
  return out;
}

/// Positions s of the extrema of one colour, from the centre outwards.
std::vector<double> extrema(CoronaModel& model, int colour, bool maximum, double end) {
  constexpr int kSteps = 1200;
  const auto value = [&](int i) {
    const auto rgb = model.at(end * i / kSteps);
    const double v = colour == 3 ? 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2] : rgb[size_t(colour)];
    return maximum ? v : -v;
  };
  std::vector<double> out;
  double a = value(0), b = value(1);
  for (int i = 2; i <= kSteps; ++i) {
    const double c = value(i);
    if (b > a && b >= c) out.push_back(end / kSteps * (i - 1 + 0.5 * (a - c) / (a - 2 * b + c)));
    a = b, b = c;
  }
  return out;
}

}  // namespace

std::vector<RingAngle> parse_ring_angles(const std::string& text) {
  std::vector<RingAngle> rings;
  for (const std::string& entry : split(text, ',')) {
    const auto fail = [&](const std::string& what) { throw Error("--angles: \"" + entry + "\": " + what); };
    std::vector<std::string> parts = split(entry, ':');
    RingAngle r;
    if (parts[0].ends_with("deg")) parts[0].resize(parts[0].size() - 3);
    try {
      r.angle_deg = parse_number(parts[0]);
    } catch (const Error& e) {
      fail(e.message() + " of degrees");
    }
    if (!(r.angle_deg > 0 && r.angle_deg < 45)) fail("an angle must be between 0 and 45 degrees");
    r.maximum = rings.size() % 2 == 0, r.colour = 3;
    for (size_t i = 1; i < parts.size(); ++i) {
      const std::string& p = parts[i];
      if (p == "max" || p == "min")
        r.maximum = p == "max";
      else if (p.size() == 1 && std::string("RGBY").find(p[0]) != std::string::npos)
        r.colour = int(std::string("RGBY").find(p[0]));
      else
        fail("\"" + p + "\" is neither max nor min nor one of R, G, B, Y");
    }
    rings.push_back(r);
  }
  std::stable_sort(rings.begin(), rings.end(),
                   [](const RingAngle& a, const RingAngle& b) { return a.angle_deg < b.angle_deg; });
  return rings;
}

CoronaFit fit_ring_angles(const std::vector<RingAngle>& rings, const LampSpectrum& lamp, double error_deg,
                          double fixed_fraction, CoronaModel::Positions positions) {
  double largest = 0;
  for (const RingAngle& r : rings) largest = std::max(largest, std::sin(r.angle_deg * kDegree));
  CoronaModel model(lamp, 2 * largest, 0, positions);
  const double error = error_deg * kDegree;
  // Differences of s over the error; a missing extremum of the model counts as a large difference.
  const auto residuals = [&](double radius, double fraction) {
    model.set({radius, fraction});
    std::vector<double> out, found[4][2];
    size_t used[4][2] = {};
    for (const RingAngle& r : rings) {
      auto& list = found[r.colour][r.maximum];
      const size_t i = used[r.colour][r.maximum]++;
      if (i == 0) list = extrema(model, r.colour, r.maximum, 2 * largest);
      const double s = std::sin(r.angle_deg * kDegree);
      out.push_back(i < list.size() ? (list[i] - s) / error : 2 * largest / error);
    }
    return out;
  };
  const auto misfit = [&](double radius, double fraction) {
    double sum = 0;
    for (const double r : residuals(radius, fraction)) sum += r * r;
    return sum;
  };
  CoronaFit fit;
  fit.fraction_fixed = rings.size() < 2 || fixed_fraction >= 0;
  const double only = fixed_fraction >= 0 ? fixed_fraction : 0.5;
  double best = INFINITY;
  const double scale = 2.548 * 550e-9 / (2 * M_PI) / std::sin(rings[0].angle_deg * kDegree);
  for (double fraction = fit.fraction_fixed ? only : 0.05; fraction < kMaxFittedFraction + 0.02;
       fraction += fit.fraction_fixed ? 1 : 0.05)
    for (double radius = 0.3 * scale; radius < 4 * scale; radius *= 1.02)
      if (const double m = misfit(radius, std::min(fraction, kMaxFittedFraction)); m < best)
        best = m, fit.radius = radius, fit.area_fraction = std::min(fraction, kMaxFittedFraction);
  if (fit.fraction_fixed) {
    const auto x =
        simplex_minimum<1>([&](const std::array<double, 1>& p) { return misfit(std::exp(p[0]), only); },
                           {std::log(fit.radius)}, {0.01}, 60);
    fit.radius = std::exp(x[0]);
  } else {
    const auto x = simplex_minimum<2>(
        [&](const std::array<double, 2>& p) {
          return p[1] > 0.005 && p[1] < kMaxFittedFraction ? misfit(std::exp(p[0]), p[1]) : double(INFINITY);
        },
        {std::log(fit.radius), fit.area_fraction}, {0.01, 0.02}, 150);
    fit.radius = std::exp(x[0]), fit.area_fraction = x[1];
  }
  const std::vector<double> r0 = residuals(fit.radius, fit.area_fraction);
  best = misfit(fit.radius, fit.area_fraction);
  const size_t unknowns = fit.fraction_fixed ? 1 : 2;
  for (size_t i = 0; i < r0.size(); ++i)
    if (std::abs(r0[i]) > 5 && std::abs(r0[i]) * error > 0.1 * rings[i].angle_deg * kDegree)
      throw Error(
          "--angles: no radius has extrema at these angles; check their order, kind (max, min) and colour");
  // Covariance: (X^T X)^-1 times the square of the given error or of the residuals' error, whichever is
  // larger.
  const double hr = 2e-3, hf = fit.area_fraction > 0.6 ? -0.01 : 0.01;
  const auto r1 = residuals(fit.radius * (1 + hr), fit.area_fraction);
  const auto r2 = residuals(fit.radius, fit.area_fraction + (fit.fraction_fixed ? 0 : hf));
  double a = 0, b = 0, c = 0;
  for (size_t i = 0; i < r0.size(); ++i) {
    const double dr = (r1[i] - r0[i]) / hr, df = (r2[i] - r0[i]) / hf;
    a += dr * dr, b += dr * df, c += df * df;
  }
  const double chi = rings.size() > unknowns ? std::max(1.0, best / double(rings.size() - unknowns)) : 1;
  const double determinant = a * c - b * b;
  if (fit.fraction_fixed || !(determinant > 1e-12 * a * c)) {
    fit.radius_error = fit.radius * std::sqrt(chi / a);
    fit.area_fraction_error = fit.fraction_fixed ? 0 : INFINITY;
  } else {
    fit.radius_error = fit.radius * std::sqrt(chi * c / determinant);
    fit.area_fraction_error = std::sqrt(chi * a / determinant);
    fit.correlation = -b / std::sqrt(a * c);
  }
  fit.residual = std::sqrt(best / double(rings.size())) * error_deg;
  return fit;
}

}  // namespace aureole

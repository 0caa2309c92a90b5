// SPDX-License-Identifier: Apache-2.0
// Mixtures of scatterers with closed forms of J(q), in double precision, for the tests of `ScattererModel` and
// of its samplers.
#pragma once

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <functional>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "aureole/aperture/aperture.h"
#include "aureole/bsdf/layer/scatterer_model.h"
#include "harness/properties_builder.h"

namespace aureole::testing::mixture_cases {

using Amplitude = std::function<std::complex<double>(double, double)>;

/// Bessel functions are those of the C library here, which are exact to 1e-15 and much faster than std::cyl_bessel_j.
inline double airy(double x) { return x < 1e-6 ? 1 : 2 * ::j1(x) / x; }
inline double sinc(double x) { return std::abs(x) < 1e-9 ? 1 : std::sin(x) / x; }

/// Hard discs, written anew.
inline double hard_discs(double u, double fa) {
  const double f = fa / (1 - fa), a1 = airy(u);
  const double c = 4 * f * airy(2 * u) + 4 * f * f * ::j0(u) * a1 + (f * f + 2 * f * f * f) * a1 * a1;
  return 1 / (1 + c);
}

/// A shape as XML, and its transform relative to the correlation radius of 1 um.
struct ShapeCase {
  std::string xml;
  double fraction;
  Amplitude amplitude;
  double area;
};

inline ShapeCase circle(double radius, double fraction = 1) {
  const double area = std::numbers::pi * radius * radius;
  return {"<aperture type=\"circle\"><string name=\"radius\" value=\"" + std::to_string(radius) +
              "um\"/><float name=\"fraction\" value=\"" + std::to_string(fraction) + "\"/></aperture>",
          fraction, [=](double x, double y) { return area * airy(radius * std::hypot(x, y)); }, area};
}

inline ShapeCase rectangle(double width, double height, double degrees, double fraction = 1) {
  const double c = std::cos(degrees * std::numbers::pi / 180), s = std::sin(degrees * std::numbers::pi / 180);
  return {"<aperture type=\"rectangle\"><string name=\"width\" value=\"" + std::to_string(width) +
              "um\"/><string name=\"height\" value=\"" + std::to_string(height) +
              "um\"/><float name=\"rotation\" value=\"" + std::to_string(degrees) +
              "\"/><float name=\"fraction\" value=\"" + std::to_string(fraction) + "\"/></aperture>",
          fraction,
          [=](double x, double y) {
            return width * height * sinc((x * c + y * s) * width / 2) * sinc((y * c - x * s) * height / 2);
          },
          width * height};
}

struct MixtureCase {
  std::string name;
  std::vector<ShapeCase> shapes;
  double extent = 240;

  std::shared_ptr<optics::ScattererMixture> mixture() const {
    std::vector<optics::Scatterer> scatterers;
    for (const ShapeCase& s : shapes) {
      const auto a = build<Aperture>(s.xml);
      scatterers.push_back({a->shape(), a->fraction(), a->rotation(), a->is_randomly_rotated(), a->sizes()});
    }
    return std::make_shared<optics::ScattererMixture>(std::move(scatterers), 1e-6);
  }
  std::shared_ptr<ScattererModel> model(
      double least, double most,
      const std::string& correlation = R"(<correlation type="percus_yevick"/>)") const {
    return std::make_shared<ScattererModel>(*mixture(), *build<Correlation>(correlation), least, most,
                                            extent);
  }
  /// U + C S'.
  double intensity(double x, double y, double fa) const {
    std::complex<double> sum = 0;
    double squares = 0;
    for (const ShapeCase& s : shapes) {
      const auto f = s.amplitude(x, y);
      sum += s.fraction * f, squares += s.fraction * std::norm(f);
    }
    return squares - std::norm(sum) + std::norm(sum) * hard_discs(std::hypot(x, y), fa);
  }
};

inline std::vector<MixtureCase> layers() {
  return {{"circle", {circle(1)}},
          {"small circle", {circle(0.5)}},
          {"two circles", {circle(1, 0.3), circle(0.6, 0.7)}},
          {"square", {rectangle(std::numbers::sqrt2 * 0.999, std::numbers::sqrt2 * 0.999, 0)}},
          {"turned slit", {rectangle(1.9, 0.4, 30)}},
          {"circle and square", {circle(0.9, 0.4), rectangle(1.3, 1.3, 20, 0.6)}}};
}

inline DiffractedWave wave(double x, double y) {
  return {float(x), float(y), float(std::hypot(float(x), float(y)))};
}

/// As many waves as a spectrum holds, which are looked up together: the j-th is `position(j)`, {x, y}.
template <class Position>
DiffractedWave waves(const Position& position) {
  DiffractedWave w;
  for (int j = 0; j < kWavelengths; ++j) {
    const auto [x, y] = position(j);
    w.x[j] = float(x), w.y[j] = float(y), w.length[j] = std::hypot(w.x[j], w.y[j]);
  }
  return w;
}

/// Azimuths at equal steps over an angle from 0 on, in the middle of each step.
class RingPoints {
public:
  RingPoints(int count, double angle) {
    for (int i = 0; i < count; ++i) {
      const double f = angle * (i + 0.5) / count;
      cosines_.push_back(std::cos(f)), sines_.push_back(std::sin(f));
    }
  }
  int count() const { return int(cosines_.size()); }
  /// As many of them as a spectrum holds, at the radius u; repeats the last one behind it.
  DiffractedWave at(double u, int first) const {
    DiffractedWave w;
    for (int j = 0; j < kWavelengths; ++j) {
      const auto i = std::size_t(std::min(first + j, count() - 1));
      w.x[j] = float(u * cosines_[i]), w.y[j] = float(u * sines_[i]), w.length[j] = float(u);
    }
    return w;
  }

private:
  std::vector<double> cosines_, sines_;
};

}  // namespace aureole::testing::mixture_cases

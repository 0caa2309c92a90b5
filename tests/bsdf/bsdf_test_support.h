// SPDX-License-Identifier: Apache-2.0
// Helpers of the tests of single BSDFs: a setting to evaluate them in, directions by angles, and energies.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "aureole/bsdf/bsdf.h"
#include "harness/properties_builder.h"

namespace aureole::testing {

constexpr double kPiDouble = 3.14159265358979323846;

inline Vec3 direction(double theta, double phi) {
  return {float(std::sin(theta) * std::cos(phi)), float(std::sin(theta) * std::sin(phi)),
          float(std::cos(theta))};
}

/// A context of wavelengths from 440 to 650 nm; it keeps what it refers to.
struct Setting {
  explicit Setting(TransportMode m = TransportMode::radiance)
      : wavelengths(Wavelengths::at(SpectralGrid::over(360, 830),
                                    make_spectrum([](int i) { return 440 + 30 * float(i); }))),
        mode(m) {}
  BsdfContext context() const { return {wavelengths, point, mode, 0}; }
  Wavelengths wavelengths;
  SurfacePoint point;
  TransportMode mode;
};

inline std::shared_ptr<Bsdf> bsdf_of(const std::string& type, const std::string& parameters) {
  return build<Bsdf>("<bsdf type=\"" + type + "\">" + parameters + "</bsdf>");
}
inline std::string number(const char* name, double value) {
  std::string text = std::to_string(value);
  return "<float name=\"" + std::string(name) + "\" value=\"" + text + "\"/>";
}

/// f at the first wavelength, without the cosine.
inline double brdf(const Bsdf& bsdf, const Vec3& wi, const Vec3& wo, const Setting& s = Setting()) {
  return double(bsdf.eval(wi, wo, s.context())[0]) / std::abs(double(wo.z));
}

/// Reflected share of the light from wi at the first wavelength, by quadrature over angles; for lobes wider
/// than about 0.05.
inline double albedo(const Bsdf& bsdf, const Vec3& wi, int n = 360) {
  const Setting s;
  double sum = 0;
  for (int i = 0; i < n; ++i) {
    const double theta = (i + 0.5) / n * kPiDouble / 2;
    double ring = 0;
    for (int j = 0; j < 2 * n; ++j)
      ring += double(bsdf.eval(wi, direction(theta, (j + 0.5) / n * kPiDouble), s.context())[0]);
    sum += ring * std::sin(theta);
  }
  return sum * (kPiDouble / 2 / n) * (kPiDouble / n);
}

/// The albedo by stratified samples, for narrow lobes and grazing angles.
inline double sampled_albedo(const Bsdf& bsdf, const Vec3& wi, int n = 512) {
  const Setting s;
  double sum = 0;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const float u1 = float((i * 7 + j * 3) % 64 + 0.5) / 64;
      const auto x =
          bsdf.sample(wi, u1, {(float(i) + 0.5f) / float(n), (float(j) + 0.5f) / float(n)}, s.context());
      if (x) sum += double(x->value[0]) / double(x->pdf[0]);
    }
  return sum / n / n;
}

inline std::string error_of_bsdf(const std::string& type, const std::string& parameters) {
  try {
    bsdf_of(type, parameters);
  } catch (const Error& e) {
    return e.what();
  }
  return "";
}
inline void expect_error(const std::string& type, const std::string& parameters, const std::string& text) {
  const std::string message = error_of_bsdf(type, parameters);
  EXPECT_NE(message.find(text), std::string::npos) << parameters << ": " << message;
  EXPECT_EQ(message.rfind("snippet:1:", 0), 0u) << parameters << ": " << message;
}

}  // namespace aureole::testing

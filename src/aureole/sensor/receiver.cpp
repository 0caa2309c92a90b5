// SPDX-License-Identifier: Apache-2.0
#include "aureole/math/warp.h"
#include "aureole/sensor/sensor.h"
#include "aureole/shape/surface_point.h"

namespace aureole {

namespace {

/// Returns the sine of the angle between a unit direction and a unit axis.
float sine_to(const Vec3& axis, const Vec3& d) { return length(cross(axis, d)); }

/// Returns the angle x in [0, 2 pi] with (x - sin x)/(2 pi) = u, by bisection and Newton's method. Half of x
/// is the angle from a cylinder's axis.
double angle_of_segment(double u) {
  double low = 0, high = 2 * M_PI, x = 2 * M_PI * u;
  for (int i = 0; i < 60; ++i) {
    const double f = x - std::sin(x) - 2 * M_PI * u;
    (f < 0 ? low : high) = x;
    const double slope = 1 - std::cos(x), next = slope > 0 ? x - f / slope : low;
    const double before = x;
    x = next > low && next < high ? next : 0.5 * (low + high);
    if (std::abs(x - before) < 1e-12) break;
  }
  return x;
}

}  // namespace

float Receiver::response(const Vec3& d) const {
  switch (measure) {
    case Measure::irradiance:
      return weight * std::max(dot(d, ng), 0.f);
    case Measure::cylindrical:
      return weight * kInvPi * sine_to(axis, d);
    case Measure::semicylindrical:
      return weight * kInvPi * std::max(sine_to(axis, d) + dot(d, ng), 0.f);
    default:
      return weight;
  }
}

float Receiver::total() const { return weight * (measure == Measure::fluence ? 4 * kPi : kPi); }

float Receiver::pdf(const Vec3& d) const {
  switch (measure) {
    case Measure::irradiance:
      return cosine_hemisphere_pdf(dot(d, ng));
    case Measure::fluence:
      return uniform_sphere_pdf();
    case Measure::far:
      return far_share;
    default:
      return response(d) * kInvPi / weight;
  }
}

SensorRay Receiver::sample_ray(Vec2 u) const {
  Vec3 d;
  if (measure == Measure::fluence) {
    d = square_to_uniform_sphere(u);
  } else if (measure == Measure::irradiance) {
    d = normalize(Frame::from_normal(ng).to_world(square_to_cosine_hemisphere(u)));
  } else {
    // Angles e from the axis have the pdf 2 sin^2(e)/pi. Azimuths a are uniform, or have the pdf (1 + cos a)/(2 pi):
    // with b = a + pi that is (1 - cos b)/(2 pi), whose CDF is (b - sin b)/(2 pi).
    const double e = 0.5 * angle_of_segment(double(u.x)), a = measure == Measure::semicylindrical
                                                                  ? angle_of_segment(double(u.y)) - M_PI
                                                                  : 2 * M_PI * double(u.y);
    const Frame frame = Frame::from_normal_tangent(axis, ng);
    d = normalize(frame.to_world(
        {float(std::sin(e) * std::cos(a)), float(std::sin(e) * std::sin(a)), float(std::cos(e))}));
  }
  return {{offset_origin(p, p_error, ng, d), d, kInfinity}, total()};
}

std::optional<SensorConnection> Receiver::connect(const Vec3& reference, Vec2 film, float film_area) const {
  const Vec3 to = p - reference;
  const float distance2 = length_squared(to);
  if (!(distance2 > 0)) return {};
  const Vec3 wo = to * (1 / std::sqrt(distance2));
  const float seen = response(-wo);
  if (!(seen > 0)) return {};
  return SensorConnection{wo, offset_origin(p, p_error, ng, -wo), film, film_area * seen / distance2};
}

}  // namespace aureole

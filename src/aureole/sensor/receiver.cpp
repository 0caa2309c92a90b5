// SPDX-License-Identifier: Apache-2.0
#include "aureole/math/warp.h"
#include "aureole/sensor/sensor.h"
#include "aureole/shape/surface_point.h"

namespace aureole {

float Receiver::response(const Vec3& d) const {
  return weight * (measure == Measure::fluence ? 1.f : std::max(dot(d, ng), 0.f));
}

float Receiver::total() const { return weight * (measure == Measure::fluence ? 4 * kPi : kPi); }

float Receiver::pdf(const Vec3& d) const {
  return measure == Measure::fluence ? uniform_sphere_pdf() : cosine_hemisphere_pdf(dot(d, ng));
}

SensorRay Receiver::sample_ray(Vec2 u) const {
  const bool fluence = measure == Measure::fluence;
  const Vec3 d = fluence ? square_to_uniform_sphere(u)
                         : normalize(Frame::from_normal(ng).to_world(square_to_cosine_hemisphere(u)));
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

// SPDX-License-Identifier: Apache-2.0
// What cameras share: clip planes, and the projection through a thin lens, of which a pinhole is the limit.
#pragma once

#include "aureole/sensor/sensor.h"

namespace aureole {

/// Nothing before `near` or behind `far`, in camera space, is seen.
struct ClipPlanes {
  float near = 1e-2f, far = 1e4f;
  explicit ClipPlanes(const Properties& properties);
};

/// A camera with a circular aperture around the origin of camera space. It looks along local +z; local +x
/// points left and +y up in the picture, as in Mitsuba.
class LensCamera : public Sensor {
public:
  SensorRay sample_ray(Vec2 film_position, Vec2 lens) const override;
  bool uses_lens() const override { return aperture_radius_ > 0; }
  void share_film(const std::shared_ptr<Film>& film, int index, int count) override;
  std::optional<SensorConnection> sample_direct(const Vec3& reference, Vec2 lens) const override;

protected:
  explicit LensCamera(const Properties& properties);
  const ClipPlanes& clip() const { return clip_; }
  void set_lens(double aperture_radius, double focus_distance);

private:
  void fit();
  /// A point of the aperture, in its plane z = 0.
  Vec2 aperture_point(Vec2 lens) const;

  Transform to_world_, to_camera_;
  Vec3 origin_, axes_[3];  ///< of camera space
  ClipPlanes clip_;
  float aperture_radius_ = 0;
  float inverse_focus_ = 0;  ///< 1 / distance of the plane in focus; of no account for a pinhole
  float center_x_ = 0, center_y_ = 0;
  float scale_ = 1;  ///< tangent of the angle that a pixel at the centre covers
};

}  // namespace aureole

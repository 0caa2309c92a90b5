// SPDX-License-Identifier: Apache-2.0
// Projection shared by the cameras: clip planes, and a thin lens; a pinhole is a lens with an aperture of
// radius 0.
#pragma once

#include <vector>

#include "aureole/plugin/field_of_view.h"
#include "aureole/plugin/registry.h"
#include "aureole/sensor/placed_sensor.h"

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
  SensorRay sample_ray(const PlacedSensor& at, Vec2 film_position, Vec2 lens) const override;
  bool uses_lens() const override { return aperture_radius_ > 0; }
  std::optional<SensorConnection> sample_direct(const PlacedSensor& at, const Vec3& reference,
                                                Vec2 lens) const override;
  std::optional<SensorResponse> eval(const PlacedSensor& at, const Vec3& p, const Vec3& d,
                                     std::optional<Vec2> seen) const override;
  void fit(PlacedSensor& at) const override;

protected:
  explicit LensCamera(const Properties& properties);
  const ClipPlanes& clip() const { return clip_; }
  void set_lens(double aperture_radius, double focus_distance);

private:
  /// A point of the aperture, in its plane z = 0.
  Vec2 aperture_point(Vec2 lens) const;

  Transform to_world_, to_camera_;
  Vec3 origin_, axes_[3];  ///< of camera space
  ClipPlanes clip_;
  float aperture_radius_ = 0;
  float inverse_focus_ = 0;  ///< 1 / distance of the plane in focus; unused for a pinhole
  FieldOfView field_of_view_;
  double principal_point_offset_[2];  ///< in widths and heights of the picture
};

/// `own` followed by the rows of the parameter table that cameras share: near_clip and far_clip.
std::vector<ParameterDoc> camera_parameters(std::vector<ParameterDoc> own);
/// The same for a LensCamera: to_world, the field of view and the centre of projection before them.
std::vector<ParameterDoc> lens_camera_parameters(std::vector<ParameterDoc> own);

}  // namespace aureole

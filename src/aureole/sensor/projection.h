// SPDX-License-Identifier: Apache-2.0
// The projection shared by cameras: clip planes and a thin lens. A pinhole is a lens with an aperture of
// radius 0.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "aureole/plugin/field_of_view.h"
#include "aureole/plugin/registry.h"
#include "aureole/sensor/placed_sensor.h"

namespace aureole {

/// Clip planes: only geometry between `near` and `far` along the camera's z axis is visible.
struct ClipPlanes {
  float near = 1e-2f, far = 1e4f;
  explicit ClipPlanes(const Properties& properties);

  /// Returns a located note if none of the boxes in the world reaches between the planes, else an empty string.
  /// The farther plane is at `far_z` of camera space.
  std::string note(const Properties& properties, const Transform& to_camera, std::span<const Bounds3> boxes,
                   double far_z) const;
};

/// Returns the parameter `to_world` of a camera, `transform` being its value at the first key frame. Throws Error if it
/// scales.
Transform rigid_transform(const Properties& properties, const Transform& transform);

/// A camera with a circular aperture around the origin of camera space. Its optical axis is local +z; local
/// +x points left and +y up in the picture, as in Mitsuba.
class LensCamera : public Sensor {
public:
  SensorRay sample_ray(const PlacedSensor& at, Vec2 film_position, Vec2 lens) const override;
  bool uses_lens() const override { return aperture_radius_ > 0; }
  std::optional<SensorConnection> sample_direct(const PlacedSensor& at, const Vec3& reference,
                                                Vec2 lens) const override;
  std::optional<SensorResponse> eval(const PlacedSensor& at, const Vec3& p, const Vec3& d,
                                     std::optional<Vec2> seen) const override;
  std::optional<PinholeView> pinhole(const PlacedSensor& at) const override;
  void fit(PlacedSensor& at) const override;
  std::string clipping_note(std::span<const Bounds3> shapes) const override {
    return clip_.note(properties(), to_camera_, shapes, clip_.far);
  }

protected:
  explicit LensCamera(const Properties& properties);
  /// Factor of the radiance along a ray that has the length `slope` for a unit along the axis: 1, or what makes it the
  /// irradiance on the film.
  float weight(float slope) const {
    return film_angle_ > 0 ? film_angle_ / (slope * slope * slope * slope) : 1.f;
  }
  const ClipPlanes& clip() const { return clip_; }
  void set_lens(double aperture_radius, double focus_distance);

private:
  /// Returns a point of the aperture, in the plane z = 0 of camera space.
  Vec2 aperture_point(Vec2 lens) const;

  Transform to_world_, to_camera_;
  Vec3 origin_, axes_[3];  ///< origin and axes of camera space in the world
  ClipPlanes clip_;
  float aperture_radius_ = 0;
  float film_angle_ =
      0;  ///< projected solid angle of the aperture from the middle of the film [sr]; 0: radiance is measured
  float inverse_focus_ = 0;  ///< 1 / distance of the plane in focus; unused for a pinhole
  FieldOfView field_of_view_;
  /// offset of the principal point, in fractions of the picture's width and height
  double principal_point_offset_[2];
};

/// Appends to `own` the rows of the parameter table that all cameras share: near_clip and far_clip.
std::vector<ParameterDoc> camera_parameters(std::vector<ParameterDoc> own);
/// Appends to `own` the rows for a LensCamera: to_world, field of view, centre of projection, and the rows of
/// `camera_parameters`.
std::vector<ParameterDoc> lens_camera_parameters(std::vector<ParameterDoc> own);

}  // namespace aureole

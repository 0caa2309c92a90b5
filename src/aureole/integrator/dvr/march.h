// SPDX-License-Identifier: Apache-2.0
// `VolumeMarch`: follows one ray through the classified media of a scene and composites what they show.
#pragma once

#include <cmath>
#include <span>
#include <vector>

#include "aureole/integrator/dvr/lighting.h"

namespace aureole {

/// The light, the transmittance and the measures of one ray.
struct VolumeResult {
  Spectrum radiance{0.f};
  float transmittance = 1;      ///< of the light from behind
  float optical_thickness = 0;  ///< of the part of the ray that was followed
  /// The largest number for mip, the mean for average, else the number where half of the light is absorbed; 0 if there
  /// is none.
  float value = 0;
  float depth = 0;  ///< distance of that place along the ray; 0 if there is none
  /// How often the numbers of a volume were looked up along the ray, without those of gradients, lights and shadows.
  float lookups = 0;
};

/// Opacity of an optical thickness, 1 - exp(-t), by its series where that has float's precision.
inline float opacity_of(float t) {
  if (!(t < 0.25f)) return -std::expm1(-t);
  return t * (1 - t * (1.f / 2) *
                      (1 - t * (1.f / 3) * (1 - t * (1.f / 4) * (1 - t * (1.f / 5) * (1 - t * (1.f / 6))))));
}
/// How many steps of `length` an interval has, of which the last may be shorter. Makes them longer if there were too many.
int divide_into_steps(float interval, float& length);

class VolumeMarch {
public:
  /// Follows `path.ray` up to the distance `length`. `d65` has the path's wavelengths.
  VolumeMarch(const Scene& scene, std::span<const ClassifiedMedium* const> media, const DvrSettings& settings,
              const Path& path, float length, const Spectrum& d65, std::uint32_t key);

  /// The distance where the last medium ends along the ray; 0 if the ray misses all.
  float end() const { return parts_.empty() ? 0 : shift_ + end_; }
  VolumeResult follow();

private:
  using Sample = TransferFunction::Sample;
  /// A medium on the ray.
  struct Part {
    const ClassifiedMedium* medium;
    float begin, end;                          ///< distances
    std::vector<std::array<float, 2>> active;  ///< where it may absorb: distances in order
    std::size_t next = 0;                      ///< index in `active`
    float last_end = -1, last_value = 0;       ///< end of the last step and the number there
    float first = 0, middle = 0, last = 0;     ///< numbers at the ends and in the middle of an adaptive step
  };
  /// One step: its optical thickness and the light that it emits, unattenuated.
  struct Step {
    float thickness = 0;
    Spectrum emission{0.f};  ///< sum of thickness times colour
    float value = 0;         ///< number of the last medium
    int lookups = 0;
  };

  /// Finds the parts of the ray in which the media may absorb.
  void find_active();
  VolumeResult composite(float step);
  /// Composites one volume from front to back (one_volume.cpp): as `composite`, in a shorter loop.
  VolumeResult composite_one(float step);
  VolumeResult integrate();
  /// Composites adaptive steps (adaptive.cpp).
  VolumeResult adapt();
  /// Adds the footprints of voxels up (splatting.cpp).
  VolumeResult splat();
  VolumeResult isosurfaces();
  VolumeResult project();
  /// The picture of a composited ray: for xray the light from behind.
  VolumeResult shown(VolumeResult result) const;
  /// The part of the step [a, b] within a medium.
  void add(Part& part, float a, float b, float offset, Step& step);
  Spectrum color_at(const ClassifiedMedium& medium, const Vec3& p, const Sample& s);
  /// Notes the place where half of the light from behind is lost, of a layer around the distance `t`.
  void note_half(VolumeResult& result, float before, float value, float t) const {
    if (before > 0.5f && result.transmittance <= 0.5f) result.value = value, result.depth = shift_ + t;
  }
  void cover(VolumeResult& result, const Spectrum& color, float opacity) const {
    result.radiance += color * (opacity * result.transmittance);
    result.transmittance *= 1 - opacity;
  }
  Vec3 at(float t) const { return ray_.o + ray_.d * t; }

  const DvrSettings& settings_;
  Ray ray_;          ///< begins where the first medium does, so that distances along it are precise
  float shift_ = 0;  ///< distance of its origin along the ray of the sensor
  const Spectrum d65_;
  ColorBasis basis_;
  KeyedRandom random_;
  VolumeLighting lighting_;
  std::vector<Part> parts_;
  float begin_ = 0, end_ = 0;  ///< distances along `ray_`
  bool is_one_ = false;        ///< whether `composite_one` composites the ray
  float length_ = 0;           ///< of the sensor's ray up to a surface
};

}  // namespace aureole

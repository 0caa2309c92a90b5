// SPDX-License-Identifier: Apache-2.0
// `VolumeMarch`: follows one ray through the classified media of a scene and composites what they show.
#pragma once

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
};

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
  };
  /// One step: its optical thickness and the light that it emits, unattenuated.
  struct Step {
    float thickness = 0;
    Spectrum emission{0.f};  ///< sum of thickness times colour
    float value = 0;         ///< number of the last medium
  };

  VolumeResult composite(float step);
  VolumeResult integrate();
  VolumeResult isosurfaces();
  VolumeResult project();
  /// The part of the step [a, b] within a medium.
  void add(Part& part, float a, float b, float offset, Step& step);
  Spectrum color_at(const ClassifiedMedium& medium, const Vec3& p, const Sample& s);
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
};

}  // namespace aureole

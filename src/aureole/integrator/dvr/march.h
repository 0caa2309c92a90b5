// SPDX-License-Identifier: Apache-2.0
// `VolumeMarch`: follows one ray through the classified media of a scene and composites their emission and
// absorption.
#pragma once

#include <bit>
#include <cmath>
#include <span>
#include <vector>

#include "aureole/integrator/dvr/lighting.h"

namespace aureole {

/// The light, the transmittance and the measures of one ray.
struct VolumeResult {
  Spectrum radiance{0.f};
  float transmittance = 1;      ///< transmittance for the light from behind
  float optical_thickness = 0;  ///< optical thickness of the part of the ray that was followed
  /// The largest value of the volume for mip, the mean for average, else the value where half of the light is
  /// absorbed; 0 if there is none.
  float value = 0;
  /// distance along the ray at which half of the light is absorbed; 0 if there is no such point
  float depth = 0;
  /// Number of evaluations of volumes along the ray, without those for gradients, lights and shadows.
  float lookups = 0;
};

/// Opacity of an optical thickness t >= 0, 1 - exp(-t), to some units in the last place: exp(-t) is 2^n exp(r) with
/// |r| <= log(2) / 2, and expm1(r) is its series.
inline float opacity_of(float t) {
  constexpr float kLargest = 80, kLog2 = 1.44269504f, kHigh = 0.693359375f, kLow = -2.12194440e-4f;
  const float x = t < kLargest ? -t : -kLargest;
  const int n = int(x * kLog2 - 0.5f);  // rounds to the nearest integer, since x is not positive
  const float r = (x - float(n) * kHigh) - float(n) * kLow;
  const float series =
      r +
      r * r *
          (1.f / 2 + r * (1.f / 6 + r * (1.f / 24 + r * (1.f / 120 + r * (1.f / 720 + r * (1.f / 5040))))));
  const float power = std::bit_cast<float>((n + 127) << 23);
  return -(power * series + (power - 1));
}
/// Number of steps of `length` in an interval, of which the last may be shorter. Makes the steps longer if
/// there were too many.
int divide_into_steps(float interval, float& length);

class VolumeMarch {
public:
  /// Follows `path.ray` up to the distance `length`.
  VolumeMarch(const Scene& scene, std::span<const ClassifiedMedium* const> media, const DvrSettings& settings,
              const Path& path, float length, const SampledSpectrum& d65, std::uint32_t key);

  /// Distance along the ray at which the last medium ends; 0 if the ray misses all media.
  float end() const { return parts_.empty() ? 0 : shift_ + end_; }
  VolumeResult follow();

private:
  using Sample = TransferFunction::Sample;
  /// A medium on the ray.
  struct Part {
    const ClassifiedMedium* medium;
    float begin, end;                          ///< distances along the ray
    std::vector<std::array<float, 2>> active;  ///< intervals that may absorb, as distances in order
    std::size_t next = 0;                      ///< index of the next interval in `active`
    float last_end = -1, last_value = 0;       ///< end of the last step and the volume's value there
    float first = 0, middle = 0,
          last = 0;  ///< values of the volume at the ends and in the middle of an adaptive step
  };
  /// One step: its optical thickness and the light that it emits, unattenuated.
  struct Step {
    float thickness = 0;
    Spectrum emission{0.f};  ///< sum of thickness times colour
    float value = 0;         ///< value of the volume in the last medium
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
  /// Sums the footprints of voxels (splatting.cpp).
  VolumeResult splat();
  VolumeResult isosurfaces();
  VolumeResult project();
  /// Radiance shown by a composited ray: the light from behind for xray.
  VolumeResult shown(VolumeResult result) const;
  /// The part of the step [a, b] within a medium.
  void add(Part& part, float a, float b, float offset, Step& step);
  Spectrum color_at(const ClassifiedMedium& medium, const Vec3& p, const Sample& s);
  /// Records the point where half of the light from behind is absorbed, in a layer around the distance `t`.
  void note_half(VolumeResult& result, float before, float value, float t) const {
    if (before > 0.5f && result.transmittance <= 0.5f) result.value = value, result.depth = shift_ + t;
  }
  void cover(VolumeResult& result, const Spectrum& color, float opacity) const {
    result.radiance += color * (opacity * result.transmittance);
    result.transmittance *= 1 - opacity;
  }
  Vec3 at(float t) const { return ray_.o + ray_.d * t; }

  const DvrSettings& settings_;
  Ray ray_;          ///< ray that begins at the first medium, so that distances along it are precise
  float shift_ = 0;  ///< distance from the origin of the sensor's ray to the origin of `ray_`
  Spectrum d65_;     ///< at the path's wavelengths; set, as `basis_`, where the ray hits a medium
  ColorBasis basis_;
  KeyedRandom random_;
  VolumeLighting lighting_;
  std::vector<Part> parts_;
  float phase_ = 0.5f;         ///< position of the samples in their steps, from 0 to 1
  float begin_ = 0, end_ = 0;  ///< first and last distance of the media along `ray_`
  bool is_one_ = false;        ///< whether `composite_one` composites the ray
  float length_ = 0;           ///< length of the sensor's ray up to a surface
};

}  // namespace aureole

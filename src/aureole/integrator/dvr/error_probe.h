// SPDX-License-Identifier: Apache-2.0
// `ErrorProbe`: rays of the sensor that `dvr` follows in several ways, to measure the errors of its approximations.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "aureole/integrator/dvr/march.h"

namespace aureole {

/// Differences between two ways to follow the same rays.
struct RayDifferences {
  double light = 0, largest_light = 0;  ///< mean and largest, as parts of the brightest ray's light
  double opacity = 0, largest_opacity = 0;
  double number = 0;                  ///< mean difference of the volume's number
  double shift = 0, shift_error = 0;  ///< mean signed difference of light and its standard error

  /// `brightest` is the light of the brightest ray.
  static RayDifferences of(const std::vector<VolumeResult>& found, const std::vector<VolumeResult>& expected,
                           double brightest);
};

class ErrorProbe {
public:
  /// Number of rays for a picture with `samples` samples in all, of which a hundredth is spent, where a ray costs as much as `cost`
  /// samples.
  static int count_of(double samples, double cost);
  /// Takes at most `count` rays that hit a medium and spread evenly over the film.
  ErrorProbe(const Scene& scene, std::span<const ClassifiedMedium* const> media, const SampledSpectrum& d65,
             int count, int threads);

  std::size_t count() const { return rays_.size(); }
  /// The rays as paths whose random numbers are those of a sample.
  std::vector<Path> paths(std::uint32_t sample) const;
  /// The light of all rays. Random numbers depend on the ray and on `stream`.
  std::vector<VolumeResult> follow(const DvrSettings& settings, std::uint32_t stream = 0) const;

private:
  struct ProbeRay {
    Path path;
    float length;  ///< distance of the first surface
    std::uint32_t key;
  };
  bool hits(const Ray& ray, float length) const;

  const Scene& scene_;
  const std::span<const ClassifiedMedium* const> media_;
  const SampledSpectrum& d65_;
  const int threads_;
  std::vector<ProbeRay> rays_;
};

}  // namespace aureole

// SPDX-License-Identifier: Apache-2.0
// The start of a pixel sample: its random numbers, film position, wavelengths and ray. All kinds of rendering
// begin samples here.
#pragma once

#include "aureole/core/random.h"
#include "aureole/sampler/sampler.h"
#include "aureole/scene/scene.h"

namespace aureole {

/// The key of a film pixel for the samplers.
inline std::uint64_t pixel_key(std::uint64_t seed, int replicate, int x, int y) {
  const std::uint64_t pixel = std::uint64_t(std::uint32_t(y)) << 32 | std::uint32_t(x);
  return combine_bits(combine_bits(seed, std::uint64_t(replicate)), pixel);
}

/// Begins sample `index` of the pixel (x, y) of the film. On return the next dimension of `samples` is the
/// first one of the path.
inline SensorRay begin_camera_sample(const Scene& scene, std::uint64_t key, int x, int y, std::int64_t index,
                                     SampleStream& samples, Wavelengths& wavelengths, Vec2& position) {
  const PlacedSensor& sensor = scene.sensor();
  samples = SampleStream(sensor.sampler(), key, std::uint32_t(index));
  position = samples.get2(SampleStream::kFilm) + Vec2{float(x), float(y)};
  wavelengths = scene.wavelengths().sample(samples.get1(SampleStream::kWavelengthSet),
                                           samples.get1(SampleStream::kHero));
  const bool lens = sensor.uses_lens(), changes = scene.changes();
  if (changes) {
    const Exposure& exposure = sensor.sensor->exposure();
    const float u = exposure.is_instant() ? 0.f : samples.get1(SampleStream::kTime);
    const Film& film = scene.film();
    if (const ExposureTimes* times = scene.exposure_times()) {
      const double begin = exposure.begin(x, y, film.width(), film.height());
      const ExposureTimes::Sample s = times->sample(double(u), begin, begin + exposure.duration());
      wavelengths.time = float(s.time), wavelengths.time_weight = float(1 / s.density);
      wavelengths.pdf *= float(s.density);
    } else {
      wavelengths.time = exposure.time(u, x, y, film.width(), film.height());
    }
  }
  const Vec2 lens_position = lens ? samples.get2(SampleStream::kLens) : Vec2{};
  if (sensor.disperses()) wavelengths = wavelengths.of_hero();
  SensorRay ray = sensor.disperses() ? sensor.sample_dispersed_ray(position, lens_position, wavelengths.time,
                                                                   wavelengths.nm[0])
                                     : sensor.sample_ray(position, lens_position, wavelengths.time);
  ray.ray.time = wavelengths.time;
  samples.set_first(SampleStream::camera_dimensions(lens || changes));
  return ray;
}

}  // namespace aureole

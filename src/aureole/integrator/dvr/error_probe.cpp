// SPDX-License-Identifier: Apache-2.0
#include "aureole/integrator/dvr/error_probe.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "aureole/core/parallel.h"
#include "aureole/integrator/first_surface.h"

namespace aureole {

RayDifferences RayDifferences::of(const std::vector<VolumeResult>& found,
                                  const std::vector<VolumeResult>& expected, double brightest) {
  RayDifferences d;
  const double n = double(found.size()), scale = brightest > 0 ? 1 / brightest : 0;
  double squares = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    const Spectrum change = found[i].radiance - expected[i].radiance;
    const double light = scale * double(mean(abs(change))), shift = scale * double(mean(change));
    const double opacity = std::abs(double(found[i].transmittance) - double(expected[i].transmittance));
    d.light += light / n, d.opacity += opacity / n, d.shift += shift / n, squares += shift * shift / n;
    d.number += std::abs(double(found[i].value) - double(expected[i].value)) / n;
    d.largest_light = std::max(d.largest_light, light),
    d.largest_opacity = std::max(d.largest_opacity, opacity);
  }
  d.shift_error = std::sqrt(std::max(0., squares - d.shift * d.shift) / std::max(1., n - 1));
  return d;
}

int ErrorProbe::count_of(double samples, double cost) {
  constexpr double kEffort = 0.01, kFewest = 16, kMost = 4096;
  return int(std::clamp(kEffort * samples / cost, kFewest, kMost));
}

ErrorProbe::ErrorProbe(const Scene& scene, std::span<const ClassifiedMedium* const> media,
                       const SampledSpectrum& d65, int count, int threads)
    : scene_(scene), media_(media), d65_(d65), threads_(threads) {
  // Positions on the film by the R2 sequence (M. Roberts 2018, "The unreasonable effectiveness of quasirandom
  // sequences"). Rays beside the media cost little and show nothing.
  constexpr int kMostMisses = 8;  // rays that are tried for each one that is wanted
  const PlacedSensor& sensor = scene.sensor();
  const Film& film = scene.film();
  const auto fraction = [](double x) { return float(x - std::floor(x)); };
  for (int k = 0; k < kMostMisses * count && int(rays_.size()) < count; ++k) {
    const float u = fraction(0.5 + k * 0.7548776662466927), v = fraction(0.5 + k * 0.5698402909980532);
    ProbeRay ray{.path = {}, .length = kInfinity, .key = std::uint32_t(k)};
    Path& path = ray.path;
    path.film = {float(film.crop_x()) + u * float(film.crop_width()),
                 float(film.crop_y()) + v * float(film.crop_height())};
    path.samples = SampleStream(sensor.sampler(), std::uint64_t(k), 0);
    path.wavelengths = scene.wavelengths().sample(0.5f, 0.5f);
    if (scene.changes())
      path.wavelengths.time = sensor.sensor->exposure().time(0.5f, int(path.film.x), int(path.film.y),
                                                             film.width(), film.height());
    const Vec2 lens{fraction(0.5 + k * 0.6180339887498949), fraction(0.5 + k * 0.4142135623730951)};
    const float time = path.wavelengths.time;
    path.ray = sensor.disperses()
                   ? sensor.sample_dispersed_ray(path.film, lens, time, path.wavelengths.nm[0]).ray
                   : sensor.sample_ray(path.film, lens, time).ray;
    path.ray.time = time;
    if (!hits(path.ray, path.ray.t_max)) continue;
    FirstSurface surface;
    find_first_surfaces(scene, {&path.ray, 1}, RayTracer::Rays::incoherent, &surface);
    ray.length = surface.distance;
    if (hits(path.ray, std::min(ray.length, path.ray.t_max))) rays_.push_back(ray);
  }
}

std::vector<Path> ErrorProbe::paths(std::uint32_t sample) const {
  std::vector<Path> paths;
  for (const ProbeRay& ray : rays_) {
    Path& path = paths.emplace_back(ray.path);
    path.samples = SampleStream(scene_.sensor().sampler(), ray.key, sample);
    path.samples.set_first(SampleStream::camera_dimensions(scene_.sensor().uses_lens() || scene_.changes()));
  }
  return paths;
}

std::vector<VolumeResult> ErrorProbe::follow(const DvrSettings& settings, std::uint32_t stream) const {
  std::vector<VolumeResult> results(rays_.size());
  std::atomic<std::size_t> next{0};
  run_workers(threads_, [&](int) {
    for (std::size_t i = next++; i < rays_.size(); i = next++) {
      const ProbeRay& ray = rays_[i];
      results[i] =
          VolumeMarch(scene_, media_, settings, ray.path, ray.length, d65_, ray.key + 0x9e3779b9u * stream)
              .follow();
    }
  });
  return results;
}

bool ErrorProbe::hits(const Ray& ray, float length) const {
  return std::any_of(media_.begin(), media_.end(), [&](const ClassifiedMedium* medium) {
    float begin = 0, end = length;
    medium->clip(ray, begin, end);
    return end > begin;
  });
}

}  // namespace aureole
